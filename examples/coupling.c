/* coupling.c - an implicit coupling by snapshot and rollback: an elastic bar, and a heavy mass at
 * its end that belongs to another code. The bar receives a force and returns an acceleration; the
 * mass receives the acceleration and returns a force. Each step is repeated, by Aitken's
 * relaxation, until both agree. Plain repetition would diverge, the mass being heavier than the
 * bar's end. The bar with the mass as density of its last particles (monolithic) must have the same
 * motion.
 * SPDX-License-Identifier: BSD-3-Clause */
#include <mps/elastic.h>
#include <mps/material.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#define LENGTH 20 /* particles; 2 wide */
#define STEPS 200

static const double spacing = 0.1, density = 2000.0, young = 5e7; /* m, kg/m3, Pa */
static const double mass = 500.0, pull = 1e4;                     /* kg, N; the mass is pulled */

typedef struct bar {
  mps_particles *set;
  mps_elastic *solver;
  int64_t ends[2];
  int32_t load;
} bar;

/* Stops where a call fails, with the library's message. */
static void ok(mps_status status) {
  if (status == MPS_OK) return;
  fprintf(stderr, "%s\n", mps_last_error()->message);
  exit(1);
}

/* Held at x = 0 and across everywhere; `more` is added to the density of the end, `force` pulls. */
static void make_bar(mps_context *context, double more, double force, bar *b) {
  const double lo[] = {0.0, 0.0}, hi[] = {LENGTH * spacing, 2.0 * spacing};
  const double end[] = {(LENGTH - 1) * spacing, 0.0};
  int64_t count = 0;
  mps_particles_def def = mps_particles_defaults();
  def.spacing = spacing;
  ok(mps_particles_create(context, &def, &b->set));
  ok(mps_particles_fill_box(b->set, lo, hi, NULL));
  ok(mps_particles_select_box(b->set, end, hi, 2, &count, b->ends));
  mps_material *stuff = NULL, *heavy = NULL;
  ok(mps_material_create_linear_elastic(context, young, 0.0, &stuff));
  ok(mps_particles_set_material(b->set, stuff, density, NULL, 0));
  ok(mps_material_create_linear_elastic(context, young, 0.0, &heavy));
  ok(mps_particles_set_material(b->set, heavy, density + more, b->ends, count));
  mps_material_destroy(&stuff);
  mps_material_destroy(&heavy);
  ok(mps_elastic_create(context, b->set, NULL, &b->solver));
  mps_elastic_boundary_def held = mps_elastic_boundary_defaults();
  for (int c = 0; c < 3; c++) held.lower[c] = -INFINITY, held.upper[c] = INFINITY;
  held.dofs = MPS_DOF_Y;
  ok(mps_elastic_add_boundary(b->solver, &held, NULL));
  held.dofs = MPS_DOF_X, held.upper[0] = spacing;
  ok(mps_elastic_add_boundary(b->solver, &held, NULL));
  mps_elastic_load_def load = mps_elastic_load_defaults();
  load.kind = MPS_ELASTIC_LOAD_FORCE;
  load.ids = b->ends, load.id_count = 2, load.force[0] = 0.5 * force;
  ok(mps_elastic_add_load(b->solver, &load, &b->load));
  mps_elastic_motion_def motion = mps_elastic_motion_defaults();
  motion.dt = spacing / sqrt(young / density);
  ok(mps_elastic_start(b->solver, &motion));
}

static void at_end(const bar *b, const char *field, double *value) {
  mps_view view;
  ok(mps_particles_view(b->set, field, &view));
  *value = *mps_view_f64(&view, mps_particles_index(b->set, b->ends[0]), 0);
}

/* One step under the force on the bar's end. */
static void step(bar *b, double force, double *acceleration) {
  mps_elastic_load_def load = mps_elastic_load_defaults();
  load.kind = MPS_ELASTIC_LOAD_FORCE;
  load.ids = b->ends, load.id_count = 2, load.force[0] = 0.5 * force;
  ok(mps_elastic_set_load(b->solver, b->load, &load));
  ok(mps_elastic_step(b->solver, 1));
  at_end(b, "acceleration", acceleration);
}

/* A step of both: force = pull - mass * acceleration, to 1e-9 of the pull. */
static void couple(bar *b, mps_snapshot **before, double *force, int *repeats) {
  double last = 0.0, omega = 0.1, acceleration;
  ok(mps_elastic_snapshot(b->solver, before));
  for (int k = 0; k < 30; k++) {
    if (k > 0) ok(mps_elastic_rollback(b->solver, *before));
    step(b, *force, &acceleration);
    const double residual = pull - mass * acceleration - *force;
    ++*repeats;
    if (fabs(residual) < 1e-9 * pull) return;
    if (k > 0) omega *= -last / (residual - last); /* Aitken */
    last = residual;
    *force += omega * residual;
  }
  fprintf(stderr, "bar and mass do not agree after 30 repeats\n");
  exit(1);
}

int main(void) {
  mps_context *context = NULL;
  mps_snapshot *before = NULL;
  bar coupled = {0}, whole = {0};
  const double area = spacing * spacing, own = 2.0 * area * density; /* kg: of the end particles */
  double force = pull * own / (own + mass), worst = 0.0, largest = 0.0;
  int repeats = 0;
  ok(mps_context_create(NULL, &context, NULL, 0));
  make_bar(context, 0.0, force, &coupled);
  make_bar(context, mass / (2.0 * area), pull, &whole);
  for (int k = 1; k <= STEPS; k++) {
    double u = 0.0, reference = 0.0;
    couple(&coupled, &before, &force, &repeats);
    ok(mps_elastic_step(whole.solver, 1));
    at_end(&coupled, "displacement", &u);
    at_end(&whole, "displacement", &reference);
    worst = fmax(worst, fabs(u - reference));
    largest = fmax(largest, fabs(reference));
    if (k % 20 == 0)
      printf("t = %.4f s: end at %.6f mm, monolithic %.6f mm\n", mps_elastic_time(whole.solver),
             1e3 * u, 1e3 * reference);
  }
  printf("%.1f repeats a step; largest difference %.2g of the largest displacement\n",
         (double)repeats / STEPS, worst / largest);
  mps_snapshot_destroy(&before);
  bar *bars[] = {&coupled, &whole};
  for (int k = 0; k < 2; k++) {
    mps_elastic_destroy(&bars[k]->solver);
    mps_particles_destroy(&bars[k]->set);
  }
  mps_context_destroy(&context);
  return worst < 1e-6 * largest && largest > 0.0 ? 0 : 1;
}
