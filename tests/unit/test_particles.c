/* test_particles.c - particle sets: life, growth, fields, views, order, selection, and the
 * agreement of the field table with docs/fields.md. Fills: test_fill.c.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "test_fixture.h"
#include "test_allocator.h"

#include <core/particles/fields.h>
#include <core/particles/particles_internal.h>

static mps_particles *make_set(int32_t dim) {
  DEF(particles, def, .dim = dim, .spacing = 0.5);
  MAKE_KEPT(particles, set, create, context, &def);
  return set;
}

/* Five particles in the plane: 0 (0,0), 1 (1,0), 2 (2,-1), 3 (3,-2), 4 (4,-3). */
static mps_particles *make_five(void) {
  const double xy[] = {0, 0, 1, 0, 2, -1, 3, -2, 4, -3};
  mps_particles *set = make_set(2);
  OK(mps_particles_append(set, 5, xy));
  return set;
}

TEST(bad_definitions_are_refused) {
  const mps_particles_def def = {.struct_size = sizeof def, .dim = 3, .spacing = 1.0};
  mps_particles *set = NULL;
  assert_int_equal(mps_particles_create(NULL, &def, &set), MPS_ERROR_ARGUMENT);
  REFUSES(mps_particles_create(context, &def, NULL), "out");
  REFUSES(mps_particles_create(context, NULL, &set), "def");
  assert_null(set);
  assert_int_equal(mps_particles_defaults().dim, 2);
}

TEST(a_new_set_is_empty_and_has_id_and_position) {
  mps_particles *set = make_set(3);
  assert_int_equal(mps_particles_count(set), 0);
  assert_int_equal(mps_particles_dim(set), 3);
  NEAR(mps_particles_spacing(set), 0.5, 0.0);
  assert_int_equal(mps_particles_field_count(set), 2);
  mps_particles_field_info info;
  OK(mps_particles_get_field_info(set, 0, &info));
  assert_string_equal(info.name, "id");
  assert_int_equal(info.flags, MPS_VIEW_READONLY);
  OK(mps_particles_get_field_info(set, 1, &info));
  assert_string_equal(info.name, "position");
  assert_string_equal(info.unit, "m");
  assert_int_equal(info.components, 3);
  assert_int_equal(info.flags, 0);
  REFUSES(mps_particles_get_field_info(set, 2, &info), "index is 2");
  REFUSES(mps_particles_get_field_info(set, -1, &info), "index is -1");
  assert_int_equal(view_field(set, "position").shape[0], 0);
  const double x[3] = {0, 0, 0};
  assert_int_equal(mps_particles_nearest(set, x), -1);
  mps_particles_destroy(&set);
  assert_null(set);
  mps_particles_destroy(&set);
  mps_particles_destroy(NULL);
}

TEST(queries_of_no_set_answer_nothing) {
  assert_int_equal(mps_particles_count(NULL), 0);
  assert_int_equal(mps_particles_dim(NULL), 0);
  assert_true(mps_particles_spacing(NULL) == 0.0);
  assert_int_equal(mps_particles_epoch(NULL), 0);
  assert_int_equal(mps_particles_field_count(NULL), 0);
  assert_int_equal(mps_particles_index(NULL, 0), -1);
  assert_int_equal(mps_particles_nearest(NULL, NULL), -1);
  assert_int_equal(mps_particles_append(NULL, 0, NULL), MPS_ERROR_ARGUMENT);
  assert_int_equal(mps_particles_add_field(NULL, "density", 0), MPS_ERROR_ARGUMENT);
  assert_int_equal(mps_particles_view(NULL, "density", NULL), MPS_ERROR_ARGUMENT);
  assert_int_equal(mps_particles_set(NULL, "density", 0, 1.0), MPS_ERROR_ARGUMENT);
  assert_int_equal(mps_particles_get_field_info(NULL, 0, NULL), MPS_ERROR_ARGUMENT);
  assert_int_equal(mps_particles_select_box(NULL, NULL, NULL, 0, NULL, NULL), MPS_ERROR_ARGUMENT);
}

TEST(appending_keeps_what_was_there_and_zeroes_what_is_new) {
  scoped_particles *set = make_five();
  OK(mps_particles_set(set, "density", 0, 1800.0));
  uint64_t epoch = mps_particles_epoch(set);
  for (int64_t n = 5; n < 3000; n++) {
    const double xy[2] = {(double)n, (double)-n};
    OK(mps_particles_append(set, 1, xy));
    assert_true(mps_particles_epoch(set) != epoch);
    epoch = mps_particles_epoch(set);
  }
  OK(mps_particles_append(set, 0, NULL));
  assert_int_equal(mps_particles_epoch(set), epoch);
  const mps_view id = view_field(set, "id"), x = view_field(set, "position"),
                 density = view_field(set, "density");
  assert_int_equal(x.shape[0], 3000);
  assert_int_equal(x.shape[1], 2);
  assert_int_equal(x.epoch, epoch);
  assert_int_equal(id.flags, MPS_VIEW_READONLY);
  for (int64_t i = 0; i < 3000; i++) {
    assert_int_equal(*mps_view_i64(&id, i, 0), i);
    assert_int_equal(mps_particles_index(set, i), i);
    NEAR(*mps_view_f64(&x, i, 0), (double)i, 0.0);
    NEAR(*mps_view_f64(&density, i, 0), i < 5 ? 1800.0 : 0.0, 0.0);
  }
}

TEST(bad_positions_append_nothing) {
  scoped_particles *set = make_five();
  const double xy[] = {9, 9, 9, NAN};
  const uint64_t epoch = mps_particles_epoch(set);
  REFUSES(mps_particles_append(set, 2, xy), "position 1 has y = nan");
  REFUSES(mps_particles_append(set, -1, xy), "count is -1");
  REFUSES(mps_particles_append(set, INT64_MAX, xy), "2^40");
  REFUSES(mps_particles_append(set, 1, NULL), "positions");
  assert_int_equal(mps_particles_count(set), 5);
  assert_int_equal(mps_particles_epoch(set), epoch);
}

TEST(every_component_is_aligned_padded_and_staggered) {
  scoped_particles *set = make_set(3);
  OK(mps_particles_add_field(set, "restoring_old", 0));
  OK(mps_particles_add_field(set, "velocity", 0));
  for (int round = 0; round < 3; round++) {
    const double *column[12];
    for (int c = 0; c < 12; c++)
      column[c] = c < 3   ? mpsi_particles_column(set, "position", c)
                  : c < 9 ? mpsi_particles_column(set, "restoring_old", c - 3)
                          : mpsi_particles_column(set, "velocity", c - 9);
    const int64_t n = mps_particles_count(set);
    for (int c = 0; c < 12; c++) {
      assert_int_equal((uintptr_t)column[c] % MPSI_ALIGNMENT, 0);
      for (int k = 0; k < MPSI_PARTICLES_PADDING; k++) assert_true(column[c][n + k] == 0.0);
      for (int d = 0; d < c; d++)
        assert_true((uintptr_t)column[c] % 4096 != (uintptr_t)column[d] % 4096);
    }
    OK(mps_particles_fill_box(set, AT(0, 0, 0), AT(8, 8, 4.0 * (round + 1)), NULL));
  }
  assert_null(mpsi_particles_column(set, "velocity", 3));
  assert_null(mpsi_particles_column(set, "velocity", -1));
  assert_null(mpsi_particles_column(set, "density", 0));
  assert_null(mpsi_particles_column(set, "id", 0));
}

TEST(fields_of_the_table_get_their_documented_shape) {
  for (int32_t dim = 2; dim <= 3; dim++) {
    mps_particles *set = make_set(dim);
#define I64 0
#define F64 2
#define CHECK(field, type, comps, unit_, meaning_, writer, valid, since)                           \
  OK(mps_particles_add_field(set, #field, 0));                                                     \
  OK(mps_particles_add_field(set, #field, mpsi_field_components(comps, dim)));                     \
  assert_int_equal(view_field(set, #field).dtype.code, type);                                      \
  assert_int_equal(view_field(set, #field).dtype.bits, 64);                                        \
  assert_int_equal(view_field(set, #field).shape[1], mpsi_field_components(comps, dim));
    MPSI_FIELD_TABLE(CHECK)
#undef CHECK
#undef I64
#undef F64
    assert_int_equal(view_field(set, "rotation").shape[1], dim == 2 ? 1 : 3);
    assert_int_equal(view_field(set, "restoring_old").shape[1], dim == 2 ? 3 : 6);
    FAILS(mps_particles_add_field(set, "velocity", 1), MPS_ERROR_FIELD,
          "components of field 'velocity' is 1");
    mps_particles_destroy(&set);
  }
}

TEST(the_callers_own_fields_follow_their_rules) {
  scoped_particles *set = make_five();
  const uint64_t epoch = mps_particles_epoch(set);
  const char *longest = "user.a23456789_123456789_123456789_123456789_1234567";
  const char *bad[] = {"",         "2d",
                       "a-b",      "a b",
                       "\xc3\xa9", "user.",
                       "user.2d",  "user.a.b",
                       ".a",       "user.a23456789_123456789_123456789_123456789_12345678"};
  OK(mps_particles_add_field(set, longest, 16));
  OK(mps_particles_add_field(set, "user._T2", 2));
  OK(mps_particles_add_field(set, "user._T2", 2));
  assert_int_equal(mps_particles_field_count(set), 4);
  for (int b = 0; b < 10; b++) REFUSES(mps_particles_add_field(set, bad[b], 1), "name is '");
  REFUSES(mps_particles_add_field(set, NULL, 1), "NULL");
  FAILS(mps_particles_add_field(set, "user._T2", 3), MPS_ERROR_FIELD, "exists with 2");
  REFUSES(mps_particles_add_field(set, "user._T2", 0), "is 0");
  REFUSES(mps_particles_add_field(set, "user.new", 17), "is 17");
  assert_int_equal(mps_particles_epoch(set), epoch);
  const mps_view t = view_field(set, "user._T2");
  assert_int_equal(t.shape[0], 5);
  for (int c = 0; c < 2; c++)
    for (int i = 0; i < 5; i++) assert_true(*mps_view_f64(&t, i, c) == 0.0);
}

TEST(another_name_is_refused_with_what_to_write) {
  scoped_particles *set = make_five();
  mps_view view;
  mps_status (*add)(mps_particles *, const char *, int32_t) = mps_particles_add_field;
  REFUSES(add(set, "own", 1), "name is 'own', no field of the library's table: for a field of your "
                              "own write user.own");
  assert_null(strstr(mps_context_error(context)->message, "nearest"));
  REFUSES(add(set, "Velocity", 2), "write user.Velocity; the nearest of the table is 'velocity'");
  REFUSES(add(set, "presure", 1), "write user.presure; the nearest of the table is 'pressure'");
  REFUSES(add(set, "sand.damage", 1), "name is 'sand.damage', the history of a law, which the "
                                      "solver adds");
  REFUSES(add(set, "sand.damage", 1), "write user.damage");
  assert_int_equal(mps_particles_field_count(set), 2);
  OK(add(set, "user.own", 1));
  FAILS(mps_particles_view(set, "own", &view), MPS_ERROR_FIELD, "no field 'own' (write user.own)");
  FAILS(mps_particles_set(set, "own", 0, 1.0), MPS_ERROR_FIELD, "(write user.own)");
  FAILS(mps_particles_view(set, "none_such", &view), MPS_ERROR_FIELD, "no field 'none_such'; the");
}

TEST(an_unknown_field_is_an_error_that_lists_the_known) {
  scoped_particles *set = make_five();
  mps_view view;
  FAILS(mps_particles_view(set, "preasure", &view), MPS_ERROR_FIELD,
        "no field 'preasure' (is 'pressure' meant?); the set has: id, position");
  assert_null(view.data);
  FAILS(mps_particles_view(set, "pressure", &view), MPS_ERROR_FIELD,
        "no field 'pressure' here, as no solver of the set has made it; the set has: id, position");
  REFUSES(mps_particles_view(set, NULL, &view), "name");
  REFUSES(mps_particles_view(set, "id", NULL), "out");
  char name[16];
  for (int f = 0; f < 100; f++) { /* a list longer than the record is cut, not overrun */
    snprintf(name, sizeof name, "user.f_%d", f);
    OK(mps_particles_add_field(set, name, 1));
  }
  FAILS(mps_particles_view(set, "x", &view), MPS_ERROR_FIELD, "user.f_0");
}

TEST(setting_adds_a_known_field_and_fills_one_component) {
  scoped_particles *set = make_five();
  OK(mps_particles_set(set, "velocity", 1, -2.5));
  const mps_view v = view_field(set, "velocity");
  for (int i = 0; i < 5; i++) {
    assert_true(*mps_view_f64(&v, i, 0) == 0.0);
    assert_true(*mps_view_f64(&v, i, 1) == -2.5);
  }
  REFUSES(mps_particles_set(set, NULL, 0, 1.0), "name");
  FAILS(mps_particles_set(set, "user.mine", 0, 1.0), MPS_ERROR_FIELD,
        "no field 'user.mine' (mps_particles_add_field adds it)");
  FAILS(mps_particles_set(set, "id", 0, 1.0), MPS_ERROR_FIELD, "int64");
  REFUSES(mps_particles_set(set, "spin", 1, 1.0), "is 1, and the field has one alone");
  REFUSES(mps_particles_set(set, "spin", -1, 1.0), "is -1");
  REFUSES(mps_particles_set(set, "spin", 0, NAN), "nan");
  assert_int_equal(mps_particles_field_count(set), 3); /* spin was not added by mistake */
}

TEST(sorting_takes_every_field_along) {
  scoped_particles *set = make_five();
  const int64_t order[] = {4, 2, 0, 1, 3};
  const double x2[2] = {2.1, -1.0};
  int64_t ids[5], count;
  OK(mps_particles_add_field(set, "user.mine", 2));
  OK(mps_particles_add_field(set, "group", 0));
  mps_edit mine, group;
  OK(mps_particles_edit(set, "user.mine", &mine));
  OK(mps_particles_edit(set, "group", &group));
  for (int i = 0; i < 5; i++) {
    *mps_edit_f64(&mine, i, 1) = 10.0 * i;
    *mps_edit_i64(&group, i, 0) = 100 + i;
  }
  OK(mps_particles_commit(set, &mine));
  OK(mps_particles_commit(set, &group));
  const uint64_t epoch = mps_particles_epoch(set);
  OK(mpsi_particles_permute(set, __func__, order));
  assert_true(mps_particles_epoch(set) != epoch);
  const mps_view id = view_field(set, "id"), x = view_field(set, "position");
  for (int k = 0; k < 5; k++) {
    assert_int_equal(*mps_view_i64(&id, k, 0), order[k]);
    assert_int_equal(*mps_view_i64(&group.view, k, 0), 100 + order[k]);
    NEAR(*mps_view_f64(&x, k, 0), (double)order[k], 0.0);
    NEAR(*mps_view_f64(&mine.view, k, 1), 10.0 * (double)order[k], 0.0);
    assert_int_equal(mps_particles_index(set, order[k]), k);
  }
  assert_int_equal(mps_particles_nearest(set, x2), 2);
  const double lo[2] = {0.0, -2.0}, hi[2] = {3.0, INFINITY};
  OK(mps_particles_select_box(set, lo, hi, 5, &count, ids));
  assert_int_equal(count, 4);
  for (int k = 0; k < 4; k++) assert_int_equal(ids[k], k);
  const double more[2] = {7, 7};
  OK(mps_particles_append(set, 1, more));
  assert_int_equal(mps_particles_index(set, 5), 5);
  assert_int_equal(mps_particles_index(set, 4), 0);
}

TEST(selection_takes_the_closed_box) {
  scoped_particles *set = make_five();
  const double lo[2] = {1, -3}, hi[2] = {3, 0}, empty[2] = {2, -INFINITY};
  int64_t ids[2] = {-7, -7}, count = -1;
  OK(mps_particles_select_box(set, lo, hi, 0, &count, NULL));
  assert_int_equal(count, 3);
  OK(mps_particles_select_box(set, lo, hi, 1, &count, ids));
  assert_int_equal(count, 3);
  assert_int_equal(ids[0], 1);
  assert_int_equal(ids[1], -7); /* not past the capacity */
  REFUSES(mps_particles_select_box(set, lo, empty, 2, &count, ids), "the box in y is [-3, -inf]");
  const double bad[2] = {NAN, 0};
  REFUSES(mps_particles_select_box(set, bad, hi, 2, &count, ids), "the box in x is [nan, 3]");
  REFUSES(mps_particles_select_box(set, lo, hi, -1, &count, ids), "capacity is -1");
  REFUSES(mps_particles_select_box(set, lo, hi, 1, &count, NULL), "capacity is 1");
  REFUSES(mps_particles_select_box(set, NULL, hi, 0, &count, NULL), "lo is NULL");
  REFUSES(mps_particles_select_box(set, lo, hi, 0, NULL, NULL), "count is NULL");
  assert_int_equal(mps_particles_index(set, 5), -1);
  assert_int_equal(mps_particles_index(set, -1), -1);
  const double between[2] = {0.5, 0.0}; /* as near to 0 as to 1: the lower id */
  assert_int_equal(mps_particles_nearest(set, between), 0);
}

TEST(a_set_in_use_does_not_grow_and_outlives_its_destruction) {
  mps_particles *set = make_five();
  const double lo[2] = {0, 0}, hi[2] = {1, 1}, triangle[] = {0, 0, 1, 0, 0, 1};
  const int64_t order[] = {1, 0, 2, 3, 4};
  mps_particles *held = set;
  mpsi_holder solver = {.name = "a solver", .kind = MPSI_USE_FIX}, second = solver;
  OK(mpsi_particles_hold(set, __func__, &solver));
  assert_ptr_equal(mpsi_particles_context(set), context);
  FAILS(mps_particles_append(set, 1, lo), MPS_ERROR_STATE, "held by a solver");
  FAILS(mps_particles_fill_box(set, lo, hi, NULL), MPS_ERROR_STATE, "held by");
  FAILS(mps_particles_fill_ball(set, lo, 1.0, NULL), MPS_ERROR_STATE, "held by");
  FAILS(mps_particles_fill_polygon(set, 3, triangle, NULL), MPS_ERROR_STATE, "held by");
  OK(mps_particles_set(set, "density", 0, 1.0)); /* fields may be added */
  OK(mpsi_particles_permute(set, __func__, order));
  OK(mpsi_particles_hold(set, __func__, &second));
  FAILS(mpsi_particles_permute(set, "mps_x_create", order), MPS_ERROR_STATE, "2 solvers");
  assert_string_equal(mps_context_error(context)->function, "mps_x_create");
  mpsi_particles_release(set, &second);
  mps_particles_destroy(&set);
  assert_null(set);
  assert_int_equal(mps_particles_count(held), 5);
  mpsi_particles_release(held, &solver); /* the last: a leak here is a finding of the sanitizer */
  mpsi_particles_release(NULL, &solver);
}

/* All that allocates, once through; stops at the first failure, which must be of memory. */
static mps_status build_all(mps_context *c, mps_particles **set) {
  DEF(particles, def, .spacing = 1.0);
  const double lo[2] = {0, 0}, hi[2] = {40, 80}, triangle[] = {0, -9, 9, -9, 0, 0};
  int64_t order[3 + 3200 + 40], added;
  mps_status status = mps_particles_create(c, &def, set);
  if (status == MPS_OK) status = mps_particles_add_field(*set, "user.mine", 3);
  if (status == MPS_OK) status = mps_particles_append(*set, 3, triangle);
  if (status == MPS_OK) status = mps_particles_set(*set, "density", 0, 5.0);
  if (status == MPS_OK) status = mps_particles_fill_box(*set, lo, hi, &added);
  if (status == MPS_OK) status = mps_particles_fill_polygon(*set, 3, triangle, &added);
  if (status == MPS_OK) {
    const int64_t n = mps_particles_count(*set);
    for (int64_t i = 0; i < n; i++) order[i] = n - 1 - i;
    status = mpsi_particles_permute(*set, __func__, order);
  }
  return status;
}

TEST(every_allocation_failure_is_reported_and_changes_nothing) {
  mps_status status = MPS_ERROR_MEMORY;
  int64_t refuse = 2; /* the first is the context's own */
  for (; status != MPS_OK; refuse++) {
    test_allocator memory = {.refuse_at = refuse};
    mps_context_def def = mps_context_defaults();
    mps_context *c = NULL;
    mps_particles *set = NULL;
    char text[128];
    test_allocator_use(&def, &memory);
    assert_int_equal(mps_context_create(&def, &c, text, sizeof text), MPS_OK);
    status = build_all(c, &set);
    if (status != MPS_OK) {
      assert_int_equal(status, MPS_ERROR_MEMORY);
      assert_int_equal(mps_context_error(c)->status, MPS_ERROR_MEMORY);
      const int64_t n = mps_particles_count(set);
      assert_true(n == 0 || n == 3 || n == 3203 || n == 3239);
    }
    memory.refuse_at = 0;
    if (set) { /* the set is whole: the same goes well now, up to the sites already taken */
      mps_view x = view_field(set, "position");
      for (int64_t i = 0; i < x.shape[0]; i++) assert_true(isfinite(*mps_view_f64(&x, i, 1)));
      int64_t added = -1;
      const int64_t before = mps_particles_count(set);
      OK(mps_particles_fill_box(set, AT(0, 0), AT(40, 80), &added));
      assert_int_equal(added, before >= 3203 ? 0 : 3200);
    }
    mps_particles_destroy(&set);
    mps_context_destroy(&c);
    assert_int_equal(memory.live, 0);
  }
  assert_true(refuse > 30); /* it did have failures */
}

TEST(the_documentation_shows_the_table) {
  char line[512], expected[512];
  FILE *file = fopen(TEST_DOCS "/fields.md", "r");
  assert_non_null(file);
  do assert_non_null(fgets(line, sizeof line, file));
  while (strncmp(line, "|---", 4) != 0);
#define I64 "int64"
#define F64 "float64"
#define CHECK(name, type, comps, unit, meaning, writer, valid, since)                              \
  assert_non_null(fgets(line, sizeof line, file));                                                 \
  snprintf(expected, sizeof expected, "| %s | %s | %d | %d | %s | %s | %s | %s | %s |\n", #name,   \
           type, mpsi_field_components(comps, 2), mpsi_field_components(comps, 3), unit, meaning,  \
           writer, valid, #since);                                                                 \
  assert_string_equal(line, expected);
  MPSI_FIELD_TABLE(CHECK)
  assert_true(!fgets(line, sizeof line, file) || line[0] != '|'); /* no row too many */
  fclose(file);
}
