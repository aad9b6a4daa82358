/* A wall of water and a rigid body in soil as participants of a preCICE coupling, against a
 * stand-in of preCICE: a wall that the coupling moves as a piston has the forces of one driven by a
 * signal; a body whose mass is in the other code moves as a free body; repeated windows leave no
 * trace, bit for bit. SPDX-License-Identifier: BSD-3-Clause */
#include "mock.h"
#include "precice/block.h"
#include "precice/rigid.h"
#include "precice/wall.h"
#include "test_common.h"

#include "fluid_tank.h"

/* ---- a wall of water ------------------------------------------------------------------------- */

enum { WINDOWS = 60, VERTICES = 25 };

static const double spacing = 0.02, window = 4e-3, amplitude = 0.01; /* m, s */

typedef struct piston {
  app *a;
  mps_signal *signal;
  int windows;
  double reaction[WINDOWS + 1], sum[WINDOWS + 1]; /* N: of the wall on the water; of the vertices */
} piston;

/* A piston's displacement and velocity; in repetitions that are not kept, others. */
static void move(void *user, const char *data, double t, int right, int size, const double *x,
                 double *values) {
  const piston *p = user;
  const bool speed = strcmp(data, "Velocity") == 0;
  (void)x;
  for (int k = 0; k < size; k++) {
    const double u =
        speed ? mps_signal_velocity(p->signal, t)
              : mps_signal_displacement(p->signal, t) - mps_signal_displacement(p->signal, 0.0);
    values[2 * k] = right ? u : 0.98 * u;
    values[2 * k + 1] = 0.0;
  }
}

static void sum_forces(void *user, const char *data, double t, int right, int size,
                       const double *values) {
  piston *p = user;
  (void)data, (void)t;
  double sum = 0.0;
  for (int k = 0; k < size; k++) sum += values[2 * k];
  if (right) p->sum[p->windows] = sum;
}

static bool note_reaction(void *user, mps_fluid *fluid) {
  piston *p = user;
  mps_reaction r;
  if (!app_check(p->a, mps_fluid_get_reaction(fluid, TANK_LEFT, &r))) return false;
  p->reaction[p->windows++] = r.force[0];
  return true;
}

/* A tank of .6 x .3 m; `by`: 0 the signal, 1 a coupling by displacements, 2 with velocities. */
static piston run_tank(int by, int bends, int repetitions, double *last) {
  static double x[3 * VERTICES];
  app a;
  participant_result result;
  assert_true(app_start(&a, "test", 1));
  piston p = {.a = &a};
  OK(mps_signal_create_sine(a.context, MPS_SIGNAL_QUANTITY_DISPLACEMENT, 2.5, amplitude,
                            1.5707963267948966, &p.signal));
  tank t = tank_make(a.context, 0.6, 0.3, spacing, by ? NULL : p.signal, 0.5 * window);
  for (int k = 0; k < VERTICES; k++) x[3 * k + 1] = (k + 0.5) * spacing;
  wall_def def = {.config = PRECICE_CONFIG,
                  .name = "Solid",
                  .mesh = "Solid-Mesh",
                  .displacement = "Displacement",
                  .velocity = by == 2 ? "Velocity" : NULL,
                  .force = "Force",
                  .number = TANK_LEFT,
                  .bends = bends,
                  .count = VERTICES,
                  .x = x,
                  .normal = {1.0, 0.0, 0.0},
                  .area = spacing,
                  .dt = 1.0,
                  .each = note_reaction,
                  .user = &p};
  if (bends) {
    DEF(fluid_boundary, wall, .kind = MPS_BOUNDARY_ROLLER, .normal[0] = 1.0, .nodes = x,
        .node_count = VERTICES);
    OK(mps_fluid_set_boundary(t.fluid, TANK_LEFT, &wall));
  }
  mock = (mock_def){.window = window,
                    .windows = WINDOWS,
                    .repetitions = repetitions,
                    .give = move,
                    .take = sum_forces,
                    .user = &p};
  if (by) {
    assert_true(wall_run(&a, t.fluid, &def, &result));
    if (mock_was.wrong) fail_msg("preCICE refuses: %s", mock_was.wrong);
    assert_int_equal(result.windows, WINDOWS);
    assert_int_equal(result.steps, 2 * WINDOWS * repetitions);
    assert_int_equal(result.repeats, WINDOWS * (repetitions - 1));
  } else
    for (int k = 0; k < WINDOWS; k++) {
      OK(mps_fluid_step(t.fluid, 2));
      assert_true(note_reaction(&p, t.fluid));
    }
  mps_view view;
  OK(mps_particles_view(t.water, "position", &view));
  for (int k = 0; k < 450; k++)
    for (int c = 0; c < 2; c++) last[2 * k + c] = *mps_view_f64(&view, k, c);
  mps_fluid_destroy(&t.fluid);
  mps_particles_destroy(&t.water);
  mps_signal_destroy(&p.signal);
  mps_context_destroy(&a.context);
  return p;
}

/* Largest difference of the reactions (relative to the hydrostatic force) and of positions (in
 * spacings). */
static void compare(const piston *p, const double *x, const piston *q, const double *y,
                    double *force, double *position) {
  *force = *position = 0.0;
  for (int k = 2; k < WINDOWS; k++)
    *force = fmax(*force, fabs(p->reaction[k] - q->reaction[k]) / (0.5 * 9810.0 * 0.09));
  for (int k = 0; k < 900; k++) *position = fmax(*position, fabs(x[k] - y[k]) / spacing);
}

TEST(a_coupled_wall_is_a_piston) {
  static double x[3][900], y[900];
  double force, position;
  const piston driven = run_tank(0, 0, 1, x[0]);
  double least = INFINITY, most = -INFINITY;
  for (int k = 2; k < WINDOWS; k++)
    least = fmin(least, driven.reaction[k]), most = fmax(most, driven.reaction[k]);
  print_message("driven: %.4g to %.4g N\n", least, most);
  assert_true(most - least > 0.1 * 0.5 * 9810.0 * 0.09); /* it makes waves */
  const piston moved = run_tank(1, 0, 1, x[1]);
  compare(&driven, x[0], &moved, x[1], &force, &position);
  print_message("by displacements: forces differ by %.2g, positions by %.2g spacings\n", force,
                position);
  assert_true(force < 1e-7 && position < 1e-7);
  const piston given = run_tank(2, 0, 1, x[2]); /* velocities at the end of a step, not its mean */
  compare(&driven, x[0], &given, x[2], &force, &position);
  print_message("with velocities: forces differ by %.2g, positions by %.2g spacings\n", force,
                position);
  assert_true(force < 0.01 && position < 0.03);
  double missing = 0.0;
  for (int k = 0; k < WINDOWS; k++)
    missing = fmax(missing, fabs(moved.sum[k] + moved.reaction[k]) / moved.reaction[k]);
  print_message("forces of the vertices: %.2g of the sum is missing\n", missing);
  assert_true(missing < 2e-3); /* where the surface is at the wall */
  const piston bent = run_tank(1, 1, 1, y);
  compare(&moved, x[1], &bent, y, &force, &position);
  print_message("by its nodes: forces differ by %.2g, positions by %.2g spacings\n", force,
                position);
  assert_true(force < 0.01 && position < 0.01);
  const piston again = run_tank(1, 0, 3, y);
  assert_memory_equal(moved.reaction, again.reaction, sizeof moved.reaction);
  assert_memory_equal(moved.sum, again.sum, sizeof moved.sum);
  assert_memory_equal(x[1], y, sizeof y);
}

/* ---- a rigid body in soil -------------------------------------------------------------------- */

enum { FALL = 600 }; /* most windows */

static double step_of_soil = 5e-4; /* s, and of the window */
static int falls = 300;            /* windows */
static const double mass = BLOCK_BOX_MASS, inertia = BLOCK_BOX_INERTIA;
static const double start[2] = {BLOCK_BOX_X, BLOCK_BOX_Y};

/* Its motion in the other code, and the force that it has received. */
typedef struct faller {
  app *a;
  mps_body *body;
  double d[2], v[2], angle, spin, force[2], moment;
  int windows;
  double path[FALL][3];
} faller;

static void corner_now(const faller *f, int k, double *x) {
  const double p = block_corner[2 * k] - start[0], q = block_corner[2 * k + 1] - start[1];
  x[0] = start[0] + f->d[0] + cos(f->angle) * p - sin(f->angle) * q;
  x[1] = start[1] + f->d[1] + sin(f->angle) * p + cos(f->angle) * q;
}

/* Velocities by the force of the last window, then positions. */
static void fall(void *user, const char *data, double t, int right, int size, const double *x,
                 double *values) {
  faller *f = user, next = *f;
  (void)data, (void)t;
  const double dt = step_of_soil;
  next.v[0] += dt * f->force[0] / mass, next.v[1] += dt * (f->force[1] / mass - 9.81);
  next.spin += dt * f->moment / inertia;
  for (int c = 0; c < 2; c++) next.d[c] += dt * next.v[c];
  next.angle += dt * next.spin;
  for (int k = 0; k < size; k++) {
    double at[2];
    corner_now(&next, k, at);
    for (int c = 0; c < 2; c++)
      values[2 * k + c] = right ? at[c] - x[2 * k + c] : 0.9 * (at[c] - x[2 * k + c]);
  }
  if (right) *f = next;
}

static void receive(void *user, const char *data, double t, int right, int size,
                    const double *values) {
  faller *f = user;
  (void)data, (void)t;
  if (!right) return;
  f->force[0] = f->force[1] = f->moment = 0.0;
  for (int k = 0; k < size; k++) {
    double at[2];
    corner_now(f, k, at);
    f->force[0] += values[2 * k], f->force[1] += values[2 * k + 1];
    f->moment += (at[0] - start[0] - f->d[0]) * values[2 * k + 1] -
                 (at[1] - start[1] - f->d[1]) * values[2 * k];
  }
}

static bool note_body(void *user, mps_mpm *mpm) {
  faller *f = user;
  mps_body_state s;
  (void)mpm;
  if (!app_check(f->a, mps_body_get_state(f->body, &s))) return false;
  const double row[3] = {s.position[0], s.position[1], s.rotation[2]};
  memcpy(f->path[f->windows++], row, sizeof row);
  return true;
}

/* The box falls onto the edge of the block and tilts; free, or by a coupling. */
static faller run_fall(int repetitions) {
  app a;
  block b;
  participant_result result;
  assert_true(app_start(&a, "test", 1));
  faller f = {.a = &a};
  assert_true(block_make(&a, step_of_soil, repetitions == 0, &b));
  f.body = b.box;
  const rigid_def coupling = {.config = PRECICE_CONFIG,
                              .name = "Solid",
                              .mesh = "Solid-Mesh",
                              .displacement = "Displacement",
                              .force = "Force",
                              .count = 4,
                              .x = block_corner,
                              .dt = 1.0,
                              .each = note_body,
                              .user = &f};
  mock = (mock_def){.window = step_of_soil,
                    .windows = falls,
                    .repetitions = repetitions,
                    .give = fall,
                    .take = receive,
                    .user = &f};
  if (repetitions > 0) {
    assert_true(rigid_run(&a, b.soil, b.box, &coupling, &result));
    if (mock_was.wrong) fail_msg("preCICE refuses: %s", mock_was.wrong);
    assert_int_equal(result.windows, falls);
    assert_int_equal(result.repeats, falls * (repetitions - 1));
  } else
    for (int k = 0; k < falls; k++) {
      OK(mps_mpm_step(b.soil, 1));
      assert_true(note_body(&f, b.soil));
    }
  block_free(&b);
  mps_context_destroy(&a.context);
  return f;
}

/* The force of a window moves the coupled body in the next one: the error is of first order in it.
 */
TEST(a_coupled_body_falls_as_a_free_one) {
  static faller alone, coupled;
  double far[2] = {0.0, 0.0}, turned[2] = {0.0, 0.0};
  for (int half = 0; half < 2; half++) {
    step_of_soil = half ? 2.5e-4 : 5e-4, falls = half ? 600 : 300;
    alone = run_fall(0);
    coupled = run_fall(1);
    for (int k = 0; k < falls; k++) {
      const double *x = alone.path[k], *y = coupled.path[k];
      far[half] = fmax(far[half], hypot(x[0] - y[0], x[1] - y[1]));
      turned[half] = fmax(turned[half], fabs(x[2] - y[2]));
    }
    const double *end = alone.path[falls - 1];
    print_message("free body: %.4g m, %.4g m, %.4g rad; coupled: %.2g m and %.2g rad off\n",
                  end[0] - start[0], end[1] - start[1], end[2], far[half], turned[half]);
    assert_true(end[1] < start[1] - 0.01 && fabs(end[2]) > 0.05);
    assert_true(far[half] < 0.015 * hypot(end[0] - start[0], end[1] - start[1]));
    assert_true(turned[half] < 0.015 * fabs(end[2]));
  }
  assert_true(far[1] < 0.7 * far[0]);
  const faller again = run_fall(3);
  assert_memory_equal(coupled.path, again.path, sizeof again.path);
}

/* Displacements that no rigid body has end the coupling. */
static void stretch(void *user, const char *data, double t, int right, int size, const double *x,
                    double *values) {
  (void)user, (void)data, (void)t, (void)right;
  for (int k = 0; k < 2 * size; k++) values[k] = 0.2 * (x[k] - start[k % 2]);
}

TEST(deformed_bodies_are_refused) {
  app a;
  mps_particles *set = NULL;
  mps_material *law = NULL;
  mps_mpm *mpm = NULL;
  mps_body *box = NULL;
  mps_particles_def particles = mps_particles_defaults();
  mps_mpm_def def = mps_mpm_defaults();
  mps_body_def body = mps_body_defaults();
  const double at[2] = {0.1, 0.1};
  participant_result result;
  faller unused = {.a = &a};
  assert_true(app_start(&a, "test", 1));
  particles.spacing = 0.025, def.cell = 0.05;
  OK(mps_particles_create(a.context, &particles, &set));
  OK(mps_particles_append(set, 1, at));
  OK(mps_particles_set(set, "density", 0, 1600.0));
  OK(mps_material_create_linear_elastic(a.context, 1e6, 0.3, &law));
  OK(mps_mpm_create(a.context, set, law, &def, &mpm));
  for (int c = 0; c < 2; c++) body.position[c] = start[c];
  OK(mps_body_create_box(a.context, &body, 0.3, 0.2, &box));
  OK(mps_mpm_add_contact(mpm, box, NULL, NULL));
  rigid_def coupling = {.config = PRECICE_CONFIG,
                        .name = "Solid",
                        .mesh = "Solid-Mesh",
                        .displacement = "Displacement",
                        .force = "Force",
                        .count = 4,
                        .x = block_corner,
                        .dt = 1.0};
  mock = (mock_def){.window = step_of_soil,
                    .windows = 3,
                    .repetitions = 1,
                    .give = stretch,
                    .take = receive,
                    .user = &unused};
  assert_false(rigid_run(&a, mpm, box, &coupling, &result));
  assert_int_equal(result.steps, 0);
  coupling.displacement = "Pressure"; /* a number a vertex */
  assert_false(rigid_run(&a, mpm, box, &coupling, &result));
  coupling.displacement = "Displacement", coupling.config = "nowhere.xml";
  assert_false(rigid_run(&a, mpm, box, &coupling, &result));
  mps_mpm_destroy(&mpm);
  mps_body_destroy(&box);
  mps_material_destroy(&law);
  mps_particles_destroy(&set);
  mps_context_destroy(&a.context);
}
