/* prescribed.c - see prescribed.h. Before a step the listed particles of each cell become groups;
 * with the masses of the nodes each group has a constraint; after the boundaries the constraints
 * are solved; after G2P the listed particles move by exactly the prescribed velocity.
 *
 * The constraint of a group of mass M is sum_i psi_i v_i = V, psi_i = sum_p (m_p/M) phi_ip: the
 * mean velocity that the nodes give its particles is the prescribed one, and the impulse on node i
 * is psi_i J. Where a side or box prescribes a component of a node, the impulse on it is that
 * boundary's, and the node's velocity is a constant of the constraint.
 *
 * All ranks with listed particles, or with blocks beside these, solve all constraints alike.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "body/rotation.h"
#include "core/base/room_array.h"
#include "mpm/base/kernels.h"
#include "mpm/base/energy.h"
#include "mpm/base/run.h"
#include "mpm/boundary/mirror.h"
#include "mpm/contact/prescribed.h"
#include "mpm/particles/rooms.h"
#include "mpm/ranks/partition.h"

#include "core/particles/particles_internal.h"
#include "domain/domain_internal.h"

#include <string.h>

#define MOST_SWEEPS 200
#define TOLERANCE 1e-10 /* relative change of the impulses in a sweep */

/* ---- before a step --------------------------------------------------------------------------- */

/* Number of entries of all lists. */
static int64_t count_entries(const mpsi_boundaries *boundaries) {
  int64_t count = 0;
  for (int32_t b = MPSI_SIDES; b < boundaries->count; b++)
    if (mpsi_is_list(&boundaries->boundary[b])) count += boundaries->boundary[b].id_count;
  return count;
}

static mps_status reserve(const mpsi_contact_stage *stage, const char *function, bool before,
                          int64_t entries) {
  mpsi_prescribed *all = stage->prescribed;
  mps_context *context = stage->context;
  const int64_t blocks = stage->transfer.grid->cell_count;
  const int64_t nodes = mpsi_all_nodes(stage->transfer.grid) * stage->transfer.grid->block_nodes;
  const bool good =
      MPSI_ENSURE(context, all, listed, entries) && MPSI_ENSURE(context, all, group, entries) &&
      MPSI_ENSURE(context, all, cell, entries) &&
      mpsi_room_ensure(context, &all->first_room, blocks + 1, sizeof *all->first_group) &&
      mpsi_room_ensure(context, &all->key_room, stage->partition ? MPSI_LISTED_KEY * entries : 0,
                       sizeof(int64_t)) &&
      mpsi_room_ensure(context, &all->fixed_room, nodes, 1) &&
      MPSI_ENSURE(context, all, before, before ? nodes : 0) &&
      mpsi_room_ensure(context, &all->constraints.impulses.next_room, entries,
                       sizeof(mpsi_warm_impulse));
  all->first_group = all->first_room.item;
  all->fixed = all->fixed_room.item;
  if (good && nodes > 0) memset(all->fixed, 0, (size_t)nodes);
  return good ? MPS_OK
              : mpsi_fail_memory(context, function,
                                 (size_t)entries * (sizeof *all->listed + sizeof *all->group) +
                                     (size_t)nodes * (before ? 33 : 1));
}

mps_status mpsi_mpm_find_prescribed(const mpsi_contact_stage *stage, const char *function,
                                    bool before, mps_status status) {
  mpsi_prescribed *all = stage->prescribed;
  const mpsi_transfer *work = &stage->transfer;
  const int64_t entries = count_entries(work->boundaries);
  all->on = entries > 0;
  if (!all->on) {
    all->constraints.impulses.warm_count = 0;
    return status;
  }
  if (status == MPS_OK) status = reserve(stage, function, before, entries);
  int64_t *key = NULL;
  if (stage->partition) {
    mps_domain *domain = stage->partition->domain;
    if (status == MPS_OK && !all->constraints.partners.words)
      status = mpsi_mpm_begin_partners(&all->constraints.partners, domain, function);
    status = mpsi_domain_agree(domain, function, status);
    if (status != MPS_OK) return status;
    key = all->key_room.item;
  }
  if (status != MPS_OK) return status;
  mpsi_mpm_list_particles(work, all, key);
  if (key)
    status = mpsi_domain_sum(stage->partition->domain, function,
                             (int32_t)(MPSI_LISTED_KEY * entries), key);
  if (status != MPS_OK) return status;
  mpsi_mpm_list_groups(work, all, entries, key);
  return mpsi_mpm_agree(stage->partition, function, mpsi_mpm_find_constraints(stage, function));
}

/* ---- solution -------------------------------------------------------------------------------- */

/* Relative change of the impulses in the last sweep, of all ranks' constraints, which each of their
 * ranks has. */
static double find_change(const mpsi_impulses *impulses) {
  double changed = 0.0, most = 0.0;
  for (int64_t k = 0; k < impulses->block_count; k++) {
    changed = fmax(changed, impulses->block[k].group_changed);
    most = fmax(most, impulses->block[k].group_impulses);
  }
  return changed > 0.0 ? sqrt(changed / most) : 0.0;
}

/* Marks the blocks of cells with listed particles, on this rank or, as ghosts, on others. */
static void mark_blocks(const mpsi_prescribed *all, mpsi_grid *grid) {
  for (int64_t b = 0; b < grid->cell_count; b++)
    grid->cells[b].in_contact = grid->cells[b].sent = false;
  for (int64_t i = 0; i < all->cell_count; i++)
    for (int64_t b = 0; b < grid->cell_count; b++)
      if (memcmp(grid->cells[b].at, all->cell[i].block, sizeof grid->cells[b].at) == 0)
        grid->cells[b].in_contact = true;
}

mps_status mpsi_mpm_solve_prescribed(const mpsi_contact_stage *stage, const char *function) {
  mpsi_contacts *constraints = &stage->prescribed->constraints;
  mpsi_impulses *impulses = &constraints->impulses;
  mps_status status = MPS_OK;
  mpsi_mpm_fit_constraints(stage);
  if (stage->partition) {
    mark_blocks(stage->prescribed, (mpsi_grid *)stage->transfer.grid);
    status = mpsi_mpm_exchange_contacts(stage, function, status);
  }
  if (status != MPS_OK) return status;
  mpsi_mpm_sweep_all(stage, MPSI_SWEEP_WARM, false);
  impulses->sweeps = 0;
  for (bool more = impulses->constraint_count > 0; more;) {
    mpsi_mpm_sweep_all(stage, MPSI_SWEEP_UPDATE, impulses->sweeps % 2 != 0);
    impulses->sweeps++;
    more = impulses->sweeps < MOST_SWEEPS && find_change(impulses) > TOLERANCE;
  }
  if (stage->partition) mpsi_mpm_end_contact_exchange(constraints);
  for (int64_t k = 0; k < impulses->block_count && stage->transfer.mirrors->sides; k++)
    if (impulses->block[k].cells >= 0) mpsi_mpm_mirror_prescribed(stage, &impulses->block[k]);
  return MPS_OK;
}

/* ---- after G2P ------------------------------------------------------------------------------- */

/* Adds the impulse of a group's constraint to the reaction of its list. */
static void add_reaction(const mpsi_contact_stage *stage, mpsi_energy *energy,
                         const mpsi_constraint *constraint) {
  const mpsi_prescribed *all = stage->prescribed;
  const mpsi_columns *p = stage->transfer.p;
  const mpsi_listed_group *group = &all->group[constraint->particle];
  const mpsi_listed *member = &all->listed[group->first];
  const double *J = constraint->impulse.tangent_impulse;
  mpsi_boundary *boundary = &stage->transfer.boundaries->boundary[member->list];
  double x[3] = {0.0}, impulse[3], moment[3], work = 0.0;
  for (int64_t i = 0; i < group->count; i++)
    for (int c = 0; c < 3; c++) x[c] += p->m[member[i].particle] / group->mass * member[i].x[c];
  for (int c = 0; c < 3; c++) {
    const int a = (c + 1) % 3, b = (c + 2) % 3;
    impulse[c] = (1.0 - group->lost[c]) * J[c];
    moment[c] = (x[a] - group->lost_at[b][a]) * J[b] - (x[b] - group->lost_at[a][b]) * J[a];
    work += impulse[c] * boundary->v[c];
  }
  mpsi_mpm_boundary_add_impulse(boundary, impulse, moment, work, 0);
  mpsi_mpm_energy_add(energy, MPSI_ENERGY_BOUNDARIES, work);
  mpsi_mpm_energy_add(energy, MPSI_ENERGY_BOUNDARY_LOSS, work);
}

/* Marks the block, as G2P does, where the particle has left the block's tile or the domain. */
static void check_place(const mpsi_transfer *work, const mpsi_listed *one) {
  const mpsi_grid *grid = work->grid;
  mpsi_cell_block *cells = &grid->cells[one->block];
  const double first = grid->spline == 3 ? 1.0 : 0.5;
  for (int c = 0; c < grid->dim; c++) {
    const double X = mpsi_grid_at(grid, c, work->p->x[c][one->particle]);
    const double local = X - (double)cells->at[c] * MPSI_SIDE - first;
    if (!(local >= cells->low[c] && local < cells->high[c] - mpsi_reach(grid, c)))
      cells->left = true;
    if (X >= (double)grid->low[c] - MPSI_ON_BORDER && X <= (double)grid->high[c] + MPSI_ON_BORDER)
      continue;
    if (mpsi_mpm_passes(grid, work->boundaries, c, X))
      cells->gone = true;
    else if (cells->bad < 0)
      cells->bad = one->particle, cells->lost = true;
  }
}

/* Prescribes the velocity of a particle exactly; m dv is the impulse beyond those of its group. */
static void drive_particle(const mpsi_contact_stage *stage, mpsi_energy *energy,
                           const mpsi_listed *one) {
  const mpsi_columns *p = stage->transfer.p;
  mpsi_boundary *boundary = &stage->transfer.boundaries->boundary[one->list];
  const int64_t k = one->particle;
  double impulse[3] = {0.0}, moment[3], work = 0.0, kinetic = 0.0;
  for (int c = 0; c < stage->transfer.grid->dim; c++) {
    if (!(boundary->dofs >> c & 1)) continue;
    impulse[c] = p->m[k] * (boundary->v[c] - p->v[c][k]);
    work += impulse[c] * boundary->v[c];
    kinetic += 0.5 * impulse[c] * (boundary->v[c] + p->v[c][k]);
    p->v[c][k] = boundary->v[c];
    p->x[c][k] = one->x[c] + stage->transfer.run->dt * boundary->v[c];
  }
  mpsi_cross3(one->x, impulse, moment);
  mpsi_mpm_boundary_add_impulse(boundary, impulse, moment, work, 1);
  mpsi_mpm_energy_add(energy, MPSI_ENERGY_BOUNDARIES, work);
  mpsi_mpm_energy_add(energy, MPSI_ENERGY_KINETIC, kinetic);
  mpsi_mpm_energy_add(energy, MPSI_ENERGY_TRANSFER, work - kinetic);
  check_place(&stage->transfer, one);
}

/* Keeps the impulse of a group's constraint, divided among its particles, for the next step. */
static int64_t keep_impulse(const mpsi_contact_stage *stage, const mpsi_constraint *constraint,
                            mpsi_warm_impulse *out) {
  const mpsi_columns *p = stage->transfer.p;
  const mpsi_listed_group *group = &stage->prescribed->group[constraint->particle];
  const mpsi_listed *member = &stage->prescribed->listed[group->first];
  for (int64_t i = 0; i < group->count; i++) {
    out[i] = (mpsi_warm_impulse){.id = member[i].id, .body = constraint->body};
    for (int a = 0; a < 3; a++)
      out[i].by[a] = p->m[member[i].particle] / group->mass *
                     (constraint->impulse.tangent_impulse[a] / stage->transfer.run->dt);
  }
  return group->count;
}

void mpsi_mpm_end_prescribed(const mpsi_contact_stage *stage, mpsi_energy *energy) {
  mpsi_prescribed *all = stage->prescribed;
  mpsi_impulses *impulses = &all->constraints.impulses;
  mpsi_warm_impulse *next = impulses->next_room.item;
  int64_t count = 0;
  if (!all->on) return;
  for (int64_t n = 0; n < impulses->constraint_count; n++) {
    if (impulses->constraint[n].pair < 0) continue; /* of another rank */
    add_reaction(stage, energy, &impulses->constraint[n]);
    count += keep_impulse(stage, &impulses->constraint[n], next + count);
  }
  for (int64_t i = 0; i < all->listed_count; i++) drive_particle(stage, energy, &all->listed[i]);
  const mpsi_room old = impulses->warm_room;
  impulses->warm_room = impulses->next_room;
  impulses->next_room = old;
  impulses->warm = impulses->warm_room.item;
  impulses->warm_count = count;
}

void mpsi_mpm_free_prescribed(mps_context *context, mpsi_prescribed *all) {
  MPSI_FREE(context, all->listed_room.item, all->group_room.item, all->cell_room.item,
            all->first_room.item, all->key_room.item, all->fixed_room.item, all->before_room.item);
  mpsi_mpm_free_impulses(context, &all->constraints);
  mpsi_mpm_free_contact_exchange(context, &all->constraints);
  mpsi_mpm_free_partners(&all->constraints.partners, context);
}
