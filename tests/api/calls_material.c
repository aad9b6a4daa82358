/* calls_material.c - laws, also of the caller's own, and their use without a solver.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "calls.h"

#include <float.h>

#include <mps/soil.h>
#include <mps/experimental/material_point.h>
#include <mps/experimental/soil.h>

#define YOUNG 1e-6, 1e18, 1e6
#define POISSON -0.999, 0.49999, 0.3

static bool made_material(api *a, mps_status status, mps_material **made) {
  return api_end_made(a, status, API_MATERIAL, *made, NULL);
}

static void material_linear_elastic(api *a) {
  mps_material *made = NULL;
  mps_context *context = api_context(a);
  const double young = api_real(a, "young", YOUNG), poisson = api_real(a, "poisson", POISSON);
  (void)made_material(a,
                      mps_material_create_linear_elastic(context, young, poisson,
                                                         api_null(a, "out") ? NULL : &made),
                      &made);
}

static void material_neo_hookean(api *a) {
  mps_material *made = NULL;
  mps_context *context = api_context(a);
  const double young = api_real(a, "young", YOUNG), poisson = api_real(a, "poisson", POISSON);
  (void)made_material(
      a,
      mps_material_create_neo_hookean(context, young, poisson, api_null(a, "out") ? NULL : &made),
      &made);
}

/* A law of a definition: the members that are drawn. */
#define LAW(name, KIND, members)                                                                   \
  static void material_##name(api *a) {                                                            \
    mps_material *made = NULL;                                                                     \
    mps_context *context = api_context(a);                                                         \
    mps_material_##name##_def def = mps_material_##name##_defaults();                              \
    api_define(a, MPS_DEF_MATERIAL_##KIND, &def, 0, members);                                      \
    const mps_material_##name##_def *given = api_null(a, "def") ? NULL : &def;                     \
    mps_material **out = api_null(a, "out") ? NULL : &made;                                        \
    (void)made_material(a, mps_material_create_##name(context, given, out), &made);                \
  }
#define SOIL "young 1e6, poisson 0.3, friction 0.5, dilation? 0.1, cohesion? 10"
#define VOIDS ", void_ratio? 0.5, max_void_ratio? 0.9"
LAW(von_mises, VON_MISES, "young 1e6, poisson 0.3, yield_stress 1e4, hardening? 1e3, residual? 0.5, "
                          "slip? 0.1, band? 0.5, rate_factor? 0.1, rate_reference? 1e-6")
LAW(drucker_prager, DRUCKER_PRAGER, SOIL ", cone, tension? 10" VOIDS)
LAW(mohr_coulomb, MOHR_COULOMB, SOIL ", tension? 10, residual_friction? 0.3, softening, slip? 0.1, "
                                     "band? 0.5" VOIDS)
LAW(newtonian, NEWTONIAN, "state, bulk_modulus 1e6, viscosity? 1, no_tension")
LAW(cam_clay, CAM_CLAY, "critical_slope 1, compression 0.2, swelling 0.04, poisson 0.3, "
                        "shear_modulus? 1e6, void_ratio 1, preconsolidation 1e5, "
                        "least_pressure? 100, lode")

/* Laws whose stresses have energies that need not add up. */
#define LOOSE_LAW(name, KIND, members)                                                             \
  LAW(name, KIND, members)                                                                         \
  static void material_loose_##name(api *a) {                                                      \
    api_loosen(a);                                                                                 \
    material_##name(a);                                                                            \
  }
LOOSE_LAW(small_strain, SMALL_STRAIN, "shear_modulus 1e7, poisson 0.3, reference_strain 1e-3")
LOOSE_LAW(cyclic_sand, CYCLIC_SAND, "young 1e6, poisson 0.3, friction 0.6, relative_density 0.5, "
                                    "threshold 1e-4, strain_limit 0.02" VOIDS)

static void material_by_field(api *a) {
  mps_material *made = NULL;
  mps_context *context = api_context(a);
  const mps_material *law = api_any(a, API_MATERIAL)->handle;
  api_loosen(a);
  (void)made_material(
      a, mps_material_create_by_field(context, law, api_null(a, "out") ? NULL : &made), &made);
}

static void normal_k0(api *a) {
  const mps_material *material = api_any(a, API_MATERIAL)->handle;
  a->wrong = 0; /* NaN of what is no Cam-Clay */
  const double k0 = mps_material_normal_k0(material);
  a->reads = true;
  if (!isnan(k0) && !(k0 > 0.0 && k0 < 1.0)) api_broken(a, "K0 is %g", k0);
  (void)api_end(a, MPS_OK);
}

/* ---- the caller's own ------------------------------------------------------------------------ */

static void material_user(api *a) {
  static const char *const columns[] = {"age", "b_2"}, *const bad[] = {"age", "no good"};
  mps_material *made = NULL;
  mps_context *context = api_context(a);
  mps_material_user_def def = mps_material_user_defaults();
  const double initial[] = {a->mood != API_ABSURD || api_chance(a, 90) ? 0.5 : NAN, 2.0};
  def.history = columns;
  def.history_initial = initial;
  def.update = a->mood != API_ABSURD || api_chance(a, 95) ? api_law : NULL;
  def.user = &a->plan;
  api_define(a, MPS_DEF_MATERIAL_USER, &def, 0,
             "history_count 2, wave_modulus 1e6, viscosity? 1, needs_deformation, turns_stress");
  if (def.history_count > 2) def.history_count = 2;
  if (a->mood == API_ABSURD && def.history_count == 2 && api_chance(a, 20))
    def.history = bad, api_wrong(a, "history");
  if (api_chance(a, 30)) def.name = "my_law";
  if (a->mood == API_ABSURD && api_chance(a, 10)) def.name = "my law", api_wrong(a, "name");
  (void)made_material(a, mps_material_create_user(context, &def, api_null(a, "out") ? NULL : &made),
                      &made);
}

static void material_umat(api *a) {
  mps_material *made = NULL;
  mps_context *context = api_context(a);
  mps_material_umat_def def = mps_material_umat_defaults();
  const double props[] = {a->mood != API_ABSURD || api_chance(a, 90) ? 0.5 : NAN};
  def.props = props;
  def.props_count = 1;
  def.umat = a->mood != API_ABSURD || api_chance(a, 95) ? api_umat : NULL;
  api_define(a, MPS_DEF_MATERIAL_UMAT, &def, 0,
             "statev_count 3, wave_modulus 1e6, length 1, temperature 300, keeps_strain, "
             "needs_deformation");
  (void)made_material(a, mps_material_create_umat(context, &def, api_null(a, "out") ? NULL : &made),
                      &made);
}

/* ---- questions ------------------------------------------------------------------------------- */

API_DESTROY(material_destroy, API_MATERIAL)
API_QUERY(material_name, API_MATERIAL)
API_QUERY(material_wave_modulus, API_MATERIAL)
API_QUERY(material_history_count, API_MATERIAL)

static void material_history(api *a) {
  const mps_material *material = api_any(a, API_MATERIAL)->handle;
  const int32_t count = mps_material_history_count(material);
  const int32_t index = (int32_t)api_whole(a, "index", 0, count > 0 ? count - 1 : 0);
  const bool inside = material && index >= 0 && index < count;
  const char *name = mps_material_history_name(material, index);
  if (inside != (name != NULL)) api_broken(a, "name of column %d of %d", index, count);
  api_end_query(a);
  api_end_query(a);
  api_begin(a, "mps_material_history_initial");
  if (!isfinite(mps_material_history_initial(material, index))) api_broken(a, "not finite");
  api_end_query(a);
}

static void check_moduli(api *a, mps_status status, const mps_moduli *out, size_t size) {
  if (status != MPS_OK || size < sizeof *out) return;
  const double *values = &out->young;
  for (int k = 0; k < 9; k++)
    if (!isfinite(values[k])) api_broken(a, "modulus %d is %g", k, values[k]);
}

static void moduli_from_elastic(api *a) {
  mps_context *context = api_context(a);
  const double young = api_real(a, "young", YOUNG), poisson = api_real(a, "poisson", POISSON);
  const double density = api_real(a, "density", 1e-9, 1e9, 1000.0);
  API_SIZED(a, mps_moduli, size, out);
  const mps_status status =
      mps_moduli_from_elastic_sized(context, young, poisson, density, out, size);
  check_moduli(a, status, out, size);
  API_SIZED_END(a, status, size, out, true);
}

static void moduli_from_velocities(api *a) {
  mps_context *context = api_context(a);
  const double vs = api_real(a, "shear_velocity", 1e-6, 1e9, 100.0);
  const double vp = api_real(a, "pressure_velocity", 1e-6, 1e12, 200.0);
  const double density = api_real(a, "density", 1e-9, 1e9, 1000.0);
  API_SIZED(a, mps_moduli, size, out);
  const mps_status status = mps_moduli_from_velocities_sized(context, vs, vp, density, out, size);
  check_moduli(a, status, out, size);
  API_SIZED_END(a, status, size, out, true);
}

static void material_get_moduli(api *a) {
  const mps_material *material = api_any(a, API_MATERIAL)->handle;
  const double density = api_real(a, "density", 1e-9, 1e9, 1000.0);
  API_SIZED(a, mps_moduli, size, out);
  const mps_status status = mps_material_get_moduli_sized(material, density, out, size);
  check_moduli(a, status, out, size);
  API_SIZED_END(a, status, size, out, true);
}

/* ---- use without a solver -------------------------------------------------------------------- */

enum { BLOCK = 3, HISTORY = 24 };

static void material_update(api *a) {
  static double columns[9 + 9 + 1 + 6 + HISTORY][BLOCK];
  double *history[HISTORY];
  int64_t flags[BLOCK] = {0}, refused = -1;
  char message[64] = "";
  mps_context *context = api_context(a);
  const mps_material *material = api_any(a, API_MATERIAL)->handle;
  memset(columns, 0, sizeof columns);
  mps_material_block block = mps_material_block_defaults();
  block.struct_size = api_struct_size(a, sizeof block);
  block.dim = (int32_t)api_whole(a, "dim", 2, 3);
  block.count = api_least(a, "count", 0, BLOCK);
  block.dt = api_real(a, "dt", 5e-324, DBL_MAX, 1e-3);
  double slope[9];
  const int before = a->wrong;
  api_vector(a, "gradient", 9, 0.0, 1.0, slope);
  a->wrong = before; /* values are not checked */
  for (int k = 0; k < 9; k++) {
    for (int i = 0; i < BLOCK; i++) columns[k][i] = slope[k], columns[9 + k][i] = k % 4 == 0;
    block.gradient[k] = columns[k];
    block.deformation[k] = columns[9 + k];
  }
  for (int i = 0; i < BLOCK; i++) columns[18][i] = 1.0;
  block.volume_ratio = columns[18];
  for (int k = 0; k < 6; k++) block.stress[k] = columns[19 + k];
  for (int k = 0; k < HISTORY; k++) history[k] = columns[25 + k];
  block.history = history;
  block.history_count = api_chance(a, 90) ? HISTORY : (int32_t)api_below(a, 2);
  block.flags = flags;
  block.message = message, block.message_size = sizeof message, block.refused = &refused;
  if (a->mood == API_ABSURD && api_chance(a, 10)) block.stress[0] = NULL, api_wrong(a, "stress");
  a->wrong *= block.count > 0 || !material; /* of an empty block nothing is read */
  (void)api_end(a, mps_material_update(context, material, &block));
}

static void material_point(api *a) {
  mps_material_point point;
  memset(&point, 0, sizeof point);
  mps_context *context = api_context(a);
  const mps_material *material = api_any(a, API_MATERIAL)->handle;
  const mps_status begun =
      mps_material_point_init(context, material, api_null(a, "point") ? NULL : &point);
  a->reads = true;
  if (!api_end(a, begun)) return;
  api_begin(a, "mps_material_point_drive");
  double gradient[9];
  api_vector(a, "gradient", 9, 0.0, 1.0, gradient);
  const double duration = api_real(a, "duration", 5e-324, DBL_MAX, 0.01);
  const int64_t steps = api_least(a, "steps", 1, 20);
  const mps_status status =
      mps_material_point_drive(context, material, &point, gradient, duration, steps);
  for (int k = 0; status == MPS_OK && k < 6; k++)
    if (!isfinite(point.stress[k]))
      api_broken(a, "succeeds, and stress[%d] is %g", k, point.stress[k]);
  if (!api_end(a, status)) return;
  api_begin(a, "mps_material_point_control");
  double target[6] = {0.0}, still[9] = {0.0};
  for (int k = 0; k < 3; k++) target[k] = point.stress[k];
  const uint32_t bits = (uint32_t)api_below(a, 8);
  const mps_status held = mps_material_point_control(context, material, &point, still, bits, target,
                                                     0.01, 1 + (int64_t)api_below(a, 3), NULL);
  for (int k = 0; held == MPS_OK && k < 3; k++)
    if ((bits >> k & 1) && !(fabs(point.stress[k] - target[k]) <= 1e-6 * fabs(target[k]) + 1.0))
      api_broken(a, "stress[%d] is %g, not its target %g", k, point.stress[k], target[k]);
  (void)api_end(a, held);
}

static const api_call calls[] = {
    {"mps_material_create_linear_elastic", 6, API_CONTEXT, material_linear_elastic},
    {"mps_material_create_neo_hookean", 2, API_CONTEXT, material_neo_hookean},
    {"mps_material_create_von_mises", 2, API_CONTEXT, material_von_mises},
    {"mps_material_create_drucker_prager", 2, API_CONTEXT, material_drucker_prager},
    {"mps_material_create_mohr_coulomb", 2, API_CONTEXT, material_mohr_coulomb},
    {"mps_material_create_cam_clay", 2, API_CONTEXT, material_cam_clay},
    {"mps_material_create_small_strain", 2, API_CONTEXT, material_loose_small_strain},
    {"mps_material_create_cyclic_sand", 2, API_CONTEXT, material_loose_cyclic_sand},
    {"mps_material_create_by_field", 1, API_MATERIAL, material_by_field},
    {"mps_material_normal_k0", 1, API_MATERIAL, normal_k0},
    {"mps_material_create_newtonian", 2, API_CONTEXT, material_newtonian},
    {"mps_material_create_user", 3, API_CONTEXT, material_user},
    {"mps_material_create_umat", 2, API_CONTEXT, material_umat},
    {"mps_material_destroy", 1, API_MATERIAL, destroy_material_destroy},
    {"mps_material_name", 1, API_MATERIAL, query_material_name},
    {"mps_material_wave_modulus", 1, API_MATERIAL, query_material_wave_modulus},
    {"mps_material_history_count", 1, API_MATERIAL, query_material_history_count},
    {"mps_material_history_name", 2, API_MATERIAL, material_history},
    {"mps_material_history_initial", 0, API_MATERIAL, material_history},
    {"mps_moduli_from_elastic_sized", 2, API_CONTEXT, moduli_from_elastic},
    {"mps_moduli_from_velocities_sized", 2, API_CONTEXT, moduli_from_velocities},
    {"mps_material_get_moduli_sized", 2, API_MATERIAL, material_get_moduli},
    {"mps_material_update", 4, API_MATERIAL, material_update},
    {"mps_material_point_init", 4, API_MATERIAL, material_point},
    {"mps_material_point_drive", 0, API_MATERIAL, material_point},
    {"mps_material_point_control", 0, API_MATERIAL, material_point},
};
const api_table api_material_calls = API_TABLE(calls);
