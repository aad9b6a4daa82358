/* damping.h - damping at the nodes, after all forces and boundaries; and the unbalanced force of
 * the nodes, for mps_mpm_settle. SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include "mpm/base/energy.h"
#include "core/base/exact.h"

/* A block of nodes in a step of mps_mpm_settle. */
typedef struct mpsi_node_balance {
  double kinetic;    /* J, after the step */
  double unbalanced; /* N, sum over nodes of the magnitude of the unbalanced force */
  double applied;    /* N, sum over nodes of the magnitudes of contact and boundary forces */
} mpsi_node_balance;

typedef struct mpsi_settling {
  bool on;  /* in mps_mpm_settle: bodies and boundaries are at rest */
  bool cut; /* a call was cancelled, and no step has been taken since */
  /* Of the cancelled call, for the one that continues it: */
  bool from_rest;
  double before;        /* J, kinetic energy of the last step; 0 from rest */
  int64_t steps, peaks; /* so far */
  mpsi_exact applied;   /* N, sum of the magnitudes of gravity and loads on this rank's particles */
  mpsi_node_balance *nodes;
  mpsi_room nodes_room;
} mpsi_settling;

/* Before a step of mps_mpm_settle: memory, and the forces applied to the particles, some of which
 * may leave in the step. */
mps_status mpsi_mpm_begin_balance(mps_context *context, const mpsi_grid *grid,
                                  const mpsi_columns *p, mpsi_settling *s, const mps_mpm_def *def,
                                  const char *function);
/* Energy and unbalanced force of the nodes of block g. `fixed`: bit c: component c of the node is
 * prescribed; `held`: velocities before the boundaries. */
void mpsi_mpm_measure_balance(const mpsi_grid *grid, const mpsi_contacts *contacts,
                              const mpsi_settling *settling, double dt, int64_t g,
                              const uint8_t *fixed, const mpsi_node *held);
/* Damps the velocities of the nodes of block g, but not their prescribed components (`fixed`). */
void mpsi_mpm_damp_nodes(const mpsi_grid *grid, const mps_mpm_def *def, double dt, int64_t g,
                         const uint8_t *fixed);

/* Whether each node needs its velocity before the forces, so that all blocks are split. */
static inline bool mpsi_forces_apart(const mpsi_energy *energy, const mpsi_settling *settling,
                                     const mpsi_columns *p, const mps_mpm_def *def) {
  return energy->counts || settling->on || def->local_damping > 0.0 || mpsi_keeps_velocity(def, p);
}
