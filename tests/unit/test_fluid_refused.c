/* test_fluid_refused.c - calls that are refused change nothing: reactions, fields, what later steps
 * find.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "test_allocator.h"
#include "test_fixture.h"

#include "fluid_tank.h"

#define L0 0.02
#define MOST 4096

/* What a caller reads of a fluid with `n` particles. */
typedef struct reading {
  mps_reaction wall[3];
  mps_fluid_report report;
  double position[MOST][2], rise[MOST], surface[MOST];
} reading;

/* A plain copy of fields and reactions, in memory that is 0 before. */
static reading *read_all(mps_fluid *fluid) {
  reading *out = calloc(1, sizeof *out);
  mps_particles *set = mps_fluid_particles(fluid);
  const int64_t n = mps_particles_count(set);
  assert_true(n <= MOST);
  for (int32_t b = 0; b < 3; b++) OK(mps_fluid_get_reaction(fluid, b, &out->wall[b]));
  OK(mps_fluid_get_report(fluid, &out->report));
  out->report.bytes = 0; /* a refused step may have grown its lists of neighbours */
  mps_view x = view_field(set, "position");
  mps_view rise = view_field(set, "surface_rise");
  mps_view surface = view_field(set, "free_surface");
  for (int64_t i = 0; i < n; i++) {
    for (int32_t c = 0; c < 2; c++) out->position[i][c] = *mps_view_f64(&x, i, c);
    out->rise[i] = *mps_view_f64(&rise, i, 0);
    out->surface[i] = (double)*mps_view_i64(&surface, i, 0);
  }
  return out;
}

static void assert_as_before(mps_fluid *fluid, reading *before) {
  reading *now = read_all(fluid);
  assert_memory_equal(now, before, sizeof *now);
  free(now), free(before);
}

static void kick(void *user, double *x, double *u) {
  x[0] += 0.1 * L0 * sin(400.0 * x[0] * x[1]), x[1] += 0.1 * L0 * cos(300.0 * x[0]);
}

static tank moving_tank(void) {
  tank t = tank_of(context, 0.4, 0.2, L0, 2e-3, NULL, kick, NULL);
  OK(mps_fluid_step(t.fluid, 5));
  return t;
}

/* Fields are being edited: the step, in one or in parts, is refused before it begins. */
TEST(a_step_that_does_not_begin_leaves_reactions) {
  scoped_tank t = moving_tank();
  reading *before = read_all(t.fluid);
  mps_edit u;
  OK(mps_particles_edit(t.water, "velocity", &u));
  assert_int_equal(mps_fluid_step(t.fluid, 1), MPS_ERROR_STATE);
  assert_int_equal(mps_fluid_begin_step(t.fluid, NAN), MPS_ERROR_STATE);
  OK(mps_particles_abandon(t.water, &u));
  assert_true(before->wall[TANK_BED].force[1] > 700.0);
  assert_as_before(t.fluid, before);
}

static mps_status take(void *user, const mps_linear_matrix *matrix) { return MPS_OK; }

static mps_status refuse(void *user, const double *b, double tolerance, double *x,
                         mps_linear_result *result) {
  return MPS_ERROR_NUMERIC;
}

/* The step fails where it solves for the pressure, when loads have been read and walls driven. */
TEST(a_step_that_fails_leaves_reactions_and_loads) {
  mps_particles_def set = mps_particles_defaults();
  mps_fluid_def def = mps_fluid_defaults();
  tank t;
  double x[3] = {0.2, 0.0, 0.0}, before, after;
  set.spacing = L0, def.dt = 2e-3;
  MAKE(signal, sine, create_sine, context, MPS_SIGNAL_QUANTITY_VALUE, 5.0, 1.0, 0.0);
  OK(mps_particles_create(context, &set, &t.water));
  tank_fill(t.water, 0.4, 0.2, NULL, NULL);
  OK(mps_fluid_create(context, t.water, &def, &t.fluid));
  tank_wall(t.fluid, 0.0, 0.0, 0.0, 1.0, NULL);
  tank_wall(t.fluid, 0.0, 0.0, 1.0, 0.0, NULL);
  tank_wall(t.fluid, 0.4, 0.0, -1.0, 0.0, NULL);
  DEF(fluid_load, load, .all = 1, .acceleration[1] = 5.0, .signal[1] = sine);
  OK(mps_fluid_add_load(t.fluid, &load, NULL));
  OK(mps_fluid_step(t.fluid, 5));
  USING(
      linear_solver,
      mps_solver_set_linear_solver(mps_fluid_solver(t.fluid), MPS_LINEAR_EQUATION_PRESSURE, &given),
      .matrix = take, .solve = refuse);
  OK(mps_fluid_get_pressure(t.fluid, TANK_BED, 1, x, &before));
  reading *all = read_all(t.fluid);
  assert_int_equal(mps_fluid_step(t.fluid, 1), MPS_ERROR_NUMERIC);
  OK(mps_fluid_get_pressure(t.fluid, TANK_BED, 1, x, &after));
  assert_true(before == after);
  assert_as_before(t.fluid, all);
  tank_free(&t);
}

/* After an insertion the surface's fields are not known: a refused reading does not write them. */
TEST(a_refused_pressure_writes_no_field) {
  scoped_tank t = moving_tank();
  const double added[2] = {0.2, 0.3}, off[6] = {0.2, 0.0, 0.0, 0.2, 0.1, 0.0};
  double p[2] = {-1.0, -1.0};
  OK(mps_particles_append(t.water, 1, added));
  reading *before = read_all(t.fluid);
  assert_int_equal(mps_fluid_get_pressure(t.fluid, TANK_BED, 2, off, p), MPS_ERROR_ARGUMENT);
  assert_true(p[0] == -1.0 && p[1] == -1.0);
  assert_as_before(t.fluid, before);
}

/* Levels after a fill that memory has refused are those of before, bit for bit. */
TEST(a_refused_insertion_leaves_the_surface) {
  mps_context *const usual = context;
  test_allocator allocator = {0};
  context = test_allocator_context(&allocator);
  tank t = moving_tank();
  const double lower[2] = {0.0, 0.3}, upper[2] = {0.4, 1.3}, station[3] = {0.05, 0.2, 0.33};
  double before[3], after[3];
  OK(mps_fluid_get_levels(t.fluid, 3, station, before));
  int refused = 0;
  for (mps_status status = MPS_ERROR_MEMORY; status != MPS_OK;) {
    reading *all = read_all(t.fluid);
    allocator.refuse_at = allocator.calls + ++refused;
    status = mps_particles_fill_box(t.water, lower, upper, NULL);
    allocator.refuse_at = 0;
    if (status == MPS_OK) {
      free(all);
      break;
    }
    assert_int_equal(status, MPS_ERROR_MEMORY);
    OK(mps_fluid_get_levels(t.fluid, 3, station, after));
    assert_memory_equal(before, after, sizeof before);
    assert_as_before(t.fluid, all);
  }
  assert_true(refused > 3);
  tank_free(&t);
  mps_context_destroy(&context);
  assert_int_equal(allocator.live, 0);
  context = usual;
}
