/* mesh.c - arranges the pairs of a body into blocks of runs and scattered pairs (see mesh.h).
 * SPDX-License-Identifier: BSD-3-Clause */
#include "batch.h"

#include <stdlib.h>
#include <string.h>

#define SHORTEST_RUN 8 /* shorter ones cost more as a run than as scattered pairs */

/* A pair as one block sees it. */
typedef struct entry {
  mpsi_dynamics_pair pair; /* ti or tj is -1 where another block owns that end */
  int32_t run;             /* length of the run that starts here; 0: scattered; -1: inside a run */
} entry;

/* Arranged pairs of one batch: blocks `begin` to `end` - 1. Runs and scattered pairs have numbers
 * from `run_first` and `scattered_first` on. */
typedef struct batch {
  int64_t begin, end;
  int64_t run_first, runs, scattered_first;
  mpsi_dynamics_pair_run *run;
  mpsi_dynamics_scattered scattered;
} batch;

/* One batch under way. */
typedef struct arrange {
  mps_context *context;
  mpsi_dynamics_mesh *mesh;
  const mpsi_dynamics_mesh_def *def;
  batch *batch;
  mpsi_dynamics_pair *pair;
  int64_t pairs;
  entry *entry;
  int64_t *first; /* first entry of each of the batch's blocks, one more */
  int64_t *next;
} arrange;

/* Which block of this rank has a particle; -1: none. */
static int64_t slot_of(const arrange *work, int32_t particle) {
  if (particle < 0) return -1;
  const int64_t block = mpsi_dynamics_block_of(work->def->body, particle);
  return work->def->cut ? work->def->cut->slot[block] : block;
}

static int32_t local(const arrange *work, int32_t particle) {
  return work->def->cut && particle >= 0 ? work->def->cut->local[particle] : particle;
}

static int compare(const void *left, const void *right) {
  const mpsi_dynamics_pair *a = &((const entry *)left)->pair, *b = &((const entry *)right)->pair;
  if (a->r0y != b->r0y) return a->r0y < b->r0y ? -1 : 1;
  if (a->r0x != b->r0x) return a->r0x < b->r0x ? -1 : 1;
  if (a->i != b->i) return a->i < b->i ? -1 : 1;
  if (a->j != b->j) return a->j < b->j ? -1 : 1;
  if (a->ti != b->ti) return a->ti < b->ti ? -1 : 1;
  return a->tj < b->tj ? -1 : a->tj > b->tj;
}

/* An ordinary pair acts on the particles whose state it reads. */
static bool ordinary(const mpsi_dynamics_pair *p) {
  return (p->ti == p->i || p->ti < 0) && (p->tj == p->j || p->tj < 0);
}

static bool continues(const mpsi_dynamics_pair *a, const mpsi_dynamics_pair *b) {
  return b->i == a->i + 1 && b->j == a->j + 1 && b->r0x == a->r0x && b->r0y == a->r0y &&
         (b->ti < 0) == (a->ti < 0) && (b->tj < 0) == (a->tj < 0) && ordinary(b);
}

/* ---- pairs of a block on this rank; of a ghost block, those that act on needed particles ----- */

static bool is_ghost(const arrange *work, int64_t b) {
  return work->def->cut && b >= work->def->cut->blocks;
}

/* Whether the pair that comes `t`-th in a run from `p` on is needed. */
static bool needed(const arrange *work, int64_t b, const mpsi_dynamics_pair *p, int32_t t) {
  if (!is_ghost(work, b)) return true;
  const uint8_t *wanted = work->def->cut->wanted;
  return (p->ti >= 0 && wanted[p->ti + t]) || (p->tj >= 0 && wanted[p->tj + t]);
}

/* The next piece of a run, from *begin on, that is needed and lies in one piece here; false: none.
 */
static bool next_piece(const arrange *work, int64_t b, const entry *e, int32_t *begin,
                       int32_t *end) {
  const mpsi_dynamics_pair *p = &e->pair;
  while (*begin < e->run && !needed(work, b, p, *begin)) (*begin)++;
  if (*begin >= e->run) return false;
  if (!work->def->cut) {
    *end = e->run;
    return true;
  }
  const int32_t first_i = local(work, p->i + *begin), first_j = local(work, p->j + *begin);
  for (*end = *begin + 1; *end < e->run; (*end)++) {
    const int32_t t = *end;
    if (!needed(work, b, p, t)) break;
    if (local(work, p->i + t) != first_i + t - *begin) break;
    if (local(work, p->j + t) != first_j + t - *begin) break;
  }
  return true;
}

/* Counts the runs and scattered pairs of a block, and in `slot` the pairs of both. */
static void count_block(const arrange *work, int64_t b) {
  mpsi_dynamics_block *block = &work->mesh->block[b];
  const int64_t *first = &work->first[b - work->batch->begin];
  for (int64_t k = first[0]; k < first[1]; k++) {
    const entry *e = &work->entry[k];
    if (e->run == 0) block->scattered_end += needed(work, b, &e->pair, 0);
    for (int32_t begin = 0, end; e->run > 0 && next_piece(work, b, e, &begin, &end); begin = end)
      block->run_end++, block->slot += end - begin;
  }
  block->slot += block->scattered_end;
}

/* ---- arranging ------------------------------------------------------------------------------- */

/* Sorts the entries of one block and marks its runs. */
static void arrange_block(void *data, int64_t number, int32_t worker) {
  arrange *work = data;
  entry *e = work->entry + work->first[number];
  const int64_t n = work->first[number + 1] - work->first[number];
  qsort(e, (size_t)n, sizeof *e, compare);
  for (int64_t k = 0, next; k < n; k = next) {
    for (next = k + 1;
         next < n && ordinary(&e[k].pair) && continues(&e[next - 1].pair, &e[next].pair);)
      e[next++].run = -1;
    e[k].run = (int32_t)(next - k);
    if (next - k < SHORTEST_RUN)
      for (int64_t s = k; s < next; s++) e[s].run = 0;
  }
  count_block(work, work->batch->begin + number);
}

static void coefficients(const mpsi_dynamics_mesh_def *def, double r0x, double r0y, double *kf,
                         double *kc) {
  const double d = 2.0, r0 = sqrt(r0x * r0x + r0y * r0y), w = mps_kernel_weight(def->kernel, r0);
  *kf = 0.5 * (4.0 * d / def->density) * w / (r0 * r0);
  *kc = (d / def->density) * w / r0;
}

/* Copies the marked entries of one block into the run and scattered lists. */
static void write_block(void *data, int64_t number, int32_t worker) {
  arrange *work = data;
  batch *out = work->batch;
  mpsi_dynamics_scattered *list = &out->scattered;
  const int64_t b = out->begin + number;
  const mpsi_dynamics_block *block = &work->mesh->block[b];
  int64_t r = block->run_begin - out->run_first, s = block->scattered_begin - out->scattered_first;
  for (int64_t k = work->first[number]; k < work->first[number + 1]; k++) {
    const entry *e = &work->entry[k];
    const mpsi_dynamics_pair *p = &e->pair;
    double kf, kc;
    if (e->run < 0) continue;
    coefficients(work->def, p->r0x, p->r0y, &kf, &kc);
    for (int32_t begin = 0, end; e->run > 0 && next_piece(work, b, e, &begin, &end); begin = end)
      out->run[r++] = (mpsi_dynamics_pair_run){.i0 = local(work, p->i + begin),
                                               .j0 = local(work, p->j + begin),
                                               .count = end - begin,
                                               .own_i = p->ti >= 0,
                                               .own_j = p->tj >= 0,
                                               .r0x = p->r0x,
                                               .r0y = p->r0y,
                                               .kf = kf,
                                               .kc = kc};
    if (e->run > 0 || !needed(work, b, p, 0)) continue;
    list->i[s] = local(work, p->i);
    list->j[s] = local(work, p->j);
    list->ti[s] = local(work, p->ti);
    list->tj[s] = local(work, p->tj);
    list->r0x[s] = p->r0x;
    list->r0y[s] = p->r0y;
    list->kf[s] = kf;
    list->kc[s++] = kc;
  }
}

/* Assigns each pair to the one or two blocks of the batch that own its ends. Without entries only
 * counts. */
static void deal(const arrange *work) {
  const batch *part = work->batch;
  for (int64_t k = 0; k < work->pairs; k++) {
    const mpsi_dynamics_pair *p = &work->pair[k];
    const int64_t b[2] = {slot_of(work, p->ti), slot_of(work, p->tj)};
    for (int e = 0; e < 2; e++) {
      if (b[e] < part->begin || b[e] >= part->end || (e == 1 && b[1] == b[0])) continue;
      const int64_t at = work->next[b[e] - part->begin]++;
      if (!work->entry) continue;
      work->entry[at].pair = *p;
      if (b[0] != b[1]) *(e == 0 ? &work->entry[at].pair.tj : &work->entry[at].pair.ti) = -1;
    }
  }
}

static bool alloc_scattered(mps_context *context, mpsi_dynamics_scattered *list, int64_t count) {
  list->count = count;
  int32_t **index[4] = {&list->i, &list->j, &list->ti, &list->tj};
  double **value[4] = {&list->r0x, &list->r0y, &list->kf, &list->kc};
  bool ok = true;
  for (int k = 0; k < 4; k++) {
    ok = (*index[k] = mpsi_alloc(context, count, sizeof(int32_t))) && ok;
    ok = (*value[k] = mpsi_alloc(context, count, sizeof(double))) && ok;
  }
  return ok;
}

/* Particles of a block: all of the body's blocks are full but the last, then come the columns'. */
static void place_block(const mpsi_dynamics_mesh_def *def, int64_t b, mpsi_dynamics_block *block) {
  if (def->cut) {
    block->begin = def->cut->begin[b];
    block->end = def->cut->end[b];
    return;
  }
  const int64_t body_blocks = mpsi_dynamics_block_of(def->body, def->body);
  const int64_t first = b < body_blocks ? 0 : def->body, last = first ? def->particles : def->body;
  const int64_t begin = first + (b - (first ? body_blocks : 0)) * MPSI_DYN_BLOCK;
  block->begin = (int32_t)begin;
  block->end = (int32_t)(begin + MPSI_DYN_BLOCK < last ? begin + MPSI_DYN_BLOCK : last);
}

/* Turns the counts left in run_end, scattered_end and slot into ranges. */
static void number_blocks(const arrange *work) {
  mpsi_dynamics_mesh *mesh = work->mesh;
  batch *part = work->batch;
  part->run_first = mesh->runs, part->scattered_first = mesh->scattered.count;
  for (int64_t b = part->begin; b < part->end; b++) {
    mpsi_dynamics_block *block = &mesh->block[b];
    const int64_t slots = block->slot;
    place_block(work->def, b, block);
    block->slot = mesh->slots;
    block->run_begin = mesh->runs;
    block->scattered_begin = mesh->scattered.count;
    block->run_end = mesh->runs += block->run_end;
    block->scattered_end = mesh->scattered.count += block->scattered_end;
    mesh->slots += slots;
  }
  part->runs = mesh->runs - part->run_first;
}

/* Whether a block reads particles of other ranks, whose numbers start at `own`. */
static bool looks_out(const mpsi_dynamics_mesh *mesh, const mpsi_dynamics_block *block,
                      int64_t own) {
  for (int64_t r = block->run_begin; r < block->run_end; r++)
    if (mesh->run[r].i0 >= own || mesh->run[r].j0 >= own) return true;
  for (int64_t k = block->scattered_begin; k < block->scattered_end; k++)
    if (mesh->scattered.i[k] >= own || mesh->scattered.j[k] >= own) return true;
  return false;
}

/* Blocks without data of other ranks come first. */
static bool take_turns(mps_context *context, const mpsi_dynamics_cut *cut,
                       mpsi_dynamics_mesh *mesh) {
  const int64_t all = mesh->blocks + mesh->ghosts;
  mesh->interior = mesh->blocks;
  if (!cut) return true;
  if (!(mesh->turn = mpsi_alloc(context, all, sizeof *mesh->turn))) return false;
  int64_t taken = 0;
  for (int pass = 0; pass < 2; pass++) {
    for (int64_t b = 0; b < all; b++) {
      const bool outer = b >= mesh->blocks || looks_out(mesh, &mesh->block[b], cut->count);
      if (outer == (pass == 1)) mesh->turn[taken++] = (int32_t)b;
    }
    if (pass == 0) mesh->interior = taken;
  }
  return true;
}

/* ---- batches --------------------------------------------------------------------------------- */

static mps_status find_pairs(arrange *work, mpsi_dynamics_source *source, int64_t *own,
                             bool *lattice) {
  const batch *part = work->batch;
  const int64_t blocks = part->end - part->begin;
  int64_t distinct = 0;
  int32_t *block = mpsi_alloc(work->context, blocks, sizeof *block);
  if (!block) return mpsi_fail_memory(work->context, source->function, (size_t)blocks * 4);
  for (int64_t k = 0; k < blocks; k++)
    block[k] = work->def->cut ? work->def->cut->block[part->begin + k] : (int32_t)(part->begin + k);
  const mps_status status =
      mpsi_dynamics_source_pairs(source, blocks, block, &work->pairs, &work->pair, &distinct);
  mpsi_free(work->context, block);
  if (status != MPS_OK) return status;
  *lattice = *lattice && mpsi_dynamics_on_lattice(source->g.spacing, work->pairs, work->pair);
  for (int64_t k = 0; k < distinct; k++) {
    const int64_t b = slot_of(work, work->pair[k].i);
    *own += b >= part->begin && b < part->end && b < work->mesh->blocks;
  }
  return MPS_OK;
}

/* False: out of memory. */
static bool arrange_batch(arrange *work) {
  batch *part = work->batch;
  const int64_t blocks = part->end - part->begin;
  work->first = mpsi_alloc(work->context, blocks + 1, sizeof *work->first);
  work->next = mpsi_alloc(work->context, blocks + 1, sizeof *work->next);
  if (!work->first || !work->next) return false;
  deal(work);
  for (int64_t b = 0; b < blocks; b++) {
    work->first[b + 1] = work->first[b] + work->next[b];
    work->next[b] = work->first[b];
  }
  work->entry = mpsi_alloc(work->context, work->first[blocks], sizeof *work->entry);
  if (!work->entry) return false;
  deal(work);
  mpsi_free(work->context, work->pair);
  work->pair = NULL;
  mpsi_parallel_for(work->context, blocks, arrange_block, work);
  number_blocks(work);
  part->run = mpsi_alloc(work->context, part->runs, sizeof *part->run);
  if (!part->run || !alloc_scattered(work->context, &part->scattered,
                                     work->mesh->scattered.count - part->scattered_first))
    return false;
  mpsi_parallel_for(work->context, blocks, write_block, work);
  return true;
}

static void free_work(arrange *work) {
  MPSI_FREE(work->context, work->pair, work->entry, work->first, work->next);
  work->pair = NULL, work->entry = NULL, work->first = work->next = NULL;
}

static void free_batch(mps_context *context, batch *part) {
  mpsi_dynamics_scattered *list = &part->scattered;
  MPSI_FREE(context, part->run, list->i, list->j, list->ti, list->tj, list->r0x, list->r0y,
            list->kf, list->kc);
  *part = (batch){0};
}

/* Concatenates the arrays of the batches. */
static bool join(mps_context *context, mpsi_dynamics_mesh *mesh, int64_t batches, batch *part) {
  mpsi_dynamics_scattered *to = &mesh->scattered;
  mesh->run = mpsi_alloc(context, mesh->runs, sizeof *mesh->run);
  if (!mesh->run || !alloc_scattered(context, to, to->count)) return false;
  for (int64_t k = 0; k < batches; k++) {
    const mpsi_dynamics_scattered *from = &part[k].scattered;
    int32_t *const index[4] = {to->i, to->j, to->ti, to->tj};
    const int32_t *const from_index[4] = {from->i, from->j, from->ti, from->tj};
    double *const value[4] = {to->r0x, to->r0y, to->kf, to->kc};
    const double *const from_value[4] = {from->r0x, from->r0y, from->kf, from->kc};
    const size_t count = (size_t)from->count;
    memcpy(mesh->run + part[k].run_first, part[k].run, (size_t)part[k].runs * sizeof *mesh->run);
    for (int c = 0; c < 4; c++) {
      memcpy(index[c] + part[k].scattered_first, from_index[c], count * sizeof **index);
      memcpy(value[c] + part[k].scattered_first, from_value[c], count * sizeof **value);
    }
    free_batch(context, &part[k]);
  }
  return true;
}

mps_status mpsi_dynamics_mesh_build(mps_context *context, mpsi_dynamics_mesh *mesh,
                                    const mpsi_dynamics_mesh_def *def, mpsi_dynamics_source *source,
                                    int64_t *own, bool *lattice) {
  *mesh = (mpsi_dynamics_mesh){0};
  *own = 0, *lattice = true;
  mesh->blocks = def->cut ? def->cut->blocks
                          : mpsi_dynamics_block_of(def->body, def->body) +
                                (def->particles - def->body + MPSI_DYN_BLOCK - 1) / MPSI_DYN_BLOCK;
  mesh->ghosts = def->cut ? def->cut->ghosts : 0;
  const int64_t blocks = mesh->blocks + mesh->ghosts;
  const int64_t size = mpsi_dynamics_batch_size(source, blocks);
  const int64_t batches = blocks > 0 ? (blocks + size - 1) / size : 0;
  batch *part = mpsi_alloc(context, batches, sizeof *part);
  mesh->block = mpsi_alloc(context, blocks, sizeof(mpsi_dynamics_block));
  bool ok = part && mesh->block;
  mps_status status = MPS_OK;
  for (int64_t k = 0; ok && status == MPS_OK && k < batches; k++) {
    arrange work = {.context = context, .mesh = mesh, .def = def, .batch = &part[k]};
    part[k].begin = k * size;
    part[k].end = (k + 1) * size < blocks ? (k + 1) * size : blocks;
    status = find_pairs(&work, source, own, lattice);
    ok = status != MPS_OK || arrange_batch(&work);
    free_work(&work);
  }
  ok = ok && (status != MPS_OK ||
              (join(context, mesh, batches, part) && take_turns(context, def->cut, mesh)));
  for (int64_t k = 0; part && k < batches; k++) free_batch(context, &part[k]);
  mpsi_free(context, part);
  if (!ok)
    status = mpsi_fail_memory(context, source->function, (size_t)mesh->slots * sizeof(entry));
  if (status != MPS_OK) mpsi_dynamics_mesh_free(context, mesh);
  return status;
}

void mpsi_dynamics_mesh_free(mps_context *context, mpsi_dynamics_mesh *mesh) {
  mpsi_dynamics_scattered *list = &mesh->scattered;
  MPSI_FREE(context, mesh->block, mesh->run, mesh->turn, list->i, list->j, list->ti, list->tj,
            list->r0x, list->r0y, list->kf, list->kc);
  *mesh = (mpsi_dynamics_mesh){0};
}
