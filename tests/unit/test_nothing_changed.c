/* test_nothing_changed.c - calls that find no memory: one allocation after the other is refused
 * within a call. Each time the call returns MPS_ERROR_MEMORY with a record in its own name, and all
 * that the caller can see of set, solver and bodies is as before it.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "unchanged.h"

#include "test_allocator.h"

SEEN_SOLVER(mpm)
SEEN_SOLVER(dynamics)
SEEN_SOLVER(elastic)
SEEN_SOLVER(fluid)

/* What a call works on. */
typedef struct scene {
  test_allocator memory;
  mps_context *own;
  mps_particles *set, *nodes;
  mps_mpm *mpm;
  mps_dynamics *dynamics;
  mps_elastic *elastic;
  mps_fluid *fluid;
  mps_body *body, *other;
  mps_contact *contact;
  mps_snapshot *snapshot;
  mps_material *material, *second;
  int32_t number; /* of the boundary or load that was added first */
} scene;

static const char *const file = "test_nothing_changed.h5";
static const int64_t some[3] = {3, 4, 9};
static const double nowhere[4] = {0.05, 0.62, 0.75, 0.62};

static void make_set(scene *s, double spacing, double height) {
  USING(particles, mps_particles_create(s->own, &given, &s->set), .spacing = spacing);
  OK(mps_particles_fill_box(s->set, AT(0.0, 0.0), AT(0.8, height), NULL));
  SET_FIELDS(s->set, {"density", 2000.0}, {"velocity", 0.01});
  OK(mps_material_create_linear_elastic(s->own, 1e6, 0.25, &s->material));
  OK(mps_material_create_linear_elastic(s->own, 2e6, 0.25, &s->second));
}

/* Calls that add and change a load on some particles. */
#define LOADS(S)                                                                                   \
  static mps_status S##_load(scene *s, bool add) {                                                 \
    mps_##S##_load_def def = mps_##S##_load_defaults();                                            \
    def.ids = some, def.id_count = 3;                                                              \
    return add ? mps_##S##_add_load(s->S, &def, NULL) : mps_##S##_set_load(s->S, 0, &def);         \
  }                                                                                                \
  static mps_status S##_add_load(scene *s) { return S##_load(s, true); }                           \
  static mps_status S##_set_load(scene *s) { return S##_load(s, false); }

/* ---- WLS-MPM --------------------------------------------------------------------------------- */

static void make_mpm(scene *s) {
  mps_mpm_boundary_def side = mps_mpm_boundary_defaults();
  mps_mpm_load_def load = mps_mpm_load_defaults();
  make_set(s, 0.1, 0.4);
  DEF(mpm, def, .cell = 0.2, .gravity[1] = -9.81);
  for (int c = 0; c < 2; c++) def.lower[c] = 0.0, def.upper[c] = 0.8;
  OK(mps_mpm_create(s->own, s->set, s->material, &def, &s->mpm));
  side.kind = MPS_BOUNDARY_ABSORBING;
  OK(mps_mpm_set_boundary(s->mpm, MPS_SIDE_X_LOWER, &side));
  side = mps_mpm_boundary_defaults();
  side.ids = some, side.id_count = 1;
  OK(mps_mpm_add_boundary(s->mpm, &side, &s->number));
  load.ids = some + 1, load.id_count = 1, load.traction[0] = 10.0;
  OK(mps_mpm_add_load(s->mpm, &load, NULL));
  DEF(body, place, .position[0] = 0.4, .position[1] = 0.57);
  OK(mps_body_create_disc(s->own, &place, 0.15, &s->body));
  OK(mps_mpm_add_contact(s->mpm, s->body, NULL, &s->contact));
  place.position[0] = 0.1, place.position[1] = 0.7;
  OK(mps_body_create_disc(s->own, &place, 0.1, &s->other));
  OK(mps_mpm_step(s->mpm, 3));
  OK(mps_mpm_snapshot(s->mpm, &s->snapshot));
  OK(mps_mpm_save(s->mpm, file, NULL));
  OK(mps_mpm_step(s->mpm, 2));
}

/* Particles added since the last step, and a field written. */
static void make_edited_mpm(scene *s) {
  make_mpm(s);
  OK(mps_particles_append(s->set, 2, nowhere));
  EDIT(edit, s->set, "density")
    for (int64_t k = 0; k < edit.view.shape[0]; k++) *mps_edit_f64(&edit, k, 0) = 2000.0;
  OK(mps_particles_set(s->set, "velocity", 1, 5.0));
}

static mps_status mpm_step(scene *s) { return mps_mpm_step(s->mpm, 1); }
static mps_status mpm_run(scene *s) {
  return mps_mpm_run(s->mpm, mps_mpm_time(s->mpm) + 1e-4, 1, NULL, NULL);
}
static mps_status mpm_settle(scene *s) { return mps_mpm_settle(s->mpm, NULL, NULL); }
static mps_status mpm_snapshot(scene *s) { return mps_mpm_snapshot(s->mpm, &s->snapshot); }
static mps_status mpm_rollback(scene *s) { return mps_mpm_rollback(s->mpm, s->snapshot); }
static mps_status mpm_save(scene *s) { return mps_mpm_save(s->mpm, file, NULL); }
static mps_status mpm_restore(scene *s) { return mps_mpm_restore(s->mpm, file, NULL); }
static mps_status mpm_add_boundary(scene *s) {
  DEF(mpm_boundary, def, .ids = some, .id_count = 3);
  return mps_mpm_add_boundary(s->mpm, &def, NULL);
}
static mps_status mpm_set_boundary(scene *s) {
  DEF(mpm_boundary, def, .ids = some, .id_count = 3);
  return mps_mpm_set_boundary(s->mpm, s->number, &def);
}
static mps_status mpm_set_side(scene *s) {
  DEF(mpm_boundary, def, .kind = MPS_BOUNDARY_FREE);
  return mps_mpm_set_boundary(s->mpm, MPS_SIDE_X_UPPER, &def);
}
LOADS(mpm)
static mps_status mpm_add_contact(scene *s) {
  return mps_mpm_add_contact(s->mpm, s->other, NULL, NULL);
}
static mps_status fields_of_material(scene *s) {
  return mps_particles_set_material(s->set, s->second, 1500.0, some, 2);
}
static mps_status mpm_set_material(scene *s) {
  return mps_mpm_set_material(s->mpm, s->second, some, 2);
}
static mps_status mpm_totals(scene *s) {
  mps_totals totals;
  return mps_mpm_get_totals(s->mpm, &totals);
}
static mps_status grid_nodes(scene *s) {
  int64_t count;
  return mps_grid_get_nodes(mps_mpm_grid(s->mpm), 0, &count, NULL, NULL, NULL, NULL);
}
static mps_status grid_evaluate(scene *s) {
  const double points[6] = {0.3, 0.2, 0.0, 0.7, 0.7, 0.0};
  double values[2];
  return mps_grid_evaluate(mps_mpm_grid(s->mpm), "density", 0, 2, points, values, NULL);
}
static mps_status contact_particles(scene *s) {
  int64_t count;
  return mps_contact_get_particles(s->contact, 0, &count, NULL, NULL, NULL, NULL, NULL);
}

/* ---- the set --------------------------------------------------------------------------------- */

static void make_bare(scene *s) { make_set(s, 0.1, 0.4); }

static mps_status append(scene *s) {
  double x[400];
  for (int k = 0; k < 200; k++) x[2 * k] = 0.02 + 1e-4 * k, x[2 * k + 1] = 0.62;
  return mps_particles_append(s->set, 200, x);
}
static mps_status fill_box(scene *s) {
  return mps_particles_fill_box(s->set, AT(0.0, 0.6), AT(0.2, 0.8), NULL);
}
static mps_status fill_ball(scene *s) {
  const double centre[2] = {0.3, 0.63};
  return mps_particles_fill_ball(s->set, centre, 0.15, NULL);
}
static mps_status fill_polygon(scene *s) {
  const double xy[6] = {0.0, 0.5, 0.8, 0.5, 0.0, 0.8};
  return mps_particles_fill_polygon(s->set, 3, xy, NULL);
}
static mps_status remove_some(scene *s) {
  const int64_t corner[2] = {30, 31};
  return mps_particles_remove(s->set, corner, 2);
}
static mps_status add_field(scene *s) { return mps_particles_add_field(s->set, "user.mine", 3); }
static mps_status set_field(scene *s) {
  return mps_particles_set(s->set, "external_force", 1, 2.0);
}
static mps_status edit_velocity(scene *s) {
  mps_edit edit;
  const mps_status status = mps_particles_edit(s->set, "velocity", &edit);
  if (status != MPS_OK) return status;
  *mps_edit_f64(&edit, 0, 0) = 0.5;
  OK(mps_particles_commit(s->set, &edit));
  return MPS_OK;
}
static mps_status set_array(scene *s) {
  double values[400] = {0.0};
  values[3] = 0.5;
  return mps_particles_set_array(s->set, "velocity", 1, values, mps_particles_count(s->set));
}
static mps_status copy_set(scene *s) {
  scoped_particles *copy = NULL;
  return mps_particles_copy(s->set, &copy);
}
static mps_status set_geostatic(scene *s) {
  const mps_geostatic_layer layer = {.thickness = 1.0, .k0 = 0.5, .density = 1800.0};
  mps_geostatic_def def;
  assert_int_equal(mps_def_init(MPS_DEF_GEOSTATIC, &def, sizeof def), MPS_OK);
  def.layers = &layer, def.layer_count = 1;
  return mps_particles_set_geostatic(s->set, &def);
}
static mps_status no_stress(void *user, const double *x, double *stress) {
  for (int c = 0; c < 6; c++) stress[c] = -1.0;
  return MPS_OK;
}
static mps_status set_stress(scene *s) { return mps_particles_set_stress(s->set, no_stress, NULL); }
static mps_status set_table(scene *s) {
  static const double x[6] = {0.0, 0.0, 1.0, 0.0, 0.0, 1.0}, values[3] = {1.0, 2.0, 3.0};
  mps_table_def def;
  assert_int_equal(mps_def_init(MPS_DEF_TABLE, &def, sizeof def), MPS_OK);
  def.interpolation = MPS_TABLE_INTERPOLATION_LINEAR;
  return mps_particles_set_table(s->set, "pore_pressure", 3, x, 1, values, &def, NULL);
}
static mps_status create_mpm(scene *s) {
  DEF(mpm, def, .cell = 0.2);
  const mps_status status = mps_mpm_create(s->own, s->set, s->material, &def, &s->mpm);
  assert_true((status == MPS_OK) == (s->mpm != NULL));
  return status;
}
static mps_status create_dynamics(scene *s) {
  DEF(dynamics, def, .material = s->material);
  const mps_status status = mps_dynamics_create(s->own, s->set, &def, &s->dynamics);
  assert_true((status == MPS_OK) == (s->dynamics != NULL));
  return status;
}
static mps_status create_elastic(scene *s) {
  DEF(elastic, def, .material = s->material);
  const mps_status status = mps_elastic_create(s->own, s->set, &def, &s->elastic);
  assert_true((status == MPS_OK) == (s->elastic != NULL));
  return status;
}
static mps_status create_fluid(scene *s) {
  const mps_status status = mps_fluid_create(s->own, s->set, NULL, &s->fluid);
  assert_true((status == MPS_OK) == (s->fluid != NULL));
  return status;
}

/* Twice: with the second column the set needs more room. */
static void make_ground(scene *s) {
  make_set(s, 0.1, 0.4);
  OK(mps_dynamics_add_free_field(s->set, MPS_SIDE_X_LOWER, 3));
}
static mps_status add_free_field(scene *s) {
  return mps_dynamics_add_free_field(s->set, MPS_SIDE_X_UPPER, 3);
}

/* ---- explicit dynamics ----------------------------------------------------------------------- */

static void make_dynamics(scene *s) {
  make_set(s, 0.1, 0.4);
  OK(create_dynamics(s));
  DEF(dynamics_boundary, base, .lower[0] = base.lower[1] = -1.0, .upper[0] = 9.0, .upper[1] = 0.1,
      .dofs = MPS_DOF_X | MPS_DOF_Y);
  OK(mps_dynamics_add_boundary(s->dynamics, &base, &s->number));
  DEF(dynamics_load, load, .ids = some, .id_count = 2, .traction[0] = 10.0);
  OK(mps_dynamics_add_load(s->dynamics, &load, NULL));
  OK(mps_dynamics_step(s->dynamics, 3));
  OK(mps_dynamics_snapshot(s->dynamics, &s->snapshot));
  OK(mps_dynamics_save(s->dynamics, file, NULL));
  OK(mps_dynamics_step(s->dynamics, 2));
}
/* Particles out of order, damping, a free-field column; then some are dug away behind a snapshot.
 */
static void make_hard_ground(scene *s) {
  const double lone[2] = {0.85, 0.05};
  make_set(s, 0.1, 0.4);
  OK(mps_particles_append(s->set, 1, lone));
  SET_FIELDS(s->set, {"density", 1500.0}, {"damping", 0.05});
  OK(mps_dynamics_add_free_field(s->set, MPS_SIDE_X_LOWER, 3));
}
static void make_dug(scene *s) {
  make_hard_ground(s);
  OK(create_dynamics(s));
  DEF(dynamics_boundary, held, .ids = some, .id_count = 3, .dofs = MPS_DOF_X | MPS_DOF_Y);
  OK(mps_dynamics_add_boundary(s->dynamics, &held, &s->number));
  OK(mps_dynamics_step(s->dynamics, 2));
  OK(mps_dynamics_snapshot(s->dynamics, &s->snapshot));
  OK(mps_particles_remove(s->set, (const int64_t[2]){4, 20}, 2));
  OK(mps_dynamics_step(s->dynamics, 2));
}
static mps_status dynamics_step(scene *s) { return mps_dynamics_step(s->dynamics, 1); }
static mps_status dynamics_run(scene *s) {
  return mps_dynamics_run(s->dynamics, mps_dynamics_time(s->dynamics) + 1e-3, 1, NULL, NULL);
}
static mps_status dynamics_refresh(scene *s) { return mps_dynamics_refresh(s->dynamics); }
static mps_status dynamics_restart(scene *s) { return mps_dynamics_restart(s->dynamics, 1.0); }
static mps_status dynamics_snapshot(scene *s) {
  return mps_dynamics_snapshot(s->dynamics, &s->snapshot);
}
static mps_status dynamics_rollback(scene *s) {
  return mps_dynamics_rollback(s->dynamics, s->snapshot);
}
static mps_status dynamics_save(scene *s) { return mps_dynamics_save(s->dynamics, file, NULL); }
static mps_status dynamics_restore(scene *s) {
  return mps_dynamics_restore(s->dynamics, file, NULL);
}
static mps_status dynamics_add_boundary(scene *s) {
  DEF(dynamics_boundary, def, .ids = some, .id_count = 3, .dofs = MPS_DOF_X);
  return mps_dynamics_add_boundary(s->dynamics, &def, NULL);
}
static mps_status dynamics_set_boundary(scene *s) {
  DEF(dynamics_boundary, def, .ids = some, .id_count = 3, .dofs = MPS_DOF_X);
  return mps_dynamics_set_boundary(s->dynamics, s->number, &def);
}
static mps_status dynamics_remove_boundary(scene *s) {
  return mps_dynamics_remove_boundary(s->dynamics, s->number);
}
LOADS(dynamics)
static mps_status dynamics_set_material(scene *s) {
  return mps_dynamics_set_material(s->dynamics, s->second, some, 2);
}
static mps_status dynamics_find_limit(scene *s) {
  mps_dynamics_linear_limit limit;
  return mps_dynamics_find_limit(s->dynamics, 0.0, &limit);
}
static mps_status dynamics_set_dt(scene *s) { return mps_dynamics_set_dt(s->dynamics, 1.0); }

/* ---- implicit elasticity --------------------------------------------------------------------- */

static void make_held_elastic(scene *s) {
  make_set(s, 0.1, 0.4);
  OK(create_elastic(s));
  DEF(elastic_boundary, foot, .lower[0] = foot.lower[1] = -1.0, .upper[0] = 9.0, .upper[1] = 0.1);
  OK(mps_elastic_add_boundary(s->elastic, &foot, &s->number));
  DEF(elastic_load, weight, .kind = MPS_ELASTIC_LOAD_BODY, .all = 1, .force[1] = -9.81);
  OK(mps_elastic_add_load(s->elastic, &weight, NULL));
}
static void make_solved_elastic(scene *s) {
  make_held_elastic(s);
  OK(mps_elastic_solve(s->elastic));
  OK(mps_particles_set(s->set, "external_force", 0, 1.0));
}
static void make_moving_elastic(scene *s) {
  make_held_elastic(s);
  USING(elastic_motion, mps_elastic_start(s->elastic, &given), .dt = 4e-3);
  OK(mps_elastic_step(s->elastic, 2));
  OK(mps_elastic_snapshot(s->elastic, &s->snapshot));
  OK(mps_elastic_save(s->elastic, file, NULL));
  OK(mps_elastic_step(s->elastic, 2));
}
/* Densities that no call has read yet. */
static void make_edited_elastic(scene *s) {
  make_moving_elastic(s);
  OK(mps_particles_set(s->set, "density", 0, 1000.0));
}
static mps_status elastic_start(scene *s) {
  DEF(elastic_motion, motion, .dt = 2e-3, .time = 1.0);
  return mps_elastic_start(s->elastic, &motion);
}
static mps_status elastic_step(scene *s) { return mps_elastic_step(s->elastic, 1); }
static mps_status elastic_run(scene *s) {
  return mps_elastic_run(s->elastic, mps_elastic_time(s->elastic) + 3e-3, 1, NULL, NULL);
}
static mps_status elastic_solve(scene *s) { return mps_elastic_solve(s->elastic); }
static mps_status elastic_solve_cases(scene *s) {
  double loads[2 * 32 * 3] = {1.0}, displacements[2 * 32 * 3];
  return mps_elastic_solve_cases(s->elastic, 2, loads, displacements);
}
static mps_status elastic_analyse(scene *s) {
  mps_elastic_estimate estimate;
  return mps_elastic_analyse(s->elastic, &estimate);
}
static mps_status elastic_stress(scene *s) { return mps_elastic_update_stress(s->elastic); }
static mps_status elastic_section(scene *s) {
  double force[3], moment[3];
  return mps_elastic_get_section(s->elastic, 1, 0.2, NULL, force, moment);
}
static mps_status elastic_totals(scene *s) {
  mps_totals totals;
  return mps_elastic_get_totals(s->elastic, &totals);
}
static mps_status elastic_resultant(scene *s) {
  double force[3];
  return mps_elastic_get_load_resultant(s->elastic, NULL, force, NULL);
}
static mps_status elastic_modes(scene *s) {
  double omega[2];
  return mps_elastic_modes(s->elastic, 2, omega, NULL);
}
static mps_status elastic_set_material(scene *s) {
  return mps_elastic_set_material(s->elastic, s->second, some, 2);
}
static mps_status elastic_cut(scene *s) {
  const int64_t edge = 7;
  return mps_elastic_cut(s->elastic, MPS_SIDE_X_UPPER, &edge, 1);
}
static mps_status elastic_add_boundary(scene *s) {
  DEF(elastic_boundary, def, .ids = some, .id_count = 3);
  return mps_elastic_add_boundary(s->elastic, &def, NULL);
}
static mps_status elastic_set_boundary(scene *s) {
  DEF(elastic_boundary, def, .ids = some, .id_count = 3);
  return mps_elastic_set_boundary(s->elastic, s->number, &def);
}
static mps_status elastic_add_load(scene *s) {
  DEF(elastic_load, def, .kind = MPS_ELASTIC_LOAD_FORCE, .ids = some, .id_count = 3);
  return mps_elastic_add_load(s->elastic, &def, NULL);
}
static mps_status elastic_set_load(scene *s) {
  DEF(elastic_load, def, .kind = MPS_ELASTIC_LOAD_FORCE, .ids = some, .id_count = 3);
  return mps_elastic_set_load(s->elastic, 0, &def);
}
static mps_status elastic_snapshot(scene *s) {
  return mps_elastic_snapshot(s->elastic, &s->snapshot);
}
static mps_status elastic_rollback(scene *s) {
  return mps_elastic_rollback(s->elastic, s->snapshot);
}
static mps_status elastic_save(scene *s) { return mps_elastic_save(s->elastic, file, NULL); }
static mps_status elastic_restore(scene *s) { return mps_elastic_restore(s->elastic, file, NULL); }

/* ---- the fluid ------------------------------------------------------------------------------- */

static void make_fluid(scene *s) {
  const double wall[3][4] = {{0, 0, 0, 1}, {0, 0, 1, 0}, {0.8, 0, -1, 0}};
  make_set(s, 0.05, 0.4);
  OK(create_fluid(s));
  DEF(material_newtonian, oil, .bulk_modulus = 1e6, .viscosity = 0.1);
  mps_material_destroy(&s->second); /* ground */
  OK(mps_material_create_newtonian(s->own, &oil, &s->second));
  for (int k = 0; k < 3; k++) {
    mps_fluid_boundary_def def = mps_fluid_boundary_defaults();
    def.kind = MPS_BOUNDARY_ROLLER; /* slip */
    for (int c = 0; c < 2; c++) def.point[c] = wall[k][c], def.normal[c] = wall[k][2 + c];
    OK(mps_fluid_add_boundary(s->fluid, &def, NULL));
  }
  DEF(body, place, .position[0] = 0.4, .position[1] = 0.8);
  OK(mps_body_create_box(s->own, &place, 0.3, 0.2, &s->other));
  DEF(fluid_load, load, .ids = some, .id_count = 2, .acceleration[0] = 0.1);
  OK(mps_fluid_add_load(s->fluid, &load, NULL));
  OK(mps_fluid_step(s->fluid, 3));
  OK(mps_fluid_snapshot(s->fluid, &s->snapshot));
  OK(mps_fluid_save(s->fluid, file, NULL));
  OK(mps_fluid_step(s->fluid, 2));
}
/* What the caller has put where is not known to lie at the surface. */
static void make_edited_fluid(scene *s) {
  make_fluid(s);
  OK(mps_particles_append(s->set, 2, nowhere));
}
/* A step in parts, as far as its pressure. */
static void make_open_fluid(scene *s) {
  make_fluid(s);
  OK(mps_fluid_begin_step(s->fluid, 1e-3));
  OK(mps_fluid_solve_pressure(s->fluid));
}
static mps_status fluid_step(scene *s) { return mps_fluid_step(s->fluid, 1); }
static mps_status fluid_run(scene *s) {
  return mps_fluid_run(s->fluid, mps_fluid_time(s->fluid) + 1e-3, 1, NULL, NULL);
}
static mps_status fluid_begin_step(scene *s) { return mps_fluid_begin_step(s->fluid, 1e-3); }
static mps_status fluid_add_boundary(scene *s) {
  mps_fluid_boundary_def def = mps_fluid_boundary_defaults();
  def.kind = MPS_BOUNDARY_ROLLER; /* slip */
  def.point[1] = -1.0, def.normal[1] = 1.0;
  return mps_fluid_add_boundary(s->fluid, &def, NULL);
}
static mps_status fluid_set_boundary(scene *s) {
  mps_fluid_boundary_def def = mps_fluid_boundary_defaults();
  def.kind = MPS_BOUNDARY_ROLLER; /* slip */
  def.point[0] = -0.1, def.normal[0] = 1.0;
  return mps_fluid_set_boundary(s->fluid, 1, &def);
}
LOADS(fluid)
static mps_status fluid_add_contact(scene *s) {
  return mps_fluid_add_contact(s->fluid, s->other, NULL, NULL);
}
static mps_status fluid_pressure(scene *s) {
  const double x[3] = {0.4, 0.0, 0.0};
  double pressure;
  return mps_fluid_get_pressure(s->fluid, 0, 1, x, &pressure);
}
static mps_status fluid_wall(scene *s) {
  int64_t count;
  return mps_fluid_get_boundary_points(s->fluid, 0, 0, &count, NULL, NULL);
}
static mps_status fluid_levels(scene *s) {
  const double station = 0.4;
  double level;
  return mps_fluid_get_levels(s->fluid, 1, &station, &level);
}
static mps_status fluid_snapshot(scene *s) { return mps_fluid_snapshot(s->fluid, &s->snapshot); }
static mps_status fluid_rollback(scene *s) { return mps_fluid_rollback(s->fluid, s->snapshot); }
static mps_status fluid_save(scene *s) { return mps_fluid_save(s->fluid, file, NULL); }
static mps_status fluid_restore(scene *s) { return mps_fluid_restore(s->fluid, file, NULL); }

/* ---- the sweep ------------------------------------------------------------------------------- */

typedef struct row {
  void (*make)(scene *s);
  mps_status (*call)(scene *s);
  const char *name;
  bool sorts; /* views may be stale afterwards: the header allows another order of the particles */
} row;

static mps_status everywhere(void *user, const double *x, int32_t *inside) {
  *inside = 1;
  return MPS_OK;
}

static mps_status fill_where(scene *s) {
  const double lo[2] = {0.0, 0.4}, hi[2] = {0.8, 0.8};
  return mps_particles_fill_where(s->set, lo, hi, everywhere, NULL, NULL);
}

/* What is taken away may need memory too: lists and matrices are rebuilt. */
static mps_status mpm_remove_boundary(scene *s) {
  return mps_mpm_remove_boundary(s->mpm, s->number);
}
static mps_status mpm_remove_load(scene *s) { return mps_mpm_remove_load(s->mpm, 0); }
static mps_status elastic_remove_boundary(scene *s) {
  return mps_elastic_remove_boundary(s->elastic, s->number);
}
static mps_status elastic_remove_load(scene *s) { return mps_elastic_remove_load(s->elastic, 0); }
static mps_status fluid_remove_boundary(scene *s) { return mps_fluid_remove_boundary(s->fluid, 1); }
static mps_status fluid_remove_load(scene *s) { return mps_fluid_remove_load(s->fluid, 0); }
static mps_status fluid_solve(scene *s) { return mps_fluid_solve_pressure(s->fluid); }
static mps_status fluid_end(scene *s) { return mps_fluid_end_step(s->fluid); }

static const row rows[] = {
    {make_bare, append, "mps_particles_append", false},
    {make_bare, fill_box, "mps_particles_fill_box", false},
    {make_bare, fill_ball, "mps_particles_fill_ball", false},
    {make_bare, fill_polygon, "mps_particles_fill_polygon", false},
    {make_bare, fill_where, "mps_particles_fill_where", false},
    {make_bare, remove_some, "mps_particles_remove", false},
    {make_bare, add_field, "mps_particles_add_field", false},
    {make_bare, set_field, "mps_particles_set", false},
    {make_bare, edit_velocity, "mps_particles_edit", false},
    {make_bare, set_array, "mps_particles_set_array", false},
    {make_bare, copy_set, "mps_particles_copy", false},
    {make_bare, set_geostatic, "mps_particles_set_geostatic", false},
    {make_bare, set_stress, "mps_particles_set_stress", false},
    {make_bare, set_table, "mps_particles_set_table", false},
    {make_ground, add_free_field, "mps_dynamics_add_free_field", false},
    {make_bare, create_mpm, "mps_mpm_create", false},
    {make_bare, create_dynamics, "mps_dynamics_create", false},
    {make_bare, create_elastic, "mps_elastic_create", false},
    {make_bare, create_fluid, "mps_fluid_create", false},
    {make_mpm, append, "mps_particles_append", false},
    {make_mpm, fill_box, "mps_particles_fill_box", false},
    {make_mpm, remove_some, "mps_particles_remove", false},
    {make_mpm, set_field, "mps_particles_set", false},
    {make_mpm, set_array, "mps_particles_set_array", false},
    {make_mpm, mpm_step, "mps_mpm_step", true},
    {make_mpm, mpm_run, "mps_mpm_run", true},
    {make_mpm, mpm_settle, "mps_mpm_settle", true},
    {make_mpm, mpm_snapshot, "mps_mpm_snapshot", true},
    {make_mpm, mpm_rollback, "mps_mpm_rollback", false},
    {make_mpm, mpm_save, "mps_mpm_save", true},
    {make_mpm, mpm_restore, "mps_mpm_restore", false},
    {make_edited_mpm, mpm_step, "mps_mpm_step", true},
    {make_edited_mpm, mpm_settle, "mps_mpm_settle", true},
    {make_edited_mpm, mpm_snapshot, "mps_mpm_snapshot", true},
    {make_edited_mpm, mpm_save, "mps_mpm_save", true},
    {make_edited_mpm, mpm_rollback, "mps_mpm_rollback", false},
    {make_edited_mpm, mpm_restore, "mps_mpm_restore", false},
    {make_edited_mpm, mpm_run, "mps_mpm_run", true},
    {make_edited_mpm, mpm_add_boundary, "mps_mpm_add_boundary", false},
    {make_edited_mpm, mpm_set_side, "mps_mpm_set_boundary", false},
    {make_edited_mpm, mpm_set_material, "mps_mpm_set_material", false},
    {make_edited_mpm, mpm_totals, "mps_mpm_get_totals", true},
    {make_edited_mpm, grid_nodes, "mps_grid_get_nodes", true},
    {make_edited_mpm, grid_evaluate, "mps_grid_evaluate", true},
    {make_edited_mpm, append, "mps_particles_append", false},
    {make_edited_mpm, remove_some, "mps_particles_remove", false},
    {make_mpm, mpm_add_boundary, "mps_mpm_add_boundary", false},
    {make_mpm, mpm_set_boundary, "mps_mpm_set_boundary", false},
    {make_mpm, mpm_set_side, "mps_mpm_set_boundary", false},
    {make_mpm, mpm_add_load, "mps_mpm_add_load", false},
    {make_mpm, mpm_set_load, "mps_mpm_set_load", false},
    {make_mpm, mpm_remove_boundary, "mps_mpm_remove_boundary", false},
    {make_mpm, mpm_remove_load, "mps_mpm_remove_load", false},
    {make_mpm, mpm_add_contact, "mps_mpm_add_contact", false},
    {make_mpm, mpm_set_material, "mps_mpm_set_material", false},
    {make_mpm, fields_of_material, "mps_particles_set_material", false},
    {make_mpm, mpm_totals, "mps_mpm_get_totals", true},
    {make_mpm, grid_nodes, "mps_grid_get_nodes", true},
    {make_mpm, grid_evaluate, "mps_grid_evaluate", true},
    {make_mpm, contact_particles, "mps_contact_get_particles", false},
    {make_hard_ground, create_dynamics, "mps_dynamics_create", false},
    {make_dug, remove_some, "mps_particles_remove", false},
    {make_dug, dynamics_rollback, "mps_dynamics_rollback", false},
    {make_dynamics, dynamics_step, "mps_dynamics_step", false},
    {make_dynamics, dynamics_run, "mps_dynamics_run", false},
    {make_dynamics, dynamics_refresh, "mps_dynamics_refresh", false},
    {make_dynamics, dynamics_restart, "mps_dynamics_restart", false},
    {make_dynamics, dynamics_snapshot, "mps_dynamics_snapshot", false},
    {make_dynamics, dynamics_rollback, "mps_dynamics_rollback", false},
    {make_dynamics, dynamics_save, "mps_dynamics_save", false},
    {make_dynamics, dynamics_restore, "mps_dynamics_restore", false},
    {make_dynamics, dynamics_add_boundary, "mps_dynamics_add_boundary", false},
    {make_dynamics, dynamics_set_boundary, "mps_dynamics_set_boundary", false},
    {make_dynamics, dynamics_remove_boundary, "mps_dynamics_remove_boundary", false},
    {make_dynamics, dynamics_add_load, "mps_dynamics_add_load", false},
    {make_dynamics, dynamics_set_load, "mps_dynamics_set_load", false},
    {make_dynamics, dynamics_set_material, "mps_dynamics_set_material", false},
    {make_dynamics, fields_of_material, "mps_particles_set_material", false},
    {make_dynamics, dynamics_find_limit, "mps_dynamics_find_limit", false},
    {make_dynamics, dynamics_set_dt, "mps_dynamics_set_dt", false},
    {make_dynamics, remove_some, "mps_particles_remove", false},
    {make_dynamics, set_field, "mps_particles_set", false},
    {make_held_elastic, elastic_solve, "mps_elastic_solve", false},
    {make_held_elastic, elastic_analyse, "mps_elastic_analyse", false},
    {make_held_elastic, elastic_start, "mps_elastic_start", false},
    {make_held_elastic, elastic_modes, "mps_elastic_modes", false},
    {make_solved_elastic, elastic_solve, "mps_elastic_solve", false},
    {make_solved_elastic, elastic_solve_cases, "mps_elastic_solve_cases", false},
    {make_solved_elastic, elastic_stress, "mps_elastic_update_stress", false},
    {make_solved_elastic, elastic_section, "mps_elastic_get_section", false},
    {make_solved_elastic, elastic_totals, "mps_elastic_get_totals", false},
    {make_solved_elastic, elastic_resultant, "mps_elastic_get_load_resultant", false},
    {make_solved_elastic, elastic_start, "mps_elastic_start", false},
    {make_solved_elastic, elastic_set_material, "mps_elastic_set_material", false},
    {make_solved_elastic, elastic_cut, "mps_elastic_cut", false},
    {make_solved_elastic, elastic_add_boundary, "mps_elastic_add_boundary", false},
    {make_solved_elastic, elastic_set_boundary, "mps_elastic_set_boundary", false},
    {make_solved_elastic, elastic_add_load, "mps_elastic_add_load", false},
    {make_solved_elastic, elastic_set_load, "mps_elastic_set_load", false},
    {make_solved_elastic, elastic_remove_boundary, "mps_elastic_remove_boundary", false},
    {make_solved_elastic, elastic_remove_load, "mps_elastic_remove_load", false},
    {make_moving_elastic, elastic_remove_boundary, "mps_elastic_remove_boundary", false},
    {make_solved_elastic, remove_some, "mps_particles_remove", false},
    {make_moving_elastic, elastic_start, "mps_elastic_start", false},
    {make_edited_elastic, elastic_start, "mps_elastic_start", false},
    {make_edited_elastic, elastic_modes, "mps_elastic_modes", false},
    {make_edited_elastic, elastic_solve, "mps_elastic_solve", false},
    {make_edited_elastic, elastic_resultant, "mps_elastic_get_load_resultant", false},
    {make_moving_elastic, elastic_step, "mps_elastic_step", false},
    {make_moving_elastic, elastic_run, "mps_elastic_run", false},
    {make_moving_elastic, elastic_solve, "mps_elastic_solve", false},
    {make_moving_elastic, elastic_set_material, "mps_elastic_set_material", false},
    {make_moving_elastic, elastic_set_boundary, "mps_elastic_set_boundary", false},
    {make_moving_elastic, elastic_snapshot, "mps_elastic_snapshot", false},
    {make_moving_elastic, elastic_rollback, "mps_elastic_rollback", false},
    {make_moving_elastic, elastic_save, "mps_elastic_save", false},
    {make_moving_elastic, elastic_restore, "mps_elastic_restore", false},
    {make_moving_elastic, remove_some, "mps_particles_remove", false},
    {make_fluid, fluid_step, "mps_fluid_step", true},
    {make_fluid, fluid_run, "mps_fluid_run", true},
    {make_fluid, fluid_begin_step, "mps_fluid_begin_step", true},
    {make_fluid, fluid_add_boundary, "mps_fluid_add_boundary", false},
    {make_fluid, fluid_set_boundary, "mps_fluid_set_boundary", false},
    {make_fluid, fluid_add_load, "mps_fluid_add_load", false},
    {make_fluid, fluid_set_load, "mps_fluid_set_load", false},
    {make_fluid, fluid_remove_boundary, "mps_fluid_remove_boundary", false},
    {make_fluid, fluid_remove_load, "mps_fluid_remove_load", false},
    {make_open_fluid, fluid_solve, "mps_fluid_solve_pressure", false},
    {make_open_fluid, fluid_end, "mps_fluid_end_step", true},
    {make_fluid, fluid_add_contact, "mps_fluid_add_contact", false},
    {make_fluid, fluid_pressure, "mps_fluid_get_pressure", true},
    {make_fluid, fluid_wall, "mps_fluid_get_boundary_points", true},
    {make_edited_fluid, fluid_pressure, "mps_fluid_get_pressure", false},
    {make_edited_fluid, fluid_wall, "mps_fluid_get_boundary_points", false},
    {make_edited_fluid, fluid_levels, "mps_fluid_get_levels", false},
    {make_open_fluid, fluid_pressure, "mps_fluid_get_pressure", false},
    {make_fluid, fluid_levels, "mps_fluid_get_levels", true},
    {make_fluid, fluid_snapshot, "mps_fluid_snapshot", true},
    {make_fluid, fluid_rollback, "mps_fluid_rollback", false},
    {make_fluid, fluid_save, "mps_fluid_save", true},
    {make_fluid, fluid_restore, "mps_fluid_restore", false},
    {make_fluid, append, "mps_particles_append", false},
    {make_fluid, remove_some, "mps_particles_remove", false},
};

static uint64_t seen(scene *s, bool sorts) {
  const int64_t refuse = s->memory.refuse_at;
  uint64_t hash;
  s->memory.refuse_at = 0;
  if (s->mpm)
    hash = seen_mpm(s->mpm, sorts);
  else if (s->dynamics)
    hash = seen_dynamics(s->dynamics, sorts);
  else if (s->elastic)
    hash = seen_elastic(s->elastic, sorts);
  else if (s->fluid)
    hash = seen_fluid(s->fluid, sorts);
  else
    hash = seen_set(s->set);
  if (s->body) hash = hash * 31 + seen_body(s->body);
  s->memory.refuse_at = refuse;
  return hash;
}

static void end(scene *s) {
  mps_snapshot_destroy(&s->snapshot);
  mps_contact_destroy(&s->contact);
  mps_mpm_destroy(&s->mpm);
  mps_dynamics_destroy(&s->dynamics);
  mps_elastic_destroy(&s->elastic);
  mps_fluid_destroy(&s->fluid);
  mps_body_destroy(&s->body);
  mps_body_destroy(&s->other);
  mps_particles_destroy(&s->nodes);
  mps_particles_destroy(&s->set);
  mps_material_destroy(&s->material);
  mps_material_destroy(&s->second);
  mps_context_destroy(&s->own);
  assert_int_equal(s->memory.live, 0);
}

/* What is wrong with the refusal of allocation number `at`; NULL: nothing. */
static const char *complaint(scene *s, const row *r, mps_status status, uint64_t before) {
  static char text[600];
  const mps_error error = *mps_context_error(s->own);
  if (status != MPS_ERROR_MEMORY || error.status != MPS_ERROR_MEMORY)
    (void)snprintf(text, sizeof text, "status %d, %s", (int)status, error.message);
  else if (strcmp(error.function, r->name) != 0)
    (void)snprintf(text, sizeof text, "the record names %s", error.function);
  else if (seen(s, r->sorts) != before)
    (void)snprintf(text, sizeof text, "something has changed");
  else
    return NULL;
  return text;
}

/* Refuses one allocation of the call after the other until it needs no more. What it does then is
 * what it does without a refusal. Returns how often something was wrong. */
static int sweep(const row *r, const char *scene_of) {
  scene made = {.own = NULL}, calm = {.own = NULL}, *s = &made;
  int wrong = 0;
  calm.own = test_allocator_context(&calm.memory);
  s->own = test_allocator_context(&s->memory);
  r->make(&calm);
  r->make(s);
  (void)seen(s, r->sorts), (void)seen(&calm, r->sorts); /* totals find some values anew */
  for (int64_t at = 1;; at++) {
    const uint64_t before = seen(s, r->sorts);
    const int64_t refuse = s->memory.refuse_at = s->memory.calls + at;
    const mps_status status = r->call(s);
    const bool refused = s->memory.calls >= refuse;
    s->memory.refuse_at = 0;
    if (!refused) {
      OK(status);
      break;
    }
    const char *text = complaint(s, r, status, before);
    if (text)
      print_message("%s %s, allocation %d: %s\n", scene_of, r->name, (int)at, text), wrong++;
    if (status == MPS_OK) break;
    assert_true(at < 2000);
  }
  OK(r->call(&calm));
  if (wrong == 0 && seen(s, true) != seen(&calm, true)) {
    print_message("%s %s: another result after refusals\n", scene_of, r->name);
    wrong++;
  }
  end(s);
  end(&calm);
  return wrong;
}

TEST(refused_memory_changes_nothing) {
  int wrong = 0;
  for (size_t k = 0; k < sizeof rows / sizeof *rows; k++) {
    char number[24];
    (void)snprintf(number, sizeof number, "row %d", (int)k);
    wrong += sweep(&rows[k], number);
  }
  (void)remove(file);
  assert_int_equal(wrong, 0);
}
