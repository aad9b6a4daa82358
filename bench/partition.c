/* partition.c - how blocks of cells would be dealt to ranks that this machine has not: the
 * library's own curve and cut (src/domain/curve.c) on a model of any size, ghosts and neighbours
 * counted one by one, and from them what a step would take: bench-partition PARTICLES RANKS
 * [THREADS [NS [GB/S]]] threads a rank (1), ns that one thread takes for a particle and step (85:
 * bench-mpm measures those of a machine), GB/s that a rank sends (10). The model is ground with 8
 * particles a cell under a slope of 1 in 4: two thirds as deep as long and wide, at its middle.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "measure.h"

#include "domain/curve.h"

#include <math.h>
#include <string.h>

enum { SIDE = 8, TILE = SIDE + 3, VALUES = 8, FULL = 8 * SIDE * SIDE * SIDE };
#define ROUNDING 1.5 /* tiles that are wider, as particles may leave their block by a cell */

/* ---- a domain whose other ranks have nothing ------------------------------------------------- */

typedef struct lonely {
  int32_t ranks;
  int64_t sums, bytes; /* reductions so far */
} lonely;

static mps_status nothing_sent(void *user, int32_t count, const mps_domain_message *messages,
                               mps_domain_room_fn room, void *room_user) {
  (void)user, (void)count, (void)messages, (void)room, (void)room_user;
  return MPS_ERROR_STATE;
}
static mps_status no_star(void *user, int64_t own, int64_t guests, const int32_t *rank,
                          const int64_t *index, void **star) {
  (void)user, (void)own, (void)guests, (void)rank, (void)index, (void)star;
  return MPS_ERROR_STATE;
}
static mps_status no_begin(void *user, void *star, int32_t bytes, const void *own, void *guests) {
  (void)user, (void)star, (void)bytes, (void)own, (void)guests;
  return MPS_ERROR_STATE;
}
static mps_status no_end(void *user, void *star) {
  (void)user, (void)star;
  return MPS_ERROR_STATE;
}
static void no_destroy(void *user, void *star) { (void)user, (void)star; }
static mps_status same_max(void *user, int32_t count, double *values) {
  (void)user, (void)count, (void)values;
  return MPS_OK;
}
static mps_status same_sum(void *user, int32_t count, int64_t *values) {
  lonely *l = user;
  l->bytes += 8 * (int64_t)count;
  if (l->sums++ == 0) { /* the domain counts its ranks */
    values[0] = l->ranks;
    values[1] = (int64_t)l->ranks * (l->ranks - 1) / 2;
  }
  return MPS_OK;
}

static mps_domain *make_domain(mps_context *context, lonely *l) {
  mps_domain *domain = NULL;
  mps_domain_def def = mps_domain_defaults();
  def.size = l->ranks;
  def.user = l;
  def.rendezvous = nothing_sent;
  def.star_create = no_star;
  def.star_begin = no_begin;
  def.star_end = no_end;
  def.star_destroy = no_destroy;
  def.reduce_max = same_max;
  def.reduce_sum = same_sum;
  check(context, mps_domain_create(context, &def, &domain), "domain");
  return domain;
}

/* ---- the model ------------------------------------------------------------------------------- */

typedef struct block {
  int64_t key, weight; /* particles */
  int32_t at[3];
} block;

typedef struct model {
  int32_t side[3];
  int64_t blocks, particles;
  block *block;    /* along the curve */
  int32_t *number; /* by place: of the block, -1: none */
  int32_t *owner;  /* by number */
} model;

static int compare(const void *left, const void *right) {
  const block *a = left, *b = right;
  return a->key < b->key ? -1 : a->key > b->key;
}

static int64_t place(const model *m, int32_t x, int32_t y, int32_t z) {
  if (x < 0 || y < 0 || z < 0 || x >= m->side[0] || y >= m->side[1] || z >= m->side[2]) return -1;
  return ((int64_t)z * m->side[1] + y) * m->side[0] + x;
}

static void *room(int64_t count, size_t size) {
  void *memory = calloc((size_t)count, size);
  if (memory) return memory;
  fprintf(stderr, "bench-partition: out of memory\n");
  exit(1);
}

/* Particles of a block under the slope, whose surface cuts some blocks. */
static int64_t fill(double surface, int32_t z) {
  const double share = fmin(1.0, fmax(0.0, surface - z));
  return (int64_t)(share * FULL);
}

static void make_model(model *m, double particles) {
  const double side = cbrt(1.5 * particles / FULL);
  m->side[0] = m->side[1] = (int32_t)ceil(side);
  m->side[2] = (int32_t)ceil((2.0 / 3.0 + 0.125) * side) + 1;
  const int64_t places = (int64_t)m->side[0] * m->side[1] * m->side[2];
  m->block = room(places, sizeof *m->block);
  m->number = room(places, sizeof *m->number);
  for (int32_t z = 0; z < m->side[2]; z++)
    for (int32_t y = 0; y < m->side[1]; y++)
      for (int32_t x = 0; x < m->side[0]; x++) {
        const double surface = 2.0 / 3.0 * side + 0.25 * (x + 0.5 - 0.5 * side);
        const int64_t weight = fill(surface, z);
        m->number[place(m, x, y, z)] = -1;
        if (weight == 0) continue;
        block *b = &m->block[m->blocks++];
        *b = (block){.weight = weight, .at = {x, y, z}};
        b->key = mpsi_curve_key(3, b->at);
        m->particles += weight;
      }
  qsort(m->block, (size_t)m->blocks, sizeof *m->block, compare);
  for (int64_t k = 0; k < m->blocks; k++)
    m->number[place(m, m->block[k].at[0], m->block[k].at[1], m->block[k].at[2])] = (int32_t)k;
}

static void deal(model *m, mps_context *context, mps_domain *domain, int32_t ranks) {
  int64_t *key = room(m->blocks, sizeof *key), *weight = room(m->blocks, sizeof *weight);
  int64_t *first = room((int64_t)ranks + 1, sizeof *first);
  m->owner = room(m->blocks, sizeof *m->owner);
  for (int64_t k = 0; k < m->blocks; k++) key[k] = m->block[k].key, weight[k] = m->block[k].weight;
  check(context, mpsi_curve_cut(domain, "bench-partition", m->blocks, key, weight, first), "cut");
  for (int64_t k = 0; k < m->blocks; k++) m->owner[k] = mpsi_curve_owner(ranks, first, key[k]);
  free(key);
  free(weight);
  free(first);
}

/* ---- what ranks send ------------------------------------------------------------------------- */

typedef struct share {
  int64_t particles, blocks, border, ghosts; /* border: blocks that others need */
  int32_t neighbours;
  int32_t last; /* rank whose turn it was when a neighbour was last counted */
} share;

/* Ranks other than its own that have a block beside block k: at most 26. */
static int32_t others(const model *m, int64_t k, int32_t found[26]) {
  const int32_t *at = m->block[k].at;
  int32_t count = 0;
  for (int n = 0; n < 27; n++) {
    const int64_t p = place(m, at[0] + n % 3 - 1, at[1] + n / 3 % 3 - 1, at[2] + n / 9 - 1);
    if (p < 0 || m->number[p] < 0 || m->owner[m->number[p]] == m->owner[k]) continue;
    const int32_t rank = m->owner[m->number[p]];
    int32_t i = 0;
    while (i < count && found[i] != rank) i++;
    if (i == count) found[count++] = rank;
  }
  return count;
}

/* Blocks lie rank after rank along the curve, so a neighbour is new where it was not counted in
 * this rank's turn. */
static void count_shares(const model *m, share *s) {
  int32_t found[26];
  for (int64_t k = 0; k < m->blocks; k++) {
    share *own = &s[m->owner[k]];
    own->particles += m->block[k].weight;
    own->blocks++;
    const int32_t count = others(m, k, found);
    own->border += count > 0;
    for (int32_t i = 0; i < count; i++) {
      share *other = &s[found[i]];
      other->ghosts++;
      if (other->last == m->owner[k] + 1) continue;
      other->last = m->owner[k] + 1;
      own->neighbours++;
    }
  }
}

/* ---- the report ------------------------------------------------------------------------------ */

static void report(const model *m, const share *s, int32_t ranks, const double machine[3]) {
  share most = {0}, sum = {0};
  for (int32_t r = 0; r < ranks; r++) {
    most.particles = s[r].particles > most.particles ? s[r].particles : most.particles;
    most.ghosts = s[r].ghosts > most.ghosts ? s[r].ghosts : most.ghosts;
    most.neighbours = s[r].neighbours > most.neighbours ? s[r].neighbours : most.neighbours;
    sum.border += s[r].border, sum.ghosts += s[r].ghosts, sum.neighbours += s[r].neighbours;
  }
  const double mean = (double)m->particles / ranks;
  const double bytes = (double)most.ghosts * TILE * TILE * TILE * VALUES * 8.0 * ROUNDING;
  const double work = (double)most.particles * machine[1] / machine[0] * 1e-6; /* ms */
  const double sent = bytes / machine[2] * 1e-6;
  printf("%.3g particles in %lld blocks on %d ranks of %g threads: %.3g particles a rank\n",
         (double)m->particles, (long long)m->blocks, (int)ranks, machine[0], mean);
  printf("  imbalance %.3f, own blocks at the border %.0f %%, ghosts an own block %.2f, neighbours "
         "%.1f (most %d)\n",
         (double)most.particles / mean, 100.0 * (double)sum.border / (double)m->blocks,
         (double)sum.ghosts / (double)m->blocks, (double)sum.neighbours / ranks,
         (int)most.neighbours);
  printf(
      "  a step of the fullest rank: %.2f ms at work; %.1f MB to receive, %.2f ms, hidden by the "
      "interior where that is less than %.2f ms\n",
      work, bytes * 1e-6, sent, work * (1.0 - (double)sum.border / (double)m->blocks));
}

int main(int argc, char **argv) {
  const double particles = argc > 1 ? atof(argv[1]) : 1e8;
  lonely l = {.ranks = argc > 2 ? atoi(argv[2]) : 64};
  const double machine[3] = {argc > 3 ? atof(argv[3]) : 1.0, argc > 4 ? atof(argv[4]) : 85.0,
                             argc > 5 ? atof(argv[5]) : 10.0};
  if (!(particles >= FULL && particles <= 1e12) || l.ranks < 2 || l.ranks > 1000000) {
    fprintf(stderr, "bench-partition: %d to 1e12 particles on 2 to 1000000 ranks\n", FULL);
    return 2;
  }
  mps_context *context = NULL;
  check(NULL, mps_context_create(NULL, &context, NULL, 0), "context");
  mps_domain *domain = make_domain(context, &l);
  model m = {.blocks = 0};
  make_model(&m, particles);
  const int64_t before[2] = {l.sums, l.bytes};
  const double start = seconds();
  deal(&m, context, domain, l.ranks);
  const double cut = seconds() - start;
  share *s = room(l.ranks, sizeof *s);
  count_shares(&m, s);
  report(&m, s, l.ranks, machine);
  printf(
      "  the cut: %lld reductions of %.1f KB in all; %.2f s here, with the blocks of all ranks\n",
      (long long)(l.sums - before[0]), (double)(l.bytes - before[1]) * 1e-3, cut);
  free(s);
  free(m.block);
  free(m.number);
  free(m.owner);
  mps_domain_destroy(&domain);
  mps_context_destroy(&context);
  return 0;
}
