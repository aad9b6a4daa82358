/* domain_threads.h - a transport for domains whose ranks are threads of one process, each with a
 * context of its own: for tests with sanitizers, allocations that are refused and partners that are
 * lost. Where every rank waits for another, or has ended, all waits end with an error on all ranks:
 * that is found without a clock, however slow the machine. Ranks read one another's memory;
 * one that ends early waits until no rank reads. SPDX-License-Identifier: BSD-3-Clause */
#ifndef MPS_TEST_DOMAIN_THREADS_H
#define MPS_TEST_DOMAIN_THREADS_H

#include "test_common.h"

#include <pthread.h>

#define TEAM_MOST 16
#define TEAM_STARS 256

typedef struct team team;
enum { MEET_RENDEZVOUS, MEET_MAX, MEET_SUM };

/* One rank's end. */
typedef struct team_member {
  team *team;
  int32_t rank;
  int32_t stars;   /* made so far: the next one's number */
  int64_t turn;    /* meetings so far */
  int64_t calls;   /* of callbacks so far */
  int64_t deaf_at; /* the call from which on it takes no part, from 1; 0: never */
  bool left;       /* takes part in nothing more but by what it has left behind */
  double *last;    /* that */
  /* what the others may read in a meeting */
  int32_t kind, count; /* of the reduction */
  int32_t messages;
  const mps_domain_message *message;
  const double *max;
  const int64_t *sum;
  double *vote; /* its own, between team_max_begin and team_max_end */
  int32_t votes;
  const char *own[TEAM_STARS]; /* items of each star while a copy is under way */
} team_member;

struct team {
  int32_t size;
  pthread_mutex_t lock;
  pthread_cond_t change;
  int64_t turn;    /* meetings that have ended */
  int32_t arrived; /* at the present one */
  int32_t left;    /* ranks that are always there: they have left */
  bool mixed;      /* ranks were in different callbacks */
  bool lost;       /* every rank was waiting, or has ended */
  int64_t changes; /* of what ranks wait for; each of them has waited since change `seen` of it */
  int64_t seen[TEAM_MOST];
  bool asleep[TEAM_MOST], ended[TEAM_MOST];
  bool silent;     /* a rank takes no part any more: its memory must not be read */
  int32_t readers; /* ranks that read others' memory now */
  bool posted[TEAM_STARS][TEAM_MOST];
  int32_t copied[TEAM_STARS];
  team_member member[TEAM_MOST];
};

typedef struct team_star {
  int32_t number, item_bytes;
  int64_t guests;
  int32_t *rank;
  int64_t *index;
  char *to;
} team_star;

static inline void team_begin(team *t, int32_t size) {
  memset(t, 0, sizeof *t);
  t->size = size;
  pthread_mutex_init(&t->lock, NULL);
  pthread_cond_init(&t->change, NULL);
  for (int32_t r = 0; r < size; r++) {
    t->member[r].team = t;
    t->member[r].rank = r;
  }
}

static inline void team_end(team *t) {
  for (int32_t r = 0; r < t->size; r++) free(t->member[r].last);
  pthread_cond_destroy(&t->change);
  pthread_mutex_destroy(&t->lock);
}

/* With the lock held, of all of the following. */
static inline void team_changed(team *t) {
  t->changes++;
  pthread_cond_broadcast(&t->change);
}

/* Whether no rank will change anything any more: all have ended, or wait for what has not come with
 * the last change. */
static inline bool team_is_stuck(const team *t) {
  for (int32_t r = 0; r < t->size; r++)
    if (!t->ended[r] && !(t->asleep[r] && t->seen[r] == t->changes)) return false;
  return true;
}

/* Waits until something changes; false where nothing will. */
static inline bool team_wait(team_member *m) {
  team *t = m->team;
  t->seen[m->rank] = t->changes;
  t->asleep[m->rank] = true;
  if (!t->lost && team_is_stuck(t)) t->lost = true;
  if (t->lost)
    team_changed(t);
  else
    pthread_cond_wait(&t->change, &t->lock);
  t->asleep[m->rank] = false;
  return !t->lost;
}

/* Whether this rank still takes part. */
static inline bool team_listens(team_member *m) {
  m->calls++;
  return m->deaf_at == 0 || m->calls < m->deaf_at;
}

/* From here to team_read_end the others' memory stays; false where the team falls apart first. */
static inline bool team_read_begin(team_member *m) {
  team *t = m->team;
  pthread_mutex_lock(&t->lock);
  while (t->silent && team_wait(m)) {
  }
  const bool good = !t->lost;
  if (good) t->readers++;
  pthread_mutex_unlock(&t->lock);
  return good;
}

static inline void team_read_end(team *t) {
  pthread_mutex_lock(&t->lock);
  t->readers--;
  team_changed(t);
  pthread_mutex_unlock(&t->lock);
}

/* This rank ends, and frees its memory once no rank reads it. */
static inline mps_status team_leave(team *t) {
  pthread_mutex_lock(&t->lock);
  t->silent = true;
  while (t->readers > 0) pthread_cond_wait(&t->change, &t->lock);
  pthread_mutex_unlock(&t->lock);
  return MPS_ERROR_IO;
}

/* With the lock held: one more is there; the last one opens the way. */
static inline void team_arrive(team *t) {
  if (++t->arrived == t->size) {
    t->arrived = t->left;
    t->turn++;
  }
  team_changed(t); /* also for ranks that wait for a star */
}

/* All ranks are here. */
static inline mps_status team_meet(team_member *m) {
  team *t = m->team;
  pthread_mutex_lock(&t->lock);
  const int64_t turn = ++m->turn;
  team_arrive(t);
  while (t->turn < turn && team_wait(m)) {
  }
  const bool good = t->turn >= turn;
  pthread_mutex_unlock(&t->lock);
  return good ? MPS_OK : MPS_ERROR_IO;
}

/* All ranks are here, in the same callback with as many numbers: they may be read. */
static inline mps_status team_open(team_member *m, int32_t kind, int32_t count) {
  team *t = m->team;
  m->kind = kind, m->count = count;
  if (team_meet(m) != MPS_OK || !team_read_begin(m)) return MPS_ERROR_IO;
  bool same = true;
  for (int32_t r = 0; r < t->size; r++)
    same = same && t->member[r].kind == kind && t->member[r].count == count;
  if (same) return MPS_OK;
  team_read_end(t);
  pthread_mutex_lock(&t->lock);
  t->mixed = t->lost = true;
  team_changed(t);
  pthread_mutex_unlock(&t->lock);
  return MPS_ERROR_IO;
}

static inline mps_status team_rendezvous(void *user, int32_t count,
                                         const mps_domain_message *message, mps_domain_room_fn room,
                                         void *room_user) {
  team_member *m = user;
  bool refused = false;
  if (!team_listens(m)) return team_leave(m->team);
  m->message = message;
  m->messages = count;
  if (team_open(m, MEET_RENDEZVOUS, 0) != MPS_OK) return team_leave(m->team);
  for (int32_t r = 0; r < m->team->size; r++) {
    const team_member *from = &m->team->member[r];
    for (int32_t k = 0; k < from->messages; k++) {
      if (from->message[k].rank != m->rank) continue;
      void *to = room(room_user, r, from->message[k].bytes);
      if (to && from->message[k].bytes > 0)
        memcpy(to, from->message[k].data, (size_t)from->message[k].bytes);
      refused = refused || !to;
    }
  }
  team_read_end(m->team);
  if (team_meet(m) != MPS_OK) return team_leave(m->team);
  return refused ? MPS_ERROR_MEMORY : MPS_OK;
}

static inline mps_status team_max(void *user, int32_t count, double *values) {
  team_member *m = user;
  if (!team_listens(m)) return team_leave(m->team);
  m->max = values;
  if (team_open(m, MEET_MAX, count) != MPS_OK) return team_leave(m->team);
  double *most = malloc((size_t)count * sizeof *most + 8);
  for (int32_t k = 0; k < count; k++) {
    most[k] = values[k];
    for (int32_t r = 0; r < m->team->size; r++) most[k] = fmax(most[k], m->team->member[r].max[k]);
  }
  team_read_end(m->team);
  const mps_status status = team_meet(m);
  if (status == MPS_OK && count > 0) memcpy(values, most, (size_t)count * sizeof *most);
  free(most);
  return status == MPS_OK ? MPS_OK : team_leave(m->team);
}

/* In two parts, of which the second does it all; teams of two have no parts. */
static inline mps_status team_max_begin(void *user, int32_t count, double *values) {
  team_member *m = user;
  m->vote = values, m->votes = count;
  return MPS_OK;
}
static inline mps_status team_max_end(void *user) {
  const team_member *m = user;
  return team_max(user, m->votes, m->vote);
}

/* What it gives is there for ever. */
static inline mps_status team_max_leave(void *user, int32_t count, const double *values) {
  team_member *m = user;
  team *t = m->team;
  if (!team_listens(m)) return team_leave(t);
  pthread_mutex_lock(&t->lock);
  m->last = malloc((size_t)count * sizeof *values + 8);
  memcpy(m->last, values, (size_t)count * sizeof *values);
  m->max = m->last, m->kind = MEET_MAX, m->count = count;
  m->left = true;
  t->left++;
  m->turn = INT64_MAX;
  team_arrive(t);
  pthread_mutex_unlock(&t->lock);
  return MPS_OK;
}

static inline mps_status team_sum(void *user, int32_t count, int64_t *values) {
  team_member *m = user;
  if (!team_listens(m)) return team_leave(m->team);
  m->sum = values;
  if (team_open(m, MEET_SUM, count) != MPS_OK) return team_leave(m->team);
  uint64_t *sum = calloc((size_t)count + 1, sizeof *sum);
  for (int32_t k = 0; k < count; k++)
    for (int32_t r = 0; r < m->team->size; r++) sum[k] += (uint64_t)m->team->member[r].sum[k];
  team_read_end(m->team);
  const mps_status status = team_meet(m);
  if (status == MPS_OK && count > 0) memcpy(values, sum, (size_t)count * sizeof *sum);
  free(sum);
  return status == MPS_OK ? MPS_OK : team_leave(m->team);
}

static inline mps_status team_star_create(void *user, int64_t own, int64_t guests,
                                          const int32_t *rank, const int64_t *index, void **out) {
  team_member *m = user;
  (void)own;
  if (!team_listens(m) || m->stars == TEAM_STARS) return team_leave(m->team);
  team_star *star = calloc(1, sizeof *star);
  star->number = m->stars++;
  star->guests = guests;
  star->rank = malloc((size_t)guests * sizeof *star->rank + 8);
  star->index = malloc((size_t)guests * sizeof *star->index + 8);
  if (guests > 0) {
    memcpy(star->rank, rank, (size_t)guests * sizeof *star->rank);
    memcpy(star->index, index, (size_t)guests * sizeof *star->index);
  }
  *out = star;
  return MPS_OK;
}

static inline mps_status team_star_begin(void *user, void *handle, int32_t item_bytes,
                                         const void *own, void *guests) {
  team_member *m = user;
  team *t = m->team;
  team_star *star = handle;
  if (!team_listens(m)) return team_leave(t);
  star->item_bytes = item_bytes;
  star->to = guests;
  pthread_mutex_lock(&t->lock);
  m->own[star->number] = own;
  t->posted[star->number][m->rank] = true;
  team_changed(t);
  pthread_mutex_unlock(&t->lock);
  return MPS_OK;
}

/* Takes the items of ranks that have posted theirs, and waits until all have taken this one's. */
static inline mps_status team_star_end(void *user, void *handle) {
  team_member *m = user;
  team *t = m->team;
  const team_star *star = handle;
  bool good = team_listens(m);
  pthread_mutex_lock(&t->lock);
  for (int32_t r = 0; good && r < t->size; r++)
    while (good && !t->posted[star->number][r]) {
      const bool elsewhere = t->member[r].turn > t->turn; /* it waits for this one too */
      t->mixed = t->mixed || elsewhere;
      t->lost = t->lost || elsewhere;
      good = team_wait(m);
    }
  pthread_mutex_unlock(&t->lock);
  good = good && team_read_begin(m);
  for (int64_t k = 0; good && k < star->guests; k++)
    memcpy(star->to + k * star->item_bytes,
           t->member[star->rank[k]].own[star->number] + star->index[k] * star->item_bytes,
           (size_t)star->item_bytes);
  if (good) team_read_end(t);
  pthread_mutex_lock(&t->lock);
  if (good && ++t->copied[star->number] == t->size) {
    t->copied[star->number] = 0;
    memset(t->posted[star->number], 0, sizeof t->posted[star->number]);
    team_changed(t);
  }
  while (good && t->posted[star->number][m->rank]) good = team_wait(m);
  pthread_mutex_unlock(&t->lock);
  return good ? MPS_OK : team_leave(t);
}

static inline void team_star_destroy(void *user, void *handle) {
  team_star *star = handle;
  (void)user;
  free(star->rank);
  free(star->index);
  free(star);
}

static inline mps_domain_def team_domain_def(team *t, int32_t rank) {
  DEF(domain, def, .rank = rank, .size = t->size, .user = &t->member[rank],
      .rendezvous = team_rendezvous, .star_create = team_star_create, .star_begin = team_star_begin,
      .star_end = team_star_end, .star_destroy = team_star_destroy, .reduce_max = team_max,
      .reduce_sum = team_sum, .max_leave = team_max_leave);
  if (t->size != 2) def.max_begin = team_max_begin, def.max_end = team_max_end;
  return def;
}

/* ---- running --------------------------------------------------------------------------------- */

/* What each rank runs, in its own thread: no assertions there. */
typedef void (*team_fn)(void *user, team *t, int32_t rank);

typedef struct team_thread {
  pthread_t thread;
  team *team;
  int32_t rank;
  team_fn run;
  void *user;
} team_thread;

static inline void *team_thread_main(void *argument) {
  const team_thread *self = argument;
  team *t = self->team;
  self->run(self->user, t, self->rank);
  pthread_mutex_lock(&t->lock);
  t->ended[self->rank] = true;
  team_changed(t); /* waiting ranks see whether they wait for this one */
  pthread_mutex_unlock(&t->lock);
  return NULL;
}

static inline void team_run(team *t, team_fn run, void *user) {
  team_thread thread[TEAM_MOST];
  memset(t->ended, 0, sizeof t->ended);
  for (int32_t r = 0; r < t->size; r++) {
    thread[r] = (team_thread){.team = t, .rank = r, .run = run, .user = user};
    if (pthread_create(&thread[r].thread, NULL, team_thread_main, &thread[r]) != 0) abort();
  }
  for (int32_t r = 0; r < t->size; r++) pthread_join(thread[r].thread, NULL);
}

/* A context for a rank, or NULL. */
static inline mps_context *team_context(int32_t executor, int32_t threads) {
  mps_context_def def = test_context_defaults();
  mps_context *made = NULL;
  def.executor = executor;
  def.threads = threads;
  return mps_context_create(&def, &made, NULL, 0) == MPS_OK ? made : NULL;
}

/* A team of `size` ranks that runs `run` and ends. */
static inline void team_compute(int32_t size, team_fn run, void *user) {
  team t;
  team_begin(&t, size);
  team_run(&t, run, user);
  team_end(&t);
}

#endif
