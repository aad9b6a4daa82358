/* mock.c - see mock.h. SPDX-License-Identifier: BSD-3-Clause */
#include "mock.h"

#include <precice/preciceC.h>

#include <math.h>
#include <stdbool.h>
#include <string.h>

enum { MOST = 100000 };

mock_def mock = {.window = 0.02, .windows = 10, .repetitions = 3, .rate = 100.0};
mock_seen mock_was;

static bool made, begun, left[MOST];
static double place[2 * MOST];             /* in the order of the participant */
static int repetition;                     /* from 0, in the present window */
static double done;                        /* s of the window */
static bool asked_to_write, asked_to_read; /* for the checkpoint of this window */

static void refuse(bool wrong, const char *what) {
  if (wrong && !mock_was.wrong) mock_was.wrong = what;
}

static bool at_begin(void) { return repetition == 0 && done == 0.0; }
static bool at_end(void) { return mock.window - done <= 1e-10 * mock.window; }

void precicec_createParticipant(const char *name, const char *config, int index, int size) {
  mock_was = (mock_seen){0};
  made = true, begun = false, repetition = 0, done = 0.0, asked_to_write = asked_to_read = false;
  refuse(strcmp(name, "Solid") != 0 || !strstr(config, ".xml"),
         "createParticipant: name or configuration");
  refuse(index != 0 || size != 1, "createParticipant: ranks");
}

void precicec_initialize(void) {
  refuse(!made || begun || mock_was.vertices == 0, "initialize");
  begun = true;
}

int precicec_requiresInitialData(void) { return !begun; }
int precicec_getMeshDimensions(const char *mesh) { return strcmp(mesh, "Solid-Mesh") == 0 ? 2 : 0; }
int precicec_getDataDimensions(const char *mesh, const char *data) {
  static const char *const vectors[] = {"Force", "Stress", "Displacement", "Velocity"};
  refuse(begun, "getDataDimensions: names are to be checked before initialize");
  for (int k = 0; k < 4; k++)
    if (strcmp(data, vectors[k]) == 0) return precicec_getMeshDimensions(mesh);
  return strcmp(data, "Pressure") == 0; /* preCICE itself ends the program for unknown names */
}
int precicec_isCouplingOngoing(void) { return mock_was.windows < mock.windows; }

double precicec_getMaxTimeStepSize(void) {
  refuse(!begun, "getMaxTimeStepSize before initialize");
  return mock.window - done;
}

int precicec_requiresWritingCheckpoint(void) {
  const bool needed = mock.repetitions > 1 && at_begin();
  if (needed) asked_to_write = true, mock_was.checkpoints++;
  return needed;
}

int precicec_requiresReadingCheckpoint(void) {
  if (asked_to_read) mock_was.rollbacks++;
  const int needed = asked_to_read;
  asked_to_read = false;
  return needed;
}

int precicec_isTimeWindowComplete(void) { return at_begin(); }

void precicec_advance(double dt) {
  refuse(!begun || asked_to_read, "advance: a checkpoint was to be read");
  refuse(!(dt > 0.0) || dt > (mock.window - done) * (1.0 + 1e-10),
         "advance: step beyond the window");
  refuse(mock.repetitions > 1 && !asked_to_write, "advance: a checkpoint was to be written");
  done += dt;
  if (!at_end()) return;
  done = 0.0;
  if (++repetition < mock.repetitions) {
    asked_to_read = true;
    return;
  }
  repetition = 0, asked_to_write = false;
  mock_was.windows++;
}

void precicec_finalize(void) {
  refuse(!made, "finalize");
  made = false;
}

void precicec_setMeshVertices(const char *mesh, int size, const double *positions, int *ids) {
  double least = INFINITY;
  refuse(begun || precicec_getMeshDimensions(mesh) != 2 || size > MOST, "setMeshVertices");
  for (int k = 0; k < size; k++) least = fmin(least, positions[2 * k]);
  for (int k = 0; k < size; k++) {
    place[2 * k] = positions[2 * k], place[2 * k + 1] = positions[2 * k + 1];
    ids[k] = size - 1 - k; /* preCICE promises no order */
    left[ids[k]] = positions[2 * k] < least + 1e-9;
    mock_was.left += left[ids[k]];
  }
  mock_was.vertices = size;
}

void precicec_writeData(const char *mesh, const char *data, int size, const int *ids,
                        const double *values) {
  refuse(precicec_getMeshDimensions(mesh) != 2 || size != mock_was.vertices, "writeData");
  refuse(strcmp(data, "Displacement") != 0 && strcmp(data, "Velocity") != 0 &&
             (!mock.take || strcmp(data, "Force") != 0),
         "writeData: name");
  if (strcmp(data, "Velocity") != 0) mock_was.writes++;
  if (mock.take)
    mock.take(mock.user, data, mock_was.windows * mock.window + done,
              repetition == mock.repetitions - 1, size, values);
  for (int k = 0; k < size; k++) {
    refuse(ids[k] < 0 || ids[k] >= size || !isfinite(values[2 * k] + values[2 * k + 1]),
           "writeData: values");
    if (strcmp(data, "Displacement") == 0 && repetition == mock.repetitions - 1)
      mock_was.displacement = fmax(mock_was.displacement, fabs(values[2 * k]));
  }
}

void precicec_readData(const char *mesh, const char *data, int size, const int *ids, double time,
                       double *values) {
  const double t = mock_was.windows * mock.window + done + time;
  const double factor = repetition == mock.repetitions - 1 ? 1.0 : 2.0 - 3.0 * repetition;
  refuse(precicec_getMeshDimensions(mesh) != 2 || size != mock_was.vertices, "readData");
  refuse(!mock.give && strcmp(data, "Force") != 0 && strcmp(data, "Stress") != 0, "readData: name");
  refuse(!(time >= 0.0) || time > (mock.window - done) * (1.0 + 1e-10), "readData: time");
  mock_was.reads++;
  if (mock.give) {
    mock.give(mock.user, data, t, repetition == mock.repetitions - 1, size, place, values);
    return;
  }
  for (int k = 0; k < size; k++) {
    values[2 * k] = left[ids[k]] ? factor * mock.rate * t : 0.0;
    values[2 * k + 1] = 0.0;
  }
}
