/* test_elastic_joints.c - bodies of several materials: layers in any constant traction are exact,
 * composite beams, a stiff inclusion, no motions free but the rigid ones.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "implicit/operator/moduli.h"
#include "elastic_common.h"

#include "implicit/base/implicit_solver.h"
#include "implicit/operator/operator.h"

#include <lapacke.h>

/* ---- layers ---------------------------------------------------------------------------------- */

/* Two kinds of layers, normal to `axis`. The displacement gradient across the layers is
 * `tangential` everywhere; the derivative along `axis` is, in each layer, the one that gives
 * `traction`. */
typedef struct laminate {
  int dim, axis, plane_stress;
  double young[2], nu[2], joint[2]; /* layers: below joint[0], between, above joint[1] */
  double tangential[3][3], traction[3];
  double gradient[2][3][3], stress[2][3][3];
} laminate;

static int kind_at(const laminate *l, double s) { return s > l->joint[0] && s < l->joint[1]; }

static void lame(const laminate *l, int kind, double *lambda, double *mu) {
  const double e = l->young[kind], nu = l->nu[kind];
  *mu = e / 2 / (1 + nu);
  *lambda = nu * e / (1 + nu) / (l->plane_stress ? 1 - nu : 1 - 2 * nu);
}

static void solve_laminate(laminate *l) {
  for (int kind = 0; kind < 2; kind++) {
    double lambda, mu, lateral = 0.0, trace = 0.0, (*g)[3] = l->gradient[kind];
    const int a = l->axis;
    lame(l, kind, &lambda, &mu);
    memcpy(g, l->tangential, sizeof l->tangential);
    for (int t = 0; t < l->dim; t++)
      if (t != a) {
        lateral += g[t][t];
        g[t][a] = l->traction[t] / mu - g[a][t];
      }
    g[a][a] = (l->traction[a] - lambda * lateral) / (lambda + 2 * mu);
    for (int c = 0; c < l->dim; c++) trace += g[c][c];
    for (int c = 0; c < l->dim; c++)
      for (int b = 0; b < l->dim; b++)
        l->stress[kind][c][b] = mu * (g[c][b] + g[b][c]) + (c == b ? lambda * trace : 0.0);
  }
}

static double laminate_u(const laminate *l, const double *x, int c) {
  const double s = x[l->axis];
  double u = 0.0;
  for (int b = 0; b < l->dim; b++)
    if (b != l->axis) u += l->tangential[c][b] * x[b];
  const double inner = fmin(fmax(s - l->joint[0], 0.0), l->joint[1] - l->joint[0]);
  return u + l->gradient[0][c][l->axis] * (s - inner) + l->gradient[1][c][l->axis] * inner;
}

static mps_status laminate_traction(void *user, const double *x, const double *normal, double *t) {
  const laminate *l = user;
  const int kind = kind_at(l, x[l->axis]);
  for (int c = 0; c < l->dim; c++)
    for (int b = 0; b < l->dim; b++) t[c] += l->stress[kind][c][b] * normal[b];
  return MPS_OK;
}

static void fill(test_body *b, const laminate *l) {
  EDIT(young, b->particles, "young")
    EDIT(poisson, b->particles, "poisson")
      for (int64_t i = 0; i < b->n; i++) {
        const int kind = kind_at(l, test_value(b, "position", i, l->axis));
        *mps_edit_f64(&young, i, 0) = l->young[kind];
        *mps_edit_f64(&poisson, i, 0) = l->nu[kind];
      }
}

static void hold_corner(test_body *b, const laminate *l, const double *corner, int first) {
  const int64_t id = mps_particles_nearest(b->particles, corner);
  for (int c = first; c < b->dim; c++) {
    double x[3];
    for (int k = 0; k < b->dim; k++) x[k] = test_value(b, "position", id, k);
    const double value = laminate_u(l, x, c);
    OK(test_prescribe(b->elastic, c, 1, &id, &value));
  }
}

/* Loads every facet, holds what a rigid body needs. */
static void load_laminate(test_body *b, laminate *l) {
  const double corner[3] = {-9, -9, -9}, far_x[3] = {9, -9, -9}, far_y[3] = {-9, 9, -9};
  int64_t count = 0;
  const int64_t all = mps_elastic_facet_count(b->elastic);
  int64_t *facets = malloc((size_t)all * sizeof *facets);
  OK(mps_elastic_select_facets(b->elastic, MPS_SIDE_ANY, NULL, NULL, all, &count, facets));
  OK(test_traction_fn(b->elastic, count, facets, laminate_traction, l));
  free(facets);
  hold_corner(b, l, corner, 0);
  hold_corner(b, l, far_x, 1);
  if (b->dim == 3) hold_corner(b, l, far_y, 2);
}

/* Largest errors of displacement and stress, of the largest of each. */
static void compare(test_body *b, const laminate *l, double *eu, double *es) {
  static const int row[6] = {0, 1, 2, 0, 2, 1}, col[6] = {0, 1, 2, 1, 0, 2};
  double worst_u = 0, worst_s = 0, largest_u = 0, largest_s = 0;
  for (int64_t i = 0; i < b->n; i++) {
    double x[3] = {0};
    for (int k = 0; k < b->dim; k++) x[k] = test_value(b, "position", i, k);
    const int kind = kind_at(l, x[l->axis]);
    for (int c = 0; c < b->dim; c++) {
      const double u = laminate_u(l, x, c);
      worst_u = fmax(worst_u, fabs(test_value(b, "displacement", i, c) - u));
      largest_u = fmax(largest_u, fabs(u));
    }
    for (int k = 0; k < 2 * b->dim; k++) {
      if (row[k] >= b->dim || col[k] >= b->dim) continue;
      const double s = l->stress[kind][row[k]][col[k]];
      worst_s = fmax(worst_s, fabs(test_value(b, "stress", i, k) - s));
      largest_s = fmax(largest_s, fabs(s));
    }
  }
  *eu = worst_u / largest_u;
  *es = worst_s / largest_s;
}

static void check_laminate(mps_context *context, laminate *l, double radius) {
  DEF(elastic, def,
      .state = l->plane_stress ? MPS_ELASTIC_STATE_PLANE_STRESS : MPS_ELASTIC_STATE_PLANE_STRAIN,
      .radius_ratio = radius);
  scoped_test_body b = test_body_begin(context, l->dim, 0.1);
  test_body_box(&b, 0, 0, 0, 0.8, 0.8, 0.6);
  test_body_finish(&b, 1.0, 0.0, &def);
  solve_laminate(l);
  fill(&b, l);
  load_laminate(&b, l);
  OK(mps_elastic_solve(b.elastic));
  OK(mps_elastic_update_stress(b.elastic));
  double eu, es;
  compare(&b, l, &eu, &es);
  print_message("layers %dD, normal %c, E %g:1, re %g: displacement %.1e, stress %.1e\n", l->dim,
                "xyz"[l->axis], l -> young[1] / l -> young[0], radius, eu, es);
  NEAR(eu, 0.0, 1e-10);
  NEAR(es, 0.0, 1e-10);
}

TEST_SERIAL(layers_in_constant_traction_are_exact) {
  const double ratio[] = {1.0 / 3000, 3, 95, 3000};
  for (int r = 0; r < 4; r++)
    for (int dim = 2; dim <= 3; dim++)
      for (int axis = 0; axis < dim; axis++) {
        laminate l = {.dim = dim,
                      .axis = axis,
                      .plane_stress = dim == 2 && r % 2,
                      .nu = {0.35, 0.1},
                      .young = {1.0, ratio[r]},
                      .joint = {0.2, 0.3}, /* one cell thick */
                      .tangential = {{0.3, -0.2, 0.1}, {0.15, 0.25, -0.3}, {0.2, 0.1, -0.15}},
                      .traction = {0.4, -0.5, 0.3}};
        if (axis == 1) l.joint[1] = 0.5;
        check_laminate(context, &l, 1.5);
        if (dim == 2) check_laminate(context, &l, 3.0);
      }
}

/* The finding as reported: uniform tension of 1 MPa, nu = 0. */
TEST_SERIAL(a_bar_in_series_carries_its_load_everywhere) {
  const double ratio[] = {3, 95, 3000};
  for (int r = 0; r < 3; r++) {
    laminate l = {.dim = 2,
                  .plane_stress = 1,
                  .young = {1e9, ratio[r] * 1e9},
                  .joint = {0.4, 9.0},
                  .traction = {1e6, 0, 0}};
    check_laminate(context, &l, 1.5);
  }
}

/* Beside one another along the load the layers share the strain. */
TEST_SERIAL(layers_in_parallel_share_the_strain) {
  for (int dim = 2; dim <= 3; dim++) {
    laminate l = {.dim = dim,
                  .axis = 1,
                  .plane_stress = dim == 2,
                  .young = {1, 3000},
                  .nu = {0.3, 0.3},
                  .joint = {0.3, 0.6},
                  .tangential = {{1e-3, 0, 0}}};
    if (dim == 3) l.tangential[2][2] = -0.3e-3;
    check_laminate(context, &l, 1.5);
    for (int kind = 0; kind < 2; kind++) {
      NEAR(l.stress[kind][0][0] / l.young[kind] / 1e-3, 1.0, 1e-12);
      NEAR(l.gradient[kind][1][1] / 0.3e-3, -1.0, 1e-12);
    }
  }
}

/* ---- composite cantilevers ------------------------------------------------------------------- */

typedef struct beam {
  double length, depth, nu;
  double joint;      /* distance from the wall, where the two lie along the length */
  double split;      /* part of the depth that is below, where they lie above one another */
  double bending;    /* of mps_elastic_def */
  double young[2];   /* below and above the split, or near and far from the wall */
  bool along_length; /* how the two lie */
} beam;

/* Bending and shear flexibility of a section of two layers, unit width: 1/EI and
 * (int q^2/G dy)/P^2, q = P/EI int E (y - y0) dy by 20000 slices. */
static void section(const double *young, double split, double nu, double h, double *bend,
                    double *shear) {
  const int slices = 20000;
  const double dy = h / slices;
  double area = 0, first = 0, inertia = 0, flow = 0, sum = 0;
  for (int pass = 0; pass < 2; pass++)
    for (int k = 0; k < slices; k++) {
      const double e = young[k >= (int)lround(slices * split)], y = (k + 0.5) * dy - 0.5 * h;
      if (pass == 0) {
        area += e * dy;
        first += e * y * dy;
        inertia += e * y * y * dy;
        continue;
      }
      const double y0 = first / area, ei = inertia - first * y0;
      flow += 0.5 * e * (y - y0) * dy;
      sum += flow * flow / (ei * ei) * 2 * (1 + nu) / e * dy;
      flow += 0.5 * e * (y - y0) * dy;
    }
  *bend = 1.0 / (inertia - first * first / area);
  *shear = sum;
}

/* Timoshenko: deflection of the end under a unit force there. */
static double beam_theory(const beam *q) {
  double deflection = 0.0, bend, shear;
  for (int part = 0; part < 2; part++) {
    const double e = q->young[part], both[2] = {e, e};
    const double far = part ? 0.0 : q->length - q->joint;
    const double near = part ? q->length - q->joint : q->length; /* distances from the end */
    section(q->along_length ? both : q->young, q->split, q->nu, q->depth, &bend, &shear);
    deflection += (near * near * near - far * far * far) / 3 * bend + (near - far) * shear;
  }
  return deflection;
}

static mps_status end_shear(void *user, const double *x, const double *normal, double *traction) {
  traction[1] = 1.0 / *(const double *)user;
  return MPS_OK;
}

static double beam_error(mps_context *context, const beam *q, int cells) {
  const double h = q->depth / cells, wall = 0.5 * h;
  test_body b = test_body_begin(context, 2, h);
  test_body_box(&b, 0, 0, 0, q->length + wall, q->depth, 0);
  DEF(elastic, def, .bending = q->bending);
  test_body_finish(&b, 1.0, q->nu, &def);
  EDIT(young, b.particles, "young")
    for (int64_t i = 0; i < b.n; i++) {
      const double x = test_value(&b, "position", i, 0) - wall,
                   y = test_value(&b, "position", i, 1);
      const bool second = q->along_length ? x > q->joint : y > q->split * q->depth;
      *mps_edit_f64(&young, i, 0) = q->young[second];
    }
  int64_t count, *ids = test_select(&b, 0, -1, 0.6 * h, &count);
  for (int c = 0; c < 2; c++) OK(test_prescribe(b.elastic, c, count, ids, NULL));
  OK(mps_elastic_cut(b.elastic, MPS_SIDE_X_LOWER, ids, count));
  free(ids);
  int64_t *facets = test_facets(&b, 0, 1, &count);
  double depth = q->depth;
  OK(test_traction_fn(b.elastic, count, facets, end_shear, &depth));
  free(facets);
  OK(mps_elastic_solve(b.elastic));
  /* The mean deflection of the end, extrapolated by half a cell. */
  double last = 0.0, former = 0.0;
  const double end = q->length + wall;
  ids = test_select(&b, 0, end - 1.6 * h, end, &count);
  for (int64_t k = 0; k < count; k++) {
    const double v = test_value(&b, "displacement", ids[k], 1) / cells;
    if (test_value(&b, "position", ids[k], 0) > end - h)
      last += v;
    else
      former += v;
  }
  free(ids);
  test_body_end(&b);
  return (1.5 * last - 0.5 * former) / beam_theory(q) - 1.0;
}

TEST_SERIAL(composite_cantilevers_bend_as_beam_theory_says) {
  for (int layout = 0; layout < 4; layout++) {
    const bool swap = layout % 2;
    beam q = {.depth = 1.0, .nu = 0.3, .split = 0.5, .bending = NAN};
    q.along_length = layout / 2;
    q.young[swap] = 1.0;
    q.young[!swap] = 10.0;
    for (int cells = 10; cells <= 20; cells += 10) {
      q.length = 10.0 - 0.5 / cells; /* from the wall's layer; joint and end lie on faces */
      q.joint = 5.0 - 0.5 / cells;
      const double error = beam_error(context, &q, cells);
      print_message("cantilever %g:%g %s, %d cells: end deflection %+.2f %%\n", q.young[0],
                    q.young[1], q.along_length ? "along the length" : "through the depth", cells,
                    100 * error);
      NEAR(error, 0.0, 0.01);
    }
  }
}

/* Layers of one cell to nine, of a tenth to a thousand times the other's modulus, ten cells through
 * the depth; beside it the method without bending within cells, whose layers of n cells lack 1/n^2
 * of their own bending stiffness. */
TEST_SERIAL(layers_at_any_height_bend_as_beam_theory_says) {
  const double ratio[] = {0.1, 10, 100, 1000}, split[] = {0.1, 0.2, 0.3, 0.5, 0.8};
  for (int r = 0; r < 4; r++)
    for (int s = 0; s < 5; s++) {
      beam q = {.depth = 1.0, .nu = 0.3, .length = 9.95, .split = split[s], .bending = NAN};
      q.young[0] = ratio[r], q.young[1] = 1.0;
      const double error = beam_error(context, &q, 10);
      q.bending = 0.0;
      const double without = beam_error(context, &q, 10);
      print_message("%g:1, the lower %g of the depth, 10 cells: %+.2f %%; without %+.2f %%\n",
                    ratio[r], split[s], 100 * error, 100 * without);
      NEAR(error, 0.0, ratio[r] <= 10 ? 0.005 : ratio[r] <= 100 ? 0.015 : 0.06);
      assert_true(fabs(error) < 0.9 * fabs(without) && (ratio[r] < 1000 || error < 0.3 * without));
    }
}

/* ---- free motions ---------------------------------------------------------------------------- */

/* Materials without any order; the matrix is checked against the operator in property/elastic. */
TEST_SERIAL(only_rigid_motions_are_free_whatever_the_materials) {
  for (int dim = 2; dim <= 3; dim++) {
    scoped_test_body b = test_body_begin(context, dim, 0.25);
    test_body_box(&b, 0, 0, 0, 2, 1, 0.5);
    test_body_box(&b, 0, 0, 0, 1, 1.5, 0.75);
    test_body_finish(&b, 1.0, 0.2, NULL);
    EDIT(young, b.particles, "young")
      EDIT(poisson, b.particles, "poisson")
        for (int64_t i = 0; i < b.n; i++) {
          *mps_edit_f64(&young, i, 0) = 1.0 + (double)(i * 7919 % 13) * 8.0;
          *mps_edit_f64(&poisson, i, 0) = 0.4 * (double)(i * 31 % 5) / 5.0;
        }
    OK(mpsi_elastic_renew_material(b.elastic, __func__));
    const int64_t all = b.n * dim, rigid = dim == 2 ? 3 : 6;
    double *k = malloc((size_t)(all * all) * sizeof *k), *u = calloc((size_t)all, sizeof *u);
    double *w = malloc((size_t)all * sizeof *w), skew = 0.0;
    for (int64_t c = 0; c < all; c++) {
      u[c] = 1.0;
      OK(mpsi_elastic_apply(b.elastic, __func__, u, k + c * all));
      u[c] = 0.0;
    }
    for (int64_t r = 0; r < all; r++)
      for (int64_t c = 0; c < r; c++) skew = fmax(skew, fabs(k[r * all + c] - k[c * all + r]));
    assert_int_equal(LAPACKE_dsyev(LAPACK_ROW_MAJOR, 'N', 'U', (int)all, k, (int)all, w), 0);
    print_message("%dD, E 1 to 97 at random: %.1e ... %.1e | %.2e ... %.2e, asymmetry %.1e\n", dim,
                  w[0], w[rigid - 1], w[rigid], w[all - 1], skew);
    assert_true(skew < 1e-13 * w[all - 1]);
    assert_true(fabs(w[0]) < 1e-13 * w[all - 1] && fabs(w[rigid - 1]) < 1e-13 * w[all - 1]);
    assert_true(w[rigid] > 1e-5 * w[all - 1]);
    free(k);
    free(u);
    free(w);
  }
}

/* ---- a round inclusion ----------------------------------------------------------------------- */

/* Uniaxial tension 1 of a plane with a disc of radius 1: the stress in the disc is uniform
 * (Eshelby; plane strain, kappa = 3 - 4 nu, shear moduli ratio m = mu_disc / mu). */
typedef struct inclusion {
  double m, nu, sxx, syy;
} inclusion;

static void inside(inclusion *q) {
  const double kappa = 3 - 4 * q->nu;
  const double mean = 0.5 * q->m * (kappa + 1) / (2 * q->m + kappa - 1);
  const double shear = 0.5 * q->m * (kappa + 1) / (q->m * kappa + 1);
  q->sxx = mean + shear;
  q->syy = mean - shear;
}

/* Stress outside, from Muskhelishvili's phi' and psi' of the plane with a disc. */
static void outside(const inclusion *q, double x, double y, double *s) {
  const double kappa = 3 - 4 * q->nu, m = q->m, r2 = x * x + y * y, r = sqrt(r2), t = atan2(y, x);
  const double a = 1 / r2, a2 = a * a, c2 = cos(2 * t), s2 = sin(2 * t);
  /* lambda-like constants of Goodier's solution */
  const double A = (1 - m) / (1 + m * kappa);                           /* shear part */
  const double B = (kappa - 1 - m * (kappa - 1)) / (2 * m + kappa - 1); /* mean part */
  const double srr = 0.5 * (1 - B * a) + 0.5 * c2 * (1 - 4 * A * a + 3 * A * a2);
  const double stt = 0.5 * (1 + B * a) - 0.5 * c2 * (1 + 3 * A * a2);
  const double srt = -0.5 * s2 * (1 + 2 * A * a - 3 * A * a2);
  const double c = x / r, w = y / r;
  s[0] = srr * c * c + stt * w * w - 2 * srt * c * w;
  s[1] = srr * w * w + stt * c * c + 2 * srt * c * w;
  s[2] = (srr - stt) * c * w + srt * (c * c - w * w);
}

static mps_status inclusion_traction(void *user, const double *x, const double *n, double *t) {
  double s[3];
  outside(user, x[0], x[1], s);
  t[0] = s[0] * n[0] + s[2] * n[1];
  t[1] = s[2] * n[0] + s[1] * n[1];
  return MPS_OK;
}

/* A quarter of a square of half side 4; relative error of the mean stress xx over the disc, and the
 * root mean square of its deviation from the uniform one. */
static void inclusion_error(mps_context *context, inclusion *q, int cells, double *mean,
                            double *rms) {
  const double h = 1.0 / (cells + 0.5), young = 2 * (1 + q->nu); /* mu = 1 */
  DEF(elastic, def, .state = MPS_ELASTIC_STATE_PLANE_STRAIN);
  DEF(particles, set, .spacing = h, .origin[0] = set.origin[1] = -0.5 * h);
  scoped_test_body b = {.context = context, .dim = 2};
  OK(mps_particles_create(context, &set, &b.particles));
  const double side = (4 * cells + 0.5) * h;
  test_body_box(&b, -0.5 * h, -0.5 * h, 0, side, side, 0);
  test_body_finish(&b, young, q->nu, &def);
  EDIT(stiffness, b.particles, "young")
    for (int64_t i = 0; i < b.n; i++) {
      const double x = test_value(&b, "position", i, 0), y = test_value(&b, "position", i, 1);
      if (x * x + y * y < 1) *mps_edit_f64(&stiffness, i, 0) = q->m * young;
    }
  for (int c = 0; c < 2; c++) {
    int64_t count, *ids = test_select(&b, c, -1, 0.1 * h, &count);
    OK(test_prescribe(b.elastic, c, count, ids, NULL));
    OK(mps_elastic_cut(b.elastic, mps_side_of(c, 0), ids, count));
    free(ids);
  }
  for (int axis = 0; axis < 2; axis++) {
    int64_t count, *facets = test_facets(&b, axis, 1, &count);
    OK(test_traction_fn(b.elastic, count, facets, inclusion_traction, q));
    free(facets);
  }
  OK(mps_elastic_solve(b.elastic));
  OK(mps_elastic_update_stress(b.elastic));
  double sum = 0, square = 0, count = 0;
  for (int64_t i = 0; i < b.n; i++) {
    const double x = test_value(&b, "position", i, 0), y = test_value(&b, "position", i, 1);
    if (x * x + y * y >= 1) continue;
    const double away = test_value(&b, "stress", i, 0) / q->sxx - 1;
    sum += away;
    square += away * away;
    count++;
  }
  *mean = sum / count;
  *rms = sqrt(square / count);
}

TEST_SERIAL(a_stiff_inclusion_converges) {
  const double ratios[] = {10, 0.1};
  for (int r = 0; r < 2; r++) {
    inclusion q = {.m = ratios[r], .nu = 0.3};
    double former = 0;
    inside(&q);
    for (int cells = 5; cells <= 20; cells *= 2) {
      double mean, rms;
      inclusion_error(context, &q, cells, &mean, &rms);
      print_message("disc %g:1, radius %d.5 cells: mean stress %+.2f %%, rms deviation %.2f %%\n",
                    q.m, cells, 100 * mean, 100 * rms);
      if (cells > 5) assert_true(fabs(mean) < 0.8 * fabs(former));
      former = mean;
    }
    NEAR(former, 0.0, 0.03);
  }
}
