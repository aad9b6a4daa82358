/* test_elastic_tolerance.c - steps of implicit elasticity whose equations are solved to a
 * tolerance: the budget of energies closes whatever is left of them, and the work of that is
 * `scheme`, which the tolerance bounds. SPDX-License-Identifier: BSD-3-Clause */
#include "test_fixture.h"

#define SPACING 0.1
#define YOUNG 1e6
#define DENSITY 1000.0

typedef struct budget {
  double missing, largest; /* J: of the sum of mps_totals; its largest term */
  double scheme, bound; /* J: largest |scheme|; sum over the steps of what the tolerance allows */
} budget;

static mps_elastic *make(mps_particles **set, int32_t solver, double tolerance, double dt,
                         double stiffness_damping) {
  static const double lo[2] = {0.0, 0.0}, hi[2] = {1.2, 0.4}, end[2] = {0.1, 0.4};
  mps_elastic_boundary_def left = mps_elastic_boundary_defaults();
  mps_elastic_motion_def motion = mps_elastic_motion_defaults();
  USING(particles, mps_particles_create(context, &given, set), .spacing = SPACING);
  OK(mps_particles_fill_box(*set, lo, hi, NULL));
  SET_FIELDS(*set, {"young", YOUNG}, {"poisson", 0.3}, {"density", DENSITY});
  DEF(elastic, how, .solver = solver, .tolerance = tolerance);
  MAKE_KEPT(elastic, e, create, context, *set, &how);
  for (int c = 0; c < 2; c++) left.lower[c] = lo[c], left.upper[c] = end[c];
  left.lower[2] = -INFINITY, left.upper[2] = INFINITY;
  OK(mps_elastic_add_boundary(e, &left, NULL));
  USING(elastic_load, mps_elastic_add_load(e, &given, NULL), .kind = MPS_ELASTIC_LOAD_VOLUME,
        .all = 1, .force[0] = 3e3, .force[1] = -2e3);
  motion.dt = dt, motion.stiffness_damping = stiffness_damping;
  OK(mps_elastic_start(e, &motion));
  return e;
}

/* Displacements and velocities of all particles, 4 values each. */
static void read_motion(mps_particles *set, double *out) {
  mps_view u = view_field(set, "displacement");
  mps_view v = view_field(set, "velocity");
  for (int64_t i = 0; i < u.shape[0]; i++)
    for (int c = 0; c < 2; c++) {
      out[4 * i + c] = *mps_view_f64(&u, i, c);
      out[4 * i + 2 + c] = *mps_view_f64(&v, i, c);
    }
}

/* A beam released under its load. In a step from u, v of dt the unknown correction w has the
 * right side F - K (u + dt v + dt^2 a/4) of the average acceleration, which is 4 M w/dt^2 + K w: of
 * at most (4 m/dt^2 + k) |w|, k the largest eigenvalue of K, some 8 E of a 2D lattice. The force
 * that a solution leaves is at most the tolerance times that, and works over du at both ends. */
static budget swing(int32_t solver, double tolerance, double dt, double stiffness_damping) {
  enum { MOST = 4 * 64 };
  static double now[MOST], then[MOST];
  scoped_particles *set = NULL;
  scoped_elastic *e = make(&set, solver, tolerance, dt, stiffness_damping);
  const double m = DENSITY * SPACING * SPACING,
               k = 8.0 * YOUNG * (1.0 + 2.0 * stiffness_damping / dt);
  budget b = {0.0, 0.0, 0.0, 0.0};
  double former = 0.0; /* N: bound of the force left by the step before */
  assert_true(4 * mps_particles_count(set) <= MOST);
  read_motion(set, then);
  for (int step = 0; step < 200; step++) {
    mps_totals t;
    double w = 0.0, moved = 0.0;
    OK(mps_elastic_step(e, 1));
    read_motion(set, now);
    for (int64_t i = 0; i < mps_particles_count(set); i++)
      for (int c = 0; c < 2; c++) {
        const double *a = then + 4 * i + c, *z = now + 4 * i + c;
        w += pow(0.5 * dt * (z[2] - a[2]), 2), moved += pow(z[0] - a[0], 2);
      }
    const double left = tolerance * (4.0 * m / (dt * dt) + k) * 2.0 * sqrt(w);
    b.bound += 0.5 * (former + left) * sqrt(moved);
    former = left;
    memcpy(then, now, sizeof now);
    OK(mps_elastic_get_totals(e, &t));
    const double sum = t.kinetic + t.strain + t.dissipated - t.work_loads - t.work_boundaries;
    b.missing = fmax(b.missing, fabs(sum));
    b.largest = fmax(b.largest, fmax(t.kinetic + t.strain, fabs(t.work_loads)));
    b.largest = fmax(b.largest, fabs(t.dissipated));
    b.scheme = fmax(b.scheme, fabs(t.scheme));
  }
  return b;
}

TEST(what_a_tolerance_leaves_is_counted) {
  static const double tolerances[] = {1e-2, 1e-4, 1e-6, 1e-8, 1e-10, 1e-12};
  double coarse = 0.0;
  for (size_t k = 0; k < sizeof tolerances / sizeof *tolerances; k++) {
    const budget b = swing(MPS_ELASTIC_SOLVER_CG, tolerances[k], 5e-3, 0.0);
    print_message("tolerance %g: the budget misses %.2g of %.3g J, scheme %.3g J of %.3g allowed\n",
                  tolerances[k], b.missing, b.largest, b.scheme, b.bound);
    assert_true(b.missing <= 1e-12 * b.largest);
    assert_true(b.scheme <= b.bound + 1e-12 * b.largest);
    if (k == 0) coarse = b.scheme;
  }
  assert_true(coarse > 1e-6); /* J: without it the budget would not close */
}

/* Damping by stiffness so large that rounding of the direct solution is a part of the forces. */
TEST(what_rounding_leaves_is_counted) {
  static const double damping[] = {0.0, 1.0, 1e12, 4e18};
  for (size_t k = 0; k < sizeof damping / sizeof *damping; k++) {
    const budget b = swing(MPS_ELASTIC_SOLVER_LDLT, 1e-10, 6e-4, damping[k]);
    print_message("stiffness damping %g s: misses %.2g of %.3g J, scheme %.3g J\n", damping[k],
                  b.missing, b.largest, b.scheme);
    assert_true(b.missing <= 1e-12 * fmax(b.largest, b.scheme));
    if (damping[k] == 0.0) assert_true(b.scheme <= 1e-12 * b.largest);
  }
}
