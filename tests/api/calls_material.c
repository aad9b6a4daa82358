/* calls_material.c - laws, also of the caller's own, and their use without a solver.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "calls.h"

#include <float.h>

#include <mps/soil.h>

#define YOUNG 1e-6, 1e18, 1e6
#define POISSON -0.999, 0.49999, 0.3

static bool made_material(api *a, mps_status status, mps_material **made) {
  return api_end_made(a, status, API_MATERIAL, *made, NULL);
}

static void material_linear_elastic(api *a) {
  api_begin(a, "mps_material_create_linear_elastic");
  mps_material *made = NULL;
  mps_context *context = api_context(a);
  const double young = api_real(a, "young", YOUNG), poisson = api_real(a, "poisson", POISSON);
  (void)made_material(a,
                      mps_material_create_linear_elastic(context, young, poisson,
                                                         api_null(a, "out") ? NULL : &made),
                      &made);
}

static void material_neo_hookean(api *a) {
  api_begin(a, "mps_material_create_neo_hookean");
  mps_material *made = NULL;
  mps_context *context = api_context(a);
  const double young = api_real(a, "young", YOUNG), poisson = api_real(a, "poisson", POISSON);
  (void)made_material(
      a,
      mps_material_create_neo_hookean(context, young, poisson, api_null(a, "out") ? NULL : &made),
      &made);
}

API_INIT(material_von_mises_def)
API_INIT(material_drucker_prager_def)
API_INIT(material_mohr_coulomb_def)
API_INIT(material_newtonian_def)
API_INIT(material_cam_clay_def)
API_INIT(material_small_strain_def)
API_INIT(material_cyclic_sand_def)
API_INIT(material_user_def)
API_INIT(material_umat_def)
API_INIT(material_block)

static void material_von_mises(api *a) {
  api_begin(a, "mps_material_create_von_mises");
  mps_material *made = NULL;
  mps_context *context = api_context(a);
  mps_material_von_mises_def def = mps_material_von_mises_defaults();
  def.struct_size = api_struct_size(a, sizeof def);
  def.young = api_real(a, "young", YOUNG);
  def.poisson = api_real(a, "poisson", POISSON);
  def.yield_stress = api_real(a, "yield_stress", 5e-324, 1e18, 1e4);
  def.hardening = api_real(a, "hardening", 0.0, 1e18, 0.0);
  (void)made_material(
      a, mps_material_create_von_mises(context, api_null(a, "def") ? NULL : &def, &made), &made);
}

/* Angles and strengths, by which the two laws of soil are alike. */
#define DRAW_SOIL(a, def)                                                                          \
  do {                                                                                             \
    (def)->young = api_real(a, "young", YOUNG);                                                    \
    (def)->poisson = api_real(a, "poisson", POISSON);                                              \
    (def)->friction = api_real(a, "friction", 0.0, 1.5707963, 0.5);                                \
    (def)->dilation = api_real(a, "dilation", 0.0, 1.5707963, api_chance(a, 50) ? 0.0 : 0.2);      \
    (def)->cohesion = api_real(a, "cohesion", 0.0, 1e18, 100.0);                                   \
    if (api_chance(a, 20)) (def)->tension = api_real(a, "tension", 0.0, INFINITY, 10.0);           \
    const double beyond = nextafter(1.5707963, 2.0); /* below a right angle still */               \
    if ((def)->friction == beyond || (def)->dilation == beyond) (a)->wrong = 0;                    \
  } while (0)

static void material_drucker_prager(api *a) {
  api_begin(a, "mps_material_create_drucker_prager");
  mps_material *made = NULL;
  mps_context *context = api_context(a);
  mps_material_drucker_prager_def def;
  mps_material_drucker_prager_def_init(&def, sizeof def);
  def.struct_size = api_struct_size(a, sizeof def);
  def.cone = api_choice(a, "cone", 4);
  DRAW_SOIL(a, &def);
  mps_material **out = api_null(a, "out") ? NULL : &made;
  (void)made_material(a, mps_material_create_drucker_prager(context, &def, out), &made);
}

static void material_mohr_coulomb(api *a) {
  api_begin(a, "mps_material_create_mohr_coulomb");
  mps_material *made = NULL;
  mps_context *context = api_context(a);
  mps_material_mohr_coulomb_def def;
  mps_material_mohr_coulomb_def_init(&def, sizeof def);
  def.struct_size = api_struct_size(a, sizeof def);
  DRAW_SOIL(a, &def);
  mps_material **out = api_null(a, "out") ? NULL : &made;
  (void)made_material(a, mps_material_create_mohr_coulomb(context, &def, out), &made);
}

static void material_cam_clay(api *a) {
  api_begin(a, "mps_material_create_cam_clay");
  mps_material *made = NULL;
  mps_context *context = api_context(a);
  mps_material_cam_clay_def def = mps_material_cam_clay_defaults();
  def.struct_size = api_struct_size(a, sizeof def);
  def.critical_slope = api_real(a, "critical_slope", 0.05, 2.9, 1.0);
  const int wrong = a->wrong;
  def.compression = api_real(a, "compression", 0.1, 5.0, 0.2);
  def.swelling = api_real(a, "swelling", 1e-5, 0.09, 0.04);
  if (def.swelling >= 1e-5 && def.swelling < def.compression && def.compression <= 5.0)
    a->wrong = wrong; /* the bounds above only keep the two apart */
  def.poisson = api_real(a, "poisson", 0.0, 0.49, 0.3);
  def.void_ratio = api_real(a, "void_ratio", 0.01, 20.0, 1.0);
  def.preconsolidation = api_real(a, "preconsolidation", 1e-3, 1e12, 1e5);
  def.lode = api_choice(a, "lode", 2);
  (void)made_material(
      a, mps_material_create_cam_clay(context, &def, api_null(a, "out") ? NULL : &made), &made);
}

static void material_small_strain(api *a) {
  api_begin(a, "mps_material_create_small_strain");
  mps_material *made = NULL;
  mps_context *context = api_context(a);
  mps_material_small_strain_def def = mps_material_small_strain_defaults();
  def.struct_size = api_struct_size(a, sizeof def);
  def.shear_modulus = api_real(a, "shear_modulus", 1e-6, 1e17, 1e7);
  def.poisson = api_real(a, "poisson", -0.999, 0.49999, 0.3);
  def.reference_strain = api_real(a, "reference_strain", 1e-7, 1.0, 1e-3);
  api_loosen(a);
  (void)made_material(
      a, mps_material_create_small_strain(context, &def, api_null(a, "out") ? NULL : &made), &made);
}

static void material_cyclic_sand(api *a) {
  api_begin(a, "mps_material_create_cyclic_sand");
  mps_material *made = NULL;
  mps_context *context = api_context(a);
  mps_material_cyclic_sand_def def = mps_material_cyclic_sand_defaults();
  def.struct_size = api_struct_size(a, sizeof def);
  def.young = api_real(a, "young", YOUNG);
  def.poisson = api_real(a, "poisson", POISSON);
  def.friction = api_real(a, "friction", 0.01, 1.57, 0.6);
  def.relative_density = api_real(a, "relative_density", 0.1, 1.0, 0.5);
  def.threshold = api_real(a, "threshold", 0.0, 0.01, 1e-4);
  def.strain_limit = api_real(a, "strain_limit", 0.011, 1.0, 0.02);
  api_loosen(a);
  (void)made_material(
      a, mps_material_create_cyclic_sand(context, &def, api_null(a, "out") ? NULL : &made), &made);
}

static void material_by_field(api *a) {
  api_begin(a, "mps_material_create_by_field");
  mps_material *made = NULL;
  mps_context *context = api_context(a);
  const mps_material *law = api_any(a, API_MATERIAL)->handle;
  api_loosen(a);
  (void)made_material(
      a, mps_material_create_by_field(context, law, api_null(a, "out") ? NULL : &made), &made);
}

static void normal_k0(api *a) {
  api_begin(a, "mps_material_normal_k0");
  const mps_material *material = api_any(a, API_MATERIAL)->handle;
  a->wrong = 0; /* NaN of what is no Cam-Clay */
  const double k0 = mps_material_normal_k0(material);
  a->reads = true;
  if (!isnan(k0) && !(k0 > 0.0 && k0 < 1.0)) api_broken(a, "K0 is %g", k0);
  (void)api_end(a, MPS_OK);
}

static void material_newtonian(api *a) {
  api_begin(a, "mps_material_create_newtonian");
  mps_material *made = NULL;
  mps_context *context = api_context(a);
  mps_material_newtonian_def def = mps_material_newtonian_defaults();
  def.struct_size = api_struct_size(a, sizeof def);
  def.state = api_choice(a, "state", 2);
  def.bulk_modulus = api_real(a, "bulk_modulus", 5e-324, 1e18, 1e6);
  def.viscosity = api_real(a, "viscosity", 0.0, 1e18, api_chance(a, 50) ? 0.0 : 1.0);
  def.no_tension = (int32_t)api_below(a, 2);
  (void)made_material(
      a, mps_material_create_newtonian(context, &def, api_null(a, "out") ? NULL : &made), &made);
}

/* ---- the caller's own ------------------------------------------------------------------------ */

/* Elastic along each axis. Several threads call it at once: what it does follows from the block
 * alone, and from what was armed before the call. */
static mps_status law(void *user, const mps_material_block *block) {
  const api *a = user;
  const int axes = 3;
  const bool turn = a->fault != API_FAULT_NONE && block->count > 2 && a->fault_at <= 3;
  for (int64_t i = 0; i < block->count; i++)
    for (int k = 0; k < axes; k++) {
      const double *slope = block->gradient[4 * k];
      if (slope) block->stress[k][i] += 1e5 * block->dt * slope[i];
    }
  if (block->history_count > 0)
    for (int64_t i = 0; i < block->count; i++) block->history[0][i] += block->dt;
  if (!turn) return MPS_OK;
  if (a->fault == API_FAULT_VALUE) block->stress[0][0] = NAN;
  if (block->refused) *block->refused = 0;
  if (a->fault == API_FAULT_STATUS) return a->fault_status;
  return a->fault == API_FAULT_NO_STATUS ? (mps_status)99 : MPS_OK;
}

static void material_user(api *a) {
  api_begin(a, "mps_material_create_user");
  static const char *const columns[] = {"age", "b_2"}, *const bad[] = {"age", "no good"};
  mps_material *made = NULL;
  mps_context *context = api_context(a);
  mps_material_user_def def = mps_material_user_defaults();
  def.struct_size = api_struct_size(a, sizeof def);
  def.history_count = (int32_t)api_least(a, "history_count", 0, 2);
  const double initial[] = {api_near(a, "initial", 0.0, 1.0), 2.0};
  if (def.history_count < 1) a->wrong -= !isfinite(initial[0]);
  def.history = columns;
  if (a->mood == API_ABSURD && def.history_count == 2 && api_chance(a, 20))
    def.history = bad, api_wrong(a, "history");
  def.history_initial = initial;
  def.update = api_null(a, "update") ? NULL : law;
  def.user = a;
  def.wave_modulus = api_real(a, "wave_modulus", 5e-324, 1e18, 1e6);
  def.viscosity = api_real(a, "viscosity", 0.0, 1e18, 0.0);
  def.needs_deformation = (int32_t)api_below(a, 2);
  if (api_chance(a, 30)) def.name = "my_law";
  if (a->mood == API_ABSURD && api_chance(a, 10)) def.name = "my law", api_wrong(a, "name");
  (void)made_material(a, mps_material_create_user(context, &def, api_null(a, "out") ? NULL : &made),
                      &made);
}

static void umat(double *stress, double *statev, double *ddsdde, double *sse, double *spd,
                 double *scd, double *rpl, double *ddsddt, double *drplde, double *drpldt,
                 const double *stran, const double *dstran, const double *time, const double *dtime,
                 const double *temp, const double *dtemp, const double *predef, const double *dpred,
                 const char *cmname, const int32_t *ndi, const int32_t *nshr, const int32_t *ntens,
                 const int32_t *nstatv, const double *props, const int32_t *nprops,
                 const double *coords, const double *drot, double *pnewdt, const double *celent,
                 const double *dfgrd0, const double *dfgrd1, const int32_t *noel,
                 const int32_t *npt, const int32_t *layer, const int32_t *kspt,
                 const int32_t *kstep, const int32_t *kinc, size_t cmname_length) {
  (void)ddsdde, (void)sse, (void)spd, (void)scd, (void)rpl, (void)ddsddt, (void)drplde;
  (void)drpldt, (void)stran, (void)time, (void)dtime, (void)temp, (void)dtemp, (void)predef;
  (void)dpred, (void)cmname, (void)ndi, (void)nshr, (void)coords, (void)drot;
  (void)celent, (void)dfgrd0, (void)dfgrd1, (void)noel, (void)npt, (void)layer, (void)kspt;
  (void)kstep, (void)kinc, (void)cmname_length;
  for (int32_t k = 0; k < *ntens; k++) stress[k] += 1e5 * dstran[k];
  for (int32_t k = 0; k < *nstatv; k++) statev[k] += 1.0;
  if (*nprops > 0 && props[0] > 0.9) *pnewdt = 0.5; /* refuses every step */
}

static void material_umat(api *a) {
  api_begin(a, "mps_material_create_umat");
  mps_material *made = NULL;
  mps_context *context = api_context(a);
  mps_material_umat_def def = mps_material_umat_defaults();
  def.struct_size = api_struct_size(a, sizeof def);
  const double props[] = {api_near(a, "props", 0.0, 1.0)};
  def.props = props;
  def.props_count = 1;
  def.statev_count = (int32_t)api_least(a, "statev_count", 0, 3);
  def.umat = api_null(a, "umat") ? NULL : umat;
  def.wave_modulus = api_real(a, "wave_modulus", 5e-324, 1e18, 1e6);
  def.length = api_real(a, "length", 5e-324, 1e300, 1.0);
  def.temperature = api_near(a, "temperature", 300.0, 10.0);
  def.keeps_strain = (int32_t)api_below(a, 2);
  def.needs_deformation = (int32_t)api_below(a, 2);
  (void)made_material(a, mps_material_create_umat(context, &def, api_null(a, "out") ? NULL : &made),
                      &made);
}

/* ---- questions ------------------------------------------------------------------------------- */

API_DESTROY(material_destroy, API_MATERIAL)
API_QUERY(material_name, API_MATERIAL)
API_QUERY(material_wave_modulus, API_MATERIAL)
API_QUERY(material_needs_deformation, API_MATERIAL)
API_QUERY(material_history_count, API_MATERIAL)

static void material_history(api *a) {
  api_begin(a, "mps_material_history_name");
  const mps_material *material = api_any(a, API_MATERIAL)->handle;
  const int32_t count = mps_material_history_count(material);
  const int32_t index = (int32_t)api_whole(a, "index", 0, count > 0 ? count - 1 : 0);
  const bool inside = material && index >= 0 && index < count;
  const char *name = mps_material_history_name(material, index);
  if (inside != (name != NULL)) api_broken(a, "name of column %d of %d", index, count);
  api_end_query(a);
  api_begin(a, "mps_material_history_field");
  if (inside != (mps_material_history_field(material, index) != NULL)) api_broken(a, "field");
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
  api_begin(a, "mps_moduli_from_elastic_sized");
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
  api_begin(a, "mps_moduli_from_velocities_sized");
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
  api_begin(a, "mps_material_get_moduli_sized");
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
  api_begin(a, "mps_material_update");
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
  api_begin(a, "mps_material_point_init");
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
    {"mps_material_von_mises_def_init", 1, API_NOTHING, init_material_von_mises_def},
    {"mps_material_drucker_prager_def_init", 1, API_NOTHING, init_material_drucker_prager_def},
    {"mps_material_mohr_coulomb_def_init", 1, API_NOTHING, init_material_mohr_coulomb_def},
    {"mps_material_newtonian_def_init", 1, API_NOTHING, init_material_newtonian_def},
    {"mps_material_user_def_init", 1, API_NOTHING, init_material_user_def},
    {"mps_material_umat_def_init", 1, API_NOTHING, init_material_umat_def},
    {"mps_material_block_init", 1, API_NOTHING, init_material_block},
    {"mps_material_create_von_mises", 2, API_CONTEXT, material_von_mises},
    {"mps_material_create_drucker_prager", 2, API_CONTEXT, material_drucker_prager},
    {"mps_material_create_mohr_coulomb", 2, API_CONTEXT, material_mohr_coulomb},
    {"mps_material_cam_clay_def_init", 1, API_NOTHING, init_material_cam_clay_def},
    {"mps_material_create_cam_clay", 2, API_CONTEXT, material_cam_clay},
    {"mps_material_small_strain_def_init", 1, API_NOTHING, init_material_small_strain_def},
    {"mps_material_create_small_strain", 2, API_CONTEXT, material_small_strain},
    {"mps_material_cyclic_sand_def_init", 1, API_NOTHING, init_material_cyclic_sand_def},
    {"mps_material_create_cyclic_sand", 2, API_CONTEXT, material_cyclic_sand},
    {"mps_material_create_by_field", 1, API_MATERIAL, material_by_field},
    {"mps_material_normal_k0", 1, API_MATERIAL, normal_k0},
    {"mps_material_create_newtonian", 2, API_CONTEXT, material_newtonian},
    {"mps_material_create_user", 3, API_CONTEXT, material_user},
    {"mps_material_create_umat", 2, API_CONTEXT, material_umat},
    {"mps_material_destroy", 1, API_MATERIAL, destroy_material_destroy},
    {"mps_material_name", 1, API_MATERIAL, query_material_name},
    {"mps_material_wave_modulus", 1, API_MATERIAL, query_material_wave_modulus},
    {"mps_material_needs_deformation", 1, API_MATERIAL, query_material_needs_deformation},
    {"mps_material_history_count", 1, API_MATERIAL, query_material_history_count},
    {"mps_material_history_name", 2, API_MATERIAL, material_history},
    {"mps_material_history_field", 0, API_MATERIAL, material_history},
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
