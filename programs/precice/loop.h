/* loop.h - the loop of a preCICE participant (version 3): checkpoint, read, step, write, advance.
 * What is coupled is a `loop_side`: an elastic body (participant.h), a wall of a fluid (wall.h) or
 * a rigid body in soil (rigid.h). SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include "common/app.h"

/* Options that name a participant and its mesh, of a side's definition (common/options.h). */
#define LOOP_OPTIONS(def)                                                                          \
  OPTION_TEXT("config", &(def).config, NULL), OPTION_TEXT("participant", &(def).name, NULL),       \
      OPTION_TEXT("coupling-mesh", &(def).mesh, NULL)

enum { LOOP_DATA = 2 }; /* vectors that a side reads, and writes, at most */

/* Arrays of vectors have `dim` values a vertex, in the order of `x`. Functions return false, with
 * an error line, on a failure, which ends the coupling. */
typedef struct loop_side {
  void *self;
  int dim;         /* of the mesh, 2 or 3 */
  int64_t count;   /* vertices, > 0 */
  const double *x; /* m, dim a vertex, before the first step */
  double dt;       /* s: the largest step; preCICE may ask for shorter ones */
  const char *reads[LOOP_DATA], *writes[LOOP_DATA]; /* names of data; NULL: none */
  /* Step by dt. `read` has the data at its end; `written` receives those to be written. */
  bool (*step)(void *self, double dt, double *const *read, double *const *written);
  /* What is to be written before the first step. */
  bool (*begin)(void *self, double *const *written);
  bool (*save)(void *self); /* keeps the present state .. */
  bool (*undo)(void *self); /* .. and returns to it, as often as asked */
  bool (*each)(void *self); /* after each completed time window */
} loop_side;

typedef struct participant_result {
  int64_t windows, steps, repeats; /* time windows; steps with the repeated ones; windows undone */
} participant_result;

/* Couples `side` as participant `name` of the configuration by the vertices of `mesh` until preCICE
 * ends it. False, with an error line, on a failure; names that the configuration lacks end the
 * program with preCICE's own message. */
bool loop_run(app *a, const loop_side *side, const char *config, const char *name, const char *mesh,
              participant_result *result);
