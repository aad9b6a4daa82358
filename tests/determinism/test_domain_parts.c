/* test_domain_parts.c - sets that lie in parts on the ranks from the first fill on: the parts
 * together are the set of one process, WLS-MPM on them has its bits, no rank ever has memory for
 * more than its part, and what does not fit together is refused on all ranks.
 * SPDX-License-Identifier: BSD-3-Clause */
#define RANKS_IN_PARTS true
#include "mpm_ranks.h"
#include "ranks_memory.h"
#include "ranks_team.h"

/* ---- fills ----------------------------------------------------------------------------------- */

enum { PLANE, SPACE, TALL };

static mps_status above_wave(void *user, const double *x, int32_t *inside) {
  *inside = x[1] > 1.0 + 0.4 * sin(9.0 * x[0]);
  return MPS_OK;
}

/* Shapes that overlap and single particles; fewer of these than ranks. */
static mps_status fill(mps_particles *set, int what) {
  const double lo[3] = {0.0, 0.0, 0.0}, hi[3] = {1.3, 0.61, 0.5};
  const double high[3] = {0.2, 2.0, 0.3}, middle[3] = {0.65, 0.6, 0.2};
  const double here[3] = {0.0, 0.4, 0.0}, there[3] = {1.0, 1.7, 0.1};
  const double corners[8] = {1.0, 0.0, 2.2, 0.1, 1.9, 1.4, 1.2, 0.9};
  const double drops[6] = {3.0, 3.1, 3.2, 3.3, 3.4, 3.5};
  const int32_t dim = mps_particles_dim(set);
  mps_status status = mps_particles_fill_box(set, lo, what == TALL ? high : hi, NULL);
  TRY(mps_particles_append(set, 6 / dim, drops));
  TRY(mps_particles_fill_ball(set, middle, 0.4, NULL));
  TRY(mps_particles_fill_where(set, here, there, above_wave, NULL, NULL));
  if (dim == 2) TRY(mps_particles_fill_polygon(set, 4, corners, NULL));
  TRY(mps_particles_fill_box(set, lo, what == TALL ? high : hi, NULL)); /* adds none */
  return status;
}

static mps_status compute_fills(mps_context *own, mps_domain *domain, int what, int64_t length,
                                result *r) {
  DEF(particles, def, .dim = what == SPACE ? 3 : 2, .spacing = 0.05);
  scoped_particles *set = NULL;
  mps_status status = domain ? mps_domain_create_particles(domain, &def, &set)
                             : mps_particles_create(own, &def, &set);
  (void)length;
  TRY(fill(set, what));
  TRY(keep(set, r));
  for (int64_t k = 0; status == MPS_OK && k < r->count; k++)
    if (mps_particles_index(set, r->id[k]) != k) status = MPS_ERROR_INTERNAL;
  return status;
}

TEST(test_fills) {
  for (int what = PLANE; what <= TALL; what++) compare_teams(compute_fills, what, 0, false);
}

/* Of each fill every rank has the same number, but for one. */
TEST(test_even) {
  ranks s = {.compute = compute_fills, .what = PLANE, .threads = 1};
  int64_t least = INT64_MAX, most = 0;
  run_team(&s, 7);
  for (int32_t r = 0; r < 7; r++) {
    if (s.rank[r].status != MPS_OK) fail_msg("rank %d: %s", (int)r, s.rank[r].message);
    least = s.rank[r].count < least ? s.rank[r].count : least;
    most = s.rank[r].count > most ? s.rank[r].count : most;
    drop(&s.rank[r]);
  }
  assert_true(most - least <= 5); /* additions */
}

/* ---- WLS-MPM --------------------------------------------------------------------------------- */

TEST(test_slide) { compare_teams(compute, SLIDE, 60, false); }
TEST(test_spread) { compare_teams(compute, SPREAD, 60, true); }
TEST(test_ring) { compare_teams(compute, RING, 30, true); }
TEST(test_room) { compare_teams(compute, ROOM, 30, true); }
TEST(test_press) { compare_teams(compute, PRESS, 45, true); }
TEST(test_changes) { compare_teams(compute_changes, SPREAD, 24, true); }

TEST(test_refused_memory) { refuse_memory(compute, SLIDE, 4, 11); }

/* ---- fields of the caller's own ---------------------------------------------------------------
 */

/* Number and place of each particle, in "user.tag". */
static mps_status put_tags(mps_particles *set) {
  const int64_t n = mps_particles_count(set);
  double *tags = malloc((size_t)n * 2 * sizeof *tags + 1);
  mps_view id, x;
  mps_status status = mps_particles_add_field(set, "user.tag", 2);
  TRY(mps_particles_view(set, "id", &id));
  TRY(mps_particles_view(set, "position", &x));
  for (int64_t k = 0; status == MPS_OK && k < n; k++)
    tags[2 * k] = (double)*mps_view_i64(&id, k, 0), tags[2 * k + 1] = *mps_view_f64(&x, k, 0);
  TRY(mps_particles_set_array(set, "user.tag", -1, tags, n));
  free(tags);
  return status;
}

/* A copy has the rank's particles, and outlives nothing that it needs. */
static mps_status compare_copy(mps_particles *set) {
  scoped_particles *copy = NULL;
  mps_view id, tag, velocity;
  mps_status status = mps_particles_copy(set, &copy);
  TRY(mps_particles_view(set, "id", &id));
  TRY(mps_particles_view(copy, "user.tag", &tag));
  TRY(mps_particles_view(copy, "velocity", &velocity));
  if (status == MPS_OK && mps_particles_count(copy) != id.shape[0]) return MPS_ERROR_INTERNAL;
  for (int64_t k = 0; status == MPS_OK && k < id.shape[0]; k++) {
    const int64_t number = *mps_view_i64(&id, k, 0);
    if (mps_particles_index(copy, number) != k || *mps_view_f64(&tag, k, 0) != (double)number)
      status = MPS_ERROR_INTERNAL;
  }
  TRY(mps_particles_set_array(set, "velocity", 0, mps_view_f64(&velocity, 0, 0), id.shape[0]));
  return status;
}

static mps_status compute_tags(mps_context *own, mps_domain *domain, int what, int64_t steps,
                               result *r) {
  SCOPED(end_scene) scene s = {.set = NULL};
  mps_status status = make_scene(own, domain, what, &s);
  r->first = s.set ? mps_particles_count(s.set) : 0;
  TRY(mps_mpm_step(s.mpm, steps / 4));
  TRY(put_tags(s.set));
  TRY(mps_particles_add_field(s.set, "user.gone", 3));
  TRY(mps_mpm_step(s.mpm, steps / 2));
  TRY(compare_copy(s.set));
  TRY(mps_particles_remove_field(s.set, "user.gone"));
  TRY(mps_mpm_step(s.mpm, steps / 4));
  TRY(keep_scene(domain, what, &s, r));
  return status;
}

TEST(test_tags) { compare_teams(compute_tags, SPREAD, 60, false); }

/* A field that one rank alone has removed. */
static mps_status remove_alone(mps_context *own, mps_domain *domain, int what, int64_t steps,
                               result *r) {
  (void)r;
  SCOPED(end_scene) scene s = {.set = NULL};
  mps_status status = make_scene(own, domain, what, &s);
  TRY(put_tags(s.set));
  TRY(mps_mpm_step(s.mpm, 2));
  if (mps_domain_rank(domain) == 1) TRY(mps_particles_remove_field(s.set, "user.tag"));
  TRY(mps_mpm_step(s.mpm, steps));
  return status;
}

TEST(test_removed_alone) {
  ranks s = {.compute = remove_alone, .what = SPREAD, .length = 60, .threads = 1};
  run_team(&s, 3);
  for (int32_t r = 0; r < 3; r++)
    if (s.rank[r].status != MPS_ERROR_ARGUMENT ||
        !strstr(s.rank[r].message, "the number of columns of a particle"))
      fail_msg("rank %d: %d %s", (int)r, (int)s.rank[r].status, s.rank[r].message);
}

/* ---- memory ---------------------------------------------------------------------------------- */

typedef struct creation { /* by rank: bytes beside those of the solver when it is made; particles */
  int64_t beside[TEAM_MOST], here[TEAM_MOST];
} creation;

static mps_status begin_wide(mps_context *own, mps_domain *domain, const peak_allocator *allocator,
                             void *user) {
  creation *made = user;
  const int32_t rank = domain ? mps_domain_rank(domain) : 0;
  SCOPED(end_scene) scene s = {.set = NULL};
  mps_status status = make_set(own, domain, WIDE, &s.set);
  mps_mpm_def def = scene_def(domain, WIDE);
  TRY(mps_material_create_linear_elastic(own, 1e6, 0.3, &s.material[0]));
  if (domain) status = mps_domain_agree(domain, status);
  TRY(mps_mpm_create(own, s.set, s.material[0], &def, &s.mpm));
  made->beside[rank] = allocator->most - allocator->now;
  made->here[rank] = mps_particles_count(s.set);
  TRY(mps_mpm_step(s.mpm, 2));
  return status;
}

TEST(test_memory) {
  creation made = {.here = {0}};
  if (test_races()) skip();
  const int64_t one = memory_most(1, begin_wide, &made), four = memory_most(4, begin_wide, &made);
  /* ids, places, densities and velocities are not copied to make the solver: 48 B a particle */
  for (int r = 0; r < 4; r++) assert_true(made.beside[r] < 24 * made.here[r]);
  print_message("9600 particles: at most %lld bytes on one rank, %lld on each of 4: %.3f\n",
                (long long)one, (long long)four, (double)four / (double)one);
  /* with the columns of the state before the last step */
  assert_true((double)four < 0.45 * (double)one);
}

/* ---- what is refused ------------------------------------------------------------------------- */

enum { FILLS, POSITIONS, CONSTANTS, FIELDS, SPACINGS, WHOLE, ALONE, DYNAMICS, FLUID, REFUSED };

static mps_status refused(mps_context *own, mps_domain *domain, int what, int64_t length,
                          result *r) {
  const bool odd = mps_domain_rank(domain) == 1;
  const double lo[2] = {0.0, 0.0}, hi[2] = {1.0, what == FILLS && odd ? 0.9 : 1.0};
  const double drop[2] = {2.0, what == POSITIONS && odd ? 2.1 : 2.0};
  scoped_material *material = NULL;
  scoped_particles *set = NULL;
  scoped_mpm *mpm = NULL;
  mps_dynamics *dynamics = NULL;
  mps_fluid *fluid = NULL;
  (void)length, (void)r;
  DEF(particles, def, .spacing = what == SPACINGS && odd ? 0.11 : 0.1);
  mps_status status = mps_domain_create_particles(domain, &def, &set);
  TRY(mps_particles_fill_box(set, lo, hi, NULL));
  TRY(mps_particles_append(set, 1, drop));
  if (what == WHOLE && odd && status == MPS_OK) {
    mps_particles_destroy(&set);
    status = mps_particles_create(own, &def, &set);
    TRY(mps_particles_fill_box(set, lo, hi, NULL));
  }
  if (what == FIELDS && odd) TRY(mps_particles_add_field(set, "stress", 0));
  TRY(mps_particles_set(set, "density", 0, what == CONSTANTS && odd ? 1001.0 : 1000.0));
  TRY(mps_material_create_linear_elastic(own, 1e6, 0.3, &material));
  DEF(mpm, solver, .cell = 0.2);
  if (what != ALONE) solver.domain = domain;
  const int64_t count = mps_particles_count(set);
  mps_dynamics_def waves = mps_dynamics_defaults();
  mps_fluid_def water = mps_fluid_defaults();
  if (what == DYNAMICS)
    TRY(mps_dynamics_create(own, set, &waves, &dynamics));
  else if (what == FLUID) /* a solver that takes no set in parts */
    TRY(mps_fluid_create(own, set, &water, &fluid));
  else
    TRY(mps_mpm_create(own, set, material, &solver, &mpm));
  if (mpm || dynamics || fluid || (what == ALONE && mps_particles_count(set) != count))
    status = MPS_ERROR_INTERNAL;
  return status;
}

TEST(test_refused) {
  static const struct {
    mps_status status;
    const char *words;
  } expected[REFUSED] = {
      [FILLS] = {MPS_ERROR_ARGUMENT, "the number of particles that are added is"},
      [POSITIONS] = {MPS_ERROR_ARGUMENT, "a hash of the positions of the added particles is"},
      [CONSTANTS] = {MPS_ERROR_ARGUMENT, "a hash of the constants given by mps_particles_set is"},
      [FIELDS] = {MPS_ERROR_ARGUMENT, "the number of fields of the set is"},
      [SPACINGS] = {MPS_ERROR_ARGUMENT, "spacing is"},
      [WHOLE] = {MPS_ERROR_ARGUMENT, "whether the set is in parts"},
      [ALONE] = {MPS_ERROR_STATE, "the others on 2 other ranks (mps_domain_create_particles)"},
      [DYNAMICS] = {MPS_ERROR_STATE, "the others on 2 other ranks (mps_domain_create_particles)"},
      [FLUID] = {MPS_ERROR_STATE, "the others on 2 other ranks (mps_domain_create_particles)"}};
  for (int what = 0; what < REFUSED; what++) {
    ranks s = {.compute = refused, .what = what, .threads = 1};
    run_team(&s, 3);
    for (int32_t r = 0; r < 3; r++) {
      if (s.rank[r].status != expected[what].status ||
          !strstr(s.rank[r].message, expected[what].words))
        fail_msg("case %d, rank %d: %d %s", what, (int)r, (int)s.rank[r].status, s.rank[r].message);
      assert_int_equal(s.allocator[r].live, 0);
    }
  }
}
