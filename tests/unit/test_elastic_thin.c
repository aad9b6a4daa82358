/* test_elastic_thin.c - slender parts of few cells that are solved without `bending` are reported
 * in the log, once a solver; blocks, discs and bodies with a choice are not.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "test_journal.h"

static void hold_lowest(mps_elastic *e, int32_t axis) {
  mps_elastic_boundary_def foot = mps_elastic_boundary_defaults();
  for (int c = 0; c < 3; c++) foot.lower[c] = -INFINITY, foot.upper[c] = INFINITY;
  foot.upper[axis] = 0.1;
  OK(mps_elastic_add_boundary(e, &foot, NULL));
}

/* Warnings of two solutions of boxes of the given cells (z 0: 2D), one beside the other in x and
 * joined at the foot; the last is left in `j`. */
static int warnings(journal *j, double bending, int boxes, const int cells[][3]) {
  *j = (journal){0};
  mps_context *own = journal_context(j, NULL);
  DEF(particles, def, .spacing = 0.1, .dim = cells[0][2] ? 3 : 2);
  DEF(elastic, method, .bending = bending);
  double lo[3] = {0.0, 0.0, 0.0};
  MAKE_KEPT(particles, set, create, own, &def);
  for (int k = 0; k < boxes; k++) {
    double hi[3];
    for (int c = 0; c < 3; c++) hi[c] = lo[c] + 0.1 * cells[k][c];
    OK(mps_particles_fill_box(set, lo, hi, NULL));
    lo[0] = hi[0];
  }
  SET_FIELDS(set, {"young", 1e6}, {"poisson", 0.3});
  MAKE_KEPT(elastic, e, create, own, set, &method);
  hold_lowest(e, 1);
  for (int k = 0; k < 2; k++) OK(mps_elastic_solve(e));
  mps_elastic_destroy(&e);
  mps_particles_destroy(&set);
  mps_context_destroy(&own);
  return j->count;
}

TEST(slender_parts_are_reported_once) {
  journal j;
  assert_int_equal(warnings(&j, NAN, 1, (const int[][3]){{4, 40, 0}}), 1);
  assert_non_null(strstr(j.last, "160 of 160 particles"));
  assert_non_null(strstr(j.last, "most of 4: without `bending` they lack up to 6.25 %"));
  assert_int_equal(warnings(&j, NAN, 1, (const int[][3]){{16, 16, 3}}), 1); /* a plate */
  assert_non_null(strstr(j.last, "most of 3:"));
  /* on a block: 3 x 20 cells stand out of 20 x 6 */
  assert_int_equal(warnings(&j, NAN, 2, (const int[][3]){{20, 6, 0}, {3, 26, 0}}), 1);
  assert_non_null(strstr(j.last, "of 198 particles"));
}

TEST(other_bodies_are_not) {
  journal j;
  assert_int_equal(warnings(&j, 0.0, 1, (const int[][3]){{4, 40, 0}}), 0);
  assert_int_equal(warnings(&j, 1.0, 1, (const int[][3]){{4, 40, 0}}), 0);
  assert_int_equal(warnings(&j, NAN, 1, (const int[][3]){{9, 90, 0}}), 0);
  assert_int_equal(warnings(&j, NAN, 1, (const int[][3]){{6, 6, 0}}), 0);
  assert_int_equal(warnings(&j, NAN, 1, (const int[][3]){{8, 31, 0}}), 0);
  assert_int_equal(warnings(&j, NAN, 1, (const int[][3]){{8, 32, 0}}), 1);
}

/* The rim of a disc has short rows of cells without being slender. */
TEST(a_disc_is_not_slender) {
  journal j = {0};
  scoped_context *own = journal_context(&j, NULL);
  int64_t out[1600], count = 0;
  scoped_particles *set = box_of(own, 0.1, AT(0.0, 0.0), AT(4.0, 4.0));
  SET_FIELDS(set, {"young", 1e6}, {"poisson", 0.3});
  for (int64_t k = 0; k < 1600; k++) {
    const double x = 0.1 * (double)(k % 40) - 1.95, y = 0.1 * (double)(k / 40) - 1.95;
    if (x * x + y * y > 4.0) {
      const double at[2] = {x + 2.0, y + 2.0};
      out[count++] = mps_particles_nearest(set, at);
    }
  }
  OK(mps_particles_remove(set, out, count));
  MAKE(elastic, e, create, own, set, NULL);
  hold_lowest(e, 1);
  OK(mps_elastic_solve(e));
  assert_int_equal(j.count, 0);
}
