/* test_pore_solver.c - the solution for implicit pore pressures: the coarse equation is that of the
 * matrix, iterations hardly grow with the number of cells, a solver of the caller gives the same
 * pressures, and the report. SPDX-License-Identifier: BSD-3-Clause */
#include "mpm_scene.h"
#include "test_fixture.h"

#include "linear_plug.h"
#include "mpm/base/mpm_solver.h"
#include "mpm/water/solve/coarse.h"
#include "mpm/water/solve/operator.h"

#define YOUNG 1e6
#define MODULUS (YOUNG * 0.7 / (1.3 * 0.4)) /* Pa, M' */

/* Ground between rollers, `cells` wide of 1 m and `high` of these, under an undrained load whose
 * pressures are not in equilibrium. */
static mpm_scene begin(int32_t geometry, int cells, double high, double stiffness) {
  const int dim = geometry == MPS_MPM_GEOMETRY_SPACE ? 3 : 2;
  const double h = 1.0 / cells, lo[3] = {0.0, 0.0, 0.0}, hi[3] = {1.0, high * h, 1.0};
  mpm_scene s = mpm_scene_begin_in(context, dim, 0.5 * h, 0.0, 0.0, YOUNG);
  OK(mps_particles_fill_box(s.particles, lo, hi, NULL));
  OK(mps_particles_set(s.particles, "density", 0, 2000.0));
  DEF(mpm, def, .geometry = geometry, .cell = h, .courant = 0.5);
  for (int c = 0; c < dim; c++) def.lower[c] = 0.0;
  OK(mps_mpm_create(context, s.particles, s.material, &def, &s.mpm));
  USING(pore_water, mps_mpm_add_pore_water(s.mpm, &given), .scheme = MPS_PORE_SCHEME_IMPLICIT,
        .porosity = 0.4, .bulk = 0.4 * stiffness * MODULUS, .permeability = 1e-4);
  OK(mps_particles_set(s.particles, "pore_pressure", 0, 1e3));
  OK(mps_particles_set(s.particles, "stress", 1, -1e3));
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
      if (mpsi_pore_is_unknown(mpm->water, g, k))
        sum[c->number[g] * c->tiles + tile_of(k)] += vector[cell];
    }
}

/* Cells with a pressure of their own by the particles after the step's motion; the equation is of
 * those before it. */
static int64_t count_unknowns(mps_mpm *mpm) {
  int64_t count = 0;
  for (int64_t g = 0; g < mpm->grid.node_count; g++)
    for (int k = 0; k < mpm->grid.block_nodes; k++) count += mpsi_pore_is_unknown(mpm->water, g, k);
  return count;
}

/* The pressure 1 in one tile. */
static void set_direction(mps_mpm *mpm, int64_t b, int t) {
  mpsi_pore_system *s = mpm->water->system;
  for (int64_t g = 0; g < mpm->grid.node_count; g++)
    for (int k = 0; k < mpm->grid.block_nodes; k++) {
      const int64_t cell = mpsi_first_node(&mpm->grid, g) + k;
      const bool unknown = mpsi_pore_is_unknown(mpm->water, g, k);
      s->direction[cell] = unknown && s->coarse->number[g] == b && tile_of(k) == t ? 1.0 : 0.0;
    }
}

/* Each row of E is A times the pressure 1 in its tile, summed over tiles, and its entries are all
 * there is. */
static void compare_coarse(int32_t geometry, int cells, double high) {
  enum { MOST = 2000 };
  static double sum[MOST];
  scoped_mpm_scene s = begin(geometry, cells, high, 200.0);
  OK(mps_mpm_step(s.mpm, 3));
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
      OK(mpsi_pore_apply(s.mpm, "test", &along));
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
}

TEST(coarse_equation_is_of_matrix) {
  compare_coarse(MPS_MPM_GEOMETRY_PLANE_STRAIN, 21, 15.0);
  compare_coarse(MPS_MPM_GEOMETRY_AXISYMMETRIC, 21, 15.0);
  compare_coarse(MPS_MPM_GEOMETRY_SPACE, 11, 11.0);
}

/* ---- iterations ------------------------------------------------------------------------------ */

static mps_pore_report solve(int32_t geometry, int cells, double high) {
  mps_pore_report report;
  scoped_mpm_scene s = begin(geometry, cells, high, 2000.0);
  OK(mps_mpm_step(s.mpm, 2));
  OK(mps_mpm_get_pore_report(s.mpm, &report));
  print_message("%d unknowns, %d of the coarse equation: %d iterations\n", (int)report.unknowns,
                (int)report.coarse, (int)report.iterations);
  return report;
}

/* With the diagonal alone they are as the number of cells along the ground. */
TEST(iterations_hardly_grow) {
  const mps_pore_report few = solve(MPS_MPM_GEOMETRY_PLANE_STRAIN, 16, 16.0),
                        many = solve(MPS_MPM_GEOMETRY_PLANE_STRAIN, 96, 96.0);
  assert_int_equal(few.unknowns, 16 * 16);
  assert_int_equal(few.coarse, 16);
  assert_int_equal(many.coarse, 24 * 24);
  assert_true((double)many.iterations < 1.5 * (double)few.iterations);
}

/* Long ground in space: the order along its longest axis keeps the factors short. */
TEST(orders_by_longest_axis) {
  scoped_mpm_scene s = begin(MPS_MPM_GEOMETRY_PLANE_STRAIN, 8, 160.0, 200.0);
  OK(mps_mpm_step(s.mpm, 1));
  const mpsi_envelope *e = &s.mpm->water->system->coarse->matrix;
  assert_int_equal(e->rows, 2 * 40);
  for (int64_t i = 0; i < e->rows; i++) assert_true(i - e->first[i] <= 3);
}

/* ---- a solver of the caller ------------------------------------------------------------------ */

/* The matrix given is symmetric with a diagonal of ones, and its solution that of the library. */
static void compare_outside(int32_t geometry, int cells, double high) {
  SCOPED(linear_plug_drop) linear_plug p = {.fault = LINEAR_FINE};
  mpm_scene s[2] = {begin(geometry, cells, high, 200.0), begin(geometry, cells, high, 200.0)};
  const mps_linear_solver_def def = linear_plug_def(&p);
  double worst = 0.0;
  OK(mps_solver_set_linear_solver(mps_mpm_solver(s[1].mpm), MPS_LINEAR_EQUATION_PORE_PRESSURE,
                                  &def));
  for (int k = 0; k < 2; k++) OK(mps_mpm_step(s[k].mpm, 3));
  const mps_view u[2] = {mpm_scene_view(&s[0], "pore_pressure"),
                         mpm_scene_view(&s[1], "pore_pressure")};
  for (int64_t i = 0; i < u[0].shape[0]; i++)
    worst = fmax(worst, fabs(*mps_view_f64(&u[1], i, 0) - *mps_view_f64(&u[0], i, 0)) / 1e3);
  mps_pore_report report;
  OK(mps_mpm_get_pore_report(s[1].mpm, &report));
  const double asymmetry = linear_asymmetry(&p);
  print_message("%d rows, %.1f entries each, asymmetry %.1e; pressures differ by %.1e\n",
                (int)p.rows, (double)p.start[p.rows] / (double)p.rows, asymmetry, worst);
  assert_true(p.matrices == 3 && p.solutions == 3 && report.iterations > 0);
  assert_true(report.unknowns == p.rows && report.coarse == 0);
  assert_true(asymmetry < 1e-14);
  for (int64_t i = 0; i < p.rows; i++) NEAR(linear_entry(&p, i, i), 1.0, 1e-14);
  assert_true(worst > 0.0 && worst < 1e-8);
  for (int k = 0; k < 2; k++) mpm_scene_end(&s[k]);
}

TEST(takes_solver_of_caller) {
  compare_outside(MPS_MPM_GEOMETRY_PLANE_STRAIN, 19, 13.3);
  compare_outside(MPS_MPM_GEOMETRY_AXISYMMETRIC, 11, 13.3);
  compare_outside(MPS_MPM_GEOMETRY_SPACE, 6, 9.3);
}

/* ---- report ---------------------------------------------------------------------------------- */

TEST(reports_errors) {
  mps_pore_report report = {.iterations = 7};
  scoped_mpm_scene s = begin(MPS_MPM_GEOMETRY_PLANE_STRAIN, 4, 4.0, 200.0);
  assert_int_equal(mps_mpm_get_pore_report(NULL, &report), MPS_ERROR_ARGUMENT);
  assert_int_equal(mps_mpm_get_pore_report(s.mpm, NULL), MPS_ERROR_ARGUMENT);
  assert_int_equal(report.iterations, 7);
  OK(mps_mpm_get_pore_report(s.mpm, &report));
  assert_true(report.unknowns == 0 && report.iterations == 0);
  OK(mps_mpm_step(s.mpm, 1));
  OK(mps_mpm_get_pore_report(s.mpm, &report));
  assert_int_equal(report.unknowns, 16);
  assert_int_equal(report.coarse, 0); /* small */
  assert_true(report.iterations > 0 && report.iterations <= 16);
  mpm_scene_end(&s);
  s = mpm_scene_begin(context, 0.1, 0.0, 0.0, YOUNG);
  mpm_scene_box(&s, 0.0, 0.0, 1.0, 1.0);
  USING(mpm, mpm_scene_solve(&s, &given), .cell = 0.2);
  assert_int_equal(mps_mpm_get_pore_report(s.mpm, &report), MPS_ERROR_STATE);
}
