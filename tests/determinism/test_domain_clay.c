/* test_domain_clay.c - ground of Cam-Clay with K0 and OCR, and of the small-strain law, on several
 * ranks: from sets that every rank has whole, and from sets that lie in parts on the ranks, each
 * particle has the first state and the bits of the run without a domain.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "mpm_ranks.h"
#include "ranks_team.h"

#include <mps/soil.h>

enum { WHOLE, IN_PARTS };
#define SURFACE 0.4 /* m */

static mps_status make_ground(mps_context *own, mps_domain *domain, mps_particles **out) {
  mps_particles_def def = mps_particles_defaults();
  def.spacing = 0.02;
  mps_status status = domain ? mps_domain_create_particles(domain, &def, out)
                             : mps_particles_create(own, &def, out);
  const double lo[2] = {0.0, 0.0}, hi[2] = {1.2, SURFACE};
  TRY(mps_particles_fill_box(*out, lo, hi, NULL));
  TRY(mps_particles_set(*out, "density", 0, 1800.0));
  TRY(mps_particles_add_field(*out, "velocity", 0));
  mps_view x;
  mps_edit v;
  TRY(mps_particles_view(*out, "position", &x));
  TRY(mps_particles_edit(*out, "velocity", &v));
  for (int64_t k = 0; status == MPS_OK && k < mps_particles_count(*out); k++) {
    *mps_edit_f64(&v, k, 0) = 0.8 * sin(6.0 * *mps_view_f64(&x, k, 1));
    *mps_edit_f64(&v, k, 1) = -0.5 * sin(5.0 * *mps_view_f64(&x, k, 0));
  }
  TRY(mps_particles_commit(*out, &v));
  return status;
}

static mps_status make_laws(mps_context *own, scene *s) {
  mps_material_cam_clay_def clay = mps_material_cam_clay_defaults();
  clay.critical_slope = 1.0, clay.compression = 0.15, clay.swelling = 0.03;
  clay.void_ratio = 1.2, clay.preconsolidation = 60e3, clay.lode = 1;
  mps_material_small_strain_def small = mps_material_small_strain_defaults();
  small.shear_modulus = 1e6, small.reference_strain = 1e-3;
  const mps_status status = mps_material_create_cam_clay(own, &clay, &s->material[0]);
  return status == MPS_OK ? mps_material_create_small_strain(own, &small, &s->material[1]) : status;
}

/* The weight, K0 of an overconsolidated clay, void ratios by the critical state line. */
static mps_status set_rest(scene *s) {
  const mps_geostatic_layer layer = {INFINITY, 0.5, NAN};
  mps_geostatic_def weight = mps_geostatic_defaults();
  weight.layers = &layer, weight.layer_count = 1;
  weight.surface = SURFACE, weight.surcharge = 10e3;
  mps_consolidation_def rest = mps_consolidation_defaults();
  rest.ocr = 1.5, rest.pop = 2e3, rest.critical_volume = 2.6;
  mps_status status = mps_particles_set_geostatic(s->set, &weight);
  TRY(mps_particles_set_consolidation(s->set, s->material[0], &rest));
  return status;
}

static mps_status compute_clay(mps_context *own, mps_domain *domain, int what, int64_t steps,
                               result *r) {
  scene s = {.set = NULL};
  int64_t ids[300];
  for (int64_t k = 0; k < 300; k++) ids[k] = 500 + k;
  mps_mpm_def def = mps_mpm_defaults();
  def.domain = domain;
  def.cell = 0.04, def.gravity[1] = -9.81, def.budget = 1;
  def.lower[0] = def.lower[1] = 0.0, def.upper[0] = 1.2;
  mps_status status = make_laws(own, &s);
  if (domain) status = mps_domain_agree(domain, status);
  TRY(make_ground(own, what == IN_PARTS ? domain : NULL, &s.set));
  TRY(set_rest(&s));
  if (domain) status = mps_domain_agree(domain, status);
  TRY(mps_mpm_create(own, s.set, s.material[0], &def, &s.mpm));
  TRY(mps_mpm_set_material(s.mpm, s.material[1], 300, ids));
  TRY(mps_mpm_set_side(s.mpm, MPS_MPM_SIDE_Y_LOWER, MPS_BOUNDARY_HELD, 0.0));
  mps_snapshot *then = NULL;
  TRY(mps_mpm_step(s.mpm, steps / 2));
  TRY(mps_mpm_snapshot(s.mpm, &then));
  TRY(mps_mpm_step(s.mpm, steps / 4));
  TRY(mps_mpm_rollback(s.mpm, then));
  mps_snapshot_destroy(&then);
  TRY(mps_mpm_step(s.mpm, steps - steps / 2));
  TRY(keep_scene(domain, SLIDE, &s, r));
  double lost = r->totals.dissipated; /* both laws have yielded */
  if (status == MPS_OK && !(lost > 0.0)) status = MPS_ERROR_INTERNAL;
  end_scene(&s);
  return status;
}

static void test_whole(void **state) { (void)state, compare_teams(compute_clay, WHOLE, 80, true); }

static void test_in_parts(void **state) {
  (void)state, compare_teams(compute_clay, IN_PARTS, 80, true);
}

/* The first state, without a solver: each rank's part has the values of the whole set. */
static mps_status compute_rest(mps_context *own, mps_domain *domain, int what, int64_t steps,
                               result *r) {
  scene s = {.set = NULL};
  (void)what, (void)steps;
  mps_status status = make_laws(own, &s);
  if (domain) status = mps_domain_agree(domain, status);
  TRY(make_ground(own, domain, &s.set));
  TRY(set_rest(&s));
  TRY(keep(s.set, r));
  end_scene(&s);
  return status;
}

static void test_rest(void **state) {
  (void)state, compare_teams(compute_rest, IN_PARTS, 0, false);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_rest),
      cmocka_unit_test(test_whole),
      cmocka_unit_test(test_in_parts),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
