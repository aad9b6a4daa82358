/* test_elastic.c - properties of implicit elasticity that hold exactly: constant stress, rigid
 * motions and no other free ones, matrix = operator, equilibrium, rollers.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "implicit/operator/budget.h"
#include "implicit/operator/moduli.h"
#include "elastic_common.h"

#include "implicit/base/implicit_solver.h"
#include "implicit/operator/assemble.h"
#include "implicit/operator/operator.h"

#include <lapacke.h>

/* ---- bodies ---------------------------------------------------------------------------------- */

static test_body l_shape_by(mps_context *context, const mps_elastic_def *def, double nu,
                            test_method method) {
  test_body b = test_body_begin(context, 2, 0.25);
  test_body_box(&b, 0, 0, 0, 2.0, 0.75, 0);
  test_body_box(&b, 0, 0, 0, 1.0, 2.0, 0);
  test_body_finish_by(&b, 3.0, nu, def, method);
  return b;
}

static test_body l_shape(mps_context *context, const mps_elastic_def *def, double nu) {
  return l_shape_by(context, def, nu, TEST_CONSERVATIVE);
}

/* A block with a step on top of it and a slot of one cell through it. */
static test_body stepped_by(mps_context *context, const mps_elastic_def *def, double nu) {
  test_body b = test_body_begin(context, 3, 0.5);
  test_body_box(&b, 0, 0, 0, 3, 2, 1);
  test_body_box(&b, 0, 0, 0, 1.5, 2, 2);
  test_body_box(&b, 2, 0, 0, 3, 1, 2);
  test_body_finish(&b, 3.0, nu, def);
  return b;
}
static test_body stepped(mps_context *context, double nu) { return stepped_by(context, NULL, nu); }

/* ---- constant stress ------------------------------------------------------------------------- */

typedef struct affine {
  int dim;
  double gradient[3][3], stress[3][3];
} affine;

static affine affine_field(const test_body *b, double lambda, double mu) {
  affine a = {.dim = b->dim, .gradient = {{0.3, -0.2, 0.15}, {0.5, -0.4, 0.35}, {-0.1, 0.25, 0.6}}};
  double trace = 0.0;
  for (int c = 0; c < a.dim; c++) trace += a.gradient[c][c];
  for (int c = 0; c < a.dim; c++)
    for (int d = 0; d < a.dim; d++)
      a.stress[c][d] = mu * (a.gradient[c][d] + a.gradient[d][c]) + (c == d ? lambda * trace : 0.0);
  return a;
}

static mps_status affine_traction(void *user, const double *x, const double *normal,
                                  double *traction) {
  const affine *a = user;
  (void)x;
  for (int c = 0; c < a->dim; c++)
    for (int d = 0; d < a->dim; d++) traction[c] += a->stress[c][d] * normal[d];
  return MPS_OK;
}

static double affine_at(const test_body *b, const affine *a, int64_t i, int c) {
  double u = 0.0;
  for (int d = 0; d < a->dim; d++) u += a->gradient[c][d] * test_value(b, "position", i, d);
  return u;
}

static void hold(test_body *b, int component, int64_t id, double value) {
  OK(test_prescribe(b->elastic, component, 1, &id, &value));
}

/* As many supports as there are rigid motions, so that the loads must balance. */
static void hold_statically(test_body *b, const affine *a) {
  const double corner[3] = {-9, -9, -9}, far_x[3] = {9, -9, -9}, far_y[3] = {-9, 9, -9};
  const int64_t p = mps_particles_nearest(b->particles, corner);
  const int64_t q = mps_particles_nearest(b->particles, far_x);
  const int64_t r = mps_particles_nearest(b->particles, far_y);
  for (int c = 0; c < b->dim; c++) hold(b, c, p, affine_at(b, a, p, c));
  hold(b, 1, q, affine_at(b, a, q, 1));
  if (b->dim == 3) {
    hold(b, 2, q, affine_at(b, a, q, 2));
    hold(b, 2, r, affine_at(b, a, r, 2));
  }
}

static void check_patch(test_body *b, double young, double nu, int plane_stress) {
  const double mu = young / 2 / (1 + nu);
  const double lambda = nu * young / (1 + nu) / (plane_stress ? 1 - nu : 1 - 2 * nu);
  affine a = affine_field(b, lambda, mu);
  int64_t count;
  const int64_t all = mps_elastic_facet_count(b->elastic);
  int64_t *facets = malloc((size_t)all * sizeof *facets);
  OK(mps_elastic_select_facets(b->elastic, MPS_SIDE_ANY, NULL, NULL, all, &count, facets));
  assert_int_equal(count, all);
  OK(test_traction_fn(b->elastic, count, facets, affine_traction, &a));
  free(facets);
  hold_statically(b, &a);
  OK(mps_elastic_solve(b->elastic));
  OK(mps_elastic_update_stress(b->elastic));
  static const int row[6] = {0, 1, 2, 0, 2, 1}, col[6] = {0, 1, 2, 1, 0, 2};
  double worst_u = 0, worst_s = 0, worst_r = 0;
  for (int64_t i = 0; i < b->n; i++) {
    for (int c = 0; c < b->dim; c++) {
      worst_u = fmax(worst_u, fabs(test_value(b, "displacement", i, c) - affine_at(b, &a, i, c)));
      worst_r = fmax(worst_r, fabs(test_value(b, "reaction", i, c)));
    }
    for (int k = 0; k < 2 * b->dim; k++)
      if (row[k] < b->dim && col[k] < b->dim)
        worst_s = fmax(worst_s, fabs(test_value(b, "stress", i, k) - a.stress[row[k]][col[k]]));
  }
  print_message("patch test %dD: displacement %.1e, stress %.1e, reactions %.1e\n", b->dim, worst_u,
                worst_s, worst_r);
  NEAR(worst_u, 0.0, 1e-12);
  NEAR(worst_s, 0.0, 1e-12);
  NEAR(worst_r, 0.0, 1e-12);
}

TEST_SERIAL(constant_stress_is_exact_on_an_l_shape) {
  for (int plane_stress = 0; plane_stress < 2; plane_stress++) {
    DEF(elastic, def,
        .state = plane_stress ? MPS_ELASTIC_STATE_PLANE_STRESS : MPS_ELASTIC_STATE_PLANE_STRAIN);
    scoped_test_body b = l_shape(context, &def, 0.3);
    check_patch(&b, 3.0, 0.3, plane_stress);
  }
}

TEST_SERIAL(constant_stress_is_exact_on_a_stepped_block) {
  scoped_test_body b = stepped(context, 0.3);
  check_patch(&b, 3.0, 0.3, 0);
}

/* Layers of half cells along one axis, two, three: tractions on their facets balance the stress. */
TEST_SERIAL(constant_stress_is_exact_where_layers_are_cut) {
  for (int dim = 2; dim <= 3; dim++)
    for (int axes = 1; axes <= dim; axes++) {
      DEF(elastic, def, .state = MPS_ELASTIC_STATE_PLANE_STRAIN);
      scoped_test_body b = test_body_begin(context, dim, 0.25);
      test_body_box(&b, 0, 0, 0, 1.5, 1.25, dim == 3 ? 1 : 0);
      test_body_finish(&b, 3.0, 0.3, &def);
      for (int axis = 0; axis < axes; axis++) {
        int64_t count, *ids = test_select(&b, axis, -1, 0.2, &count);
        OK(mps_elastic_cut(b.elastic, mps_side_of(axis, 0), ids, count));
        free(ids);
      }
      check_patch(&b, 3.0, 0.3, 0);
    }
}

/* A block on a fixed foot, pressed down on its top; with m spacings on either side of the plane of
 * symmetry, or the right half alone, whose plane goes through a cut layer on rollers. Returns the
 * vertical displacements of the layer at the plane and of those to its right. */
static double *pressed(mps_context *context, int m, bool half, int64_t *count) {
  const double D = 1.0 / m, x0 = half ? 1.0 : 0.0, lo[2] = {x0, -1.0}, hi[2] = {9.0, 0.9 * D};
  const double top[3] = {0.0, -1e-3}, plane[2] = {1.0 + 0.4 * D, -1.0}, high[2] = {9.0, 9.0};
  scoped_test_body b = test_body_begin(context, 2, D);
  test_body_box(&b, x0, 0, 0, 2.0 + 0.9 * D, 1.0, 0);
  test_body_finish(&b, 3.0, 0.3, NULL);
  int64_t ids[512], facets[512], n;
  if (half) {
    const double edge[2] = {1.0 + 0.6 * D, 9.0}, left[2] = {-1.0, -1.0};
    OK(mps_particles_select_box(b.particles, left, edge, 512, &n, ids));
    assert_int_equal(n, m);
    OK(mps_elastic_cut(b.elastic, MPS_SIDE_X_LOWER, ids, n));
    OK(test_prescribe(b.elastic, 0, n, ids, NULL));
  }
  OK(mps_particles_select_box(b.particles, lo, hi, 512, &n, ids));
  for (int c = 0; c < 2; c++) OK(test_prescribe(b.elastic, c, n, ids, NULL));
  OK(mps_elastic_select_facets(b.elastic, MPS_SIDE_Y_UPPER, NULL, NULL, 512, &n, facets));
  OK(test_load(b.elastic, MPS_ELASTIC_LOAD_TRACTION, n, facets, top, false));
  OK(mps_elastic_solve(b.elastic));
  int64_t *seen = malloc(4096 * sizeof *seen);
  mps_view u = view_field(b.particles, "displacement");
  OK(mps_particles_select_box(b.particles, plane, high, 4096, count, seen));
  double *uy = malloc((size_t)*count * sizeof *uy);
  for (int64_t k = 0; k < *count; k++)
    uy[k] = *mps_view_f64(&u, mps_particles_index(b.particles, seen[k]), 1);
  free(seen);
  return uy;
}

/* A cut layer does not know that the body continues as its mirror image: its gradient across the
 * plane is one-sided, where the whole body's is 0 by symmetry, and it has fewer stabilising pairs.
 * The difference is that of a discretisation, and falls with the spacing (docs/elastic.md). */
TEST_SERIAL(a_half_differs_from_the_whole_by_the_discretisation) {
  double off[3];
  for (int r = 0; r < 3; r++) {
    int64_t count, of_half;
    double *whole = pressed(context, 5 << r, false, &count);
    double *half = pressed(context, 5 << r, true, &of_half), largest = 0.0;
    assert_int_equal(count, of_half);
    off[r] = 0.0;
    for (int64_t k = 0; k < count; k++) {
      largest = fmax(largest, fabs(whole[k]));
      off[r] = fmax(off[r], fabs(whole[k] - half[k]));
    }
    off[r] /= largest;
    free(whole);
    free(half);
  }
  assert_true(off[0] < 3e-3 && off[1] < 0.6 * off[0] && off[2] < 0.6 * off[1]);
}

/* ---- free motions ---------------------------------------------------------------------------- */

/* Dense K of all displacements, by the matrix-free operator. */
static double *dense(mps_elastic *e) {
  const int64_t all = e->n * e->dim;
  double *k = malloc((size_t)(all * all) * sizeof *k), *u = calloc((size_t)all, sizeof *u);
  for (int64_t c = 0; c < all; c++) {
    u[c] = 1.0;
    OK(mpsi_elastic_apply(e, __func__, u, k + c * all));
    u[c] = 0.0;
  }
  free(u);
  return k;
}

static void check_modes(test_body *b, int rigid, double gap) {
  mps_elastic *e = b->elastic;
  const int64_t all = e->n * e->dim;
  double *k = dense(e), *w = malloc((size_t)all * sizeof *w), worst = 0.0;
  for (int64_t r = 0; r < all; r++)
    for (int64_t c = 0; c < r; c++) worst = fmax(worst, fabs(k[r * all + c] - k[c * all + r]));
  assert_int_equal(LAPACKE_dsyev(LAPACK_ROW_MAJOR, 'N', 'U', (int)all, k, (int)all, w), 0);
  print_message("%dD %s: eigenvalues %.1e ... %.1e | %.3e ... %.3e, asymmetry "
                "%.1e\n",
                e->dim, e->conservative ? "conservative" : "published", w[0], w[rigid - 1],
                w[rigid], w[all - 1], worst);
  assert_true(worst < 1e-13 * w[all - 1]);
  assert_true(fabs(w[0]) < 1e-13 * w[all - 1] && fabs(w[rigid - 1]) < 1e-13 * w[all - 1]);
  assert_true(w[rigid] > gap * w[all - 1]);
  free(k);
  free(w);
}

TEST_SERIAL(rigid_motions_and_no_others_are_free) {
  mps_elastic_def def = mps_elastic_defaults();
  scoped_test_body b = l_shape(context, &def, 0.3);
  check_modes(&b, 3, 1e-3);
  test_body_end(&b);
  b = l_shape_by(context, &def, 0.3, TEST_PUBLISHED);
  check_modes(&b, 3, 1e-3);
  test_body_end(&b);
  b = stepped(context, 0.3);
  check_modes(&b, 6, 1e-3);
  test_body_end(&b);
  def = mps_elastic_defaults();
  def.bending = 1.0;
  b = l_shape(context, &def, 0.3);
  check_modes(&b, 3, 1e-3);
  test_body_end(&b);
  def = mps_elastic_defaults(); /* the weakest stabilisation that is allowed */
  def.alpha = 0.03;
  b = l_shape(context, &def, 0.0);
  check_modes(&b, 3, 1e-4);
}

/* ---- the matrix is the operator -------------------------------------------------------------- */

/* The assembled matrix against the operator, column by column, with rollers at an angle. */
static void check_matrix(test_body *b) {
  mps_elastic *e = b->elastic;
  const double slope[3] = {0.6, 0.8, 0.0}, other[3] = {0.5, -0.3, 0.7};
  const int64_t some[3] = {0, 5, b->n - 1};
  OK(test_roller(e, slope, 3, some, NULL));
  OK(test_roller(e, other, 2, some, NULL));
  OK(test_prescribe(e, 1, 1, &(int64_t){9}, NULL));
  mpsi_elastic_number(e);
  OK(mpsi_elastic_assemble(e, "test"));
  const int64_t n = e->unknowns, all = e->n * e->dim;
  double *u = malloc((size_t)all * sizeof *u), *f = malloc((size_t)all * sizeof *f);
  double *one = calloc((size_t)n, sizeof *one), *column = malloc((size_t)n * sizeof *column);
  double worst = 0.0, largest = 0.0;
  for (int64_t c = 0; c < n; c++) {
    memset(u, 0, (size_t)all * sizeof *u);
    one[c] = 1.0;
    mpsi_elastic_expand(e, one, false, u);
    one[c] = 0.0;
    OK(mpsi_elastic_apply(e, __func__, u, f));
    mpsi_elastic_reduce(e, f, column);
    assert_int_equal(e->row[e->column[c]], c);
    for (int64_t k = e->column[c]; k < e->column[c + 1]; k++) {
      assert_true(k == e->column[c] || e->row[k] > e->row[k - 1]);
      column[e->row[k]] -= e->value[k];
      largest = fmax(largest, fabs(e->value[k]));
    }
    for (int64_t r = c; r < n; r++) worst = fmax(worst, fabs(column[r]));
  }
  print_message("matrix - operator, %dD %d: %.1e of %.3g\n", e->dim, e->conservative, worst,
                largest);
  NEAR(worst, 0.0, 1e-14 * largest);
  free(u);
  free(f);
  free(one);
  free(column);
}

TEST_SERIAL(the_assembled_matrix_is_the_operator) {
  mps_elastic_def def = mps_elastic_defaults();
  test_body b = stepped(context, 0.2);
  check_matrix(&b);
  test_body_end(&b);
  const double ratio[] = {1.5, 2.1, 3.0};
  for (int k = 0; k < 6; k++) {
    def.radius_ratio = ratio[k / 2];
    b = l_shape_by(context, &def, 0.3, k % 2 ? TEST_PUBLISHED : TEST_CONSERVATIVE);
    /* A material that varies, and cells cut in half. */
    EDIT(young, b.particles, "young")
      for (int64_t i = 0; i < b.n; i++) *mps_edit_f64(&young, i, 0) = 1.0 + 0.1 * (double)(i % 7);
    OK(mpsi_elastic_renew_material(b.elastic, __func__));
    int64_t count, *ids = test_select(&b, 0, -1, 0.2, &count);
    OK(mps_elastic_cut(b.elastic, MPS_SIDE_X_LOWER, ids, count));
    free(ids);
    check_matrix(&b);
    test_body_end(&b);
  }
  /* Bending within cells: one material, then layers, joints and their corners. */
  def = mps_elastic_defaults();
  def.bending = 0.7;
  for (int k = 0; k < 4; k++) {
    b = k % 2 ? stepped_by(context, &def, 0.2) : l_shape(context, &def, 0.3);
    EDIT(young, b.particles, "young")
      for (int64_t i = 0; i < b.n; i++)
        if (k / 2 && test_value(&b, "position", i, 1) < 0.6 &&
            test_value(&b, "position", i, 0) > 0.4)
          *mps_edit_f64(&young, i, 0) = 8.0;
    OK(mpsi_elastic_renew_material(b.elastic, __func__));
    int64_t count, *ids = test_select(&b, 0, -1, 0.2, &count);
    OK(mps_elastic_cut(b.elastic, MPS_SIDE_X_LOWER, ids, count));
    free(ids);
    check_matrix(&b);
    test_body_end(&b);
  }
}

/* ---- equilibrium, rollers, orders ------------------------------------------------------------ */

TEST_SERIAL(loads_and_reactions_are_in_equilibrium) {
  for (int dim = 2; dim <= 3; dim++) {
    scoped_test_body b = dim == 2 ? l_shape(context, NULL, 0.3) : stepped(context, 0.3);
    int64_t count, *ids = test_select(&b, 1, -1, 0.3, &count);
    for (int c = 0; c < dim; c++) OK(test_prescribe(b.elastic, c, count, ids, NULL));
    OK(mps_elastic_cut(b.elastic, MPS_SIDE_Y_LOWER, ids, count));
    free(ids);
    const double gravity[3] = {0.3, -9.81, 0.7}, point[3] = {0.4, -0.7, 1.1};
    OK(test_body_force(b.elastic, gravity));
    int64_t *facets = test_facets(&b, 0, 1, &count);
    double *pressure = malloc((size_t)count * sizeof *pressure);
    for (int64_t k = 0; k < count; k++) pressure[k] = 2.0 + (double)k;
    OK(test_pressure(b.elastic, count, facets, pressure));
    free(facets);
    free(pressure);
    OK(mps_elastic_solve(b.elastic));
    double f[3], m[3], rf[3], rm[3];
    OK(mps_elastic_get_load_resultant(b.elastic, point, f, m));
    OK(test_reactions(b.elastic, point, rf, rm));
    for (int c = 0; c < dim; c++) NEAR((f[c] + rf[c]) / fabs(f[1]), 0.0, 1e-10);
    for (int c = 0; c < (dim == 2 ? 1 : 3); c++)
      NEAR((m[dim == 2 ? 2 : c] + rm[dim == 2 ? 2 : c]) / fabs(f[1]), 0.0, 1e-10);
    /* The section just above the support carries the reactions of the cut's near side. */
    double sf[3], sm[3], energy, work = 0.0;
    OK(mps_elastic_get_section(b.elastic, 1, 100.0, point, sf, sm));
    for (int c = 0; c < dim; c++) NEAR(sf[c] / fabs(f[1]), 0.0, 1e-10);
    /* Clapeyron: the strain energy is half the work of the loads. */
    OK(mpsi_elastic_strain_energy(b.elastic, __func__, &energy));
    for (int64_t i = 0; i < b.n * dim; i++)
      work += 0.5 * b.elastic->load[i] * b.elastic->displacement[i];
    NEAR(energy / work, 1.0, 1e-10);
  }
}

/* A square on a 45 degree roller below and a parallel pressure above: compression t along the
 * roller's normal gives the same displacement along it as turned supports say. */
TEST_SERIAL(a_roller_lets_particles_slide_across_only) {
  scoped_test_body b = test_body_begin(context, 2, 0.1);
  test_body_box(&b, 0, 0, 0, 1, 1, 0);
  test_body_finish(&b, 2.0, 0.25, NULL);
  const double normal[2] = {1.0, 1.0}, across[2] = {1.0, -1.0}, load[2] = {-0.3, -0.8};
  int64_t count, *ids = test_select(&b, 1, -1, 0.06, &count);
  double *values = malloc((size_t)count * sizeof *values);
  for (int64_t k = 0; k < count; k++) values[k] = 0.01 * (double)k;
  OK(test_roller(b.elastic, normal, count, ids, values));
  OK(test_roller(b.elastic, across, 1, ids, NULL));
  OK(test_body_force(b.elastic, load));
  OK(mps_elastic_solve(b.elastic));
  for (int64_t k = 0; k < count; k++) {
    const double u = test_value(&b, "displacement", ids[k], 0);
    const double v = test_value(&b, "displacement", ids[k], 1);
    NEAR((u + v) / sqrt(2.0), values[k], 1e-14);
    const double fx = test_value(&b, "reaction", ids[k], 0);
    const double fy = test_value(&b, "reaction", ids[k], 1);
    if (k > 0) NEAR(fx - fy, 0.0, 1e-12);
  }
  double f[3];
  OK(test_reactions(b.elastic, NULL, f, NULL));
  NEAR(f[0], 0.3, 1e-10);
  NEAR(f[1], 0.8, 1e-10);
  free(ids);
  free(values);
}
