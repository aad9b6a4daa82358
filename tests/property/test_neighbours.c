/* test_neighbours.c - neighbour lists of every kind of cloud against all pairs, with every number
 * of threads.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "kit/random.h"
#include "pthread_executor.h"
#include "test_common.h"

enum { SIZE = 4500 }; /* above one block of work */

typedef enum cloud { UNIFORM, CLUSTERED, DUPLICATE, FAR, STRAY, LATTICE, LINE, CLOUDS } cloud;

static const char *cloud_names[CLOUDS] = {"uniform", "clustered", "duplicate", "far",
                                          "stray",   "lattice",   "line"};

static void make_cloud(cloud kind, int32_t dim, int64_t n, double *x) {
  for (int64_t i = 0; i < n; i++) {
    double *p = x + i * dim;
    for (int32_t c = 0; c < dim; c++) {
      if (kind == UNIFORM || kind == STRAY) p[c] = uniform(-15.0, 20.0);
      if (kind == CLUSTERED) p[c] = (double)(i % 5) * 40.0 + uniform(-1.0, 1.0) * uniform(0.0, 3.0);
      if (kind == DUPLICATE) p[c] = floor(uniform(-6.0, 6.0)) * 0.75;
      if (kind == FAR) p[c] = (c == 1 ? -1e6 : 1e6) + uniform(0.0, 30.0);
      if (kind == LATTICE)
        p[c] = c == 0 ? (double)(i % 67) : c == 1 ? (double)(i / 67 % 8) : (double)(i / 536);
      if (kind == LINE) p[c] = c == dim - 1 ? uniform(-2000.0, 2000.0) : 0.0;
    }
    /* particles that flew off, some of them together, beyond any sensible cell number */
    if (kind == STRAY && i % 100 == 0) p[i / 100 % dim] = i % 200 ? 1e300 : -3e12 - (double)(i % 7);
  }
}

static mps_neighbours *lists_of(mps_context *context, const double *x, int64_t n, int32_t dim,
                                double radius, int32_t half) {
  const mps_view view = {.data = (void *)(uintptr_t)x,
                         .shape = {n, dim, 1},
                         .stride = {dim, 1, 1},
                         .dtype = {2, 64, 1}};
  DEF(neighbours, def, .dim = dim, .radius = radius, .half = half);
  MAKE_KEPT(neighbours, nb, create, context, &def);
  OK(mps_neighbours_build(nb, &view));
  return nb;
}

/* The definition itself, one particle after the other; returns the number of pairs. */
static int64_t check_against_all_pairs(const mps_neighbours *nb, const double *x, int64_t n,
                                       int32_t dim, double radius, int32_t half, const char *what) {
  int64_t count, found = 0;
  const int64_t *offsets, *indices;
  assert_int_equal(mps_neighbours_lists(nb, &count, &offsets, &indices), MPS_OK);
  assert_int_equal(count, n);
  for (int64_t i = 0; i < n; i++) {
    for (int64_t j = half ? i + 1 : 0; j < n; j++) {
      double square = 0.0;
      for (int32_t c = 0; c < dim; c++)
        square += (x[j * dim + c] - x[i * dim + c]) * (x[j * dim + c] - x[i * dim + c]);
      if (j == i || !(square < radius * radius)) continue;
      if (found >= offsets[i + 1] || indices[found] != j)
        fail_msg("%s, %dD, half %d: neighbour %d of particle %d is missing or out of order", what,
                 dim, half, (int)j, (int)i);
      found++;
    }
    if (offsets[i + 1] != found)
      fail_msg("%s, %dD, half %d: particle %d has %d neighbours too many", what, dim, half, (int)i,
               (int)(offsets[i + 1] - found));
  }
  return found;
}

TEST_SERIAL(lists_are_those_of_all_pairs) {
  double *x = malloc(3 * SIZE * sizeof *x);
  assert_non_null(x);
  for (int32_t kind = 0; kind < CLOUDS; kind++)
    for (int32_t dim = 2; dim <= 3; dim++) {
      int64_t pairs[2];
      const double radius = dim == 2 ? 1.0 : 1.5;
      const int64_t n = kind == LATTICE || kind == UNIFORM ? SIZE : 700;
      make_cloud((cloud)kind, dim, n, x);
      for (int32_t half = 0; half < 2; half++) {
        scoped_neighbours *nb = lists_of(context, x, n, dim, radius, half);
        pairs[half] = check_against_all_pairs(nb, x, n, dim, radius, half, cloud_names[kind]);
      }
      assert_int_equal(pairs[0], 2 * pairs[1]);
      /* At radius 1 the lattice has no pair: the nearest are at the radius itself. */
      assert_true(pairs[1] > 30 || (kind == LATTICE && dim == 2 && pairs[1] == 0));
    }
  free(x);
}

/* Neighbours closer than the radius by one rounding error, all the way across the cells, near
 * zero and far from it: cells must not lose them. */
TEST_SERIAL(pairs_just_inside_the_radius_are_found_everywhere) {
  const double places[] = {0.0, -1.0, 1.0 / 3.0, 1e3, -1e6 - 0.1, 1e9 + 0.7};
  const double radius = 0.1;
  for (int p = 0; p < 6; p++)
    for (int k = -50; k < 50; k++) {
      const double a = places[p] + 0.02 * k;
      double b = a + radius;
      while (!((b - a) * (b - a) < radius * radius)) b -= fmax(fabs(a), radius) * 0x1p-52;
      const double xy[] = {0.0, 0.0, a, a, b, a}; /* cells are counted from one of the three */
      scoped_neighbours *nb = lists_of(context, xy, 3, 2, radius, 1);
      check_against_all_pairs(nb, xy, 3, 2, radius, 1, "edge");
      int64_t n;
      const int64_t *offsets;
      OK(mps_neighbours_lists(nb, &n, &offsets, NULL));
      assert_true(offsets[3] - offsets[1] == 1);
    }
}

TEST(lists_do_not_depend_on_the_threads) {
  const int64_t n = 40000;
  double *x = malloc(3 * (size_t)n * sizeof *x);
  assert_non_null(x);
  scoped_context *serial = test_context(MPS_CONTEXT_EXECUTOR_SERIAL, 1);
  for (int32_t dim = 2; dim <= 3; dim++)
    for (int32_t half = 0; half < 2; half++) {
      make_cloud(UNIFORM, dim, n, x);
      scoped_neighbours *expected = lists_of(serial, x, n, dim, 0.4, half);
      const int64_t *offsets, *indices, *other_offsets, *other_indices;
      OK(mps_neighbours_lists(expected, NULL, &offsets, &indices));
      for (int t = 0; t < 4; t++) {
        int32_t threads = (const int32_t[]){1, 2, 3, 8}[t];
        const mps_context_def def = pthread_executor_def(&threads);
        scoped_context *context = NULL;
        assert_int_equal(mps_context_create(&def, &context, NULL, 0), MPS_OK);
        scoped_neighbours *nb = lists_of(context, x, n, dim, 0.4, half);
        OK(mps_neighbours_lists(nb, NULL, &other_offsets, &other_indices));
        assert_memory_equal(offsets, other_offsets, (size_t)(n + 1) * sizeof *offsets);
        assert_memory_equal(indices, other_indices, (size_t)offsets[n] * sizeof *indices);
      }
      assert_true(offsets[n] > 3000);
    }
  free(x);
}
