/* test_unset.c - one rule for what a definition does not say: a real number is NaN, whether the
 * library finds it or the caller has to give it; 0 is a value. The table has every real number that
 * is NaN by default; a NaN that it lacks, in any definition struct, fails.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "test_fixture.h"

#include "core/internal.h"

#include <mps/elastic_solver.h>
#include <mps/fluid_solver.h>
#include <mps/mps.h>
#include <mps/mpm_settle.h>

typedef struct number {
  const char *type, *member;
  size_t at, bytes;
} number;

#define NUMBER(type, member)                                                                       \
  { #type, #member, offsetof(type, member), sizeof(((type *)NULL)->member) }

static const number unset[] = {
    NUMBER(mps_body_def, mass),
    NUMBER(mps_body_def, inertia),
    NUMBER(mps_body_motion, position),
    NUMBER(mps_body_motion, rotation),
    NUMBER(mps_contact_def, penalty),
    NUMBER(mps_contact_def, xi),
    NUMBER(mps_contact_def, offset),
    NUMBER(mps_contact_def, depth),
    NUMBER(mps_contact_def, strength),
    NUMBER(mps_contact_def, tolerance),
    NUMBER(mps_dynamics_boundary_def, lower),
    NUMBER(mps_dynamics_boundary_def, upper),
    NUMBER(mps_dynamics_boundary_def, density),
    NUMBER(mps_dynamics_boundary_def, shear_velocity),
    NUMBER(mps_dynamics_boundary_def, pressure_velocity),
    NUMBER(mps_dynamics_def, dt),
    NUMBER(mps_dynamics_def, period_x),
    NUMBER(mps_dynamics_load_def, lower),
    NUMBER(mps_dynamics_load_def, upper),
    NUMBER(mps_dynamics_load_def, area),
    NUMBER(mps_dynamics_predict_def, spacing),
    NUMBER(mps_dynamics_predict_def, shear_velocity),
    NUMBER(mps_dynamics_predict_def, pressure_velocity),
    NUMBER(mps_elastic_boundary_def, lower),
    NUMBER(mps_elastic_boundary_def, upper),
    NUMBER(mps_elastic_def, radius_ratio),
    NUMBER(mps_elastic_def, memory_limit),
    NUMBER(mps_elastic_def, bending),
    NUMBER(mps_elastic_motion_def, beta),
    NUMBER(mps_elastic_motion_def, gamma),
    NUMBER(mps_elastic_motion_def, ratio),
    NUMBER(mps_elastic_motion_def, frequency),
    NUMBER(mps_pore_water_def, porosity),
    NUMBER(mps_pore_water_def, permeability),
    NUMBER(mps_pore_water_def, bulk),
    NUMBER(mps_fluid_def, density),
    NUMBER(mps_fluid_def, viscosity),
    NUMBER(mps_fluid_def, level),
    NUMBER(mps_fluid_def, dt),
    NUMBER(mps_fluid_load_def, lower),
    NUMBER(mps_fluid_rock_def, porosity),
    NUMBER(mps_fluid_rock_def, diameter),
    NUMBER(mps_fluid_rock_def, KC),
    NUMBER(mps_fluid_load_def, upper),
    NUMBER(mps_geostatic_def, surface),
    NUMBER(mps_consolidation_def, k0),
    NUMBER(mps_table_def, reach),
    NUMBER(mps_consolidation_def, critical_volume),
    NUMBER(mps_material_cam_clay_def, critical_slope),
    NUMBER(mps_material_cam_clay_def, compression),
    NUMBER(mps_material_cam_clay_def, swelling),
    NUMBER(mps_material_cam_clay_def, shear_modulus),
    NUMBER(mps_material_cam_clay_def, void_ratio),
    NUMBER(mps_material_cam_clay_def, preconsolidation),
    NUMBER(mps_material_cam_clay_def, least_pressure),
    NUMBER(mps_material_small_strain_def, shear_modulus),
    NUMBER(mps_material_small_strain_def, reference_strain),
    NUMBER(mps_material_small_strain_def, strength),
    NUMBER(mps_material_cyclic_sand_def, young),
    NUMBER(mps_material_cyclic_sand_def, friction),
    NUMBER(mps_material_cyclic_sand_def, relative_density),
    NUMBER(mps_material_cyclic_sand_def, blow_count),
    NUMBER(mps_material_cyclic_sand_def, c1),
    NUMBER(mps_material_cyclic_sand_def, c2),
    NUMBER(mps_material_cyclic_sand_def, c3),
    NUMBER(mps_material_cyclic_sand_def, c4),
    NUMBER(mps_material_drucker_prager_def, young),
    NUMBER(mps_material_drucker_prager_def, friction),
    NUMBER(mps_material_mohr_coulomb_def, young),
    NUMBER(mps_material_mohr_coulomb_def, friction),
    NUMBER(mps_material_mohr_coulomb_def, residual_friction),
    NUMBER(mps_material_mohr_coulomb_def, residual_cohesion),
    NUMBER(mps_material_mohr_coulomb_def, slip),
    NUMBER(mps_material_mohr_coulomb_def, band),
    NUMBER(mps_material_newtonian_def, bulk_modulus),
    NUMBER(mps_material_umat_def, wave_modulus),
    NUMBER(mps_material_umat_def, bulk_modulus),
    NUMBER(mps_material_umat_def, shear_modulus),
    NUMBER(mps_material_user_def, wave_modulus),
    NUMBER(mps_material_user_def, bulk_modulus),
    NUMBER(mps_material_user_def, shear_modulus),
    NUMBER(mps_material_von_mises_def, young),
    NUMBER(mps_material_von_mises_def, yield_stress),
    NUMBER(mps_material_von_mises_def, slip),
    NUMBER(mps_material_von_mises_def, band),
    NUMBER(mps_mpm_def, cell),
    NUMBER(mps_mpm_def, measure),
    NUMBER(mps_mpm_def, dt),
    NUMBER(mps_mpm_settle_def, tolerance),
    NUMBER(mps_neighbours_def, radius),
    NUMBER(mps_particles_def, spacing),
    NUMBER(mps_absorber_def, depth),
    NUMBER(mps_absorber_def, period),
    NUMBER(mps_absorber_def, high_pass),
    NUMBER(mps_absorber_def, leak),
    NUMBER(mps_absorber_def, stroke),
    NUMBER(mps_absorber_def, acceleration),
    NUMBER(mps_eurotop_def, height),
    NUMBER(mps_eurotop_def, period),
    NUMBER(mps_eurotop_def, depth),
    NUMBER(mps_eurotop_def, crest),
    NUMBER(mps_eurotop_def, cotangent),
    NUMBER(mps_overtopping_def, resolved),
    NUMBER(mps_overtopping_def, depth),
    NUMBER(mps_goda_def, height),
    NUMBER(mps_goda_def, period),
    NUMBER(mps_goda_def, depth),
    NUMBER(mps_goda_def, seaward),
    NUMBER(mps_goda_def, berm_depth),
    NUMBER(mps_goda_def, base),
    NUMBER(mps_goda_def, crest),
    NUMBER(mps_goda_def, width),
    NUMBER(mps_goda_def, weight),
    NUMBER(mps_goda_def, arm),
    NUMBER(mps_sainflou_def, height),
    NUMBER(mps_sainflou_def, period),
    NUMBER(mps_sainflou_def, depth),
    NUMBER(mps_separation_def, depth),
    NUMBER(mps_separation_def, from),
    NUMBER(mps_separation_def, to),
    NUMBER(mps_separation_def, lower),
    NUMBER(mps_separation_def, upper),
    NUMBER(mps_waves_def, depth),
    NUMBER(mps_waves_def, height),
    NUMBER(mps_waves_def, period),
    NUMBER(mps_waves_def, repeat),
    NUMBER(mps_waves_def, crest),
    NUMBER(mps_waves_def, time),
    NUMBER(mps_waves_def, ramp),
    NUMBER(mps_waves_def, stroke),
    NUMBER(mps_waves_def, speed),
};

typedef mps_status (*init_fn)(void *def, size_t size);

typedef struct definition {
  const char *type;
  init_fn init;
  size_t size;
} definition;

/* The init functions take the type of their struct: one of void * for each. */
#define WRAPPED(type, init, version, size)                                                         \
  static mps_status unset_##init(void *def, size_t bytes) { return init((type *)def, bytes); }
#include "core/context/released_sizes.h"
MPSI_RELEASED_SIZES(WRAPPED)

#define ROW(type, init, version, size) {#type, unset_##init, sizeof(type)},
static const definition definitions[] = {MPSI_RELEASED_SIZES(ROW)};

/* Whether the table has the eight bytes at `at`. */
static bool is_listed(const char *type, size_t at) {
  for (size_t k = 0; k < sizeof unset / sizeof *unset; k++)
    if (strcmp(unset[k].type, type) == 0 && at >= unset[k].at && at < unset[k].at + unset[k].bytes)
      return true;
  return false;
}

static void unset_real_numbers_are_nan(void **state) {
  (void)state;
  for (size_t d = 0; d < sizeof definitions / sizeof *definitions; d++) {
    const definition *def = &definitions[d];
    double *words = calloc(1, def->size + sizeof *words);
    mps_assert_ok(context, def->init(words, def->size));
    for (size_t at = 0; at + sizeof *words <= def->size; at += sizeof *words) {
      const bool nan = isnan(words[at / sizeof *words]);
      if (nan != is_listed(def->type, at))
        fail_msg("%s: the number at byte %zu is %g by default, and the table of this test says %s",
                 def->type, at, words[at / sizeof *words], nan ? "nothing of it" : "NaN");
    }
    free(words);
  }
}

/* Each row is of a definition struct that there is. */
static void the_table_names_definitions(void **state) {
  (void)state;
  for (size_t k = 0; k < sizeof unset / sizeof *unset; k++) {
    bool found = false;
    for (size_t d = 0; d < sizeof definitions / sizeof *definitions; d++)
      found |= strcmp(definitions[d].type, unset[k].type) == 0;
    if (!found) fail_msg("%s has no init function", unset[k].type);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(unset_real_numbers_are_nan),
      cmocka_unit_test(the_table_names_definitions),
  };
  return cmocka_run_group_tests(tests, make_context, drop_context);
}
