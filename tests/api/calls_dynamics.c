/* calls_dynamics.c - explicit elastodynamics.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "calls_solver.h"

#include <mps/experimental/papers.h>
#include <mps/mps.h>
#include <mps/experimental/dynamics_predict.h>

#include <float.h>

/* The step that a run would take, as far as it is known. */
static double step_of(const mps_dynamics *dynamics) {
  mps_dynamics_def def;
  if (mps_dynamics_get_def(dynamics, &def) == MPS_OK && def.dt > 0.0) return def.dt;
  return mps_dynamics_limit(dynamics);
}

/* Where dt is not yet chosen, totals would choose it. */
static bool has_step(const mps_dynamics *dynamics) {
  mps_dynamics_def def;
  return mps_dynamics_get_def(dynamics, &def) == MPS_OK && def.dt > 0.0;
}

#define SOLVER_DEF MPS_DEF_DYNAMICS
#define SOLVER_BOUNDARY MPS_DEF_DYNAMICS_BOUNDARY
#define SOLVER_LOAD MPS_DEF_DYNAMICS_LOAD
#define SOLVER_GRAVITY(s, account) (void)(account);
#define SOLVER_MOMENTUM true
#define SOLVER_COUNTS(s) has_step(s)
#define SOLVER_DT(s) step_of(s)
API_SOLVER(dynamics, API_DYNAMICS)

static void dynamics_create(api *a) {
  mps_dynamics *made = NULL;
  mps_context *context = api_context(a);
  mps_particles *set = api_any(a, API_SET)->handle;
  mps_dynamics_def def = mps_dynamics_defaults();
  def.struct_size = api_struct_size(a, sizeof def);
  def.integrator = api_choice(a, "integrator", 3);
  def.rotation = api_choice(a, "rotation", 2);
  def.damping = api_choice(a, "damping", 2);
  def.watch_damping = (int32_t)api_below(a, 2);
  const bool euler = def.integrator == MPS_DYNAMICS_INTEGRATOR_EULER;
  if (euler || api_chance(a, 20)) def.dt = api_real(a, "dt", 1e-12, 1e9, 1e-4);
  if (isnan(def.dt)) a->wrong = 0;
  def.courant = api_real(a, "courant", 5e-324, 1.0, 0.5);
  def.radius_ratio = api_real(a, "radius_ratio", nextafter(1.0, 2.0), 4.0, 1.5);
  def.f1 = api_real(a, "f1", 1e-20, 1e9, 1.0);
  def.f2 = api_real(a, "f2", 1e-20, 1e9, 14.0);
  def.period_x =
      !a->latest && api_chance(a, 10) ? api_real(a, "period_x", 5e-324, 1e300, 0.6) : NAN;
  if (a->wrong && isnan(def.period_x) && strcmp(a->wrong_name, "period_x") == 0) a->wrong--;
  def.divergence = api_real(a, "divergence", 5e-324, DBL_MAX, NAN);
  def.measure = api_real(a, "measure", 1e-9, 1e9, 1.0);
  if (api_chance(a, 20)) def.material = api_maybe(a, API_MATERIAL, "material");
  if (!a->latest && api_chance(a, 10)) def.kernel = api_maybe(a, API_KERNEL, "kernel");
  if (def.kernel && a->wrong && strcmp(a->wrong_name, "radius_ratio") == 0) a->wrong = 0;
  const mps_status status =
      mps_dynamics_create(context, set, a->wrong == 0 && api_chance(a, 5) ? NULL : &def,
                          api_null(a, "out") ? NULL : &made);
  (void)api_end_made(a, status, API_DYNAMICS, made, NULL);
}

static void dynamics_set_material(api *a) {
  int64_t ids[8] = {0};
  mps_dynamics *dynamics = api_any(a, API_DYNAMICS)->handle;
  mps_material *material = api_any(a, API_MATERIAL)->handle;
  const int64_t count =
      api_chance(a, 60) ? api_ids(a, mps_dynamics_particles(dynamics), 8, ids) : 0;
  (void)api_end(a, mps_dynamics_set_material(dynamics, material, count ? ids : NULL, count));
}

/* A list of ids, or a box. */
static void draw_place(api *a, mps_particles *set, const int64_t **ids, int64_t *count,
                       int64_t room[8], double lower[3], double upper[3]) {
  if (api_chance(a, 50)) {
    *count = api_ids(a, set, 6, room);
    *ids = *count ? room : NULL;
    return;
  }
  for (int c = 0; c < 3; c++) {
    lower[c] = -INFINITY, upper[c] = INFINITY;
    if (c == 1) upper[c] = api_near(a, "upper", 0.1, 0.05);
  }
  a->wrong = 0; /* NaN is no bound */
}

static void draw_boundary(api *a, mps_dynamics *dynamics, mps_dynamics_boundary_def *def,
                          int64_t *ids) {
  *def = mps_dynamics_boundary_defaults();
  def->struct_size = api_struct_size(a, sizeof *def);
  const int before = a->wrong;
  def->kind = api_choice(a, "kind", 8);
  draw_place(a, mps_dynamics_particles(dynamics), &def->ids, &def->id_count, ids, def->lower,
             def->upper);
  if (a->wrong < before) a->wrong = before;
  const uint32_t dofs[] = {MPS_DOF_X, MPS_DOF_Y, MPS_DOF_X | MPS_DOF_Y,
                           MPS_DOF_X | MPS_DOF_Y | MPS_DOF_ROTATION};
  def->dofs = dofs[api_below(a, 4)];
  if (api_chance(a, 40)) def->signal[0] = api_signal(a, false);
}

static void dynamics_add_boundary(api *a) {
  mps_dynamics_boundary_def def;
  int64_t ids[8] = {0};
  int32_t number = -1;
  mps_dynamics *dynamics = api_any(a, API_DYNAMICS)->handle;
  draw_boundary(a, dynamics, &def, ids);
  api_arm(a);
  (void)api_end(a, mps_dynamics_add_boundary(dynamics, api_null(a, "def") ? NULL : &def,
                                             api_chance(a, 80) ? &number : NULL));
}

static void dynamics_set_boundary(api *a) {
  mps_dynamics_boundary_def def;
  int64_t ids[8] = {0};
  mps_dynamics *dynamics = api_any(a, API_DYNAMICS)->handle;
  const int32_t number = (int32_t)api_least(a, "number", 0, 2);
  draw_boundary(a, dynamics, &def, ids);
  api_arm(a);
  (void)api_end(a, mps_dynamics_set_boundary(dynamics, number, &def));
}

static void draw_load(api *a, mps_dynamics *dynamics, mps_dynamics_load_def *def, int64_t *ids) {
  *def = mps_dynamics_load_defaults();
  def->struct_size = api_struct_size(a, sizeof *def);
  const int before = a->wrong;
  def->kind = api_choice(a, "kind", 2);
  draw_place(a, mps_dynamics_particles(dynamics), &def->ids, &def->id_count, ids, def->lower,
             def->upper);
  if (a->wrong < before) a->wrong = before;
  const int outside = a->wrong;
  if (def->kind == MPS_DYNAMICS_LOAD_TRACTION) {
    api_vector(a, "traction", 2, 0.0, 100.0, def->traction);
    if (api_chance(a, 30)) def->area = api_real(a, "area", 1e-30, 1e30, 0.1);
    if (isnan(def->area)) a->wrong = outside + (!isfinite(def->traction[0] + def->traction[1]));
  } else {
    api_vector(a, "acceleration", 2, 0.0, 10.0, def->acceleration);
  }
  if (api_chance(a, 40)) def->signal[0] = api_signal(a, true);
}

static void dynamics_add_load(api *a) {
  mps_dynamics_load_def def;
  int64_t ids[8] = {0};
  int32_t number = -1;
  mps_dynamics *dynamics = api_any(a, API_DYNAMICS)->handle;
  draw_load(a, dynamics, &def, ids);
  (void)api_end(a, mps_dynamics_add_load(dynamics, api_null(a, "def") ? NULL : &def, &number));
}

static void dynamics_set_load(api *a) {
  mps_dynamics_load_def def;
  int64_t ids[8] = {0};
  mps_dynamics *dynamics = api_any(a, API_DYNAMICS)->handle;
  const int32_t number = (int32_t)api_least(a, "number", 0, 2);
  draw_load(a, dynamics, &def, ids);
  (void)api_end(a, mps_dynamics_set_load(dynamics, number, &def));
}

static void dynamics_add_free_field(api *a) {
  mps_particles *set = api_any(a, API_SET)->handle;
  const int32_t side = (int32_t)api_whole(a, "side", MPS_SIDE_X_LOWER, MPS_SIDE_X_UPPER);
  (void)api_end(a, mps_dynamics_add_free_field(set, side, (int32_t)api_least(a, "gap", 2, 5)));
}

static void dynamics_restart(api *a) {
  mps_dynamics *dynamics = api_any(a, API_DYNAMICS)->handle;
  (void)api_end(a, mps_dynamics_restart(dynamics, api_near(a, "time", 0.0, 1.0)));
}

static void dynamics_refresh(api *a) {
  api_object *o = api_any(a, API_DYNAMICS);
  api_run_solver(a, API_DYNAMICS, o);
  (void)api_end(a, mps_dynamics_refresh(o->handle));
}

static void dynamics_find_limit_sized(api *a) {
  mps_dynamics *dynamics = api_any(a, API_DYNAMICS)->handle;
  const double duration = api_real(a, "duration", 0.0, DBL_MAX, 0.0);
  API_SIZED(a, mps_dynamics_linear_limit, size, out);
  const mps_status status = mps_dynamics_find_limit_sized(dynamics, duration, out, size);
  API_SIZED_END(a, status, size, out, false);
}

static void dynamics_predict_sized(api *a) {
  mps_context *context = api_context(a);
  mps_dynamics_predict_def def = mps_dynamics_predict_defaults();
  api_define(a, MPS_DEF_DYNAMICS_PREDICT, &def, 0,
             "integrator, spacing 0.1, shear_velocity 100, pressure_velocity 200, damping 0.02");
  API_SIZED(a, mps_dynamics_prediction, size, out);
  const mps_status status = mps_dynamics_predict_sized(context, &def, out, size);
  if (status == MPS_OK && size >= sizeof *out && !(out->dt > 0.0 && isfinite(out->omega)))
    api_broken(a, "predicts dt = %g, omega = %g", out->dt, out->omega);
  API_SIZED_END(a, status, size, out, true);
}

static void experimental_printed_torque(api *a) {
  mps_dynamics *dynamics = api_any(a, API_DYNAMICS)->handle;
  (void)api_end(a, mps_experimental_dynamics_printed_torque(dynamics));
}

static const api_call calls[] = {
    API_SOLVER_CALLS(dynamics, API_DYNAMICS),
    {"mps_dynamics_create", 6, API_SET, dynamics_create},
    {"mps_dynamics_set_material", 2, API_DYNAMICS, dynamics_set_material},
    {"mps_dynamics_add_boundary", 4, API_DYNAMICS, dynamics_add_boundary},
    {"mps_dynamics_set_boundary", 3, API_DYNAMICS, dynamics_set_boundary},
    {"mps_dynamics_add_load", 3, API_DYNAMICS, dynamics_add_load},
    {"mps_dynamics_set_load", 2, API_DYNAMICS, dynamics_set_load},
    {"mps_dynamics_add_free_field", 2, API_SET, dynamics_add_free_field},
    {"mps_dynamics_restart", 2, API_DYNAMICS, dynamics_restart},
    {"mps_dynamics_refresh", 3, API_DYNAMICS, dynamics_refresh},
    {"mps_dynamics_find_limit_sized", 2, API_DYNAMICS, dynamics_find_limit_sized},
    {"mps_dynamics_predict_sized", 2, API_CONTEXT, dynamics_predict_sized},
    {"mps_experimental_dynamics_printed_torque", 1, API_DYNAMICS, experimental_printed_torque},
};
const api_table api_dynamics_calls = API_TABLE(calls);
