/* crowding.c - whether particles share a place, or clouds of them overlap: the same matter twice.
 * Every solver asks before it takes particles, and when some are added.
 *
 * Two particles within SAME spacings share a place. Elsewhere the volumes of the particles within
 * RADIUS of one are summed: a regular lattice fills the ball to within a tenth of 1, jittered ones
 * to within a quarter, two clouds in one place 2. Particles are found by a hash of cells as wide as
 * the ball. SPDX-License-Identifier: BSD-3-Clause */
#include "particles_private.h"

#include <stdio.h>
#include <string.h>

#define SAME 1e-6       /* spacings */
#define FULL 1.5        /* of the ball's volume */
#define CHUNK 4096      /* particles of a unit of work */
#define FARTHEST 0x1p52 /* cells from the origin */

static const double RADIUS[4] = {0.0, 0.0, 2.5, 2.1}; /* spacings, by dimension */

/* Result of a chunk of particles. */
typedef struct chunk {
  int64_t crowded; /* particles in balls filled above FULL */
  int64_t fullest; /* index of the particle in the fullest, or -1 */
  double fill;     /* of that */
  int64_t pair[2]; /* indices of the first particle that shares its place, and of the other */
} chunk;

typedef struct search {
  const mps_particles *set;
  const double *x[3], *volume; /* volume NULL: all are of the spacing's */
  const mpsi_amount *amount;
  int64_t count, from;
  int32_t dim;
  uint64_t mask;
  int32_t *head, *next; /* of the particles of a hash value: indices plus 1, 0 ends */
  chunk *chunks;
} search;

/* Cell of particle k; false: too far off to have one. */
static bool cell_of(const search *s, int64_t k, int64_t cell[3]) {
  const double inverse = 1.0 / (RADIUS[s->dim] * s->set->def.spacing);
  for (int32_t c = 0; c < 3; c++) {
    const double at = c < s->dim ? floor(s->x[c][k] * inverse) : 0.0;
    if (!(fabs(at) < FARTHEST)) return false;
    cell[c] = (int64_t)at;
  }
  return true;
}

/* Neighbours along x follow one another, so that a lattice is read in order. */
static uint64_t hash_of(const search *s, const int64_t cell[3]) {
  const uint64_t row = (uint64_t)cell[1] * UINT64_C(0x9e3779b97f4a7c15) +
                       (uint64_t)cell[2] * UINT64_C(0xc2b2ae3d27d4eb4f);
  return ((uint64_t)cell[0] + (row >> 20)) & s->mask;
}

/* Volume of particle k over that of its share of a lattice. */
static double share_of(const search *s, int64_t k) {
  if (!s->volume || !(s->volume[k] > 0.0)) return 1.0;
  const mps_particles_def *d = &s->set->def;
  const double size = s->dim == 3 ? d->spacing * d->spacing * d->spacing : d->spacing * d->spacing;
  const double radius = s->amount->axisymmetric ? fabs(s->x[0][k]) : 1.0;
  const double lattice = size * s->amount->measure * radius;
  return lattice > 0.0 ? s->volume[k] / lattice : 1.0;
}

/* Adds the particles of a cell that are near particle k. */
static void add_cell(const search *s, int64_t k, const int64_t cell[3], double *sum, chunk *out) {
  const double D = s->set->def.spacing, reach = RADIUS[s->dim] * D, same = SAME * D;
  for (int64_t j = s->head[hash_of(s, cell)]; j > 0; j = s->next[j - 1]) {
    const int64_t other = j - 1;
    int64_t own[3];
    double square = 0.0;
    for (int32_t c = 0; c < s->dim; c++) {
      const double d = s->x[c][other] - s->x[c][k];
      square += d * d;
    }
    if (square >= reach * reach) continue;
    if (!cell_of(s, other, own) || memcmp(own, cell, sizeof own) != 0) continue;
    *sum += share_of(s, other);
    if (square > same * same || other == k || out->pair[0] >= 0) continue;
    out->pair[0] = k, out->pair[1] = other;
  }
}

static void search_chunk(void *data, int64_t unit, int32_t worker) {
  const search *s = data;
  chunk *out = &s->chunks[unit];
  const int64_t begin = s->from + unit * CHUNK;
  const int64_t end = begin + CHUNK < s->count ? begin + CHUNK : s->count;
  const double r = RADIUS[s->dim], ball = s->dim == 3 ? 4.18879 * r * r * r : 3.14159 * r * r;
  *out = (chunk){.fullest = -1, .pair = {-1, -1}};
  for (int64_t k = begin; k < end; k++) {
    int64_t own[3], cell[3];
    double sum = 0.0;
    if (!cell_of(s, k, own)) continue;
    const int64_t deep = s->dim == 3;
    for (cell[2] = own[2] - deep; cell[2] <= own[2] + deep; cell[2]++)
      for (cell[1] = own[1] - 1; cell[1] <= own[1] + 1; cell[1]++)
        for (cell[0] = own[0] - 1; cell[0] <= own[0] + 1; cell[0]++)
          add_cell(s, k, cell, &sum, out);
    if (!(sum > FULL * ball)) continue;
    out->crowded++;
    if (sum / ball > out->fill) out->fill = sum / ball, out->fullest = k;
  }
}

static bool make_cells(search *s, int64_t chunks) {
  mps_context *context = s->set->context;
  uint64_t size = 16;
  while (size < (uint64_t)s->count) size *= 2;
  s->mask = size - 1;
  s->head = mpsi_alloc(context, (int64_t)size, sizeof *s->head);
  if (s->head) s->next = mpsi_alloc(context, s->count, sizeof *s->next);
  if (s->next) s->chunks = mpsi_alloc(context, chunks, sizeof *s->chunks);
  if (!s->chunks) return false;
  for (int64_t k = s->count - 1; k >= 0; k--) { /* chains ascend */
    int64_t cell[3];
    if (!cell_of(s, k, cell)) continue;
    int32_t *head = &s->head[hash_of(s, cell)];
    s->next[k] = *head;
    *head = (int32_t)(k + 1);
  }
  return true;
}

static void place_text(const search *s, int64_t k, char *text, size_t size) {
  if (s->dim == 3)
    (void)snprintf(text, size, "(%g, %g, %g) m", s->x[0][k], s->x[1][k], s->x[2][k]);
  else
    (void)snprintf(text, size, "(%g, %g) m", s->x[0][k], s->x[1][k]);
}

static mps_status judge(const search *s, const char *function, int64_t chunks) {
  const int64_t *id = s->set->fields[MPSI_FIELD_ID]->data;
  chunk all = {.fullest = -1, .pair = {-1, -1}};
  char place[96];
  for (int64_t u = 0; u < chunks; u++) {
    const chunk *c = &s->chunks[u];
    all.crowded += c->crowded;
    if (c->fill > all.fill) all.fill = c->fill, all.fullest = c->fullest;
    if (all.pair[0] < 0) all.pair[0] = c->pair[0], all.pair[1] = c->pair[1];
  }
  if (all.pair[0] >= 0) {
    place_text(s, all.pair[0], place, sizeof place);
    (void)mpsi_fail(s->set->context, function, MPS_ERROR_ARGUMENT,
                    "particles %lld and %lld lie at the same point %s: particles must be at least "
                    "%g of the spacing %g m apart",
                    (long long)id[all.pair[0]], (long long)id[all.pair[1]], place, SAME,
                    s->set->def.spacing);
    mpsi_fail_where(s->set->context, -1, id[all.pair[0]]);
    return MPS_ERROR_ARGUMENT;
  }
  if (all.crowded == 0) return MPS_OK;
  place_text(s, all.fullest, place, sizeof place);
  mpsi_log(s->set->context, MPS_CONTEXT_LOG_WARNING,
           "%lld of %lld particles lie where space is filled above %g of its volume, %.3g at "
           "particle %lld, %s: clouds of particles overlap, or their spacing is not %g m",
           (long long)all.crowded, (long long)s->count, FULL, all.fill, (long long)id[all.fullest],
           place, s->set->def.spacing);
  return MPS_OK;
}

mps_status mpsi_particles_check_crowding(mps_particles *p, const char *function, int64_t from,
                                         const mpsi_amount *amount) {
  search s = {.set = p, .count = p->count, .from = from, .dim = p->def.dim, .amount = amount};
  if (from >= p->count || p->count >= INT32_MAX) return MPS_OK;
  for (int32_t c = 0; c < s.dim; c++) s.x[c] = mpsi_field_column(p->fields[MPSI_FIELD_POSITION], c);
  if (amount) s.volume = mpsi_particles_column(p, "volume", 0);
  const int64_t chunks = (p->count - from + CHUNK - 1) / CHUNK;
  mps_status status = MPS_OK;
  if (!make_cells(&s, chunks)) {
    status = mpsi_fail(p->context, function, MPS_ERROR_MEMORY,
                       "could not allocate the search for %lld particles that share a place",
                       (long long)p->count);
  } else {
    mpsi_parallel_for(p->context, chunks, search_chunk, &s);
    status = judge(&s, function, chunks);
  }
  MPSI_FREE(p->context, s.head, s.next, s.chunks);
  return status;
}
