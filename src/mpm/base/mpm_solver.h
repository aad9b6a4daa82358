/* mpm_solver.h - the WLS-MPM solver as a whole, for public functions and the stages of a step: its
 * parts, and what the subfolders below a step work on, made from it. SPDX-License-Identifier:
 * BSD-3-Clause */
#pragma once

#include "energy.h"
#include "kernels.h"
#include "mpm/boundary/boundaries.h"
#include "mpm/boundary/mirror.h"
#include "mpm/contact/pairs.h"
#include "mpm/contact/prescribed.h"
#include "mpm/contact/thin_bodies.h"
#include "mpm/particles/loads.h"
#include "mpm/particles/rooms.h"
#include "mpm/ranks/partition.h"
#include "mpm/step/damping.h"
#include "mpm/step/undo.h"
#include "core/particles/particles_internal.h"
#include "run.h"
#include "solver/solver_base.h"

/* The handle of mps/grid.h, which the solver owns. */
struct mps_grid {
  mps_mpm *mpm;
};

struct mps_mpm {
  MPSI_SOLVER_BASE;
  struct mps_grid reader;
  mps_mpm_def def;
  const mpsi_kernels *kernels;
  mps_kernel *weights; /* weight function, for queries of the caller */
  mpsi_columns p;
  mpsi_rooms rooms;
  mpsi_grid grid;
  mpsi_contacts contact;
  mpsi_prescribed prescribed;
  mpsi_boundaries boundaries;
  mpsi_mirrors mirrors;
  mpsi_loads loads;
  mpsi_run run;
  mpsi_undo undo;
  mpsi_bound bound;
  mpsi_energy energy;
  mpsi_settling settling;
  mpsi_water *water;         /* pore water (water/water.h); NULL: none */
  mpsi_partition *partition; /* parts on several ranks; NULL: one rank */
};

double mpsi_mpm_limit(const void *mpm); /* limit.c */
double mpsi_mpm_dt(const mps_mpm *mpm);

/* While the ground settles nothing is kept: how it moves until it rests has no meaning. */
static inline double mpsi_kept_velocity(const mps_mpm *mpm) {
  return mpm->settling.on ? 0.0
                          : mpsi_kept_fraction(&mpm->def, &mpm->p, mpm->run.dt,
                                               mpsi_wave_time(&mpm->run, mpm->grid.cell));
}

/* The transfer of a solver, of no block of cells yet. */
static inline mpsi_transfer mpsi_transfer_begin(mps_mpm *mpm) {
  return (mpsi_transfer){.grid = &mpm->grid,
                         .p = &mpm->p,
                         .contact = &mpm->contact,
                         .boundaries = &mpm->boundaries,
                         .mirrors = &mpm->mirrors,
                         .water = mpm->water,
                         .energy = &mpm->energy,
                         .run = &mpm->run,
                         .def = &mpm->def,
                         .keep = mpsi_kept_velocity(mpm)};
}

/* The transfer of block of cells b by a worker. */
static inline mpsi_transfer mpsi_transfer_of(mps_mpm *mpm, int64_t b, int32_t worker) {
  mpsi_transfer work = mpsi_transfer_begin(mpm);
  work.cells = &mpm->grid.cells[b];
  work.worker = &mpm->grid.workers[worker];
  return work;
}

static inline mpsi_contact_stage mpsi_contact_stage_of(mps_mpm *mpm) {
  return (mpsi_contact_stage){
      .context = mpm->context,
      .transfer = mpsi_transfer_begin(mpm),
      .contact = &mpm->contact,
      .prescribed = mpm->prescribed.on && mpm->contact.bodies > 0 ? &mpm->prescribed : NULL,
      .partition = mpm->partition,
      .kernels = mpm->kernels,
      .next_dt = mpsi_mpm_dt(mpm),
      .settling = mpm->settling.on};
}

/* The stage in which lists of particles are imposed on the nodes (contact/prescribed.h). */
static inline mpsi_contact_stage mpsi_prescribed_stage_of(mps_mpm *mpm) {
  mpsi_contact_stage stage = mpsi_contact_stage_of(mpm);
  stage.contact = &mpm->prescribed.constraints;
  stage.prescribed = &mpm->prescribed;
  return stage;
}

static inline mpsi_rank_part mpsi_rank_part_of(mps_mpm *mpm) {
  return (mpsi_rank_part){.context = mpm->context,
                          .grid = &mpm->grid,
                          .p = &mpm->p,
                          .rooms = &mpm->rooms,
                          .water = mpm->water,
                          .contact = &mpm->contact,
                          .run = &mpm->run,
                          .def = &mpm->def,
                          .partition = mpm->partition};
}

static inline mpsi_boundary_setup mpsi_boundary_setup_of(mps_mpm *mpm) {
  return (mpsi_boundary_setup){.context = mpm->context,
                               .grid = &mpm->grid,
                               .p = &mpm->p,
                               .boundaries = &mpm->boundaries,
                               .mirrors = &mpm->mirrors,
                               .partition = mpm->partition,
                               .run = &mpm->run,
                               .def = &mpm->def,
                               .water = mpm->water,
                               .has_relaxation = mpm->settling.cut};
}

static inline mpsi_contact_setup mpsi_contact_setup_of(mps_mpm *mpm) {
  return (mpsi_contact_setup){.context = mpm->context,
                              .grid = &mpm->grid,
                              .p = &mpm->p,
                              .rooms = &mpm->rooms,
                              .contact = &mpm->contact,
                              .partition = mpm->partition,
                              .run = &mpm->run,
                              .def = &mpm->def};
}

/* ---- a step and what comes before it --------------------------------------------------------- */

/* step.c: one step of dt, in one process or on several ranks. On an error nothing
 * has changed, unless a particle has left the domain (run.lost: the step is complete) or has values
 * that are not finite (run.broken). */
mps_status mpsi_mpm_take_step(mps_mpm *mpm, const char *function, double dt);
/* settle.c: mpsi_mpm_take_step, before which the particles stop where mps_mpm_settle was cancelled.
 * A step that fails has changed nothing (on several ranks they stay at rest). */
mps_status mpsi_mpm_step_from_settling(mps_mpm *mpm, const char *function, double dt);
/* signals.c: evaluates the signals of loads and boundaries, and of bodies (`moves`) at the end of
 * the step of dt. Not collective: `function` continues with the status until all ranks agree on
 * one. */
mps_status mpsi_mpm_evaluate_signals(mps_mpm *mpm, const char *function, double dt, bool moves);
/* ready.c: applies the caller's edits, additions and removals: masses, blocks of the present
 * positions, the Courant limit of the present velocities. */
mps_status mpsi_mpm_apply_edits(mps_mpm *mpm, const char *function);
/* ready.c: MPS_ERROR_STATE in a callback of the solver, after a step that has failed, or while a
 * field is edited. */
mps_status mpsi_mpm_usable(mps_mpm *mpm, const char *function);
/* ready.c: mpsi_mpm_apply_edits, refused in a callback of the solver. */
mps_status mpsi_mpm_ready(mps_mpm *mpm, const char *function);
/* ready.c: MPS_ERROR_STATE unless the next step changes the time in double precision. */
mps_status mpsi_mpm_check_advance(mps_mpm *mpm, const char *function);
/* ready.c: likewise for a step outside a run; without particles dt must be given. */
mps_status mpsi_mpm_check_bounded(mps_mpm *mpm, const char *function);
/* ready.c: sorts the particles by blocks and rebuilds the lists of blocks. */
mps_status mpsi_mpm_sort(mps_mpm *mpm, const char *function);
/* inset_edges.c: once particles and bodies have moved, moves particles in the strips beyond inset
 * edges off their bodies. */
void mpsi_mpm_clear_strips(mps_mpm *mpm);
/* cut.c: before a step, pairs of blocks and bodies, nodes inside bodies, and which blocks are cut
 * and split (contact/pairs.h). `status`: of the step so far on this rank; collective where there
 * are bodies. */
mps_status mpsi_mpm_find_near(mps_mpm *mpm, const char *function, mps_status status);
/* ready.c: before the blocks are used: finds the ghosts of the present blocks, sorted or not.
 * Collective. */
mps_status mpsi_mpm_partition_update(mps_mpm *mpm, const char *function, mps_status status);
/* ready.c: the largest c + |v| of each block of cells, and its first bad particle. */
void mpsi_mpm_find_speeds(mps_mpm *mpm);
/* block_results.c: the error of the first bad particle of this rank, whose step is to be undone. */
mps_status mpsi_mpm_report_undone(mps_mpm *mpm, const char *function);
/* block_results.c: results of all blocks: the largest speed, or the error of a bad particle. */
mps_status mpsi_mpm_collect_block_results(mps_mpm *mpm, const char *function);
/* signals.c: the worst status of all ranks, whether they have the same time, bodies and signals in
 * the step, and the largest of `count` values. Collective. */
mps_status mpsi_mpm_agree_in_step(mps_mpm *mpm, const char *function, mps_status status,
                                  int32_t count, double *values);
