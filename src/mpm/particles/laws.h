/* laws.h - the materials' laws of the particles. SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include "mpm/base/parts.h"
#include "core/base/room.h"
#include "material/material_internal.h"

#include <mps/mpm.h>

#define MPSI_CHUNK 64 /* particles: what is prepared for them stays in the first-level cache */

typedef struct mpsi_law_use {
  mps_material *material;
  double modulus; /* K + 4G/3 at zero strain, Pa */
  double bulk;    /* K at zero strain, Pa */
  bool reads_volume, needs_deformation;
  bool own_volume; /* it takes each particle's own change of volume, not a mean (volumetric.c) */
  bool filtered;   /* its mean stress is filtered (filter.c) */
  int32_t strain, gap; /* then the columns of its plastic strain and of the opening */
  int32_t opening;     /* column of the opening, filtered or not; -1: none */
  int32_t columns;
  double **history;        /* columns over all particles; NULL for none */
  const double *stiffness; /* factor of the moduli of each particle, 0 for 1; NULL: 1 */
} mpsi_law_use;

/* Why a law has refused a block in the step being made: that of the first block with one. */
typedef struct mpsi_refusal {
  atomic_flag busy;
  const mpsi_cell_block *cells; /* NULL: none has refused */
  const mps_material *material;
  mps_status status;
  int64_t particle; /* index, or -1 */
  char message[MPSI_MATERIAL_MESSAGE];
} mpsi_refusal;

typedef struct mpsi_laws {
  mpsi_law_use *law; /* 0: of creation */
  int32_t count;
  mpsi_room room;     /* of these */
  bool one_modulus;   /* law[0].modulus is that of all particles, whatever their state */
  bool at_once;       /* all laws act within G2P, by each particle's own change of volume */
  bool some_own;      /* some law takes each particle's own change of volume, */
  bool some_filtered; /* its mean stress is filtered */
  bool some_open;     /* some law has a gap between its grains */
  bool some_flow;     /* some law is one of a body that may flow slowly */
  bool soaked;        /* explicit pressures of pore water: see mpsi_mpm_soak_laws */
  const int64_t *ids;
  const double *temperature; /* NULL where the set has no such field */
  mpsi_refusal refusal;
} mpsi_laws;

/* The laws on one block of cells. */
typedef struct mpsi_law_block {
  const mpsi_grid *grid;
  mpsi_columns *p;
  const mpsi_run *run;
  const mpsi_energy *energy;
  const mpsi_cell_block *cells;
  mps_material_block *seen; /* particles as a law sees them; begun once for all of the block of
                               cells, as emptying it takes as long as filling it for a chunk */
} mpsi_law_block;

/* laws.c: the laws of particles [begin, end) of a block, at most a chunk, with the velocity
 * gradients of the columns `D` of these particles, as mpsi_columns.D; `mean`: their diagonals by
 * volumetric.c, or NULL. */
void mpsi_mpm_begin_block(mps_material_block *seen);
void mpsi_mpm_apply_law(const mpsi_law_block *laws, int64_t begin, int64_t end, double *const *D,
                        double (*mean)[MPSI_CHUNK]);
/* laws.c: after the laws of particles [begin, begin + n), at most a chunk, with the diagonal `rate`
 * (1/s) of their velocity gradients (the third NULL: 0), whose volumes were `former` (m3) before.
 * Where grains are drawn apart V stays, and the water that fills the gap has the strain of the
 * motion: of laws with a gap `former` becomes the volume that this strain makes V of. */
void mpsi_mpm_follow_motion(const mpsi_columns *p, double dt, const double *const *rate,
                            int64_t begin, int n, double *former);
/* laws.c: the returns to the yield surface of those among particles [begin, end), at most a chunk,
 * whose stress is filtered, without strain. */
void mpsi_mpm_return_stress(const mpsi_grid *grid, mpsi_columns *p, const mpsi_run *run,
                            const mpsi_cell_block *cells, int64_t begin, int64_t end);
/* laws.c: the present wave moduli of particles [begin, end), raised where viscosity limits dt; the
 * largest speed (m/s) whose Courant limit is that of the flow of pore water, and that of waves
 * without water that flows; both 0 where none does. */
typedef struct mpsi_pore_speeds {
  double flow, wave;
} mpsi_pore_speeds;
void mpsi_mpm_find_moduli(const mpsi_grid *grid, const mpsi_columns *p, mpsi_water *water,
                          const mpsi_run *run, const mps_mpm_def *def, int64_t begin, int64_t end,
                          double *moduli, mpsi_pore_speeds *pores);
/* materials.c: what the laws take under explicit pressures of pore water, from here on, for which
 * mpsi_mpm_soak_room has made room. The water fills the cell, whose volume it keeps; by its own
 * change of volume each particle would bear a mean stress of its own besides. One that is drawn
 * apart bears none and opens, the others are compressed by as much: the strength of sand that flows
 * at constant volume grew without end. So frictional laws without dilation take the mean by cell.
 */
bool mpsi_mpm_soak_room(mps_context *context, const mpsi_grid *grid, mpsi_columns *p,
                        mpsi_rooms *rooms, const mps_mpm_def *def);
void mpsi_mpm_soak_laws(mpsi_columns *p, const mps_mpm_def *def);
/* materials.c: puts the law at the end of the list, with the fields it works on; nothing has
 * changed on an error. Gives the particle (an index) the state in which the law begins. */
mps_status mpsi_mpm_add_law(mps_context *context, const mpsi_grid *grid, mpsi_columns *p,
                            mpsi_rooms *rooms, const mps_mpm_def *def, const char *function,
                            mps_material *material);
/* materials.c: MPS_ERROR_ARGUMENT where the law cannot begin in the state of the particle, which
 * the message names. `columns`: found once for the law. */
typedef struct mpsi_first_state {
  const mps_material *material;
  const double *history[MPSI_MATERIAL_COLUMNS]; /* NULL: the set has no such field yet */
} mpsi_first_state;
void mpsi_mpm_find_state(const mpsi_columns *p, const mps_material *material,
                         mpsi_first_state *out);
mps_status mpsi_mpm_check_state(mps_context *context, const mpsi_grid *grid, const mpsi_columns *p,
                                const char *function, const mpsi_first_state *first,
                                int64_t particle);
/* Of those of the particles [begin, end) that are under law `number`. */
mps_status mpsi_mpm_check_states(mps_context *context, const mpsi_grid *grid, const mpsi_columns *p,
                                 const char *function, int32_t number, int64_t begin, int64_t end);
/* materials.c: where the columns of a law's own fields are now. */
void mpsi_mpm_bind_law(mpsi_columns *p, mpsi_law_use *law);
void mpsi_mpm_begin_law(const mpsi_grid *grid, const mpsi_columns *p, const mpsi_law_use *law,
                        int64_t particle);
