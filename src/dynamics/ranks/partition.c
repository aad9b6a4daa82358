/* partition.c - the part that one rank has of a body whose particles lie on several ranks.
 *
 * All ranks begin with the same set, sort it in the same way and cut the body at blocks, or with a
 * set in parts (deal.c): each has
 * an interval of them, and all of the free-field columns, which are few and whose motion the edges
 * need at once. Behind its own particles a rank keeps two layers of ghosts: the neighbours of its
 * own particles, whose pressure it computes itself, and the neighbours of these. So one message a
 * step is enough: displacements and rotations of ghosts. Pairs are arranged in blocks by their
 * numbers in the whole body, and every sum has the same terms in the same order on every rank.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "core/base/order.h"
#include "core/particles/particles_internal.h"
#include "domain/halo.h"
#include "partition.h"
#include "dynamics/base/dynamics_solver.h"
#include "dynamics/ranks/deal.h"
#include "dynamics/pairs/batch.h"
#include "material/material_internal.h"

#include <stdlib.h>
#include <string.h>

#define BACK 4 /* columns of one copy, at most */

/* Data of the whole body while the partition is made; arrays by global number. */
typedef struct plan {
  mps_dynamics *dynamics;
  const char *function;
  int64_t count, body;
  int64_t *order; /* present index of each particle; NULL: own ones lie in order */
  int64_t *block; /* of a set in parts: global number of each block; NULL: the same */
  int64_t whole;  /* particles of the body in the whole set */
  double *x, *y;
  int64_t *side;       /* NULL: no columns */
  int64_t first, last; /* own ones of the body */
  double edge[2];      /* x of the body's outermost particles, m */
  int64_t *near;       /* global numbers of the particles of the search for pairs, ascending */
  int64_t nears, near_body;
  uint8_t *present; /* ghosts */
  mpsi_dynamics_cut cut;
  int64_t ghosts;
  int64_t *ghost;
  int32_t *ghost_rank;
  int64_t *ghost_index;
} plan;

static void free_plan(plan *p) {
  mps_context *context = p->dynamics->context;
  MPSI_FREE(context, p->block, p->order, p->x, p->y, p->side, p->near, p->present, p->ghost,
            p->ghost_rank, p->ghost_index, p->cut.block, p->cut.begin, p->cut.end, p->cut.slot,
            p->cut.local, p->cut.wanted);
}

static mps_status refused(const plan *p, int64_t bytes) {
  return mpsi_fail_memory(p->dynamics->context, p->function, (size_t)bytes);
}

/* ---- the whole body -------------------------------------------------------------------------- */

static mps_status sort_whole(plan *p) {
  mps_dynamics *dynamics = p->dynamics;
  mps_context *context = dynamics->context;
  const mpsi_dynamics_geometry g = mpsi_dynamics_present_geometry(dynamics);
  p->count = g.count;
  p->order = mpsi_alloc(context, g.count, sizeof *p->order);
  p->x = mpsi_alloc(context, g.count, sizeof *p->x);
  p->y = mpsi_alloc(context, g.count, sizeof *p->y);
  p->side = mpsi_alloc(context, g.count, sizeof *p->side);
  if (!p->order || !p->x || !p->y || !p->side || !mpsi_dynamics_layout_order(context, &g, p->order))
    return refused(p, g.count * 32);
  p->edge[0] = INFINITY, p->edge[1] = -INFINITY;
  for (int64_t k = 0; k < g.count; k++) {
    const int64_t i = p->order[k];
    p->x[k] = g.x[i], p->y[k] = g.y[i];
    p->side[k] = g.side ? g.side[i] : 0;
    if (p->side[k]) continue;
    p->body = k + 1;
    p->edge[0] = fmin(p->edge[0], g.x[i]), p->edge[1] = fmax(p->edge[1], g.x[i]);
  }
  return MPS_OK;
}

/* ---- what may be near ------------------------------------------------------------------------ */

/* Cells as wide as re: neighbours of the particles of some blocks lie in their cells and the cells
 * around. */
typedef struct cells {
  double lo[2], width;
  int64_t columns;
  int64_t *taken, count; /* numbers of cells with such particles, ascending */
} cells;

static int64_t cell_of(const cells *c, double x, double y) {
  return (int64_t)floor((y - c->lo[1]) / c->width + 1.0) * c->columns +
         (int64_t)floor((x - c->lo[0]) / c->width + 1.0);
}

static bool begin_cells(const plan *p, cells *c) {
  const double period = isnan(p->dynamics->def.period_x) ? 0.0 : p->dynamics->def.period_x;
  double low = INFINITY;
  for (int64_t k = 0; k < p->body; k++) low = fmin(low, p->y[k]);
  c->width = p->dynamics->radius * (1.0 + 1e-6);
  c->lo[0] = p->edge[0] - period, c->lo[1] = low;
  c->columns = (int64_t)((p->edge[1] - p->edge[0] + 2.0 * period) / c->width) + 4;
  c->taken = mpsi_alloc(p->dynamics->context, (period > 0.0 ? 3 : 1) * p->body, sizeof *c->taken);
  return c->taken != NULL;
}

/* Cells of the marked blocks. */
static void take_cells(const plan *p, const uint8_t *marked, cells *c) {
  const double period = isnan(p->dynamics->def.period_x) ? 0.0 : p->dynamics->def.period_x;
  c->count = 0;
  for (int64_t k = 0; k < p->body; k++)
    for (int copy = 0; marked[k / MPSI_DYN_BLOCK] && copy < (period > 0.0 ? 3 : 1); copy++) {
      const int64_t cell = cell_of(c, p->x[k] + (copy == 2 ? -period : copy * period), p->y[k]);
      if (c->count == 0 || c->taken[c->count - 1] != cell) c->taken[c->count++] = cell;
    }
  qsort(c->taken, (size_t)c->count, sizeof *c->taken, mpsi_ascending);
}

/* Is a cell, or one around it, in the list? */
static bool any_taken(const cells *c, int64_t cell) {
  for (int64_t row = -1; row <= 1; row++) {
    const int64_t first = cell + row * c->columns - 1;
    int64_t low;
    MPSI_BISECT(low, c->count, middle, c->taken[middle] < first);
    if (low < c->count && c->taken[low] <= first + 2) return true;
  }
  return false;
}

/* Pairs are searched among all particles near own blocks or their neighbour blocks: the arrangement
 * of a block's pairs depends on all of them. */
static mps_status find_near(plan *p) {
  mps_context *context = p->dynamics->context;
  cells c = {.count = 0};
  uint8_t *marked = mpsi_alloc(context, p->body / MPSI_DYN_BLOCK + 1, 1);
  p->near = mpsi_alloc(context, p->count, sizeof *p->near);
  const bool good = marked && p->near && begin_cells(p, &c);
  for (int64_t k = p->first; good && k < p->last; k += MPSI_DYN_BLOCK)
    marked[k / MPSI_DYN_BLOCK] = 1;
  if (good) take_cells(p, marked, &c);
  for (int64_t k = 0; good && k < p->body; k++)
    if (any_taken(&c, cell_of(&c, p->x[k], p->y[k]))) marked[k / MPSI_DYN_BLOCK] = 1;
  if (good) take_cells(p, marked, &c);
  for (int64_t k = 0; good && k < p->count; k++)
    if (k >= p->body || any_taken(&c, cell_of(&c, p->x[k], p->y[k]))) {
      p->near[p->nears++] = k;
      p->near_body += k < p->body;
    }
  MPSI_FREE(context, c.taken, marked);
  return good ? MPS_OK : refused(p, p->count * 8);
}

/* Edge particles of the free-field columns, in global numbers. */
static mps_status find_edges(plan *p, int64_t *edge) {
  mps_dynamics *dynamics = p->dynamics;
  mps_context *context = dynamics->context;
  for (int64_t k = 0; k < p->nears; k++) edge[k] = -1;
  if (p->count == p->body) return MPS_OK;
  double *at = mpsi_alloc(context, 2 * p->nears, sizeof *at);
  int64_t *side = mpsi_alloc(context, p->nears, sizeof *side);
  mps_status status = at && side ? MPS_OK : refused(p, p->nears * 24);
  for (int64_t k = 0; status == MPS_OK && k < p->nears; k++) {
    at[k] = p->x[p->near[k]], at[p->nears + k] = p->y[p->near[k]];
    side[k] = p->side[p->near[k]];
  }
  mpsi_dynamics_geometry g = mpsi_dynamics_geometry_of(dynamics, p->nears, at, at + p->nears, side);
  g.edge = p->edge;
  if (status == MPS_OK) status = mpsi_dynamics_layout_edges(context, p->function, &g, edge);
  for (int64_t k = 0; status == MPS_OK && k < p->nears; k++)
    if (edge[k] >= 0) edge[k] = p->near[edge[k]];
  MPSI_FREE(context, at, side);
  return status;
}

/* ---- the cut --------------------------------------------------------------------------------- */

static bool own(const plan *p, int64_t k) { return (k >= p->first && k < p->last) || k >= p->body; }

/* Marks the ghosts of pairs that act on particles of these blocks: from own particles the first
 * layer, from the first layer the second. */
static mps_status mark(plan *p, mpsi_dynamics_source *source, int64_t blocks, const int32_t *block,
                       bool second) {
  int64_t pairs = 0, distinct = 0;
  mpsi_dynamics_pair *pair = NULL;
  const mps_status status =
      mpsi_dynamics_source_pairs(source, blocks, block, &pairs, &pair, &distinct);
  for (int64_t k = 0; status == MPS_OK && k < pairs; k++) {
    const int32_t i = pair[k].i, j = pair[k].j;
    const bool at_i = second ? p->cut.wanted[i] : own(p, i);
    const bool at_j = second ? p->cut.wanted[j] : own(p, j);
    uint8_t *marks = second ? p->present : p->cut.wanted;
    if (at_i && !own(p, j)) marks[j] = 1;
    if (at_j && !own(p, i)) marks[i] = 1;
  }
  mpsi_free(p->dynamics->context, pair);
  return status;
}

/* Blocks with an own particle, or with a ghost of the first layer. */
static int64_t list_marked(const plan *p, bool second, int32_t *block) {
  int64_t blocks = 0, last = -1;
  for (int64_t k = 0; k < p->count; k++) {
    const int64_t at = mpsi_dynamics_block_of(p->body, k);
    if (at != last && (second ? p->cut.wanted[k] != 0 : own(p, k)))
      block[blocks++] = (int32_t)(last = at);
  }
  return blocks;
}

/* Ghosts of the first layer, whose pressure is computed, and of the second. */
static mps_status find_ghosts(plan *p, mpsi_dynamics_source *source) {
  mps_context *context = p->dynamics->context;
  const int64_t all = mpsi_dynamics_block_of(p->body, p->count) + 1;
  int32_t *block = mpsi_alloc(context, all, sizeof *block);
  p->cut.wanted = mpsi_alloc(context, p->count, 1);
  p->present = mpsi_alloc(context, p->count, 1);
  mps_status status =
      p->cut.wanted && p->present && block ? MPS_OK : refused(p, p->count + all * 4);
  for (int layer = 0; layer < 2; layer++) {
    const int64_t blocks = status == MPS_OK ? list_marked(p, layer == 1, block) : 0;
    const int64_t size = mpsi_dynamics_batch_size(source, blocks);
    for (int64_t b = 0; status == MPS_OK && b < blocks; b += size)
      status = mark(p, source, size < blocks - b ? size : blocks - b, block + b, layer == 1);
  }
  for (int64_t k = 0; status == MPS_OK && k < p->body; k++) {
    p->present[k] |= p->cut.wanted[k];
    p->ghosts += p->present[k];
  }
  mpsi_free(context, block);
  return status;
}

static mps_status number_ghosts(plan *p) {
  mps_context *context = p->dynamics->context;
  const int64_t ranks = mps_domain_size(p->dynamics->domain);
  p->ghost = mpsi_alloc(context, p->ghosts, sizeof *p->ghost);
  p->ghost_rank = mpsi_alloc(context, p->ghosts, sizeof *p->ghost_rank);
  p->ghost_index = mpsi_alloc(context, p->ghosts, sizeof *p->ghost_index);
  p->cut.local = mpsi_alloc(context, p->count, sizeof *p->cut.local);
  if (!p->ghost || !p->ghost_rank || !p->ghost_index || !p->cut.local)
    return refused(p, p->count * 4);
  const int64_t body = p->last - p->first;
  int64_t rank = 0, ghosts = 0;
  p->cut.count = body + p->count - p->body;
  for (int64_t k = 0; k < p->count; k++) {
    p->cut.local[k] = k >= p->body                   ? (int32_t)(body + k - p->body)
                      : k >= p->first && k < p->last ? (int32_t)(k - p->first)
                                                     : -1;
    if (k >= p->body || !p->present[k]) continue;
    const int64_t global =
        p->block ? p->block[k / MPSI_DYN_BLOCK] * MPSI_DYN_BLOCK + k % MPSI_DYN_BLOCK : k;
    while (mpsi_dynamics_first_of_rank(p->whole, rank + 1, ranks) <= global) rank++;
    p->ghost[ghosts] = k;
    p->ghost_rank[ghosts] = (int32_t)rank;
    p->ghost_index[ghosts] = global - mpsi_dynamics_first_of_rank(p->whole, rank, ranks);
    p->cut.local[k] = (int32_t)(p->cut.count + ghosts++);
  }
  return MPS_OK;
}

static void add_block(mpsi_dynamics_cut *cut, int64_t block, int32_t begin, int32_t end) {
  const int64_t at = cut->blocks + cut->ghosts;
  cut->block[at] = (int32_t)block;
  cut->begin[at] = begin, cut->end[at] = end;
  cut->slot[block] = (int32_t)at;
}

/* Own blocks, then those of the columns, then ghost blocks with a particle of the first layer. */
static mps_status list_blocks(plan *p) {
  mps_context *context = p->dynamics->context;
  mpsi_dynamics_cut *cut = &p->cut;
  const int64_t all = p->count / MPSI_DYN_BLOCK + 2;
  cut->block = mpsi_alloc(context, all, sizeof *cut->block);
  cut->begin = mpsi_alloc(context, all, sizeof *cut->begin);
  cut->end = mpsi_alloc(context, all, sizeof *cut->end);
  cut->slot = mpsi_alloc(context, all, sizeof *cut->slot);
  if (!cut->block || !cut->begin || !cut->end || !cut->slot) return refused(p, all * 16);
  for (int64_t b = 0; b < all; b++) cut->slot[b] = -1;
  for (int64_t k = 0, next; k < p->count; k = next) {
    const int64_t block = mpsi_dynamics_block_of(p->body, k);
    for (next = k + 1; next < p->count && mpsi_dynamics_block_of(p->body, next) == block;) next++;
    if (!own(p, k)) continue;
    add_block(cut, block, cut->local[k], cut->local[next - 1] + 1);
    cut->blocks++;
  }
  for (int64_t g = 0, next; g < p->ghosts; g = next) {
    const int64_t block = p->ghost[g] / MPSI_DYN_BLOCK;
    bool wanted = p->cut.wanted[p->ghost[g]];
    for (next = g + 1; next < p->ghosts && p->ghost[next] / MPSI_DYN_BLOCK == block; next++)
      wanted = wanted || p->cut.wanted[p->ghost[next]];
    if (!wanted) continue;
    add_block(cut, block, (int32_t)(cut->count + g), (int32_t)(cut->count + next));
    cut->ghosts++;
  }
  return MPS_OK;
}

/* ---- the structure --------------------------------------------------------------------------- */

/* Dashpots between columns and those edge particles that are this rank's. */
static mps_status couple_columns(const plan *p, const int64_t *edge, mpsi_dynamics_structure *out) {
  const int64_t columns = p->count - p->body;
  out->column_dashpot = mpsi_alloc(p->dynamics->context, 2 * columns, sizeof *out->column_dashpot);
  if (!out->column_dashpot) return refused(p, 2 * columns * 64);
  for (int64_t k = p->near_body; k < p->nears; k++)
    for (int c = 0; c < 2; c++) {
      if (edge[k] < p->first || edge[k] >= p->last) continue;
      out->column_dashpot[out->column_dashpots++] =
          (mpsi_dynamics_dashpot){.particle = p->cut.local[edge[k]],
                                  .component = c,
                                  .boundary = -1,
                                  .partner = p->cut.local[p->near[k]]};
    }
  return MPS_OK;
}

static mps_status arrange_pairs(plan *p, mpsi_dynamics_structure *out) {
  mps_dynamics *dynamics = p->dynamics;
  mps_context *context = dynamics->context;
  const mpsi_dynamics_mesh_def def = {.kernel = dynamics->kernel,
                                      .density = dynamics->density,
                                      .particles = p->count,
                                      .body = p->body,
                                      .cut = &p->cut};
  mpsi_dynamics_source source = {
      .context = context,
      .function = p->function,
      .g = mpsi_dynamics_geometry_of(dynamics, p->count, p->x, p->y, p->side),
      .near = p->near,
      .nears = p->nears,
      .body = p->body};
  source.g.edge = p->edge;
  mps_status status = mpsi_dynamics_source_open(&source);
  if (status == MPS_OK) status = find_ghosts(p, &source);
  if (status == MPS_OK) status = number_ghosts(p);
  if (status == MPS_OK) status = list_blocks(p);
  if (status == MPS_OK)
    status =
        mpsi_dynamics_mesh_build(context, &out->mesh, &def, &source, &out->pairs, &out->lattice);
  mpsi_dynamics_source_close(&source);
  return status;
}

static mps_status make_structure(plan *p, mpsi_dynamics_structure *out) {
  mps_dynamics *dynamics = p->dynamics;
  int64_t *edge = mpsi_alloc(dynamics->context, p->nears, sizeof *edge);
  mps_status status = edge ? find_edges(p, edge) : refused(p, p->nears * 8);
  if (status == MPS_OK) status = arrange_pairs(p, out);
  out->count = p->cut.count, out->body = p->last - p->first, out->ghosts = p->ghosts;
  if (status == MPS_OK) status = mpsi_dynamics_allocate(dynamics, p->function, out);
  if (status == MPS_OK) status = couple_columns(p, edge, out);
  mpsi_free(dynamics->context, edge);
  return status;
}

/* ---- all of it ------------------------------------------------------------------------------- */

/* Have all ranks the same arguments? */
static mps_status compare_ranks(mps_dynamics *dynamics, const char *function, mps_status status) {
  const mps_dynamics_def *d = &dynamics->def;
  mpsi_given given = MPSI_GIVEN;
  MPSI_GIVE_DEF(&given, mps_dynamics_def, d);
  mpsi_give(&given, "divergence", dynamics->limits.bounded ? NAN : d->divergence);
  mpsi_give(&given, "the radius of the kernel", dynamics->radius);
  mpsi_give(&given, "the kind of the kernel", mps_kernel_get_kind(dynamics->kernel));
  mpsi_material_give(&given, d->material);
  status = mpsi_domain_agree_given(dynamics->domain, function, status, &given);
  if (status != MPS_OK || mpsi_particles_deal(dynamics->particles)) return status;
  return mpsi_domain_agree_particles(dynamics->domain, function, status, dynamics->particles);
}

/* Sums and extremes over the ranks; and the halo, once ghosts have their numbers. */
static mps_status join(plan *p, mpsi_dynamics_structure *out) {
  mps_dynamics *dynamics = p->dynamics;
  const mpsi_halo_def def = {.guests = p->ghosts,
                             .rank = p->ghost_rank,
                             .index = p->ghost_index,
                             .first = p->cut.count,
                             .columns = BACK};
  double off_lattice = !out->lattice;
  mps_status status = mpsi_domain_max(dynamics->domain, p->function, 1, &off_lattice);
  if (status == MPS_OK) status = mpsi_domain_sum(dynamics->domain, p->function, 1, &out->pairs);
  out->lattice = off_lattice == 0.0;
  if (status != MPS_OK) return status;
  return mpsi_halo_create(dynamics->domain, p->function, &def, &out->halo);
}

/* For a set that is whole on each rank: own particles and their ghosts, and the particles to keep.
 */
static mps_status plan_whole(plan *p) {
  mps_dynamics *dynamics = p->dynamics;
  const int64_t rank = mps_domain_rank(dynamics->domain), ranks = mps_domain_size(dynamics->domain);
  mps_status status = mpsi_dynamics_add_reference(dynamics, p->function);
  if (status == MPS_OK) status = sort_whole(p);
  p->whole = p->body;
  p->first = mpsi_dynamics_first_of_rank(p->body, rank, ranks);
  p->last = mpsi_dynamics_first_of_rank(p->body, rank + 1, ranks);
  return status == MPS_OK ? find_near(p) : status;
}

static mps_status keep_own(const plan *p, const mpsi_dynamics_structure *out,
                           mpsi_storage **former) {
  mps_dynamics *dynamics = p->dynamics;
  const int64_t count = p->cut.count, room = count + p->ghosts;
  if (!p->order) return mpsi_particles_hold_room(dynamics->particles, p->function, room);
  int64_t *rows = mpsi_alloc(dynamics->context, count, sizeof *rows);
  if (!rows) return refused(p, count * 8);
  for (int64_t k = 0; k < count; k++)
    rows[k] = p->order[k < out->body ? p->first + k : p->body + k - out->body];
  const mps_status status =
      mpsi_particles_keep(dynamics->particles, p->function, count, rows, room, former);
  mpsi_free(dynamics->context, rows);
  return status;
}

/* For a set in parts: particles are sent to their ranks, with the ghosts of each (deal.c). */
static mps_status plan_parts(plan *p, mpsi_backup *backup) {
  mpsi_dynamics_window part = {0};
  mps_status status = mpsi_dynamics_deal(p->dynamics, p->function, &part);
  if (status == MPS_OK)
    status = mpsi_particles_back_up(p->dynamics->particles, p->function, backup);
  p->count = p->body = part.count;
  p->block = part.block, p->whole = part.whole;
  p->x = part.x, p->y = part.y, p->side = part.side;
  p->first = part.first, p->last = part.last;
  p->near = part.near, p->nears = p->near_body = part.nears;
  memcpy(p->edge, part.edge, sizeof p->edge);
  return status;
}

mps_status mpsi_dynamics_take_partition(mps_dynamics *dynamics, const char *function,
                                        mps_status status, mpsi_dynamics_structure *out,
                                        mpsi_storage **former, mpsi_backup *backup) {
  plan p = {.dynamics = dynamics, .function = function};
  mps_domain *domain = dynamics->domain;
  *out = (mpsi_dynamics_structure){0};
  MPSI_TRY(compare_ranks(dynamics, function, status));
  const bool parts = mpsi_particles_deal(dynamics->particles) != NULL;
  status = parts ? plan_parts(&p, backup) : plan_whole(&p);
  if (status == MPS_OK) status = make_structure(&p, out);
  if (status == MPS_OK) status = keep_own(&p, out, former);
  if (status == MPS_OK) status = mpsi_dynamics_add_fields(dynamics, function);
  status = mpsi_domain_agree(domain, function, status);
  if (status == MPS_OK) status = join(&p, out);
  dynamics->whole = parts ? p.whole : p.count, dynamics->whole_body = p.whole;
  dynamics->lead = mps_domain_rank(domain) == mps_domain_size(domain) - 1;
  free_plan(&p);
  if (status != MPS_OK) mpsi_dynamics_free_structure(dynamics, out);
  return status;
}

/* ---- later ----------------------------------------------------------------------------------- */

mps_status mpsi_dynamics_bring_motion(mps_dynamics *dynamics, const char *function) {
  mpsi_dynamics_state *s = &dynamics->state;
  double *const column[3] = {s->dx, s->dy, s->th};
  if (!dynamics->halo) return MPS_OK;
  mps_status status = mpsi_halo_begin(dynamics->halo, function, 3, column);
  if (status == MPS_OK) status = mpsi_halo_end(dynamics->halo, function, column);
  if (status == MPS_OK)
    dynamics->kernels->trig[dynamics->def.rotation](s, dynamics->count,
                                                    dynamics->count + dynamics->ghosts);
  return status;
}

mps_status mpsi_dynamics_join_coefficients(mps_dynamics *dynamics, const char *function,
                                           mps_status status) {
  mpsi_dynamics_state *s = &dynamics->state;
  mpsi_dynamics_extremes *e = &dynamics->extremes;
  double *const column[3] = {s->mu, s->lambda, s->beta};
  double most[7] = {e->mu,        e->lambda,  -e->lightest, e->alpha[1],
                    -e->alpha[0], e->beta[1], -e->beta[0]};
  status = mpsi_domain_agree_max(dynamics->domain, function, status, 7, most);
  if (status != MPS_OK || !dynamics->halo) return status;
  *e = (mpsi_dynamics_extremes){.mu = most[0],
                                .lambda = most[1],
                                .lightest = -most[2],
                                .alpha = {-most[4], most[3]},
                                .beta = {-most[6], most[5]}};
  mpsi_dynamics_choose_damping(dynamics);
  MPSI_TRY(mpsi_halo_begin(dynamics->halo, function, 3, column));
  return mpsi_halo_end(dynamics->halo, function, column);
}
