/* host_scenes.h - a short scene of every solver, from creation to a restored state, for tests of
 * what a host's thread may be like. They report by their status, so that any thread may run them.
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef MPS_TEST_HOST_SCENES_H
#define MPS_TEST_HOST_SCENES_H

#include "test_common.h"

#define HOST_FILE TEST_TMP "/host_scenes.h5"
/* The first call that fails is the scene's status. */
#define HOST_TRY(call)                                                                             \
  do {                                                                                             \
    const mps_status tried = (call);                                                               \
    if (tried != MPS_OK) return tried;                                                             \
  } while (0)

typedef struct host_scene {
  const char *name;
  mps_status (*run)(mps_context *context);
} host_scene;

static mps_status host_box(mps_context *c, int dim, double spacing, const double *lo,
                           const double *hi, double density, mps_particles **out) {
  DEF(particles, def, .spacing = spacing, .dim = dim);
  HOST_TRY(mps_particles_create(c, &def, out));
  HOST_TRY(mps_particles_fill_box(*out, lo, hi, NULL));
  return mps_particles_set(*out, "density", 0, density);
}

/* ---- WLS-MPM --------------------------------------------------------------------------------- */

enum {
  HOST_ELASTIC,
  HOST_MISES,
  HOST_MOHR,
  HOST_SOIL_DP,
  HOST_CLAY,
  HOST_SMALL,
  HOST_WATER,
  HOST_LAWS
};

static mps_status host_law(mps_context *c, int law, mps_material **out) {
  DEF(material_von_mises, mises, .young = 2e6, .poisson = 0.3, .yield_stress = 2e3);
  DEF(material_mohr_coulomb, mohr, .young = 2e6, .poisson = 0.3, .friction = 0.5, .cohesion = 10.0);
  DEF(material_drucker_prager, prager, .young = 2e6, .poisson = 0.3, .friction = 0.5,
      .cohesion = 10.0);
  DEF(material_cam_clay, clay, .critical_slope = 1.1, .compression = 0.13, .swelling = 0.03,
      .void_ratio = 0.9, .preconsolidation = 6e4);
  DEF(material_small_strain, small, .shear_modulus = 1e6, .reference_strain = 1e-3);
  DEF(material_newtonian, water, .bulk_modulus = 2e6, .viscosity = 1.0);
  switch (law) {
  case HOST_MISES:
    return mps_material_create_von_mises(c, &mises, out);
  case HOST_MOHR:
    return mps_material_create_mohr_coulomb(c, &mohr, out);
  case HOST_SOIL_DP:
    return mps_material_create_drucker_prager(c, &prager, out);
  case HOST_CLAY:
    return mps_material_create_cam_clay(c, &clay, out);
  case HOST_SMALL:
    return mps_material_create_small_strain(c, &small, out);
  case HOST_WATER:
    return mps_material_create_newtonian(c, &water, out);
  default:
    return mps_material_create_linear_elastic(c, 2e6, 0.3, out);
  }
}

typedef struct host_mpm {
  int geometry, law, method; /* of contact; -1: no body */
  bool thin, budget, settles, wet, flows, implicit, filtered, frictional;
} host_mpm;

static mps_status host_add_body(mps_context *c, mps_mpm *mpm, const host_mpm *how) {
  DEF(contact, contact, .method = how->method, .friction = 0.3);
  scoped_body *body = NULL;
  if (how->method == MPS_CONTACT_METHOD_IMPULSE) contact.adhesion = 10.0, contact.strength = 100.0;
  contact.thin = contact.inside = how->thin;
  DEF(body, place, .position[0] = how->geometry == MPS_MPM_GEOMETRY_AXISYMMETRIC ? 0.0 : 0.5,
      .position[1] = 0.5,
      .position[how->geometry == MPS_MPM_GEOMETRY_SPACE ? 2 : 1] = how->thin ? 0.9 : 1.01);
  if (how->geometry == MPS_MPM_GEOMETRY_SPACE)
    HOST_TRY(mps_body_create_sphere(c, &place, 0.2, &body));
  else if (how->geometry == MPS_MPM_GEOMETRY_PLANE_STRAIN)
    HOST_TRY(mps_body_create_box(c, &place, how->thin ? 0.03 : 0.4, 0.4, &body));
  else
    HOST_TRY(mps_body_create_disc(c, &place, 0.2, &body));
  mps_body_motion motion = mps_body_motion_defaults();
  motion.velocity[how->geometry == MPS_MPM_GEOMETRY_SPACE ? 2 : 1] = -1.0;
  HOST_TRY(mps_body_set_motion(body, &motion));
  HOST_TRY(mps_mpm_add_contact(mpm, body, &contact, NULL));
  return MPS_OK;
}

static mps_status host_add_water(mps_mpm *mpm, const host_mpm *how) {
  DEF(pore_water, water, .porosity = 0.4, .bulk = 1e7);
  if (how->flows || how->implicit) water.permeability = 1e-3;
  if (how->implicit) water.scheme = MPS_PORE_SCHEME_IMPLICIT;
  return mps_mpm_add_pore_water(mpm, &water);
}

static mps_status host_fields(mps_mpm *mpm) {
  mps_particles *set = mps_mpm_particles(mpm);
  mps_totals totals;
  const double points[6] = {0.3, 0.3, 0.3, 0.4, 0.4, 0.4};
  double values[2];
  int32_t states[2];
  HOST_TRY(mps_mpm_get_totals(mpm, &totals));
  HOST_TRY(mps_grid_evaluate(mps_mpm_grid(mpm), "stress", 0, 2, points, values, states));
  return mps_particles_count(set) > 0 ? MPS_OK : MPS_ERROR_STATE;
}

static mps_status host_mpm_make(mps_context *c, const host_mpm *how, mps_mpm **out) {
  const int dim = how->geometry == MPS_MPM_GEOMETRY_SPACE ? 3 : 2, up = dim - 1;
  const double lo[3] = {0.0, 0.0, 0.0}, hi[3] = {1.0, 0.8, 0.8};
  scoped_particles *set = NULL;
  scoped_material *law = NULL;
  HOST_TRY(host_box(c, dim, 0.1, lo, hi, 2000.0, &set));
  HOST_TRY(host_law(c, how->law, &law));
  if (how->law == HOST_CLAY)
    for (int k = 0; k < 3; k++) HOST_TRY(mps_particles_set(set, "stress", k, -2e4));
  DEF(mpm, def, .cell = 0.2, .geometry = how->geometry, .budget = how->budget,
      .volumetric = how->filtered ? MPS_MPM_VOLUMETRIC_NODES : MPS_MPM_VOLUMETRIC_BY_LAW,
      .gravity[up] = -9.81);
  for (int k = 0; k < dim; k++)
    def.lower[k] = 0.0, def.upper[k] = k == up ? 2.0 : k == 1 ? 0.8 : 1.0;
  HOST_TRY(mps_mpm_create(c, set, law, &def, out));
  DEF(mpm_boundary, side, .kind = MPS_BOUNDARY_FRICTIONAL, .friction = 0.3);
  const int which = how->geometry == MPS_MPM_GEOMETRY_AXISYMMETRIC ? 1 : 0; /* not the axis */
  if (how->frictional) HOST_TRY(mps_mpm_set_boundary(*out, which, &side));
  if (how->wet) HOST_TRY(host_add_water(*out, how));
  return how->method >= 0 ? host_add_body(c, *out, how) : MPS_OK;
}

static mps_status host_mpm_run(mps_context *c, host_mpm how) {
  scoped_mpm *mpm = NULL;
  scoped_snapshot *snapshot = NULL;
  mps_mpm_settled settled;
  HOST_TRY(host_mpm_make(c, &how, &mpm));
  DEF(mpm_settle, settle, .max_steps = 5, .tolerance = 0.5);
  if (how.settles) {
    const mps_status status = mps_mpm_settle(mpm, &settle, &settled);
    if (status != MPS_OK && status != MPS_ERROR_NUMERIC) return status;
  }
  HOST_TRY(mps_mpm_step(mpm, 6));
  HOST_TRY(host_fields(mpm));
  HOST_TRY(mps_mpm_snapshot(mpm, &snapshot));
  HOST_TRY(mps_mpm_run(mpm, mps_mpm_time(mpm) + 3.0 * mps_mpm_dt(mpm), 1, NULL, NULL));
  HOST_TRY(mps_mpm_rollback(mpm, snapshot));
  HOST_TRY(mps_mpm_step(mpm, 2));
  return MPS_OK;
}

#define HOST_MPM(name, ...)                                                                        \
  static mps_status host_##name(mps_context *c) { return host_mpm_run(c, (host_mpm){__VA_ARGS__}); }
HOST_MPM(plane, .frictional = true, .budget = true, .settles = true)
HOST_MPM(penalty, .method = MPS_CONTACT_METHOD_PENALTY, .law = HOST_MOHR)
HOST_MPM(thin, .thin = true, .law = HOST_SOIL_DP)
HOST_MPM(axial, .geometry = MPS_MPM_GEOMETRY_AXISYMMETRIC, .law = HOST_CLAY, .frictional = true)
HOST_MPM(space, .geometry = MPS_MPM_GEOMETRY_SPACE, .law = HOST_MISES, .budget = true,
         .settles = true)
HOST_MPM(space_clay, .geometry = MPS_MPM_GEOMETRY_SPACE, .law = HOST_CLAY, .frictional = true)
HOST_MPM(space_small, .geometry = MPS_MPM_GEOMETRY_SPACE, .law = HOST_SMALL,
         .method = MPS_CONTACT_METHOD_PENALTY)
HOST_MPM(filtered, .law = HOST_MOHR, .filtered = true, .frictional = true)
HOST_MPM(newtonian, .law = HOST_WATER, .method = -1)
HOST_MPM(undrained, .wet = true, .law = HOST_MOHR)
HOST_MPM(drained, .wet = true, .flows = true, .method = -1)
HOST_MPM(implicit_water, .wet = true, .implicit = true, .method = -1)
HOST_MPM(wet_space, .wet = true, .flows = true, .method = -1, .geometry = MPS_MPM_GEOMETRY_SPACE)

/* ---- the others ------------------------------------------------------------------------------ */

static mps_status host_dynamics(mps_context *c) {
  const double lo[2] = {0.0, 0.0}, hi[2] = {3.0, 4.0};
  scoped_particles *set = NULL;
  scoped_dynamics *dynamics = NULL;
  mps_dynamics_linear_limit limit;
  scoped_snapshot *snapshot = NULL;
  mps_totals totals;
  mps_dynamics_def def = mps_dynamics_defaults();
  int32_t number;
  HOST_TRY(host_box(c, 2, 0.25, lo, hi, 2000.0, &set));
  HOST_TRY(mps_particles_set(set, "shear_velocity", 0, 100.0));
  HOST_TRY(mps_particles_set(set, "pressure_velocity", 0, 200.0));
  HOST_TRY(mps_particles_set(set, "damping", 0, 0.02));
  HOST_TRY(mps_dynamics_create(c, set, &def, &dynamics));
  DEF(dynamics_boundary, base, .lower[1] = 0.0, .upper[1] = 0.25, .kind = MPS_BOUNDARY_DRIVEN,
      .dofs = MPS_DOF_Y);
  HOST_TRY(mps_signal_create_ricker(c, 10.0, 0.05, 1.0, &base.signal[0]));
  base.lower[0] = 0.0, base.upper[0] = 3.0;
  HOST_TRY(mps_dynamics_add_boundary(dynamics, &base, &number));
  mps_signal_destroy(&base.signal[0]);
  HOST_TRY(mps_dynamics_find_limit(dynamics, 0.0, &limit));
  HOST_TRY(mps_dynamics_step(dynamics, 20));
  HOST_TRY(mps_dynamics_get_totals(dynamics, &totals));
  HOST_TRY(mps_dynamics_snapshot(dynamics, &snapshot));
  HOST_TRY(mps_dynamics_run(dynamics, mps_dynamics_time(dynamics) + 5e-3, 1, NULL, NULL));
  HOST_TRY(mps_dynamics_rollback(dynamics, snapshot));
  return MPS_OK;
}

static mps_status host_water(mps_context *c) {
  const double lo[2] = {0.0, 0.0}, hi[2] = {0.8, 0.4};
  const double wall[3][4] = {{0, 0, 0, 1}, {0, 0, 1, 0}, {0.8, 0, -1, 0}};
  scoped_particles *set = NULL;
  scoped_fluid *fluid = NULL;
  scoped_snapshot *snapshot = NULL;
  mps_totals totals;
  int32_t number;
  HOST_TRY(host_box(c, 2, 0.02, lo, hi, 1000.0, &set));
  HOST_TRY(mps_fluid_create(c, set, NULL, &fluid));
  for (int k = 0; k < 3; k++) {
    DEF(fluid_boundary, def, .kind = MPS_BOUNDARY_ROLLER);
    for (int a = 0; a < 2; a++) def.point[a] = wall[k][a], def.normal[a] = wall[k][2 + a];
    HOST_TRY(mps_fluid_add_boundary(fluid, &def, &number));
  }
  HOST_TRY(mps_fluid_step(fluid, 5));
  HOST_TRY(mps_fluid_get_totals(fluid, &totals));
  HOST_TRY(mps_fluid_snapshot(fluid, &snapshot));
  HOST_TRY(mps_fluid_run(fluid, mps_fluid_time(fluid) + 2e-3, 1, NULL, NULL));
  HOST_TRY(mps_fluid_rollback(fluid, snapshot));
  return MPS_OK;
}

/* A law at one point: given strains, and given stresses. */
static mps_status host_point(mps_context *c) {
  for (int law = 0; law < HOST_LAWS; law++) {
    const double gradient[9] = {-1e-3, 0, 0, 0, 1e-3}, target[6] = {-2.2e4, -2e4, -2e4};
    scoped_material *material = NULL;
    mps_material_point point;
    HOST_TRY(host_law(c, law, &material));
    HOST_TRY(mps_material_point_init(c, material, &point));
    for (int k = 0; k < 3; k++) point.stress[k] = -2e4;
    HOST_TRY(mps_material_point_drive(c, material, &point, gradient, 1.0, 20));
    if (law == HOST_CLAY)
      HOST_TRY(mps_material_point_control(c, material, &point, gradient, 1, target, 1.0, 5, NULL));
  }
  return MPS_OK;
}

static mps_status host_elastic_make(mps_context *c, int32_t solver, mps_elastic **out) {
  const double lo[2] = {0.0, 0.0}, hi[2] = {0.4, 2.0};
  scoped_particles *set = NULL;
  DEF(elastic, def, .solver = solver);
  int32_t number;
  HOST_TRY(host_box(c, 2, 0.1, lo, hi, 2000.0, &set));
  HOST_TRY(mps_particles_set(set, "young", 0, 3e7));
  HOST_TRY(mps_particles_set(set, "poisson", 0, 0.25));
  HOST_TRY(mps_elastic_create(c, set, &def, out));
  DEF(elastic_boundary, foot, .lower[0] = foot.lower[1] = -1.0, .upper[0] = 9.0, .upper[1] = 0.1);
  HOST_TRY(mps_elastic_add_boundary(*out, &foot, &number));
  DEF(elastic_load, load, .kind = MPS_ELASTIC_LOAD_VOLUME, .all = 1, .force[0] = 1e3);
  HOST_TRY(mps_elastic_add_load(*out, &load, &number));
  return MPS_OK;
}

/* By one of the solvers of its equations: CHOLMOD and ARPACK, or conjugate gradients. */
static mps_status host_elastic(mps_context *c, int32_t solver, bool modes) {
  scoped_elastic *elastic = NULL;
  mps_totals totals;
  double omega[2];
  HOST_TRY(host_elastic_make(c, solver, &elastic));
  HOST_TRY(mps_elastic_solve(elastic));
  if (modes) HOST_TRY(mps_elastic_modes(elastic, 2, omega, NULL));
  DEF(elastic_motion, motion, .dt = 1e-3);
  HOST_TRY(mps_elastic_start(elastic, &motion));
  HOST_TRY(mps_elastic_step(elastic, 3));
  HOST_TRY(mps_elastic_run(elastic, 5e-3, 1, NULL, NULL));
  HOST_TRY(mps_elastic_get_totals(elastic, &totals));
  return MPS_OK;
}

/* ---- files ----------------------------------------------------------------------------------- */

static mps_status host_files(mps_context *c) {
  const host_mpm how = {.law = HOST_MOHR, .wet = true};
  scoped_mpm *mpm = NULL;
  mps_recorder *recorder = NULL;
  HOST_TRY(host_mpm_make(c, &how, &mpm));
  HOST_TRY(mps_mpm_step(mpm, 2));
  HOST_TRY(mps_mpm_save(mpm, HOST_FILE, NULL));
  HOST_TRY(mps_mpm_step(mpm, 2));
  HOST_TRY(mps_mpm_restore(mpm, HOST_FILE, NULL));
  DEF(recorder, def, .path = TEST_TMP "/host_scenes.vtkhdf");
  HOST_TRY(mps_recorder_create(c, mps_mpm_particles(mpm), &def, &recorder));
  HOST_TRY(mps_recorder_write(recorder, 0.0));
  HOST_TRY(mps_recorder_close(&recorder));
  return MPS_OK;
}

/* ---- all of them: by the library alone, and with foreign libraries --------------------------- */

static mps_status host_elastic_cg(mps_context *c) {
  return host_elastic(c, MPS_ELASTIC_SOLVER_CG, false);
}
static mps_status host_elastic_llt(mps_context *c) {
  return host_elastic(c, MPS_ELASTIC_SOLVER_LLT, true);
}

static const host_scene host_own[] = {{"plane", host_plane},
                                      {"penalty", host_penalty},
                                      {"thin body", host_thin},
                                      {"axisymmetry", host_axial},
                                      {"space", host_space},
                                      {"space, Cam-Clay", host_space_clay},
                                      {"space, small strains", host_space_small},
                                      {"filtered stresses", host_filtered},
                                      {"fluid of WLS-MPM", host_newtonian},
                                      {"undrained", host_undrained},
                                      {"drained", host_drained},
                                      {"implicit pore pressures", host_implicit_water},
                                      {"drained in space", host_wet_space},
                                      {"explicit dynamics", host_dynamics},
                                      {"free surface", host_water},
                                      {"laws at a point", host_point}};
static const host_scene host_foreign[] = {{"elasticity, CG", host_elastic_cg},
                                          {"elasticity, CHOLMOD and ARPACK", host_elastic_llt},
                                          {"files", host_files}};

#endif
