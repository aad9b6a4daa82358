/* test_particle_values.c - which fields a set has, removal of fields, values from arrays, copies of
 * sets: with holders, with refused memory, and what is refused.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "test_allocator.h"
#include "test_fixture.h"

#include <core/particles/particles_internal.h>

enum { COUNT = 6 };

/* Six sites, of which the second was removed and the order turned. */
static mps_particles *make_set_in(mps_context *own) {
  DEF(particles, def, .spacing = 0.5, .origin[0] = 0.25);
  mps_particles *set = NULL;
  const double lo[2] = {0.25, 0.0}, hi[2] = {2.25, 1.0};
  const int64_t gone[] = {1, 4}, order[] = {5, 3, 1, 0, 2, 4};
  if (mps_particles_create(own, &def, &set) != MPS_OK) return NULL;
  mps_status status = mps_particles_fill_box(set, lo, hi, NULL);
  if (status == MPS_OK) status = mps_particles_remove(set, gone, 2);
  if (status == MPS_OK) status = mps_particles_add_field(set, "user.dose", 2);
  if (status == MPS_OK) status = mps_particles_add_field(set, "group", 0);
  if (status == MPS_OK) status = mpsi_particles_permute(set, __func__, order);
  if (status != MPS_OK) mps_particles_destroy(&set);
  return set;
}

static mps_particles *make_set(void) {
  mps_particles *set = make_set_in(context);
  assert_int_equal(mps_particles_count(set), COUNT);
  return set;
}

static double value(mps_particles *set, const char *name, int64_t i, int64_t c) {
  mps_view view;
  OK(mps_particles_view(set, name, &view));
  return view.dtype.code == 2 ? *mps_view_f64(&view, i, c) : (double)*mps_view_i64(&view, i, c);
}

/* ---- which there are ------------------------------------------------------------------------- */

TEST(a_set_knows_its_fields) {
  scoped_particles *set = make_set();
  assert_int_equal(mps_particles_has_field(set, "id"), 1);
  assert_int_equal(mps_particles_has_field(set, "user.dose"), 1);
  assert_int_equal(mps_particles_has_field(set, "dose"), 0);
  assert_int_equal(mps_particles_has_field(set, "density"), 0);
  assert_int_equal(mps_particles_has_field(set, "a b"), 0);
  assert_int_equal(mps_particles_has_field(set, NULL), 0);
  assert_int_equal(mps_particles_has_field(NULL, "id"), 0);
}

/* ---- removal --------------------------------------------------------------------------------- */

TEST(a_removed_field_ends_views_and_leaves_the_others) {
  scoped_particles *set = make_set();
  const double dose[2 * COUNT] = {1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12};
  OK(mps_particles_set(set, "density", 0, 1800.0));
  OK(mps_particles_set_array(set, "user.dose", -1, dose, COUNT));
  OK(mps_particles_set(set, "velocity", 1, 2.5));
  const uint64_t epoch = mps_particles_epoch(set);
  const int32_t fields = mps_particles_field_count(set);
  OK(mps_particles_remove_field(set, "density"));
  assert_true(mps_particles_epoch(set) != epoch);
  assert_int_equal(mps_particles_field_count(set), fields - 1);
  assert_int_equal(mps_particles_has_field(set, "density"), 0);
  for (int i = 0; i < COUNT; i++) {
    assert_true(value(set, "user.dose", i, 1) == 2.0 * i + 2.0);
    assert_true(value(set, "velocity", i, 1) == 2.5);
  }
  OK(mps_particles_add_field(set, "density", 0)); /* anew, and zero */
  assert_true(value(set, "density", 2, 0) == 0.0);
  const double at[2] = {5.0, 5.0};
  OK(mps_particles_append(set, 1, at));
  assert_true(value(set, "user.dose", COUNT - 1, 0) == 11.0);
}

TEST(removal_is_refused) {
  scoped_particles *set = make_set();
  mps_edit edit;
  const uint64_t epoch = mps_particles_epoch(set);
  assert_int_equal(mps_particles_remove_field(NULL, "density"), MPS_ERROR_ARGUMENT);
  REFUSES(mps_particles_remove_field(set, NULL), "name is NULL");
  FAILS(mps_particles_remove_field(set, "id"), MPS_ERROR_STATE, "every set has the field 'id'");
  FAILS(mps_particles_remove_field(set, "position"), MPS_ERROR_STATE, "'position'");
  FAILS(mps_particles_remove_field(set, "dose"), MPS_ERROR_FIELD, "(write user.dose)");
  OK(mps_particles_edit(set, "user.dose", &edit));
  FAILS(mps_particles_remove_field(set, "user.dose"), MPS_ERROR_STATE, "is being edited");
  OK(mps_particles_abandon(set, &edit));
  assert_int_equal(mps_particles_epoch(set), epoch);
  assert_int_equal(mps_particles_field_count(set), 4);
}

static bool needs_group(const void *self, const char *field) {
  (void)self;
  return strcmp(field, "group") == 0;
}

TEST(fields_that_a_holder_needs_stay) {
  scoped_particles *set = make_set();
  mpsi_holder solver = {.name = "a solver", .kind = MPSI_USE_FIX};
  mpsi_holder reader = {.name = "a reader", .kind = MPSI_USE_LOOK, .uses = needs_group};
  OK(mps_particles_set(set, "density", 0, 1800.0));
  OK(mpsi_particles_hold(set, __func__, &reader));
  FAILS(mps_particles_remove_field(set, "group"), MPS_ERROR_STATE, "is used by a reader");
  OK(mps_particles_remove_field(set, "density"));
  OK(mps_particles_set(set, "density", 0, 1800.0));
  OK(mpsi_particles_hold(set, __func__, &solver));
  FAILS(mps_particles_remove_field(set, "density"), MPS_ERROR_STATE,
        "field 'density' is used by a solver, which holds the set");
  OK(mps_particles_remove_field(set, "user.dose"));
  mpsi_particles_release(set, &solver);
  mpsi_particles_release(set, &reader);
  OK(mps_particles_remove_field(set, "density"));
  OK(mps_particles_remove_field(set, "group"));
}

/* ---- values ---------------------------------------------------------------------------------- */

TEST(an_array_sets_a_field_or_a_component) {
  scoped_particles *set = make_set();
  double rows[2 * COUNT], column[COUNT], groups[COUNT];
  for (int i = 0; i < COUNT; i++)
    rows[2 * i] = 0.1 * i, rows[2 * i + 1] = -0.1 * i, column[i] = 7.0 + i, groups[i] = i * 0x1p50;
  const uint64_t epoch = mps_particles_epoch(set);
  OK(mps_particles_set_array(set, "velocity", -1, rows, COUNT)); /* is added */
  OK(mps_particles_set_array(set, "velocity", 1, column, COUNT));
  OK(mps_particles_set_array(set, "user.dose", 0, column, COUNT));
  OK(mps_particles_set_array(set, "group", -1, groups, COUNT));
  for (int i = 0; i < COUNT; i++) {
    assert_true(value(set, "velocity", i, 0) == rows[2 * i]);
    assert_true(value(set, "velocity", i, 1) == column[i]);
    assert_true(value(set, "user.dose", i, 0) == column[i]);
    assert_true(value(set, "user.dose", i, 1) == 0.0);
    assert_true(value(set, "group", i, 0) == groups[i]);
  }
  mps_view x;
  OK(mps_particles_view(set, "position", &x));
  OK(mps_particles_set_array(set, "user.dose", 1, mps_view_f64(&x, 0, 1), COUNT));
  for (int i = 0; i < COUNT; i++) /* a column of a view is such an array */
    assert_true(value(set, "user.dose", i, 1) == value(set, "position", i, 1));
  assert_int_equal(mps_particles_epoch(set), epoch);
  scoped_particles *none = NULL;
  DEF(particles, def, .spacing = 0.5);
  OK(mps_particles_create(context, &def, &none));
  OK(mps_particles_set_array(none, "velocity", -1, NULL, 0));
  assert_int_equal(mps_particles_has_field(none, "velocity"), 1);
}

TEST(wrong_arrays_change_nothing) {
  scoped_particles *set = make_set();
  double v[2 * COUNT] = {1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12};
  OK(mps_particles_set_array(set, "user.dose", -1, v, COUNT));
  const int32_t fields = mps_particles_field_count(set);
  assert_int_equal(mps_particles_set_array(NULL, "user.dose", 0, v, COUNT), MPS_ERROR_ARGUMENT);
  REFUSES(mps_particles_set_array(set, NULL, 0, v, COUNT), "name is NULL");
  REFUSES(mps_particles_set_array(set, "user.dose", 0, NULL, COUNT), "values is NULL");
  REFUSES(mps_particles_set_array(set, "user.dose", 2, v, COUNT),
          "is 2, allowed are -1 (all) to 1");
  REFUSES(mps_particles_set_array(set, "user.dose", -2, v, COUNT), "is -2");
  REFUSES(mps_particles_set_array(set, "user.dose", 0, v, COUNT + 1),
          "count is 7, must be the number of particles, 6");
  REFUSES(mps_particles_set_array(set, "user.dose", 0, v, -1), "count is -1");
  FAILS(mps_particles_set_array(set, "id", 0, v, COUNT), MPS_ERROR_FIELD, "by the library only");
  FAILS(mps_particles_set_array(set, "dose", 0, v, COUNT), MPS_ERROR_FIELD, "(write user.dose)");
  FAILS(mps_particles_set_array(set, "user.more", 0, v, COUNT), MPS_ERROR_FIELD,
        "mps_particles_add_field adds it");
  const double bad[] = {NAN, INFINITY, 2e100};
  for (int k = 0; k < 3; k++) {
    v[11] = bad[k];
    REFUSES(mps_particles_set_array(set, "user.dose", -1, v, COUNT),
            "values of field 'user.dose' of");
    assert_int_equal(mps_context_error(context)->particle, 6); /* the last one's id */
    assert_true(value(set, "user.dose", 0, 0) == 1.0 && value(set, "user.dose", 5, 1) == 12.0);
  }
  v[0] = -1.0;
  REFUSES(mps_particles_set_array(set, "density", 0, v, COUNT), "is -1 kg/m3, allowed are 0 to");
  v[0] = 1.5;
  REFUSES(mps_particles_set_array(set, "group", 0, v, COUNT), "is 1.5, must be a whole number");
  v[0] = 0x1p54;
  REFUSES(mps_particles_set_array(set, "group", 0, v, COUNT), "allowed are -9.0072e+15 to");
  assert_int_equal(mps_particles_field_count(set), fields);
  mps_edit edit;
  OK(mps_particles_edit(set, "user.dose", &edit));
  FAILS(mps_particles_set_array(set, "user.dose", 0, v, COUNT), MPS_ERROR_STATE, "being edited");
  OK(mps_particles_abandon(set, &edit));
}

static mps_status refuse_commit(void *self, const char *function, const char *field,
                                const double *former) {
  mps_context *own = self;
  (void)former;
  return strcmp(field, "velocity") == 0
             ? mpsi_fail(own, function, MPS_ERROR_ARGUMENT, "too fast for a solver")
             : MPS_OK;
}

TEST(a_holder_may_refuse_an_array) {
  scoped_particles *set = make_set();
  const double v[2 * COUNT] = {1, 2, 3};
  mpsi_holder solver = {
      .name = "a solver", .self = context, .kind = MPSI_USE_FIX, .commit = refuse_commit};
  OK(mpsi_particles_hold(set, __func__, &solver));
  FAILS(mps_particles_set_array(set, "velocity", -1, v, COUNT), MPS_ERROR_ARGUMENT, "too fast");
  assert_int_equal(mps_particles_has_field(set, "velocity"), 0);
  OK(mps_particles_add_field(set, "velocity", 0));
  FAILS(mps_particles_set_array(set, "velocity", -1, v, COUNT), MPS_ERROR_ARGUMENT, "too fast");
  FAILS(mps_particles_set(set, "velocity", 0, 5.0), MPS_ERROR_ARGUMENT, "too fast");
  assert_true(value(set, "velocity", 0, 1) == 0.0);
  OK(mps_particles_set_array(set, "user.dose", -1, v, COUNT));
  assert_true(value(set, "user.dose", 0, 1) == 2.0);
  mpsi_particles_release(set, &solver);
}

/* ---- copies ---------------------------------------------------------------------------------- */

TEST(a_copy_is_the_same_and_independent) {
  mps_particles *set = make_set();
  const double dose[2 * COUNT] = {1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12};
  OK(mps_particles_set_array(set, "user.dose", -1, dose, COUNT));
  mpsi_holder solver = {.name = "a solver", .kind = MPSI_USE_MOVE};
  OK(mpsi_particles_hold(set, __func__, &solver));
  scoped_particles *copy = NULL;
  OK(mps_particles_copy(set, &copy));
  assert_int_equal(mps_particles_field_count(copy), mps_particles_field_count(set));
  assert_true(mps_particles_spacing(copy) == 0.5 && mps_particles_dim(copy) == 2);
  for (int32_t f = 0; f < mps_particles_field_count(set); f++) {
    mps_particles_field_info a, b;
    OK(mps_particles_get_field_info(set, f, &a));
    OK(mps_particles_get_field_info(copy, f, &b));
    assert_string_equal(a.name, b.name);
    assert_string_equal(a.unit, b.unit);
    assert_int_equal(a.flags, b.flags);
    for (int64_t i = 0; i < COUNT; i++)
      for (int32_t c = 0; c < a.components; c++)
        assert_true(value(set, a.name, i, c) == value(copy, a.name, i, c));
  }
  for (int64_t id = 0; id < 8; id++)
    assert_int_equal(mps_particles_index(copy, id), mps_particles_index(set, id));
  OK(mps_particles_set(set, "user.dose", 0, -1.0));
  assert_true(value(copy, "user.dose", 3, 0) == 7.0);
  const double lo[2] = {0.25, 0.0}, hi[2] = {2.75, 1.0};
  int64_t added = -1;
  OK(mps_particles_fill_box(copy, lo, hi, &added)); /* no solver holds it; sites are taken */
  assert_int_equal(added, 2);
  assert_int_equal(mps_particles_index(copy, 8), COUNT); /* ids go on */
  assert_int_equal(mps_particles_count(set), COUNT);
  mps_particles *kept = set;
  mps_particles_destroy(&set);
  mpsi_particles_release(kept, &solver);
  assert_true(value(copy, "user.dose", 5, 1) == 12.0);
}

TEST(copies_of_nothing_are_refused) {
  scoped_particles *set = make_set();
  mps_particles *copy = set;
  mps_edit edit;
  assert_int_equal(mps_particles_copy(NULL, &copy), MPS_ERROR_ARGUMENT);
  REFUSES(mps_particles_copy(set, NULL), "out is NULL");
  OK(mps_particles_edit(set, "position", &edit));
  FAILS(mps_particles_copy(set, &copy), MPS_ERROR_STATE, "is being edited");
  assert_null(copy);
  OK(mps_particles_abandon(set, &edit));
  scoped_particles *none = NULL, *other = NULL;
  DEF(particles, def, .dim = 3, .spacing = 0.5);
  OK(mps_particles_create(context, &def, &none));
  OK(mps_particles_copy(none, &other));
  assert_int_equal(mps_particles_count(other), 0);
  const double at[3] = {0.0, 0.0, 0.0};
  OK(mps_particles_append(other, 1, at));
  assert_int_equal(mps_particles_index(other, 0), 0);
}

/* ---- refused memory -------------------------------------------------------------------------- */

/* All of it, with a holder, for which former values are kept. */
static mps_status use_all(mps_context *own, int what) {
  const double dose[2 * COUNT] = {1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12};
  mps_particles *set = make_set_in(own), *copy = NULL;
  mpsi_holder solver = {
      .name = "a solver", .self = own, .kind = MPSI_USE_FIX, .commit = refuse_commit};
  (void)what;
  if (!set) return MPS_ERROR_MEMORY;
  mps_status status = mpsi_particles_hold(set, __func__, &solver);
  const int32_t fields = mps_particles_field_count(set);
  if (status == MPS_OK) status = mps_particles_set_array(set, "displacement", -1, dose, COUNT);
  if (status != MPS_OK) assert_int_equal(mps_particles_field_count(set), fields);
  if (status == MPS_OK) status = mps_particles_set_array(set, "user.dose", 1, dose, COUNT);
  if (status == MPS_OK) status = mps_particles_copy(set, &copy);
  if (status == MPS_OK) status = mps_particles_remove_field(copy, "displacement");
  mpsi_particles_release(set, &solver);
  mps_particles_destroy(&copy);
  mps_particles_destroy(&set);
  return status;
}

TEST(refused_memory_is_reported_and_leaves_nothing) { test_allocator_sweep(use_all, 0); }
