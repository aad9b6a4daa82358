/* impulses.c - contact impulses of a step, by sweeps of projected Gauss-Seidel over the contact
 * constraints (constraints.c): each update satisfies one constraint exactly with all others as they
 * are (contact/impulse.h), and changes its nodes by psi_i J/m_i at once (sweep.c). Sweeps go
 * forward and backward in turn, start with the impulses of the last step, and end when one changes
 * the impulses by less than a tolerance.
 *
 * Blocks of one colour share no node: where no body moves freely their sweeps are independent and
 * are divided among the threads, with the same bits. A free body couples all blocks; then one
 * thread sweeps over them in their order. SPDX-License-Identifier: BSD-3-Clause */
#include "mpm/base/kernels.h"
#include "mpm/base/energy.h"
#include "mpm/base/run.h"
#include "mpm/boundary/mirror.h"
#include "mpm/contact/prescribed.h"
#include "mpm/ranks/partition.h"

#include "domain/domain_internal.h"

#include <string.h>

#define SHARED 512 /* constraints: below, dividing the work costs more than it gains */

/* ---- sweeps over all blocks ------------------------------------------------------------------ */

typedef struct sweep {
  const mpsi_contact_stage *stage;
  int64_t first; /* first block of the colour */
  mpsi_sweep_kind kind;
  bool back;
} sweep;

static void one_block(void *data, int64_t unit, int32_t worker) {
  const sweep *s = data;
  const mpsi_contact_stage *stage = s->stage;
  mpsi_impulses *all = &stage->contact->impulses;
  mpsi_constraint_block *block = &all->block[s->first + unit];
  if (s->kind == MPSI_SWEEP_WARM)
    stage->kernels->warm(all, stage->transfer.run->dt, block);
  else if (s->kind == MPSI_SWEEP_RELEASE)
    stage->kernels->release(all, block);
  else
    stage->kernels->sweep(all, stage->transfer.grid->dim, block, s->back);
}

void mpsi_mpm_sweep_all(const mpsi_contact_stage *stage, mpsi_sweep_kind kind, bool back) {
  const mpsi_impulses *all = &stage->contact->impulses;
  const int32_t workers = stage->transfer.grid->worker_count;
  const bool shared = !all->free_bodies && workers > 1 && all->constraint_count > SHARED;
  sweep s = {stage, 0, kind, back};
  if (!shared) {
    for (int64_t k = 0; k < all->block_count; k++)
      one_block(&s, back ? all->block_count - 1 - k : k, 0);
    return;
  }
  for (int k = 0; k < MPSI_CORNERS; k++) {
    const int colour = back ? MPSI_CORNERS - 1 - k : k;
    s.first = all->colour[colour];
    mpsi_parallel_for(stage->context, all->colour[colour + 1] - s.first, one_block, &s);
  }
}

/* ---- the end of the sweeps ------------------------------------------------------------------- */

/* Largest number of sweeps and smallest tolerance of all contacts. */
static int32_t most_sweeps(const mpsi_contacts *contacts, double *tolerance) {
  int32_t most = 0;
  *tolerance = INFINITY;
  for (int32_t b = 0; b < contacts->bodies; b++) {
    const mps_contact_def *def = &contacts->handle[b]->def;
    if (!mpsi_by_impulses(contacts->handle[b])) continue;
    if (def->sweeps > most) most = def->sweeps;
    *tolerance = fmin(*tolerance, def->tolerance);
  }
  return most;
}

void mpsi_mpm_sweep_sums(const mpsi_contacts *contacts, double *most) {
  const mpsi_impulses *all = &contacts->impulses;
  most[MPSI_SWEEP_CHANGED] = most[MPSI_SWEEP_IMPULSES] = 0.0;
  for (int64_t k = 0; k < all->block_count && all->sweeps > 0; k++) {
    if (all->block[k].cells < 0) continue;
    most[MPSI_SWEEP_CHANGED] = fmax(most[MPSI_SWEEP_CHANGED], all->block[k].changed);
    most[MPSI_SWEEP_IMPULSES] = fmax(most[MPSI_SWEEP_IMPULSES], all->block[k].impulses);
  }
}

double mpsi_mpm_relative_change(const double *most) {
  const double changed = most[MPSI_SWEEP_CHANGED];
  return changed > 0.0 ? sqrt(changed / most[MPSI_SWEEP_IMPULSES]) : 0.0;
}

/* Relative change of the impulses in the last sweep: of all ranks where it may end the sweeps
 * (`agree`); else it is reduced at the end of the step (block_results.c). */
static void find_change(mpsi_contacts *contacts, mpsi_partition *partition, bool agree) {
  double most[MPSI_SWEEP_SUMS];
  mpsi_mpm_sweep_sums(contacts, most);
  if (agree && partition && partition->lost == MPS_OK)
    partition->lost =
        mpsi_domain_agree_max(partition->domain, "mps_mpm_step", MPS_OK, MPSI_SWEEP_SUMS, most);
  contacts->impulses.left = mpsi_mpm_relative_change(most);
}

/* Whether sweeps may end after this number: half of them went backward, and at least ten, because
 * fewer lag behind a load that changes slowly from step to step. */
static bool may_end_after(int32_t sweeps) { return sweeps >= 10 && sweeps % 4 == 2; }

/* ---- a step ---------------------------------------------------------------------------------- */

/* Adds the reaction to the impulse `by` on a particle to the load of its pair on the body. */
static void add_reaction(const mpsi_contacts *contacts, double dt,
                         const mpsi_constraint *constraint, const double *by) {
  mpsi_cell_pair *pair = &contacts->cell_pair[constraint->pair];
  const double *x = contacts->body[constraint->body]->pose.x;
  double arm[3], force[3];
  for (int a = 0; a < 3; a++) {
    force[a] = -by[a] / dt;
    arm[a] = constraint->impulse.at[a] - x[a];
  }
  pair->in_contact = true;
  mpsi_pair_load *load = &contacts->load[pair->first_load + constraint->part];
  load->contacts++;
  mpsi_contact_add_load(&load->by, arm, force);
}

/* Adds the reactions of all constraints to the loads on the bodies, and stores the impulses for the
 * warm start of the next step, and the rest gaps. */
static void store_impulses(mpsi_contacts *contacts, double dt) {
  mpsi_impulses *all = &contacts->impulses;
  mpsi_warm_impulse *next = all->next_room.item;
  int64_t count = 0;
  for (int64_t n = 0; n < all->constraint_count; n++) {
    const mpsi_constraint *constraint = &all->constraint[n];
    const mpsi_impulse *c = &constraint->impulse;
    if (constraint->rest_gap != 0.0)
      next[count++] = (mpsi_warm_impulse){.id = constraint->id,
                                          .body = constraint->body,
                                          .point = MPSI_REST_GAP,
                                          .by = {constraint->rest_gap}};
    if (!(c->normal_impulse > 0.0)) continue;
    next[count] = (mpsi_warm_impulse){
        .id = constraint->id, .body = constraint->body, .point = constraint->point};
    for (int a = 0; a < 3; a++)
      next[count].by[a] = c->normal_impulse * c->normal[a] + c->tangent_impulse[a];
    if (constraint->pair >= 0) add_reaction(contacts, dt, constraint, next[count].by);
    count++;
  }
  const mpsi_room old = all->warm_room;
  all->warm_room = all->next_room;
  all->next_room = old;
  all->warm = all->warm_room.item;
  all->warm_count = count;
  all->warm_dt = dt;
}

void mpsi_mpm_apply_impulses(const mpsi_contact_stage *stage) {
  mpsi_impulses *all = &stage->contact->impulses;
  const bool any =
      stage->partition ? stage->contact->exchange.constraints > 0 : all->contact_count > 0;
  double tolerance;
  const int32_t most = most_sweeps(stage->contact, &tolerance);
  if (any) mpsi_mpm_sweep_all(stage, MPSI_SWEEP_WARM, false);
  all->sweeps = 0, all->left = 0.0;
  for (int32_t s = 1; any && s <= most; s++) {
    if (s % 2 != 0) mpsi_mpm_distribute_areas(stage);
    mpsi_mpm_sweep_all(stage, MPSI_SWEEP_UPDATE, s % 2 == 0);
    all->sweeps = s;
    if (s < most && (tolerance == 0.0 || !may_end_after(s))) continue;
    find_change(stage->contact, stage->partition, tolerance > 0.0);
    if (!(all->left > tolerance)) break;
  }
  /* they come again when the boundaries have acted */
  if (any && stage->prescribed) mpsi_mpm_sweep_all(stage, MPSI_SWEEP_RELEASE, false);
}

void mpsi_mpm_end_impulses(const mpsi_contact_stage *stage) {
  mpsi_mpm_mirror_constraints(stage);
  store_impulses(stage->contact, stage->transfer.run->dt);
}

void mpsi_mpm_find_impulse_loss(const mpsi_grid *grid, const mpsi_contacts *contacts,
                                mpsi_energy *energy, const mpsi_kernels *kernels) {
  const mpsi_impulses *all = &contacts->impulses;
  if (!energy->counts) return;
  for (int64_t n = 0; n < all->constraint_count; n++) {
    const mpsi_constraint *constraint = &all->constraint[n];
    const mpsi_impulse *c = &constraint->impulse;
    double v[3], surface[3];
    if (!(c->normal_impulse > 0.0) || constraint->pair < 0) continue;
    kernels->foot_velocity(&contacts->impulses, n, v);
    mpsi_body_velocity(&contacts->body[constraint->body]->pose, c->at, surface);
    double work = 0.0, loss = 0.0;
    for (int a = 0; a < grid->dim; a++) {
      const double by = c->normal_impulse * c->normal[a] + c->tangent_impulse[a];
      work += by * surface[a];
      loss += by * (surface[a] - v[a]);
    }
    mpsi_mpm_energy_add(energy, MPSI_ENERGY_FRICTION_LOSS, loss);
    mpsi_mpm_energy_add(energy, MPSI_ENERGY_STEPPING, -work);
  }
}

void mpsi_mpm_free_impulses(mps_context *context, mpsi_contacts *contacts) {
  mpsi_impulses *all = &contacts->impulses;
  MPSI_FREE(context, all->constraint_room.item, all->block_room.item, all->weight_room.item,
            all->node_room.item, all->candidate_room.item, all->warm_room.item, all->next_room.item,
            all->lookup_room.item, all->area_room.item, all->around_room.item, all->body_room.item);
}
