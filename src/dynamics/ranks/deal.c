/* deal.c - a set in parts becomes one whose particles lie on the ranks that have their blocks of
 * 512, in the order of one process (layout.c), without any rank having them all.
 *
 * A particle's number in the whole body is that of its place and id among all. Where each rank's
 * interval begins is found by bisection of places, then of ids, all ranks' at once: each round is a
 * sum over the ranks of how many lie below. Then particles travel, and each rank sorts its own.
 *
 * The arrangement of a block's pairs depends on all particles near it, and a rank arranges its own
 * blocks and blocks with a particle near them. So it needs the positions of all particles near
 * either. Ranks exchange the bounds of their blocks, cut where a block continues in another strip;
 * each requests the particles near the blocks that it arranges. Bounds request slightly more than
 * needed, which changes nothing.
 *
 * Finally blocks have local numbers, ascending as in the whole body, with a gap where they are not
 * neighbours in the whole body: no run of pairs crosses a gap.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "core/base/order.h"
#include "core/particles/particles_internal.h"
#include "deal.h"
#include "dynamics/base/dynamics_solver.h"
#include "dynamics/pairs/batch.h"

#include <stdlib.h>
#include <string.h>

int64_t mpsi_dynamics_first_of_rank(int64_t body, int64_t rank, int64_t ranks) {
  const int64_t first = mpsi_dynamics_block_of(body, body) * rank / ranks * MPSI_DYN_BLOCK;
  return first < body ? first : body;
}

/* Where a particle comes in the whole body. */
typedef struct item {
  int64_t key, id, index;
} item;

/* Bounds of a block's particles in one strip, by present indices on its rank. */
typedef mpsi_dynamics_piece piece;

/* A particle of another rank. */
typedef struct neighbour {
  int64_t number; /* in the whole body */
  double x, y;    /* m */
} neighbour;

typedef struct dealing {
  mps_dynamics *dynamics;
  const char *function;
  mps_domain *domain;
  int32_t rank, ranks;
  int64_t whole; /* particles of all ranks */
  double lo[2], hi[2];
  double reach, period; /* m */
  mpsi_dynamics_rows rows;
  item *item; /* own ones, in order */
  int64_t count;
  int64_t *key, *id; /* of each rank but the first: where its interval begins */
  mpsi_mailbox box;  /* pieces of all ranks */
  piece *requested;  /* around which this rank needs all particles */
  int64_t requests;
} dealing;

static mps_status refused(const dealing *d, int64_t bytes) {
  return mpsi_fail_memory(d->dynamics->context, d->function, (size_t)bytes);
}

/* ---- order ----------------------------------------------------------------------------------- */

static int compare(const void *left, const void *right) {
  const item *a = left, *b = right;
  if (a->key != b->key) return a->key < b->key ? -1 : 1;
  return a->id < b->id ? -1 : a->id > b->id;
}

/* Bounds and number of particles of the whole body. */
static mps_status measure(dealing *d, mps_status status) {
  double most[4] = {-INFINITY, -INFINITY, -INFINITY, -INFINITY};
  if (status == MPS_OK) {
    const mpsi_dynamics_geometry g = mpsi_dynamics_present_geometry(d->dynamics);
    for (int64_t k = 0; k < g.count; k++) {
      most[0] = fmax(most[0], -g.x[k]), most[1] = fmax(most[1], -g.y[k]);
      most[2] = fmax(most[2], g.x[k]), most[3] = fmax(most[3], g.y[k]);
    }
    d->whole = g.count;
  }
  status = mpsi_domain_agree_max(d->domain, d->function, status, 4, most);
  if (status == MPS_OK) status = mpsi_domain_sum(d->domain, d->function, 1, &d->whole);
  for (int c = 0; c < 2; c++) d->lo[c] = -most[c], d->hi[c] = most[2 + c];
  d->rows = mpsi_dynamics_layout_rows(d->lo, d->hi, d->dynamics->spacing);
  return status;
}

static mps_status list_items(dealing *d) {
  const mpsi_dynamics_geometry g = mpsi_dynamics_present_geometry(d->dynamics);
  const int64_t *id = mpsi_particles_integers(d->dynamics->particles, "id");
  mpsi_free(d->dynamics->context, d->item);
  d->count = g.count;
  d->item = mpsi_alloc(d->dynamics->context, g.count, sizeof *d->item);
  if (!d->item) return refused(d, g.count * (int64_t)sizeof *d->item);
  for (int64_t k = 0; k < g.count; k++)
    d->item[k] = (item){mpsi_dynamics_layout_key(&d->rows, g.x[k], g.y[k]), id[k], k};
  if (g.count > 0) qsort(d->item, (size_t)g.count, sizeof *d->item, compare);
  return MPS_OK;
}

/* Own ones before (key, id). */
static int64_t count_below(const dealing *d, int64_t key, int64_t id) {
  const item at = {.key = key, .id = id};
  int64_t low;
  MPSI_BISECT(low, d->count, middle, compare(&d->item[middle], &at) < 0);
  return low;
}

/* The least number of each cut for which more than the cut's particles lie below: of places, or of
 * ids at the cut's place. `out` has the number below which it lies, `least` is for work. */
static mps_status bisect(dealing *d, bool ids, int64_t *least, int64_t *below, int64_t *out) {
  const int32_t cuts = d->ranks - 1;
  for (bool open = true; open;) {
    open = false;
    for (int32_t c = 0; c < cuts; c++) {
      const int64_t middle = least[c] + (out[c] - least[c]) / 2;
      below[c] = ids ? count_below(d, d->key[c], middle + 1) : count_below(d, middle + 1, 0);
    }
    MPSI_TRY(mpsi_domain_sum(d->domain, d->function, cuts, below));
    for (int32_t c = 0; c < cuts; c++) {
      const int64_t middle = least[c] + (out[c] - least[c]) / 2;
      if (least[c] == out[c]) continue;
      if (below[c] > mpsi_dynamics_first_of_rank(d->whole, c + 1, d->ranks))
        out[c] = middle;
      else
        least[c] = middle + 1;
      open = open || least[c] < out[c];
    }
  }
  return MPS_OK;
}

static mps_status find_cuts(dealing *d) {
  mps_context *context = d->dynamics->context;
  const int64_t cuts = d->ranks - 1, made = mpsi_particles_made(d->dynamics->particles);
  const int64_t places = d->rows.strips * d->rows.rows * d->rows.width;
  int64_t *least = mpsi_alloc(context, 2 * cuts, sizeof *least);
  d->key = mpsi_alloc(context, 2 * cuts, sizeof *d->key);
  mps_status status = least && d->key ? MPS_OK : refused(d, 4 * cuts * 8);
  status = mpsi_domain_agree(d->domain, d->function, status);
  if (status == MPS_OK) {
    d->id = d->key + cuts;
    for (int64_t c = 0; c < cuts; c++) least[c] = 0, d->key[c] = places;
    status = bisect(d, false, least, least + cuts, d->key);
  }
  if (status == MPS_OK) {
    for (int64_t c = 0; c < cuts; c++) least[c] = 0, d->id[c] = made;
    status = bisect(d, true, least, least + cuts, d->id);
  }
  mpsi_free(context, least);
  return status;
}

/* To the ranks whose intervals they belong to. */
static mps_status travel(dealing *d) {
  mps_dynamics *dynamics = d->dynamics;
  int32_t *to = mpsi_alloc(dynamics->context, d->count, sizeof *to), rank = 0;
  const mps_status status = to ? MPS_OK : refused(d, d->count * 4);
  for (int64_t k = 0; to && k < d->count; k++) {
    while (rank < d->ranks - 1 &&
           compare(&d->item[k], &(item){.key = d->key[rank], .id = d->id[rank]}) >= 0)
      rank++;
    to[d->item[k].index] = rank;
  }
  mpsi_free(dynamics->context, d->item);
  d->item = NULL;
  const mps_status moved =
      mpsi_domain_move(d->domain, d->function, status, dynamics->particles, to);
  mpsi_free(dynamics->context, to);
  return moved;
}

static mps_status sort_own(dealing *d) {
  mps_dynamics *dynamics = d->dynamics;
  mps_status status = list_items(d);
  int64_t *order = mpsi_alloc(dynamics->context, d->count, sizeof *order);
  if (status == MPS_OK && !order) status = refused(d, d->count * 8);
  for (int64_t k = 0; status == MPS_OK && k < d->count; k++) order[k] = d->item[k].index;
  if (status == MPS_OK && d->count > 0)
    status = mpsi_particles_permute(dynamics->particles, d->function, order);
  mpsi_free(dynamics->context, order);
  dynamics->count = d->count;
  const int64_t wanted = mpsi_dynamics_first_of_rank(d->whole, d->rank + 1, d->ranks) -
                         mpsi_dynamics_first_of_rank(d->whole, d->rank, d->ranks);
  if (status == MPS_OK && d->count != wanted)
    status = mpsi_fail(dynamics->context, d->function, MPS_ERROR_INTERNAL,
                       "%lld particles have arrived on rank %d, expected are %lld",
                       (long long)d->count, (int)d->rank, (long long)wanted);
  return status;
}

/* ---- bounds ---------------------------------------------------------------------------------- */

static void widen(piece *p, const double *lo, const double *hi) {
  for (int c = 0; c < 2; c++) p->lo[c] = fmin(p->lo[c], lo[c]), p->hi[c] = fmax(p->hi[c], hi[c]);
}

static piece nothing(void) {
  return (piece){.lo = {INFINITY, INFINITY}, .hi = {-INFINITY, -INFINITY}};
}

static bool within_reach(const dealing *d, const piece *a, const piece *b) {
  return mpsi_dynamics_within_reach(a, b, d->reach, d->period);
}

/* `out` NULL: how many. */
static int64_t list_pieces(const dealing *d, piece *out) {
  const mpsi_dynamics_geometry g = mpsi_dynamics_present_geometry(d->dynamics);
  const int64_t first = mpsi_dynamics_first_of_rank(d->whole, d->rank, d->ranks);
  int64_t pieces = 0, strip = -1;
  for (int64_t k = 0; k < d->count; k++) {
    const int64_t at = d->item[k].key / (d->rows.rows * d->rows.width);
    if (k % MPSI_DYN_BLOCK == 0 || at != strip) {
      if (out) {
        out[pieces] = nothing();
        out[pieces].block = (first + k) / MPSI_DYN_BLOCK;
        out[pieces].begin = k;
      }
      pieces++;
    }
    strip = at;
    if (!out) continue;
    const double place[2] = {g.x[k], g.y[k]};
    widen(&out[pieces - 1], place, place);
    out[pieces - 1].end = k + 1;
  }
  return pieces;
}

static mps_status exchange_pieces(dealing *d) {
  mps_context *context = d->dynamics->context;
  const int64_t pieces = list_pieces(d, NULL);
  piece *own = mpsi_alloc(context, pieces, sizeof *own);
  mps_domain_message *message = mpsi_alloc(context, d->ranks, sizeof *message);
  mps_status status = own && message ? MPS_OK : refused(d, pieces * (int64_t)sizeof *own);
  if (status == MPS_OK) list_pieces(d, own);
  for (int32_t r = 0; status == MPS_OK && r < d->ranks; r++)
    message[r] =
        (mps_domain_message){.rank = r, .bytes = pieces * (int64_t)sizeof *own, .data = own};
  status = mpsi_domain_agree(d->domain, d->function, status);
  if (status == MPS_OK)
    status = mpsi_domain_exchange(d->domain, d->function, d->ranks, message, &d->box);
  MPSI_FREE(context, own, message);
  return status;
}

static const piece *pieces_of(const mpsi_mailbox *box, int32_t m, int64_t *count) {
  *count = box->mail[m].bytes / (int64_t)sizeof(piece);
  return box->mail[m].data;
}

static const piece *pieces_here(const dealing *d, int64_t *count) {
  for (int32_t m = 0; m < d->box.count; m++)
    if (d->box.mail[m].rank == d->rank) return pieces_of(&d->box, m, count);
  *count = 0;
  return NULL;
}

static piece bounds_of(const piece *list, int64_t count) {
  piece all = nothing();
  for (int64_t k = 0; k < count; k++) widen(&all, list[k].lo, list[k].hi);
  return all;
}

/* The blocks that this rank arranges: its own, and those near them. */
static mps_status list_requested(dealing *d) {
  int64_t own, count, all = 0;
  const piece *here = pieces_here(d, &own), bounds = bounds_of(here, own);
  for (int32_t m = 0; m < d->box.count; m++) (void)pieces_of(&d->box, m, &count), all += count;
  d->requested = mpsi_alloc(d->dynamics->context, all, sizeof *d->requested);
  if (!d->requested) return refused(d, all * (int64_t)sizeof *d->requested);
  for (int32_t m = 0; m < d->box.count; m++) {
    const piece *list = pieces_of(&d->box, m, &count);
    for (int64_t k = 0, next; k < count; k = next) {
      bool near = false;
      for (next = k; next < count && list[next].block == list[k].block; next++)
        for (int64_t q = 0; !near && q < own && within_reach(d, &list[next], &bounds); q++)
          near = within_reach(d, &list[next], &here[q]);
      for (int64_t q = k; near && q < next; q++) d->requested[d->requests++] = list[q];
    }
  }
  return MPS_OK;
}

/* ---- what is near ---------------------------------------------------------------------------- */

static mps_status request(dealing *d, mpsi_mailbox *box) {
  mps_context *context = d->dynamics->context;
  mps_domain_message *message = mpsi_alloc(context, d->ranks, sizeof *message);
  piece *list = NULL;
  int64_t used = 0, room = 0;
  int32_t messages = 0;
  mps_status status = message ? MPS_OK : refused(d, d->ranks * (int64_t)sizeof *message);
  for (int pass = 0; status == MPS_OK && pass < 2; pass++) { /* count, then list */
    if (pass == 1 && !(list = mpsi_alloc(context, room, sizeof *list)))
      status = refused(d, room * (int64_t)sizeof *list);
    for (int32_t m = 0; status == MPS_OK && m < d->box.count; m++) {
      int64_t count;
      const int64_t first = used;
      const piece *theirs = pieces_of(&d->box, m, &count), bounds = bounds_of(theirs, count);
      if (d->box.mail[m].rank == d->rank) continue;
      for (int64_t k = 0; k < d->requests; k++)
        if (within_reach(d, &d->requested[k], &bounds)) {
          if (list) list[used++] = d->requested[k];
          room += pass == 0;
        }
      if (used > first)
        message[messages++] = (mps_domain_message){.rank = d->box.mail[m].rank,
                                                   .bytes = (used - first) * (int64_t)sizeof *list,
                                                   .data = list + first};
    }
  }
  status = mpsi_domain_agree(d->domain, d->function, status);
  if (status == MPS_OK)
    status = mpsi_domain_exchange(d->domain, d->function, messages, message, box);
  MPSI_FREE(context, list, message);
  return status;
}

/* Own particles within reach of the pieces; `out` NULL: how many. `near` is for work. */
static int64_t answer(const dealing *d, int64_t requests, const piece *requested, int64_t *near,
                      neighbour *out) {
  const mpsi_dynamics_geometry g = mpsi_dynamics_present_geometry(d->dynamics);
  const int64_t first = mpsi_dynamics_first_of_rank(d->whole, d->rank, d->ranks);
  int64_t own, found = 0;
  const piece *here = pieces_here(d, &own);
  for (int64_t p = 0; p < own; p++) {
    int64_t nears = 0;
    for (int64_t q = 0; q < requests; q++)
      if (within_reach(d, &here[p], &requested[q])) near[nears++] = q;
    for (int64_t k = here[p].begin; nears > 0 && k < here[p].end; k++) {
      const piece at = {.lo = {g.x[k], g.y[k]}, .hi = {g.x[k], g.y[k]}};
      bool any = false;
      for (int64_t q = 0; q < nears && !any; q++) any = within_reach(d, &at, &requested[near[q]]);
      if (any && out) out[found] = (neighbour){first + k, g.x[k], g.y[k]};
      found += any;
    }
  }
  return found;
}

/* Particles of other ranks near the blocks that this one arranges, in order. */
static mps_status bring_near(dealing *d, mpsi_mailbox *out) {
  mps_context *context = d->dynamics->context;
  mpsi_mailbox requests = {.context = context};
  mps_status status = request(d, &requests);
  if (status != MPS_OK) return status;
  int64_t all = 0, most = 0, count, used = 0;
  int32_t messages = 0;
  for (int32_t m = 0; m < requests.count; m++) {
    (void)pieces_of(&requests, m, &count);
    most = count > most ? count : most;
  }
  int64_t *near = mpsi_alloc(context, most, sizeof *near);
  for (int32_t m = 0; near && m < requests.count; m++) {
    const piece *list = pieces_of(&requests, m, &count);
    all += answer(d, count, list, near, NULL);
  }
  neighbour *found = mpsi_alloc(context, all, sizeof *found);
  mps_domain_message *message = mpsi_alloc(context, d->ranks, sizeof *message);
  if (!near || !found || !message) status = refused(d, all * (int64_t)sizeof *found);
  for (int32_t m = 0; status == MPS_OK && m < requests.count; m++) {
    const piece *list = pieces_of(&requests, m, &count);
    const int64_t n = answer(d, count, list, near, found + used);
    if (n > 0)
      message[messages++] = (mps_domain_message){
          .rank = requests.mail[m].rank, .bytes = n * (int64_t)sizeof *found, .data = found + used};
    used += n;
  }
  status = mpsi_domain_agree(d->domain, d->function, status);
  if (status == MPS_OK)
    status = mpsi_domain_exchange(d->domain, d->function, messages, message, out);
  mpsi_domain_free_mail(&requests);
  MPSI_FREE(context, near, found, message);
  return status;
}

/* ---- numbers --------------------------------------------------------------------------------- */

/* Iterates over own and received particles, in the order of the whole body. */
typedef struct walk {
  const dealing *d;
  const mpsi_mailbox *box;
  mpsi_dynamics_geometry g;
  int32_t mail; /* of the box; the own ones come between those of lower and higher ranks */
  int64_t at;
  bool passed; /* the own ones */
} walk;

static bool next(walk *w, neighbour *out) {
  for (;;) {
    const bool left = w->mail < w->box->count;
    if (!w->passed && (!left || w->box->mail[w->mail].rank > w->d->rank)) {
      const int64_t first = mpsi_dynamics_first_of_rank(w->d->whole, w->d->rank, w->d->ranks);
      if (w->at < w->d->count) {
        *out = (neighbour){first + w->at, w->g.x[w->at], w->g.y[w->at]};
        w->at++;
        return true;
      }
      w->passed = true, w->at = 0;
      continue;
    }
    if (!left) return false;
    if (w->at < w->box->mail[w->mail].bytes / (int64_t)sizeof *out) {
      memcpy(out, (const neighbour *)w->box->mail[w->mail].data + w->at++, sizeof *out);
      return true;
    }
    w->mail++, w->at = 0;
  }
}

/* Local blocks, with a gap where they are not neighbours in the whole body; number of particles. */
static void count_blocks(walk w, int64_t *blocks, int64_t *nears) {
  neighbour k;
  int64_t last = -2;
  *blocks = *nears = 0;
  while (next(&w, &k)) {
    const int64_t block = k.number / MPSI_DYN_BLOCK;
    if (block != last) *blocks += *blocks > 0 && block != last + 1 ? 2 : 1;
    last = block;
    ++*nears;
  }
}

static mps_status number(dealing *d, const mpsi_mailbox *box, mpsi_dynamics_window *out) {
  mps_context *context = d->dynamics->context;
  const walk start = {.d = d, .box = box, .g = mpsi_dynamics_present_geometry(d->dynamics)};
  int64_t blocks, slot = -1, last = -2, n = 0;
  neighbour k;
  count_blocks(start, &blocks, &out->nears);
  out->block = mpsi_alloc(context, blocks, sizeof *out->block);
  out->near = mpsi_alloc(context, out->nears, sizeof *out->near);
  out->x = mpsi_alloc(context, blocks * MPSI_DYN_BLOCK, sizeof *out->x);
  out->y = mpsi_alloc(context, blocks * MPSI_DYN_BLOCK, sizeof *out->y);
  out->side = mpsi_alloc(context, blocks * MPSI_DYN_BLOCK, sizeof *out->side);
  if (!out->block || !out->near || !out->x || !out->y || !out->side)
    return refused(d, blocks * MPSI_DYN_BLOCK * 24);
  const int64_t first = mpsi_dynamics_first_of_rank(d->whole, d->rank, d->ranks);
  for (walk w = start; next(&w, &k); n++) {
    const int64_t block = k.number / MPSI_DYN_BLOCK;
    if (block != last) {
      if (slot >= 0 && block != last + 1) out->block[++slot] = last + 1;
      out->block[++slot] = last = block;
    }
    const int64_t here = slot * MPSI_DYN_BLOCK + k.number % MPSI_DYN_BLOCK;
    const int64_t end = d->whole - last * MPSI_DYN_BLOCK;
    out->near[n] = here;
    out->x[here] = k.x, out->y[here] = k.y;
    if (k.number == first) out->first = here;
    out->count = slot * MPSI_DYN_BLOCK + (end < MPSI_DYN_BLOCK ? end : MPSI_DYN_BLOCK);
  }
  if (d->count == 0) out->first = 0;
  out->last = out->first + d->count;
  out->whole = d->whole;
  out->edge[0] = d->lo[0], out->edge[1] = d->hi[0];
  return MPS_OK;
}

mps_status mpsi_dynamics_deal(mps_dynamics *dynamics, const char *function,
                              mpsi_dynamics_window *out) {
  mps_context *context = dynamics->context;
  dealing d = {.dynamics = dynamics,
               .function = function,
               .domain = dynamics->domain,
               .rank = mps_domain_rank(dynamics->domain),
               .ranks = mps_domain_size(dynamics->domain),
               .reach = dynamics->radius * (1.0 + 1e-6),
               .period = isnan(dynamics->def.period_x) ? 0.0 : dynamics->def.period_x,
               .box.context = context};
  mpsi_mailbox near = {.context = context};
  *out = (mpsi_dynamics_window){0};
  mps_status status = measure(&d, mpsi_dynamics_add_reference(dynamics, function));
  if (status == MPS_OK) status = mpsi_domain_agree(d.domain, function, list_items(&d));
  if (status == MPS_OK) status = find_cuts(&d);
  if (status == MPS_OK) status = travel(&d);
  if (status == MPS_OK) status = mpsi_domain_agree(d.domain, function, sort_own(&d));
  if (status == MPS_OK) status = exchange_pieces(&d);
  if (status == MPS_OK) status = mpsi_domain_agree(d.domain, function, list_requested(&d));
  if (status == MPS_OK) status = bring_near(&d, &near);
  if (status == MPS_OK) status = number(&d, &near, out); /* settled by the caller */
  mpsi_domain_free_mail(&near);
  mpsi_domain_free_mail(&d.box);
  MPSI_FREE(context, d.item, d.key, d.requested);
  return status;
}
