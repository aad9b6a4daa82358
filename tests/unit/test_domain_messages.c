/* test_domain_messages.c - how much ranks of WLS-MPM exchange in a step, counted, so that
 * it cannot grow unseen: the numbers of docs/cluster.md. SPDX-License-Identifier: BSD-3-Clause */
#include "mpm_ranks.h"
#include "ranks_team.h"

/* A transport that counts what goes through another. */
typedef struct counts {
  int64_t reductions, meetings, copies, bytes; /* bytes of copies that come to this rank */
} counts;
typedef struct counted {
  mps_domain_def inner;
  counts now;
} counted;

static mps_status count_max(void *user, int32_t count, double *values) {
  counted *c = user;
  c->now.reductions++;
  return c->inner.reduce_max(c->inner.user, count, values);
}

static mps_status count_sum(void *user, int32_t count, int64_t *values) {
  counted *c = user;
  c->now.reductions++;
  return c->inner.reduce_sum(c->inner.user, count, values);
}

static mps_status count_meeting(void *user, int32_t count, const mps_domain_message *messages,
                                mps_domain_room_fn room, void *room_user) {
  counted *c = user;
  c->now.meetings++;
  return c->inner.rendezvous(c->inner.user, count, messages, room, room_user);
}

static mps_status make_star(void *user, int64_t own, int64_t guests, const int32_t *rank,
                            const int64_t *index, void **star) {
  const counted *c = user;
  return c->inner.star_create(c->inner.user, own, guests, rank, index, star);
}

static mps_status count_copy(void *user, void *star, int32_t item_bytes, const void *own,
                             void *guests) {
  counted *c = user;
  c->now.copies++;
  c->now.bytes += item_bytes * ((const team_star *)star)->guests;
  return c->inner.star_begin(c->inner.user, star, item_bytes, own, guests);
}

static mps_status end_copy(void *user, void *star) {
  const counted *c = user;
  return c->inner.star_end(c->inner.user, star);
}

static void drop_star(void *user, void *star) {
  const counted *c = user;
  c->inner.star_destroy(c->inner.user, star);
}

static mps_domain_def counting(counted *c) {
  mps_domain_def def = c->inner;
  def.user = c;
  def.reduce_max = count_max, def.reduce_sum = count_sum;
  def.rendezvous = count_meeting;
  def.star_create = make_star, def.star_begin = count_copy, def.star_end = end_copy;
  def.star_destroy = drop_star;
  def.max_begin = NULL, def.max_end = NULL, def.max_leave = NULL;
  return def;
}

/* ---- steps ----------------------------------------------------------------------------------- */

enum { STEPS = 10 };

/* Two calls that differ by STEPS steps, none of which is followed by a sort. */
typedef struct measured {
  int what;
  mps_status status[TEAM_MOST];
  counts step[TEAM_MOST]; /* of STEPS steps */
  bool sorted[TEAM_MOST];
} measured;

static counts call(mps_mpm *mpm, const counted *c, int64_t steps, mps_status *so_far) {
  const counts before = c->now;
  mps_status status = *so_far;
  TRY(mps_mpm_step(mpm, steps));
  *so_far = status;
  return (counts){c->now.reductions - before.reductions, c->now.meetings - before.meetings,
                  c->now.copies - before.copies, c->now.bytes - before.bytes};
}

/* At rest, so that nothing is sorted. */
static void measure(void *user, team *t, int32_t rank) {
  measured *m = user;
  counted c = {.inner = team_domain_def(t, rank)};
  scoped_context *own = team_context(MPS_CONTEXT_EXECUTOR_SERIAL, 1);
  const mps_domain_def def = counting(&c);
  scoped_domain *domain = NULL;
  SCOPED(end_scene) scene s = {.set = NULL};
  mps_status status = mps_domain_create(own, &def, &domain);
  TRY(make_scene(own, domain, m->what, &s));
  TRY(mps_particles_set(s.set, "velocity", 0, 0.0));
  TRY(mps_mpm_step(s.mpm, 4)); /* all bodies are in contact */
  const uint64_t epoch = s.set ? mps_particles_epoch(s.set) : 0;
  const counts few = call(s.mpm, &c, 1, &status), many = call(s.mpm, &c, 1 + STEPS, &status);
  m->step[rank] = (counts){many.reductions - few.reductions, many.meetings - few.meetings,
                           many.copies - few.copies, many.bytes - few.bytes};
  m->sorted[rank] = s.set && mps_particles_epoch(s.set) != epoch;
  m->status[rank] = status;
}

static measured run(int what, int32_t size) {
  measured m = {.what = what};
  team_compute(size, measure, &m);
  for (int32_t r = 0; r < size; r++) {
    assert_int_equal(m.status[r], MPS_OK);
    assert_false(m.sorted[r]);
  }
  return m;
}

/* Each rank's, a step; `rare` reductions and copies more in all steps together. */
static void expect(int what, int64_t reductions, int64_t rare, int64_t meetings, int64_t copies,
                   int64_t bytes) {
  for (int32_t size = 2; size <= 3; size++) {
    const measured m = run(what, size);
    for (int32_t r = 0; r < size; r++) {
      const counts *step = &m.step[r];
      assert_in_range(step->reductions, 1, reductions * STEPS + rare);
      assert_in_range(step->meetings, 0, meetings * STEPS);
      assert_in_range(step->copies, 1, copies * STEPS + rare);
      assert_in_range(step->bytes, 1, bytes * STEPS);
    }
  }
}

/* A message to the neighbours and a reduction. */
TEST(test_alone) { expect(SLIDE, 1, 0, 0, 1, 40000); }

/* Bodies by impulses: what is reached and the tiles; ready, partners, contacts, loads and the end,
 * with how much the sweeps have left; twice the filter of the sand's stress, each eighth step. */
TEST(test_bodies) {
  /* of the ten reductions one agrees on the memory of the state that a fast step saves, and four on
   * the particles that bear at the inset edges of two bodies, eight each */
  expect(PILES, 10, 2 * (STEPS / 8), 1, 2, 60000);
}
