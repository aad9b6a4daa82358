/* energy.h - the energy budget of WLS-MPM: changes of energy in each part of a step, measured where
 * they happen, so that the sum is a check. With nodes i, particles p, the velocities v before and
 * v' after a step, and J the impulses on a node,
 *
 *   sum m_i (v'_i - v_i) . v'_i = sum J_i . v'_i,
 *
 * so all works are those of the velocity at the end, with which particles move. The left side is
 * the change of kinetic energy of the nodes and half of sum m |v' - v|^2, which an explicit step
 * dissipates. On the right the works of stresses and loads are found at the particles (G2P is the
 * adjoint of P2G), those of contacts and boundaries at the nodes. The loss of the transfers is the
 * kinetic energy of the particles less that of the nodes, before and after.
 *
 * Sums over blocks, particles and ranks are exact: they do not depend on the partition. On several
 * ranks each has its part of them. SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include "mpm/grid/blocks.h"
#include "mpm/particles/laws.h"
#include "core/base/exact.h"
#include "core/base/room.h"

/* Energies of the particles of a block of cells in the step being made, J. */
typedef struct mpsi_cell_energy {
  double kinetic_before, kinetic;
  double loads;    /* work of gravity, loads and fields of forces */
  double returned; /* part of it by momentum returned from light nodes (cut_gather.c) */
  double stresses; /* work of the nodes against the stresses at the beginning of the step */
  double seen;     /* the same by the derivatives that the laws take */
  double stored;   /* stored part of the work against the mean stresses of the step */
  double spent;    /* dissipated part of that work: plasticity, viscosity */
  double smoothed; /* elastic energy removed by the filter of frictional stresses */
} mpsi_cell_energy;

/* Energies of a block of nodes in the step being made, J. */
typedef struct mpsi_node_energy {
  double kinetic_before, kinetic;
  double jump;     /* half of m |v' - v|^2 */
  double normal;   /* work of the normal forces of bodies */
  double friction; /* work of their friction on the nodes */
  double surface;  /* friction force times the velocity of the bodies */
  double boundaries; /* work of the boundaries' impulses on the nodes */
  double damping;  /* work of damping */
} mpsi_node_energy;

/* J, since creation. */
typedef enum mpsi_energy_sum {
  MPSI_ENERGY_KINETIC, /* change */
  MPSI_ENERGY_KEPT,
  MPSI_ENERGY_SPENT,
  MPSI_ENERGY_SPRINGS,
  MPSI_ENERGY_LOADS, /* works */
  MPSI_ENERGY_BOUNDARIES,
  MPSI_ENERGY_BOUNDARY_LOSS,
  MPSI_ENERGY_FRICTION_LOSS,
  MPSI_ENERGY_DAMPING_LOSS,
  MPSI_ENERGY_TRANSFER,
  MPSI_ENERGY_STEPPING,
  MPSI_ENERGY_STRAIN,
  MPSI_ENERGY_SUMS
} mpsi_energy_sum;

typedef struct mpsi_energy {
  bool counts; /* `budget` of the definition is 1 */
  mpsi_cell_energy *cells;
  mpsi_node_energy *nodes;
  mpsi_exact sum[MPSI_ENERGY_SUMS];
  mpsi_exact step[MPSI_ENERGY_SUMS]; /* sums of the step being made, which may fail */
  double work_bodies;                /* J, since creation, the same on all ranks; */
  double bodies;                     /* J, of the step being made */
  mpsi_room cells_room, nodes_room;
} mpsi_energy;

/* State of particles before their law, for mpsi_mpm_energy_law. */
typedef struct mpsi_before_law {
  double stress[6][64], volume[64];
  double dissipated[64]; /* J/m3; set where the law counts it */
} mpsi_before_law;

/* If there is a budget: adds to the sums of the step being made, or (at_once) to those of the
 * past. */
void mpsi_mpm_energy_add(mpsi_energy *budget, mpsi_energy_sum which, double energy);
void mpsi_mpm_energy_add_at_once(mpsi_energy *budget, mpsi_energy_sum which, double energy);
/* Before the step: memory, and the energy of penalty contact. */
mps_status mpsi_mpm_energy_begin(mps_context *context, const mpsi_grid *grid, const mpsi_columns *p,
                                 const mpsi_contacts *contacts, mpsi_energy *energy,
                                 const mps_mpm_def *def, const char *function);
/* Recoverable energy (J/m3) of an isotropic elastic solid by its stress. */
double mpsi_elastic_energy(const double *s, double bulk, double shear);
/* Kinetic energy of particles [begin, end) of a block before and after G2P; the latter before
 * listed particles get their prescribed velocities (walls.c). */
void mpsi_mpm_energy_before(const mpsi_grid *grid, const mpsi_columns *p, const mpsi_energy *energy,
                            const mpsi_cell_block *cells, int64_t begin, int64_t end);
void mpsi_mpm_energy_after(const mpsi_grid *grid, const mpsi_columns *p, const mpsi_energy *energy,
                           const mpsi_cell_block *cells, int64_t begin, int64_t end);
/* Works of loads and stresses by the velocities of the nodes. */
void mpsi_mpm_energy_moved(const mpsi_grid *grid, const mpsi_columns *p, const mpsi_energy *energy,
                           const mps_mpm_def *def, double dt, const mpsi_cell_block *cells,
                           int64_t begin, int64_t end);
/* Work of loads by momentum returned from light nodes, with `v` the part of a particle's new
 * velocity by it. Forces at the nodes do no work with it, as the fit does not represent it. */
void mpsi_mpm_energy_returned(const mpsi_grid *grid, const mpsi_columns *p,
                              const mpsi_energy *energy, const mps_mpm_def *def, double dt,
                              const mpsi_cell_block *cells, int64_t particle, const double *v);
/* State of at most 64 particles of one law before it; works after it. */
void mpsi_mpm_energy_before_law(const mpsi_grid *grid, const mpsi_columns *p, int64_t begin,
                                int64_t end, mpsi_before_law *out);
void mpsi_mpm_energy_law(const mpsi_grid *grid, const mpsi_columns *p, const mpsi_energy *energy,
                         const mpsi_cell_block *cells, const mpsi_law_use *law,
                         const mps_material_block *block, const mpsi_before_law *before,
                         int64_t begin);
/* Elastic energy, counted as dissipated, of frictional particles [begin, end) whose stresses
 * `before` were filtered after their law (filter.c). */
void mpsi_mpm_energy_smoothed(const mpsi_grid *grid, const mpsi_columns *p,
                              const mpsi_energy *energy, const mpsi_cell_block *cells,
                              const mpsi_before_law *before, int64_t begin, int64_t end);
/* Works at the nodes of block g, after all forces: `held` has their velocities before the
 * boundaries, `damped` those before damping. */
void mpsi_mpm_energy_nodes(const mpsi_grid *grid, const mpsi_contacts *contacts,
                           const mpsi_energy *energy, double dt, int64_t g, const mpsi_node *held,
                           const mpsi_node *damped);
/* After the step: adds its energies to the sums. */
void mpsi_mpm_energy_end(const mpsi_grid *grid, const mpsi_columns *p,
                         const mpsi_contacts *contacts, mpsi_partition *partition,
                         mpsi_energy *energy, const mps_mpm_def *def);
