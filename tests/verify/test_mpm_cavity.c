/* test_mpm_cavity.c - a cylindrical cavity that is opened further in undrained modified Cam-Clay.
 * Volume is kept, so that r^2 - r0^2 is the same for all r and each particle follows the path of
 * pure shear in plane strain with the strain ln(r/r0); equilibrium gives the total pressure in the
 * cavity, p_a = p_R + integral from a to R of (s_r - s_t)(ln(r/r0)) dr/r, with s_r - s_t of one
 * point (verify/material_cam_clay compares its paths with closed forms), and, far from first yield,
 * s_r - s_t = 2 su. SPDX-License-Identifier: BSD-3-Clause */
#include "mpm_scene.h"

#include "clay_points.h"

#define A0 0.05     /* m, first radius of the cavity */
#define R0 1.0      /* m, first outer radius */
#define H 0.005     /* m, cell; the height of the ring too */
#define SPEED 0.5   /* m/s */
#define RAMP 0.01   /* s */
#define OPENED 0.02 /* m */

/* ---- theory ---------------------------------------------------------------------------------- */

enum { PATH = 4000 };

/* s_r - s_t (Pa) for strains 0 to `most` in PATH steps. */
static void find_path(const clay *c, double most, double *difference) {
  scoped_material *m = make_clay(c);
  mps_material_point x = point_under(m, -c->p0);
  const double L[9] = {-most / PATH, 0, 0, 0, most / PATH, 0, 0, 0, 0};
  difference[0] = 0.0;
  for (int k = 1; k <= PATH; k++) {
    OK(mps_material_point_drive(context, m, &x, L, 1.0, 1));
    difference[k] = x.stress[1] - x.stress[0];
  }
}

/* Total pressure (Pa) in a cavity of radius a. */
static double cavity_pressure(const clay *c, const double *path, double most, double a) {
  enum { RINGS = 20000 };
  const double square = a * a - A0 * A0, step = log(sqrt(R0 * R0 + square) / a) / RINGS;
  double sum = 0.0;
  for (int k = 0; k < RINGS; k++) {
    const double r = a * exp((k + 0.5) * step), strain = -0.5 * log1p(-square / (r * r));
    const double at = strain / most * PATH;
    const int i = (int)at < PATH - 1 ? (int)at : PATH - 1;
    sum += step * (path[i] + (at - i) * (path[i + 1] - path[i]));
  }
  return c->p0 + sum;
}

/* ---- the ring -------------------------------------------------------------------------------- */

static void press_outside(mpm_scene *s, double p) {
  enum { MOST = 16 };
  int64_t ids[MOST], count = 0;
  mps_view x = mpm_scene_view(s, "position"), id = mpm_scene_view(s, "id");
  for (int64_t k = 0; k < x.shape[0]; k++)
    if (*mps_view_f64(&x, k, 0) > R0 - 0.5 * H) {
      assert_true(count < MOST);
      ids[count++] = *mps_view_i64(&id, k, 0);
    }
  const double traction[2] = {-p, 0.0};
  const mps_mpm_load_def load = mpm_scene_load_def(count, ids, NULL, traction, 2, NULL);
  OK(mps_mpm_add_load(s->mpm, &load, NULL));
}

/* The ground of the ring at rest, saturated. */
static mpm_scene make_ring(const clay *c) {
  mpm_scene s = mpm_scene_begin(context, 0.5 * H, A0, 0.0, 1e7);
  mps_material_destroy(&s.material);
  s.material = make_clay(c);
  mpm_scene_box(&s, A0, 0.0, R0, H);
  OK(mps_particles_add_field(s.particles, "stress", 0));
  for (int k = 0; k < 3; k++) OK(mps_particles_set(s.particles, "stress", k, -c->p0));
  OK(mps_particles_set(s.particles, "density", 0, 1800.0));
  USING(mpm, mps_mpm_create(context, s.particles, s.material, &given, &s.mpm),
        .geometry = MPS_MPM_GEOMETRY_AXISYMMETRIC, .cell = H, .lower[0] = given.lower[1] = 0.0,
        .upper[1] = H);
  USING(pore_water, mps_mpm_add_pore_water(s.mpm, &given), .porosity = c->e0 / (1.0 + c->e0));
  press_outside(&s, c->p0);
  return s;
}

/* A half plane to the left of the ground, which moves outwards. */
static mps_body *add_wall(mpm_scene *s) {
  const double out[2] = {1.0, 0.0}, t[3] = {0.0, RAMP, 10.0}, v[3] = {0.0, SPEED, SPEED};
  DEF(body, def, .position[0] = A0);
  MAKE_KEPT(body, wall, create_half_plane, context, &def, out);
  MAKE(signal, signal, create_table, context, MPS_SIGNAL_QUANTITY_VELOCITY, 3, t, v);
  OK(mps_body_drive(wall, 0, signal, 1.0));
  mpm_scene_contact(s, wall, 0.0);
  return wall;
}

static double radius_of(const mps_body *wall) {
  mps_body_state state;
  OK(mps_body_get_state(wall, &state));
  return state.position[0];
}

/* Mean pressure (Pa) on the wall while it moves on by `path`. */
static double mean_pressure(mpm_scene *s, mps_body *wall, double path, double *radius) {
  const double begin = radius_of(wall), t = mps_mpm_time(s->mpm);
  mps_reaction before, after;
  OK(mps_body_get_reaction(wall, -1, &before));
  OK(mps_mpm_run(s->mpm, t + path / SPEED, 1000000, NULL, NULL));
  OK(mps_body_get_reaction(wall, -1, &after));
  *radius = 0.5 * (begin + radius_of(wall));
  const double force = fabs(after.impulse[0] - before.impulse[0]) / (mps_mpm_time(s->mpm) - t);
  return force / (2.0 * PI * *radius * H);
}

static void expand(const clay *c) {
  static double path[PATH + 1];
  const double most = 0.5 * log((A0 + OPENED) * (A0 + OPENED) / (A0 * A0)) * 1.2;
  find_path(c, most, path);
  scoped_mpm_scene s = make_ring(c);
  scoped_body *wall = add_wall(&s);
  OK(mps_mpm_run(s.mpm, RAMP, 1000000, NULL, NULL));
  const double lambda = 1.0 - c->kappa / c->lambda;
  const double su = c->M / sqrt(3.0) * c->p0 * pow(0.5 * c->R, lambda);
  for (double a = radius_of(wall); a < A0 + OPENED; a = radius_of(wall)) {
    double radius;
    const double p = mean_pressure(&s, wall, 0.1 * OPENED, &radius);
    const double exact = cavity_pressure(c, path, most, radius);
    print_message("a/a0 %.3f: %.1f kPa, theory %.1f kPa (%+.2f %%)\n", radius / A0, 1e-3 * p,
                  1e-3 * exact, 100.0 * (p / exact - 1.0));
    if (radius < A0 + 0.3 * OPENED) continue;
    NEAR((p - c->p0) / (exact - c->p0), 1.0, 0.03);
  }
  NEAR(path[PATH] / (2.0 * su), 1.0, 0.01);
}

TEST(normally_consolidated) { expand(&clays[0]); }
TEST(overconsolidated) { expand(&clays[1]); }
