/* restart.c - the state of the WLS-MPM solver (core/state.h): snapshots, rollback, checkpoints.
 * Sums over particles are taken block by block in the order of the set: a run that continues bit
 * for bit needs both as they were at the last sort. SPDX-License-Identifier: BSD-3-Clause */
#include "restart.h"
#include "rank_files.h"
#include "mpm/base/mpm_solver.h"
#include "mpm/water/water.h"
#include "mpm/boundary/free_field.h"
#include "mpm/particles/mpm_particles.h"
#include "mpm/step/insertion.h"

#include <string.h>

_Static_assert(sizeof(mpsi_dashpot) == MPSI_DASH * sizeof(double), "kept as numbers");

/* ---- tables: blocks, their nodes, dashpots --------------------------------------------------- */

/* Memory as by mpsi_room_ensure, keeping the contents. */
static bool keep_room(mps_context *context, mpsi_room *room, int64_t count, size_t size) {
  if (count <= room->capacity) return true;
  if (!mpsi_grow(context, &room->item, room->capacity, count, size)) return false;
  room->capacity = count;
  return true;
}

/* Number of blocks of cells; on several ranks of this one's, without ghosts. */
static int64_t count_blocks(const void *solver) {
  const mpsi_grid *grid = &((const mps_mpm *)solver)->grid;
  int64_t count = 0;
  for (int64_t b = 0; b < grid->cell_count; b++) count += !grid->cells[b].ghost;
  return count;
}

static void get_blocks(const void *solver, void *values) {
  const mps_mpm *mpm = solver;
  mpsi_block *block = values;
  for (int64_t b = 0, k = 0; b < mpm->grid.cell_count; b++) {
    const mpsi_cell_block *cells = &mpm->grid.cells[b];
    if (cells->ghost) continue;
    block[k][0] = cells->begin;
    for (int c = 0; c < 3; c++) {
      block[k][MPSI_BLOCK_AT + c] = cells->at[c];
      block[k][MPSI_BLOCK_LOW + c] = cells->low[c];
      block[k][MPSI_BLOCK_HIGH + c] = cells->high[c];
    }
    k++;
  }
}

static bool reserve_blocks(void *solver, int64_t rows, const void *values) {
  mps_mpm *mpm = solver;
  mpsi_grid *grid = &mpm->grid;
  const int64_t entries = 4 * rows + grid->nodes_room.capacity; /* see mpsi_mpm_ensure_pass */
  const bool good = keep_room(mpm->context, &grid->cells_room, rows, sizeof *grid->cells) &&
                    keep_room(mpm->context, &grid->coloured_room, rows, sizeof *grid->coloured) &&
                    keep_room(mpm->context, &grid->pass_room, entries, sizeof(_Atomic int32_t));
  grid->cells = grid->cells_room.item;
  grid->coloured = grid->coloured_room.item;
  return good;
}

/* Memory is reserved already, unless the sizes in a file are wrong: then the solver is marked as
 * broken and takes no step. */
static void set_blocks(void *solver, int64_t rows, const void *values) {
  mps_mpm *mpm = solver;
  mpm->run.lost = false;
  mpm->run.broken = mpsi_mpm_place_blocks(mpm->context, &mpm->grid, &mpm->p, mpm->partition,
                                          "restore", rows, (const mpsi_block *)values) != MPS_OK;
}

/* Sizes of the lists that depend on the blocks: blocks of nodes, boundaries on these, dashpots,
 * mirrors. */
enum { SIZES = 4 };

static int64_t one_row(const void *solver) { return 1; }

/* The speed of waves beside water that flows: one, or none. Files of 1.0 lack it: until the end of
 * the first step the limit of the flow stands in for it. */
static int64_t count_wave(const void *run) { return ((const mpsi_run *)run)->wave > 0.0 ? 1 : 0; }

static void get_wave(const void *run, void *values) {
  if (count_wave(run)) *(double *)values = ((const mpsi_run *)run)->wave;
}

static void set_wave(void *run, int64_t rows, const void *values) {
  ((mpsi_run *)run)->wave = rows > 0 ? *(const double *)values : 0.0;
}

static bool is_wave(const void *run, int64_t rows, const void *values) {
  const double wave = *(const double *)values;
  return rows == 1 && wave > 0.0 && isfinite(wave);
}

static const mpsi_state_table wave_table = {
    .type = MPSI_STATE_F64, .columns = 1, .rows = count_wave, .get = get_wave, .set = set_wave};

/* Contacts that have not yet made their first step. */
static int64_t count_new_contacts(const void *solver) {
  const mps_mpm *mpm = solver;
  int64_t count = 0;
  for (int32_t b = 0; b < mpm->contact.bodies; b++)
    count += mpm->contact.state[b].first_step == mpm->run.steps;
  return count;
}

static void get_new_contacts(const void *solver, void *values) {
  const mps_mpm *mpm = solver;
  int64_t *row = values;
  for (int32_t b = 0; b < mpm->contact.bodies; b++)
    if (mpm->contact.state[b].first_step == mpm->run.steps) *row++ = b;
}

static void set_new_contacts(void *solver, int64_t rows, const void *values) {
  mps_mpm *mpm = solver;
  const int64_t *row = values;
  for (int32_t b = 0; b < mpm->contact.bodies; b++) mpm->contact.state[b].first_step = -1;
  for (int64_t k = 0; k < rows; k++) mpm->contact.state[row[k]].first_step = mpm->run.steps;
}

static bool are_contacts(const void *solver, int64_t rows, const void *values) {
  const mps_mpm *mpm = solver;
  const int64_t *row = values;
  for (int64_t k = 0; k < rows; k++)
    if (row[k] < 0 || row[k] >= mpm->contact.bodies) return false;
  return true;
}

static const mpsi_state_table new_contacts_table = {.type = MPSI_STATE_I64,
                                                    .columns = 1,
                                                    .rows = count_new_contacts,
                                                    .get = get_new_contacts,
                                                    .set = set_new_contacts};

static void get_sizes(const void *solver, void *values) {
  const mps_mpm *mpm = solver;
  int64_t *size = values;
  size[0] = mpm->grid.node_count;
  size[1] = mpm->boundaries.held_count;
  size[2] = mpm->boundaries.dashpot_count;
  size[3] = mpm->mirrors.count;
}

static bool reserve_sizes(void *solver, int64_t rows, const void *values) {
  mps_mpm *mpm = solver;
  mpsi_grid *grid = &mpm->grid;
  mpsi_boundaries *b = &mpm->boundaries;
  const int64_t *size = values;
  if (rows != 1) return false;
  const bool good =
      keep_room(mpm->context, &grid->nodes_room, size[0], sizeof *grid->nodes) &&
      keep_room(mpm->context, &grid->node_room, size[0] * grid->block_nodes, sizeof *grid->node) &&
      keep_room(mpm->context, &b->held_room, size[1], sizeof *b->held) &&
      keep_room(mpm->context, &b->old_held_room, size[1], sizeof *b->held) &&
      keep_room(mpm->context, &b->dashpot_room, size[2], sizeof *b->dashpot) &&
      keep_room(mpm->context, &b->old_dashpot_room, size[2], sizeof *b->dashpot) &&
      keep_room(mpm->context, &mpm->mirrors.mirror_room, size[3], sizeof *mpm->mirrors.mirror) &&
      keep_room(mpm->context, &mpm->mirrors.mass_room,
                size[3] * mpsi_mirror_plane(grid->tile_nodes), sizeof *mpm->mirrors.mass);
  grid->nodes = grid->nodes_room.item;
  grid->node = grid->node_room.item;
  b->held = b->held_room.item;
  b->dashpot = b->dashpot_room.item;
  mpm->mirrors.mirror = mpm->mirrors.mirror_room.item;
  mpm->mirrors.mass = mpm->mirrors.mass_room.item;
  return good;
}

static void set_sizes(void *solver, int64_t rows, const void *values) {}

/* Number of dashpots on blocks of nodes for which this rank has all particles. */
static int64_t count_dashes(const void *solver) {
  const mps_mpm *mpm = solver;
  int64_t count = 0;
  for (int64_t t = 0; t < mpm->boundaries.held_count; t++)
    if (mpm->boundaries.held[t].dashpot >= 0 && mpm->boundaries.held[t].whole)
      count += mpm->grid.block_nodes / MPSI_SIDE;
  return count;
}

static void get_dashes(const void *solver, void *values) {
  const mps_mpm *mpm = solver;
  const mpsi_boundaries *b = &mpm->boundaries;
  const int64_t plane = mpm->grid.block_nodes / MPSI_SIDE;
  mpsi_dashpot *to = values;
  for (int64_t t = 0; t < b->held_count; t++) {
    if (b->held[t].dashpot < 0 || !b->held[t].whole) continue;
    memcpy(to, b->dashpot + b->held[t].dashpot, (size_t)plane * sizeof *to);
    to += plane;
  }
}

/* On several ranks dashpots are restored after the ghosts are found: mpsi_mpm_returned. */
static bool reserve_dashpots(void *solver, int64_t rows, const void *values) {
  mps_mpm *mpm = solver;
  return !mpm->partition ||
         mpsi_room_ensure(mpm->context, &mpm->boundaries.warm_room, rows, sizeof(mpsi_dashpot));
}

static void set_dashpots(void *solver, int64_t rows, const void *values) {
  mps_mpm *mpm = solver;
  if (mpm->partition) mpsi_mpm_keep_dashpots(&mpm->boundaries, rows, values);
  if (mpm->partition || mpm->run.broken) return;
  const mpsi_boundary_setup setup = mpsi_boundary_setup_of(mpm);
  mpm->run.broken = mpsi_mpm_put_dashpots(&setup, "restore", rows, values) != MPS_OK;
}

/* On several ranks, after the lists are restored: finds the ghosts, then restores the dashpots.
 * Collective. */
mps_status mpsi_mpm_returned(void *solver, const char *function) {
  mps_mpm *mpm = solver;
  if (!mpm->partition || !mpm->partition->outdated) return MPS_OK;
  const bool stale = mpm->run.stale;
  const mpsi_rank_part part = mpsi_rank_part_of(mpm);
  const mpsi_boundary_setup setup = mpsi_boundary_setup_of(mpm);
  mps_status status = mpsi_mpm_partition_find_ghosts(&part, function);
  if (status == MPS_OK)
    status = mpsi_domain_agree(mpm->domain, function,
                               mpsi_mpm_put_dashpots(&setup, function, mpm->boundaries.warm,
                                                     mpm->boundaries.warm_room.item));
  mpm->run.stale = mpm->run.stale || stale;
  mpm->run.broken = mpm->run.broken || status != MPS_OK;
  return status;
}

/* ---- warm-start impulses ----------------------------------------------------------------------
 */

/* Of contacts, then of lists of particles, whose bodies are negative (contact/prescribed.h). */
static mpsi_impulses *impulses_of(const void *solver, int which) {
  mps_mpm *mpm = (mps_mpm *)solver;
  return which == 0 ? &mpm->contact.impulses : &mpm->prescribed.constraints.impulses;
}

static int64_t count_warm_start(const void *solver) {
  return impulses_of(solver, 0)->warm_count + impulses_of(solver, 1)->warm_count;
}

/* The body, and above it the inset edge at which it bears or the mark of a rest gap. */
static int64_t owner_of(const mpsi_warm_impulse *warm) {
  return warm->body < 0 ? warm->body : (int64_t)warm->point << 32 | warm->body;
}

static void get_warm_start_owners(const void *solver, void *values) {
  int64_t *row = values;
  for (int which = 0; which < 2; which++) {
    const mpsi_impulses *all = impulses_of(solver, which);
    for (int64_t k = 0; k < all->warm_count; k++, row += 2)
      row[0] = all->warm[k].id, row[1] = owner_of(&all->warm[k]);
  }
}

static bool reserve_kept(void *solver, int64_t rows, const void *values) {
  bool good = true;
  for (int which = 0; which < 2; which++) {
    mpsi_impulses *all = impulses_of(solver, which);
    good =
        good && keep_room(((mps_mpm *)solver)->context, &all->warm_room, rows, sizeof *all->warm);
    all->warm = all->warm_room.item;
  }
  return good;
}

static void set_kept_owners(void *solver, int64_t rows, const void *values) {
  const int64_t *row = values;
  for (int which = 0; which < 2; which++) impulses_of(solver, which)->warm_count = 0;
  for (int64_t k = 0; k < rows; k++, row += 2) {
    mpsi_impulses *all = impulses_of(solver, row[1] < 0);
    const bool list = row[1] < 0;
    all->warm[all->warm_count++] =
        (mpsi_warm_impulse){.id = row[0],
                            .body = (int32_t)(list ? row[1] : row[1] & INT32_MAX),
                            .point = list ? 0 : (int32_t)(row[1] >> 32)};
  }
}

static void get_kept(const void *solver, void *values) {
  double *row = values;
  for (int which = 0; which < 2; which++) {
    const mpsi_impulses *all = impulses_of(solver, which);
    for (int64_t k = 0; k < all->warm_count; k++, row += 3)
      memcpy(row, all->warm[k].by, sizeof all->warm[k].by);
  }
}

static void set_kept(void *solver, int64_t rows, const void *values) {
  const double *row = values;
  for (int which = 0; which < 2; which++) {
    mpsi_impulses *all = impulses_of(solver, which);
    for (int64_t k = 0; k < all->warm_count; k++, row += 3)
      memcpy(all->warm[k].by, row, sizeof all->warm[k].by);
  }
}

/* ---- the list ------------------------------------------------------------------------------- */

static const mpsi_state_table blocks_table = {MPSI_STATE_I64, MPSI_BLOCK,     count_blocks,
                                              get_blocks,     reserve_blocks, set_blocks};
static const mpsi_state_table sizes_table = {MPSI_STATE_I64, SIZES,         one_row,
                                             get_sizes,      reserve_sizes, set_sizes};
static const mpsi_state_table dashes_table = {MPSI_STATE_F64, MPSI_DASH,        count_dashes,
                                              get_dashes,     reserve_dashpots, set_dashpots};

static const mpsi_state_table kept_owners_table = {
    MPSI_STATE_I64, 2, count_warm_start, get_warm_start_owners, reserve_kept, set_kept_owners};
static const mpsi_state_table kept_table = {MPSI_STATE_F64, 3,    count_warm_start,
                                            get_kept,       NULL, set_kept};

static void list_setting(mpsi_state *s, const mpsi_grid *grid, const mpsi_loads *all_loads,
                         const mpsi_contacts *contacts, const mps_mpm_def *def) {
  int64_t loads = 0;
  for (int32_t k = 0; k < all_loads->list->capacity; k++)
    loads += mpsi_load_of(all_loads, k) != NULL;
  mpsi_state_agree_choice(s, "geometry", "mps_mpm_geometry", (int32_t)grid->geometry);
  mpsi_state_agree_integer(s, "scheme", grid->standard);
  mpsi_state_agree_choice(s, "walls", "mps_mpm_edge", def->edge);
  mpsi_state_agree_integer(s, "spline", grid->spline);
  mpsi_state_agree_number(s, "cell", grid->cell);
  for (int c = 0; c < grid->dim; c++) {
    mpsi_state_enter(s, "axis%d", c);
    mpsi_state_agree_number(s, "origin", grid->origin[c]);
    mpsi_state_agree_integer(s, "lowest_node", grid->low[c]);
    mpsi_state_agree_integer(s, "highest_node", grid->high[c]);
    mpsi_state_leave(s);
  }
  mpsi_state_agree_integer(s, "loads", loads);
  mpsi_state_agree_number(s, "measure", grid->measure);
  mpsi_state_agree_integer(s, "bodies", contacts->bodies);
}

/* State of a cancelled mps_mpm_settle. */
static void list_settling(mpsi_state *s, mpsi_settling *settling) {
  mpsi_state_enter(s, "settling");
  mpsi_state_bool(s, "cut", &settling->cut);
  mpsi_state_bool(s, "from_rest", &settling->from_rest);
  mpsi_state_f64(s, "before", &settling->before, 1);
  mpsi_state_i64(s, "steps", &settling->steps, 1);
  mpsi_state_i64(s, "peaks", &settling->peaks, 1);
  mpsi_state_leave(s);
}

#define FILE_BOUNDARIES 64 /* numbers of boundaries that every file has */

/* Number of boundaries that a state lists: up to the last in use. */
static int32_t listed_boundaries(const mpsi_boundaries *boundaries) {
  int32_t count = boundaries->count;
  while (count > FILE_BOUNDARIES && boundaries->boundary[count - 1].kind == MPSI_BOUNDARY_NONE)
    count--;
  return count > FILE_BOUNDARIES ? count : FILE_BOUNDARIES;
}

static void list_state(mpsi_state *s, void *solver) {
  mps_mpm *mpm = solver;
  list_setting(s, &mpm->grid, &mpm->loads, &mpm->contact, &mpm->def);
  const int32_t numbers = listed_boundaries(&mpm->boundaries);
  if (numbers > FILE_BOUNDARIES) mpsi_state_agree_integer(s, "boundaries", numbers);
  for (int32_t k = 0; k < numbers; k++) {
    mpsi_boundary *boundary = k < mpm->boundaries.count ? &mpm->boundaries.boundary[k] : NULL;
    mpsi_state_enter(s, "boundary%d", k);
    mpsi_state_agree_choice(s, "kind", "mps_boundary_kind",
                            boundary ? boundary->kind : MPSI_BOUNDARY_NONE);
    /* a side that has been set free still shows its last force and what it has done */
    if (boundary && boundary->field) mpsi_mpm_list_free_field(s, boundary->field);
    if (boundary && (boundary->kind != MPSI_BOUNDARY_NONE || (k < MPSI_SIDES && boundary->sums))) {
      mpsi_state_exact(s, "step", boundary->sums->step, MPSI_BOUNDARY_MASS);
      mpsi_state_exact(s, "all", boundary->sums->all, MPSI_BOUNDARY_MASS + 1);
      mpsi_state_i64(s, "count", &boundary->count, 1);
      mpsi_state_i64(s, "removed", &boundary->removed, 1);
      mpsi_state_bool(s, "finds", &boundary->finds);
      mpsi_state_f64(s, "found", &boundary->found, 1);
    }
    mpsi_state_leave(s);
  }
  mpsi_state_agree_integer(s, "materials", mpm->p.laws.count);
  for (int32_t k = 0; k < mpm->p.laws.count; k++) {
    mpsi_state_enter(s, "material%d", k);
    mpsi_state_agree_text(s, "name", mps_material_name(mpm->p.laws.law[k].material));
    mpsi_state_leave(s);
  }
  mpsi_state_f64(s, "time", &mpm->run.time, 1);
  mpsi_state_f64(s, "boundaries_dt", &mpm->run.dt, 1);
  mpsi_state_exact(s, "boundaries_work", &mpm->boundaries.work, 1);
  mpsi_state_i64(s, "steps", &mpm->run.steps, 1);
  mpsi_state_f64(s, "speed", &mpm->run.speed, 1);
  mpsi_state_f64(s, "flow", &mpm->run.flow, 1);
  mpsi_state_bool(s, "stale", &mpm->run.stale);
  mpsi_state_bool(s, "moments", &mpm->run.moments);
  list_settling(s, &mpm->settling);
  mpsi_pore_list_state(s, mpm->water);
  mpsi_state_exact(s, "energies", mpm->energy.sum, MPSI_ENERGY_SUMS);
  mpsi_state_f64(s, "work_bodies", &mpm->energy.work_bodies, 1);
  for (int32_t b = 0; b < mpm->contact.bodies; b++) {
    mpsi_state_enter(s, "body%d", b);
    mpsi_body_list_state(s, mpm->contact.body[b]);
    mpsi_contact_list_state(s, mpm->contact.handle[b]);
    mpsi_state_leave(s);
  }
  mpsi_state_f64(s, "impulses_dt", &mpm->contact.impulses.warm_dt, 1);
  mpsi_state_i64(s, "sweeps", &mpm->contact.impulses.sweeps, 1);
  mpsi_state_f64(s, "impulses_left", &mpm->contact.impulses.left, 1);
  mpsi_state_add_table(s, "impulses_of", &kept_owners_table);
  mpsi_state_add_table(s, "impulses", &kept_table);
  mpsi_state_add_table(s, "sizes", &sizes_table);
  mpsi_state_add_table(s, "blocks", &blocks_table);
  mpsi_state_add_table(s, "dashpots", &dashes_table);
  mpsi_state_add_optional(s, "wave", &wave_table, is_wave, &mpm->run);
  mpsi_state_add_optional(s, "new_contacts", &new_contacts_table, are_contacts, mpm);
}

/* ---- checks of a file ------------------------------------------------------------------------ */

#define ROUNDED 1e-6 /* cells */

/* Whether the part of the tile in use lies within the tile and is wide enough for a stencil. */
static bool within_tile(const mpsi_grid *grid, const int64_t *b) {
  for (int c = 0; c < 3; c++) {
    const int64_t low = b[MPSI_BLOCK_LOW + c], high = b[MPSI_BLOCK_HIGH + c];
    const int64_t reach = mpsi_reach(grid, c);
    if (c >= grid->dim ? low != 0 || high != 1
                       : low < 0 || high > MPSI_SIDE + 2 + reach || high - low <= reach)
      return false;
  }
  return true;
}

static bool orderly(const mpsi_grid *grid, int64_t rows, const mpsi_block *block,
                    int64_t particles) {
  if (particles == 0) return rows == 0;
  if (rows < 1 || rows > particles || block[0][0] != 0) return false;
  for (int64_t k = 0; k < rows; k++) {
    const int64_t *b = block[k], *next = block[k + 1 < rows ? k + 1 : k];
    for (int c = 0; c < 3; c++) /* far from the limits of 32 bits, for nodes too */
      if (b[1 + c] < -MPSI_NO_WALL || b[1 + c] > MPSI_NO_WALL || (c >= grid->dim && b[1 + c] != 0))
        return false;
    if (!within_tile(grid, b)) return false;
    if (next == b) break;
    int c = 3;
    while (c > 1 && b[c] == next[c]) c--;
    if (b[0] >= next[0] || b[c] >= next[c]) return false;
  }
  return block[rows - 1][0] < particles;
}

/* Place of a particle of the file, with its position in m: 1 in the tile of its block; -1 where no
 * run can have it, unless it sorts next; 0 in between: outside by no more than the round-off of the
 * steps' fused products. */
static int place_of(const mpsi_grid *grid, const int64_t *block, bool stale, const double *x,
                    int64_t stride) {
  const double first = grid->spline == 3 ? 1.0 : 0.5; /* see move in g2p.c */
  int place = 1;
  for (int c = 0; c < grid->dim; c++) {
    const double X = mpsi_grid_at(grid, c, x[c * stride]);
    const double low = (double)grid->low[c], high = (double)grid->high[c];
    if (!(fabs(X) < MPSI_MAX_CELLS && X >= low - ROUNDED && X <= high + ROUNDED)) return -1;
    if (stale) continue;
    const double local = X - (double)(block[MPSI_BLOCK_AT + c] * MPSI_SIDE) - first;
    const double begin = (double)block[MPSI_BLOCK_LOW + c];
    const double end = (double)(block[MPSI_BLOCK_HIGH + c] - mpsi_reach(grid, c));
    if (local < begin - ROUNDED || local > end + ROUNDED) return -1;
    if (!(local >= begin && local < end)) place = 0;
  }
  return place;
}

/* Whether the blocks of a file contain their particles, and the laws of these exist. A step relies
 * on it: a stencil outside its tile would be memory outside. */
static bool contains_particles(const mpsi_grid *grid, const mpsi_columns *p, mps_snapshot *from) {
  const mpsi_value *blocks = mpsi_values_find(&from->state, "blocks");
  const mpsi_value *x = mpsi_values_find(&from->fields, "position");
  const mpsi_value *law = mpsi_values_find(&from->fields, "material");
  int64_t *stale = mpsi_values_find(&from->state, "stale")->data;
  const mpsi_block *block = blocks->data;
  const int64_t count = from->particles;
  if (!x || x->type != MPSI_STATE_F64 || x->columns != grid->dim) return false;
  if (p->law && !(law && law->type == MPSI_STATE_I64)) return false;
  if (!orderly(grid, blocks->rows, block, count)) return false;
  for (int64_t k = 0, b = 0; k < count; k++) {
    const int64_t number = p->law ? ((const int64_t *)law->data)[k] : 0;
    if (number < 0 || number >= p->laws.count) return false;
    if (b + 1 < blocks->rows && k == block[b + 1][0]) b++;
    const int place = place_of(grid, block[b], *stale != 0, (const double *)x->data + k, count);
    if (place < 0) return false;
    if (place == 0) *stale = 1; /* the particles are sorted before the next step */
  }
  return true;
}

static bool contains_impulses(const mpsi_contacts *contacts, const mps_snapshot *from) {
  const mpsi_value *owners = mpsi_values_find(&from->state, "impulses_of");
  const mpsi_value *impulses = mpsi_values_find(&from->state, "impulses");
  const double dt = *(const double *)mpsi_values_find(&from->state, "impulses_dt")->data;
  if (owners->rows != impulses->rows || owners->rows > MPSI_MPM_MOST_PARTICLES) return false;
  if (!(dt >= 0.0) || !isfinite(dt)) return false;
  for (int64_t k = 0; k < owners->rows; k++) {
    const int64_t owner = ((const int64_t *)owners->data)[2 * k + 1];
    const int64_t body = owner < 0 ? owner : owner & INT32_MAX;
    const bool list = body < -MPSI_SIDES && body >= INT32_MIN; /* contact/prescribed.h */
    if (!list && (body < 0 || body >= contacts->bodies)) return false;
    for (int c = 0; c < 3; c++)
      if (!isfinite(((const double *)impulses->data)[3 * k + c])) return false;
  }
  return true;
}

static bool fits(void *solver, mps_snapshot *from, const char **what) {
  const mps_mpm *mpm = solver;
  const mpsi_value *sizes = mpsi_values_find(&from->state, "sizes");
  const double speed = *(const double *)mpsi_values_find(&from->state, "speed")->data;
  *what = "its blocks do not contain its particles";
  if (!(speed > 0.0 || (speed == 0.0 && from->particles == 0)) || !isfinite(speed) ||
      sizes->rows != 1 || from->particles > MPSI_MPM_MOST_PARTICLES)
    return false;
  for (int k = 0; k < SIZES; k++) {
    const int64_t size = ((const int64_t *)sizes->data)[k];
    if (size < 0 || size > MPSI_NO_WALL) return false;
  }
  if (!contains_particles(&mpm->grid, &mpm->p, from)) return false;
  *what = "the columns of its free-field sides have other laws or rows";
  for (int32_t k = 0; k < 2; k++) {
    const mpsi_free_field *field = mpm->boundaries.boundary[k].field;
    if (field && !mpsi_mpm_free_field_fits(field, k, &mpm->p.laws, from)) return false;
  }
  *what = "its impulses of contact are not one of each particle and body";
  return contains_impulses(&mpm->contact, from);
}

/* ---- public functions ------------------------------------------------------------------------ */

static void bind(void *solver) {
  mps_mpm *mpm = solver;
  mpsi_mpm_bind(&mpm->grid, &mpm->p, mpm->water);
}

/* Marks edits as applied: a snapshot is of such a state, and had passed all checks. */
static void forget_edits(void *solver) {
  mpsi_run *run = &((mps_mpm *)solver)->run;
  run->edited = run->unchecked = false;
  run->begun = run->changed = run->renewed = true;
}

static mps_status settle(void *solver, const char *function, mps_status status) {
  mps_mpm *mpm = solver;
  return mpsi_mpm_agree(mpm->partition, function, status);
}

mpsi_state_of mpsi_mpm_state(void *solver) {
  mps_mpm *mpm = solver;
  return (mpsi_state_of){.solver = mpm,
                         .name = "WLS-MPM",
                         .context = mpm->context,
                         .particles = mpm->p.set,
                         .identity = &mpm->identity,
                         .list = list_state,
                         .fits = fits,
                         .reserve = mpsi_mpm_hold_room,
                         .take_share = mpsi_mpm_restore_on_ranks,
                         .settle = settle,
                         .bind = bind,
                         .after = forget_edits,
                         .time = mpm->run.time,
                         .dt = mpsi_mpm_dt(mpm),
                         .steps = mpm->run.steps};
}

/* The lists in a snapshot must be those of the present boundaries. */
mps_status mpsi_mpm_settle_state(void *solver, const char *function) {
  mps_mpm *mpm = solver;
  mpm->run.as_kept = mpsi_mpm_edit_state(&mpm->run);
  if (mpm->run.broken)
    return mpsi_fail(mpm->context, function, MPS_ERROR_STATE,
                     "step %lld has failed: there is no state to go on from",
                     (long long)mpm->run.steps);
  MPSI_TRY(mpsi_mpm_apply_edits(mpm, function));
  const mpsi_boundary_setup setup = mpsi_boundary_setup_of(mpm);
  return mpsi_mpm_update_boundaries(&setup, function, MPS_OK);
}

void mpsi_mpm_settled_state(void *solver, mps_status status) {
  mpsi_run *run = &((mps_mpm *)solver)->run;
  if (status != MPS_OK) mpsi_mpm_restore_edit_state(run, &run->as_kept);
}

mps_status mpsi_mpm_save_state(void *solver, const mpsi_state_of *of, const char *function,
                               const char *path, const mps_checkpoint *info) {
  mps_mpm *mpm = solver;
  mpsi_mpm_order_warm_start(&mpm->contact.impulses);
  mpsi_mpm_order_warm_start(&mpm->prescribed.constraints.impulses);
  return mpm->partition ? mpsi_mpm_save_on_ranks(mpm, of, function, path, info)
                        : mpsi_checkpoint_save(of, function, path, info);
}
