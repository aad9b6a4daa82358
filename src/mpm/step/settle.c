/* settle.c - static equilibrium by dynamic relaxation with kinetic damping: the particles
 * accelerate towards equilibrium, and are stopped when their kinetic energy has passed a peak,
 * since there the forces are near balance. SPDX-License-Identifier: BSD-3-Clause */
#include "mpm/base/mpm_solver.h"
#include "mpm/boundary/free_field.h"
#include "mpm/particles/mpm_particles.h"
#include "mpm/water/water.h"

#include <mps/experimental/settle.h>
#include <mps/experimental/pore_water.h>

#include <string.h>

#define TOLERANCE 1e-3

/* ---- bodies at rest -------------------------------------------------------------------------- */

static mps_status check_still(mps_context *context, const mpsi_contacts *contacts,
                              mpsi_water *water, const char *function) {
  if (water && water->flows)
    return mpsi_fail(context, function, MPS_ERROR_UNSUPPORTED,
                     "the solver has pore water that flows, and no time passes while the particles "
                     "settle: use mps_mpm_run");
  for (int32_t b = 0; b < contacts->bodies; b++)
    if (contacts->body[b]->def.motion == MPS_BODY_MOTION_FREE)
      return mpsi_fail(context, function, MPS_ERROR_UNSUPPORTED,
                       "body %d moves freely: only what is held or driven stands still while the "
                       "particles settle",
                       b);
  return MPS_OK;
}

static void stop_bodies(const mpsi_contacts *contacts) {
  for (int32_t b = 0; b < contacts->bodies; b++) {
    mpsi_pose *pose = &contacts->body[b]->pose;
    mpsi_contact_state *state = &contacts->state[b];
    memcpy(state->v, pose->v, sizeof pose->v);
    memcpy(state->spin, pose->spin, sizeof pose->spin);
    memset(pose->v, 0, sizeof pose->v);
    memset(pose->spin, 0, sizeof pose->spin);
  }
}

static void release_bodies(const mpsi_contacts *contacts) {
  for (int32_t b = 0; b < contacts->bodies; b++) {
    mpsi_pose *pose = &contacts->body[b]->pose;
    const mpsi_contact_state *state = &contacts->state[b];
    memcpy(pose->v, state->v, sizeof pose->v);
    memcpy(pose->spin, state->spin, sizeof pose->spin);
  }
}

/* ---- particles ------------------------------------------------------------------------------- */

static void stop_block(void *data, int64_t b, int32_t worker) {
  mps_mpm *mpm = data;
  const mpsi_cell_block *cells = &mpm->grid.cells[b];
  const size_t bytes = (size_t)(cells->end - cells->begin) * sizeof(double);
  for (int c = 0; c < mpm->grid.dim; c++) memset(mpm->p.v[c] + cells->begin, 0, bytes);
  for (int c = 0; c < 9; c++)
    if (mpm->p.L[c]) memset(mpm->p.L[c] + cells->begin, 0, bytes);
}

/* All particles stop; the budget counts their kinetic energy as damped. */
static void stop_particles(mps_mpm *mpm) {
  const mpsi_columns *p = &mpm->p;
  for (int64_t k = 0; mpm->energy.counts && k < p->count; k++)
    for (int c = 0; c < mpm->grid.dim; c++) {
      const double kinetic = 0.5 * p->m[k] * p->v[c][k] * p->v[c][k];
      mpsi_mpm_energy_add_at_once(&mpm->energy, MPSI_ENERGY_KINETIC, -kinetic);
      mpsi_mpm_energy_add_at_once(&mpm->energy, MPSI_ENERGY_DAMPING_LOSS, kinetic);
    }
  mpsi_mpm_for_cells(mpm->context, &mpm->grid, &mpm->p, stop_block, mpm);
}

/* ---- settling -------------------------------------------------------------------------------- */

/* Stops the particles of a cancelled mps_mpm_settle before a step of another kind. */
static void leave_settling(mps_mpm *mpm) {
  if (!mpm->settling.cut) return;
  mpm->settling.cut = false;
  stop_particles(mpm);
}

/* Copy of what stopping changes, for a first step that fails: ids, velocities and velocity
 * gradients in the order of the particles. NULL: no memory. */
static double *save_motion(mps_context *context, const mpsi_columns *p, const char *function) {
  const int64_t n = p->count;
  double *saved = mpsi_alloc(context, 13 * n, sizeof *saved);
  if (!saved) {
    (void)mpsi_fail_memory(context, function, (size_t)n * 13 * sizeof *saved);
    return NULL;
  }
  const size_t bytes = (size_t)n * sizeof *saved;
  memcpy(saved, mpsi_particles_integers(p->set, "id"), bytes);
  for (int c = 0; c < 12; c++) {
    const double *column = c < 3 ? p->v[c] : p->L[c - 3];
    if (column) memcpy(saved + (c + 1) * n, column, bytes);
  }
  return saved;
}

static void restore_motion(const mpsi_columns *p, const double *saved) {
  const int64_t n = p->count;
  for (int64_t k = 0; k < n; k++) {
    int64_t id;
    memcpy(&id, &saved[k], sizeof id);
    const int64_t at = mps_particles_index(p->set, id); /* the step may have sorted */
    for (int c = 0; c < 12 && at >= 0; c++) {
      double *column = c < 3 ? p->v[c] : p->L[c - 3];
      if (column) column[at] = saved[(c + 1) * n + k];
    }
  }
}

mps_status mpsi_mpm_step_from_settling(mps_mpm *mpm, const char *function, double dt) {
  if (!mpm->settling.cut) return mpsi_mpm_take_step(mpm, function, dt);
  const int64_t steps = mpm->run.steps;
  const mpsi_energy energy = mpm->energy;
  double *motion = NULL;
  if (!mpm->partition && !(motion = save_motion(mpm->context, &mpm->p, function)))
    return MPS_ERROR_MEMORY;
  leave_settling(mpm);
  const mps_status status = mpsi_mpm_take_step(mpm, function, dt);
  if (motion && status != MPS_OK && mpm->run.steps == steps && !mpm->run.broken) {
    restore_motion(&mpm->p, motion);
    memcpy(mpm->energy.sum, energy.sum, sizeof energy.sum);
    mpm->settling.cut = true;
  }
  mpsi_free(mpm->context, motion);
  return status;
}

enum { UNBALANCED, APPLIED, KINETIC, SUMS };

/* Adds the magnitudes of the contact forces by impulses on this rank's particles (N). */
static void add_impulses(const mpsi_contacts *contacts, double dt, mpsi_exact *sum) {
  const mpsi_impulses *all = &contacts->impulses;
  for (int64_t n = 0; n < all->constraint_count; n++) {
    const mpsi_impulse *c = &all->constraint[n].impulse;
    if (!(c->normal_impulse > 0.0) || all->constraint[n].pair < 0) continue;
    double square = 0.0;
    for (int a = 0; a < 3; a++) {
      const double by = c->normal_impulse * c->normal[a] + c->tangent_impulse[a];
      square += by * by;
    }
    mpsi_exact_add(sum, sqrt(square) / dt);
  }
}

/* Sums over the blocks of all ranks: exact, independent of the partition. */
static mps_status sum_balance(const mpsi_grid *grid, const mpsi_contacts *contacts,
                              mpsi_partition *partition, const mpsi_settling *settling, double dt,
                              const char *function, double *sums) {
  mpsi_exact sum[SUMS];
  mps_status status = MPS_OK;
  memset(sum, 0, sizeof sum);
  sum[APPLIED] = settling->applied;
  add_impulses(contacts, dt, &sum[APPLIED]);
  for (int64_t g = 0; g < mpsi_all_nodes(grid); g++) {
    const mpsi_node_balance *n = &settling->nodes[g];
    if (partition && !mpsi_mpm_counts_node_block(grid, g)) continue;
    mpsi_exact_add(&sum[UNBALANCED], n->unbalanced);
    mpsi_exact_add(&sum[APPLIED], n->applied);
    mpsi_exact_add(&sum[KINETIC], n->kinetic);
  }
  if (partition) status = mpsi_domain_sum_exact(partition->domain, function, SUMS, sum);
  for (int k = 0; k < SUMS; k++) sums[k] = mpsi_exact_value(&sum[k]);
  return status;
}

/* The given dt may be that of implicit pressures, which are explicit here: below. */
static double settling_dt(const mps_mpm *mpm) {
  const double dt = mpsi_mpm_dt(mpm), most = mpm->def.courant * mpsi_mpm_limit(mpm);
  return mpm->water && most < dt ? most : dt;
}

/* One step of the relaxation; the time of the run does not change. */
static mps_status relax(mps_mpm *mpm, const char *function, mps_mpm_settled *now) {
  const double time = mpm->run.time;
  mps_status status = mpsi_mpm_check_bounded(mpm, function);
  if (status == MPS_OK) status = mpsi_mpm_take_step(mpm, function, settling_dt(mpm));
  mpm->run.time = time;
  double sums[SUMS];
  if (status == MPS_OK)
    status = sum_balance(&mpm->grid, &mpm->contact, mpm->partition, &mpm->settling, mpm->run.dt,
                         function, sums);
  if (status != MPS_OK) return status;
  now->kinetic = sums[KINETIC];
  now->applied = sums[APPLIED];
  now->unbalanced = sums[UNBALANCED] > 0.0 ? sums[UNBALANCED] / now->applied : 0.0;
  now->steps = ++mpm->settling.steps;
  return MPS_OK;
}

static mps_status relax_until(mps_mpm *mpm, const char *function, const mps_mpm_settle_def *def,
                              mps_mpm_settled *now) {
  mpsi_settling *settling = &mpm->settling;
  while (settling->steps < def->max_steps) {
    MPSI_TRY(relax(mpm, function, now));
    const bool balanced = now->unbalanced <= def->tolerance;
    if (balanced && settling->from_rest) return MPS_OK;
    settling->from_rest = balanced || now->kinetic < settling->before;
    settling->before = settling->from_rest ? 0.0 : now->kinetic;
    now->peaks = settling->peaks += settling->from_rest;
    if (settling->from_rest) stop_particles(mpm);
    if (now->steps % 100 == 0)
      mpsi_progress(mpm->context, "mpm settle", mpm->run.steps, (double)now->steps,
                    (double)def->max_steps);
    if (mpm->partition ? !mpm->partition->cancel : !mpsi_cancelled(mpm->context)) continue;
    settling->cut = true;
    return mpsi_fail(mpm->context, function, MPS_ERROR_CANCELLED,
                     "stopped by the cancel hook after %lld steps, the unbalanced force being "
                     "%.3g of the applied",
                     (long long)now->steps, now->unbalanced);
  }
  return mpsi_fail(mpm->context, function, MPS_ERROR_NUMERIC,
                   "no equilibrium after %lld steps: the unbalanced force is %.3g of the applied "
                   "%.4g N, above the tolerance %.3g; more steps, or there is none (the ground "
                   "flows)",
                   (long long)now->steps, now->unbalanced, now->applied, def->tolerance);
}

/* Pressures of undrained ground follow from its volumes at rest, whatever the scheme. Explicit ones
 * do so without an error in time, and stay stable where particles are stopped again and again. */
static mps_status relax_with_explicit_pressures(mps_mpm *mpm, const char *function,
                                                const mps_mpm_settle_def *def,
                                                mps_mpm_settled *now) {
  mpsi_pore_set_scheme(mpm, MPS_PORE_SCHEME_EXPLICIT);
  mps_status status = mpsi_mpm_collect_block_results(mpm, function);
  if (status == MPS_OK) status = relax_until(mpm, function, def, now);
  mpsi_pore_set_scheme(mpm, MPS_PORE_SCHEME_IMPLICIT);
  if (mpm->run.broken) return status;
  const mps_status limit = mpsi_mpm_collect_block_results(mpm, function);
  return status == MPS_OK ? limit : status;
}

static mps_status read_def(mps_context *context, const char *function,
                           const mps_mpm_settle_def *user, mps_mpm_settle_def *def) {
  *def = mps_mpm_settle_defaults();
  MPSI_TRY(MPSI_DEF_READ_OR_DEFAULTS(context, function, mps_mpm_settle_def, user, def));
  if (isnan(def->tolerance)) def->tolerance = TOLERANCE;
  return MPS_OK;
}

/* The column of a free-field side moves in time, and is made of ground that has settled. */
static mps_status check_sides(mps_context *context, const mpsi_boundaries *boundaries,
                              const char *function) {
  if (!mpsi_mpm_has_free_field(boundaries)) return MPS_OK;
  return mpsi_fail(context, function, MPS_ERROR_STATE,
                   "a side is of kind MPS_BOUNDARY_FREE_FIELD: settle with MPS_BOUNDARY_ROLLER, "
                   "then make it one");
}

mps_status mps_mpm_settle_sized(mps_mpm *mpm, const mps_mpm_settle_def *user, mps_mpm_settled *out,
                                size_t size) {
  static const char function[] = "mps_mpm_settle";
  if (!mpm) return mpsi_null(__func__, "mpm");
  mps_mpm_settle_def def = mps_mpm_settle_defaults();
  mps_mpm_settled now = {0};
  const mpsi_edit_state before = mpsi_mpm_edit_state(&mpm->run);
  if (out && (size == 0 || size > MPSI_STRUCT_MOST)) /* refused before anything moves */
    return mpsi_out_write(mpm->context, function, out, size, &now, sizeof now);
  mps_status status = mpsi_mpm_ready(mpm, function);
  if (status == MPS_OK) status = read_def(mpm->context, function, user, &def);
  if (status == MPS_OK) status = check_still(mpm->context, &mpm->contact, mpm->water, function);
  if (status == MPS_OK) status = check_sides(mpm->context, &mpm->boundaries, function);
  if (status == MPS_OK && out) status = mpsi_out_check(mpm->context, function, out, size);
  if (mpm->partition) {
    mpsi_given given = MPSI_GIVEN;
    MPSI_GIVE_DEF(&given, mps_mpm_settle_def, &def);
    status = mpsi_domain_agree_given(mpm->domain, function, status, &given);
  }
  double *motion = status == MPS_OK ? save_motion(mpm->context, &mpm->p, function) : NULL;
  if (status == MPS_OK && !motion) status = MPS_ERROR_MEMORY;
  status = mpsi_mpm_agree(mpm->partition, function, status);
  if (status != MPS_OK) {
    mpsi_free(mpm->context, motion);
    mpsi_mpm_restore_edit_state(&mpm->run, &before);
    return status;
  }
  mpsi_settling *settling = &mpm->settling;
  const mpsi_settling former = *settling;
  const mpsi_energy energy = mpm->energy;
  stop_bodies(&mpm->contact);
  if (!settling->cut) { /* else continues from the state of the cancellation */
    stop_particles(mpm);
    settling->from_rest = true;
    settling->before = 0.0;
    settling->steps = settling->peaks = 0;
  }
  now.peaks = settling->peaks;
  settling->on = true;
  settling->cut = false;
  mpsi_guard_enter(&mpm->guard, mpm->context, function);
  if (mpm->water && mpm->water->def.scheme == MPS_PORE_SCHEME_IMPLICIT)
    status = relax_with_explicit_pressures(mpm, function, &def, &now);
  else
    status = relax_until(mpm, function, &def, &now);
  mpsi_guard_end(&mpm->guard);
  if (!mpm->run.broken && !settling->cut) stop_particles(mpm);
  release_bodies(&mpm->contact);
  settling->on = false;
  mpm->run.changed = mpm->run.renewed = true; /* works were not counted */
  if (status != MPS_OK && settling->steps == former.steps * former.cut && !mpm->partition &&
      !mpm->run.broken) { /* no step was made */
    restore_motion(&mpm->p, motion);
    memcpy(mpm->energy.sum, energy.sum, sizeof energy.sum);
    settling->cut = former.cut, settling->from_rest = former.from_rest;
    settling->before = former.before;
    settling->steps = former.steps, settling->peaks = former.peaks;
    mpsi_mpm_restore_edit_state(&mpm->run, &before);
  }
  mpsi_free(mpm->context, motion);
  if (!out) return status;
  const mps_status written = mpsi_out_write(mpm->context, function, out, size, &now, sizeof now);
  return status == MPS_OK ? written : status;
}
