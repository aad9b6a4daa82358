/* loop.c - see loop.h. SPDX-License-Identifier: BSD-3-Clause */
#include "loop.h"

#include <precice/preciceC.h>

#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

typedef struct loop {
  app *a;
  const loop_side *side;
  const char *mesh;
  int *vertex;
  double *read[LOOP_DATA], *written[LOOP_DATA];
} loop;

static bool reserve(loop *l) {
  const size_t n = (size_t)l->side->count, values = n * (size_t)l->side->dim;
  bool good = (l->vertex = malloc(n * sizeof *l->vertex)) != NULL;
  for (int k = 0; k < LOOP_DATA; k++) {
    l->read[k] = calloc(values, sizeof(double));
    l->written[k] = calloc(values, sizeof(double));
    good = good && l->read[k] && l->written[k];
  }
  return good || app_no_memory(l->a);
}

static void release(loop *l) {
  free(l->vertex);
  for (int k = 0; k < LOOP_DATA; k++) {
    free(l->read[k]);
    free(l->written[k]);
  }
}

/* Before preCICE, which would end the program. */
static bool check_config(app *a, const loop_side *side, const char *config) {
  FILE *f = fopen(config, "r");
  if (!f) return app_error(a, "cannot read preCICE's configuration '%s'", config);
  fclose(f);
  if (side->count < 1 || side->count > INT_MAX / 3)
    return app_error(a, "%lld vertices for the coupling, must be 1 to %d", (long long)side->count,
                     INT_MAX / 3);
  return true;
}

static bool check_data(const loop *l, const char *name) {
  const int found = name ? precicec_getDataDimensions(l->mesh, name) : l->side->dim;
  return found == l->side->dim ||
         app_error(l->a, "'%s' of mesh '%s' of the coupling has %d components, must have %d", name,
                   l->mesh, found, l->side->dim);
}

static bool connect(loop *l) {
  const int dim = precicec_getMeshDimensions(l->mesh);
  if (dim != l->side->dim)
    return app_error(l->a, "mesh '%s' of the coupling has %d dimensions, the body has %d", l->mesh,
                     dim, l->side->dim);
  for (int k = 0; k < LOOP_DATA; k++)
    if (!check_data(l, l->side->reads[k]) || !check_data(l, l->side->writes[k])) return false;
  precicec_setMeshVertices(l->mesh, (int)l->side->count, l->side->x, l->vertex);
  return true;
}

static bool read_data(loop *l, double dt) {
  const loop_side *s = l->side;
  for (int k = 0; k < LOOP_DATA; k++) {
    if (!s->reads[k]) continue;
    precicec_readData(l->mesh, s->reads[k], (int)s->count, l->vertex, dt, l->read[k]);
    for (int64_t i = 0; i < s->count * s->dim; i++)
      if (!isfinite(l->read[k][i])) {
        const double *x = s->x + i / s->dim * s->dim;
        return app_error(l->a, "%s of the coupling is %g at the vertex %.6g m, %.6g m", s->reads[k],
                         l->read[k][i], x[0], x[1]);
      }
  }
  return true;
}

static void write_data(loop *l) {
  for (int k = 0; k < LOOP_DATA; k++)
    if (l->side->writes[k])
      precicec_writeData(l->mesh, l->side->writes[k], (int)l->side->count, l->vertex,
                         l->written[k]);
}

/* A step of at most preCICE's. */
static bool step(loop *l, double *dt) {
  const double most = precicec_getMaxTimeStepSize();
  *dt = l->side->dt < most * (1.0 - 1e-10) ? l->side->dt : most;
  if (!read_data(l, *dt) || !l->side->step(l->side->self, *dt, l->read, l->written)) return false;
  write_data(l);
  return true;
}

static bool couple(loop *l, participant_result *result) {
  const loop_side *s = l->side;
  bool good = true;
  if (precicec_requiresInitialData()) {
    good = s->begin(s->self, l->written);
    if (good) write_data(l);
  }
  if (good) precicec_initialize();
  while (good && precicec_isCouplingOngoing()) {
    double dt = 0.0;
    if (precicec_requiresWritingCheckpoint()) good = s->save(s->self);
    good = good && step(l, &dt);
    if (!good) break;
    precicec_advance(dt);
    result->steps++;
    if (precicec_requiresReadingCheckpoint()) {
      good = s->undo(s->self);
      result->repeats++;
    } else if (precicec_isTimeWindowComplete()) {
      result->windows++;
      if (s->each) good = s->each(s->self);
    }
  }
  return good;
}

bool loop_run(app *a, const loop_side *side, const char *config, const char *name, const char *mesh,
              participant_result *result) {
  loop l = {.a = a, .side = side, .mesh = mesh};
  *result = (participant_result){0};
  if (!check_config(a, side, config)) return false;
  bool good = reserve(&l);
  if (good) {
    precicec_createParticipant(name, config, 0, 1);
    good = connect(&l) && couple(&l, result);
    precicec_finalize();
  }
  release(&l);
  return good;
}
