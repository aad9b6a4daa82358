/* pass.c - see pass.h. Each thread has a lane: its part of the blocks of cells, consecutive in
 * their order. These lie side by side, so that nodes move from one processor's cache to another's
 * only at the borders of lanes (with one queue for all, from which any thread took neighbouring
 * blocks, the same work took a fourth more time). Blocks that are ready are in the queue of their
 * lane, from which its thread claims some at a time; the thread that completes a block's last
 * dependency enqueues it. Blocks that became ready precede blocks that were ready from the start:
 * their particles and nodes are still in the cache. A thread whose lane is empty, or waits for
 * long, claims from other lanes. A thread that finds nothing ready spins for some microseconds and
 * then sleeps briefly; under a caller's executor, which may run the units one after the other, it
 * returns. The pass is complete when all threads have returned, since a thread that makes a block
 * ready polls the queues after that.
 *
 * A single thread goes over the blocks in their order and completes the dependencies of each first.
 * On several ranks the caller's thread, the only one that may call the transport, receives the
 * ghosts' tiles when it finds nothing else to do, while the others continue.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "blocks.h"
#include "core/internal.h"
#include "mpm/ranks/partition.h"

#include <stdatomic.h>

#define SMALL_SET 2048 /* particles: below, sharing the work costs more than it gains */
/* units for each thread of a caller's executor, which may return and come again */
#define ROUNDS 4
#define MOST_CLAIMED 8
#define PATIENCE 100 /* polls of its own lane before a thread claims from another one */

/* Parities of the coordinates of a block of nodes, a bit each. */
static int parity_of(const mpsi_node_block *nodes) {
  return (nodes->at[0] & 1) | (nodes->at[1] & 1) << 1 | (nodes->at[2] & 1) << 2;
}

static bool awaits(const mpsi_pass *pass) { return pass->ranks && pass->arrive; }

/* Whether this rank updates the block of nodes g, or gathers the block of cells b: see
 * partition.h. */
static bool has_nodes(const mpsi_grid *grid, const mpsi_pass *pass, int64_t g) {
  return pass->ghosts || !grid->nodes[g].foreign;
}

static bool has_cells(const mpsi_grid *grid, const mpsi_pass *pass, int64_t b) {
  return pass->ghosts || !grid->cells[b].ghost;
}

/* Work of one thread on its part of the blocks of cells. Entries of the queue: b is the scatter of
 * block of cells b, cells + b its gather, and 2 cells + g the update of block of nodes g where
 * there is no scatter, else its finish after `between`. */
typedef struct mpsi_lane {
  _Atomic int32_t *queue;     /* those ready from the start, then others; EMPTY: not ready yet */
  int64_t starts, entries;    /* number of those ready from the start; of all */
  _Atomic int64_t begun;      /* number of the former that are claimed, or more */
  _Atomic int64_t head, tail; /* of the others: next to claim, next to write */
  char apart[2 * 64];         /* keeps the next lane in other cache lines */
} lane;

/* Length of the lanes in the memory of a pass; counters of blocks and queues follow. */
static int64_t lane_counters(const mpsi_grid *grid) {
  return grid->worker_count * (int64_t)(sizeof(lane) / sizeof(_Atomic int32_t));
}

static _Atomic int32_t *counters_of(const mpsi_grid *grid) {
  return (_Atomic int32_t *)grid->pass_room.item + lane_counters(grid);
}

/* ---- one thread ------------------------------------------------------------------------------ */

static bool is_first(const mpsi_cell_block *cells, int q) { return cells->first >> q & 1; }

static void clear_and_scatter(const mpsi_grid *grid, const mpsi_pass *pass, int64_t b,
                              int32_t worker) {
  const mpsi_cell_block *cells = &grid->cells[b];
  for (int q = 0; q < 1 << grid->dim; q++)
    if (is_first(cells, q)) pass->clear(pass->data, cells->to[q], worker);
  pass->scatter(pass->data, b, worker);
}

/* A pass by one thread, with the stages completed so far. */
typedef struct wave {
  const mpsi_grid *grid;
  const mpsi_pass *pass;
  _Atomic int32_t *scattered,
      *done; /* by block of cells: 1 after its scatter; by block of nodes: UPDATED or FINISHED */
} wave;
enum { UPDATED = 1, FINISHED = 2 };

/* Advances a block to `stage`; false if it has reached it before. */
static bool advance(_Atomic int32_t *done, int32_t stage) {
  const bool before = atomic_load_explicit(done, memory_order_relaxed) < stage;
  if (before) atomic_store_explicit(done, stage, memory_order_relaxed);
  return before;
}

/* Block of cells that adds to the block of nodes g just before the one at its corner q, or -1. */
static int32_t added_before(const mpsi_grid *grid, int32_t g, int q) {
  const mpsi_node_block *nodes = &grid->nodes[g];
  const int parity = parity_of(nodes);
  for (int colour = (q ^ parity) - 1; colour >= 0; colour--)
    if (nodes->from[colour ^ parity] >= 0) return nodes->from[colour ^ parity];
  return -1;
}

/* Scatters block b, after the blocks that must precede it. The depth of the recursion is at most
 * the number of colours. */
static void scatter_in_turn(wave *w, int32_t b) {
  const mpsi_cell_block *cells = &w->grid->cells[b];
  if (!advance(&w->scattered[b], 1)) return;
  for (int q = 0; q < 1 << w->grid->dim; q++) {
    const int32_t before = added_before(w->grid, cells->to[q], q);
    if (before >= 0) scatter_in_turn(w, before);
  }
  clear_and_scatter(w->grid, w->pass, b, 0);
}

static void update_in_turn(wave *w, int32_t g) {
  const mpsi_node_block *nodes = &w->grid->nodes[g];
  if (!advance(&w->done[g], UPDATED)) return;
  for (int q = 0; q < 1 << w->grid->dim && w->pass->scatter; q++)
    if (nodes->from[q] >= 0) scatter_in_turn(w, nodes->from[q]);
  if (w->pass->update) w->pass->update(w->pass->data, g, 0);
}

static void finish_in_turn(wave *w, int32_t g) {
  update_in_turn(w, g);
  if (advance(&w->done[g], FINISHED) && w->pass->finish) w->pass->finish(w->pass->data, g, 0);
}

/* Whether some node under the block waits for ghosts (partition.h). */
static bool is_late(const mpsi_grid *grid, const mpsi_cell_block *cells) {
  bool late = false;
  for (int q = 0; q < 1 << grid->dim; q++) late = late || grid->nodes[cells->to[q]].late;
  return late;
}

/* Gathers the blocks that wait for ghosts (`late`), or the others, after finishing their nodes;
 * returns whether it has left out some. */
static bool gather_in_turn(wave *w, bool late) {
  const mpsi_grid *grid = w->grid;
  bool left_out = false;
  for (int64_t b = 0; b < grid->cell_count; b++) {
    const mpsi_cell_block *cells = &grid->cells[b];
    if (!has_cells(grid, w->pass, b)) continue;
    if (is_late(grid, cells) != late) {
      left_out = true;
      continue;
    }
    for (int q = 0; q < 1 << grid->dim; q++) finish_in_turn(w, cells->to[q]);
    if (w->pass->gather) w->pass->gather(w->pass->data, b, 0);
  }
  return left_out;
}

/* A pass by one thread. Each block gathers as soon as its nodes are finished, while its particles
 * are in the cache from the scatter: a large set would be read from memory twice otherwise. Blocks
 * that wait for ghosts are last, but scatter while the ghosts' message is on its way. */
static void run_wave(const mpsi_grid *grid, const mpsi_pass *pass) {
  _Atomic int32_t *counters = counters_of(grid);
  wave w = {grid, pass, counters, counters + grid->cell_count};
  for (int64_t k = 0; k < grid->cell_count + grid->node_count; k++)
    atomic_store_explicit(&counters[k], 0, memory_order_relaxed);
  for (int32_t g = 0; pass->between && g < grid->node_count; g++)
    if (grid->nodes[g].waits) update_in_turn(&w, g);
  if (pass->between && !pass->between(pass->step)) return;
  if (!gather_in_turn(&w, false) && !awaits(pass)) return;
  for (int32_t b = 0; pass->scatter && b < grid->cell_count; b++)
    if (!grid->cells[b].late) scatter_in_turn(&w, b);
  if (awaits(pass)) pass->arrive(pass->ranks);
  gather_in_turn(&w, true);
}

/* ---- several threads ------------------------------------------------------------------------- */

typedef struct flow {
  mps_context *context;
  const mpsi_grid *grid;
  const mpsi_pass *pass;
  int32_t cells, nodes, lanes;
  lane *lane;
  _Atomic int32_t *scatter_waits,
      *gather_waits;    /* of each block of cells: number of blocks of nodes that it waits for */
  _Atomic int32_t held; /* blocks of nodes to update before `between` */
  _Atomic bool arrived; /* the sums of ghosts are received, or none are expected */
} flow;
enum { EMPTY = -1 };

static lane *lane_of_cells(const flow *f, int32_t b) {
  return &f->lane[(int64_t)b * f->lanes / f->cells];
}

/* Lane of the first block of cells that covers the nodes. */
static lane *lane_of_nodes(const flow *f, int32_t g) {
  const mpsi_node_block *nodes = &f->grid->nodes[g];
  int q = 0;
  while (nodes->from[q] < 0) q++;
  return lane_of_cells(f, nodes->from[q]);
}

/* Enqueues an entry in its lane. */
static void put(lane *l, int32_t entry) {
  const int64_t at = atomic_fetch_add_explicit(&l->tail, 1, memory_order_relaxed);
  atomic_store_explicit(&l->queue[at], entry, memory_order_release);
}

/* Decrements a counter; returns whether it was the last time. The work of all threads that have
 * decremented it is then visible. */
static bool count_down(_Atomic int32_t *count) {
  return atomic_fetch_sub_explicit(count, 1, memory_order_acq_rel) == 1;
}

static void finish_nodes(flow *f, int32_t g, int32_t worker) {
  const mpsi_node_block *nodes = &f->grid->nodes[g];
  if (f->pass->finish && has_nodes(f->grid, f->pass, g)) f->pass->finish(f->pass->data, g, worker);
  for (int q = 0; q < 1 << f->grid->dim; q++) {
    const int32_t b = nodes->from[q];
    if (b >= 0 && count_down(&f->gather_waits[b]) && f->pass->gather &&
        has_cells(f->grid, f->pass, b))
      put(lane_of_cells(f, b), f->cells + b);
  }
}

static void update_nodes(flow *f, int32_t g, int32_t worker) {
  if (f->pass->update && has_nodes(f->grid, f->pass, g)) f->pass->update(f->pass->data, g, worker);
  if (!f->pass->between || !f->grid->nodes[g].waits) {
    finish_nodes(f, g, worker);
    return;
  }
  if (!count_down(&f->held)) return;
  f->pass->between(f->pass->step);
  for (int32_t k = 0; k < f->nodes; k++)
    if (f->grid->nodes[k].waits) put(lane_of_nodes(f, k), 2 * f->cells + k);
}

static void scatter_cells(flow *f, int32_t b, int32_t worker) {
  const mpsi_cell_block *cells = &f->grid->cells[b];
  clear_and_scatter(f->grid, f->pass, b, worker);
  for (int q = 0; q < 1 << f->grid->dim; q++) {
    const int32_t next = cells->next[q];
    if (next < 0)
      update_nodes(f, cells->to[q], worker);
    else if (count_down(&f->scatter_waits[next]))
      put(lane_of_cells(f, next), next);
  }
}

static void work_on(flow *f, int32_t entry, int32_t worker) {
  if (entry < f->cells)
    scatter_cells(f, entry, worker);
  else if (entry < 2 * f->cells)
    f->pass->gather(f->pass->data, entry - f->cells, worker);
  else if (f->pass->scatter)
    finish_nodes(f, entry - 2 * f->cells, worker);
  else
    update_nodes(f, entry - 2 * f->cells, worker);
}

/* Number of entries to claim of `waiting` ones: few, so that the last ones are divided among the
 * threads. */
static int64_t portion(const flow *f, int64_t waiting) {
  const int64_t most = waiting / (2 * f->lanes);
  return most < 1 ? 1 : most > MOST_CLAIMED ? MOST_CLAIMED : most;
}

/* Claims consecutive entries that became ready; returns their number. */
static int32_t claim_next(const flow *f, lane *l, int32_t *entry) {
  int64_t head = atomic_load_explicit(&l->head, memory_order_relaxed);
  for (;;) {
    const int64_t most = portion(f, atomic_load_explicit(&l->tail, memory_order_relaxed) - head);
    int32_t n = 0;
    for (; n < most && head + n < l->entries; n++) {
      entry[n] = atomic_load_explicit(&l->queue[head + n], memory_order_acquire);
      if (entry[n] == EMPTY) break;
    }
    if (n == 0) return 0;
    if (atomic_compare_exchange_weak_explicit(&l->head, &head, head + n, memory_order_relaxed,
                                              memory_order_relaxed))
      return n;
  }
}

/* Claims entries that were ready from the start; returns their number. */
static int32_t claim_start(const flow *f, lane *l, int32_t *entry) {
  const int64_t left = l->starts - atomic_load_explicit(&l->begun, memory_order_relaxed);
  if (left <= 0) return 0;
  const int64_t most = portion(f, left);
  const int64_t at = atomic_fetch_add_explicit(&l->begun, most, memory_order_relaxed);
  int32_t n = 0;
  for (; n < most && at + n < l->starts; n++)
    entry[n] = atomic_load_explicit(&l->queue[at + n], memory_order_relaxed);
  return n;
}

static int32_t claim_of(const flow *f, lane *l, int32_t *entry) {
  const int32_t n = claim_next(f, l, entry);
  return n > 0 ? n : claim_start(f, l, entry);
}

static bool is_claimed(const lane *l) {
  return atomic_load_explicit(&l->head, memory_order_relaxed) == l->entries &&
         atomic_load_explicit(&l->begun, memory_order_relaxed) >= l->starts;
}

static bool is_all_claimed(const flow *f) {
  bool all = true;
  for (int32_t k = 0; k < f->lanes && all; k++) all = is_claimed(&f->lane[k]);
  return all;
}

/* Claims entries of the thread's own lane; of other lanes when that has no more, or waits for
 * long. */
static int32_t claim(const flow *f, int32_t worker, int32_t look, int32_t *entry) {
  lane *own = &f->lane[worker];
  int32_t n = claim_of(f, own, entry);
  if (n > 0 || (look < PATIENCE && !is_claimed(own))) return n;
  for (int32_t k = 1; k < f->lanes && n == 0; k++)
    n = claim_of(f, &f->lane[(worker + k) % f->lanes], entry);
  return n;
}

/* Receives the sums of ghosts, on the caller's thread; their blocks are then ready to scatter. */
static void receive(flow *f) {
  f->pass->arrive(f->pass->ranks);
  for (int32_t b = 0; b < f->cells; b++)
    if (f->grid->cells[b].ghost && count_down(&f->scatter_waits[b])) put(lane_of_cells(f, b), b);
  atomic_store_explicit(&f->arrived, true, memory_order_release);
}

/* Work of one thread until all entries are claimed. Worker 0 of the context's own executors is the
 * caller's thread. */
static void run_worker(void *data, int64_t unit, int32_t worker) {
  flow *f = data;
  const bool own = mpsi_executor_is_own(f->context), receives = own && worker == 0;
  for (int32_t look = 0; !is_all_claimed(f); look++) {
    int32_t entry[MOST_CLAIMED];
    /* under a caller's executor the thread of another lane may never come: no patience */
    const int32_t n = claim(f, worker, own ? look : PATIENCE, entry);
    for (int32_t k = 0; k < n; k++) work_on(f, entry[k], worker);
    const bool waits = n == 0 && !atomic_load_explicit(&f->arrived, memory_order_relaxed);
    if (waits && receives) receive(f);
    if (n > 0 || (waits && receives))
      look = -1;
    else if (!mpsi_wait_a_little(look, own))
      return;
  }
}

/* Divides the memory of the queue among the lanes, by the number of entries of each. */
static void make_lanes(flow *f, _Atomic int32_t *queue) {
  const mpsi_grid *grid = f->grid;
  for (int32_t k = 0; k < f->lanes; k++) f->lane[k] = (lane){.entries = 0};
  for (int32_t b = 0; b < f->cells; b++)
    lane_of_cells(f, b)->entries +=
        (f->pass->scatter ? 1 : 0) + (f->pass->gather && has_cells(grid, f->pass, b) ? 1 : 0);
  for (int32_t g = 0; g < f->nodes && (f->pass->between || !f->pass->scatter); g++)
    lane_of_nodes(f, g)->entries +=
        (f->pass->scatter ? 0 : 1) + (f->pass->between && grid->nodes[g].waits ? 1 : 0);
  for (int32_t k = 0; k < f->lanes; k++) {
    f->lane[k].queue = queue;
    for (int64_t i = 0; i < f->lane[k].entries; i++)
      atomic_store_explicit(queue++, EMPTY, memory_order_relaxed);
  }
}

/* Sets the counters of dependencies and enqueues what is ready from the start. */
static void fill(flow *f) {
  const mpsi_grid *grid = f->grid;
  int32_t held = 0;
  for (int32_t b = 0; b < f->cells; b++) {
    const int32_t message = awaits(f->pass) && grid->cells[b].ghost;
    atomic_store_explicit(&f->scatter_waits[b], grid->cells[b].waits + message,
                          memory_order_relaxed);
    atomic_store_explicit(&f->gather_waits[b], 1 << grid->dim, memory_order_relaxed);
  }
  for (int32_t g = 0; f->pass->between && g < f->nodes; g++) held += grid->nodes[g].waits;
  atomic_init(&f->held, held);
  for (int32_t k = 0; f->pass->scatter && k < f->cells; k++) {
    const int32_t b = grid->coloured[k];
    if (atomic_load_explicit(&f->scatter_waits[b], memory_order_relaxed) == 0)
      put(lane_of_cells(f, b), b);
  }
  atomic_init(&f->arrived, !awaits(f->pass));
  for (int32_t g = 0; !f->pass->scatter && g < f->nodes; g++)
    put(lane_of_nodes(f, g), 2 * f->cells + g);
  for (int32_t k = 0; k < f->lanes; k++) {
    f->lane[k].starts = atomic_load_explicit(&f->lane[k].tail, memory_order_relaxed);
    atomic_store_explicit(&f->lane[k].head, f->lane[k].starts, memory_order_relaxed);
  }
}

bool mpsi_mpm_passes_alone(const mpsi_grid *grid, const mpsi_columns *p) {
  return grid->worker_count == 1 || p->count < SMALL_SET;
}

void mpsi_mpm_run_pass(mps_context *context, const mpsi_grid *grid, const mpsi_columns *p,
                       const mpsi_pass *pass) {
  if (mpsi_mpm_passes_alone(grid, p)) {
    run_wave(grid, pass);
    return;
  }
  _Atomic int32_t *counters = counters_of(grid);
  flow f = {.context = context,
            .grid = grid,
            .pass = pass,
            .cells = (int32_t)grid->cell_count,
            .nodes = (int32_t)grid->node_count,
            .lanes = grid->worker_count,
            .lane = grid->pass_room.item,
            .scatter_waits = counters,
            .gather_waits = counters + grid->cell_count};
  const int64_t rounds = mpsi_executor_is_own(context) ? 1 : ROUNDS;
  make_lanes(&f, counters + 2 * grid->cell_count);
  fill(&f);
  mpsi_parallel_for(context, rounds * grid->worker_count, run_worker, &f);
  if (atomic_load_explicit(&f.arrived, memory_order_relaxed)) return;
  receive(&f); /* the caller's executor has done all that needs no ghosts */
  mpsi_parallel_for(context, rounds * grid->worker_count, run_worker, &f);
}

bool mpsi_mpm_ensure_pass(mps_context *context, mpsi_grid *grid) {
  const int64_t entries = 4 * grid->cell_count + grid->node_count;
  return mpsi_room_ensure(context, &grid->pass_room, lane_counters(grid) + entries,
                          sizeof(_Atomic int32_t));
}

/* ---- blocks ---------------------------------------------------------------------------------- */

/* The tile of the block of cells at corner q begins q blocks below the block of nodes, so that
 * their parities, and the colour of the cells, follow from those of the nodes. */
void mpsi_mpm_link_blocks(const mpsi_grid *grid) {
  mpsi_cell_block *cells = grid->cells;
  for (int64_t g = 0; g < grid->node_count; g++) {
    const mpsi_node_block *nodes = &grid->nodes[g];
    const int parity = parity_of(nodes);
    int32_t last = -1;
    int last_q = 0;
    for (int colour = 0; colour < 1 << grid->dim; colour++) {
      const int q = colour ^ parity;
      const int32_t b = nodes->from[q];
      if (b < 0) continue;
      cells[b].next[q] = -1;
      if (last < 0)
        cells[b].first |= (uint8_t)(1u << q);
      else
        cells[last].next[last_q] = b, cells[b].waits++;
      last = b, last_q = q;
    }
  }
}

/* ---- loops over blocks of cells -------------------------------------------------------------- */

typedef struct cell_loop {
  const mpsi_grid *grid;
  mpsi_mpm_task task;
  void *data;
  int64_t grain;
} cell_loop;

static void some_cells(void *data, int64_t unit, int32_t worker) {
  const cell_loop *w = data;
  const int64_t end = (unit + 1) * w->grain;
  for (int64_t b = unit * w->grain; b < end && b < w->grid->cell_count; b++)
    w->task(w->data, b, worker);
}

void mpsi_mpm_for_cells(mps_context *context, const mpsi_grid *grid, const mpsi_columns *p,
                        mpsi_mpm_task task, void *data) {
  const int64_t most = p->count < SMALL_SET ? 1 : 8 * (int64_t)grid->worker_count;
  const int64_t count = grid->cell_count, units = count < most ? count : most;
  if (units == 0) return;
  cell_loop w = {grid, task, data, (count + units - 1) / units};
  mpsi_parallel_for(context, units, some_cells, &w);
}
