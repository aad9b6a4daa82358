/* test_neighbours.c - neighbour lists: arguments, small cases known by hand, strides, steady
 * memory, allocation failures. Against brute force: property/test_neighbours.c.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "test_common.h"
#include "test_allocator.h"

static mps_view view_of(const double *xy, int64_t n, int32_t dim) {
  return (mps_view){.data = (void *)(uintptr_t)xy,
                    .shape = {n, dim, 1},
                    .stride = {dim, 1, 1},
                    .dtype = {2, 64, 1}};
}

TEST_SERIAL(bad_arguments_are_refused) {
  mps_neighbours_def good = mps_neighbours_defaults();
  mps_neighbours *nb = NULL;
  assert_int_equal(good.dim, 2);
  good.radius = 1.0;
  assert_int_equal(mps_neighbours_create(NULL, &good, &nb), MPS_ERROR_ARGUMENT);
  REFUSES(mps_neighbours_create(context, &good, NULL), "out");
  REFUSES(mps_neighbours_create(context, NULL, &nb), "def");
  assert_null(nb);
  assert_int_equal(mps_neighbours_build(NULL, NULL), MPS_ERROR_ARGUMENT);
  assert_int_equal(mps_neighbours_lists(NULL, NULL, NULL, NULL), MPS_ERROR_ARGUMENT);
  mps_neighbours_destroy(NULL);
}

TEST(bad_positions_leave_the_former_list) {
  mps_context *context = test_context(MPS_CONTEXT_EXECUTOR_SERIAL, 1);
  DEF(neighbours, def, .radius = 1.0);
  double xy[] = {0, 0, 0.5, 0, 3, 0};
  const int64_t *offsets, *indices;
  int64_t n = -1;
  MAKE_KEPT(neighbours, nb, create, context, &def);
  OK(mps_neighbours_lists(nb, &n, &offsets, NULL));
  assert_int_equal(n, 0);
  assert_int_equal(offsets[0], 0);
  mps_view view = view_of(xy, 3, 2), bad = view;
  OK(mps_neighbours_build(nb, &view));
  REFUSES(mps_neighbours_build(nb, NULL), "position is NULL");
  bad.shape[1] = 3;
  FAILS(mps_neighbours_build(nb, &bad), MPS_ERROR_FIELD, "(3, 3)");
  bad = view;
  bad.shape[0] = INT64_C(1) << 32;
  FAILS(mps_neighbours_build(nb, &bad), MPS_ERROR_FIELD, "(4294967296, 2)");
  bad = view;
  bad.dtype.bits = 32;
  FAILS(mps_neighbours_build(nb, &bad), MPS_ERROR_FIELD, "of 32 bits");
  bad = view;
  bad.data = NULL;
  REFUSES(mps_neighbours_build(nb, &bad), "data NULL");
  xy[5] = NAN;
  REFUSES(mps_neighbours_build(nb, &view), "position 2 has y = nan");
  OK(mps_neighbours_lists(nb, &n, &offsets, &indices));
  assert_int_equal(n, 3);
  assert_int_equal(offsets[3], 2);
  assert_int_equal(indices[0], 1);
  assert_int_equal(indices[1], 0);
  view.shape[0] = 0;
  view.data = NULL;
  OK(mps_neighbours_build(nb, &view));
  OK(mps_neighbours_lists(nb, &n, &offsets, NULL));
  assert_int_equal(n, 0);
  assert_int_equal(offsets[0], 0);
  mps_context_destroy(&context); /* the lists keep it alive */
  mps_neighbours_destroy(&nb);
  assert_null(nb);
}

/* On the lattice with radius 1.5 D an inner particle has 8 neighbours in 2D, 18 in 3D; with
 * exactly D none: the radius itself is outside. */
TEST_SERIAL(lattice_particles_have_the_neighbours_known_by_hand) {
  for (int32_t dim = 2; dim <= 3; dim++) {
    DEF(particles, def, .dim = dim, .spacing = 1.0);
    MAKE(particles, set, create, context, &def);
    OK(mps_particles_fill_box(set, AT(-4, -4, -4), AT(5, 5, 5), NULL));
    mps_view x = view_field(set, "position");
    for (int ring = 0; ring < 2; ring++) {
      DEF(neighbours, nd, .dim = dim, .radius = ring ? 1.5 : 1.0);
      const int64_t *offsets, *indices, middle = mps_particles_count(set) / 2;
      MAKE(neighbours, nb, create, context, &nd);
      OK(mps_neighbours_build(nb, &x));
      OK(mps_neighbours_lists(nb, NULL, &offsets, &indices));
      assert_int_equal(offsets[middle + 1] - offsets[middle], !ring ? 0 : dim == 2 ? 8 : 18);
      if (ring && dim == 2) {
        const int64_t expected[] = {-10, -9, -8, -1, 1, 8, 9, 10};
        for (int k = 0; k < 8; k++)
          assert_int_equal(indices[offsets[middle] + k], middle + expected[k]);
        assert_int_equal(offsets[1], 3); /* a corner */
      }
    }
  }
}

static mps_status build_twice(mps_context *context, mps_neighbours **nb, const mps_view *first,
                              const mps_view *second) {
  DEF(neighbours, def, .radius = 1.5);
  mps_status status = mps_neighbours_create(context, &def, nb);
  if (status == MPS_OK) status = mps_neighbours_build(*nb, first);
  if (status == MPS_OK) status = mps_neighbours_build(*nb, second);
  return status;
}

TEST(allocation_failures_leave_the_former_list) {
  double xy[400];
  for (int i = 0; i < 200; i++) {
    xy[2 * i] = i % 20;
    xy[2 * i + 1] = i / 20; /* NOLINT: whole rows */
  }
  const mps_view small = view_of(xy, 3, 2), large = view_of(xy, 200, 2);
  mps_status status = MPS_ERROR_MEMORY;
  int64_t refuse = 2;
  for (; status != MPS_OK; refuse++) {
    test_allocator memory = {.refuse_at = refuse};
    mps_context_def def = mps_context_defaults();
    mps_context *context = NULL;
    mps_neighbours *nb = NULL;
    int64_t n = 0;
    const int64_t *offsets = NULL;
    char text[128];
    test_allocator_use(&def, &memory);
    assert_int_equal(mps_context_create(&def, &context, text, sizeof text), MPS_OK);
    status = build_twice(context, &nb, &small, &large);
    assert_true(status == MPS_OK || status == MPS_ERROR_MEMORY);
    memory.refuse_at = 0;
    if (nb) {
      OK(mps_neighbours_lists(nb, &n, &offsets, NULL));
      assert_true(n == 0 || n == 3 || n == 200);
      assert_int_equal(offsets[n], n == 0 ? 0 : n == 3 ? 4 : 2 * (19 * 10 + 20 * 9 + 2 * 19 * 9));
      OK(mps_neighbours_build(nb, &large)); /* and recovers */
      OK(mps_neighbours_lists(nb, &n, NULL, NULL));
      assert_int_equal(n, 200);
    }
    mps_neighbours_destroy(&nb);
    mps_context_destroy(&context);
    assert_int_equal(memory.live, 0);
  }
  assert_true(refuse > 12);
}

TEST(building_again_allocates_nothing) {
  test_allocator memory = {0};
  mps_context_def def = mps_context_defaults();
  scoped_context *context = NULL;
  scoped_neighbours *nb = NULL;
  char text[128];
  double x[2000];
  test_allocator_use(&def, &memory);
  assert_int_equal(mps_context_create(&def, &context, text, sizeof text), MPS_OK);
  for (int i = 0; i < 1000; i++) {
    x[i] = i; /* all x, then all y: as the fields of a particle set */
    x[1000 + i] = 0.25 * (i % 3);
  }
  mps_view view = view_of(x, 1000, 2);
  view.stride[0] = 1;
  view.stride[1] = 1000;
  OK(build_twice(context, &nb, &view, &view));
  const int64_t calls = memory.calls;
  for (int round = 0; round < 5; round++) {
    x[500 + round] += 0.1;
    OK(mps_neighbours_build(nb, &view));
  }
  assert_int_equal(memory.calls, calls);
}
