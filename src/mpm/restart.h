/* restart.h - what a checkpoint keeps of the WLS-MPM solver besides the fields of its set: for the
 * files of src/io. SPDX-License-Identifier: BSD-3-Clause */
#ifndef MPSI_MPM_RESTART_H
#define MPSI_MPM_RESTART_H

#include "body/body.h"

#include <mps/mpm.h>

#define MPSI_MATERIAL_NAME 64 /* bytes, with the terminating zero */

/* A block of cells: its first particle, where it is (3), and the part of its tile in use (low 3,
 * high 3). The particles' present places do not tell: these are those of the last sort. */
enum { MPSI_BLOCK_AT = 1, MPSI_BLOCK_LOW = 4, MPSI_BLOCK_HIGH = 7, MPSI_BLOCK = 10 };
typedef int64_t mpsi_block[MPSI_BLOCK];

/* At a node of an absorbing wall. */
typedef struct mpsi_dash {
  double across, along; /* rho c A, kg/s */
  double rest[3];       /* N, force of the wall at rest */
} mpsi_dash;
enum { MPSI_DASH = 5 }; /* doubles */

#define MPSI_WALLS 6 /* 2 axis + upper */
#define MPSI_HOLDS (MPSI_WALLS + MPS_MPM_MAX_BOXES)

typedef struct mpsi_mpm_record {
  /* what must agree */
  char material[MPS_MPM_MAX_MATERIALS][MPSI_MATERIAL_NAME];
  int64_t geometry, scheme, spline, bodies, materials;
  int64_t loads, accelerated; /* loads; whether there are body accelerations */
  int64_t kind[MPSI_HOLDS];   /* of walls and boxes */
  int64_t low[3], high[3];    /* nodes of the walls */
  double cell, origin[3];
  /* the state */
  int64_t stale;
  double speed;
  mpsi_block *block; /* this and dash: of the allocator of the context */
  int64_t blocks;
  mpsi_dash *dash;
  int64_t dashes;
  int64_t finds[MPSI_HOLDS];
  double found[MPSI_HOLDS], force[MPSI_HOLDS * 3];
  mpsi_body_record body[MPS_MPM_MAX_BODIES];
} mpsi_mpm_record;

mps_context *mpsi_mpm_context(const mps_mpm *mpm);
mps_particles *mpsi_mpm_particles(const mps_mpm *mpm);

/* Fills an empty record; the caller frees `block` and `dash`, on an error too. */
mps_status mpsi_mpm_get_record(const mps_mpm *mpm, const char *function, mpsi_mpm_record *out);
/* MPS_ERROR_ARGUMENT where the record in the file `path` is of another solver than this. */
mps_status mpsi_mpm_check_record(const mps_mpm *mpm, const char *function, const char *path,
                                 const mpsi_mpm_record *record);
/* Whether the record's blocks are in order and hold the particles at x, dim columns one behind the
 * other in the file's order, and these are of laws that there are (`law` NULL: of the first). A
 * step relies on it: a stencil outside its tile is memory outside. */
bool mpsi_mpm_fits_record(const mps_mpm *mpm, mpsi_mpm_record *record, const double *x,
                          const int64_t *law);
/* Puts back a record that fits, the fields being in place. MPS_ERROR_MEMORY: the solver is broken
 * until another record is put. */
mps_status mpsi_mpm_set_record(mps_mpm *mpm, const char *function, const mpsi_mpm_record *record,
                               double time, int64_t steps);

#endif
