/* box.c - the mass of the box of precice-soil in a code of its own, which knows nothing of soil: a
 * participant "Box" of soil-config.xml that falls by gravity and by the forces on its corners. The
 * forces are means over the window, so are its accelerations.
 *
 *   precice-box CONFIG
 *
 * SPDX-License-Identifier: BSD-3-Clause */
#include <precice/preciceC.h>

#include <math.h>
#include <stdio.h>

static const double mass = 480.0, inertia = 480.0 * 0.13 / 12.0, gravity = 9.81; /* kg, kg m2 */
static const double centre[2] = {0.8, 0.6}; /* m, at the start */
static const double corner[8] = {0.65, 0.5, 0.95, 0.5, 0.95, 0.7, 0.65, 0.7};

typedef struct box {
  double d[2], angle, v[2], spin; /* m, rad, m/s, rad/s */
} box;

/* Of the corners, from their places at the start. */
static void displacements(const box *b, double *out) {
  for (int k = 0; k < 4; k++) {
    const double p = corner[2 * k] - centre[0], q = corner[2 * k + 1] - centre[1];
    out[2 * k] = b->d[0] + (cos(b->angle) - 1.0) * p - sin(b->angle) * q;
    out[2 * k + 1] = b->d[1] + sin(b->angle) * p + (cos(b->angle) - 1.0) * q;
  }
}

/* A window of dt under `force` on the corners: velocities, then places with them. */
static box advance(const box *start, double dt, const double *force) {
  box b = *start;
  double sum[2] = {0.0, 0.0}, moment = 0.0, moved[8];
  displacements(start, moved);
  for (int k = 0; k < 4; k++) {
    const double arm[2] = {corner[2 * k] + moved[2 * k] - centre[0] - b.d[0],
                           corner[2 * k + 1] + moved[2 * k + 1] - centre[1] - b.d[1]};
    sum[0] += force[2 * k], sum[1] += force[2 * k + 1];
    moment += arm[0] * force[2 * k + 1] - arm[1] * force[2 * k];
  }
  b.v[0] += dt * sum[0] / mass, b.v[1] += dt * (sum[1] / mass - gravity);
  b.spin += dt * moment / inertia;
  for (int c = 0; c < 2; c++) b.d[c] += dt * b.v[c];
  b.angle += dt * b.spin;
  return b;
}

int main(int argc, char **argv) {
  box now = {{0.0, 0.0}, 0.0, {0.0, 0.0}, 0.0}, kept = now;
  int vertex[4];
  double force[8] = {0.0}, moved[8] = {0.0};
  if (argc != 2) {
    fprintf(stderr, "usage: precice-box CONFIG\n");
    return 2;
  }
  precicec_createParticipant("Box", argv[1], 0, 1);
  precicec_setMeshVertices("Box-Mesh", 4, corner, vertex);
  if (precicec_requiresInitialData())
    precicec_writeData("Box-Mesh", "Displacement", 4, vertex, moved);
  precicec_initialize();
  while (precicec_isCouplingOngoing()) {
    const double dt = precicec_getMaxTimeStepSize();
    if (precicec_requiresWritingCheckpoint()) kept = now;
    precicec_readData("Box-Mesh", "Force", 4, vertex, dt, force);
    now = advance(&now, dt, force);
    displacements(&now, moved);
    precicec_writeData("Box-Mesh", "Displacement", 4, vertex, moved);
    precicec_advance(dt);
    if (precicec_requiresReadingCheckpoint()) now = kept;
  }
  precicec_finalize();
  printf("the box at the end: %.6g m, %.6g m, %.6g rad\n", now.d[0], now.d[1], now.angle);
  return 0;
}
