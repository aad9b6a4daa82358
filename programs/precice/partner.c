/* partner.c - the other side of a preCICE coupling with mps-precice, to try it without a fluid
 * solver: a uniform pressure on one side of the flap from the first moment on, and an elastic
 * foundation (as a spring along each of its vertices) that answers its displacement.
 *
 *   precice-partner CONFIG PRESSURE FOUNDATION     Pa, Pa/m
 *
 * It is the participant "Fluid" of precice-config.xml with vertices of its own, so that the mapping
 * between both meshes is used too. The last line is the largest displacement of its vertices.
 * SPDX-License-Identifier: BSD-3-Clause */
#include <precice/preciceC.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

enum { SIDE = 50, COUNT = 2 * SIDE }; /* vertices: the left side, then the right one */

static const double half = 0.05, height = 1.0; /* m, of the flap */

typedef struct partner {
  double pressure, foundation;
  int vertex[COUNT];
  double x[2 * COUNT], force[2 * COUNT], displacement[2 * COUNT];
  double largest, at; /* m, s */
} partner;

static void place(partner *p) {
  for (int k = 0; k < COUNT; k++) {
    p->x[2 * k] = k < SIDE ? -half : half;
    p->x[2 * k + 1] = (k % SIDE + 0.5) * height / SIDE;
  }
  precicec_setMeshVertices("Fluid-Mesh", COUNT, p->x, p->vertex);
}

/* Forces at the end of a step of dt, by the displacements that are known of this moment. */
static void answer(partner *p, double dt) {
  precicec_readData("Fluid-Mesh", "Displacement", COUNT, p->vertex, dt, p->displacement);
  for (int k = 0; k < COUNT; k++) {
    const double moved = p->displacement[2 * k], area = height / SIDE;
    p->force[2 * k] = area * ((k < SIDE ? p->pressure : 0.0) - 0.5 * p->foundation * moved);
    p->force[2 * k + 1] = 0.0;
  }
  precicec_writeData("Fluid-Mesh", "Force", COUNT, p->vertex, p->force);
}

int main(int argc, char **argv) {
  partner p = {0};
  double t = 0.0;
  if (argc != 4 || !(p.pressure = strtod(argv[2], NULL), isfinite(p.pressure)) ||
      !(p.foundation = strtod(argv[3], NULL), p.foundation >= 0.0 && p.foundation < INFINITY)) {
    fprintf(stderr, "usage: precice-partner CONFIG PRESSURE FOUNDATION\n"
                    "PRESSURE in Pa, a number; FOUNDATION in Pa/m, 0 or more\n");
    return 2;
  }
  precicec_createParticipant("Fluid", argv[1], 0, 1);
  place(&p);
  if (precicec_requiresInitialData())
    precicec_writeData("Fluid-Mesh", "Force", COUNT, p.vertex, p.force);
  precicec_initialize();
  while (precicec_isCouplingOngoing()) {
    const double dt = precicec_getMaxTimeStepSize();
    (void)precicec_requiresWritingCheckpoint(); /* it has no state */
    answer(&p, dt);
    precicec_advance(dt);
    if (precicec_requiresReadingCheckpoint() || !precicec_isTimeWindowComplete()) continue;
    t += dt;
    for (int k = 0; k < COUNT; k++)
      if (fabs(p.displacement[2 * k]) > fabs(p.largest))
        p.largest = p.displacement[2 * k], p.at = t;
  }
  precicec_finalize();
  printf("largest displacement %.5g m at %.4g s\n", p.largest, p.at);
  return 0;
}
