/* test_mpm_pressure.c - the pressure of water in the WLS-MPM solver: at rest it is that of the
 * depth; in the collapse of a column (Martin and Moyce 1952, n^2 = 2) it is smooth with the filter
 * and with the means of nodes, and the front goes as without. SPDX-License-Identifier: BSD-3-Clause
 */
#include "mpm_scene.h"
#include "test_fixture.h"

#define WIDTH 0.05715 /* m, a */
#define GRAVITY 9.81
#define RHO 1000.0

/* A column of water, two particles a cell along each axis, a/cells wide cells, between walls
 * `sides` apart on a floor, all without friction. It begins with the pressure of its depth (at
 * rest), or none, as where a gate was removed at its side. */
static mpm_scene water(int32_t spline, int32_t volumetric, int cells, double sides, bool at_rest) {
  const double h = WIDTH / cells, height = 2.0 * WIDTH, c = 10.0 * sqrt(2.0 * GRAVITY * height);
  const double K = RHO * c * c;
  mpm_scene s = mpm_scene_begin(context, 0.5 * h, 0.0, 0.0, 1e6);
  mps_material_destroy(&s.material);
  USING(material_newtonian, mps_material_create_newtonian(context, &given, &s.material),
        .state = MPS_MATERIAL_STATE_EQUATION_LINEAR, .bulk_modulus = K, .no_tension = 1);
  mpm_scene_box(&s, 0.0, 0.0, WIDTH, height);
  OK(mps_particles_add_field(s.particles, "volume_ratio", 0));
  OK(mps_particles_add_field(s.particles, "stress", 0));
  mps_view x = mpm_scene_view(&s, "position");
  EDIT(J, s.particles, "volume_ratio")
    EDIT(stress, s.particles, "stress")
      for (int64_t k = 0; k < x.shape[0]; k++) {
        const double p = at_rest ? RHO * GRAVITY * (height - *mps_view_f64(&x, k, 1)) : 0.0;
        *mps_edit_f64(&J, k, 0) = 1.0 / (1.0 + p / K);
        for (int a = 0; a < 3; a++) *mps_edit_f64(&stress, k, a) = -p;
      }
  USING(mpm, mpm_scene_solve(&s, &given), .spline = spline, .volumetric = volumetric, .cell = h,
        .lower[0] = given.lower[1] = 0.0, .upper[0] = sides, .gravity[1] = -GRAVITY);
  return s;
}

/* T = t (2 g/a)^1/2. */
static double seconds(double T) { return T * sqrt(WIDTH / (2.0 * GRAVITY)); }

TEST(water_rests) {
  for (int32_t spline = 2; spline <= 3; spline++)
    for (int option = 0; option < 3; option++) {
      static const char *const name[] = {"by law", "point", "nodes"};
      static const int32_t which[] = {MPS_MPM_VOLUMETRIC_BY_LAW, MPS_MPM_VOLUMETRIC_POINT,
                                      MPS_MPM_VOLUMETRIC_NODES};
      scoped_mpm_scene s = water(spline, which[option], 10, WIDTH, true);
      OK(mps_mpm_run(s.mpm, seconds(12.0), 1000000, NULL, NULL));
      mps_view x = mpm_scene_view(&s, "position"), stress = mpm_scene_view(&s, "stress");
      double square = 0.0;
      for (int64_t k = 0; k < x.shape[0]; k++) {
        const double p = RHO * GRAVITY * (2.0 * WIDTH - *mps_view_f64(&x, k, 1));
        square += pow(*mps_view_f64(&stress, k, 0) + p, 2);
      }
      const double off = sqrt(square / (double)x.shape[0]) / (RHO * GRAVITY * 2.0 * WIDTH);
      print_message("water at rest, spline %d, %s: off by %.3g %% of the bottom's pressure\n",
                    spline, name[option], 100.0 * off);
      assert_true(off < 1e-3);
    }
}

/* ---- collapse -------------------------------------------------------------------------------- */

/* Solves the symmetric 3 x 3 system of a linear fit; its value at the particle. */
static double fitted(double m[3][4]) {
  for (int a = 0; a < 3; a++)
    for (int b = a + 1; b < 3; b++) {
      const double f = m[b][a] / m[a][a];
      for (int c = a; c < 4; c++) m[b][c] -= f * m[a][c];
    }
  const double c2 = m[2][3] / m[2][2], c1 = (m[1][3] - m[1][2] * c2) / m[1][1];
  return (m[0][3] - m[0][1] * c1 - m[0][2] * c2) / m[0][0];
}

/* Mean square of what acts as a particle's pressure less the linear fit to those within a cell. */
static double square_roughness(mpm_scene *s) {
  const double h = s->mpm ? WIDTH / 20 : 0.0;
  mps_view x = mpm_scene_view(s, "position"), stress = mpm_scene_view(s, "stress");
  double square = 0.0;
  int64_t count = 0;
  for (int64_t k = 0; k < x.shape[0]; k += 7) {
    double m[3][4] = {{0.0}};
    int near = 0;
    for (int64_t q = 0; q < x.shape[0]; q++) {
      const double dx = (*mps_view_f64(&x, q, 0) - *mps_view_f64(&x, k, 0)) / h;
      const double dy = (*mps_view_f64(&x, q, 1) - *mps_view_f64(&x, k, 1)) / h;
      if (dx * dx + dy * dy > 1.0) continue;
      const double b[4] = {1.0, dx, dy, -*mps_view_f64(&stress, q, 0)};
      for (int u = 0; u < 3; u++)
        for (int w = 0; w < 4; w++) m[u][w] += b[u] * b[w];
      near++;
    }
    if (near < 8) continue;
    square += pow(-*mps_view_f64(&stress, k, 0) - fitted(m), 2);
    count++;
  }
  return square / (double)count;
}

static void collapse(int32_t spline, int32_t volumetric, double *rough, double *front) {
  enum { LOOKS = 16 };
  scoped_mpm_scene s = water(spline, volumetric, 20, 6.0 * WIDTH, false);
  double square = 0.0;
  OK(mps_mpm_run(s.mpm, seconds(1.0), 1000000, NULL, NULL));
  for (int k = 1; k <= LOOKS; k++) {
    OK(mps_mpm_run(s.mpm, seconds(1.0 + 2.0 * k / LOOKS), 1000000, NULL, NULL));
    square += square_roughness(&s) / LOOKS;
  }
  mps_view x = mpm_scene_view(&s, "position");
  *front = 0.0;
  for (int64_t k = 0; k < x.shape[0]; k++) *front = fmax(*front, *mps_view_f64(&x, k, 0) / WIDTH);
  *rough = sqrt(square);
}

TEST(collapse_is_smooth) {
  for (int32_t spline = 2; spline <= 3; spline++) {
    double rough[4], front[4];
    for (int32_t v = 0; v < 4; v++)
      collapse(spline, MPS_MPM_VOLUMETRIC_BY_LAW + v, &rough[v], &front[v]);
    print_message("collapse, spline %d, T 1 to 3: roughness %.3g Pa, by point %.3g, by cell %.3g, "
                  "by nodes %.3g; front at T = 3 %.3f, %.3f, %.3f, %.3f a\n",
                  spline, rough[0], rough[1], rough[2], rough[3], front[0], front[1], front[2],
                  front[3]);
    assert_true(rough[0] < 0.15 * rough[1] && rough[3] < 0.1 * rough[1]);
    NEAR(front[0], front[1], 0.01 * front[1]);
    NEAR(front[3], front[1], 0.03 * front[1]);
  }
}
