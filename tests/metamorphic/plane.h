/* plane.h - scenes of a lattice of particles in the plane: what layers of explicit dynamics and
 * blocks of implicit elasticity share. SPDX-License-Identifier: BSD-3-Clause */
#ifndef TESTS_METAMORPHIC_PLANE_H
#define TESTS_METAMORPHIC_PLANE_H

#include "metamorphic.h"

#define TRY(call)                                                                                  \
  do {                                                                                             \
    if (status == MPS_OK) status = (call);                                                         \
  } while (0)

#define SPACING 0.5 /* m */
enum { EDGES = 4 }; /* left, right, bottom, top */

/* The first member of a scene: what its seed chose, and what is made of it under a change. */
typedef struct lattice {
  int nx, ny;
  int32_t kind[EDGES]; /* of the boundary; -1: none */
  bool moves[EDGES][2];
  double contrast, frequency, amplitude, phase, traction[2];
  int64_t steps[2];
  uint64_t random;
  const change *by;
  mps_context *context;
  mps_particles *set;
  mps_solver *solver;
} lattice;

typedef mps_status (*lattice_fn)(lattice *g);

/* The particles, the first at `first`: of density 1900 kg/m3, with random velocities. */
mps_status make_lattice(lattice *g, const double *first);
/* Divides a field by the contrast in the upper half. */
mps_status soften(lattice *g, const char *field);
/* The signal that drives edges. */
mps_status make_signal(lattice *g, mps_signal **out);
/* Ids of the particles at an edge; returns their number. */
int64_t list_edge(const lattice *g, int edge, int64_t *ids);
/* Builds, takes the steps in the way of the change, and keeps the result; `place`: the field that
 * says where particles are. */
void run_lattice(lattice *g, lattice_fn build, const char *place, const char *folder, result *out);
void print_lattice(const lattice *g);

#endif
