/* participant.c - see participant.h. SPDX-License-Identifier: BSD-3-Clause */
#include "participant.h"

#include <math.h>
#include <stdlib.h>

typedef struct participant {
  app *a;
  mps_elastic *solver;
  const participant_def *def;
  int64_t count;
  const int64_t *facets;
  int dim;
  double *centre, *area; /* 3 and 1 a facet */
  double *vertex;        /* dim a facet */
  double *values;        /* 3 a facet */
  int32_t load;
  mps_snapshot *checkpoint;
} participant;

static bool reserve(participant *p) {
  const size_t n = (size_t)p->count + 1;
  p->centre = malloc(3 * n * sizeof *p->centre);
  p->vertex = malloc(3 * n * sizeof *p->vertex);
  p->area = malloc(n * sizeof *p->area);
  p->values = calloc(3 * n, sizeof *p->values);
  return (p->centre && p->vertex && p->area && p->values) || app_no_memory(p->a);
}

static void release(participant *p) {
  mps_snapshot_destroy(&p->checkpoint);
  free(p->centre);
  free(p->vertex);
  free(p->area);
  free(p->values);
}

/* The traction that the facets have until the next call. */
static bool set_traction(participant *p, bool first) {
  mps_elastic_load_def load = mps_elastic_load_defaults();
  load.kind = MPS_ELASTIC_LOAD_TRACTION;
  load.ids = p->facets;
  load.id_count = p->count;
  load.values = p->values;
  return app_check(p->a, first ? mps_elastic_add_load(p->solver, &load, &p->load)
                               : mps_elastic_set_load(p->solver, p->load, &load));
}

/* Vertices at the centres of the facets, and the load that the other code will give. */
static bool prepare(participant *p) {
  const mps_elastic_facet_arrays arrays = {.centre = p->centre, .area = p->area};
  p->dim = mps_particles_dim(mps_elastic_particles(p->solver));
  if (!app_check(p->a, mps_elastic_get_facets(p->solver, p->facets, p->count, &arrays)))
    return false;
  for (int64_t k = 0; k < p->count; k++)
    for (int c = 0; c < p->dim; c++) p->vertex[k * p->dim + c] = p->centre[3 * k + c];
  return set_traction(p, true);
}

/* Force over area, or stress, as traction. */
static bool load(participant *p, const double *read) {
  for (int64_t k = 0; k < p->count; k++)
    for (int c = 0; c < p->dim; c++) {
      const double value = read[k * p->dim + c];
      p->values[3 * k + c] = p->def->force ? value / p->area[k] : value;
    }
  return set_traction(p, false);
}

static void copy_out(const participant *p, double *out) {
  for (int64_t k = 0; k < p->count; k++)
    for (int c = 0; c < p->dim; c++) out[k * p->dim + c] = p->values[3 * k + c];
}

static bool write_motion(void *self, double *const *written) {
  participant *p = self;
  const mps_elastic_facet_arrays moved = {.displacement = p->values},
                                 moving = {.velocity = p->values};
  if (!app_check(p->a, mps_elastic_get_facets(p->solver, p->facets, p->count, &moved)))
    return false;
  copy_out(p, written[0]);
  if (!app_check(p->a, mps_elastic_get_facets(p->solver, p->facets, p->count, &moving)))
    return false;
  copy_out(p, written[1]);
  return true;
}

/* The matrix is factored again where the step changes. */
static bool step(void *self, double dt, double *const *read, double *const *written) {
  participant *p = self;
  if (!load(p, read[0])) return false;
  if (fabs(dt - mps_elastic_dt(p->solver)) > 1e-12 * dt &&
      !app_check(p->a, mps_elastic_set_dt(p->solver, dt)))
    return false;
  return app_check(p->a, mps_elastic_step(p->solver, 1)) && write_motion(p, written);
}

static bool save(void *self) {
  participant *p = self;
  return app_check(p->a, mps_elastic_snapshot(p->solver, &p->checkpoint));
}

static bool undo(void *self) {
  participant *p = self;
  return app_check(p->a, mps_elastic_rollback(p->solver, p->checkpoint));
}

static bool each(void *self) {
  participant *p = self;
  return !p->def->each || p->def->each(p->def->user, p->solver);
}

bool participant_run(app *a, mps_elastic *solver, int64_t count, const int64_t *facets,
                     const participant_def *def, participant_result *result) {
  participant p = {.a = a, .solver = solver, .def = def, .count = count, .facets = facets};
  bool good = reserve(&p) && prepare(&p);
  const loop_side side = {.self = &p,
                          .dim = p.dim,
                          .count = count,
                          .x = p.vertex,
                          .dt = def->dt,
                          .reads = {def->force ? def->force : def->stress},
                          .writes = {def->displacement, def->velocity},
                          .step = step,
                          .begin = write_motion,
                          .save = save,
                          .undo = undo,
                          .each = each};
  good = good && loop_run(a, &side, def->config, def->name, def->mesh, result);
  release(&p);
  return good;
}
