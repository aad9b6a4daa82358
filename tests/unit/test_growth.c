/* test_growth.c - structs may grow: programs built against an older libmps pass smaller
 * definitions, programs built against a newer one larger definitions; and no getter writes beyond
 * the caller's struct. Each definition struct of core/released_sizes.h is tried with its released
 * size. SPDX-License-Identifier: BSD-3-Clause */
#include "test_fixture.h"

#include "core/internal.h"
#include "domain_threads.h"

#include <mps/body.h>
#include <mps/couple.h>
#include <mps/domain.h>
#include <mps/dynamics.h>
#include <mps/elastic.h>
#include <mps/fluid.h>
#include <mps/fluid_rock.h>
#include <mps/elastic_solver.h>
#include <mps/fluid_solver.h>
#include <mps/geostatic.h>
#include <mps/soil.h>
#include <mps/io.h>
#include <mps/material.h>
#include <mps/mpm.h>
#include <mps/mpm_settle.h>
#include <mps/neighbours.h>
#include <mps/particles.h>
#include <mps/pore_solver.h>
#include <mps/signal.h>
#include <mps/wave_loads.h>
#include <mps/waves.h>

#define MORE 24 /* bytes of the members that a newer libmps would have */

/* ---- one way to use each struct -------------------------------------------------------------- */

/* A square of 4 x 4 particles with every property that a solver may read. */
static mps_particles *square(void) {
  mps_particles_def def = mps_particles_defaults();
  def.spacing = 0.5;
  mps_particles *set = NULL;
  mps_assert_ok(context, mps_particles_create(context, &def, &set));
  const double lo[2] = {0.0, 0.0}, hi[2] = {2.0, 2.0};
  mps_assert_ok(context, mps_particles_fill_box(set, lo, hi, NULL));
  static const struct {
    const char *name;
    double value;
  } fields[] = {{"density", 2000.0},          {"young", 1e7},   {"poisson", 0.3},
                {"shear_velocity", 100.0},    {"damping", 0.0}, {"velocity", 0.0},
                {"pressure_velocity", 200.0}, {"stress", 0.0}};
  for (size_t k = 0; k < sizeof fields / sizeof *fields; k++)
    mps_assert_ok(context, mps_particles_set(set, fields[k].name, 0, fields[k].value));
  return set;
}

/* Each `need` writes what has no default; each `use` makes an object and destroys it. */
static void need_nothing(void *def) { (void)def; }

static mps_status use_context(const void *def) {
  mps_context *made = NULL;
  const mps_status status = mps_context_create(def, &made, NULL, 0);
  mps_context_destroy(&made);
  return status;
}

static void need_particles(void *def) { ((mps_particles_def *)def)->spacing = 0.1; }
static mps_status use_particles(const void *def) {
  mps_particles *made = NULL;
  const mps_status status = mps_particles_create(context, def, &made);
  mps_particles_destroy(&made);
  return status;
}

static void need_neighbours(void *def) { ((mps_neighbours_def *)def)->radius = 0.1; }
static mps_status use_neighbours(const void *def) {
  mps_neighbours *made = NULL;
  const mps_status status = mps_neighbours_create(context, def, &made);
  mps_neighbours_destroy(&made);
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
  mps_particles *set = square();
  mps_material *clay = NULL;
  mps_material_cam_clay_def law = mps_material_cam_clay_defaults();
  need_cam_clay(&law);
  mps_assert_ok(context, mps_particles_add_field(set, "stress", 0));
  for (int c = 0; c < 3; c++) mps_assert_ok(context, mps_particles_set(set, "stress", c, -1e4));
  mps_assert_ok(context, mps_material_create_cam_clay(context, &law, &clay));
  const mps_status status = mps_particles_set_consolidation(set, clay, def);
  mps_material_destroy(&clay);
  mps_particles_destroy(&set);
  return status;
}

static mps_status use_body(const void *def) {
  mps_body *made = NULL;
  const mps_status status = mps_body_create_disc(context, def, 1.0, &made);
  mps_body_destroy(&made);
  return status;
}

static void need_mpm(void *def) { ((mps_mpm_def *)def)->cell = 1.0; }
static mps_status use_mpm(const void *def) {
  mps_particles *set = square();
  mps_material *material = NULL;
  mps_mpm *made = NULL;
  mps_assert_ok(context, mps_material_create_linear_elastic(context, 1e7, 0.3, &material));
  const mps_status status = mps_mpm_create(context, set, material, def, &made);
  mps_mpm_destroy(&made);
  mps_material_destroy(&material);
  mps_particles_destroy(&set);
  return status;
}

static mps_status use_mpm_settle(const void *def) {
  mps_particles *set = square();
  mps_material *material = NULL;
  mps_mpm_def solver = mps_mpm_defaults();
  mps_mpm *made = NULL;
  solver.cell = 1.0;
  mps_assert_ok(context, mps_material_create_linear_elastic(context, 1e7, 0.3, &material));
  mps_assert_ok(context, mps_mpm_create(context, set, material, &solver, &made));
  const mps_status status = mps_mpm_settle(made, def, NULL);
  mps_mpm_destroy(&made);
  mps_material_destroy(&material);
  mps_particles_destroy(&set);
  return status;
}

/* What a definition of water is of. */
typedef enum wet { WATER, FACES, SOLVER } wet;

/* Of a solver with water where the definition is not that of the water itself. */
static mps_status use_water(const void *def, wet what) {
  mps_particles *set = square();
  mps_material *material = NULL;
  mps_mpm_def solver = mps_mpm_defaults();
  mps_pore_water_def water = mps_pore_water_defaults();
  mps_mpm *made = NULL;
  solver.cell = 1.0;
  water.porosity = 0.4;
  mps_assert_ok(context, mps_material_create_linear_elastic(context, 1e7, 0.3, &material));
  mps_assert_ok(context, mps_mpm_create(context, set, material, &solver, &made));
  if (what != WATER) mps_assert_ok(context, mps_mpm_add_pore_water(made, &water));
  const mps_status status = what == WATER   ? mps_mpm_add_pore_water(made, def)
                            : what == FACES ? mps_mpm_add_pore_face(made, def, NULL)
                                            : mps_mpm_set_pore_solver(made, def);
  mps_mpm_destroy(&made);
  mps_material_destroy(&material);
  mps_particles_destroy(&set);
  return status;
}

static void need_pore_water(void *def) { ((mps_pore_water_def *)def)->porosity = 0.4; }
static mps_status use_pore_water(const void *def) { return use_water(def, WATER); }
static mps_status use_pore_face(const void *def) { return use_water(def, FACES); }
static mps_status use_pore_solver(const void *def) { return use_water(def, SOLVER); }

static mps_status use_dynamics(const void *def) {
  mps_particles *set = square();
  mps_dynamics *made = NULL;
  const mps_status status = mps_dynamics_create(context, set, def, &made);
  mps_dynamics_destroy(&made);
  mps_particles_destroy(&set);
  return status;
}

static mps_status use_elastic(const void *def) {
  mps_particles *set = square();
  mps_elastic *made = NULL;
  const mps_status status = mps_elastic_create(context, set, def, &made);
  mps_elastic_destroy(&made);
  mps_particles_destroy(&set);
  return status;
}

static mps_status use_fluid(const void *def) {
  mps_particles *set = square();
  mps_fluid *made = NULL;
  const mps_status status = mps_fluid_create(context, set, def, &made);
  mps_fluid_destroy(&made);
  mps_particles_destroy(&set);
  return status;
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
  mps_domain *made = NULL;
  const mps_status status = mps_domain_create(context, def, &made);
  mps_domain_destroy(&made);
  return status;
}

static void need_coupling(void *def) { ((mps_coupling_def *)def)->size = 3; }
static mps_status use_coupling(const void *def) {
  mps_coupling *made = NULL;
  const mps_status status = mps_coupling_create(context, def, &made);
  mps_coupling_destroy(&made);
  return status;
}

static void need_waves(void *def) {
  mps_waves_def *d = def;
  d->depth = 0.5, d->height = 0.03, d->period = 1.4;
}
static mps_status use_waves(const void *def) {
  mps_waves *made = NULL;
  const mps_status status = mps_waves_create(context, def, &made);
  mps_waves_destroy(&made);
  return status;
}

static void need_absorber(void *def) {
  ((mps_absorber_def *)def)->depth = 0.5, ((mps_absorber_def *)def)->period = 1.4;
}
static mps_status use_absorber(const void *def) {
  mps_absorber *made = NULL;
  const mps_status status = mps_absorber_create(context, def, &made);
  mps_absorber_destroy(&made);
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
  mps_body *body = NULL;
  mps_assert_ok(context, mps_body_create_disc(context, NULL, 1.0, &body));
  const mps_status status = mps_body_set_motion(body, def);
  mps_body_destroy(&body);
  return status;
}

static mps_status use_checkpoint(const void *def) {
  mps_particles *set = square();
  const mps_status status = mps_checkpoint_write(set, TEST_TMP "/growth.h5", def);
  mps_particles_destroy(&set);
  return status;
}

static void need_recorder(void *def) {
  ((mps_recorder_def *)def)->path = TEST_TMP "/growth.vtkhdf";
}
static mps_status use_recorder(const void *def) {
  mps_particles *set = square();
  mps_recorder *made = NULL;
  const mps_status status = mps_recorder_create(context, set, def, &made);
  mps_recorder_destroy(&made);
  mps_particles_destroy(&set);
  return status;
}

/* ---- of WLS-MPM ---- */

static mps_mpm *make_mpm(void) {
  mps_particles *set = square();
  mps_material *material = NULL;
  mps_mpm *made = NULL;
  mps_mpm_def def = mps_mpm_defaults();
  def.cell = 1.0;
  mps_assert_ok(context, mps_material_create_linear_elastic(context, 1e7, 0.3, &material));
  mps_assert_ok(context, mps_mpm_create(context, set, material, &def, &made));
  mps_material_destroy(&material);
  mps_particles_destroy(&set);
  return made;
}

static const int64_t first_id[1] = {0};

static mps_status use_contact(const void *def) {
  mps_body_def place = mps_body_defaults();
  mps_body *body = NULL;
  mps_mpm *mpm = make_mpm();
  place.position[1] = 20.0;
  mps_assert_ok(context, mps_body_create_disc(context, &place, 5.0, &body));
  const mps_status status = mps_mpm_add_contact(mpm, body, def, NULL);
  mps_mpm_destroy(&mpm);
  mps_body_destroy(&body);
  return status;
}

static void need_mpm_boundary(void *def) {
  mps_mpm_boundary_def *d = def;
  d->kind = MPS_BOUNDARY_DRIVEN;
  d->ids = first_id, d->id_count = 1;
  d->dofs = MPS_DOF_X;
}
static mps_status use_mpm_boundary(const void *def) {
  mps_mpm *mpm = make_mpm();
  int32_t number;
  const mps_status status = mps_mpm_add_boundary(mpm, def, &number);
  mps_mpm_destroy(&mpm);
  return status;
}

static void need_mpm_load(void *def) {
  mps_mpm_load_def *d = def;
  d->ids = first_id, d->id_count = 1;
}
static mps_status use_mpm_load(const void *def) {
  mps_mpm *mpm = make_mpm();
  int32_t number;
  const mps_status status = mps_mpm_add_load(mpm, def, &number);
  mps_mpm_destroy(&mpm);
  return status;
}

/* ---- of explicit dynamics ---- */

static mps_dynamics *make_dynamics(void) {
  mps_particles *set = square();
  mps_dynamics *made = NULL;
  mps_assert_ok(context, mps_dynamics_create(context, set, NULL, &made));
  mps_particles_destroy(&set);
  return made;
}

static void need_dynamics_boundary(void *def) {
  mps_dynamics_boundary_def *d = def;
  d->ids = first_id, d->id_count = 1;
  d->dofs = MPS_DOF_X;
}
static mps_status use_dynamics_boundary(const void *def) {
  mps_dynamics *dynamics = make_dynamics();
  int32_t number;
  const mps_status status = mps_dynamics_add_boundary(dynamics, def, &number);
  mps_dynamics_destroy(&dynamics);
  return status;
}

static void need_dynamics_load(void *def) {
  mps_dynamics_load_def *d = def;
  d->ids = first_id, d->id_count = 1;
}
static mps_status use_dynamics_load(const void *def) {
  mps_dynamics *dynamics = make_dynamics();
  int32_t number;
  const mps_status status = mps_dynamics_add_load(dynamics, def, &number);
  mps_dynamics_destroy(&dynamics);
  return status;
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
  mps_particles *set = square();
  mps_elastic *made = NULL;
  mps_assert_ok(context, mps_elastic_create(context, set, NULL, &made));
  mps_particles_destroy(&set);
  return made;
}

static void need_elastic_boundary(void *def) {
  mps_elastic_boundary_def *d = def;
  d->ids = first_id, d->id_count = 1;
}
static mps_status use_elastic_boundary(const void *def) {
  mps_elastic *elastic = make_elastic();
  const mps_status status = mps_elastic_add_boundary(elastic, def, NULL);
  mps_elastic_destroy(&elastic);
  return status;
}

static mps_status use_elastic_load(const void *def) {
  mps_elastic *elastic = make_elastic();
  const mps_status status = mps_elastic_add_load(elastic, def, NULL);
  mps_elastic_destroy(&elastic);
  return status;
}

static mps_status use_elastic_solver(const void *def) {
  mps_elastic *elastic = make_elastic();
  const mps_status status = mps_elastic_set_solver(elastic, def);
  mps_elastic_destroy(&elastic);
  return status;
}

static void need_elastic_motion(void *def) { ((mps_elastic_motion_def *)def)->dt = 1e-3; }
static mps_status use_elastic_motion(const void *def) {
  static const int64_t held[2] = {0, 1};
  mps_elastic *elastic = make_elastic();
  mps_elastic_boundary_def foot = mps_elastic_boundary_defaults();
  foot.ids = held, foot.id_count = 2;
  mps_assert_ok(context, mps_elastic_add_boundary(elastic, &foot, NULL));
  const mps_status status = mps_elastic_start(elastic, def);
  mps_elastic_destroy(&elastic);
  return status;
}

/* ---- others ---- */

static void need_fluid_boundary(void *def) {
  mps_fluid_boundary_def *d = def;
  d->point[1] = -1.0, d->normal[1] = 1.0;
}
static mps_status use_fluid_boundary(const void *def) {
  mps_particles *set = square();
  mps_fluid *fluid = NULL;
  mps_assert_ok(context, mps_fluid_create(context, set, NULL, &fluid));
  const mps_status status = mps_fluid_add_boundary(fluid, def, NULL);
  mps_fluid_destroy(&fluid);
  mps_particles_destroy(&set);
  return status;
}

static mps_status no_law(void *user, const mps_material_block *block) {
  (void)user;
  (void)block;
  return MPS_OK;
}
static void need_user_law(void *def) {
  mps_material_user_def *d = def;
  d->update = no_law;
  d->wave_modulus = 1e7;
}
static mps_status use_user_law(const void *def) {
  mps_material *made = NULL;
  const mps_status status = mps_material_create_user(context, def, &made);
  mps_material_destroy(&made);
  return status;
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
  mps_material *made = NULL;
  const mps_status status = mps_material_create_umat(context, def, &made);
  mps_material_destroy(&made);
  return status;
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
  mps_material *material = NULL;
  mps_assert_ok(context, mps_material_create_linear_elastic(context, 1e7, 0.3, &material));
  const mps_status status = mps_material_update(context, material, def);
  mps_material_destroy(&material);
  return status;
}

static void need_geostatic(void *def) {
  static const mps_geostatic_layer layer = {.thickness = 10.0, .k0 = 0.5, .density = 2000.0};
  mps_geostatic_def *d = def;
  d->layer_count = 1;
  d->layers = &layer;
}
static mps_status use_geostatic(const void *def) {
  mps_particles *set = square();
  const mps_status status = mps_particles_set_geostatic(set, def);
  mps_particles_destroy(&set);
  return status;
}

static mps_status use_table(const void *def) {
  static const double position[2] = {0.0, 0.0}, value = 1.0;
  mps_particles *set = square();
  const mps_status status =
      mps_particles_set_table(set, "pore_pressure", 1, position, 1, &value, def, NULL);
  mps_particles_destroy(&set);
  return status;
}

static mps_status use_record(const void *def) {
  mps_signal *made = NULL;
  const mps_status status = mps_signal_create_record(context, TEST_DATA "/sample.AT2", def, &made);
  mps_signal_destroy(&made);
  return status;
}

static mps_status use_fluid_contact(const void *def) {
  mps_particles *set = square();
  mps_fluid *fluid = NULL;
  mps_body *box = NULL;
  mps_body_def at = mps_body_defaults();
  at.position[0] = 1.0, at.position[1] = 4.0;
  mps_assert_ok(context, mps_fluid_create(context, set, NULL, &fluid));
  mps_assert_ok(context, mps_body_create_box(context, &at, 1.0, 1.0, &box));
  const mps_status status = mps_fluid_add_contact(fluid, box, def, NULL);
  mps_fluid_destroy(&fluid);
  mps_body_destroy(&box);
  mps_particles_destroy(&set);
  return status;
}

static mps_status use_fluid_load(const void *def) {
  mps_particles *set = square();
  mps_fluid *fluid = NULL;
  mps_assert_ok(context, mps_fluid_create(context, set, NULL, &fluid));
  const mps_status status = mps_fluid_add_load(fluid, def, NULL);
  mps_fluid_destroy(&fluid);
  mps_particles_destroy(&set);
  return status;
}

static void need_fluid_rock(void *def) {
  static const double corners[] = {0.1, 0.0, 0.0, 0.4, 0.0, 0.0, 0.25, 0.3, 0.0};
  mps_fluid_rock_def *rock = def;
  rock->corners = corners, rock->corner_count = 3;
  rock->porosity = 0.5, rock->diameter = 0.02;
}

static mps_status use_fluid_rock(const void *def) {
  mps_particles *set = square();
  mps_fluid *fluid = NULL;
  mps_assert_ok(context, mps_fluid_create(context, set, NULL, &fluid));
  const mps_status status = mps_fluid_add_rock(fluid, def, NULL);
  mps_fluid_destroy(&fluid);
  mps_particles_destroy(&set);
  return status;
}

static mps_status no_matrix(void *user, int64_t rows, const int64_t *start, const int32_t *column,
                            const double *value) {
  (void)user, (void)rows, (void)start, (void)column, (void)value;
  return MPS_OK;
}

static mps_status no_solution(void *user, const double *b, double tolerance, double *x,
                              int64_t *iterations) {
  (void)user, (void)b, (void)tolerance, (void)x, (void)iterations;
  return MPS_OK;
}

static mps_status no_elastic_matrix(void *user, const mps_elastic_matrix *matrix, size_t size) {
  (void)user, (void)matrix, (void)size;
  return MPS_OK;
}

static void need_elastic_solver(void *def) {
  mps_elastic_solver_def *d = def;
  d->matrix = no_elastic_matrix, d->solve = no_solution;
}

static mps_status no_pore_rows(void *user, int64_t all, int64_t first, int64_t rows,
                               const int64_t *start, const int32_t *column, const double *value) {
  (void)user, (void)all, (void)first, (void)rows, (void)start, (void)column, (void)value;
  return MPS_OK;
}

static void need_pore_solver(void *def) {
  mps_pore_solver_def *d = def;
  d->rows = no_pore_rows, d->solve = no_solution;
}

static void need_fluid_solver(void *def) {
  mps_fluid_solver_def *d = def;
  d->matrix = no_matrix, d->solve = no_solution;
}

static mps_status use_fluid_solver(const void *def) {
  mps_particles *set = square();
  mps_fluid *fluid = NULL;
  mps_assert_ok(context, mps_fluid_create(context, set, NULL, &fluid));
  const mps_status status = mps_fluid_set_solver(fluid, def);
  mps_fluid_destroy(&fluid);
  mps_particles_destroy(&set);
  return status;
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
    {"mps_elastic_load_def", need_nothing, use_elastic_load},
    {"mps_elastic_motion_def", need_elastic_motion, use_elastic_motion},
    {"mps_elastic_solver_def", need_elastic_solver, use_elastic_solver},
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
    {"mps_fluid_load_def", need_nothing, use_fluid_load},
    {"mps_fluid_rock_def", need_fluid_rock, use_fluid_rock},
    {"mps_fluid_contact_def", need_nothing, use_fluid_contact},
    {"mps_fluid_solver_def", need_fluid_solver, use_fluid_solver},
    {"mps_geostatic_def", need_geostatic, use_geostatic},
    {"mps_material_mohr_coulomb_def", need_mohr_coulomb, use_mohr_coulomb},
    {"mps_mpm_def", need_mpm, use_mpm},
    {"mps_mpm_settle_def", need_nothing, use_mpm_settle},
    {"mps_pore_face_def", need_nothing, use_pore_face},
    {"mps_pore_solver_def", need_pore_solver, use_pore_solver},
    {"mps_pore_water_def", need_pore_water, use_pore_water},
    {"mps_neighbours_def", need_neighbours, use_neighbours},
    {"mps_material_newtonian_def", need_newtonian, use_newtonian},
    {"mps_particles_def", need_particles, use_particles},
    {"mps_signal_record_def", need_nothing, use_record},
    {"mps_material_von_mises_def", need_von_mises, use_von_mises},
};

/* ---- every struct ---------------------------------------------------------------------------- */

typedef mps_status (*init_fn)(void *def, size_t size);

#define INIT(type, init, version, size)                                                            \
  static mps_status type##_init_any(void *def, size_t bytes) { return init((type *)def, bytes); }
MPSI_RELEASED_SIZES(INIT)

typedef struct row {
  const char *type;
  size_t released, now;
  init_fn init;
} row;

#define ROW(type, init, version, size) {#type, MPSI_RELEASED(type), sizeof(type), type##_init_any},
static const row rows[] = {MPSI_RELEASED_SIZES(ROW)};
#define ROWS (sizeof rows / sizeof *rows)

static const user *user_of(const char *type) {
  for (size_t k = 0; k < sizeof users / sizeof *users; k++)
    if (strcmp(users[k].type, type) == 0) return &users[k];
  return NULL;
}

/* Exactly `size` bytes, so that a read beyond them is seen by the address sanitizer. */
static void *definition(const row *r, size_t size) {
  unsigned char *def = malloc(size);
  memset(def, 0xee, size);
  assert_int_equal(r->init(def, size), MPS_OK);
  uint32_t stored;
  memcpy(&stored, def, sizeof stored);
  assert_int_equal(stored, size);
  return def;
}

static void init_takes_every_size(void **state) {
  (void)state;
  for (size_t k = 0; k < ROWS; k++) {
    const row *r = &rows[k];
    if (r->now < r->released) fail_msg("%s has shrunk since its release", r->type);
    unsigned char *whole = definition(r, r->now), *old = definition(r, r->released);
    unsigned char *newer = definition(r, r->now + MORE);
    assert_memory_equal(whole + 4, old + 4, r->released - 4);
    assert_memory_equal(whole + 4, newer + 4, r->now - 4);
    for (size_t i = r->now; i < r->now + MORE; i++) assert_int_equal(newer[i], 0);
    assert_int_equal(r->init(whole, r->released - 1), MPS_ERROR_ARGUMENT);
    assert_int_equal(r->init(NULL, r->now), MPS_ERROR_ARGUMENT);
    free(whole);
    free(old);
    free(newer);
  }
}

/* The first `size` bytes of a good definition. */
static void *good_definition(const row *r, const user *u, size_t size) {
  unsigned char *whole = definition(r, r->now), *def = definition(r, size);
  u->need(whole);
  const size_t common = size < r->now ? size : r->now;
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

static void create_takes_every_size(void **state) {
  (void)state;
  for (size_t k = 0; k < ROWS; k++) {
    const row *r = &rows[k];
    const user *u = user_of(r->type);
    if (!u) fail_msg("nothing here uses a %s: give it a line in users", r->type);
    if (!is_built(r->type)) continue;
    expect(r, u, good_definition(r, u, r->now), MPS_OK, "as it is");
    expect(r, u, good_definition(r, u, r->released), MPS_OK, "as released");
    expect(r, u, good_definition(r, u, r->now + MORE), MPS_OK, "larger, with zeros");
    for (size_t at = r->now; at < r->now + MORE; at += MORE - 1) {
      unsigned char *unknown = good_definition(r, u, r->now + MORE);
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
static void sizes_beyond_any_struct_are_refused(void **state) {
  (void)state;
  const uint32_t wrong[] = {MPSI_STRUCT_MOST + 1, INT32_MAX, UINT32_MAX};
  for (size_t k = 0; k < ROWS; k++) {
    const row *r = &rows[k];
    const user *u = user_of(r->type);
    unsigned char *def = definition(r, r->now);
    assert_int_equal(r->init(def, (size_t)MPSI_STRUCT_MOST + 1), MPS_ERROR_ARGUMENT);
    assert_int_equal(r->init(def, SIZE_MAX), MPS_ERROR_ARGUMENT);
    free(def);
    for (size_t w = 0; is_built(r->type) && w < sizeof wrong / sizeof *wrong; w++) {
      def = good_definition(r, u, r->now);
      memcpy(def, &wrong[w], sizeof wrong[w]);
      expect(r, u, def, MPS_ERROR_ARGUMENT, "of a size that no struct has");
    }
  }
  char text[200];
  mps_context *own = NULL;
  mps_context_def def = mps_context_defaults();
  def.struct_size = UINT32_MAX;
  assert_int_equal(mps_context_create(&def, &own, text, sizeof text), MPS_ERROR_ARGUMENT);
  assert_non_null(strstr(text, "struct_size is 4294967295 bytes, allowed are 104 to 4096"));
}

/* ---- results --------------------------------------------------------------------------------- */

static void results_stay_within_the_callers_struct(void **state) {
  (void)state;
  const double known[3] = {1.0, 2.0, 3.0};
  double out[5] = {-1.0, -1.0, -1.0, -1.0, -1.0};
  mps_assert_ok(context, mpsi_out_write(context, "f", out, 16, known, sizeof known));
  const double older[5] = {1.0, 2.0, -1.0, -1.0, -1.0};
  assert_memory_equal(out, older, sizeof out);
  mps_assert_ok(context, mpsi_out_write(context, "f", out, 32, known, sizeof known));
  const double newer[5] = {1.0, 2.0, 3.0, 0.0, -1.0};
  assert_memory_equal(out, newer, sizeof out);
  mps_assert_fails(context, mpsi_out_write(context, "f", NULL, 8, known, sizeof known),
                   MPS_ERROR_ARGUMENT, "NULL");
  mps_assert_fails(context, mpsi_out_write(context, "f", out, 0, known, sizeof known),
                   MPS_ERROR_ARGUMENT, "size is 0");
  mps_assert_fails(context, mpsi_out_write(context, "f", out, SIZE_MAX, known, sizeof known),
                   MPS_ERROR_ARGUMENT, "allowed are 1 to 4096");
}

/* Field by field: the struct of a caller with only its first members. */
/* A program built against an older libmps queries a definition and creates another solver by it:
 * the size that comes with it is the program's. */
static void definitions_come_back_with_the_callers_size(void **state) {
  (void)state;
  mps_particles *set = square();
  mps_fluid *fluid = NULL;
  mps_dynamics *dynamics = NULL;
  mps_material *material = NULL;
  mps_mpm *mpm = NULL;
  const uint32_t size = 16;
  union {
    uint32_t size;
    mps_mpm_def mpm;
    mps_fluid_def fluid;
    mps_dynamics_def dynamics;
  } part;
  mps_assert_ok(context, mps_fluid_create(context, set, NULL, &fluid));
  mps_assert_ok(context, mps_fluid_get_def_sized(fluid, &part.fluid, size));
  assert_int_equal(part.size, size);
  mps_assert_ok(context, mps_fluid_get_def(fluid, &part.fluid));
  assert_int_equal(part.size, sizeof part.fluid);
  mps_fluid_destroy(&fluid);
  mps_assert_ok(context, mps_dynamics_create(context, set, NULL, &dynamics));
  mps_assert_ok(context, mps_dynamics_get_def_sized(dynamics, &part.dynamics, size));
  assert_int_equal(part.size, size);
  mps_dynamics_destroy(&dynamics);
  mps_mpm_def def = mps_mpm_defaults();
  def.cell = 1.0;
  mps_assert_ok(context, mps_material_create_linear_elastic(context, 1e7, 0.3, &material));
  mps_assert_ok(context, mps_mpm_create(context, set, material, &def, &mpm));
  mps_assert_ok(context, mps_mpm_get_def_sized(mpm, &part.mpm, size));
  assert_int_equal(part.size, size);
  mps_mpm_destroy(&mpm);
  mps_material_destroy(&material);
  mps_particles_destroy(&set);
}

static void descriptions_of_fields_are_sized(void **state) {
  (void)state;
  mps_particles *set = square();
  mps_particles_field_info whole;
  memset(&whole, 0xee, sizeof whole);
  mps_assert_ok(context, mps_particles_get_field_info(set, 1, &whole));
  assert_string_equal(whole.name, "position");
  mps_particles_field_info part;
  memset(&part, 0xee, sizeof part);
  mps_assert_ok(context, mps_particles_get_field_info_sized(
                             set, 1, &part, offsetof(mps_particles_field_info, meaning)));
  assert_string_equal(part.name, "position");
  assert_string_equal(part.unit, "m");
  assert_int_equal(part.flags, 0xeeeeeeee);
  mps_particles_destroy(&set);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(init_takes_every_size),
      cmocka_unit_test(create_takes_every_size),
      cmocka_unit_test(sizes_beyond_any_struct_are_refused),
      cmocka_unit_test(results_stay_within_the_callers_struct),
      cmocka_unit_test(definitions_come_back_with_the_callers_size),
      cmocka_unit_test(descriptions_of_fields_are_sized),
  };
  return cmocka_run_group_tests(tests, make_context, drop_context);
}
