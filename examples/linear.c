/* linear.c - a linear solver of one's own: the same conjugate gradients solve for the displacements
 * of an elastic bar and for the pressure of water in a tank. The bar must stretch by F L / (E A),
 * and the pressure at the bottom of the water at rest be rho g h. SPDX-License-Identifier:
 * BSD-3-Clause */
#define MPS_EXPERIMENTAL 1
#include <mps/elastic.h>
#include <mps/experimental/linear_solver.h>
#include <mps/fluid.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- the solver: a copy of the matrix, and conjugate gradients with its diagonal ---------------
 */

typedef struct conjugate {
  int64_t rows, iterations, *start; /* iterations: of all solutions */
  int32_t *column;
  double *value;
} conjugate;

/* Stops where a call fails, with the library's message. */
static void ok(mps_status status) {
  if (status == MPS_OK) return;
  fprintf(stderr, "%s\n", mps_last_error()->message);
  exit(1);
}

static mps_status take(void *user, const mps_linear_matrix *m) {
  conjugate *c = user;
  const size_t rows = (size_t)m->rows, entries = (size_t)m->start[m->rows];
  c->rows = m->rows;
  c->start = realloc(c->start, (rows + 1) * sizeof *c->start);
  c->column = realloc(c->column, entries * sizeof *c->column);
  c->value = realloc(c->value, entries * sizeof *c->value);
  if (!c->start || !c->column || !c->value) return MPS_ERROR_MEMORY;
  memcpy(c->start, m->start, (rows + 1) * sizeof *c->start);
  memcpy(c->column, m->column, entries * sizeof *c->column);
  memcpy(c->value, m->value, entries * sizeof *c->value);
  return MPS_OK;
}

/* Row i of A times x; its diagonal to *diagonal. */
static double row(const conjugate *c, int64_t i, const double *x, double *diagonal) {
  double sum = 0.0;
  for (int64_t k = c->start[i]; k < c->start[i + 1]; k++) {
    sum += c->value[k] * x[c->column[k]];
    if (c->column[k] == i) *diagonal = c->value[k];
  }
  return sum;
}

static mps_status solve(void *user, const double *b, double tolerance, double *x,
                        mps_linear_result *result) {
  conjugate *c = user;
  const int64_t n = c->rows;
  double *r = calloc((size_t)(3 * n), sizeof *r);
  double bb = 0.0, rr = 0.0, former = 1.0, diagonal = 1.0;
  if (!r) return MPS_ERROR_MEMORY;
  double *d = r + n, *q = d + n;
  for (int64_t i = 0; i < n; i++) {
    r[i] = b[i] - row(c, i, x, &diagonal);
    bb += b[i] * b[i], rr += r[i] * r[i];
  }
  for (; rr > 0.25 * tolerance * tolerance * bb && result->iterations < n; result->iterations++) {
    double rz = 0.0, dq = 0.0;
    for (int64_t i = 0; i < n; i++) {
      (void)row(c, i, r, &diagonal);
      q[i] = r[i] / diagonal;
      rz += r[i] * q[i];
    }
    for (int64_t i = 0; i < n; i++) d[i] = q[i] + rz / former * d[i];
    for (int64_t i = 0; i < n; i++) q[i] = row(c, i, d, &diagonal), dq += d[i] * q[i];
    rr = 0.0;
    for (int64_t i = 0; i < n; i++) {
      x[i] += rz / dq * d[i], r[i] -= rz / dq * q[i];
      rr += r[i] * r[i];
    }
    former = rz;
  }
  result->residual = bb > 0.0 ? sqrt(rr / bb) : 0.0;
  c->iterations += result->iterations;
  free(r);
  return MPS_OK;
}

static void release(void *user) {
  conjugate *c = user;
  free(c->start);
  free(c->column);
  free(c->value);
}

static void set(mps_solver *solver, int32_t equation, conjugate *c) {
  mps_linear_solver_def def = mps_linear_solver_defaults();
  def.user = c, def.release = release;
  def.matrix = take, def.solve = solve;
  ok(mps_solver_set_linear_solver(solver, equation, &def));
}

/* ---- an elastic bar that is pulled ----------------------------------------------------------- */

static void stretch(mps_context *context, conjugate *c, double *error) {
  const double lo[] = {0.0, 0.0}, hi[] = {2.0, 0.4}, young = 1e6, stress = 1e3;
  mps_particles_def def = mps_particles_defaults();
  mps_elastic_boundary_def held = mps_elastic_boundary_defaults();
  mps_elastic_load_def pull = mps_elastic_load_defaults();
  mps_particles *bar = NULL;
  mps_elastic *solver = NULL;
  mps_view u;
  int64_t facets[64], count = 0;
  def.spacing = 0.1;
  ok(mps_particles_create(context, &def, &bar));
  ok(mps_particles_fill_box(bar, lo, hi, NULL));
  ok(mps_particles_set(bar, "young", 0, young));
  ok(mps_particles_set(bar, "poisson", 0, 0.0));
  ok(mps_elastic_create(context, bar, NULL, &solver));
  for (int k = 0; k < 3; k++) held.lower[k] = -1.0, held.upper[k] = k ? 1.0 : 0.1; /* a column */
  ok(mps_elastic_add_boundary(solver, &held, NULL));
  ok(mps_elastic_select_facets(solver, MPS_SIDE_X_UPPER, NULL, NULL, 64, &count, facets));
  pull.kind = MPS_ELASTIC_LOAD_TRACTION;
  pull.ids = facets, pull.id_count = count, pull.force[0] = stress;
  ok(mps_elastic_add_load(solver, &pull, NULL));
  set(mps_elastic_solver(solver), MPS_LINEAR_EQUATION_STIFFNESS, c);
  ok(mps_elastic_solve(solver));
  ok(mps_particles_view(bar, "displacement", &u));
  /* from the middle of the first column to that of the last */
  *error = *mps_view_f64(&u, u.shape[0] - 1, 0) / (stress / young * 1.9) - 1.0;
  mps_elastic_destroy(&solver);
  mps_particles_destroy(&bar);
}

/* ---- water at rest --------------------------------------------------------------------------- */

static void rest(mps_context *context, conjugate *c, double *error) {
  const double lo[] = {0.0, 0.0}, hi[] = {1.0, 0.5}, bottom[] = {0.5, 0.0, 0.0};
  const double wall[3][4] = {{0.0, 0.0, 0.0, 1.0}, {0.0, 0.0, 1.0, 0.0}, {1.0, 0.0, -1.0, 0.0}};
  mps_particles_def def = mps_particles_defaults();
  mps_fluid_def of = mps_fluid_defaults();
  mps_particles *water = NULL;
  mps_fluid *fluid = NULL;
  double pressure = 0.0;
  def.spacing = 0.05;
  of.level = 0.5, of.tolerance = 1e-8;
  ok(mps_particles_create(context, &def, &water));
  ok(mps_particles_fill_box(water, lo, hi, NULL));
  ok(mps_fluid_create(context, water, &of, &fluid));
  for (int k = 0; k < 3; k++) {
    mps_fluid_boundary_def slip = mps_fluid_boundary_defaults();
    slip.kind = MPS_BOUNDARY_ROLLER;
    memcpy(slip.point, wall[k], 2 * sizeof(double));
    memcpy(slip.normal, wall[k] + 2, 2 * sizeof(double));
    ok(mps_fluid_add_boundary(fluid, &slip, NULL));
  }
  set(mps_fluid_solver(fluid), MPS_LINEAR_EQUATION_PRESSURE, c);
  ok(mps_fluid_step(fluid, 10));
  ok(mps_fluid_get_pressure(fluid, 0, 1, bottom, &pressure));
  *error = pressure / (1000.0 * 9.81 * 0.5) - 1.0;
  mps_fluid_destroy(&fluid);
  mps_particles_destroy(&water);
}

int main(void) {
  mps_context *context = NULL;
  conjugate of_bar = {0}, of_water = {0};
  double error[2] = {1.0, 1.0};
  ok(mps_context_create(NULL, &context, NULL, 0));
  stretch(context, &of_bar, &error[0]);
  rest(context, &of_water, &error[1]);
  printf("bar: %lld iterations, stretches by %.2f %% more than F L / (E A)\n",
         (long long)of_bar.iterations, 100.0 * error[0]);
  printf("water: %lld iterations, %.2f %% more than rho g h at the bottom\n",
         (long long)of_water.iterations, 100.0 * error[1]);
  mps_context_destroy(&context);
  return fabs(error[0]) < 0.05 && fabs(error[1]) < 0.02 ? 0 : 1;
}
