/* test_mpm_free_field_water.c - saturated ground between free-field sides: noise in ground at rest
 * does not grow, whatever the cells, the stiffness of the water, the permeability and the transfer;
 * the ground consolidates as between rollers; a scene and its mirror image agree.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "mpm_free_field.h"
#include "test_fixture.h"

#define HEIGHT 10.0 /* m */
#define VS 200.0    /* m/s */
#define NOISE 1e-9  /* m/s */
#define START 1e4   /* Pa, excess pressure at the start of consolidation */

typedef struct wet_ground {
  double cell, width; /* m */
  double bulk, permeability;
  double flip_time;
  int32_t spline, sides;
} wet_ground;

static mpm_scene wet_scene(const wet_ground *w) {
  const field_ground of = {.width = w->width,
                           .height = HEIGHT,
                           .spacing = 0.5 * w->cell,
                           .vs = VS,
                           .sides = w->sides,
                           .base = MPS_BOUNDARY_HELD,
                           .flip_time = w->flip_time,
                           .spline = w->spline};
  mpm_scene s = field_scene(context, &of);
  DEF(pore_water, water, .porosity = 0.4, .bulk = w->bulk);
  if (w->permeability > 0.0) water.permeability = w->permeability;
  OK(mps_mpm_add_pore_water(s.mpm, &water));
  return s;
}

/* A number in (-1, 1) by place and component, the same on every grid of particles. */
static double noise_at(double x, double y, int c) {
  const double r = sin(12.9898 * x + 78.233 * y + 37.719 * c) * 43758.5453;
  return 2.0 * (r - floor(r)) - 1.0;
}

/* `mirrored`: of the scene whose image at x = width/2 this one is. */
static void add_noise(mpm_scene *s, double width, bool mirrored) {
  const mps_view x = mpm_scene_view(s, "position");
  EDIT(v, s->particles, "velocity")
    for (int64_t k = 0; k < x.shape[0]; k++) {
      const double X = *mps_view_f64(&x, k, 0), Y = *mps_view_f64(&x, k, 1);
      const double at = mirrored ? width - X : X;
      *mps_edit_f64(&v, k, 0) = NOISE * noise_at(at, Y, 0) * (mirrored ? -1.0 : 1.0);
      *mps_edit_f64(&v, k, 1) = NOISE * noise_at(at, Y, 1);
    }
}

static double fastest(mpm_scene *s) {
  const mps_view v = mpm_scene_view(s, "velocity");
  double most = 0.0;
  for (int64_t k = 0; k < v.shape[0]; k++)
    for (int c = 0; c < 2; c++) most = fmax(most, fabs(*mps_view_f64(&v, k, c)));
  return most;
}

/* ---- noise ----------------------------------------------------------------------------------- */

/* With the ground's pressures in the columns the same scenes grew by 6 (h = 1 m, 2.2e10 Pa) to 40
 * (0.25 m) per second: every one of these would be above the noise that it began with. */
TEST(noise_decays) {
  static const struct {
    double cell, bulk, end;
  } grid[] = {{1.0, 2.2e7, 1.0}, {1.0, 2.2e9, 1.0},  {1.0, 2.2e10, 2.0}, {0.5, 2.2e7, 1.0},
              {0.5, 2.2e9, 1.0}, {0.5, 2.2e10, 0.5}, {0.25, 2.2e7, 0.3}, {0.25, 2.2e9, 0.25}};
  static const double permeability[] = {0.0, 1e-6, 1e-4};
  for (int q = 0; q < 24; q++) { /* each grid with each permeability; the transfers take turns */
    const wet_ground w = {.cell = grid[q / 3].cell,
                          .width = 4.0 * grid[q / 3].cell,
                          .bulk = grid[q / 3].bulk,
                          .permeability = permeability[q % 3],
                          .flip_time = q / 2 % 2 ? 0.1 : 0.0,
                          .spline = 2 + (q + q / 4) % 2,
                          .sides = MPS_BOUNDARY_FREE_FIELD};
    mpm_scene s = wet_scene(&w);
    add_noise(&s, w.width, false);
    OK(mps_mpm_run(s.mpm, grid[q / 3].end, 10000000, NULL, NULL));
    const double most = fastest(&s);
    print_message("h = %g m, K_w = %.2g Pa, k = %g m/s, spline %d, flip_time %g s: %.2g m/s after "
                  "%g s, %.2g at first\n",
                  w.cell, w.bulk, w.permeability, w.spline, w.flip_time, most, grid[q / 3].end,
                  NOISE);
    assert_true(most < 0.5 * NOISE);
    mpm_scene_end(&s);
  }
}

TEST(noise_decays_without_flip_time_by_both_splines) {
  for (int32_t spline = 2; spline <= 3; spline++) {
    const wet_ground w = {.cell = 0.5,
                          .width = 2.0,
                          .bulk = 2.2e9,
                          .spline = spline,
                          .sides = MPS_BOUNDARY_FREE_FIELD};
    scoped_mpm_scene s = wet_scene(&w);
    add_noise(&s, w.width, false);
    OK(mps_mpm_run(s.mpm, 1.0, 10000000, NULL, NULL));
    print_message("spline %d: %.2g m/s\n", spline, fastest(&s));
    assert_true(fastest(&s) < 1e-9);
  }
}

/* ---- consolidation --------------------------------------------------------------------------- */

typedef struct consolidated {
  double side, middle, surface; /* Pa at the base, m */
} consolidated;

/* The mean of a field at the base within [from, to], or of the heights of the surface. */
static double mean_of(mpm_scene *s, const char *name, int c, double from, double to, double below,
                      double above) {
  const mps_view x = mpm_scene_view(s, "position"), f = mpm_scene_view(s, name);
  double sum = 0.0, count = 0.0;
  for (int64_t k = 0; k < x.shape[0]; k++) {
    const double X = *mps_view_f64(&x, k, 0), Y = *mps_view_f64(&x, k, 1);
    if (X < from || X > to || Y > below || Y < above) continue;
    sum += *mps_view_f64(&f, k, c), count += 1.0;
  }
  assert_true(count > 0.0);
  return sum / count;
}

/* From an excess pressure that the effective stress balances, so that nothing but the flow moves.
 */
static consolidated consolidate(double cell, int32_t sides) {
  const wet_ground w = {.cell = cell,
                        .width = 4.0 * cell,
                        .bulk = 2.2e8,
                        .permeability = 1e-3,
                        .flip_time = 0.1,
                        .sides = MPS_BOUNDARY_ROLLER};
  scoped_mpm_scene s = wet_scene(&w);
  EDIT(u, s.particles, "pore_pressure")
    EDIT(stress, s.particles, "stress")
      for (int64_t k = 0; k < u.view.shape[0]; k++) {
        *mps_edit_f64(&u, k, 0) = START;
        for (int c = 0; c < 3; c++) *mps_edit_f64(&stress, k, c) = START;
      }
  mpm_scene_side(&s, MPS_SIDE_X_LOWER, sides, 0.0);
  mpm_scene_side(&s, MPS_SIDE_X_UPPER, sides, 0.0);
  OK(mps_mpm_run(s.mpm, 1.0, 10000000, NULL, NULL));
  const consolidated out = {mean_of(&s, "pore_pressure", 0, 0.0, cell, cell, 0.0),
                            mean_of(&s, "pore_pressure", 0, 1.5 * cell, 2.5 * cell, cell, 0.0),
                            HEIGHT - 0.25 * cell -
                                mean_of(&s, "position", 1, 0.0, 1e9, 1e9, HEIGHT - 0.5 * cell)};
  return out;
}

TEST(consolidates_as_between_rollers) {
  static const double cell[] = {1.0, 0.625, 0.5};
  for (int q = 0; q < 3; q++) {
    const consolidated field = consolidate(cell[q], MPS_BOUNDARY_FREE_FIELD);
    const consolidated rollers = consolidate(cell[q], MPS_BOUNDARY_ROLLER);
    print_message("h = %g m: %.2f Pa beside the side, %.2f in the middle, surface %.5f mm; between "
                  "rollers %.2f Pa, %.5f mm\n",
                  cell[q], field.side, field.middle, 1e3 * field.surface, rollers.middle,
                  1e3 * rollers.surface);
    assert_true(rollers.middle > 0.2 * START && rollers.middle < 0.98 * START);
    NEAR(field.side, rollers.side, 1e-3 * START);
    NEAR(field.middle, rollers.middle, 1e-3 * START);
    NEAR(field.surface, rollers.surface, 1e-3 * rollers.surface);
  }
}

/* Pressures that the caller writes after the side was set are the column's too. */
TEST(takes_pressures_of_the_caller) {
  const wet_ground w = {.cell = 0.5,
                        .width = 2.0,
                        .bulk = 2.2e8,
                        .permeability = 1e-4,
                        .sides = MPS_BOUNDARY_FREE_FIELD};
  double force[2][3];
  for (int late = 0; late < 2; late++) {
    scoped_mpm_scene s = wet_scene(&w);
    if (late) OK(mps_mpm_step(s.mpm, 1)); /* nothing moves */
    EDIT(u, s.particles, "pore_pressure")
      for (int64_t k = 0; k < u.view.shape[0]; k++) *mps_edit_f64(&u, k, 0) = START;
    OK(mps_mpm_step(s.mpm, 1));
    mpm_scene_force(&s, MPS_SIDE_X_LOWER, force[late]);
    print_message("force of the left side %.6g N, of the pressures %g N\n", force[late][0],
                  START * HEIGHT);
    NEAR(force[late][0], START * HEIGHT, 0.02 * START * HEIGHT);
  }
}

/* ---- mirrored -------------------------------------------------------------------------------- */

TEST(mirror_images_agree) {
  const wet_ground w = {.cell = 0.5,
                        .width = 2.0,
                        .bulk = 2.2e9,
                        .permeability = 1e-4,
                        .sides = MPS_BOUNDARY_FREE_FIELD};
  scoped_mpm_scene a = wet_scene(&w), b = wet_scene(&w);
  add_noise(&a, w.width, false);
  add_noise(&b, w.width, true);
  OK(mps_mpm_step(a.mpm, 400));
  OK(mps_mpm_step(b.mpm, 400));
  const mps_view va = mpm_scene_view(&a, "velocity"), vb = mpm_scene_view(&b, "velocity");
  const mps_view x = mpm_scene_view(&a, "position");
  double apart = 0.0;
  for (int64_t k = 0; k < x.shape[0]; k++) {
    const double at[2] = {w.width - *mps_view_f64(&x, k, 0), *mps_view_f64(&x, k, 1)};
    const int64_t m = mps_particles_index(b.particles, mps_particles_nearest(b.particles, at));
    apart = fmax(apart, fabs(*mps_view_f64(&va, k, 0) + *mps_view_f64(&vb, m, 0)));
    apart = fmax(apart, fabs(*mps_view_f64(&va, k, 1) - *mps_view_f64(&vb, m, 1)));
  }
  print_message("mirror images differ by %.2g m/s of %.2g\n", apart, fastest(&a));
  assert_true(fastest(&a) > 1e-4 * NOISE);
  assert_true(apart < 1e-6 * fastest(&a));
}

/* ---- implicit pressures ---------------------------------------------------------------------- */

TEST(refuses_implicit_pressures) {
  const field_ground of = {.width = 2.0,
                           .height = 4.0,
                           .spacing = 0.25,
                           .vs = VS,
                           .sides = MPS_BOUNDARY_FREE_FIELD,
                           .base = MPS_BOUNDARY_HELD};
  scoped_mpm_scene s = field_scene(context, &of);
  USING(pore_water, mps_mpm_add_pore_water(s.mpm, &given), .porosity = 0.4, .bulk = 2.2e9,
        .permeability = 1e-4, .scheme = MPS_PORE_SCHEME_IMPLICIT);
  FAILS(mps_mpm_step(s.mpm, 1), MPS_ERROR_STATE, "a side is of kind MPS_BOUNDARY_FREE_FIELD");
  assert_int_equal(mps_mpm_steps(s.mpm), 0);
  mpm_scene_side(&s, MPS_SIDE_X_LOWER, MPS_BOUNDARY_ROLLER, 0.0);
  mpm_scene_side(&s, MPS_SIDE_X_UPPER, MPS_BOUNDARY_ROLLER, 0.0);
  OK(mps_mpm_step(s.mpm, 1));
}
