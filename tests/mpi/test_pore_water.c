/* test_pore_water.c - implicit pressures of pore water solved by PETSc, on the ranks that mpirun
 * starts and on each alone, beside the library's own solution.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "world.h"
#include "petsc_solves.h"

#include <math.h>
#include <string.h>

typedef struct scene {
  mps_particles *set;
  mps_material *material;
  mps_mpm *mpm;
} scene;

/* Ground 26 cells wide that falls on a slope of the load, drained at its surface. */
static mps_status make_set(mps_particles **out) {
  DEF(particles, def, .spacing = 0.02);
  const double lo[2] = {0.0, 0.0}, hi[2] = {1.04, 0.63};
  mps_view x;
  mps_edit v;
  mps_status status = mps_particles_create(own, &def, out);
  if (status == MPS_OK) status = mps_particles_fill_box(*out, lo, hi, NULL);
  if (status == MPS_OK) status = mps_particles_set(*out, "density", 0, 2000.0);
  if (status == MPS_OK) status = mps_particles_set(*out, "velocity", 0, 0.0);
  if (status == MPS_OK) status = mps_particles_view(*out, "position", &x);
  if (status == MPS_OK) status = mps_particles_edit(*out, "velocity", &v);
  if (status != MPS_OK) return status;
  for (int64_t k = 0; k < x.shape[0]; k++)
    *mps_edit_f64(&v, k, 1) = -0.2 - 0.2 * sin(4.0 * *mps_view_f64(&x, k, 0));
  return mps_particles_commit(*out, &v);
}

static void make_scene(mps_domain *of, scene *s) {
  mps_mpm_def def = mps_mpm_defaults();
  mps_pore_water_def water = mps_pore_water_defaults();
  OK(make_set(&s->set));
  OK(mps_material_create_linear_elastic(own, 1e6, 0.3, &s->material));
  def.domain = of;
  def.cell = 0.04;
  def.gravity[1] = -9.81;
  def.lower[0] = def.lower[1] = 0.0;
  def.upper[0] = 1.04;
  OK(mps_mpm_create(own, s->set, s->material, &def, &s->mpm));
  water.scheme = MPS_PORE_SCHEME_IMPLICIT;
  water.porosity = 0.4, water.permeability = 1e-4;
  OK(mps_mpm_add_pore_water(s->mpm, &water));
}

static void drop_scene(scene *s) {
  mps_mpm_destroy(&s->mpm);
  mps_material_destroy(&s->material);
  mps_particles_destroy(&s->set);
}

enum { STEPS = 6 };

/* Largest difference of the pressures of this rank's particles from those of the whole set, over
 * the highest. */
static double compare(const scene *alone, const scene *share) {
  mps_view u[2], id;
  double worst = 0.0, highest = 0.0;
  OK(mps_particles_view(alone->set, "pore_pressure", &u[0]));
  OK(mps_particles_view(share->set, "pore_pressure", &u[1]));
  OK(mps_particles_view(share->set, "id", &id));
  for (int64_t i = 0; i < u[0].shape[0]; i++)
    highest = fmax(highest, fabs(*mps_view_f64(&u[0], i, 0)));
  for (int64_t i = 0; i < u[1].shape[0]; i++) {
    const int64_t at = mps_particles_index(alone->set, *mps_view_i64(&id, i, 0));
    assert_true(at >= 0);
    worst = fmax(worst, fabs(*mps_view_f64(&u[1], i, 0) - *mps_view_f64(&u[0], at, 0)));
  }
  assert_true(highest > 100.0);
  return worst / highest;
}

static void compare_method(int32_t method, int64_t most) {
  mps_petsc_solver *solver[2] = {NULL, NULL};
  scene reference = {NULL, NULL, NULL}, s[2] = {{NULL, NULL, NULL}, {NULL, NULL, NULL}};
  make_scene(NULL, &reference);
  OK(mps_mpm_step(reference.mpm, STEPS));
  assert_int_equal(mps_petsc_solver_create(own, method, &solver[0]), MPS_OK);
  assert_int_equal(mps_petsc_solver_create_world(own, method, &solver[1]), MPS_OK);
  for (int k = 0; k < 2; k++) {
    mps_pore_report report;
    make_scene(k ? domain : NULL, &s[k]);
    OK(petsc_solves(solver[k], mps_mpm_solver(s[k].mpm), MPS_LINEAR_EQUATION_PORE_PRESSURE, 0));
    OK(mps_mpm_step(s[k].mpm, STEPS));
    OK(mps_mpm_get_pore_report(s[k].mpm, &report));
    const double error = compare(&reference, &s[k]);
    print_message("%s: %d rows, %d iterations, differs by %.1e of the highest pressure\n",
                  k ? "all ranks" : "one", (int)report.unknowns, (int)report.iterations, error);
    assert_true(error < 1e-7);
    assert_true(report.unknowns > 300 && report.coarse == 0);
    assert_true(report.iterations > 0 && report.iterations <= most);
  }
  if (mps_domain_size(domain) > 1) { /* those of other processes do not fit */
    assert_int_equal(
        petsc_solves(solver[0], mps_mpm_solver(s[1].mpm), MPS_LINEAR_EQUATION_PORE_PRESSURE, 0),
        MPS_ERROR_ARGUMENT);
    assert_int_equal(
        petsc_solves(solver[1], mps_mpm_solver(s[0].mpm), MPS_LINEAR_EQUATION_PORE_PRESSURE, 0),
        MPS_ERROR_ARGUMENT);
  }
  for (int k = 0; k < 2; k++) {
    drop_scene(&s[k]);
    mps_petsc_solver_destroy(&solver[k]);
  }
  drop_scene(&reference);
}

TEST(test_multigrid) { compare_method(MPS_PETSC_METHOD_MULTIGRID, 60); }

TEST(test_direct) { compare_method(MPS_PETSC_METHOD_DIRECT, 2); }

int main(void) { return begin_world() ? end_world(test_run()) : 1; }
