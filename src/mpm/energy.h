/* energy.h - the energy budget of WLS-MPM: what each part of a step does to the energy, measured
 * where it happens, so that the sum is a check. With nodes i, particles p, the velocities v before
 * and v' after a step, and J the impulses on a node,
 *
 *   sum m_i (v'_i - v_i) . v'_i = sum J_i . v'_i,
 *
 * so all works are those of the velocity at the end, with which particles move. The left side is
 * the change of kinetic energy of the nodes and half of sum m |v' - v|^2, which an explicit step
 * loses. On the right the works of stresses and loads are found at the particles (G2P is the
 * adjoint of P2G), those of contacts and boundaries at the nodes. What the transfers take is the
 * kinetic energy of the particles less that of the nodes, before and after.
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef MPSI_MPM_ENERGY_H
#define MPSI_MPM_ENERGY_H

#include "blocks.h"
#include "laws.h"
#include "core/room.h"

/* J, of the step being made, of the particles of a block of cells. */
typedef struct mpsi_cell_energy {
  double kinetic_before, kinetic;
  double loads;    /* work of gravity, loads and fields of forces */
  double stresses; /* work of the nodes against the stresses at the beginning of the step */
  double seen;     /* the same by the gradient that the laws see */
  double kept;     /* work against the mean stresses of the step that the laws keep */
  double spent;    /* the rest of that: plasticity, viscosity */
} mpsi_cell_energy;

/* Likewise of a block of nodes. */
typedef struct mpsi_node_energy {
  double kinetic_before, kinetic;
  double jump;     /* half of m |v' - v|^2 */
  double normal;   /* work of the normal forces of bodies */
  double friction; /* work of their friction on the nodes */
  double surface;  /* the same force times the velocity of the bodies */
  double holds;    /* work of the boundaries' impulses on the nodes */
  double damping;  /* work of damping */
} mpsi_node_energy;

/* J, since creation. */
typedef struct mpsi_energy_sums {
  double kinetic; /* change */
  double kept, spent, springs;
  double loads, boundaries, bodies; /* works */
  double boundary_loss, friction_loss, damping_loss;
  double transfer, stepping, strain;
} mpsi_energy_sums;
enum { MPSI_ENERGY_SUMS = 13 };

typedef struct mpsi_energy {
  bool counts; /* the definition asks for the budget */
  mpsi_cell_energy *cells;
  mpsi_node_energy *nodes;
  mpsi_energy_sums sum;
  /* Of the step being made: */
  double boundaries, bodies;  /* works */
  double mirrored;            /* work of the particles' forces on what moving mirrors add */
  double driven, driven_work; /* held particles: change of kinetic energy, work */
  double springs;             /* of contacts, at the end of the last step that was counted */
  bool springs_known;
  mpsi_room cells_room, nodes_room;
} mpsi_energy;

/* What mpsi_mpm_energy_law needs of a run of particles from before their law. */
typedef struct mpsi_before_law {
  double stress[6][64], volume[64];
} mpsi_before_law;

/* Before the step: room, and the springs where contacts or places have changed. */
mps_status mpsi_mpm_energy_begin(mps_mpm *mpm, const char *function);
/* Particles [begin, end) of a block: before and after G2P. */
void mpsi_mpm_energy_before(mps_mpm *mpm, const mpsi_cell_block *cells, int64_t begin, int64_t end);
void mpsi_mpm_energy_moved(mps_mpm *mpm, const mpsi_cell_block *cells, int64_t begin, int64_t end);
/* Particles of one law, at most 64 of them: before it, and after. */
void mpsi_mpm_energy_keep(const mps_mpm *mpm, int64_t begin, int64_t end, mpsi_before_law *out);
void mpsi_mpm_energy_law(mps_mpm *mpm, const mpsi_cell_block *cells, const mpsi_law_use *law,
                         const mps_material_block *block, const mpsi_before_law *before,
                         int64_t begin);
/* Nodes of block g, all forces known: `held` has their velocities before the boundaries, `damped`
 * those before damping. */
void mpsi_mpm_energy_nodes(mps_mpm *mpm, int64_t g, const mpsi_node *held, const mpsi_node *damped);
/* After the step: adds it to the sums. */
void mpsi_mpm_energy_end(mps_mpm *mpm);

#endif
