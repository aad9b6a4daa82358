/* test_fill_faces.c - fills are made of whole lattice sites: where a face, an edge or a ball asked
 * for is another size than what is made, a warning says both; where they agree there is none,
 * whatever the round-off of the caller's numbers and the origin. SPDX-License-Identifier:
 * BSD-3-Clause */
#include "test_common.h"

static mps_context *context;
static char warning[512];

static void listen(void *user, int32_t level, const char *text) {
  if (level == MPS_CONTEXT_LOG_WARNING) snprintf(warning, sizeof warning, "%s", text);
}

static mps_particles *empty(int32_t dim, double spacing, double origin) {
  DEF(particles, def, .dim = dim, .spacing = spacing);
  for (int c = 0; c < dim; c++) def.origin[c] = origin;
  MAKE_KEPT(particles, set, create, context, &def);
  warning[0] = '\0';
  return set;
}

static int64_t box(mps_particles *set, double x0, double y0, double x1, double y1) {
  int64_t made = 0;
  warning[0] = '\0';
  OK(mps_particles_fill_box(set, AT(x0, y0, 0.0), AT(x1, y1, mps_particles_spacing(set)), &made));
  return made;
}

TEST(boxes_off_the_lattice_are_warned_of) {
  static const double wide[3] = {1.04, 1.06, 0.96};
  static const int64_t made[3] = {50, 55, 50};
  static const char *const says[3] = {"made x 0 to 1,", "made x 0 to 1.1,", "made x 0 to 1,"};
  for (int k = 0; k < 3; k++) {
    scoped_particles *set = empty(2, 0.1, 0.0);
    assert_int_equal(box(set, 0.0, 0.0, wide[k], 0.5), made[k]);
    char number[32];
    snprintf(number, sizeof number, "x 0 to %g", wide[k]);
    assert_non_null(strstr(warning, number));
    if (!strstr(warning, says[k])) fail_msg("%s is not in: %s", says[k], warning);
  }
  /* a box that is moved by less than a site is not moved */
  scoped_particles *set = empty(2, 0.1, 0.0);
  assert_int_equal(box(set, 0.03, 0.0, 1.03, 0.5), 50);
  assert_non_null(strstr(warning, "x 0.03 to 1.03"));
  assert_non_null(strstr(warning, "up to 0.3 spacings off"));
  mps_particles_destroy(&set);
  /* the origin moves the lattice */
  set = empty(2, 0.1, 0.03);
  assert_int_equal(box(set, 0.03, 0.03, 1.03, 0.53), 50);
  assert_true(warning[0] == '\0');
  mps_particles_destroy(&set);
  /* the third axis counts */
  set = empty(3, 0.1, 0.0);
  OK(mps_particles_fill_box(set, AT(0.0, 0.0, 0.0), AT(1.0, 0.5, 0.26), NULL));
  assert_non_null(strstr(warning, "z 0 to 0.26"));
}

TEST(boxes_on_it_are_not) {
  static const double spacings[5] = {0.1, 1.0 / 3.0, 0.015, 1e-3, 0.7};
  for (int s = 0; s < 5; s++)
    for (int shift = 0; shift < 5; shift++) {
      static const double origins[5] = {0.0, 0.1, -17.3, 1e4, 1.0 / 7.0};
      const double D = spacings[s], origin = origins[shift];
      scoped_particles *set = empty(2, D, origin);
      for (int i = -20; i <= 20; i += 4) {
        double sum = origin; /* edges by sums and products, as callers compute them */
        for (int k = 0; k < 30; k++) sum += D;
        (void)box(set, origin + i * D, origin + (i + 1) * D, sum, origin + (i + 3) * D);
        if (warning[0]) fail_msg("%s", warning);
      }
    }
}

TEST(edges_along_an_axis_are_looked_at) {
  scoped_particles *set = empty(2, 0.1, 0.0);
  const double ramp[8] = {0, 0, 1.0, 0, 0.5, 0.5, 0, 0.5},
               odd[8] = {2, 0, 3.0, 0, 2.5, 0.44, 2, 0.44};
  OK(mps_particles_fill_polygon(set, 4, ramp, NULL));
  assert_true(warning[0] == '\0'); /* an oblique edge is stairs */
  OK(mps_particles_fill_polygon(set, 4, odd, NULL));
  assert_non_null(strstr(warning, "the edge at y = 0.44 m is made at 0.4 m"));
}

TEST(small_balls_are_another_size) {
  scoped_particles *set = empty(2, 0.1, 0.0);
  const double here[2] = {0.0, 0.0}, there[2] = {5.0, 0.0};
  OK(mps_particles_fill_ball(set, here, 1.0, NULL));
  assert_true(warning[0] == '\0');
  mps_particles_destroy(&set);
  set = empty(2, 0.1, 0.0);
  OK(mps_particles_fill_ball(set, there, 0.1, NULL));
  assert_non_null(strstr(warning, "the ball asked for has 0.0314159 m2, the one made 0.04"));
}

static mps_status everywhere(void *user, const double *x, int32_t *inside) {
  *inside = 1;
  return MPS_OK;
}

/* The box of a predicate only bounds the sites that are asked about. */
TEST(a_predicate_has_its_own_faces) {
  scoped_particles *set = empty(2, 0.1, 0.0);
  const double lo[2] = {0.03, 0.0}, hi[2] = {1.07, 0.5};
  OK(mps_particles_fill_where(set, lo, hi, everywhere, NULL, NULL));
  assert_true(warning[0] == '\0');
}

static int make(void **state) {
  mps_context_def def = test_context_defaults();
  (void)state;
  def.log = listen;
  OK(mps_context_create(&def, &context, NULL, 0));
  return 0;
}

static int drop(void **state) {
  mps_context_destroy(&context);
  return 0;
}

TEST_GROUP(make, drop)
