/* mesh.c - arranges the pairs of a body into blocks of runs and scattered pairs (see mesh.h).
 * SPDX-License-Identifier: BSD-3-Clause */
#include "mesh.h"

#include <stdlib.h>
#include <string.h>

#define SHORTEST_RUN 8 /* shorter ones cost more as a run than as scattered pairs */

/* A pair as one block sees it. */
typedef struct entry {
  mpsi_dynamics_pair pair; /* ti and tj are -1 where another block owns that side */
  int32_t run;             /* length of the run that starts here; 0: scattered; -1: inside a run */
} entry;

typedef struct arrange {
  mpsi_dynamics_mesh *mesh;
  const mpsi_dynamics_mesh_def *def;
  const mpsi_dynamics_pair *pair;
  entry *entry;
  int64_t *first; /* first entry of each block, blocks + 1 */
} arrange;

static int32_t block_of(int32_t particle) { return particle / MPSI_DYN_BLOCK; }

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

/* Sorts the entries of one block and marks its runs. */
static void arrange_block(void *data, int64_t b, int32_t worker) {
  (void)worker;
  arrange *work = data;
  entry *e = work->entry + work->first[b];
  const int64_t n = work->first[b + 1] - work->first[b];
  mpsi_dynamics_block *block = &work->mesh->block[b];
  qsort(e, (size_t)n, sizeof *e, compare);
  for (int64_t k = 0, next; k < n; k = next) {
    for (next = k + 1;
         next < n && ordinary(&e[k].pair) && continues(&e[next - 1].pair, &e[next].pair);)
      e[next++].run = -1;
    e[k].run = (int32_t)(next - k);
    if (next - k < SHORTEST_RUN)
      for (int64_t s = k; s < next; s++) e[s].run = 0;
    if (e[k].run > 0)
      block->run_end++;
    else
      block->scattered_end += next - k;
  }
}

static void coefficients(const mpsi_dynamics_mesh_def *def, double r0x, double r0y, double *kf,
                         double *kc) {
  const double d = 2.0, r0 = sqrt(r0x * r0x + r0y * r0y), w = mps_kernel_weight(def->kernel, r0);
  *kf = 0.5 * (4.0 * d / def->density) * w / (r0 * r0);
  *kc = (d / def->density) * w / r0;
}

/* Copies the marked entries of one block into the run and scattered lists. */
static void write_block(void *data, int64_t b, int32_t worker) {
  (void)worker;
  arrange *work = data;
  mpsi_dynamics_mesh *mesh = work->mesh;
  int64_t r = mesh->block[b].run_begin, s = mesh->block[b].scattered_begin;
  for (int64_t k = work->first[b]; k < work->first[b + 1]; k++) {
    const entry *e = &work->entry[k];
    double kf, kc;
    if (e->run < 0) continue;
    coefficients(work->def, e->pair.r0x, e->pair.r0y, &kf, &kc);
    if (e->run > 0) {
      mesh->run[r++] = (mpsi_dynamics_pair_run){.i0 = e->pair.i,
                                                .j0 = e->pair.j,
                                                .count = e->run,
                                                .own_i = e->pair.ti >= 0,
                                                .own_j = e->pair.tj >= 0,
                                                .r0x = e->pair.r0x,
                                                .r0y = e->pair.r0y,
                                                .kf = kf,
                                                .kc = kc};
    } else {
      mpsi_dynamics_scattered *list = &mesh->scattered;
      list->i[s] = e->pair.i;
      list->j[s] = e->pair.j;
      list->ti[s] = e->pair.ti;
      list->tj[s] = e->pair.tj;
      list->r0x[s] = e->pair.r0x;
      list->r0y[s] = e->pair.r0y;
      list->kf[s] = kf;
      list->kc[s++] = kc;
    }
  }
}

/* Hands each pair to the one or two blocks that own its ends. With entry NULL only counts. */
static void deal(const arrange *work, int64_t count, entry *entries, int64_t *next) {
  for (int64_t k = 0; k < count; k++) {
    const mpsi_dynamics_pair *p = &work->pair[k];
    const int32_t bi = p->ti < 0 ? -1 : block_of(p->ti), bj = p->tj < 0 ? -1 : block_of(p->tj);
    if (bi >= 0) {
      const int64_t at = next[bi]++;
      if (entries) {
        entries[at].pair = *p;
        if (bj != bi) entries[at].pair.tj = -1;
      }
    }
    if (bj >= 0 && bj != bi) {
      const int64_t at = next[bj]++;
      if (entries) {
        entries[at].pair = *p;
        entries[at].pair.ti = -1;
      }
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

/* Turns the counts left in run_end and scattered_end into ranges. */
static void number_blocks(mpsi_dynamics_mesh *mesh, const int64_t *first) {
  int64_t runs = 0, scattered = 0;
  for (int64_t b = 0; b < mesh->blocks; b++) {
    mpsi_dynamics_block *block = &mesh->block[b];
    const int64_t end = (b + 1) * MPSI_DYN_BLOCK;
    block->begin = (int32_t)(b * MPSI_DYN_BLOCK);
    block->end = (int32_t)(end < mesh->particles ? end : mesh->particles);
    block->slot = first[b];
    block->run_begin = runs;
    block->scattered_begin = scattered;
    block->run_end = runs += block->run_end;
    block->scattered_end = scattered += block->scattered_end;
  }
  mesh->runs = runs;
  mesh->scattered.count = scattered;
}

bool mpsi_dynamics_mesh_build(mps_context *context, mpsi_dynamics_mesh *mesh,
                              const mpsi_dynamics_mesh_def *def, int64_t particles, int64_t count,
                              mpsi_dynamics_pair *pair) {
  *mesh = (mpsi_dynamics_mesh){.particles = particles};
  mesh->blocks = (particles + MPSI_DYN_BLOCK - 1) / MPSI_DYN_BLOCK;
  arrange work = {.mesh = mesh, .def = def, .pair = pair};
  work.first = mpsi_alloc(context, mesh->blocks + 1, sizeof(int64_t));
  int64_t *next = mpsi_alloc(context, mesh->blocks + 1, sizeof(int64_t));
  mesh->block = mpsi_alloc(context, mesh->blocks, sizeof(mpsi_dynamics_block));
  bool ok = work.first && next && mesh->block;
  if (ok) {
    deal(&work, count, NULL, next);
    for (int64_t b = 0; b < mesh->blocks; b++) {
      work.first[b + 1] = work.first[b] + next[b];
      next[b] = work.first[b];
    }
    mesh->slots = work.first[mesh->blocks];
    ok = (work.entry = mpsi_alloc(context, mesh->slots, sizeof(entry))) != NULL;
  }
  if (ok) {
    deal(&work, count, work.entry, next);
    mpsi_parallel_for(context, mesh->blocks, arrange_block, &work);
    number_blocks(mesh, work.first);
    mesh->run = mpsi_alloc(context, mesh->runs, sizeof(mpsi_dynamics_pair_run));
    ok = mesh->run && alloc_scattered(context, &mesh->scattered, mesh->scattered.count);
  }
  if (ok) mpsi_parallel_for(context, mesh->blocks, write_block, &work);
  mpsi_free(context, work.entry);
  mpsi_free(context, work.first);
  mpsi_free(context, next);
  if (!ok) mpsi_dynamics_mesh_free(context, mesh);
  return ok;
}

void mpsi_dynamics_mesh_free(mps_context *context, mpsi_dynamics_mesh *mesh) {
  mpsi_dynamics_scattered *list = &mesh->scattered;
  void *parts[] = {mesh->block, mesh->run, list->i,   list->j,  list->ti,
                   list->tj,    list->r0x, list->r0y, list->kf, list->kc};
  for (size_t k = 0; k < sizeof parts / sizeof *parts; k++) mpsi_free(context, parts[k]);
  *mesh = (mpsi_dynamics_mesh){0};
}
