/* test_domain_parts_dynamics.c - explicit dynamics on sets that lie in parts on the ranks from the
 * first fill on: the bits of one process, and no rank ever has memory for more than its part.
 * SPDX-License-Identifier: BSD-3-Clause */
#define RANKS_IN_PARTS true
#include "test_common.h"

#include "dynamics_scene.h"
#include "ranks_memory.h"

TEST(test_scattered) { compare_teams(compute, SCATTERED, WHOLE_RUN, false); }
TEST(test_periodic) { compare_teams(compute, PERIODIC, WHOLE_RUN, false); }
TEST(test_strip) { compare_teams(compute, STRIP, WHOLE_RUN, true); }

TEST(test_refused_memory) { refuse_memory(compute, PERIODIC, SHORT_RUN, 11); }

/* Two layers that lie apart, a wide and a tall one, and particles at places off the lattice. */
static mps_status compute_two(mps_context *own, mps_domain *domain, int what, int64_t length,
                              result *r) {
  const double lo[2] = {0.0, 0.0}, hi[2] = {120.0, 8.0}, to[2] = {30.0, 40.0};
  const double high[2] = {20.0, 8.5}, loose[6] = {60.1, 8.7, 60.3, 8.7, 70.2, 8.6};
  scoped_particles *set = NULL;
  scoped_dynamics *dynamics = NULL;
  (void)what, (void)length;
  DEF(particles, def, .spacing = 0.5);
  DEF(dynamics, solver, .domain = domain);
  mps_status status = domain ? mps_domain_create_particles(domain, &def, &set)
                             : mps_particles_create(own, &def, &set);
  TRY(mps_particles_fill_box(set, lo, hi, NULL));
  TRY(mps_particles_append(set, 3, loose));
  TRY(mps_particles_fill_box(set, high, to, NULL));
  TRY(give_ground(set, false));
  TRY(mps_dynamics_create(own, set, &solver, &dynamics));
  TRY(mps_dynamics_step(dynamics, 12));
  TRY(mps_dynamics_get_totals(dynamics, &r->totals));
  r->dt = mps_dynamics_dt(dynamics);
  TRY(keep(set, r));
  return status;
}

TEST(test_two) { compare_teams(compute_two, 0, 0, false); }

/* ---- memory ---------------------------------------------------------------------------------- */

/* `user`: upper corner of the body (m). */
static mps_status begin_ground(mps_context *own, mps_domain *domain,
                               const peak_allocator *allocator, void *user) {
  const double *hi = user;
  (void)allocator;
  const double lo[2] = {0.0, 0.0};
  DEF(particles, def, .spacing = 1.0);
  DEF(dynamics, solver, .domain = domain);
  scoped_particles *set = NULL;
  scoped_dynamics *dynamics = NULL;
  mps_status status = domain ? mps_domain_create_particles(domain, &def, &set)
                             : mps_particles_create(own, &def, &set);
  TRY(mps_particles_fill_box(set, lo, hi, NULL));
  TRY(mps_particles_set(set, "density", 0, 1900.0));
  TRY(mps_particles_set(set, "shear_velocity", 0, 200.0));
  TRY(mps_particles_set(set, "pressure_velocity", 0, 400.0));
  TRY(mps_dynamics_create(own, set, &solver, &dynamics));
  TRY(mps_dynamics_step(dynamics, 2));
  return status;
}

static void compare_memory(double width, double height) {
  double hi[2] = {width, height};
  if (test_races()) skip();
  const int64_t one = memory_most(1, begin_ground, hi), four = memory_most(4, begin_ground, hi);
  print_message("%g x %g particles: at most %lld bytes on one rank, %lld on each of 4: %.3f\n",
                width, height, (long long)one, (long long)four, (double)four / (double)one);
  assert_true((double)four < 0.4 * (double)one);
}

TEST(test_memory) { compare_memory(2000.0, 20.0); }

/* Here most blocks have neighbours on both sides, of other ranks. */
TEST(test_memory_square) { compare_memory(200.0, 200.0); }

/* ---- free-field columns ---------------------------------------------------------------------- */

static mps_status columns(mps_context *own, mps_domain *domain, int what, int64_t length,
                          result *r) {
  scoped_particles *set = NULL;
  (void)length, (void)r;
  return make_set(own, domain, what, &set);
}

TEST(test_columns) {
  ranks s = {.compute = columns, .what = LAYERS, .threads = 1};
  run_team(&s, 3);
  for (int32_t r = 0; r < 3; r++) {
    assert_int_equal(s.rank[r].status, MPS_ERROR_STATE);
    assert_non_null(strstr(s.rank[r].message, "mps_domain_create_particles"));
    assert_int_equal(s.allocator[r].live, 0);
  }
}
