/* partition.c - see partition.h.
 *
 * Neighbours change with every step, and with them the halo of a rank. A particle stays in the halo
 * until the set is sorted again: after a few steps hardly any is new, and the pattern of the
 * messages stays. SPDX-License-Identifier: BSD-3-Clause */
#include "fluid/base/access.h"
#include "partition.h"

#include "fluid/particles/pores.h"

#include "body/body_internal.h"
#include "domain/halo.h"

#include <string.h>

/* Copies of values, by the particles that they are of. */
typedef struct link {
  mpsi_halo *halo;
  int64_t guests;
  int32_t *guest; /* particle of each copy here */
  double *in;     /* MPSI_FLUID_SHARED columns of the guests */
} link;

struct mpsi_fluid_partition {
  mps_domain *domain;
  mps_status lost;
  int64_t block, blocks;  /* particles a block of the deal */
  int64_t count;          /* of particles: what `all` is of; -1: nothing yet */
  uint64_t epoch;         /* order that `near` is of */
  link all, near, back;   /* back: of marks, from ranks with copies to the owners */
  atomic_uchar *is_guest; /* count */
  double *mark;           /* of the guests of `near`, or of own particles */
  bool knows_local;
};

static bool is_own(const mps_fluid *f, int64_t i) { return i >= f->own[0] && i < f->own[1]; }

/* ---- life ------------------------------------------------------------------------------------ */

mps_status mpsi_fluid_partition_create(mps_fluid *f, const char *function) {
  if (!mpsi_domain_many(f->domain)) return MPS_OK;
  f->partition = mpsi_alloc(f->context, 1, sizeof *f->partition);
  const mps_status status =
      f->partition ? MPS_OK : mpsi_fail_memory(f->context, function, sizeof *f->partition);
  if (f->partition) *f->partition = (mpsi_fluid_partition){.domain = f->domain, .count = -1};
  return status;
}

static void drop_link(mps_fluid *f, link *l) {
  mpsi_halo_destroy(f->context, &l->halo);
  MPSI_FREE(f->context, l->guest, l->in);
  *l = (link){0};
}

static void forget(mps_fluid *f) {
  mpsi_fluid_partition *s = f->partition;
  drop_link(f, &s->all);
  drop_link(f, &s->near);
  drop_link(f, &s->back);
  MPSI_FREE(f->context, s->is_guest, s->mark);
  s->is_guest = NULL, s->mark = NULL;
  s->count = -1;
}

void mpsi_fluid_partition_destroy(mps_fluid *f) {
  if (!f->partition) return;
  forget(f);
  mpsi_free(f->context, f->partition);
  f->partition = NULL;
}

/* ---- errors ---------------------------------------------------------------------------------- */

mps_status mpsi_fluid_agree(mps_fluid *f, const char *function, mps_status status) {
  return mpsi_domain_agree(f->domain, function, status);
}

mps_status mpsi_fluid_agree_max(mps_fluid *f, const char *function, mps_status status,
                                int32_t count, double *values) {
  return mpsi_domain_agree_max(f->domain, function, status, count, values);
}

/* Values that all ranks must agree on: motions of walls and bodies, and loads, in the step. */
static void give_state(const mps_fluid *f, mpsi_given *list) {
  mpsi_give(list, "the number of particles", (double)f->count);
  mpsi_give(list, "dt", f->dt);
  mpsi_give(list, "time", f->time);
  for (int b = 0; b < f->walls; b++) {
    const mpsi_fluid_wall *w = &f->wall[b];
    if (!w->used) continue;
    mpsi_give_bytes(list, "a hash of a wall's motion in the step", w->next.s,
                    3 * (size_t)w->nodes * sizeof *w->next.s);
    mpsi_give_bytes(list, "a hash of a wall's motion", w->now.s,
                    3 * (size_t)w->nodes * sizeof *w->now.s);
  }
  for (int b = 0; b < f->bodies; b++)
    if (f->body[b].body) mpsi_body_give_state(list, f->body[b].body);
  for (int32_t k = 0; k < mpsi_fluid_load_count(f); k++)
    if (mpsi_fluid_load_of(f, k))
      mpsi_give_vector(list, "the present factor on a load", 2, mpsi_fluid_load_of(f, k)->now);
}

mps_status mpsi_fluid_agree_same(mps_fluid *f, const char *function, mps_status status) {
  mpsi_given list = MPSI_GIVEN;
  double edited = f->edited;
  if (!f->partition) return status;
  give_state(f, &list);
  status = mpsi_domain_agree_given_max(f->partition->domain, function, status, &list, 1, &edited);
  if (status == MPS_OK && edited > 0.0)
    status = mpsi_domain_agree_particles(f->partition->domain, function, status, f->particles);
  if (status == MPS_OK) f->edited = false;
  return status;
}

static void note(mpsi_fluid_partition *s, mps_status status) {
  if (s->lost == MPS_OK) s->lost = status;
}

mps_status mpsi_fluid_lost(mps_fluid *f, const char *function) {
  if (!f->partition || f->partition->lost == MPS_OK) return MPS_OK;
  return mpsi_fluid_agree(f, function, f->partition->lost);
}

/* ---- the deal -------------------------------------------------------------------------------- */

#define BLOCK 2560      /* particles in a block, about */
#define MOST_BLOCKS 32  /* larger blocks instead */
#define MOST_CHUNKS 256 /* in a block: its columns have 16 bits */

mpsi_fluid_blocks mpsi_fluid_cut(const mps_fluid *f) {
  const int64_t chunks = (f->count + MPSI_FLUID_CHUNK - 1) / MPSI_FLUID_CHUNK;
  int64_t needed = (f->count + BLOCK - 1) / BLOCK;
  needed += needed > 1 && needed % 2; /* two threads, equal shares */
  if (needed > MOST_BLOCKS) needed = MOST_BLOCKS;
  if (needed < (chunks + MOST_CHUNKS - 1) / MOST_CHUNKS)
    needed = (chunks + MOST_CHUNKS - 1) / MOST_CHUNKS;
  const int64_t each = (chunks + needed - 1) / needed; /* whole chunks: ranks have whole blocks */
  return (mpsi_fluid_blocks){(chunks + each - 1) / each, each * MPSI_FLUID_CHUNK};
}

void mpsi_fluid_deal(mps_fluid *f) {
  const int64_t block = f->count > 0 ? mpsi_fluid_cut(f).size : 1;
  mpsi_fluid_partition *s = f->partition;
  f->own[0] = 0, f->own[1] = f->count;
  if (!s) return;
  const int64_t ranks = mps_domain_size(s->domain), rank = mps_domain_rank(s->domain);
  s->block = block;
  s->blocks = (f->count + block - 1) / block;
  for (int64_t k = 0; k < 2; k++) {
    const int64_t at = (rank + k) * s->blocks / ranks * block;
    f->own[k] = at < f->count ? at : f->count;
  }
}

static int32_t owner(const mpsi_fluid_partition *s, int64_t particle) {
  const int64_t ranks = mps_domain_size(s->domain);
  return (int32_t)(((particle / s->block + 1) * ranks - 1) / s->blocks);
}

/* ---- links ----------------------------------------------------------------------------------- */

/* Of each guest the particle that it is here, its owner and its index there. */
typedef struct guests {
  int64_t count; /* so far */
  int32_t *particle, *rank;
  int64_t *index;
} guests;

static void add_guest(guests *g, int64_t particle, int32_t rank, int64_t index) {
  g->particle[g->count] = (int32_t)particle;
  g->rank[g->count] = rank, g->index[g->count++] = index;
}

/* A link with `count` guests, which list(fluid, from, guests) gives. Collective. */
static mps_status make_link(mps_fluid *f, const char *function, link *l, int64_t count,
                            void (*list)(const mps_fluid *, const void *, guests *),
                            const void *from) {
  drop_link(f, l);
  guests g = {.particle = mpsi_alloc(f->context, count, sizeof *g.particle),
              .rank = mpsi_alloc(f->context, count, sizeof *g.rank),
              .index = mpsi_alloc(f->context, count, sizeof *g.index)};
  l->guests = count;
  l->guest = g.particle;
  l->in = mpsi_alloc(f->context, count * MPSI_FLUID_SHARED, sizeof *l->in);
  const bool room = g.particle && g.rank && g.index && l->in;
  mps_status status =
      room ? MPS_OK : mpsi_fail_memory(f->context, function, (size_t)count * sizeof *l->in);
  if (room) list(f, from, &g);
  status = mpsi_fluid_agree(f, function, status);
  const mpsi_halo_def def = {
      .guests = count, .rank = g.rank, .index = g.index, .columns = MPSI_FLUID_SHARED};
  if (status == MPS_OK) status = mpsi_halo_create(f->partition->domain, function, &def, &l->halo);
  MPSI_FREE(f->context, g.rank, g.index);
  return status;
}

/* `first` is 0: the halo's own column `in`, from which values go to their places. */
static void copy(mps_fluid *f, link *l, int32_t columns, double *const *column,
                 double *const *into) {
  mpsi_fluid_partition *s = f->partition;
  double *in[MPSI_FLUID_SHARED];
  if (s->lost != MPS_OK) return;
  for (int32_t c = 0; c < columns; c++) in[c] = l->in + c * l->guests;
  mps_status status = mpsi_halo_begin(l->halo, "mps_fluid", columns, column);
  if (status == MPS_OK) status = mpsi_halo_end(l->halo, "mps_fluid", in);
  note(s, status);
  for (int32_t c = 0; status == MPS_OK && c < columns; c++)
    for (int64_t k = 0; k < l->guests; k++) into[c][l->guest[k]] = in[c][k];
}

typedef bool (*needed_fn)(const mps_fluid *, int64_t);

static void list_needed(const mps_fluid *f, const void *from, guests *g) {
  const needed_fn needed = *(const needed_fn *)from;
  for (int64_t i = 0; i < f->count; i++)
    if (needed(f, i)) add_guest(g, i, owner(f->partition, i), i);
}

/* The particles selected by `needed` as guests of a link. */
static mps_status join(mps_fluid *f, const char *function, link *l, needed_fn needed) {
  int64_t count = 0;
  for (int64_t i = 0; i < f->count; i++) count += needed(f, i);
  return make_link(f, function, l, count, list_needed, &needed);
}

/* ---- the way back ---------------------------------------------------------------------------- */

/* Sends each owner the number of its first guest here, and the guests' indices. */
static mps_status request_items(mps_fluid *f, const char *function, mpsi_mailbox *box) {
  const mpsi_fluid_partition *s = f->partition;
  const link *l = &s->near;
  const int64_t ranks = mps_domain_size(s->domain);
  mps_domain_message *message = mpsi_alloc(f->context, ranks, sizeof *message);
  int64_t *words = mpsi_alloc(f->context, l->guests + ranks, sizeof *words), at = 0;
  const bool room = message && words;
  mps_status status =
      room ? MPS_OK : mpsi_fail_memory(f->context, function, (size_t)(l->guests + ranks) * 8);
  int32_t count = 0;
  for (int64_t k = 0; room && k < l->guests;) {
    const int32_t rank = owner(s, l->guest[k]);
    mps_domain_message *m = &message[count++];
    *m = (mps_domain_message){.rank = rank, .data = words + at};
    words[at++] = k;
    for (; k < l->guests && owner(s, l->guest[k]) == rank; k++) words[at++] = l->guest[k];
    m->bytes = (const char *)(words + at) - (const char *)m->data;
  }
  status = mpsi_fluid_agree(f, function, status);
  if (status == MPS_OK) status = mpsi_domain_exchange(s->domain, function, count, message, box);
  MPSI_FREE(f->context, message, words);
  return status;
}

/* Its guests are the guests of `near` elsewhere that are this rank's particles. */
static void list_requested(const mps_fluid *f, const void *from, guests *g) {
  const mpsi_mailbox *box = from;
  for (int32_t m = 0; m < box->count; m++) {
    const int64_t *words = box->mail[m].data;
    for (int64_t k = 1; k < box->mail[m].bytes / 8; k++)
      add_guest(g, words[k], box->mail[m].rank, words[0] + k - 1);
  }
}

static mps_status join_back(mps_fluid *f, const char *function) {
  mpsi_mailbox box = {.context = f->context};
  int64_t count = 0;
  MPSI_TRY(request_items(f, function, &box));
  for (int32_t m = 0; m < box.count; m++) count += box.mail[m].bytes / 8 - 1;
  mps_status status = make_link(f, function, &f->partition->back, count, list_requested, &box);
  mpsi_domain_free_mail(&box);
  return status;
}

/* ---- halo: neighbours that other ranks own --------------------------------------------------- */

static bool is_foreign(const mps_fluid *f, int64_t i) { return !is_own(f, i); }

static bool is_guest(const mps_fluid *f, int64_t i) {
  return atomic_load_explicit(&f->partition->is_guest[i], memory_order_relaxed);
}

static mps_status begin_anew(mps_fluid *f, const char *function) {
  mpsi_fluid_partition *s = f->partition;
  forget(f);
  s->is_guest = mpsi_alloc(f->context, f->count, sizeof *s->is_guest);
  s->mark = mpsi_alloc(f->context, f->count, sizeof *s->mark);
  mps_status status = s->is_guest && s->mark
                          ? MPS_OK
                          : mpsi_fail_memory(f->context, function, (size_t)f->count * 9);
  MPSI_TRY(mpsi_fluid_agree(f, function, status));
  MPSI_TRY(join(f, function, &s->all, is_foreign));
  s->count = f->count;
  s->epoch = mps_particles_epoch(f->particles) + 1; /* another one */
  return MPS_OK;
}

typedef struct search {
  mps_fluid *fluid;
  atomic_bool more;
} search;

static void find_guests(void *data, int64_t chunk, int32_t worker) {
  search *s = data;
  mps_fluid *f = s->fluid;
  const int64_t end = (chunk + 1) * MPSI_FLUID_CHUNK;
  for (int64_t i = chunk * MPSI_FLUID_CHUNK; i < end && i < f->count; i++) {
    const int32_t *index = f->index + mpsi_fluid_pairs(f, i);
    for (int32_t k = 0; k < f->near[i]; k++) {
      const int32_t j = index[k] < f->count ? index[k] : f->parent[index[k] - f->count];
      if (is_own(f, j) || is_guest(f, j)) continue;
      atomic_store_explicit(&f->partition->is_guest[j], 1, memory_order_relaxed);
      atomic_store_explicit(&s->more, true, memory_order_relaxed);
    }
  }
}

mps_status mpsi_fluid_find_halo(mps_fluid *f, const char *function) {
  mpsi_fluid_partition *s = f->partition;
  mps_status status = MPS_OK;
  if (!s) return MPS_OK;
  s->knows_local = false;
  if (s->count != f->count) status = begin_anew(f, function);
  if (status != MPS_OK) return status;
  const uint64_t epoch = mps_particles_epoch(f->particles);
  search found = {.fluid = f};
  if (s->epoch != epoch) memset((void *)s->is_guest, 0, (size_t)f->count);
  atomic_store(&found.more, s->epoch != epoch);
  s->epoch = epoch;
  mpsi_fluid_units(f, MPSI_FLUID_CHUNK, find_guests, &found);
  double more = atomic_load(&found.more);
  status = mpsi_fluid_agree_max(f, function, status, 1, &more);
  if (status == MPS_OK && more > 0.0) status = join(f, function, &s->near, is_guest);
  if (status == MPS_OK && more > 0.0) status = join_back(f, function);
  if (status != MPS_OK) s->count = -1; /* starts again */
  return status;
}

/* ---- exchange -------------------------------------------------------------------------------- */

void mpsi_fluid_send_halo(mps_fluid *f, int32_t columns, double *const *column) {
  if (f->partition) copy(f, &f->partition->near, columns, column, column);
}

void mpsi_fluid_send_all(mps_fluid *f, int32_t columns, double *const *column) {
  if (f->partition) copy(f, &f->partition->all, columns, column, column);
}

void mpsi_fluid_reduce_max(mps_fluid *f, int64_t count, double *values) {
  if (!f->partition) return;
  for (int64_t k = 0; k < count; k++)
    if (isnan(values[k])) values[k] = INFINITY;
  note(f->partition, mpsi_domain_max(f->partition->domain, "mps_fluid", (int32_t)count, values));
  if (f->partition->lost != MPS_OK) memset(values, 0, (size_t)count * sizeof *values);
}

void mpsi_fluid_reduce_exact(mps_fluid *f, int32_t count, mpsi_exact *sums) {
  if (f->partition)
    note(f->partition, mpsi_domain_sum_exact(f->partition->domain, "mps_fluid", count, sums));
}

/* A sum is on its rank, and below any number on others; a NaN must not be sent. */
void mpsi_fluid_send_sums(mps_fluid *f, int64_t unit) {
  if (!f->partition) return;
  const int64_t units = (f->count + unit - 1) / unit;
  double *sums = f->system.sums;
  for (int64_t k = 0; k < 2 * units; k++)
    if (!is_own(f, k / 2 * unit)) sums[k] = -INFINITY;
  mpsi_fluid_reduce_max(f, 2 * units, sums);
}

/* In scratch columns, which the pressure has not begun to use: z states and numbers, u_new[0] and q
 * m, r h. */
void mpsi_fluid_send_moments(mps_fluid *f) {
  mpsi_fluid_partition *s = f->partition;
  if (!s) return;
  mpsi_fluid_system *y = &f->system;
  for (int64_t i = f->own[0]; i < f->own[1]; i++) {
    y->z[i] = f->state[i] + 4.0 * f->near[i];
    f->u_new[0][i] = f->local[i].m[0], y->q[i] = f->local[i].m[1], y->r[i] = f->local[i].h;
  }
  mpsi_fluid_send_all(f, 1, &y->z);
  mpsi_fluid_send_halo(f, 3, (double *const[]){f->u_new[0], y->q, y->r});
  for (int64_t k = 0; s->lost == MPS_OK && k < s->all.guests; k++) {
    const int64_t i = s->all.guest[k], word = (int64_t)y->z[i];
    f->state[i] = (uint8_t)(word % 4), f->near[i] = (uint16_t)(word / 4);
  }
  for (int64_t k = 0; k < s->near.guests; k++) {
    const int64_t i = s->near.guest[k];
    f->local[i].m[0] = f->u_new[0][i], f->local[i].m[1] = y->q[i], f->local[i].h = y->r[i];
    s->mark[k] = atomic_load_explicit(&f->zone[i], memory_order_relaxed);
  }
  /* several ranks may have copies of a particle: applied in turn */
  double *in = s->back.in;
  if (s->lost == MPS_OK) note(s, mpsi_halo_begin(s->back.halo, "mps_fluid", 1, &s->mark));
  if (s->lost == MPS_OK) note(s, mpsi_halo_end(s->back.halo, "mps_fluid", &in));
  for (int64_t k = 0; s->lost == MPS_OK && k < s->back.guests; k++)
    if (in[k] > 0.0) atomic_store_explicit(&f->zone[s->back.guest[k]], 1, memory_order_relaxed);
}

/* In columns that the pressure no longer needs, and velocities not yet. */
void mpsi_fluid_send_flux(mps_fluid *f) {
  mpsi_fluid_partition *s = f->partition;
  if (!s) return;
  mpsi_fluid_system *y = &f->system;
  double *const column[] = {f->u_new[0], y->q, y->r, y->z, y->diagonal};
  for (int c = 0; c < 5; c++)
    for (int64_t i = f->own[0]; i < f->own[1]; i++) column[c][i] = f->flux[c][i];
  mpsi_fluid_send_halo(f, 5, column);
  for (int c = 0; c < 5; c++)
    for (int64_t k = 0; s->lost == MPS_OK && k < s->near.guests; k++)
      f->flux[c][s->near.guest[k]] = (float)column[c][s->near.guest[k]];
}

static void send_fill(mps_fluid *f) {
  const mpsi_fluid_partition *s = f->partition;
  double *fill = f->system.z;
  for (int64_t i = f->own[0]; i < f->own[1]; i++) fill[i] = mpsi_fluid_fill(f, i);
  mpsi_fluid_send_all(f, 1, &fill);
  for (int64_t k = 0; s->lost == MPS_OK && k < s->all.guests; k++)
    mpsi_fluid_pore_of(f, s->all.guest[k])->fill = fill[s->all.guest[k]];
}

void mpsi_fluid_send_local(mps_fluid *f) {
  mpsi_fluid_partition *s = f->partition;
  if (!s || s->knows_local) return;
  mpsi_fluid_system *y = &f->system;
  double *const column[] = {f->u_new[0], y->q, y->r, y->z}; /* free but in the solution */
  for (int64_t i = f->own[0]; i < f->own[1]; i++) {
    const mpsi_fluid_local *l = &f->local[i];
    column[0][i] = l->n, column[1][i] = l->m[0], column[2][i] = l->m[1], column[3][i] = l->h;
  }
  mpsi_fluid_send_all(f, 4, column);
  for (int64_t k = 0; s->lost == MPS_OK && k < s->all.guests; k++) {
    const int64_t i = s->all.guest[k];
    f->local[i] =
        (mpsi_fluid_local){.n = column[0][i], .m = {column[1][i], column[2][i]}, .h = column[3][i]};
  }
  if (f->rocks) send_fill(f);
  s->knows_local = s->lost == MPS_OK;
}
