/* groups.c - groups of listed particles (prescribed.h), and the weights of their constraints with
 * the masses of the nodes. A group belongs to one cell of one block; where a side or box prescribes
 * a component of a node, the impulse on it is that boundary's, and the node's velocity is a
 * constant of the constraint. SPDX-License-Identifier: BSD-3-Clause */
#include "mpm/base/kernels.h"
#include "mpm/base/run.h"
#include "mpm/boundary/mirror.h"
#include "mpm/contact/prescribed.h"

#include "core/base/order.h"
#include "core/particles/particles_internal.h"

#include <stdlib.h>
#include <string.h>

#define LEAST_FREE 1e-2 /* fraction of a constraint's mobility that sides and boxes must leave */
#define ONE_ROW 1e-3    /* cells: particles within this of one another are in one row */

/* ---- listed particles ------------------------------------------------------------------------ */

static int32_t block_of(const mpsi_grid *grid, int64_t k) {
  int64_t low = 0, high = grid->cell_count;
  while (high - low > 1) {
    const int64_t middle = low + (high - low) / 2;
    if (grid->cells[middle].begin <= k)
      low = middle;
    else
      high = middle;
  }
  return (int32_t)low;
}

static void find_cell(const mpsi_grid *grid, const mpsi_columns *p, int64_t k, int32_t *cell) {
  for (int c = 0; c < 3; c++)
    cell[c] =
        c < grid->dim ? (int32_t)mpsi_base(grid->spline, mpsi_grid_at(grid, c, p->x[c][k])) : 0;
}

void mpsi_mpm_list_particles(const mpsi_transfer *work, mpsi_prescribed *all, int64_t *key) {
  const mpsi_grid *grid = work->grid;
  all->listed_count = 0;
  for (int32_t b = MPSI_SIDES; b < work->boundaries->count; b++) {
    const mpsi_boundary *boundary = &work->boundaries->boundary[b];
    for (int64_t i = 0; mpsi_is_list(boundary) && i < boundary->id_count;
         i++, key += key ? MPSI_LISTED_KEY : 0) {
      const int64_t k = mps_particles_index(work->p->set, boundary->ids[i]);
      if (key) memset(key, 0, MPSI_LISTED_KEY * sizeof *key);
      if (k < 0) continue;
      mpsi_listed *one = &all->listed[all->listed_count++];
      *one = (mpsi_listed){
          .particle = k, .id = boundary->ids[i], .list = b, .block = block_of(grid, k)};
      find_cell(grid, work->p, k, one->cell);
      for (int c = 0; c < grid->dim; c++) one->x[c] = work->p->x[c][k];
      for (int c = 0; c < 3 && key; c++)
        key[c] = one->cell[c], key[3 + c] = grid->cells[one->block].at[c], key[6] = 1 + b;
    }
  }
}

/* ---- cells of all ranks ---------------------------------------------------------------------- */

static int compare_three(const int32_t *a, const int32_t *b) {
  for (int c = 2; c >= 0; c--)
    if (a[c] != b[c]) return a[c] < b[c] ? -1 : 1;
  return 0;
}

static int by_cell(const void *left, const void *right) {
  const mpsi_listed_cell *a = left, *b = right;
  const int order = compare_three(a->cell, b->cell);
  return order != 0 ? order : compare_three(a->block, b->block);
}

/* Lists the cells with listed particles: by the keys of all ranks, or by the particles. */
static void list_cells(const mpsi_grid *grid, mpsi_prescribed *all, int64_t entries,
                       const int64_t *key) {
  int64_t count = 0, unique = 0;
  if (!key) entries = all->listed_count;
  for (int64_t i = 0; i < entries; i++) {
    mpsi_listed_cell *cell = &all->cell[count];
    if (key && key[MPSI_LISTED_KEY * i + 6] == 0) continue;
    for (int c = 0; c < 3; c++) {
      const mpsi_listed *one = &all->listed[i];
      cell->cell[c] = key ? (int32_t)key[MPSI_LISTED_KEY * i + c] : one->cell[c];
      cell->block[c] =
          key ? (int32_t)key[MPSI_LISTED_KEY * i + 3 + c] : grid->cells[one->block].at[c];
    }
    cell->list = key ? (int32_t)key[MPSI_LISTED_KEY * i + 6] - 1 : all->listed[i].list;
    count++;
  }
  if (count > 0) qsort(all->cell, (size_t)count, sizeof *all->cell, by_cell);
  for (int64_t i = 0; i < count; i++) {
    if (unique > 0 && by_cell(&all->cell[unique - 1], &all->cell[i]) == 0) {
      if (all->cell[unique - 1].list != all->cell[i].list) all->cell[unique - 1].list = -1;
      continue;
    }
    all->cell[unique++] = all->cell[i];
  }
  all->cell_count = unique;
}

/* First listed cell that does not come before `cell`. */
static int64_t find_first(const mpsi_prescribed *all, const int32_t *cell) {
  int64_t low;
  MPSI_BISECT(low, all->cell_count, middle, compare_three(all->cell[middle].cell, cell) < 0);
  return low;
}

static bool has_cell(const mpsi_prescribed *all, const int32_t *cell) {
  const int64_t at = find_first(all, cell);
  return at < all->cell_count && compare_three(all->cell[at].cell, cell) == 0;
}

/* ---- groups ---------------------------------------------------------------------------------- */

static int by_group(const void *left, const void *right) {
  const mpsi_listed *a = left, *b = right;
  if (a->block != b->block) return a->block < b->block ? -1 : 1;
  const int order = compare_three(a->cell, b->cell);
  if (order != 0) return order;
  if (a->list != b->list) return a->list < b->list ? -1 : 1;
  if (a->part != b->part) return a->part < b->part ? -1 : 1;
  return (a->id > b->id) - (a->id < b->id);
}

static bool same_cell(const mpsi_listed *a, const mpsi_listed *b) {
  return a->block == b->block && a->list == b->list && compare_three(a->cell, b->cell) == 0;
}

/* Whether all particles of the block in this cell are among the `count` listed ones. */
static bool is_complete(const mpsi_transfer *work, const mpsi_listed *first, int64_t count) {
  const mpsi_cell_block *cells = &work->grid->cells[first->block];
  for (int64_t k = cells->begin; k < cells->end; k++) {
    int32_t cell[3];
    find_cell(work->grid, work->p, k, cell);
    count -= compare_three(cell, first->cell) == 0;
  }
  return count >= 0;
}

/* Axes, as bits, along which the cell of the listed particles [first, first + count) is divided:
 * where the list ends there, if it fills the cell or has but this one along the axis. A cell that
 * belongs to several blocks or lists is divided by these already. */
static int divided_axes(const mpsi_transfer *work, const mpsi_prescribed *all,
                        const mpsi_listed *first, int64_t count) {
  const int64_t at = find_first(all, first->cell);
  int ends = 0, alone = 0;
  if (all->cell[at].list < 0 ||
      (at + 1 < all->cell_count && compare_three(all->cell[at + 1].cell, first->cell) == 0))
    return 0;
  for (int c = 0; c < work->grid->dim; c++) {
    int32_t beside[3] = {first->cell[0], first->cell[1], first->cell[2]};
    beside[c]--;
    const bool below = has_cell(all, beside);
    beside[c] += 2;
    const bool above = has_cell(all, beside);
    if (!below || !above) ends |= 1 << c;
    if (!below && !above) alone |= 1 << c;
  }
  return ends != alone && is_complete(work, first, count) ? ends : alone;
}

/* Divides the listed particles of one cell into parts. */
static void divide(const mpsi_transfer *work, const mpsi_prescribed *all, mpsi_listed *first,
                   int64_t count) {
  const int axes = count > 1 ? divided_axes(work, all, first, count) : 0;
  for (int c = 0; c < work->grid->dim; c++) {
    double middle = 0.0;
    if (!(axes >> c & 1)) continue;
    for (int64_t i = 0; i < count; i++) middle += first[i].x[c] / (double)count;
    middle -= ONE_ROW * work->grid->cell;
    for (int64_t i = 0; i < count; i++)
      if (first[i].x[c] > middle) first[i].part |= 1 << c;
  }
}

/* Sorts the listed particles; an id that a list names twice counts once. */
static int64_t sort_listed(mpsi_prescribed *all) {
  int64_t count = 0;
  if (all->listed_count > 0)
    qsort(all->listed, (size_t)all->listed_count, sizeof *all->listed, by_group);
  for (int64_t i = 0; i < all->listed_count; i++)
    if (i == 0 || by_group(&all->listed[count - 1], &all->listed[i]) != 0)
      all->listed[count++] = all->listed[i];
  return all->listed_count = count;
}

static double mass_of(const mpsi_columns *p, const mpsi_listed *member, int64_t count) {
  double mass = 0.0;
  for (int64_t i = 0; i < count; i++) mass += p->m[member[i].particle];
  return mass;
}

/* Sorts the listed particles into groups, and these by blocks. */
void mpsi_mpm_list_groups(const mpsi_transfer *work, mpsi_prescribed *all, int64_t entries,
                          const int64_t *key) {
  list_cells(work->grid, all, entries, key);
  mpsi_listed *listed = all->listed;
  const int64_t n = sort_listed(all), blocks = work->grid->cell_count;
  for (int64_t i = 0, end; i < n; i = end) {
    for (end = i + 1; end < n && same_cell(&listed[i], &listed[end]);) end++;
    divide(work, all, &listed[i], end - i);
  }
  sort_listed(all);
  memset(all->first_group, 0, (size_t)(blocks + 1) * sizeof *all->first_group);
  all->group_count = 0;
  for (int64_t i = 0, end; i < n; i = end) {
    for (end = i + 1;
         end < n && same_cell(&listed[i], &listed[end]) && listed[i].part == listed[end].part;)
      end++;
    all->group[all->group_count++] = (mpsi_listed_group){
        .first = i, .count = end - i, .mass = mass_of(work->p, &listed[i], end - i)};
    all->first_group[listed[i].block + 1]++;
  }
  for (int64_t b = 0; b < blocks; b++) all->first_group[b + 1] += all->first_group[b];
}

/* ---- weights --------------------------------------------------------------------------------- */

/* States of nodes (support.h) where some fit has not been stored by the scatter. */
static void find_states(const mpsi_transfer *work, const mpsi_prescribed *all, int64_t block) {
  const mpsi_cell_block *cells = work->cells;
  bool fitted = cells->first_fit >= 0;
  for (int64_t g = all->first_group[block]; g < all->first_group[block + 1] && fitted; g++)
    for (int64_t i = 0; i < all->group[g].count && fitted; i++) {
      const int64_t k = all->listed[all->group[g].first + i].particle;
      fitted = work->grid->fitted[cells->first_fit + (k - cells->begin)] != 0;
    }
  if (!fitted) mpsi_mpm_find_states(work);
}

/* Shape functions of a listed particle. */
static void find_shape(const mpsi_kernels *kernels, const mpsi_transfer *work, int64_t k,
                       mpsi_foot_weights *out) {
  static const double here[3] = {0.0};
  kernels->foot(work, k, here, out);
}

/* Tile node of stencil node s. */
static void find_place(const mpsi_foot_weights *f, int s, int *place) {
  place[0] = f->at[0] + s % 4, place[1] = f->at[1] + s / 4 % 4, place[2] = f->at[2] + s / 16;
}

/* Counts a part psi of the impulse, on a component of a node, as not the list's to give. */
static void lose(const mpsi_grid *grid, int64_t node, int component, double psi,
                 mpsi_listed_group *group) {
  double x[3];
  mpsi_node_place(grid, grid->nodes[node / grid->block_nodes].at, (int)(node % grid->block_nodes),
                  x);
  group->lost[component] += psi;
  for (int b = 0; b < 3; b++) group->lost_at[component][b] += psi * x[b];
}

/* Adds the share of a particle to the weights of its group's constraint. A node whose mass is not
 * positive, as beside sides, stays at rest. */
static void add_particle(const mpsi_contact_stage *stage, const mpsi_transfer *work, int64_t k,
                         double share, int64_t n, mpsi_listed_group *group) {
  const mpsi_grid *grid = work->grid;
  const mpsi_cell_block *cells = work->cells;
  mpsi_impulses *impulses = &stage->contact->impulses;
  mpsi_constraint *constraint = &impulses->constraint[n];
  mpsi_foot_weights f;
  find_shape(stage->kernels, work, k, &f);
  for (uint64_t left = f.active; left != 0; left &= left - 1) {
    const int s = __builtin_ctzll(left);
    int place[3];
    find_place(&f, s, place);
    const double psi = share * f.psi[s];
    double psis[3] = {psi, psi, psi}, keeps[3], carried[3];
    const bool image = cells->mirrors && mpsi_mpm_find_image(grid, work->boundaries, work->mirrors,
                                                             cells, place, keeps, carried);
    for (int a = 0; a < 3 && image; a++) {
      psis[a] *= keeps[a];
      constraint->carried[a] += psi * carried[a];
    }
    const int64_t g = f.across >> s & 1
                          ? mpsi_node_across(grid, cells, place[0], place[1], place[2])
                          : mpsi_node_under(grid, cells, place[0], place[1], place[2]);
    if (grid->node[g][MPSI_MASS] > 0.0)
      mpsi_mpm_add_node(constraint, impulses->node + n * impulses->stride,
                        impulses->weight + n * impulses->stride, grid->node[g], psis, true);
    for (int a = 0; a < 3 && !(grid->node[g][MPSI_MASS] > 0.0); a++)
      lose(grid, g, a, psis[a], group);
  }
}

/* Takes the components of nodes that sides and boxes prescribe out of a constraint, and finds the
 * inverses of its mobilities. In the contact stage of a step no boundary has acted yet. */
static void end_weights(const mpsi_contact_stage *stage, const mpsi_boundary *boundary, int64_t n,
                        mpsi_listed_group *group) {
  const mpsi_grid *grid = stage->transfer.grid;
  mpsi_impulses *impulses = &stage->contact->impulses;
  mpsi_constraint *constraint = &impulses->constraint[n];
  const bool acted = stage->contact->bodies == 0;
  /* viscous damping follows and divides the nodes' velocities by this */
  const double damps = 1.0 + stage->transfer.def->viscous_damping * stage->transfer.run->dt;
  double whole[3] = {0.0};
  for (int32_t i = 0; i < constraint->nodes; i++) {
    double *weight = impulses->weight[n * impulses->stride + i];
    const double *node = impulses->node[n * impulses->stride + i];
    const int64_t number = (node - (const double *)grid->node) / 4;
    for (int a = 0; a < 3; a++) {
      const double psi = weight[MPSI_VECTOR + a], mobility = psi * psi * weight[MPSI_MASS];
      whole[a] += mobility;
      if (!acted || !(stage->prescribed->fixed[number] >> a & 1)) {
        constraint->impulse.mobility[a] += mobility;
        continue;
      }
      constraint->carried[a] += psi * node[MPSI_VECTOR + a];
      lose(grid, number, a, psi, group);
      weight[MPSI_VECTOR + a] = 0.0;
    }
  }
  for (int a = 0; a < grid->dim; a++) {
    const double mobility = constraint->impulse.mobility[a];
    const bool held = boundary->dofs >> a & 1 && mobility > LEAST_FREE * whole[a];
    constraint->carried[a] -= boundary->v[a];
    if (acted) constraint->carried[a] *= damps;
    constraint->impulse.normal[a] = held ? 1.0 / mobility : 0.0;
  }
}

void mpsi_mpm_fit_prescribed(const mpsi_contact_stage *stage, const mpsi_transfer *work,
                             const mpsi_constraint_block *block) {
  mpsi_prescribed *all = stage->prescribed;
  mpsi_impulses *impulses = &stage->contact->impulses;
  const mpsi_columns *p = work->p;
  find_states(work, all, block->cells);
  for (int64_t q = 0; q < block->groups; q++) {
    const int64_t n = block->first + block->count + q, g = all->first_group[block->cells] + q;
    mpsi_listed_group *group = &all->group[g];
    const mpsi_listed *member = &all->listed[group->first];
    mpsi_constraint *constraint = &impulses->constraint[n];
    *constraint = (mpsi_constraint){.particle = g, .id = member->id, .body = -1 - member->list};
    memset(group->lost, 0, sizeof group->lost);
    memset(group->lost_at, 0, sizeof group->lost_at);
    for (int64_t i = 0; i < group->count; i++) {
      add_particle(stage, work, member[i].particle, p->m[member[i].particle] / group->mass, n,
                   group);
      const mpsi_warm_impulse *warm =
          mpsi_mpm_warm_impulse(&all->constraints, member[i].id, constraint->body, 0);
      for (int a = 0; a < 3 && warm; a++)
        constraint->impulse.tangent_impulse[a] += stage->transfer.run->dt * warm->by[a];
    }
    end_weights(stage, &work->boundaries->boundary[member->list], n, group);
    for (int a = 0; a < 3; a++)
      if (constraint->impulse.normal[a] == 0.0) constraint->impulse.tangent_impulse[a] = 0.0;
  }
}

void mpsi_mpm_mirror_prescribed(const mpsi_contact_stage *stage,
                                const mpsi_constraint_block *block) {
  const mpsi_prescribed *all = stage->prescribed;
  const mpsi_transfer work = mpsi_contact_transfer(stage, block->cells, 0);
  if (!work.cells->mirrors) return;
  find_states(&work, all, block->cells);
  for (int64_t n = block->first; n < block->first + block->groups; n++) {
    const mpsi_constraint *constraint = &stage->contact->impulses.constraint[n];
    const mpsi_listed_group *group = &all->group[constraint->particle];
    const mpsi_listed *member = &all->listed[group->first];
    for (int64_t i = 0; i < group->count; i++) {
      mpsi_foot_weights f;
      find_shape(stage->kernels, &work, member[i].particle, &f);
      for (uint64_t left = f.active; left != 0; left &= left - 1) {
        const int s = __builtin_ctzll(left);
        const double share = f.psi[s] * work.p->m[member[i].particle] / group->mass;
        int place[3];
        double by[3];
        find_place(&f, s, place);
        for (int a = 0; a < 3; a++) by[a] = share * constraint->impulse.tangent_impulse[a];
        mpsi_mpm_reflect_impulse(work.grid, work.boundaries, work.mirrors, work.cells, place, by);
      }
    }
  }
}
