/* test_fluid.c - the fluid on the ranks that mpirun starts: each rank computes it alone, then all
 * of them together, and compares bit for bit. SPDX-License-Identifier: BSD-3-Clause */
#include "fluid_ranks.h"
#include "world.h"
#include "petsc_solves.h"

TEST(test_collapse) { compare_shares(own, domain, compute, COLLAPSE, 12); }
TEST(test_afloat) { compare_shares(own, domain, compute, AFLOAT, 6); }
TEST(test_spill) { compare_shares(own, domain, compute, SPILL, 24); }
TEST(test_classical) { compare_shares(own, domain, compute, CLASSICAL, 6); }

/* The pressure by PETSc's multigrid, on all ranks, of which a third one has no rows, and on each
 * alone. */
TEST(test_multigrid) {
  mps_petsc_solver *solvers[2] = {NULL, NULL};
  scene s[2] = {{.set = NULL}, {.set = NULL}};
  assert_int_equal(mps_petsc_solver_create(own, MPS_PETSC_METHOD_MULTIGRID, &solvers[0]), MPS_OK);
  assert_int_equal(mps_petsc_solver_create_world(own, MPS_PETSC_METHOD_MULTIGRID, &solvers[1]),
                   MPS_OK);
  for (int k = 0; k < 2; k++) {
    OK(make_scene(own, k ? domain : NULL, EXACT, &s[k]));
    OK(petsc_solves(solvers[k], mps_fluid_solver(s[k].fluid), MPS_LINEAR_EQUATION_PRESSURE, 0));
    OK(mps_fluid_step(s[k].fluid, 3));
  }
  mps_view v[2], p[2];
  for (int k = 0; k < 2; k++) {
    OK(mps_particles_view(s[k].set, "velocity", &v[k]));
    OK(mps_particles_view(s[k].set, "pressure", &p[k]));
  }
  double fastest = 0.0, highest = 0.0;
  assert_int_equal(v[0].shape[0], v[1].shape[0]);
  for (int64_t i = 0; i < v[0].shape[0]; i++) {
    highest = fmax(highest, *mps_view_f64(&p[0], i, 0));
    for (int c = 0; c < 2; c++) fastest = fmax(fastest, fabs(*mps_view_f64(&v[0], i, c)));
  }
  assert_true(fastest > 0.0 && highest > 0.0);
  for (int64_t i = 0; i < v[0].shape[0]; i++) {
    NEAR(*mps_view_f64(&p[1], i, 0), *mps_view_f64(&p[0], i, 0), 1e-8 * highest);
    for (int c = 0; c < 2; c++)
      NEAR(*mps_view_f64(&v[1], i, c), *mps_view_f64(&v[0], i, c), 1e-8 * fastest);
  }
  if (mps_domain_size(domain) > 1) /* those of other processes do not fit */
    assert_int_equal(
        petsc_solves(solvers[0], mps_fluid_solver(s[1].fluid), MPS_LINEAR_EQUATION_PRESSURE, 0),
        MPS_ERROR_ARGUMENT);
  for (int k = 0; k < 2; k++) {
    drop_scene(&s[k]);
    mps_petsc_solver_destroy(&solvers[k]);
  }
}

int main(void) { return begin_world() ? end_world(test_run()) : 1; }
