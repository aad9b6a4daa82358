/* test_mpm_grid.c - mps/grid.h: nodes of the present state, fields at points; that queries change
 * nothing.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "mpm_twins.h"
#include "pthread_executor.h"

enum { MOST = 40000 };

typedef struct nodes {
  int64_t count;
  double x[3 * MOST], v[3 * MOST], f[3 * MOST], mass[MOST];
} nodes;

static nodes *read_nodes(mps_mpm *mpm) {
  nodes *n = malloc(sizeof *n);
  assert_non_null(n);
  OK(mps_grid_get_nodes(mps_mpm_grid(mpm), MOST, &n->count, n->x, n->mass, n->v, n->f));
  assert_in_range(n->count, 1, MOST);
  return n;
}

/* A block that moves and turns; far from any side, or in a corner. */
static mpm_scene block(mps_context *context, int32_t geometry, bool corner) {
  const int dim = geometry == MPS_MPM_GEOMETRY_SPACE ? 3 : 2;
  mpm_scene s = mpm_scene_begin_in(context, dim, 0.05, 0.0, 0.0, 1e6);
  const double lo[3] = {corner ? 0.0 : 1.0, corner ? 0.0 : 1.0, corner ? 0.0 : 1.0};
  const double hi[3] = {lo[0] + 0.5, lo[1] + 0.7, lo[2] + 0.4};
  const double v0[3] = {0.3, -0.2, 0.1};
  const double plane[4] = {0.1, -0.4, 0.3, 0.2};
  const double space[9] = {0.1, -0.4, 0.2, 0.3, 0.2, -0.1, 0.05, 0.15, -0.3};
  OK(mps_particles_fill_box(s.particles, lo, hi, NULL));
  mpm_scene_affine(&s, v0, dim == 3 ? space : plane);
  DEF(mpm, def, .geometry = geometry, .cell = 0.1);
  for (int c = 0; c < dim; c++) def.lower[c] = 0.0, def.upper[c] = 4.0;
  def.gravity[1] = -9.81;
  mpm_scene_solve(&s, &def);
  return s;
}

TEST_SERIAL(nodes_have_the_particles_mass_and_momentum) {
  for (int32_t geometry = 0; geometry < 3; geometry++)
    for (int corner = 0; corner < 2; corner++) {
      scoped_mpm_scene s = block(context, geometry, corner != 0);
      nodes *n = read_nodes(s.mpm);
      const mps_totals t = mpm_scene_totals(&s);
      double mass = 0.0, momentum[3] = {0.0}, force[3] = {0.0}, extent = 0.0;
      for (int64_t k = 0; k < n->count; k++) {
        mass += n->mass[k];
        for (int c = 0; c < 3; c++) {
          momentum[c] += n->mass[k] * n->v[3 * k + c], force[c] += n->f[3 * k + c];
          const double cells = n->x[3 * k + c] / 0.1;
          NEAR(cells, nearbyint(cells), 1e-9);
          extent = fmax(extent, fabs(n->x[3 * k + c]));
        }
      }
      NEAR(mass, t.mass, 1e-13 * t.mass);
      for (int c = 0; c < 3 && !corner; c++) { /* in the corner the images give theirs */
        NEAR(force[c], c == 1 ? -9.81 * t.mass : 0.0, 1e-12 * 9.81 * t.mass);
        NEAR(momentum[c], t.linear[c], 1e-12 * t.mass);
      }
      assert_true(extent < 2.2);
      free(n);
    }
}

/* Uniform stress: forces inside the block vanish, those at its upper face pull it down by s A. */
TEST_SERIAL(forces_are_those_of_the_stress) {
  scoped_mpm_scene s = block(context, MPS_MPM_GEOMETRY_PLANE_STRAIN, false);
  OK(mps_particles_set(s.particles, "stress", 1, 1000.0));
  nodes *n = read_nodes(s.mpm);
  double upper = 0.0;
  for (int64_t k = 0; k < n->count; k++) {
    const double *x = n->x + 3 * k, pull = n->f[3 * k + 1] + 9.81 * n->mass[k];
    if (x[1] > 1.25 && x[1] < 1.45) NEAR(pull, 0.0, 1e-9);
    if (x[1] > 1.4) upper += pull;
  }
  NEAR(upper, -1000.0 * 0.5, 1e-9);
  free(n);
}

/* A few digits of a sequence that fills (0, 1). */
static double filling(int64_t k, int c) {
  static const double step[3] = {0.754877666, 0.569840291, 0.323947};
  return fmod((double)(k + 1) * step[c], 1.0);
}

TEST_SERIAL(linear_fields_are_reproduced) {
  for (int32_t geometry = 0; geometry < 3; geometry++)
    for (int32_t spline = 2; spline <= 3; spline++) {
      scoped_mpm_scene s = block(context, geometry, true);
      const int dim = geometry == MPS_MPM_GEOMETRY_SPACE ? 3 : 2;
      mps_mpm_def def;
      OK(mps_mpm_get_def(s.mpm, &def));
      def.spline = spline;
      mps_mpm_destroy(&s.mpm);
      OK(mps_mpm_create(context, s.particles, s.material, &def, &s.mpm));
      OK(mps_particles_add_field(s.particles, "user.tracer", 2));
      mps_view x = mpm_scene_view(&s, "position");
      mps_edit tracer;
      OK(mps_particles_edit(s.particles, "user.tracer", &tracer));
      for (int64_t k = 0; k < x.shape[0]; k++)
        for (int c = 0; c < 2; c++) {
          double value = 3.0 + c;
          for (int d = 0; d < dim; d++) value += (1.0 + d - 2.0 * c) * *mps_view_f64(&x, k, d);
          *mps_edit_f64(&tracer, k, c) = value;
        }
      OK(mps_particles_commit(s.particles, &tracer));
      enum { POINTS = 200 };
      static double points[3 * POINTS], both[2 * POINTS], one[POINTS];
      static int32_t states[POINTS];
      const double size[3] = {0.5, 0.7, 0.4};
      for (int64_t i = 0; i < POINTS; i++)
        for (int c = 0; c < 3; c++) points[3 * i + c] = size[c] * filling(i, c);
      mps_grid *grid = mps_mpm_grid(s.mpm);
      OK(mps_grid_evaluate(grid, "user.tracer", -1, POINTS, points, both, states));
      OK(mps_grid_evaluate(grid, "user.tracer", 1, POINTS, points, one, NULL));
      for (int64_t i = 0; i < POINTS; i++) {
        assert_int_equal(states[i], MPS_GRID_POINT_INSIDE);
        for (int c = 0; c < 2; c++) {
          double value = 3.0 + c;
          for (int d = 0; d < dim; d++) value += (1.0 + d - 2.0 * c) * points[3 * i + d];
          NEAR(both[2 * i + c], value, 1e-12);
        }
        assert_true(one[i] == both[2 * i + 1]);
      }
    }
}

TEST_SERIAL(points_know_where_they_are) {
  scoped_mpm_scene s =
      block(context, MPS_MPM_GEOMETRY_PLANE_STRAIN, true); /* 0.5 x 0.7 from the origin */
  mps_grid *grid = mps_mpm_grid(s.mpm);
  const double points[3 * 7] = {0.25, 0.35, 0.0, 0.25, 0.7, NAN, 0.5, 0.7,  0.0, 0.0, 0.0,
                                0.0,  0.25, 0.9, 0.0,  2.0, 2.0, 0.0, -0.1, 0.2, 0.0};
  const int32_t expected[7] = {0, 0, 0, 0, 1, 1, 2};
  double values[7];
  int32_t states[7];
  OK(mps_grid_evaluate(grid, "density", 0, 7, points, values, states));
  for (int i = 0; i < 7; i++) {
    assert_int_equal(states[i], expected[i]);
    if (expected[i] == 0)
      NEAR(values[i], 1000.0, 1e-9);
    else
      assert_true(isnan(values[i]));
  }
  double bad[3] = {INFINITY, 0.0, 0.0};
  int64_t count;
  assert_null(mps_mpm_grid(NULL));
  assert_int_equal(mps_grid_evaluate(NULL, "density", 0, 0, NULL, NULL, NULL), MPS_ERROR_ARGUMENT);
  assert_int_equal(mps_grid_get_nodes(NULL, 0, &count, NULL, NULL, NULL, NULL), MPS_ERROR_ARGUMENT);
  FAILS(mps_grid_evaluate(grid, "nothing", 0, 1, points, values, NULL), MPS_ERROR_FIELD, "nothing");
  FAILS(mps_grid_evaluate(grid, "id", 0, 1, points, values, NULL), MPS_ERROR_FIELD, "'id'");
  REFUSES(mps_grid_evaluate(grid, "stress", 4, 1, points, values, NULL), "to 3");
  REFUSES(mps_grid_evaluate(grid, "stress", 0, -1, points, values, NULL), "-1");
  REFUSES(mps_grid_evaluate(grid, "stress", 0, 1, bad, values, NULL), "x = inf");
  REFUSES(mps_grid_get_nodes(grid, 0, NULL, NULL, NULL, NULL, NULL), "count");
  mps_grid_info info;
  OK(mps_grid_get_info(grid, &info));
  NEAR(info.cell, 0.1, 0.0);
  assert_int_equal(info.dim, 2);
  assert_int_equal(info.spline, 3);
}

static mps_status ask(void *user, mps_mpm *mpm) {
  const double point[3] = {0.2, 0.15, 0.1};
  double value[9];
  nodes *n = read_nodes(mpm);
  free(n);
  ++*(int *)user;
  return mps_grid_evaluate(mps_mpm_grid(mpm), "velocity", -1, 1, point, value, NULL);
}

/* Bodies, friction, plastic soil, several threads: the run is the same bit for bit. */
TEST(asking_changes_nothing) {
  for (int32_t geometry = 0; geometry < 3; geometry++) {
    int32_t threads = 1 + geometry;
    scoped_context *context = on_threads(&threads);
    SCOPED(drop) scene x = build(context, geometry, &none), twin = build(context, geometry, &none);
    int calls = 0;
    const int64_t every = test_quick() ? 1 : 5;
    const double end = (double)(12 * every) * mps_mpm_dt(x.s.mpm);
    OK(mps_mpm_run(x.s.mpm, end, every, ask, &calls));
    OK(mps_mpm_run(twin.s.mpm, end, every, NULL, NULL));
    assert_true(calls > 10);
    same(&x, &twin);
  }
}

/* The weights as an object. */
TEST_SERIAL(weights_are_a_kernel) {
  scoped_mpm_scene s = block(context, MPS_MPM_GEOMETRY_PLANE_STRAIN, false);
  mps_mpm_def def;
  OK(mps_mpm_get_def(s.mpm, &def));
  mps_mpm_destroy(&s.mpm);
  assert_null(def.kernel);
  OK(mps_kernel_create(context, MPS_KERNEL_MPS, 0.2, &def.kernel));
  REFUSES(mps_mpm_create(context, s.particles, s.material, &def, &s.mpm), "kind is MPS_KERNEL_MPS");
  mps_kernel_destroy(&def.kernel);
  OK(mps_kernel_create(context, MPS_KERNEL_SPLINE2, 0.2, &def.kernel));
  REFUSES(mps_mpm_create(context, s.particles, s.material, &def, &s.mpm), "must be 1.5 cells");
  mps_kernel_destroy(&def.kernel);
  MAKE_KEPT(kernel, other, create, context, MPS_KERNEL_SPLINE2, 0.15);
  def.kernel = other;
  OK(mps_mpm_create(context, s.particles, s.material, &def, &s.mpm));
  mps_kernel_destroy(&def.kernel); /* the caller's share */
  OK(mps_mpm_get_def(s.mpm, &def));
  assert_int_equal(def.spline, 2);
  assert_ptr_equal(def.kernel, other);
  OK(mps_mpm_step(s.mpm, 3));
}
