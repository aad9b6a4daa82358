/* test_pore_solver.c - the solution for implicit pore pressures: the coarse equation is that of the
 * matrix, iterations hardly grow with the number of cells, a solver of the caller gives the same
 * pressures, and the report. SPDX-License-Identifier: BSD-3-Clause */
#include "mpm_scene.h"
#include "test_fixture.h"

#include "conjugate.h"
#include "mpm/base/mpm_solver.h"
#include "mpm/water/solve/coarse.h"
#include "mpm/water/solve/operator.h"

#include <mps/pore_solver.h>

#include <string.h>

#define YOUNG 1e6
#define MODULUS (YOUNG * 0.7 / (1.3 * 0.4)) /* Pa, M' */

/* Ground between rollers, `cells` wide of 1 m and `high` of these, under an undrained load whose
 * pressures are not in equilibrium. */
static mpm_scene begin(int32_t geometry, int cells, double high, double stiffness) {
  const int dim = geometry == MPS_MPM_GEOMETRY_SPACE ? 3 : 2;
  const double h = 1.0 / cells, lo[3] = {0.0, 0.0, 0.0}, hi[3] = {1.0, high * h, 1.0};
  mpm_scene s = mpm_scene_begin_in(context, dim, 0.5 * h, 0.0, 0.0, YOUNG);
  mps_mpm_def def = mps_mpm_defaults();
  mps_pore_water_def water = mps_pore_water_defaults();
  mps_assert_ok(context, mps_particles_fill_box(s.particles, lo, hi, NULL));
  mps_assert_ok(context, mps_particles_set(s.particles, "density", 0, 2000.0));
  def.geometry = geometry;
  def.cell = h, def.courant = 0.5;
  for (int c = 0; c < dim; c++) def.lower[c] = 0.0;
  mps_assert_ok(context, mps_mpm_create(context, s.particles, s.material, &def, &s.mpm));
  water.scheme = MPS_PORE_SCHEME_IMPLICIT;
  water.porosity = 0.4;
  water.bulk = 0.4 * stiffness * MODULUS;
  water.permeability = 1e-4;
  mps_assert_ok(context, mps_mpm_add_pore_water(s.mpm, &water));
  mps_assert_ok(context, mps_particles_set(s.particles, "pore_pressure", 0, 1e3));
  mps_assert_ok(context, mps_particles_set(s.particles, "stress", 1, -1e3));
  return s;
}

/* ---- the coarse equation --------------------------------------------------------------------- */

static int tile_of(int k) { return ((k >> 8 & 1) << 2) | ((k >> 5 & 1) << 1) | (k >> 2 & 1); }

/* Sums of a vector over the unknowns of each tile, to sum[blocks * tiles]. */
static void sum_tiles(mps_mpm *mpm, const double *vector, double *sum) {
  const mpsi_pore_coarse *c = mpm->water->system->coarse;
  memset(sum, 0, (size_t)(c->blocks * c->tiles) * sizeof *sum);
  for (int64_t g = 0; g < mpm->grid.node_count; g++)
    for (int k = 0; k < mpm->grid.block_nodes; k++) {
      const int64_t cell = mpsi_first_node(&mpm->grid, g) + k;
      if (mpsi_pore_is_unknown(mpm->water, g, k, mpm->water->cell + cell - k))
        sum[c->number[g] * c->tiles + tile_of(k)] += vector[cell];
    }
}

/* Cells with a pressure of their own by the particles after the step's motion; the equation is of
 * those before it. */
static int64_t count_unknowns(mps_mpm *mpm) {
  int64_t count = 0;
  for (int64_t g = 0; g < mpm->grid.node_count; g++) {
    const mpsi_pore_cell *cell = mpm->water->cell + mpsi_first_node(&mpm->grid, g);
    for (int k = 0; k < mpm->grid.block_nodes; k++)
      count += mpsi_pore_is_unknown(mpm->water, g, k, cell);
  }
  return count;
}

/* The pressure 1 in one tile. */
static void set_direction(mps_mpm *mpm, int64_t b, int t) {
  mpsi_pore_system *s = mpm->water->system;
  for (int64_t g = 0; g < mpm->grid.node_count; g++)
    for (int k = 0; k < mpm->grid.block_nodes; k++) {
      const int64_t cell = mpsi_first_node(&mpm->grid, g) + k;
      const bool unknown = mpsi_pore_is_unknown(mpm->water, g, k, mpm->water->cell + cell - k);
      s->direction[cell] = unknown && s->coarse->number[g] == b && tile_of(k) == t ? 1.0 : 0.0;
    }
}

/* Each row of E is A times the pressure 1 in its tile, summed over tiles, and its entries are all
 * there is. */
static void compare_coarse(int32_t geometry, int cells, double high) {
  enum { MOST = 2000 };
  static double sum[MOST];
  mpm_scene s = begin(geometry, cells, high, 200.0);
  mps_assert_ok(context, mps_mpm_step(s.mpm, 3));
  const mpsi_pore_coarse *c = s.mpm->water->system->coarse;
  assert_true(c->used && c->blocks * c->tiles <= MOST);
  assert_int_equal(count_unknowns(s.mpm), s.mpm->water->system->unknowns); /* still the same */
  double worst = 0.0;
  int64_t rows = 0;
  for (int64_t b = 0; b < c->blocks; b++)
    for (int t = 0; t < c->tiles; t++) {
      const double *row = c->row + (b * c->tiles + t) * c->beside, middle = row[c->beside / 2];
      double along, all = 0.0, total = 0.0;
      if (!(middle > 0.0)) continue;
      set_direction(s.mpm, b, t);
      mps_assert_ok(context, mpsi_pore_apply(s.mpm, "test", &along));
      sum_tiles(s.mpm, s.mpm->water->system->product, sum);
      worst = fmax(worst, fabs(sum[b * c->tiles + t] / middle - 1.0));
      for (int k = 0; k < c->beside; k++) all += row[k] * row[k];
      for (int64_t k = 0; k < c->blocks * c->tiles; k++) total += sum[k] * sum[k];
      worst = fmax(worst, fabs(all / total - 1.0));
      rows++;
    }
  print_message("E of %d tiles is Z^T A Z within %.1e\n", (int)rows, worst);
  assert_int_equal(rows, c->matrix.rows);
  assert_true(worst < 1e-11);
  mpm_scene_end(&s);
}

static void coarse_equation_is_of_matrix(void **state) {
  (void)state;
  compare_coarse(MPS_MPM_GEOMETRY_PLANE_STRAIN, 21, 15.0);
  compare_coarse(MPS_MPM_GEOMETRY_AXISYMMETRIC, 21, 15.0);
  compare_coarse(MPS_MPM_GEOMETRY_SPACE, 11, 11.0);
}

/* ---- iterations ------------------------------------------------------------------------------ */

static mps_pore_report solve(int32_t geometry, int cells, double high) {
  mps_pore_report report;
  mpm_scene s = begin(geometry, cells, high, 2000.0);
  mps_assert_ok(context, mps_mpm_step(s.mpm, 2));
  mps_assert_ok(context, mps_mpm_get_pore_report(s.mpm, &report));
  print_message("%d unknowns, %d of the coarse equation: %d iterations\n", (int)report.unknowns,
                (int)report.coarse, (int)report.iterations);
  mpm_scene_end(&s);
  return report;
}

/* With the diagonal alone they are as the number of cells along the ground. */
static void iterations_hardly_grow(void **state) {
  (void)state;
  const mps_pore_report few = solve(MPS_MPM_GEOMETRY_PLANE_STRAIN, 16, 16.0),
                        many = solve(MPS_MPM_GEOMETRY_PLANE_STRAIN, 96, 96.0);
  assert_int_equal(few.unknowns, 16 * 16);
  assert_int_equal(few.coarse, 16);
  assert_int_equal(many.coarse, 24 * 24);
  assert_true((double)many.iterations < 1.5 * (double)few.iterations);
}

/* Long ground in space: the order along its longest axis keeps the factors short. */
static void orders_by_longest_axis(void **state) {
  (void)state;
  mpm_scene s = begin(MPS_MPM_GEOMETRY_PLANE_STRAIN, 8, 160.0, 200.0);
  mps_assert_ok(context, mps_mpm_step(s.mpm, 1));
  const mpsi_envelope *e = &s.mpm->water->system->coarse->matrix;
  assert_int_equal(e->rows, 2 * 40);
  for (int64_t i = 0; i < e->rows; i++) assert_true(i - e->first[i] <= 3);
  mpm_scene_end(&s);
}

/* ---- a solver of the caller ------------------------------------------------------------------ */

typedef struct plug {
  mps_mpm *mpm; /* to be stepped from within, where given */
  int64_t rows, entries;
  const int64_t *start;
  const int32_t *column;
  const double *value;
  int matrices, solutions, forgotten;
  double asymmetry, off; /* largest |a_ij - a_ji|, and distance of a diagonal from 1 */
  double factor;         /* of the answer: 1 */
  mps_status answer;
} plug;

static double entry(const plug *p, int64_t i, int64_t j) {
  for (int64_t k = p->start[i]; k < p->start[i + 1]; k++)
    if (p->column[k] == j) return p->value[k];
  return 0.0;
}

static mps_status take_rows(void *user, int64_t all, int64_t first, int64_t rows,
                            const int64_t *start, const int32_t *column, const double *value) {
  plug *p = user;
  assert_true(first == 0 && rows == all && start[0] == 0);
  p->matrices++;
  p->rows = rows, p->entries = start[rows];
  p->start = start, p->column = column, p->value = value;
  for (int64_t i = 0; i < rows; i++) {
    p->off = fmax(p->off, fabs(entry(p, i, i) - 1.0));
    for (int64_t k = start[i]; k < start[i + 1]; k++) {
      assert_true(k == start[i] || column[k] > column[k - 1]);
      p->asymmetry = fmax(p->asymmetry, fabs(value[k] - entry(p, column[k], i)));
    }
  }
  return p->answer;
}

static mps_status times(const void *matrix, const double *x, double *y) {
  const plug *p = matrix;
  for (int64_t i = 0; i < p->rows; i++) {
    y[i] = 0.0;
    for (int64_t k = p->start[i]; k < p->start[i + 1]; k++) y[i] += p->value[k] * x[p->column[k]];
  }
  return MPS_OK;
}

static mps_status give_solution(void *user, const double *b, double tolerance, double *x,
                                int64_t *iterations) {
  plug *p = user;
  p->solutions++;
  if (p->mpm) assert_int_equal(mps_mpm_step(p->mpm, 1), MPS_ERROR_STATE);
  const mps_status status = test_conjugate(p->rows, times, p, b, tolerance, x, iterations);
  for (int64_t i = 0; i < p->rows; i++) x[i] *= p->factor;
  return status;
}

static mps_status forget(void *user) {
  ((plug *)user)->forgotten++;
  return MPS_OK;
}

static mps_pore_solver_def solver_of(plug *p) {
  mps_pore_solver_def def = mps_pore_solver_defaults();
  def.user = p;
  def.rows = take_rows, def.solve = give_solution, def.forget = forget;
  return def;
}

/* The matrix given is symmetric with a diagonal of ones, and its solution that of the library. */
static void compare_outside(int32_t geometry, int cells, double high) {
  mpm_scene s[2] = {begin(geometry, cells, high, 200.0), begin(geometry, cells, high, 200.0)};
  plug p = {.mpm = s[1].mpm, .factor = 1.0};
  const mps_pore_solver_def def = solver_of(&p);
  double worst = 0.0;
  mps_assert_ok(context, mps_mpm_set_pore_solver(s[1].mpm, &def));
  for (int k = 0; k < 2; k++) mps_assert_ok(context, mps_mpm_step(s[k].mpm, 3));
  const mps_view u[2] = {mpm_scene_view(&s[0], "pore_pressure"),
                         mpm_scene_view(&s[1], "pore_pressure")};
  for (int64_t i = 0; i < u[0].shape[0]; i++)
    worst = fmax(worst, fabs(*mps_view_f64(&u[1], i, 0) - *mps_view_f64(&u[0], i, 0)) / 1e3);
  mps_pore_report report;
  mps_assert_ok(context, mps_mpm_get_pore_report(s[1].mpm, &report));
  print_message("%d rows, %.1f entries each, asymmetry %.1e; pressures differ by %.1e\n",
                (int)p.rows, (double)p.entries / (double)p.rows, p.asymmetry, worst);
  assert_true(p.matrices == 3 && p.solutions == 3 && report.iterations > 0);
  assert_true(report.unknowns == p.rows && report.coarse == 0);
  assert_true(p.asymmetry < 1e-14 && p.off < 1e-14);
  assert_true(worst > 0.0 && worst < 1e-8);
  for (int k = 0; k < 2; k++) mpm_scene_end(&s[k]);
}

static void takes_solver_of_caller(void **state) {
  (void)state;
  compare_outside(MPS_MPM_GEOMETRY_PLANE_STRAIN, 19, 13.3);
  compare_outside(MPS_MPM_GEOMETRY_AXISYMMETRIC, 11, 13.3);
  compare_outside(MPS_MPM_GEOMETRY_SPACE, 6, 9.3);
}

/* A wrong solution and an error of a callback fail the step; a small system is the library's. */
static void refuses_wrong_solutions(void **state) {
  (void)state;
  for (int k = 0; k < 3; k++) {
    mpm_scene s = begin(MPS_MPM_GEOMETRY_PLANE_STRAIN, 6, 5.3, 200.0);
    plug p = {.factor = k == 0 ? 1.001 : 1.0, .answer = k == 1 ? MPS_ERROR_CANCELLED : MPS_OK};
    mps_pore_solver_def def = solver_of(&p);
    if (k == 2) def.least = 37;
    mps_assert_ok(context, mps_mpm_set_pore_solver(s.mpm, &def));
    const mps_status status = mps_mpm_step(s.mpm, 1);
    assert_int_equal(status, k == 0 ? MPS_ERROR_NUMERIC : k == 1 ? MPS_ERROR_CANCELLED : MPS_OK);
    assert_int_equal(p.matrices, k == 2 ? 0 : 1);
    if (k == 0) assert_non_null(strstr(mps_context_error(context)->message, "callback solve"));
    mpm_scene_end(&s);
  }
}

static void solver_is_forgotten(void **state) {
  (void)state;
  mpm_scene s = begin(MPS_MPM_GEOMETRY_PLANE_STRAIN, 4, 4.0, 200.0);
  plug p = {.factor = 1.0};
  mps_pore_solver_def def = solver_of(&p);
  mps_snapshot *then = NULL;
  mps_assert_ok(context, mps_mpm_set_pore_solver(s.mpm, &def));
  mps_assert_ok(context, mps_mpm_step(s.mpm, 1));
  assert_int_equal(p.forgotten, 0);
  mps_assert_ok(context, mps_mpm_snapshot(s.mpm, &then));
  assert_int_equal(p.forgotten, 1);
  mps_assert_ok(context, mps_mpm_rollback(s.mpm, then));
  assert_int_equal(p.forgotten, 2);
  mps_snapshot_destroy(&then);
  def.solve = NULL;
  assert_int_equal(mps_mpm_set_pore_solver(s.mpm, &def), MPS_ERROR_ARGUMENT);
  def = solver_of(&p), def.least = -1;
  assert_int_equal(mps_mpm_set_pore_solver(s.mpm, &def), MPS_ERROR_ARGUMENT);
  mps_assert_ok(context, mps_mpm_step(s.mpm, 1)); /* the former one is still there */
  assert_int_equal(p.solutions, 2);
  mps_assert_ok(context, mps_mpm_set_pore_solver(s.mpm, NULL));
  mps_assert_ok(context, mps_mpm_step(s.mpm, 1));
  assert_int_equal(p.solutions, 2);
  mpm_scene_end(&s);
}

/* ---- report ---------------------------------------------------------------------------------- */

static void reports_errors(void **state) {
  (void)state;
  mps_pore_report report = {.iterations = 7};
  mpm_scene s = begin(MPS_MPM_GEOMETRY_PLANE_STRAIN, 4, 4.0, 200.0);
  assert_int_equal(mps_mpm_get_pore_report(NULL, &report), MPS_ERROR_ARGUMENT);
  assert_int_equal(mps_mpm_get_pore_report(s.mpm, NULL), MPS_ERROR_ARGUMENT);
  assert_int_equal(report.iterations, 7);
  mps_assert_ok(context, mps_mpm_get_pore_report(s.mpm, &report));
  assert_true(report.unknowns == 0 && report.iterations == 0);
  mps_assert_ok(context, mps_mpm_step(s.mpm, 1));
  mps_assert_ok(context, mps_mpm_get_pore_report(s.mpm, &report));
  assert_int_equal(report.unknowns, 16);
  assert_int_equal(report.coarse, 0); /* small */
  assert_true(report.iterations > 0 && report.iterations <= 16);
  mpm_scene_end(&s);
  s = mpm_scene_begin(context, 0.1, 0.0, 0.0, YOUNG);
  mps_mpm_def def = mps_mpm_defaults();
  def.cell = 0.2;
  mpm_scene_box(&s, 0.0, 0.0, 1.0, 1.0);
  mpm_scene_solve(&s, &def);
  assert_int_equal(mps_mpm_get_pore_report(s.mpm, &report), MPS_ERROR_STATE);
  mpm_scene_end(&s);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(takes_solver_of_caller), cmocka_unit_test(refuses_wrong_solutions),
      cmocka_unit_test(solver_is_forgotten),    cmocka_unit_test(coarse_equation_is_of_matrix),
      cmocka_unit_test(iterations_hardly_grow), cmocka_unit_test(orders_by_longest_axis),
      cmocka_unit_test(reports_errors)};
  return cmocka_run_group_tests(tests, make_context, drop_context);
}
