/* test_mpm_free_field_structures.c - a structure on ground between free-field sides, whose base
 * moves by several spacings and back: particles pass the sides, and the ground beside the structure
 * moves as level ground does. What lies on the ground, or differs from side to side, stays.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "mpm_free_field.h"
#include "test_fixture.h"

#define WIDTH 12.0       /* m */
#define VS 100.0         /* m/s */
#define GRAVITY 9.81     /* m/s2 */
#define ACCELERATION 1.5 /* m/s2, largest of the base */
#define BESIDE 2.0       /* m, from a side: that ground is compared */

enum { MOST = 4096 }; /* particles */

typedef enum structure { NOTHING, BLOCK, HILL } structure;

typedef struct site {
  double spacing, height, way; /* m, m, spacings */
  structure what;
  bool layers, wet; /* frictional ground above elastic; undrained */
  bool weightless;
} site;

typedef struct scene {
  mpm_scene s;
  mps_body *block;
  mps_material *sand;
  mps_signal *motion;
} scene;

#define scoped_scene SCOPED(end_scene) scene

static void end_scene(scene *x) {
  mps_mpm_destroy(&x->s.mpm);
  mps_body_destroy(&x->block);
  mps_particles_destroy(&x->s.particles);
  mps_material_destroy(&x->s.material);
  mps_material_destroy(&x->sand);
  mps_signal_destroy(&x->motion);
}

/* Time in which the base goes by `way` and back, x = way/2 (1 - cos 2 pi t/T). */
static double period_of(const site *of) {
  return PI * sqrt(2.0 * of->way * of->spacing / ACCELERATION);
}

static mps_signal *to_and_fro(const site *of) {
  enum { COUNT = 401 };
  double t[COUNT], v[COUNT];
  const double T = period_of(of);
  for (int k = 0; k < COUNT; k++) {
    t[k] = T * k / (COUNT - 1);
    v[k] = PI * of->way * of->spacing / T * sin(2.0 * PI * t[k] / T);
  }
  MAKE_KEPT(signal, out, create_table, context, MPS_SIGNAL_QUANTITY_VELOCITY, COUNT, t, v);
  return out;
}

/* ---- scenes ---------------------------------------------------------------------------------- */

static double surface(const site *of, double x) {
  const double hill = of->what == HILL ? 1.0 - 0.5 * fabs(x - 0.5 * WIDTH) : 0.0;
  return of->height + fmax(0.0, hill);
}

/* Ground with a hill of 1 m in the middle: removes what is above it. */
static void shape(mpm_scene *s, const site *of) {
  int64_t ids[MOST], count = 0;
  const mps_view x = mpm_scene_view(s, "position"), id = mpm_scene_view(s, "id");
  for (int64_t k = 0; k < x.shape[0]; k++)
    if (*mps_view_f64(&x, k, 1) > surface(of, *mps_view_f64(&x, k, 0)))
      ids[count++] = *mps_view_i64(&id, k, 0);
  if (count > 0) OK(mps_particles_remove(s->particles, ids, count));
}

static void add_sand(scene *x, const site *of) {
  int64_t ids[MOST], count;
  const double lo[2] = {-1e9, 0.5 * of->height}, hi[2] = {1e9, 1e9};
  DEF(material_mohr_coulomb, law, .young = 0.5 * field_young(VS), .poisson = FIELD_NU,
      .friction = 35.0 * PI / 180.0, .cohesion = 5000.0);
  OK(mps_material_create_mohr_coulomb(context, &law, &x->sand));
  OK(mps_particles_select_box(x->s.particles, lo, hi, MOST, &count, ids));
  OK(mps_mpm_set_material(x->s.mpm, x->sand, ids, count));
}

/* A free block of 2 x 1 m that comes down on the ground. */
static void add_block(scene *x, const site *of) {
  DEF(body, given, .motion = MPS_BODY_MOTION_FREE, .position[0] = 0.5 * WIDTH + 0.1,
      .position[1] = of->height + 0.5, .mass = 3000.0, .inertia[2] = 3000.0 * 5.0 / 12.0,
      .gravity[1] = -GRAVITY);
  OK(mps_body_create_box(context, &given, 2.0, 1.0, &x->block));
  mpm_scene_contact(&x->s, x->block, 0.5);
}

static void set_sides(scene *x, const site *of) {
  if (of->way > 0.0 && !x->motion) x->motion = to_and_fro(of);
  const field_ground sides = {
      .sides = MPS_BOUNDARY_FREE_FIELD, .base = MPS_BOUNDARY_HELD, .motion = x->motion};
  field_set_sides(&x->s, &sides);
}

/* Ground at rest between free-field sides. */
static scene begin(const site *of) {
  scene x = {.s = mpm_scene_begin(context, of->spacing, 0.0, 0.0, field_young(VS))};
  mpm_scene_box(&x.s, 0.0, 0.0, WIDTH, of->height + (of->what == HILL ? 1.0 : 0.0));
  shape(&x.s, of);
  OK(mps_particles_set(x.s.particles, "density", 0, FIELD_RHO));
  if (!of->weightless) mpm_scene_weigh(&x.s, FIELD_RHO * GRAVITY, FIELD_K0, of->height);
  DEF(mpm, def, .cell = 2.0 * of->spacing, .lower[0] = 0.0, .upper[0] = WIDTH, .lower[1] = 0.0,
      .gravity[1] = of->weightless ? 0.0 : -GRAVITY, .budget = !of->wet);
  OK(mps_mpm_create(context, x.s.particles, x.s.material, &def, &x.s.mpm));
  if (of->wet)
    USING(pore_water, mps_mpm_add_pore_water(x.s.mpm, &given), .porosity = 0.4, .bulk = 2.2e9);
  if (of->layers) add_sand(&x, of);
  mpm_scene_side(&x.s, MPS_SIDE_Y_LOWER, MPS_BOUNDARY_HELD, 0.0);
  mpm_scene_side(&x.s, MPS_SIDE_X_LOWER, MPS_BOUNDARY_ROLLER, 0.0);
  mpm_scene_side(&x.s, MPS_SIDE_X_UPPER, MPS_BOUNDARY_ROLLER, 0.0);
  if (!of->weightless) OK(mps_mpm_settle(x.s.mpm, NULL, NULL));
  if (of->what == BLOCK) add_block(&x, of);
  set_sides(&x, of);
  return x;
}

/* ---- shaken ---------------------------------------------------------------------------------- */

/* Largest difference between velocities of ground beside the sides and of level ground there. */
static double differ(scene *x, scene *level, double *fastest) {
  const mps_view at = mpm_scene_view(&x->s, "position"), v = mpm_scene_view(&x->s, "velocity");
  const mps_view of = mpm_scene_view(&level->s, "velocity");
  double most = 0.0;
  for (int64_t k = 0; k < at.shape[0]; k++) {
    const double place[2] = {*mps_view_f64(&at, k, 0), *mps_view_f64(&at, k, 1)};
    if (place[0] > BESIDE && place[0] < WIDTH - BESIDE) continue;
    const int64_t m =
        mps_particles_index(level->s.particles, mps_particles_nearest(level->s.particles, place));
    for (int c = 0; c < 2; c++) {
      most = fmax(most, fabs(*mps_view_f64(&v, k, c) - *mps_view_f64(&of, m, c)));
      *fastest = fmax(*fastest, fabs(*mps_view_f64(&of, m, c)));
    }
  }
  return most;
}

/* Part of the energy that the budget does not explain. */
static double residual(scene *x) {
  mps_mpm_energy_report report;
  OK(mps_mpm_get_energy_report(x->s.mpm, &report));
  const mps_totals t = mpm_scene_totals(&x->s);
  return fabs(report.residual) /
         (t.kinetic + fabs(t.work_boundaries) + fabs(t.work_loads) + fabs(report.transfer));
}

static void shake(const site *of) {
  site bare = *of;
  bare.what = NOTHING;
  scoped_scene x = begin(of), level = begin(&bare);
  const int64_t count = mps_particles_count(x.s.particles);
  const double mass = mpm_scene_totals(&x.s).mass, T = period_of(of);
  double apart = 0.0, fastest = 0.0;
  for (int n = 1; n <= 60; n++) {
    OK(mps_mpm_run(x.s.mpm, 0.02 * n * T, 10000000, NULL, NULL));
    OK(mps_mpm_run(level.s.mpm, 0.02 * n * T, 10000000, NULL, NULL));
    apart = fmax(apart, differ(&x, &level, &fastest));
  }
  const double error = of->wet ? 0.0 : residual(&x);
  print_message(
      "%s, spacing %g m, %g spacings, %s%s: differs by %.2g of %.3g m/s, energy by %.1g\n",
      of->what == HILL ? "hill" : "block", of->spacing, of->way,
      of->layers ? "two layers" : "one layer", of->wet ? ", undrained" : "", apart, fastest, error);
  assert_int_equal(mps_particles_count(x.s.particles), count);
  NEAR(mpm_scene_totals(&x.s).mass, mass, 1e-12 * mass);
  assert_true(fastest > 0.4);
  assert_true(apart < 0.03 * fastest);
  assert_true(error < 1e-11);
}

/* Where particles were stopped at the sides the last one differed by 0.09. */
TEST(ground_beside_a_structure_moves_as_the_free_field) {
  static const site sites[] = {
      {0.5, 4.0, 1.3, BLOCK, true, false, false},    {0.5, 4.0, 3.4, BLOCK, true, true, false},
      {0.5, 4.0, 3.4, HILL, false, false, false},    {0.5, 4.0, 1.3, HILL, true, true, false},
      {0.375, 3.75, 3.4, BLOCK, true, false, false}, {0.375, 3.75, 1.3, HILL, false, true, false},
      {0.375, 3.75, 3.4, HILL, true, false, false},  {0.25, 4.0, 3.4, HILL, true, false, false}};
  for (size_t q = 0; q < sizeof sites / sizeof *sites; q++) shake(&sites[q]);
}

/* ---- at rest --------------------------------------------------------------------------------- */

/* Also of the columns, which are made of ground that has it. */
TEST(noise_decays) {
  for (int q = 0; q < 8; q++) {
    static const double spacing[] = {0.5, 0.375, 0.25};
    const site of = {spacing[q % 3], q % 3 == 1 ? 3.75 : 4.0, 0.0, NOTHING, q / 2 % 2, q % 2, true};
    scoped_scene x = begin(&of);
    EDIT(v, x.s.particles, "velocity")
      for (int64_t k = 0; k < v.view.shape[0]; k++)
        for (int c = 0; c < 2; c++)
          *mps_edit_f64(&v, k, c) = 1e-9 * sin(12.9898 * (double)(2 * k + c));
    set_sides(&x, &of);
    const double first = mpm_scene_totals(&x.s).kinetic;
    OK(mps_mpm_run(x.s.mpm, 0.5, 10000000, NULL, NULL));
    const double last = mpm_scene_totals(&x.s).kinetic;
    print_message("spacing %g m, %s%s: %.1g of the energy is left\n", of.spacing,
                  of.layers ? "two layers" : "one layer", of.wet ? ", undrained" : "",
                  last / first);
    assert_true(last < 0.1 * first);
  }
}

/* ---- what does not pass ---------------------------------------------------------------------- */

/* A lump that flies to a side above the ground does not come in at the other. */
TEST(lump_above_the_ground_is_stopped) {
  for (int q = 0; q < 3; q++) {
    const double spacing = 0.5 - 0.125 * q, height = q == 1 ? 3.75 : 4.0;
    scoped_mpm_scene s = mpm_scene_begin(context, spacing, 0.0, 0.0, field_young(VS));
    mpm_scene_box(&s, 0.0, 0.0, WIDTH, height);
    mpm_scene_box(&s, WIDTH - 5.0, height + 5.0 * spacing, WIDTH - 3.0, height + 9.0 * spacing);
    OK(mps_particles_set(s.particles, "density", 0, FIELD_RHO));
    DEF(mpm, def, .cell = 2.0 * spacing, .lower[0] = 0.0, .upper[0] = WIDTH, .lower[1] = 0.0);
    OK(mps_mpm_create(context, s.particles, s.material, &def, &s.mpm));
    const mps_view first = mpm_scene_view(&s, "position");
    EDIT(v, s.particles, "velocity")
      for (int64_t k = 0; k < v.view.shape[0]; k++)
        *mps_edit_f64(&v, k, 0) = *mps_view_f64(&first, k, 1) > height ? 20.0 : 0.0;
    const field_ground sides = {.sides = MPS_BOUNDARY_FREE_FIELD, .base = MPS_BOUNDARY_HELD};
    field_set_sides(&s, &sides);
    double nearest = INFINITY, reach = -INFINITY;
    for (int n = 1; n <= 10; n++) {
      OK(mps_mpm_run(s.mpm, 0.03 * n, 10000000, NULL, NULL));
      const mps_view x = mpm_scene_view(&s, "position");
      for (int64_t k = 0; k < x.shape[0]; k++) {
        if (*mps_view_f64(&x, k, 1) < height) continue;
        nearest = fmin(nearest, *mps_view_f64(&x, k, 0));
        reach = fmax(reach, *mps_view_f64(&x, k, 0));
      }
    }
    print_message("spacing %g m: lump from %.2f to %.2f m\n", spacing, nearest, reach);
    assert_true(reach > WIDTH - 0.1);
    assert_true(nearest > WIDTH - 5.0);
  }
}

/* Nor does level ground that is denser at one side. */
TEST(ground_of_two_densities_is_stopped) {
  scoped_mpm_scene s = mpm_scene_begin(context, 0.25, 0.0, 0.0, field_young(VS));
  mpm_scene_box(&s, 0.0, 0.0, 4.0, 2.0);
  OK(mps_particles_add_field(s.particles, "density", 0));
  const mps_view at = mpm_scene_view(&s, "position"), id = mpm_scene_view(&s, "id");
  bool dense[MOST] = {false};
  EDIT(rho, s.particles, "density")
    for (int64_t k = 0; k < at.shape[0]; k++) {
      const bool is = *mps_view_f64(&at, k, 0) > 2.0;
      dense[*mps_view_i64(&id, k, 0)] = is;
      *mps_edit_f64(&rho, k, 0) = is ? 1.1 * FIELD_RHO : FIELD_RHO;
    }
  DEF(mpm, def, .cell = 0.5, .lower[0] = 0.0, .upper[0] = 4.0, .lower[1] = 0.0);
  OK(mps_mpm_create(context, s.particles, s.material, &def, &s.mpm));
  EDIT(v, s.particles, "velocity")
    for (int64_t k = 0; k < v.view.shape[0]; k++) *mps_edit_f64(&v, k, 0) = 1.0;
  const field_ground sides = {.sides = MPS_BOUNDARY_FREE_FIELD, .base = MPS_BOUNDARY_ROLLER};
  field_set_sides(&s, &sides);
  OK(mps_mpm_run(s.mpm, 0.3, 10000000, NULL, NULL));
  const mps_view x = mpm_scene_view(&s, "position"), ids = mpm_scene_view(&s, "id");
  for (int64_t k = 0; k < x.shape[0]; k++)
    if (dense[*mps_view_i64(&ids, k, 0)]) assert_true(*mps_view_f64(&x, k, 0) > 1.0);
}
