/* participant.c - see participant.h. The loop is preCICE's (version 3): checkpoint, read, step,
 * write, advance. SPDX-License-Identifier: BSD-3-Clause */
#include "participant.h"

#include <precice/preciceC.h>

#include <math.h>
#include <stdlib.h>
#include <string.h>

typedef struct participant {
  app *a;
  mps_elastic *solver;
  const participant_def *def;
  int64_t count;
  const int64_t *facets;
  int dim;
  int *vertex;
  double *centre, *area; /* 3 and 1 a facet */
  double *data;          /* dim a facet, as preCICE has them */
  double *values;        /* 3 a facet, as libmps has them */
  int32_t load;
  mps_snapshot *checkpoint;
} participant;

static bool reserve(participant *p) {
  const size_t n = (size_t)p->count + 1;
  p->vertex = malloc(n * sizeof *p->vertex);
  p->centre = malloc(3 * n * sizeof *p->centre);
  p->area = malloc(n * sizeof *p->area);
  p->data = calloc(3 * n, sizeof *p->data);
  p->values = calloc(3 * n, sizeof *p->values);
  return (p->vertex && p->centre && p->area && p->data && p->values) || app_no_memory(p->a);
}

static void release(participant *p) {
  mps_snapshot_destroy(&p->checkpoint);
  free(p->vertex);
  free(p->centre);
  free(p->area);
  free(p->data);
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
static bool connect(participant *p) {
  const mps_elastic_facet_arrays arrays = {.centre = p->centre, .area = p->area};
  const int dim = precicec_getMeshDimensions(p->def->mesh);
  p->dim = mps_particles_dim(mps_elastic_particles(p->solver));
  if (dim != p->dim)
    return app_error(p->a, "mesh '%s' of the coupling has %d dimensions, the body has %d",
                     p->def->mesh, dim, p->dim);
  if (!app_check(p->a, mps_elastic_get_facets(p->solver, p->count, p->facets, &arrays)))
    return false;
  for (int64_t k = 0; k < p->count; k++)
    for (int c = 0; c < dim; c++) p->data[k * dim + c] = p->centre[3 * k + c];
  precicec_setMeshVertices(p->def->mesh, (int)p->count, p->data, p->vertex);
  return set_traction(p, true);
}

/* Force over area, or stress, at the end of a step of dt. */
static bool read_load(participant *p, double dt) {
  const char *name = p->def->force ? p->def->force : p->def->stress;
  precicec_readData(p->def->mesh, name, (int)p->count, p->vertex, dt, p->data);
  for (int64_t k = 0; k < p->count; k++)
    for (int c = 0; c < p->dim; c++) {
      const double value = p->data[k * p->dim + c];
      if (!isfinite(value))
        return app_error(p->a, "%s of the coupling is %g at the vertex %.6g m, %.6g m", name, value,
                         p->centre[3 * k], p->centre[3 * k + 1]);
      p->values[3 * k + c] = p->def->force ? value / p->area[k] : value;
    }
  return set_traction(p, false);
}

static void write_one(participant *p, const char *name) {
  for (int64_t k = 0; k < p->count; k++)
    for (int c = 0; c < p->dim; c++) p->data[k * p->dim + c] = p->values[3 * k + c];
  precicec_writeData(p->def->mesh, name, (int)p->count, p->vertex, p->data);
}

static bool write_motion(participant *p) {
  const mps_elastic_facet_arrays moved = {.displacement = p->values},
                                 moving = {.velocity = p->values};
  if (p->def->displacement) {
    if (!app_check(p->a, mps_elastic_get_facets(p->solver, p->count, p->facets, &moved)))
      return false;
    write_one(p, p->def->displacement);
  }
  if (p->def->velocity) {
    if (!app_check(p->a, mps_elastic_get_facets(p->solver, p->count, p->facets, &moving)))
      return false;
    write_one(p, p->def->velocity);
  }
  return true;
}

/* A step of at most preCICE's. Its matrix is factored again where the step changes. */
static bool step(participant *p, double *dt) {
  const double most = precicec_getMaxTimeStepSize();
  *dt = p->def->dt < most * (1.0 - 1e-10) ? p->def->dt : most;
  if (!read_load(p, *dt)) return false;
  if (fabs(*dt - mps_elastic_dt(p->solver)) > 1e-12 * *dt &&
      !app_check(p->a, mps_elastic_set_dt(p->solver, *dt)))
    return false;
  return app_check(p->a, mps_elastic_step(p->solver, 1)) && write_motion(p);
}

static bool couple(participant *p, participant_result *result) {
  bool good = true;
  if (precicec_requiresInitialData()) good = write_motion(p);
  if (good) precicec_initialize();
  while (good && precicec_isCouplingOngoing()) {
    double dt = 0.0;
    if (precicec_requiresWritingCheckpoint())
      good = app_check(p->a, mps_elastic_snapshot(p->solver, &p->checkpoint));
    good = good && step(p, &dt);
    if (!good) break;
    precicec_advance(dt);
    result->steps++;
    if (precicec_requiresReadingCheckpoint()) {
      good = app_check(p->a, mps_elastic_rollback(p->solver, p->checkpoint));
      result->repeats++;
    } else if (precicec_isTimeWindowComplete()) {
      result->windows++;
      if (p->def->each) good = p->def->each(p->def->user, p->solver);
    }
  }
  return good;
}

bool participant_run(app *a, mps_elastic *solver, int64_t count, const int64_t *facets,
                     const participant_def *def, participant_result *result) {
  participant p = {.a = a, .solver = solver, .def = def, .count = count, .facets = facets};
  *result = (participant_result){0};
  precicec_createParticipant(def->name, def->config, 0, 1);
  bool good = reserve(&p) && connect(&p);
  good = good && couple(&p, result);
  precicec_finalize();
  release(&p);
  return good;
}
