/* test_domain_clay.c - ground of Cam-Clay with K0 and OCR, and of the small-strain law, on several
 * ranks: from sets that every rank has whole, and from sets that lie in parts on the ranks, each
 * particle has the first state and the bits of the run without a domain.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "mpm_ranks.h"
#include "ranks_team.h"

enum { WHOLE, IN_PARTS };
#define SURFACE 0.4 /* m */

static mps_status make_ground(mps_context *own, mps_domain *domain, mps_particles **out) {
  DEF(particles, def, .spacing = 0.02);
  mps_status status = domain ? mps_domain_create_particles(domain, &def, out)
                             : mps_particles_create(own, &def, out);
  TRY(mps_particles_fill_box(*out, AT(0.0, 0.0), AT(1.2, SURFACE), NULL));
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
  DEF(material_cam_clay, clay, .critical_slope = 1.0, .compression = 0.15, .swelling = 0.03,
      .void_ratio = 1.2, .preconsolidation = 60e3, .lode = 1);
  DEF(material_small_strain, small, .shear_modulus = 1e6, .reference_strain = 1e-3);
  const mps_status status = mps_material_create_cam_clay(own, &clay, &s->material[0]);
  return status == MPS_OK ? mps_material_create_small_strain(own, &small, &s->material[1]) : status;
}

/* The weight, K0 of an overconsolidated clay, void ratios by the critical state line. */
static mps_status set_rest(scene *s) {
  const mps_geostatic_layer layer = {INFINITY, 0.5, NAN};
  DEF(geostatic, weight, .layers = &layer, .layer_count = 1, .surface = SURFACE, .surcharge = 10e3);
  DEF(consolidation, rest, .ocr = 1.5, .pop = 2e3, .critical_volume = 2.6);
  mps_status status = mps_particles_set_geostatic(s->set, &weight);
  TRY(mps_particles_set_consolidation(s->set, s->material[0], &rest));
  return status;
}

static mps_status compute_clay(mps_context *own, mps_domain *domain, int what, int64_t steps,
                               result *r) {
  SCOPED(end_scene) scene s = {.set = NULL};
  int64_t ids[300];
  for (int64_t k = 0; k < 300; k++) ids[k] = 500 + k;
  DEF(mpm, def, .domain = domain, .cell = 0.04, .gravity[1] = -9.81, .budget = 1,
      .lower[0] = def.lower[1] = 0.0, .upper[0] = 1.2);
  mps_status status = make_laws(own, &s);
  if (domain) status = mps_domain_agree(domain, status);
  TRY(make_ground(own, what == IN_PARTS ? domain : NULL, &s.set));
  TRY(set_rest(&s));
  if (domain) status = mps_domain_agree(domain, status);
  TRY(mps_mpm_create(own, s.set, s.material[0], &def, &s.mpm));
  TRY(mps_mpm_set_material(s.mpm, s.material[1], ids, 300));
  TRY(mps_mpm_set_side(s.mpm, MPS_SIDE_Y_LOWER, MPS_BOUNDARY_HELD, 0.0));
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
  return status;
}

TEST(test_whole) { compare_teams(compute_clay, WHOLE, 80, true); }

TEST(test_in_parts) { compare_teams(compute_clay, IN_PARTS, 80, true); }

/* The first state, without a solver: each rank's part has the values of the whole set. */
static mps_status compute_rest(mps_context *own, mps_domain *domain, int what, int64_t steps,
                               result *r) {
  SCOPED(end_scene) scene s = {.set = NULL};
  (void)what, (void)steps;
  mps_status status = make_laws(own, &s);
  if (domain) status = mps_domain_agree(domain, status);
  TRY(make_ground(own, domain, &s.set));
  TRY(set_rest(&s));
  TRY(keep(s.set, r));
  return status;
}

TEST(test_rest) { compare_teams(compute_rest, IN_PARTS, 0, false); }
