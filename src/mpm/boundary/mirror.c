/* mirror.c - folding of ghosts on mirrors, and their images: see mirror.h.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "body/rotation.h"
#include "core/base/room_array.h"
#include "mpm/base/kernels.h"
#include "kinds.h"
#include "mpm/base/energy.h"
#include "mpm/base/run.h"
#include "mpm/boundary/mirror.h"
#include "mpm/contact/thin_bodies.h"

#include <string.h>

enum { LAYERS = 2 }; /* layers of ghosts: round-off alone puts particles in reach of the second */

/* ---- sides that are mirrors ------------------------------------------------------------------ */

static bool is_mirror(const mpsi_grid *grid, const mpsi_boundaries *boundaries,
                      const mps_mpm_def *def, int32_t k) {
  const mpsi_mirrored when = mpsi_kind_of(&boundaries->boundary[k])->mirror;
  return when == MPSI_MIRROR_ALWAYS ||
         (when == MPSI_MIRROR_WALLS && !grid->standard && def->edge == MPS_MPM_EDGE_MIRROR);
}

static void find_sides(mpsi_grid *grid, const mpsi_boundaries *boundaries, mpsi_mirrors *mirrors,
                       const mps_mpm_def *def) {
  mirrors->sides = 0;
  for (int32_t k = 0; k < 2 * grid->dim; k++)
    if (is_mirror(grid, boundaries, def, k)) mirrors->sides |= 1u << k;
  for (int c = 0; c < 3; c++) {
    const bool lower = mirrors->sides >> (2 * c) & 1;
    const bool upper = mirrors->sides >> (2 * c + 1) & 1;
    grid->use_low[c] = lower ? -MPSI_NO_WALL : grid->low[c];
    grid->use_high[c] = upper ? MPSI_NO_WALL : grid->high[c];
  }
}

static void find_of_block(const mpsi_grid *grid, const mpsi_mirrors *mirrors,
                          mpsi_cell_block *cells) {
  cells->edge = false;
  cells->mirrors = 0; /* a node on a mirror does not move across it, though none lies beyond */
  for (int c = 0; c < grid->dim; c++) {
    const int64_t first = (int64_t)cells->at[c] * MPSI_SIDE, last = first + MPSI_TILE_SIDE - 1;
    if (first < grid->use_low[c] || last > grid->use_high[c]) cells->edge = true;
    if (first + cells->low[c] <= grid->low[c])
      cells->mirrors |= (uint8_t)(mirrors->sides & 1u << (2 * c));
    if (first + cells->high[c] - 1 >= grid->high[c])
      cells->mirrors |= (uint8_t)(mirrors->sides & 2u << (2 * c));
  }
}

mps_status mpsi_mpm_list_mirrors(mps_context *context, mpsi_grid *grid,
                                 const mpsi_boundaries *boundaries, mpsi_mirrors *all,
                                 const mps_mpm_def *def, const char *function) {
  find_sides(grid, boundaries, all, def);
  int64_t count = 0;
  for (int64_t b = 0; b < grid->cell_count; b++) {
    mpsi_cell_block *cells = &grid->cells[b];
    find_of_block(grid, all, cells);
    cells->first_mirror = (int32_t)count;
    for (uint32_t rest = cells->mirrors; rest; rest &= rest - 1) count++;
  }
  const int64_t plane = mpsi_mirror_plane(grid->tile_nodes);
  all->count = 0;
  if (!MPSI_ENSURE(context, all, mirror, count) || !MPSI_ENSURE(context, all, mass, count * plane))
    return mpsi_fail_memory(context, function, (size_t)(count * plane) * sizeof *all->mass);
  all->count = count;
  return MPS_OK;
}

int mpsi_mpm_mirror_partner(const mpsi_grid *grid, const mpsi_cell_block *cells, int c, int node) {
  const int64_t first = (int64_t)cells->at[c] * MPSI_SIDE;
  const int64_t low = grid->low[c] - first, high = grid->high[c] - first;
  if (cells->mirrors >> (2 * c) & 1 && node < low) return (int)(2 * low - node);
  if (cells->mirrors >> (2 * c + 1) & 1 && node > high) return (int)(2 * high - node);
  return node;
}

/* ---- one side under a tile ------------------------------------------------------------------- */

typedef struct side {
  const mpsi_grid *grid;
  const mpsi_cell_block *cells;
  int axis;
  int wall, inwards;  /* tile node of the wall along the axis; +1 or -1 */
  double keeps[3];    /* the diagonal of R */
  double velocity[3]; /* m/s, (I - R) v_w */
  const mpsi_boundary *boundary;
  mpsi_mirror *mirrors, *mirror; /* of the tile; of the side */
  double *mass;
} side;

static side side_of(const mpsi_grid *grid, const mpsi_boundaries *boundaries,
                    const mpsi_mirrors *mirrors, const mpsi_cell_block *cells, int32_t k,
                    bool across) {
  const mpsi_boundary *boundary = &boundaries->boundary[k];
  const int c = k / 2;
  const int64_t node = k % 2 ? grid->high[c] : grid->low[c];
  side out = {.grid = grid,
              .cells = cells,
              .axis = c,
              .wall = (int)(node - (int64_t)cells->at[c] * MPSI_SIDE),
              .inwards = k % 2 ? -1 : 1};
  for (int a = 0; a < 3; a++) {
    const bool turns = mpsi_side_turns(boundary, c, a);
    out.keeps[a] = turns ? -1.0 : 1.0;
    out.velocity[a] = turns ? 2.0 * boundary->v[a] : 0.0;
  }
  int64_t number = cells->first_mirror;
  for (uint32_t lower = cells->mirrors & ((1u << k) - 1); lower; lower &= lower - 1) number++;
  out.mirror = &mirrors->mirror[number];
  out.boundary = boundaries->boundary;
  out.mirrors = &mirrors->mirror[cells->first_mirror];
  if (across) number += mirrors->count;
  out.mass = mirrors->mass + number * mpsi_mirror_plane(grid->tile_nodes);
  return out;
}

/* Sides after `s` that turn component c of tile node `at` too, beyond which it lies. */
typedef struct others {
  int count;
  int32_t side[2];
} others;

static others find_others(const side *s, const int *at, int c) {
  others out = {.count = 0};
  if (s->keeps[c] > 0.0) return out;
  for (int32_t k = 2 * s->axis + 2; k < MPSI_SIDES && out.count < 2; k++) {
    if (!(s->cells->mirrors >> k & 1)) continue;
    const int a = k / 2;
    const int64_t node = (int64_t)s->cells->at[a] * MPSI_SIDE + at[a];
    const bool beyond = k % 2 ? node > s->grid->high[a] : node < s->grid->low[a];
    if (beyond && mpsi_side_turns(&s->boundary[k], a, c)) out.side[out.count++] = k;
  }
  return out;
}

/* What component c has besides its reflection. A ghost beyond several sides that all turn it is
 * reflected several times, and must be the same whichever side comes first: the velocities of two
 * cancel, if the first takes that of the other; of three their mean is left. */
static double velocity_of(const side *s, const others *o, int c) {
  if (o->count == 0) return s->velocity[c];
  const double first = 2.0 * s->boundary[o->side[0]].v[c];
  return o->count == 1 ? first
                       : (s->velocity[c] + first + 2.0 * s->boundary[o->side[1]].v[c]) / 3.0;
}

/* A ghost and its partner, with positions in m. */
typedef struct couple {
  int ghost, partner, place; /* tile nodes; index in the plane of the tile */
  const int *at;             /* the ghost's place in the tile */
  double x_ghost[3], x_partner[3];
} couple;

typedef void (*couple_fn)(const side *s, const couple *at, int layer, void *data);

static bool in_use(const side *s, int node) {
  return node >= s->cells->low[s->axis] && node < s->cells->high[s->axis];
}

static void for_couples(const side *s, couple_fn work, void *data) {
  const int c = s->axis, a = (c + 1) % 3, b = (c + 2) % 3;
  const int first = a < b ? a : b, second = a < b ? b : a;
  for (int layer = 1; layer <= LAYERS; layer++) {
    int at[3];
    const int ghost = s->wall - layer * s->inwards, partner = s->wall + layer * s->inwards;
    if (!in_use(s, ghost) || !in_use(s, partner)) continue;
    for (at[second] = s->cells->low[second]; at[second] < s->cells->high[second]; at[second]++)
      for (at[first] = s->cells->low[first]; at[first] < s->cells->high[first]; at[first]++) {
        couple pair = {.place = at[second] * MPSI_TILE_SIDE + at[first], .at = at};
        for (int image = 0; image < 2; image++) {
          at[c] = image ? ghost : partner;
          const double local[3] = {at[0], at[1], at[2]};
          mpsi_node_position(s->grid, s->cells->at, local, image ? pair.x_ghost : pair.x_partner);
          *(image ? &pair.ghost : &pair.partner) = mpsi_tile_index(at[0], at[1], at[2]);
        }
        work(s, &pair, layer, data);
      }
  }
}

/* Adds to the wall's impulse the change from `before` at x_before to `after` at x_after. */
static void add_change(mpsi_mirror *to, const double *x_after, const double *after,
                       const double *x_before, const double *before) {
  for (int c = 0; c < 3; c++) {
    const int a = (c + 1) % 3, b = (c + 2) % 3;
    to->impulse[c] += after[c] - before[c];
    to->moment[c] += (x_after[a] * after[b] - x_after[b] * after[a]) -
                     (x_before[a] * before[b] - x_before[b] * before[a]);
  }
}

/* Counts a change with the sides that make it together: of two that both turn a component the other
 * one, whose own change is then the opposite; of three each a third. */
static void share_change(const side *s, const others *o, const double *x_after, const double *after,
                         const double *x_before, const double *before) {
  double own[3];
  for (int c = 0; c < 3; c++) {
    const double part = o[c].count == 0 ? 1.0 : o[c].count == 1 ? 0.0 : 1.0 / 3.0;
    own[c] = part == 1.0 ? after[c] : before[c] + part * (after[c] - before[c]);
  }
  add_change(s->mirror, x_after, own, x_before, before);
  for (int c = 0; c < 3; c++)
    for (int i = 0; i < o[c].count; i++) {
      const double from[3] = {0.0};
      double change[3] = {0.0};
      int number = 0;
      for (uint32_t lower = s->cells->mirrors & ((1u << o[c].side[i]) - 1); lower;
           lower &= lower - 1)
        number++;
      change[c] = (after[c] - before[c]) / (o[c].count == 1 ? 1.0 : 3.0);
      add_change(&s->mirrors[number], x_after, change, x_after, from);
    }
}

/* The tiles that are folded and mirrored back: a block's own, or the second ones
 * (thin_bodies.h). */
typedef struct tiles {
  mpsi_node *tile, *force;
  bool across;
  double dt;      /* s */
  double counted; /* fraction of a change of momentum, but for that of forces, which is the wall's
                     impulse: particles keep the rest (`keep` of mpsi_transfer), and the same
                     fraction of what mirroring back the velocities before the forces changes */
} tiles;

/* ---- folding --------------------------------------------------------------------------------- */

static void fold_node(const side *s, const couple *at, int layer, void *data) {
  const tiles *of = data;
  double *ghost = of->tile[at->ghost], *partner = of->tile[at->partner];
  const bool apart = s->cells->apart;
  double *force = of->force[at->ghost], *to = of->force[at->partner];
  double before[3], after[3];
  others o[3];
  const double m = ghost[MPSI_MASS];
  if (layer == 1) s->mass[at->place] = m;
  for (int c = 0; c < 3; c++) {
    const double q = ghost[MPSI_VECTOR + c], f = apart ? force[MPSI_VECTOR + c] : 0.0;
    o[c] = find_others(s, at->at, c);
    const double velocity = velocity_of(s, &o[c], c);
    const double folded = s->keeps[c] * q + m * velocity;
    partner[MPSI_VECTOR + c] += folded;
    if (apart) to[MPSI_VECTOR + c] += s->keeps[c] * f;
    before[c] = of->counted * q + of->dt * f;
    after[c] = of->counted * folded + of->dt * s->keeps[c] * f;
    s->mirror->passed += of->dt * f * velocity;
  }
  share_change(s, o, at->x_partner, after, at->x_ghost, before);
  partner[MPSI_MASS] += m;
  memset(ghost, 0, sizeof(mpsi_node));
  if (!apart) return;
  to[MPSI_EXCESS] += force[MPSI_EXCESS];
  memset(force, 0, sizeof(mpsi_node));
}

static void fold_tiles(const mpsi_transfer *work, tiles *of) {
  for (int32_t k = 0; k < MPSI_SIDES; k++) {
    if (!(work->cells->mirrors >> k & 1)) continue;
    const side s = side_of(work->grid, work->boundaries, work->mirrors, work->cells, k, of->across);
    for_couples(&s, fold_node, of);
  }
}

void mpsi_mpm_fold(const mpsi_transfer *work) {
  const mpsi_worker *worker = work->worker;
  const double counted = 1.0 - work->keep;
  tiles own = {worker->tile, worker->force, false, work->run->dt, counted};
  tiles across = {worker->across_tile, worker->across_force, true, work->run->dt, counted};
  fold_tiles(work, &own);
  if (work->cells->thin) fold_tiles(work, &across);
}

/* ---- mirroring back -------------------------------------------------------------------------- */

static void mirror_node(const side *s, const couple *at, int layer, void *data) {
  const tiles *of = data;
  double *ghost = of->tile[at->ghost];
  const double m = layer == 1 ? of->counted * s->mass[at->place] : 0.0;
  const double *partner = of->tile[at->partner];
  double before[3], after[3];
  others o[3];
  ghost[MPSI_MASS] = partner[MPSI_MASS];
  for (int c = 0; c < 3; c++) {
    o[c] = find_others(s, at->at, c);
    const double velocity = velocity_of(s, &o[c], c);
    ghost[MPSI_VECTOR + c] = s->keeps[c] * partner[MPSI_VECTOR + c] + velocity;
    before[c] = m * partner[MPSI_VECTOR + c];
    after[c] = m * ghost[MPSI_VECTOR + c];
  }
  if (m != 0.0) share_change(s, o, at->x_ghost, after, at->x_partner, before);
}

static void unfold_tiles(const mpsi_transfer *work, tiles *of) {
  for (int32_t k = MPSI_SIDES - 1; k >= 0; k--) {
    if (!(work->cells->mirrors >> k & 1)) continue;
    const side s = side_of(work->grid, work->boundaries, work->mirrors, work->cells, k, of->across);
    for_couples(&s, mirror_node, of);
  }
}

void mpsi_mpm_unfold(const mpsi_transfer *work) {
  const mpsi_worker *worker = work->worker;
  tiles own = {.tile = worker->tile, .counted = work->before ? -work->keep : 1.0}, across = own;
  across.tile = worker->across_tile, across.across = true;
  unfold_tiles(work, &own);
  if (work->cells->thin) unfold_tiles(work, &across);
}

/* ---- bodies near a mirror -------------------------------------------------------------------- */

static void copy_state(const side *s, const couple *at, int layer, void *data) {
  mpsi_worker *worker = data;
  worker->state[at->ghost] = worker->state[at->partner];
}

void mpsi_mpm_mirror_states(const mpsi_transfer *work) {
  for (int32_t k = 0; k < MPSI_SIDES; k++) {
    if (!(work->cells->mirrors >> k & 1)) continue;
    const side s = side_of(work->grid, work->boundaries, work->mirrors, work->cells, k, false);
    for_couples(&s, copy_state, work->worker);
  }
}

static bool is_folded(const side *s, const int *at) {
  return (at[s->axis] - s->wall) * s->inwards <= 0;
}

/* Factor of component c in the image of tile node `at`: a node on the wall is its own image. */
static double reflection_of(const side *s, const int *at, int c) {
  return at[s->axis] == s->wall && s->keeps[c] < 0.0 ? 0.0 : s->keeps[c];
}

static void reflect_by(const mpsi_grid *grid, const side *s, int *at, double *vector,
                       double impulse) {
  double x_before[3], x_after[3], before[3], after[3];
  const double from[3] = {at[0], at[1], at[2]};
  mpsi_node_position(grid, s->cells->at, from, x_before);
  for (int c = 0; c < 3; c++) {
    before[c] = impulse * vector[c];
    vector[c] *= reflection_of(s, at, c);
    after[c] = impulse * vector[c];
  }
  at[s->axis] = 2 * s->wall - at[s->axis];
  const double to[3] = {at[0], at[1], at[2]};
  mpsi_node_position(grid, s->cells->at, to, x_after);
  if (impulse != 0.0) add_change(s->mirror, x_after, after, x_before, before);
}

void mpsi_mpm_reflect(const mpsi_grid *grid, const mpsi_boundaries *boundaries,
                      const mpsi_mirrors *mirrors, const mpsi_cell_block *cells, int *at,
                      double *vector, double impulse) {
  for (int32_t k = 0; k < MPSI_SIDES; k++) {
    if (!(cells->mirrors >> k & 1)) continue;
    const side s = side_of(grid, boundaries, mirrors, cells, k, false);
    if (is_folded(&s, at)) reflect_by(grid, &s, at, vector, impulse);
  }
}

/* What sides do to component c of a node's image: `beyond` of them reflect it, with twice their
 * velocities in all `twice`; if the node lies on a side (`on`), that prescribes it. */
typedef struct folds {
  int beyond, on;
  double twice, wall;
} folds;

static void add_fold(const side *s, const int *at, int c, folds *to) {
  if (s->keeps[c] > 0.0) return;
  const bool across = c == s->axis;
  if (at[s->axis] != s->wall) {
    to->beyond++;
    to->twice += s->velocity[c];
  } else if (across || to->on != -1) { /* -1: the side across c, as in corners.h */
    const double v = 0.5 * s->velocity[c];
    to->on = across ? -1 : to->on + 1;
    to->wall = across || to->on == 1 ? v : to->wall + (v - to->wall) / to->on;
  }
}

bool mpsi_mpm_find_image(const mpsi_grid *grid, const mpsi_boundaries *boundaries,
                         const mpsi_mirrors *mirrors, const mpsi_cell_block *cells, int *at,
                         double *keeps, double *carried) {
  folds all[3] = {{0}};
  bool any = false;
  for (int32_t k = 0; k < MPSI_SIDES; k++) {
    if (!(cells->mirrors >> k & 1)) continue;
    const side s = side_of(grid, boundaries, mirrors, cells, k, false);
    if (!is_folded(&s, at)) continue;
    any = true;
    for (int c = 0; c < 3; c++) add_fold(&s, at, c, &all[c]);
    at[s.axis] = 2 * s.wall - at[s.axis];
  }
  for (int c = 0; c < 3; c++) { /* the velocities of two sides cancel, as in velocity_of */
    const folds *f = &all[c];
    keeps[c] = f->beyond % 2 ? -1.0 : 1.0;
    carried[c] = f->beyond % 2 ? f->twice / f->beyond : 0.0;
    if (f->on == 0) continue;
    carried[c] += keeps[c] * f->wall;
    keeps[c] = 0.0;
  }
  return any;
}

/* Besides the impulse's image: the energy that the velocities of the sides make of it. */
void mpsi_mpm_reflect_impulse(const mpsi_grid *grid, const mpsi_boundaries *boundaries,
                              const mpsi_mirrors *mirrors, const mpsi_cell_block *cells, int *at,
                              const double *impulse) {
  double vector[3] = {impulse[0], impulse[1], impulse[2]}, keeps[3], carried[3];
  int image[3] = {at[0], at[1], at[2]};
  double energy = 0.0;
  if (!mpsi_mpm_find_image(grid, boundaries, mirrors, cells, image, keeps, carried)) return;
  for (int c = 0; c < 3; c++) energy += impulse[c] * carried[c];
  for (int32_t k = 0; k < MPSI_SIDES; k++) {
    if (!(cells->mirrors >> k & 1)) continue;
    const side s = side_of(grid, boundaries, mirrors, cells, k, false);
    if (!is_folded(&s, at)) continue;
    reflect_by(grid, &s, at, vector, 1.0);
    s.mirror->passed += energy;
    energy = 0.0;
  }
}

/* ---- a step ---------------------------------------------------------------------------------- */

void mpsi_mpm_begin_mirrors(const mpsi_mirrors *mirrors, const mpsi_cell_block *cells) {
  int64_t number = cells->first_mirror;
  for (uint32_t rest = cells->mirrors; rest; rest &= rest - 1)
    mirrors->mirror[number++] = (mpsi_mirror){.passed = 0.0};
}

void mpsi_mpm_sum_mirrors(const mpsi_grid *grid, const mpsi_boundaries *boundaries,
                          const mpsi_mirrors *mirrors, mpsi_energy *energy) {
  for (int64_t b = 0; b < grid->cell_count; b++) {
    const mpsi_cell_block *cells = &grid->cells[b];
    int64_t number = cells->first_mirror;
    for (int32_t k = 0; k < MPSI_SIDES && !cells->ghost; k++) {
      if (!(cells->mirrors >> k & 1)) continue;
      const mpsi_mirror *m = &mirrors->mirror[number++];
      mpsi_boundary *boundary = &boundaries->boundary[k];
      const double work = mpsi_dot3(m->impulse, boundary->v);
      mpsi_mpm_boundary_add_impulse(boundary, m->impulse, m->moment, work, 0);
      mpsi_mpm_energy_add(energy, MPSI_ENERGY_BOUNDARIES, work);
      mpsi_mpm_energy_add(energy, MPSI_ENERGY_BOUNDARY_LOSS, work + m->passed);
    }
  }
}
