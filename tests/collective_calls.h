/* collective_calls.h - the collective functions of the library in a table, for tests in which ranks
 * call different ones: a solver of each kind on one domain, and a call of each function.
 * mps_fluid_set_boundary_motion is not among them: what it is given is compared by the step.
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef MPS_TEST_COLLECTIVE_CALLS_H
#define MPS_TEST_COLLECTIVE_CALLS_H

#include "ranks_result.h"

/* What a rank calls functions of: a solver of each kind on one domain. */
typedef struct subject {
  mps_context *own;
  mps_domain *domain;
  mps_material *material;
  mps_body *body;
  mps_particles *soil, *water, *ground, *plate;
  mps_mpm *mpm;
  mps_fluid *fluid;
  mps_dynamics *dynamics;
  mps_elastic *elastic;
  mps_snapshot *then[4];
  mps_snapshot *fresh; /* of the call under way */
} subject;

static const double above[2] = {0.11, 0.9}, low[2] = {0.0, 0.0}, high[2] = {0.3, 0.3};
static const int64_t ids[2] = {3, 11};
static const char nowhere[] = "/dev/null/checkpoint.h5";

/* ---- calls ----------------------------------------------------------------------------------- */

/* Where a call puts a new snapshot; that of an earlier one has been freed. */
static inline mps_snapshot **fresh(subject *s) {
  mps_snapshot_destroy(&s->fresh);
  return &s->fresh;
}

#define CALL(name, expression)                                                                     \
  static inline mps_status call_##name(subject *s) { return expression; }

CALL(domain_agree, mps_domain_agree(s->domain, MPS_OK))
CALL(domain_max, mps_domain_max(s->domain, 1, &(double){1.0}))
CALL(domain_gather_fields,
     mps_domain_gather_fields(s->domain, s->soil, 1, &(const char *){"velocity"},
                              &(mps_particles *){NULL}))
CALL(domain_get_field,
     mps_domain_get_field(s->domain, s->soil, "density", ids, 2, (double[2]){0.0}))
CALL(particles_append, mps_particles_append(s->soil, 1, above))
CALL(particles_fill_box, mps_particles_fill_box(s->soil, low, high, NULL))
CALL(particles_remove, mps_particles_remove(s->soil, ids, 2))

CALL(mpm_step, mps_mpm_step(s->mpm, 1))
CALL(mpm_run, mps_mpm_run(s->mpm, mps_mpm_time(s->mpm) + 1e-3, 5, NULL, NULL))
CALL(mpm_set_dt, mps_mpm_set_dt(s->mpm, 1e-5))
CALL(mpm_get_totals, mps_mpm_get_totals(s->mpm, &(mps_totals){.mass = 0.0}))
CALL(mpm_get_energy_report, mps_mpm_get_energy_report(s->mpm, &(mps_mpm_energy_report){0}))
CALL(mpm_get_reaction, mps_mpm_get_reaction(s->mpm, MPS_SIDE_Y_LOWER, &(mps_reaction){0}))
CALL(mpm_set_side, mps_mpm_set_side(s->mpm, MPS_SIDE_X_UPPER, MPS_BOUNDARY_HELD, 0.0))
CALL(mpm_set_boundary,
     mps_mpm_set_boundary(s->mpm, MPS_SIDE_X_LOWER, &(mps_mpm_boundary_def){.struct_size = 0}))
CALL(mpm_add_boundary, mps_mpm_add_boundary(s->mpm, NULL, NULL))
CALL(mpm_remove_boundary, mps_mpm_remove_boundary(s->mpm, MPS_SIDE_Y_LOWER))
CALL(mpm_add_load, mps_mpm_add_load(s->mpm, NULL, NULL))
CALL(mpm_set_load, mps_mpm_set_load(s->mpm, 0, NULL))
CALL(mpm_remove_load, mps_mpm_remove_load(s->mpm, 0))
CALL(mpm_add_contact, mps_mpm_add_contact(s->mpm, s->body, NULL, NULL))
CALL(mpm_set_material, mps_mpm_set_material(s->mpm, s->material, ids, 2))
CALL(mpm_snapshot, mps_mpm_snapshot(s->mpm, fresh(s)))
CALL(mpm_rollback, mps_mpm_rollback(s->mpm, s->then[0]))
CALL(mpm_save, mps_mpm_save(s->mpm, nowhere, NULL))
CALL(mpm_restore, mps_mpm_restore(s->mpm, nowhere, NULL))
CALL(mpm_settle, mps_mpm_settle(s->mpm, NULL, &(mps_mpm_settled){0}))
CALL(mpm_add_pore_water, mps_mpm_add_pore_water(s->mpm, NULL))
CALL(mpm_set_pore_level, mps_mpm_set_pore_level(s->mpm, low))
CALL(mpm_add_pore_face, mps_mpm_add_pore_face(s->mpm, NULL, NULL))
CALL(mpm_set_pore_face, mps_mpm_set_pore_face(s->mpm, 0, NULL))
CALL(solver_set_linear_solver,
     mps_solver_set_linear_solver(mps_mpm_solver(s->mpm), MPS_LINEAR_EQUATION_PORE_PRESSURE, NULL))
CALL(mpm_get_pore_flow, mps_mpm_get_pore_flow(s->mpm, -1, NULL, NULL))
CALL(mpm_get_pore_budget, mps_mpm_get_pore_budget(s->mpm, &(mps_pore_budget){0}))
CALL(grid_get_nodes,
     mps_grid_get_nodes(mps_mpm_grid(s->mpm), 0, &(int64_t){0}, NULL, NULL, NULL, NULL))
CALL(grid_evaluate,
     mps_grid_evaluate(mps_mpm_grid(s->mpm), "velocity", 0, 1, high, (double[3]){0.0}, NULL))

CALL(fluid_step, mps_fluid_step(s->fluid, 1))
CALL(fluid_run, mps_fluid_run(s->fluid, mps_fluid_time(s->fluid) + 1e-3, 5, NULL, NULL))
CALL(fluid_set_dt, mps_fluid_set_dt(s->fluid, 1e-4))
CALL(fluid_begin_step, mps_fluid_begin_step(s->fluid, 1e-4))
CALL(fluid_snapshot, mps_fluid_snapshot(s->fluid, fresh(s)))
CALL(fluid_rollback, mps_fluid_rollback(s->fluid, s->then[1]))
CALL(fluid_save, mps_fluid_save(s->fluid, nowhere, NULL))
CALL(fluid_restore, mps_fluid_restore(s->fluid, nowhere, NULL))
CALL(fluid_add_boundary, mps_fluid_add_boundary(s->fluid, NULL, NULL))
CALL(fluid_remove_boundary, mps_fluid_remove_boundary(s->fluid, 0))
CALL(fluid_add_load, mps_fluid_add_load(s->fluid, NULL, NULL))

CALL(dynamics_step, mps_dynamics_step(s->dynamics, 1))
CALL(dynamics_run,
     mps_dynamics_run(s->dynamics, mps_dynamics_time(s->dynamics) + 1e-3, 5, NULL, NULL))
CALL(dynamics_refresh, mps_dynamics_refresh(s->dynamics))
CALL(dynamics_restart, mps_dynamics_restart(s->dynamics, 0.0))
CALL(dynamics_set_dt, mps_dynamics_set_dt(s->dynamics, 1e-5))
CALL(dynamics_find_limit,
     mps_dynamics_find_limit(s->dynamics, 1.0, &(mps_dynamics_linear_limit){0}))
CALL(dynamics_get_totals, mps_dynamics_get_totals(s->dynamics, &(mps_totals){.mass = 0.0}))
CALL(dynamics_get_reaction, mps_dynamics_get_reaction(s->dynamics, 0, &(mps_reaction){0}))
CALL(dynamics_add_boundary, mps_dynamics_add_boundary(s->dynamics, NULL, NULL))
CALL(dynamics_set_boundary, mps_dynamics_set_boundary(s->dynamics, 0, NULL))
CALL(dynamics_remove_boundary, mps_dynamics_remove_boundary(s->dynamics, 0))
CALL(dynamics_add_load, mps_dynamics_add_load(s->dynamics, NULL, NULL))
CALL(dynamics_set_load, mps_dynamics_set_load(s->dynamics, 0, NULL))
CALL(dynamics_remove_load, mps_dynamics_remove_load(s->dynamics, 0))
CALL(dynamics_set_material, mps_dynamics_set_material(s->dynamics, s->material, ids, 2))
CALL(dynamics_snapshot, mps_dynamics_snapshot(s->dynamics, fresh(s)))
CALL(dynamics_rollback, mps_dynamics_rollback(s->dynamics, s->then[2]))
CALL(dynamics_save, mps_dynamics_save(s->dynamics, nowhere, NULL))
CALL(dynamics_restore, mps_dynamics_restore(s->dynamics, nowhere, NULL))

CALL(elastic_solve, mps_elastic_solve(s->elastic))
CALL(elastic_stress, mps_elastic_update_stress(s->elastic))
CALL(elastic_section, mps_elastic_get_section(s->elastic, 0, 0.2, NULL, (double[3]){0.0}, NULL))
CALL(elastic_start, mps_elastic_start(s->elastic, NULL))
CALL(elastic_step, mps_elastic_step(s->elastic, 1))
CALL(elastic_run, mps_elastic_run(s->elastic, 1.0, 5, NULL, NULL))
CALL(elastic_load_resultant,
     mps_elastic_get_load_resultant(s->elastic, NULL, (double[3]){0.0}, NULL))
CALL(elastic_add_boundary, mps_elastic_add_boundary(s->elastic, NULL, NULL))
CALL(elastic_remove_boundary, mps_elastic_remove_boundary(s->elastic, 0))
CALL(elastic_add_load, mps_elastic_add_load(s->elastic, NULL, NULL))
CALL(elastic_remove_load, mps_elastic_remove_load(s->elastic, 0))
CALL(fluid_get_levels, mps_fluid_get_levels(s->fluid, 1, high, (double[1]){0.0}))
CALL(fluid_get_pressure, mps_fluid_get_pressure(s->fluid, 0, 1, high, (double[1]){0.0}))
CALL(fluid_get_body_pressure,
     mps_fluid_get_body_pressure(s->fluid, NULL, 1, high, (double[1]){0.0}))
CALL(fluid_set_boundary, mps_fluid_set_boundary(s->fluid, 0, NULL))
CALL(fluid_set_load, mps_fluid_set_load(s->fluid, 0, NULL))
CALL(fluid_remove_load, mps_fluid_remove_load(s->fluid, 0))
CALL(fluid_add_contact, mps_fluid_add_contact(s->fluid, s->body, NULL, NULL))
CALL(elastic_set_boundary, mps_elastic_set_boundary(s->elastic, 0, NULL))
CALL(elastic_set_load, mps_elastic_set_load(s->elastic, 0, NULL))
CALL(elastic_set_dt, mps_elastic_set_dt(s->elastic, 0.1))
CALL(elastic_set_material, mps_elastic_set_material(s->elastic, s->material, ids, 2))
CALL(elastic_snapshot, mps_elastic_snapshot(s->elastic, fresh(s)))
CALL(elastic_save, mps_elastic_save(s->elastic, nowhere, NULL))
CALL(elastic_restore, mps_elastic_restore(s->elastic, nowhere, NULL))
CALL(elastic_analyse, mps_elastic_analyse(s->elastic, &(mps_elastic_estimate){0}))
CALL(elastic_modes, mps_elastic_modes(s->elastic, 1, (double[1]){0.0}, NULL))
CALL(elastic_solve_cases, mps_elastic_solve_cases(s->elastic, 0, NULL, NULL))
CALL(elastic_cut, mps_elastic_cut(s->elastic, MPS_SIDE_X_LOWER, ids, 2))

#define ROW(name)                                                                                  \
  { "mps_" #name, call_##name }
static const struct {
  const char *name;
  mps_status (*call)(subject *s);
} table[] = {
    ROW(domain_agree),
    ROW(domain_max),
    ROW(domain_gather_fields),
    ROW(domain_get_field),
    ROW(particles_append),
    ROW(particles_fill_box),
    ROW(particles_remove),
    ROW(mpm_step),
    ROW(mpm_run),
    ROW(mpm_set_dt),
    ROW(mpm_get_totals),
    ROW(mpm_get_energy_report),
    ROW(mpm_get_reaction),
    ROW(mpm_set_side),
    ROW(mpm_set_boundary),
    ROW(mpm_add_boundary),
    ROW(mpm_remove_boundary),
    ROW(mpm_add_load),
    ROW(mpm_set_load),
    ROW(mpm_remove_load),
    ROW(mpm_add_contact),
    ROW(mpm_set_material),
    ROW(mpm_snapshot),
    ROW(mpm_rollback),
    ROW(mpm_save),
    ROW(mpm_restore),
    ROW(mpm_settle),
    ROW(mpm_add_pore_water),
    ROW(mpm_set_pore_level),
    ROW(mpm_add_pore_face),
    ROW(mpm_set_pore_face),
    ROW(solver_set_linear_solver),
    ROW(mpm_get_pore_flow),
    ROW(mpm_get_pore_budget),
    ROW(grid_get_nodes),
    ROW(grid_evaluate),
    ROW(fluid_step),
    ROW(fluid_run),
    ROW(fluid_set_dt),
    ROW(fluid_begin_step),
    ROW(fluid_snapshot),
    ROW(fluid_rollback),
    ROW(fluid_save),
    ROW(fluid_restore),
    ROW(fluid_add_boundary),
    ROW(fluid_remove_boundary),
    ROW(fluid_add_load),
    ROW(dynamics_step),
    ROW(dynamics_run),
    ROW(dynamics_refresh),
    ROW(dynamics_restart),
    ROW(dynamics_set_dt),
    ROW(dynamics_find_limit),
    ROW(dynamics_get_totals),
    ROW(dynamics_get_reaction),
    ROW(dynamics_add_boundary),
    ROW(dynamics_set_boundary),
    ROW(dynamics_remove_boundary),
    ROW(dynamics_add_load),
    ROW(dynamics_set_load),
    ROW(dynamics_remove_load),
    ROW(dynamics_set_material),
    ROW(dynamics_snapshot),
    ROW(dynamics_rollback),
    ROW(dynamics_save),
    ROW(dynamics_restore),
    ROW(elastic_solve),
    ROW(elastic_stress),
    ROW(elastic_section),
    ROW(elastic_start),
    ROW(elastic_step),
    ROW(elastic_run),
    ROW(elastic_load_resultant),
    ROW(elastic_add_boundary),
    ROW(elastic_remove_boundary),
    ROW(elastic_add_load),
    ROW(elastic_remove_load),
    ROW(elastic_cut),
    ROW(fluid_get_levels),
    ROW(fluid_get_pressure),
    ROW(fluid_get_body_pressure),
    ROW(fluid_set_boundary),
    ROW(fluid_set_load),
    ROW(fluid_remove_load),
    ROW(fluid_add_contact),

    ROW(elastic_set_boundary),
    ROW(elastic_set_load),
    ROW(elastic_set_dt),
    ROW(elastic_set_material),
    ROW(elastic_snapshot),
    ROW(elastic_save),
    ROW(elastic_restore),
    ROW(elastic_analyse),
    ROW(elastic_modes),
    ROW(elastic_solve_cases),
};
enum { CALLS = sizeof table / sizeof *table };

/* ---- ranks ----------------------------------------------------------------------------------- */

static inline mps_status fill(subject *s, mps_particles **out, double spacing, double width) {
  DEF(particles, def, .spacing = spacing);
  const double hi[2] = {width, 0.4};
  mps_status status = mps_particles_create(s->own, &def, out);
  TRY(mps_particles_fill_box(*out, low, hi, NULL));
  TRY(mps_particles_set(*out, "density", 0, 1000.0));
  return status;
}

static inline mps_status make_mpm_and_fluid(subject *s) {
  mps_fluid_def water = mps_fluid_defaults();
  DEF(body, body, .position[0] = 0.2, .position[1] = 2.0);
  DEF(mpm, def, .domain = water.domain = s->domain, .cell = 0.08, .lower[0] = def.lower[1] = 0.0,
      .budget = 1);
  mps_status status = fill(s, &s->soil, 0.04, 0.8);
  TRY(mps_mpm_create(s->own, s->soil, s->material, &def, &s->mpm));
  TRY(mps_mpm_snapshot(s->mpm, &s->then[0]));
  TRY(mps_body_create_disc(s->own, &body, 0.1, &s->body));
  TRY(fill(s, &s->water, 0.04, 0.4));
  TRY(mps_fluid_create(s->own, s->water, &water, &s->fluid));
  TRY(mps_fluid_snapshot(s->fluid, &s->then[1]));
  return status;
}

static inline mps_status make_solvers(subject *s) {
  mps_elastic_def body = mps_elastic_defaults();
  mps_status status = mps_material_create_linear_elastic(s->own, 1e6, 0.3, &s->material);
  TRY(make_mpm_and_fluid(s));
  DEF(dynamics, def, .domain = body.domain = s->domain, .material = body.material = s->material);
  TRY(fill(s, &s->ground, 0.01, 0.4));
  TRY(mps_dynamics_create(s->own, s->ground, &def, &s->dynamics));
  TRY(mps_dynamics_snapshot(s->dynamics, &s->then[2]));
  TRY(fill(s, &s->plate, 0.1, 0.8));
  TRY(mps_elastic_create(s->own, s->plate, &body, &s->elastic));
  DEF(elastic_boundary, held, .lower[0] = held.lower[1] = -1.0, .upper[0] = 0.1, .upper[1] = 1.0);
  TRY(mps_elastic_add_boundary(s->elastic, &held, NULL));
  return status;
}

static inline void forget(subject *s) {
  for (int k = 0; k < 4; k++) mps_snapshot_destroy(&s->then[k]);
  mps_snapshot_destroy(&s->fresh);
  mps_mpm_destroy(&s->mpm);
  mps_fluid_destroy(&s->fluid);
  mps_dynamics_destroy(&s->dynamics);
  mps_elastic_destroy(&s->elastic);
  mps_particles *sets[4] = {s->soil, s->water, s->ground, s->plate};
  for (int k = 0; k < 4; k++) mps_particles_destroy(&sets[k]);
  mps_body_destroy(&s->body);
  mps_material_destroy(&s->material);
}

/* One is another name for the other: what they are given is compared. */
static inline bool are_same(int a, int b) {
  static const char *const same[][2] = {{"mps_mpm_set_side", "mps_mpm_set_boundary"}};
  for (size_t k = 0; k < sizeof same / sizeof *same; k++)
    if ((strcmp(table[a].name, same[k][0]) == 0 && strcmp(table[b].name, same[k][1]) == 0) ||
        (strcmp(table[a].name, same[k][1]) == 0 && strcmp(table[b].name, same[k][0]) == 0))
      return true;
  return a == b;
}

/* Rank 0 calls function a and the others b: MPS_OK where all have the error that says so and
 * continue together. `why` receives what this rank has got. */
static inline mps_status call_beside(subject *s, int a, int b, char why[512]) {
  const bool first = mps_domain_rank(s->domain) == 0;
  const mps_status own = table[first ? a : b].call(s);
  const mps_error *error = mps_context_error(s->own);
  const bool told = own == MPS_ERROR_STATE &&
                    strstr(error->message, "all ranks must call the same functions") != NULL;
  snprintf(why, 512, "%s beside %s: status %d, %.400s", table[a].name, table[b].name, (int)own,
           error->message);
  return mps_domain_agree(s->domain, told ? MPS_OK : MPS_ERROR_INTERNAL);
}

#endif
