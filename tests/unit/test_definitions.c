/* test_definitions.c - every definition struct, by its table (core/definition): the defaults; sizes
 * of older and newer programs; each member's bad values, and reserved ones, are refused by name.
 * And no getter writes beyond the caller's struct. SPDX-License-Identifier: BSD-3-Clause */
#include "io/checkpoint.h"
#include "test_fixture.h"

#include "core/internal.h"

#include <float.h>
#include "domain_threads.h"

#define MORE 24 /* bytes of the members that a newer libmps would have */

/* ---- one way to use each struct -------------------------------------------------------------- */

/* A square of 4 x 4 particles with every property that a solver may read. */
static mps_particles *square(void) {
  mps_particles *set = box_of(context, 0.5, AT(0.0, 0.0), AT(2.0, 2.0));
  static const struct {
    const char *name;
    double value;
  } fields[] = {{"density", 2000.0},          {"young", 1e7},   {"poisson", 0.3},
                {"shear_velocity", 100.0},    {"damping", 0.0}, {"velocity", 0.0},
                {"pressure_velocity", 200.0}, {"stress", 0.0}};
  for (size_t k = 0; k < sizeof fields / sizeof *fields; k++)
    OK(mps_particles_set(set, fields[k].name, 0, fields[k].value));
  return set;
}

/* Each `need` writes what has no default; each `use` makes an object and destroys it. */
static void need_nothing(void *def) { (void)def; }

static char context_text[300]; /* what mps_context_create said */
static mps_status use_context(const void *def) {
  scoped_context *made = NULL;
  return mps_context_create(def, &made, context_text, sizeof context_text);
}

static void need_particles(void *def) { ((mps_particles_def *)def)->spacing = 0.1; }
static mps_status use_particles(const void *def) {
  scoped_particles *made = NULL;
  return mps_particles_create(context, def, &made);
}

static void need_neighbours(void *def) { ((mps_neighbours_def *)def)->radius = 0.1; }
static mps_status use_neighbours(const void *def) {
  scoped_neighbours *made = NULL;
  const mps_status status = mps_neighbours_create(context, def, &made);
  return status;
}

static void need_von_mises(void *def) {
  mps_material_von_mises_def *d = def;
  d->young = 1e7;
  d->yield_stress = 1e4;
}
static void need_drucker_prager(void *def) {
  mps_material_drucker_prager_def *d = def;
  d->young = 1e7;
  d->friction = 0.5;
}
static void need_mohr_coulomb(void *def) {
  mps_material_mohr_coulomb_def *d = def;
  d->young = 1e7;
  d->friction = 0.5;
}
static void need_cam_clay(void *def) {
  mps_material_cam_clay_def *d = def;
  d->critical_slope = 1.0;
  d->compression = 0.1;
  d->swelling = 0.02;
  d->void_ratio = 1.0;
  d->preconsolidation = 1e5;
}
static void need_small_strain(void *def) {
  mps_material_small_strain_def *d = def;
  d->shear_modulus = 1e7;
  d->reference_strain = 1e-3;
}
static void need_cyclic_sand(void *def) {
  mps_material_cyclic_sand_def *d = def;
  d->young = 1e7;
  d->friction = 0.5;
  d->relative_density = 0.5;
}
static void need_newtonian(void *def) { ((mps_material_newtonian_def *)def)->bulk_modulus = 1e6; }

#define USE_MATERIAL(name)                                                                         \
  static mps_status use_##name(const void *def) {                                                  \
    mps_material *made = NULL;                                                                     \
    const mps_status status = mps_material_create_##name(context, def, &made);                     \
    mps_material_destroy(&made);                                                                   \
    return status;                                                                                 \
  }
USE_MATERIAL(von_mises)
USE_MATERIAL(drucker_prager)
USE_MATERIAL(mohr_coulomb)
USE_MATERIAL(newtonian)
USE_MATERIAL(cam_clay)
USE_MATERIAL(small_strain)
USE_MATERIAL(cyclic_sand)

static mps_status use_consolidation(const void *def) {
  scoped_particles *set = square();
  mps_material_cam_clay_def law = mps_material_cam_clay_defaults();
  need_cam_clay(&law);
  OK(mps_particles_add_field(set, "stress", 0));
  for (int c = 0; c < 3; c++) OK(mps_particles_set(set, "stress", c, -1e4));
  MAKE(material, clay, create_cam_clay, context, &law);
  return mps_particles_set_consolidation(set, clay, def);
}

static mps_status use_body(const void *def) {
  scoped_body *made = NULL;
  return mps_body_create_disc(context, def, 1.0, &made);
}

static void need_mpm(void *def) { ((mps_mpm_def *)def)->cell = 1.0; }
static mps_status use_mpm(const void *def) {
  scoped_particles *set = square();
  scoped_mpm *made = NULL;
  MAKE(material, material, create_linear_elastic, context, 1e7, 0.3);
  return mps_mpm_create(context, set, material, def, &made);
}

static mps_status use_mpm_settle(const void *def) {
  scoped_particles *set = square();
  DEF(mpm, solver, .cell = 1.0);
  MAKE(material, material, create_linear_elastic, context, 1e7, 0.3);
  MAKE(mpm, made, create, context, set, material, &solver);
  return mps_mpm_settle(made, def, NULL);
}

/* What a definition of water is of. */
typedef enum wet { WATER, FACES } wet;

/* Of a solver with water where the definition is not that of the water itself. */
static mps_status use_water(const void *def, wet what) {
  scoped_particles *set = square();
  DEF(mpm, solver, .cell = 1.0);
  DEF(pore_water, water, .porosity = 0.4);
  MAKE(material, material, create_linear_elastic, context, 1e7, 0.3);
  MAKE(mpm, made, create, context, set, material, &solver);
  if (what != WATER) OK(mps_mpm_add_pore_water(made, &water));
  return what == WATER ? mps_mpm_add_pore_water(made, def) : mps_mpm_add_pore_face(made, def, NULL);
}

static void need_pore_water(void *def) { ((mps_pore_water_def *)def)->porosity = 0.4; }
static mps_status use_pore_water(const void *def) { return use_water(def, WATER); }
static mps_status use_pore_face(const void *def) { return use_water(def, FACES); }

static mps_status use_dynamics(const void *def) {
  scoped_particles *set = square();
  scoped_dynamics *made = NULL;
  return mps_dynamics_create(context, set, def, &made);
}

static mps_status use_elastic(const void *def) {
  scoped_particles *set = square();
  scoped_elastic *made = NULL;
  return mps_elastic_create(context, set, def, &made);
}

static mps_status use_fluid(const void *def) {
  scoped_particles *set = square();
  scoped_fluid *made = NULL;
  return mps_fluid_create(context, set, def, &made);
}

/* A domain of this process alone. */
static team alone;
static void need_domain(void *def) {
  team_begin(&alone, 1);
  mps_domain_def known = team_domain_def(&alone, 0);
  known.struct_size = ((mps_domain_def *)def)->struct_size;
  memcpy(def, &known, sizeof known);
}
static mps_status use_domain(const void *def) {
  scoped_domain *made = NULL;
  return mps_domain_create(context, def, &made);
}

static void need_coupling(void *def) { ((mps_coupling_def *)def)->size = 3; }
static mps_status use_coupling(const void *def) {
  scoped_coupling *made = NULL;
  const mps_status status = mps_coupling_create(context, def, &made);
  return status;
}

static void need_waves(void *def) {
  mps_waves_def *d = def;
  d->depth = 0.5, d->height = 0.03, d->period = 1.4;
}
static mps_status use_waves(const void *def) {
  scoped_waves *made = NULL;
  const mps_status status = mps_waves_create(context, def, &made);
  return status;
}

static void need_absorber(void *def) {
  ((mps_absorber_def *)def)->depth = 0.5, ((mps_absorber_def *)def)->period = 1.4;
}
static mps_status use_absorber(const void *def) {
  scoped_absorber *made = NULL;
  const mps_status status = mps_absorber_create(context, def, &made);
  return status;
}

static void need_separation(void *def) {
  static double x[2] = {1.0, 1.3}, t[16], levels[32];
  mps_separation_def *d = def;
  for (int k = 0; k < 16; k++) t[k] = 0.1 * k, levels[2 * k] = 0.01 * (k % 5);
  d->gauges = 2, d->depth = 0.5, d->lower = 0.5, d->upper = 2.0;
  d->position = x, d->samples = 16, d->times = t, d->levels = levels;
}
static mps_status use_separation(const void *def) {
  mps_separation result;
  return mps_separation_find(context, def, 0, NULL, NULL, NULL, NULL, &result);
}

static void need_sainflou(void *def) {
  mps_sainflou_def *d = def;
  d->height = 0.05, d->period = 1.4, d->depth = 0.5;
}
static mps_status use_sainflou(const void *def) {
  mps_sainflou result;
  return mps_sainflou_evaluate(context, def, &result);
}

static void need_goda(void *def) {
  mps_goda_def *d = def;
  d->height = 0.05, d->period = 1.4, d->depth = 0.5, d->crest = 0.1, d->width = 0.3;
}
static mps_status use_goda(const void *def) {
  mps_goda result;
  return mps_goda_evaluate(context, def, &result);
}

static void need_eurotop(void *def) {
  mps_eurotop_def *d = def;
  d->height = 0.05, d->period = 1.4, d->depth = 0.5, d->crest = 0.05;
}
static mps_status use_eurotop(const void *def) {
  mps_eurotop result;
  return mps_eurotop_evaluate(context, def, &result);
}

static void need_overtopping(void *def) {
  static const double t[3] = {0.0, 1.0, 2.0}, heads[3] = {-0.1, 0.01, -0.1};
  mps_overtopping_def *d = def;
  d->samples = 3, d->times = t, d->heads = heads, d->resolved = 0.02;
}
static mps_status use_overtopping(const void *def) {
  mps_overtopping result;
  return mps_overtopping_find(context, def, 0, NULL, &result);
}

static mps_status use_body_motion(const void *def) {
  MAKE(body, body, create_disc, context, NULL, 1.0);
  return mps_body_set_motion(body, def);
}

static mps_status use_checkpoint(const void *def) {
  scoped_particles *set = square();
  return mpsi_checkpoint_write(set, TEST_TMP "/growth.h5", def);
}

static void need_recorder(void *def) {
  ((mps_recorder_def *)def)->path = TEST_TMP "/growth.vtkhdf";
}
static mps_status use_recorder(const void *def) {
  scoped_particles *set = square();
  scoped_recorder *made = NULL;
  return mps_recorder_create(context, set, def, &made);
}

/* ---- of WLS-MPM ---- */

static mps_mpm *make_mpm(void) {
  scoped_particles *set = square();
  DEF(mpm, def, .cell = 1.0);
  MAKE(material, material, create_linear_elastic, context, 1e7, 0.3);
  MAKE_KEPT(mpm, made, create, context, set, material, &def);
  return made;
}

static const int64_t first_id[1] = {0};

static mps_status use_contact(const void *def) {
  DEF(body, place, .position[1] = 20.0);
  scoped_mpm *mpm = make_mpm();
  MAKE(body, body, create_disc, context, &place, 5.0);
  return mps_mpm_add_contact(mpm, body, def, NULL);
}

static void need_mpm_boundary(void *def) {
  mps_mpm_boundary_def *d = def;
  d->kind = MPS_BOUNDARY_DRIVEN;
  d->ids = first_id, d->id_count = 1;
  d->dofs = MPS_DOF_X;
}
static mps_status use_mpm_boundary(const void *def) {
  scoped_mpm *mpm = make_mpm();
  int32_t number;
  return mps_mpm_add_boundary(mpm, def, &number);
}

static void need_mpm_load(void *def) {
  mps_mpm_load_def *d = def;
  d->ids = first_id, d->id_count = 1;
}
static mps_status use_mpm_load(const void *def) {
  scoped_mpm *mpm = make_mpm();
  int32_t number;
  return mps_mpm_add_load(mpm, def, &number);
}

/* ---- of explicit dynamics ---- */

static mps_dynamics *make_dynamics(void) {
  scoped_particles *set = square();
  MAKE_KEPT(dynamics, made, create, context, set, NULL);
  return made;
}

static void need_dynamics_boundary(void *def) {
  mps_dynamics_boundary_def *d = def;
  d->ids = first_id, d->id_count = 1;
  d->dofs = MPS_DOF_X;
}
static mps_status use_dynamics_boundary(const void *def) {
  scoped_dynamics *dynamics = make_dynamics();
  int32_t number;
  return mps_dynamics_add_boundary(dynamics, def, &number);
}

static void need_dynamics_load(void *def) {
  mps_dynamics_load_def *d = def;
  d->ids = first_id, d->id_count = 1;
}
static mps_status use_dynamics_load(const void *def) {
  scoped_dynamics *dynamics = make_dynamics();
  int32_t number;
  return mps_dynamics_add_load(dynamics, def, &number);
}

static void need_dynamics_predict(void *def) {
  mps_dynamics_predict_def *d = def;
  d->spacing = 1.0, d->shear_velocity = 100.0, d->pressure_velocity = 200.0;
}
static mps_status use_dynamics_predict(const void *def) {
  mps_dynamics_prediction out;
  return mps_dynamics_predict(context, def, &out);
}

/* ---- of implicit elasticity ---- */

static mps_elastic *make_elastic(void) {
  scoped_particles *set = square();
  MAKE_KEPT(elastic, made, create, context, set, NULL);
  return made;
}

static void need_elastic_boundary(void *def) {
  mps_elastic_boundary_def *d = def;
  d->ids = first_id, d->id_count = 1;
}
static mps_status use_elastic_boundary(const void *def) {
  scoped_elastic *elastic = make_elastic();
  return mps_elastic_add_boundary(elastic, def, NULL);
}

static void need_elastic_load(void *def) {
  mps_elastic_load_def *d = def;
  d->kind = MPS_ELASTIC_LOAD_VOLUME, d->all = 1;
}
static mps_status use_elastic_load(const void *def) {
  scoped_elastic *elastic = make_elastic();
  return mps_elastic_add_load(elastic, def, NULL);
}

static void need_elastic_motion(void *def) { ((mps_elastic_motion_def *)def)->dt = 1e-3; }
static mps_status use_elastic_motion(const void *def) {
  static const int64_t held[2] = {0, 1};
  scoped_elastic *elastic = make_elastic();
  DEF(elastic_boundary, foot, .ids = held, .id_count = 2);
  OK(mps_elastic_add_boundary(elastic, &foot, NULL));
  return mps_elastic_start(elastic, def);
}

/* ---- others ---- */

static void need_fluid_boundary(void *def) {
  mps_fluid_boundary_def *d = def;
  d->point[1] = -1.0, d->normal[1] = 1.0;
}
static mps_status use_fluid_boundary(const void *def) {
  scoped_particles *set = square();
  MAKE(fluid, fluid, create, context, set, NULL);
  return mps_fluid_add_boundary(fluid, def, NULL);
}

static mps_status no_law(void *user, const mps_material_block *block) { return MPS_OK; }
static void need_user_law(void *def) {
  mps_material_user_def *d = def;
  d->update = no_law;
  d->wave_modulus = 1e7;
}
static mps_status use_user_law(const void *def) {
  scoped_material *made = NULL;
  return mps_material_create_user(context, def, &made);
}

static void no_umat(double *stress, double *statev, double *ddsdde, double *sse, double *spd,
                    double *scd, double *rpl, double *ddsddt, double *drplde, double *drpldt,
                    const double *stran, const double *dstran, const double *time,
                    const double *dtime, const double *temp, const double *dtemp,
                    const double *predef, const double *dpred, const char *cmname,
                    const int32_t *ndi, const int32_t *nshr, const int32_t *ntens,
                    const int32_t *nstatv, const double *props, const int32_t *nprops,
                    const double *coords, const double *drot, double *pnewdt, const double *celent,
                    const double *dfgrd0, const double *dfgrd1, const int32_t *noel,
                    const int32_t *npt, const int32_t *layer, const int32_t *kspt,
                    const int32_t *kstep, const int32_t *kinc, size_t cmname_length) {
  const void *all[] = {stress, statev, ddsdde, sse,    spd,    scd,    rpl,    ddsddt,
                       drplde, drpldt, stran,  dstran, time,   dtime,  temp,   dtemp,
                       predef, dpred,  cmname, ndi,    nshr,   ntens,  nstatv, props,
                       nprops, coords, drot,   pnewdt, celent, dfgrd0, dfgrd1, noel,
                       npt,    layer,  kspt,   kstep,  kinc};
  (void)all;
  (void)cmname_length;
}
static void need_umat(void *def) {
  mps_material_umat_def *d = def;
  d->umat = no_umat;
  d->wave_modulus = 1e7;
}
static mps_status use_umat(const void *def) {
  scoped_material *made = NULL;
  return mps_material_create_umat(context, def, &made);
}

static void need_block(void *def) {
  static double zero[16];
  static int64_t flags[1];
  mps_material_block *b = def;
  b->count = 1, b->dt = 1.0;
  b->volume_ratio = zero, b->flags = flags;
  for (int c = 0; c < 9; c++) b->gradient[c] = zero + 1;
  for (int c = 0; c < 6; c++) b->stress[c] = zero + 2 + c;
}
static mps_status use_block(const void *def) {
  MAKE(material, material, create_linear_elastic, context, 1e7, 0.3);
  return mps_material_update(context, material, def);
}

static void need_geostatic(void *def) {
  static const mps_geostatic_layer layer = {.thickness = 10.0, .k0 = 0.5, .density = 2000.0};
  mps_geostatic_def *d = def;
  d->layer_count = 1;
  d->layers = &layer;
}
static mps_status use_geostatic(const void *def) {
  scoped_particles *set = square();
  return mps_particles_set_geostatic(set, def);
}

static mps_status use_table(const void *def) {
  static const double position[2] = {0.0, 0.0}, value = 1.0;
  scoped_particles *set = square();
  const mps_status status =
      mps_particles_set_table(set, "pore_pressure", 1, position, 1, &value, def, NULL);
  return status;
}

static mps_status use_record(const void *def) {
  scoped_signal *made = NULL;
  return mps_signal_create_record(context, TEST_DATA "/sample.AT2", def, &made);
}

static mps_status use_fluid_contact(const void *def) {
  scoped_particles *set = square();
  DEF(body, at, .position[0] = 1.0, .position[1] = 4.0);
  MAKE(fluid, fluid, create, context, set, NULL);
  MAKE(body, box, create_box, context, &at, 1.0, 1.0);
  return mps_fluid_add_contact(fluid, box, def, NULL);
}

static void need_fluid_load(void *def) { ((mps_fluid_load_def *)def)->all = 1; }
static mps_status use_fluid_load(const void *def) {
  scoped_particles *set = square();
  MAKE(fluid, fluid, create, context, set, NULL);
  return mps_fluid_add_load(fluid, def, NULL);
}

static void need_fluid_rock(void *def) {
  static const double corners[] = {0.1, 0.0, 0.0, 0.4, 0.0, 0.0, 0.25, 0.3, 0.0};
  mps_fluid_rock_def *rock = def;
  rock->corners = corners, rock->corner_count = 3;
  rock->porosity = 0.5, rock->diameter = 0.02;
}

static mps_status use_fluid_rock(const void *def) {
  scoped_particles *set = square();
  MAKE(fluid, fluid, create, context, set, NULL);
  return mps_fluid_add_rock(fluid, def, NULL);
}

static mps_status no_matrix(void *user, const mps_linear_matrix *matrix) { return MPS_OK; }

static mps_status no_solution(void *user, const double *b, double tolerance, double *x,
                              mps_linear_result *result) {
  return MPS_OK;
}

static void need_linear_solver(void *def) {
  mps_linear_solver_def *d = def;
  d->matrix = no_matrix, d->solve = no_solution;
}

static mps_status use_linear_solver(const void *def) {
  scoped_particles *set = square();
  MAKE(fluid, fluid, create, context, set, NULL);
  return mps_solver_set_linear_solver(mps_fluid_solver(fluid), MPS_LINEAR_EQUATION_PRESSURE, def);
}

typedef struct user {
  const char *type;
  void (*need)(void *def);
  mps_status (*use)(const void *def);
} user;

static const user users[] = {
    {"mps_body_motion", need_nothing, use_body_motion},
    {"mps_checkpoint", need_nothing, use_checkpoint},
    {"mps_contact_def", need_nothing, use_contact},
    {"mps_dynamics_boundary_def", need_dynamics_boundary, use_dynamics_boundary},
    {"mps_dynamics_load_def", need_dynamics_load, use_dynamics_load},
    {"mps_dynamics_predict_def", need_dynamics_predict, use_dynamics_predict},
    {"mps_elastic_boundary_def", need_elastic_boundary, use_elastic_boundary},
    {"mps_elastic_load_def", need_elastic_load, use_elastic_load},
    {"mps_elastic_motion_def", need_elastic_motion, use_elastic_motion},
    {"mps_fluid_boundary_def", need_fluid_boundary, use_fluid_boundary},
    {"mps_material_block", need_block, use_block},
    {"mps_mpm_boundary_def", need_mpm_boundary, use_mpm_boundary},
    {"mps_mpm_load_def", need_mpm_load, use_mpm_load},
    {"mps_recorder_def", need_recorder, use_recorder},
    {"mps_material_umat_def", need_umat, use_umat},
    {"mps_material_user_def", need_user_law, use_user_law},
    {"mps_body_def", need_nothing, use_body},
    {"mps_consolidation_def", need_nothing, use_consolidation},
    {"mps_table_def", need_nothing, use_table},
    {"mps_context_def", need_nothing, use_context},
    {"mps_coupling_def", need_coupling, use_coupling},
    {"mps_waves_def", need_waves, use_waves},
    {"mps_absorber_def", need_absorber, use_absorber},
    {"mps_separation_def", need_separation, use_separation},
    {"mps_sainflou_def", need_sainflou, use_sainflou},
    {"mps_goda_def", need_goda, use_goda},
    {"mps_eurotop_def", need_eurotop, use_eurotop},
    {"mps_overtopping_def", need_overtopping, use_overtopping},
    {"mps_domain_def", need_domain, use_domain},
    {"mps_material_cam_clay_def", need_cam_clay, use_cam_clay},
    {"mps_material_small_strain_def", need_small_strain, use_small_strain},
    {"mps_material_cyclic_sand_def", need_cyclic_sand, use_cyclic_sand},
    {"mps_material_drucker_prager_def", need_drucker_prager, use_drucker_prager},
    {"mps_dynamics_def", need_nothing, use_dynamics},
    {"mps_elastic_def", need_nothing, use_elastic},
    {"mps_fluid_def", need_nothing, use_fluid},
    {"mps_fluid_load_def", need_fluid_load, use_fluid_load},
    {"mps_fluid_rock_def", need_fluid_rock, use_fluid_rock},
    {"mps_fluid_contact_def", need_nothing, use_fluid_contact},
    {"mps_linear_solver_def", need_linear_solver, use_linear_solver},
    {"mps_geostatic_def", need_geostatic, use_geostatic},
    {"mps_material_mohr_coulomb_def", need_mohr_coulomb, use_mohr_coulomb},
    {"mps_mpm_def", need_mpm, use_mpm},
    {"mps_mpm_settle_def", need_nothing, use_mpm_settle},
    {"mps_pore_face_def", need_nothing, use_pore_face},
    {"mps_pore_water_def", need_pore_water, use_pore_water},
    {"mps_neighbours_def", need_neighbours, use_neighbours},
    {"mps_material_newtonian_def", need_newtonian, use_newtonian},
    {"mps_particles_def", need_particles, use_particles},
    {"mps_signal_record_def", need_nothing, use_record},
    {"mps_material_von_mises_def", need_von_mises, use_von_mises},
};

/* ---- every struct ---------------------------------------------------------------------------- */

#define ROW(name, kind, type) kind,
static const int32_t kinds[] = {MPS_DEFINITION_TABLE(ROW)};
#define ROWS (sizeof kinds / sizeof *kinds)

typedef mpsi_definition row;
static const row *row_of(size_t k) { return mpsi_definition_of(kinds[k]); }
static mps_status init(const row *r, void *def, size_t size) {
  for (size_t k = 0; k < ROWS; k++)
    if (row_of(k) == r) return mps_def_init(kinds[k], def, size);
  return MPS_ERROR_INTERNAL;
}

static const user *user_of(const char *type) {
  for (size_t k = 0; k < sizeof users / sizeof *users; k++)
    if (strcmp(users[k].type, type) == 0) return &users[k];
  return NULL;
}

/* Exactly `size` bytes, so that a read beyond them is seen by the address sanitizer. */
static void *definition(const row *r, size_t size) {
  unsigned char *def = malloc(size);
  memset(def, 0xee, size);
  assert_int_equal(init(r, def, size), MPS_OK);
  uint32_t stored;
  memcpy(&stored, def, sizeof stored);
  assert_int_equal(stored, size);
  return def;
}

TEST(init_takes_every_size) {
  for (size_t k = 0; k < ROWS; k++) {
    const row *r = row_of(k);
    if (r->size < r->released) fail_msg("%s has shrunk since its release", r->type);
    unsigned char *whole = definition(r, r->size), *old = definition(r, r->released);
    unsigned char *newer = definition(r, r->size + MORE);
    assert_memory_equal(whole + 4, old + 4, r->released - 4);
    assert_memory_equal(whole + 4, newer + 4, r->size - 4);
    for (size_t i = r->size; i < r->size + MORE; i++) assert_int_equal(newer[i], 0);
    assert_int_equal(init(r, whole, r->released - 1), MPS_ERROR_ARGUMENT);
    assert_int_equal(init(r, NULL, r->size), MPS_ERROR_ARGUMENT);
    free(whole);
    free(old);
    free(newer);
  }
}

/* The first `size` bytes of a good definition. */
static void *good_definition(const row *r, const user *u, size_t size) {
  unsigned char *whole = definition(r, r->size), *def = definition(r, size);
  u->need(whole);
  const size_t common = size < r->size ? size : r->size;
  memcpy(def + 4, whole + 4, common - 4);
  free(whole);
  return def;
}

static void expect(const row *r, const user *u, void *def, mps_status expected, const char *what) {
  const mps_status status = u->use(def);
  if (status != expected)
    fail_msg("%s, %s: status %d, expected %d: %s", r->type, what, (int)status, (int)expected,
             status == MPS_OK ? "" : mps_context_error(context)->message);
  free(def);
}

/* Whether this build has the part that takes such a struct. */
static bool is_built(const char *type) {
  if (strncmp(type, "mps_elastic", 11) == 0) return mps_library_has(MPS_FEATURE_CHOLMOD);
  if (strcmp(type, "mps_checkpoint") == 0 || strcmp(type, "mps_recorder_def") == 0)
    return mps_library_has(MPS_FEATURE_HDF5);
  return true;
}

TEST(create_takes_every_size) {
  for (size_t k = 0; k < ROWS; k++) {
    const row *r = row_of(k);
    const user *u = user_of(r->type);
    if (!u) fail_msg("nothing here uses a %s: give it a line in users", r->type);
    if (!is_built(r->type)) continue;
    expect(r, u, good_definition(r, u, r->size), MPS_OK, "as it is");
    expect(r, u, good_definition(r, u, r->released), MPS_OK, "as released");
    expect(r, u, good_definition(r, u, r->size + MORE), MPS_OK, "larger, with zeros");
    for (size_t at = r->size; at < r->size + MORE; at += MORE - 1) {
      unsigned char *unknown = good_definition(r, u, r->size + MORE);
      unknown[at] = 1;
      expect(r, u, unknown, MPS_ERROR_UNSUPPORTED, "with an unknown member");
    }
    unsigned char *small = good_definition(r, u, r->released);
    const uint32_t size = (uint32_t)r->released - 1;
    memcpy(small, &size, sizeof size);
    expect(r, u, small, MPS_ERROR_ARGUMENT, "smaller than released");
  }
}

/* A size that is none, in front of memory that is all zero: nothing behind it is read. */
TEST(sizes_beyond_any_struct_are_refused) {
  const uint32_t wrong[] = {MPSI_STRUCT_MOST + 1, INT32_MAX, UINT32_MAX};
  for (size_t k = 0; k < ROWS; k++) {
    const row *r = row_of(k);
    const user *u = user_of(r->type);
    unsigned char *def = definition(r, r->size);
    assert_int_equal(init(r, def, (size_t)MPSI_STRUCT_MOST + 1), MPS_ERROR_ARGUMENT);
    assert_int_equal(init(r, def, SIZE_MAX), MPS_ERROR_ARGUMENT);
    free(def);
    for (size_t w = 0; is_built(r->type) && w < sizeof wrong / sizeof *wrong; w++) {
      def = good_definition(r, u, r->size);
      memcpy(def, &wrong[w], sizeof wrong[w]);
      expect(r, u, def, MPS_ERROR_ARGUMENT, "of a size that no struct has");
    }
  }
  char text[200];
  mps_context *own = NULL;
  DEF(context, def, .struct_size = UINT32_MAX);
  assert_int_equal(mps_context_create(&def, &own, text, sizeof text), MPS_ERROR_ARGUMENT);
  assert_non_null(strstr(text, "struct_size is 4294967295 bytes, allowed are 144 to 4096"));
}

/* ---- every member ---------------------------------------------------------------------------- */

static bool is_whole(const mpsi_def_member *m) {
  return m->type == MPSI_MEMBER_INT || m->type == MPSI_MEMBER_BITS || m->type == MPSI_MEMBER_LONG;
}

static bool is_allowed_choice(const mpsi_allowed *allowed, double value) {
  char list[500];
  double k = 0.0;
  const char *colon = strchr(allowed->choices, ':');
  snprintf(list, sizeof list, "%s|", colon ? colon + 1 : allowed->choices);
  for (char *at = list, *bar; (bar = strchr(at, '|')); at = bar + 1, k += 1.0)
    if (k == value) return bar > at;
  return false;
}

/* Values that the line of a member, or a rule, does not allow. */
static int bad_values(const mpsi_def_member *m, const mpsi_allowed *r, double out[16]) {
  const double most = m->type == MPSI_MEMBER_LONG   ? 9007199254740992.0
                      : m->type == MPSI_MEMBER_BITS ? UINT32_MAX
                                                    : INT32_MAX;
  const double least = m->type == MPSI_MEMBER_BITS ? 0.0 : -most;
  int count = 0;
  if (r->choices)
    for (double value = -1.0; value < 12.0; value += 1.0)
      if (!is_allowed_choice(r, value) && count < 14) out[count++] = value;
  if (r->choices) out[count++] = INT32_MIN, out[count++] = INT32_MAX;
  if (r->choices || !r->checked) return count;
  const double below = is_whole(m) ? r->lower - 1.0 : nextafter(r->lower, -INFINITY);
  const double above = is_whole(m) ? r->upper + 1.0 : nextafter(r->upper, INFINITY);
  if (!is_whole(m) && !r->or_nan) out[count++] = NAN;
  if (!is_whole(m) && r->lower > -INFINITY) out[count++] = -INFINITY, out[count++] = below;
  if (!is_whole(m) && r->upper < INFINITY) out[count++] = INFINITY, out[count++] = above;
  if (is_whole(m) && below >= least) out[count++] = below, out[count++] = least;
  if (is_whole(m) && above <= most) out[count++] = above, out[count++] = most;
  if (r->open_lower && !(r->or_zero && r->lower == 0.0)) out[count++] = r->lower;
  if (r->open_upper) out[count++] = r->upper;
  if (r->lower == 0.0 && r->upper == 0.0) out[count++] = 7.0;
  return count;
}

/* Wherever a message gives the value of a choice ("kind is ..."), it is the enumerator; a number
 * only where the value has none, and never both. A list of what is allowed has the names of
 * `listed`. */
static void expect_names(const row *r, const void *def, const char *said,
                         const mpsi_allowed *listed) {
  for (const mpsi_def_member *m = r->member; m < r->member + r->count; m++) {
    const char *colon = m->allowed.choices ? strchr(m->allowed.choices, ':') : NULL;
    if (!colon) continue;
    char words[80], wanted[160];
    const int begin = (int)(colon - m->allowed.choices);
    snprintf(words, sizeof words, "%.*s%.*s", begin, m->allowed.choices,
             (int)strcspn(colon + 1, "|"), colon + 1);
    const char *enumeration = mpsi_enumeration_of(words);
    if (!enumeration) fail_msg("%s.%s: %s is no enumerator", r->type, m->name, words);
    for (int32_t value = 0; value < 12; value++)
      if (is_allowed_choice(&m->allowed, value)) {
        const char *name = mps_enumerator_name(enumeration, value);
        if (!name || !strstr(m->allowed.choices, name + begin))
          fail_msg("%s.%s = %d is %s of %s", r->type, m->name, (int)value, name, enumeration);
        if (listed->choices && strncmp(said, m->name, strlen(m->name)) == 0 &&
            is_allowed_choice(listed, value) && !strstr(said, name))
          fail_msg("%s.%s: \"%s\" lacks %s", r->type, m->name, said, name);
      }
    snprintf(words, sizeof words, "%s is ", m->name);
    const char *at = strstr(said, words);
    if (!at || (at > said && at[-1] != ' ')) continue;
    const int32_t value = (int32_t)mpsi_member_value(m, def, 0);
    const char *name = mps_enumerator_name(enumeration, value);
    if (name)
      snprintf(wanted, sizeof wanted, "%s%s", words, name);
    else
      snprintf(wanted, sizeof wanted, "%s%d", words, (int)value);
    const size_t length = strlen(wanted);
    if (strncmp(at, wanted, length) != 0 || (at[length] && !strchr(",: ", at[length])) ||
        strncmp(at + length, " (", 2) == 0)
      fail_msg("%s: \"%s\", expected \"%s\"", r->type, said, wanted);
  }
}

/* Refused, and the message begins with the member; the caller's struct is as it was. */
static void expect_refused(const row *r, const user *u, const mpsi_def_member *m, int32_t c,
                           void *def) {
  char name[80];
  void *copy = malloc(r->size);
  memcpy(copy, def, r->size);
  snprintf(name, sizeof name, m->count > 1 ? "%s[%d] is " : "%s is ", m->name, (int)c);
  const int64_t before = mpsi_failures(context);
  const bool own = strcmp(r->type, "mps_context_def") == 0;
  const mps_status status = u->use(def);
  const char *said =
      own ? context_text + strlen("mps_context_create: ") : mps_context_error(context)->message;
  const double value = m->type <= MPSI_MEMBER_REAL ? mpsi_member_value(m, def, c) : 0.0;
  if (status != MPS_ERROR_ARGUMENT || (!own && mpsi_failures(context) == before))
    fail_msg("%s.%s[%d] = %g: status %d", r->type, m->name, (int)c, value, (int)status);
  if (strncmp(said, name, strlen(name)) != 0)
    fail_msg("%s.%s[%d] = %g: \"%s\"", r->type, m->name, (int)c, value, said);
  expect_names(r, def, said, &m->allowed);
  assert_memory_equal(copy, def, r->size);
  free(copy);
  free(def);
}

TEST(bad_values_of_every_member_are_refused_by_name) {
  static const char null[sizeof(void *)];
  int refused = 0;
  for (size_t k = 0; k < ROWS; k++) {
    const row *r = row_of(k);
    const user *u = user_of(r->type);
    for (const mpsi_def_member *m = r->member; is_built(r->type) && m < r->member + r->count; m++)
      for (int32_t c = 0; c < (m->type == MPSI_MEMBER_CHAR ? 0 : m->count); c++) {
        double bad[16];
        const int count =
            m->type <= MPSI_MEMBER_REAL ? bad_values(m, &m->allowed, bad) : m->allowed.needed;
        for (int b = 0; b < count; b++, refused++) {
          char *def = good_definition(r, u, r->size);
          if (m->type <= MPSI_MEMBER_REAL)
            mpsi_member_set(m, def, c, bad[b]);
          else
            memcpy(def + m->offset, null, sizeof null);
          expect_refused(r, u, m, c, def);
        }
      }
  }
  print_message("%d values refused\n", refused);
  assert_true(refused > 1000);
}

/* ---- every rule ------------------------------------------------------------------------------ */

static double numbers[16]; /* where addresses of a definition lead */

static bool is_number(const mpsi_def_member *m) { return m->type <= MPSI_MEMBER_REAL; }

static void forget(const row *r, const mpsi_def_member *m, char *def) {
  char *plain = definition(r, r->size);
  const size_t end = m + 1 < r->member + r->count ? m[1].offset : r->size, bytes = end - m->offset;
  memcpy(def + m->offset, plain + m->offset, bytes);
  free(plain);
}

/* Gives component c a value that its line allows. */
static void give(const mpsi_def_member *m, char *def, int32_t c) {
  const mpsi_allowed *a = &m->allowed;
  const double tried[] = {1.0, 2.0, 0.0, a->lower, a->upper, 0.5 * (a->lower + a->upper), 3.0, 0.5};
  const double *address = numbers;
  if (m->type == MPSI_MEMBER_CHAR) def[m->offset] = 'a';
  if (m->type > MPSI_MEMBER_CHAR)
    memcpy(def + m->offset + (size_t)c * sizeof address, &address, sizeof address);
  for (size_t k = 0; is_number(m) && k < sizeof tried / sizeof *tried; k++) {
    mpsi_member_set(m, def, c, tried[k]);
    bool good = mpsi_member_given(m, def) && isfinite(tried[k]);
    if (a->choices) good &= is_allowed_choice(a, tried[k]);
    if (a->checked) good &= tried[k] >= a->lower && tried[k] <= a->upper;
    if (a->open_lower) good &= tried[k] > a->lower;
    if (a->open_upper) good &= tried[k] < a->upper;
    if (good) return;
  }
}

/* Makes all cases of a rule hold; the scene in which they do. */
static uint32_t enter(const row *r, const mpsi_def_rule *rule, char *def) {
  uint32_t scene = MPSI_SCENE_PLANE;
  for (const mpsi_def_case *w = rule->when; w < rule->when + MPSI_CASES; w++) {
    const mpsi_def_member *m = &r->member[w->member];
    if (w->kind == MPSI_CASE_IS)
      for (double value = 0.0; value < 32.0; value += 1.0)
        if ((w->values >> (int)value & 1u) &&
            (!m->allowed.choices || is_allowed_choice(&m->allowed, value))) {
          mpsi_member_set(m, def, 0, value);
          break;
        }
    if (w->kind == MPSI_CASE_WITH) give(m, def, w->member == rule->member ? rule->begin + 1 : 0);
    if (w->kind == MPSI_CASE_WITHOUT) forget(r, m, def);
    if (w->kind == MPSI_CASE_BEYOND) {
      double above = is_whole(m) ? w->limit + 1.0 : nextafter(w->limit, INFINITY);
      mpsi_member_set(m, def, 0, above);
    }
    if (w->kind == MPSI_CASE_WITHIN) mpsi_member_set(m, def, 0, w->limit);
    if (w->kind == MPSI_CASE_SCENE && !(w->values & scene)) scene = w->values;
  }
  return scene;
}

/* Breaks a rule in its way number `way`; false where there is none. */
static bool break_rule(const row *r, const mpsi_def_rule *rule, char *def, int way) {
  const mpsi_def_member *m = &r->member[rule->member], *o = &r->member[rule->other];
  double bad[16];
  const mpsi_def_member reals = {.type = MPSI_MEMBER_REAL};
  switch (rule->demand) {
  case MPSI_DEMAND_GIVEN:
    forget(r, m, def);
    return way == 0;
  case MPSI_DEMAND_NOT_GIVEN:
  case MPSI_DEMAND_UNUSED:
    give(m, def, rule->begin);
    return way == 0;
  case MPSI_DEMAND_RANGE:
    if (!is_number(m)) {
      forget(r, m, def);
      return way == 0;
    }
    if (way >= bad_values(m, &rule->allowed, bad)) return false;
    mpsi_member_set(m, def, rule->begin, bad[way]);
    return true;
  case MPSI_DEMAND_EACH:
  case MPSI_DEMAND_RISING: {
    const bool rises = rule->demand == MPSI_DEMAND_RISING;
    const int count = bad_values(&reals, &rule->allowed, bad);
    mpsi_member_set(o, def, 0, 2.0);
    give(m, def, 0);
    const double middle = 0.5 * (rule->allowed.lower + rule->allowed.upper);
    for (size_t k = 0; k < 16; k++) numbers[k] = middle;
    if (way < count) numbers[0] = bad[way];
    return way < count + rises;
  }
  default: {
    const bool low = rule->demand == MPSI_DEMAND_LESS || rule->demand == MPSI_DEMAND_AT_MOST;
    const bool strict = rule->demand == MPSI_DEMAND_LESS || rule->demand == MPSI_DEMAND_MORE;
    const double at = 2.0 * rule->factor, by = strict && way == 0 ? 0.0 : fabs(at) + 1.0;
    mpsi_member_set(o, def, o->count > 1 ? rule->begin : 0, 2.0);
    mpsi_member_set(m, def, rule->begin, low ? at + by : at - by);
    return way < 1 + strict;
  }
  }
}

/* Each rule, broken where its cases hold, is refused by the name of its member, and by the function
 * that takes the definition: by this rule or by one before it. */
TEST(broken_rules_are_refused_by_name) {
  int broken = 0;
  for (size_t k = 0; k < ROWS; k++) {
    const row *r = row_of(k);
    const user *u = user_of(r->type);
    for (const mpsi_def_rule *rule = r->rule; rule && rule < r->rule + r->rules; rule++) {
      const char *name = r->member[rule->member].name;
      if (rule->demand == MPSI_DEMAND_UNUSED) continue;
      for (int way = 0;; way++, broken++) {
        char *def = good_definition(r, u, r->size), why[MPSI_WHY] = "";
        const uint32_t scene = enter(r, rule, def);
        if (!break_rule(r, rule, def, way)) {
          free(def);
          assert_true(way > 0);
          break;
        }
        for (int w = 0; w < MPSI_CASES; w++)
          if (!mpsi_case_applies(r, &rule->when[w], def, scene))
            fail_msg("%s.%s: no way to make case %d hold", r->type, name, w);
        if (mpsi_rule_check(r, rule, def, scene, why) || strncmp(why, name, strlen(name)) != 0)
          fail_msg("%s.%s, way %d: \"%s\"", r->type, name, way, why);
        expect_names(r, def, why, &rule->allowed);
        if (is_built(r->type) && scene == MPSI_SCENE_PLANE && u->use(def) != MPS_ERROR_ARGUMENT)
          fail_msg("%s is taken, but \"%s\"", r->type, why);
        free(def);
      }
    }
  }
  print_message("%d rules broken\n", broken);
  assert_true(broken > 0);
}

typedef struct heard_of {
  const char *wanted;
  bool found;
} heard_of;

static void hear(void *log_user, int32_t level, const char *message) {
  heard_of *h = log_user;
  h->found |= level == MPS_CONTEXT_LOG_WARNING && strstr(message, h->wanted);
}

/* Whether the definition is taken, by a context that has to hear of `why`. */
static bool expect_warning(const char *type, const user *u, const void *def, const char *why) {
  heard_of heard = {.wanted = why};
  mps_context_def own = test_context_defaults();
  mps_context *outer = context;
  own.executor = MPS_CONTEXT_EXECUTOR_SERIAL, own.log = hear, own.log_user = &heard;
  context = NULL;
  OK(mps_context_create(&own, &context, NULL, 0));
  const bool taken = u->use(def) == MPS_OK;
  mps_context_destroy(&context);
  context = outer;
  if (taken && !heard.found) fail_msg("%s: no warning \"%s\"", type, why);
  return taken;
}

/* A member that has no effect beside the others is warned of by the function that takes the
 * definition, with its value; at its default it is not. */
TEST(members_without_effect_are_warned_of) {
  int found = 0, taken = 0;
  for (size_t k = 0; k < ROWS; k++) {
    const row *r = row_of(k);
    const user *u = user_of(r->type);
    for (const mpsi_def_rule *rule = r->rule; rule && rule < r->rule + r->rules; rule++) {
      if (rule->demand != MPSI_DEMAND_UNUSED) continue;
      const mpsi_def_member *m = &r->member[rule->member];
      char *def = good_definition(r, u, r->size), why[MPSI_WHY] = "";
      const uint32_t scene = enter(r, rule, def);
      forget(r, m, def);
      if (!mpsi_rule_check(r, rule, def, scene, why))
        fail_msg("%s: \"%s\", and it is not given", r->type, why);
      give(m, def, rule->begin);
      if (mpsi_rule_check(r, rule, def, scene, why) || strncmp(why, m->name, strlen(m->name)) != 0)
        fail_msg("%s.%s: \"%s\"", r->type, m->name, why);
      if (is_built(r->type)) taken += expect_warning(r->type, u, def, why);
      found++;
      free(def);
    }
  }
  print_message("%d members, %d in a scene\n", found, taken);
  assert_true(taken > 20);
}

/* A default is allowed, or it is NaN or 0: the caller has to give the member. */
TEST(defaults_are_allowed_or_unset) {
  for (size_t k = 0; k < ROWS; k++) {
    const row *r = row_of(k);
    unsigned char *def = definition(r, r->size);
    for (const mpsi_def_member *m = r->member; m < r->member + r->count; m++)
      for (int32_t c = 0; m->type <= MPSI_MEMBER_REAL && c < m->count; c++) {
        double bad[16];
        const double value = mpsi_member_value(m, def, c);
        const int count = bad_values(m, &m->allowed, bad);
        for (int b = 0; b < count; b++)
          if (bad[b] == value && value != 0.0)
            fail_msg("%s.%s has the default %g, which is refused", r->type, m->name, value);
      }
    free(def);
  }
}

TEST(zeros_are_told_where_to_start) {
  for (size_t k = 0; k < ROWS; k++) {
    const row *r = row_of(k);
    char wanted[120];
    if (!is_built(r->type)) continue;
    snprintf(wanted, sizeof wanted, "filled with zeros (its struct_size is 0): start from %s()",
             r->defaults);
    void *def = calloc(1, r->size);
    assert_int_equal(user_of(r->type)->use(def), MPS_ERROR_ARGUMENT);
    const char *said = strcmp(r->type, "mps_context_def") == 0
                           ? context_text
                           : mps_context_error(context)->message;
    if (!strstr(said, wanted)) fail_msg("%s: \"%s\"", r->type, said);
    free(def);
  }
}

/* ---- results --------------------------------------------------------------------------------- */

TEST(results_stay_within_the_callers_struct) {
  const double known[3] = {1.0, 2.0, 3.0};
  double out[5] = {-1.0, -1.0, -1.0, -1.0, -1.0};
  OK(mpsi_out_write(context, "f", out, 16, known, sizeof known));
  const double older[5] = {1.0, 2.0, -1.0, -1.0, -1.0};
  assert_memory_equal(out, older, sizeof out);
  OK(mpsi_out_write(context, "f", out, 32, known, sizeof known));
  assert_true(out[2] == 3.0 && isnan(out[3]) && out[4] == -1.0);
  REFUSES(mpsi_out_write(context, "f", NULL, 8, known, sizeof known), "NULL");
  REFUSES(mpsi_out_write(context, "f", out, 0, known, sizeof known), "size is 0");
  REFUSES(mpsi_out_write(context, "f", out, SIZE_MAX, known, sizeof known),
          "allowed are 1 to 4096");
}

/* Field by field: the struct of a caller with only its first members. */
/* A program built against an older libmps queries a definition and creates another solver by it:
 * the size that comes with it is the program's. */
TEST(definitions_come_back_with_the_callers_size) {
  scoped_particles *set = square();
  scoped_fluid *fluid = NULL;
  scoped_dynamics *dynamics = NULL;
  scoped_mpm *mpm = NULL;
  const uint32_t size = 16;
  union {
    uint32_t size;
    mps_mpm_def mpm;
    mps_fluid_def fluid;
    mps_dynamics_def dynamics;
  } part;
  OK(mps_fluid_create(context, set, NULL, &fluid));
  OK(mps_solver_get_def(mps_fluid_solver(fluid), MPS_DEF_FLUID, &part.fluid, size));
  assert_int_equal(part.size, size);
  OK(mps_fluid_get_def(fluid, &part.fluid));
  assert_int_equal(part.size, sizeof part.fluid);
  mps_fluid_destroy(&fluid);
  OK(mps_dynamics_create(context, set, NULL, &dynamics));
  OK(mps_solver_get_def(mps_dynamics_solver(dynamics), MPS_DEF_DYNAMICS, &part.dynamics, size));
  assert_int_equal(part.size, size);
  mps_dynamics_destroy(&dynamics);
  MAKE(material, material, create_linear_elastic, context, 1e7, 0.3);
  USING(mpm, mps_mpm_create(context, set, material, &given, &mpm), .cell = 1.0);
  OK(mps_solver_get_def(mps_mpm_solver(mpm), MPS_DEF_MPM, &part.mpm, size));
  assert_int_equal(part.size, size);
}

TEST(descriptions_of_fields_are_sized) {
  scoped_particles *set = square();
  mps_particles_field_info whole;
  memset(&whole, 0xee, sizeof whole);
  OK(mps_particles_get_field_info(set, 1, &whole));
  assert_string_equal(whole.name, "position");
  mps_particles_field_info part;
  memset(&part, 0xee, sizeof part);
  OK(mps_particles_get_field_info_sized(set, 1, &part,
                                        offsetof(mps_particles_field_info, meaning)));
  assert_string_equal(part.name, "position");
  assert_string_equal(part.unit, "m");
  assert_int_equal(part.flags, 0xeeeeeeee);
}
