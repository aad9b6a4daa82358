/* calls_fluid.c - free-surface flow: walls, bodies, loads, steps in parts, readings.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "calls_solver.h"

#include <float.h>
#include <mps/experimental/papers.h>
#include <mps/experimental/fluid_rock.h>
#include <mps/experimental/linear_solver.h>
#include <mps/mps.h>
#include <mps/experimental/fluid_parts.h>

#define SOLVER_DEF MPS_DEF_FLUID
#define SOLVER_BOUNDARY MPS_DEF_FLUID_BOUNDARY
#define SOLVER_LOAD MPS_DEF_FLUID_LOAD
#define SOLVER_GRAVITY(s, account) (void)(account);
#define SOLVER_MOMENTUM false
#define SOLVER_COUNTS(s) true
#define SOLVER_DT(s) mps_fluid_dt(s)
API_SOLVER(fluid, API_FLUID)

static void fluid_create(api *a) {
  mps_fluid *made = NULL;
  mps_context *context = api_context(a);
  mps_particles *set = api_any(a, API_SET)->handle;
  mps_fluid_def def = mps_fluid_defaults();
  def.struct_size = api_struct_size(a, sizeof def);
  def.iterations = (int32_t)api_least(a, "iterations", a->latest ? 500 : 1, 2000);
  if (def.iterations > 0) a->wrong = 0;
  def.density = api_real_or_nan(a, "density", 5e-324, 1e300, 1000.0);
  def.viscosity = api_real_or_nan(a, "viscosity", 0.0, 1e300, api_chance(a, 60) ? 0.0 : 1e-3);
  if (api_chance(a, 10)) def.gravity[1] = 0.0;
  def.measure = api_real(a, "measure", 5e-324, 1e300, 1.0);
  if (api_chance(a, 40)) def.dt = api_real(a, "dt", 5e-324, DBL_MAX, 2e-3);
  if (isnan(def.dt) && a->wrong && strcmp(a->wrong_name, "dt") == 0) a->wrong--;
  const int before = a->wrong;
  if (api_chance(a, 20)) def.level = api_optional(a, "level", -1e12, 1e12, 0.6);
  if (isfinite(def.level)) a->wrong = before;
  def.tolerance = api_real(a, "tolerance", 1e-14, 1e-2, 1e-5);
  if (!a->latest && api_chance(a, 10)) def.material = api_maybe(a, API_MATERIAL, "material");
  if (!a->latest && api_chance(a, 5)) def.kernel = api_maybe(a, API_KERNEL, "kernel");
  if (a->wrong == 1 && strcmp(a->wrong_name, "level") == 0) a->wrong = 0;
  const mps_status status =
      mps_fluid_create(context, set, a->wrong == 0 && api_chance(a, 5) ? NULL : &def,
                       api_null(a, "out") ? NULL : &made);
  (void)api_end_made(a, status, API_FLUID, made, NULL);
}

/* ---- walls ----------------------------------------------------------------------------------- */

static void draw_boundary(api *a, mps_fluid_boundary_def *def, int which, double nodes[6]) {
  static const double points[3][2] = {{0.0, 0.0}, {0.0, 0.0}, {0.6, 0.0}};
  static const double normals[3][2] = {{0.0, 1.0}, {1.0, 0.0}, {-1.0, 0.0}};
  *def = mps_fluid_boundary_defaults();
  def->struct_size = api_struct_size(a, sizeof *def);
  if (!a->latest) def->kind = api_choice(a, "kind", 3);
  if (def->kind == MPS_BOUNDARY_HELD && api_chance(a, 30)) def->kind = MPS_BOUNDARY_OPEN;
  for (int c = 0; c < 2; c++) {
    def->point[c] = a->latest ? points[which][c] : api_near(a, "point", points[which][c], 0.02);
    def->normal[c] = a->latest ? normals[which][c] : api_near(a, "normal", normals[which][c], 0.1);
  }
  api_say(a, "wall %d, ", which);
  if (api_chance(a, 30)) def->signal = api_signal(a, false);
  if (def->signal) def->factor = api_near(a, "factor", 1.0, 0.5);
  if (!def->signal && !a->latest && api_chance(a, 20)) {
    const double along[] = {def->point[0],
                            def->point[1],
                            0.0,
                            def->point[0] - def->normal[1] * 0.5,
                            def->point[1] + def->normal[0] * 0.5,
                            0.0};
    memcpy(nodes, along, sizeof along);
    def->nodes = nodes, def->node_count = 2;
    api_say(a, "2 nodes, ");
  }
}

/* The bed as a polyline that passes the plane walls at right angles, far from its corners. */
static void draw_corners(api *a, mps_fluid_boundary_def *def, double corners[12]) {
  const double h = api_near(a, "corner", -0.05, 0.04);
  const double all[] = {-2.0, -0.01, 0.0, -1.0, -0.01, 0.0, 2.0, -0.01, 0.0, 3.0, h, 0.0};
  memcpy(corners, all, sizeof all);
  *def = mps_fluid_boundary_defaults();
  def->struct_size = api_struct_size(a, sizeof *def);
  if (!a->latest && api_chance(a, 50)) def->kind = MPS_BOUNDARY_ROLLER;
  def->corners = corners, def->corner_count = 4;
  api_say(a, "4 corners, ");
}

static void fluid_add_boundary(api *a) {
  mps_fluid_boundary_def def;
  double nodes[6], corners[12];
  int32_t number = -1;
  mps_fluid *fluid = api_any(a, API_FLUID)->handle;
  int which = (int)api_below(a, 3);
  mps_reaction r; /* of a scene: one wall after the other */
  while (a->latest && which > 0 && mps_fluid_get_reaction(fluid, which - 1, &r) != MPS_OK) which--;
  if (a->latest && mps_fluid_get_reaction(fluid, which, &r) == MPS_OK) which = (which + 1) % 3;
  if (which == 0 && api_chance(a, 20))
    draw_corners(a, &def, corners);
  else
    draw_boundary(a, &def, which, nodes);
  api_arm(a);
  (void)api_end(a, mps_fluid_add_boundary(fluid, api_null(a, "def") ? NULL : &def,
                                          api_chance(a, 80) ? &number : NULL));
}

static void fluid_set_boundary(api *a) {
  mps_fluid_boundary_def def;
  double nodes[6];
  mps_fluid *fluid = api_any(a, API_FLUID)->handle;
  const int32_t number = (int32_t)api_least(a, "number", 0, 2);
  draw_boundary(a, &def, number >= 0 && number < 3 ? number : 0, nodes);
  api_arm(a);
  (void)api_end(a, mps_fluid_set_boundary(fluid, number, &def));
}

static void fluid_set_boundary_motion(api *a) {
  double s[2], v[2];
  mps_fluid *fluid = api_any(a, API_FLUID)->handle;
  const int32_t number = (int32_t)api_least(a, "number", 0, 2);
  const int before = a->wrong;
  api_vector(a, "displacement", 2, 0.0, 1e-3, s);
  api_vector(a, "velocity", 2, 0.0, 0.05, v);
  if (isfinite(s[0]) && isfinite(v[0])) a->wrong = before; /* most walls have one node */
  if (api_chance(a, 30)) {
    a->wrong = before + !isfinite(v[0]);
    (void)api_end(a, mps_fluid_set_boundary_motion(fluid, number, NULL, v));
  } else {
    (void)api_end(a, mps_fluid_set_boundary_motion(fluid, number, s, v));
  }
}

static void fluid_get_wall(api *a) {
  double x[3 * 33], pressure[33];
  int64_t count = -1;
  mps_fluid *fluid = api_any(a, API_FLUID)->handle;
  const int32_t number = (int32_t)api_least(a, "number", 0, 3);
  int64_t capacity = (int64_t)api_below(a, 33);
  if (a->mood == API_ABSURD && api_chance(a, 20)) capacity = -1, api_wrong(a, "capacity");
  const mps_status status = mps_fluid_get_boundary_points(fluid, number, capacity, &count,
                                                          api_chance(a, 80) ? x : NULL, pressure);
  for (int64_t k = 0; status == MPS_OK && k < count && k < capacity; k++)
    if (!isfinite(pressure[k])) api_broken(a, "pressure %g", pressure[k]);
  a->reads = false; /* readings before a step fill `surface_rise` and others */
  (void)api_end(a, status);
}

static void fluid_get_pressure(api *a) {
  double x[3] = {0}, pressure[1] = {0};
  mps_fluid *fluid = api_any(a, API_FLUID)->handle;
  const int32_t number = (int32_t)api_least(a, "number", 0, 2);
  x[number == 0 ? 0 : 1] = api_near(a, "x", 0.2, 0.1);
  if (number == 2) x[0] = 0.6;
  const mps_status status = mps_fluid_get_pressure(fluid, number, 1, x, pressure);
  if (status == MPS_OK && !isfinite(pressure[0])) api_broken(a, "pressure %g", pressure[0]);
  a->reads = false; /* readings before a step fill `surface_rise` and others */
  (void)api_end(a, status);
}

static void fluid_get_body_pressure(api *a) {
  double x[3] = {0}, pressure[1] = {0};
  mps_fluid *fluid = api_any(a, API_FLUID)->handle;
  mps_contact *contact = api_any(a, API_CONTACT)->handle;
  const int64_t count = api_least(a, "count", 0, 1);
  x[0] = api_near(a, "x", 0.3, 0.3), x[1] = api_near(a, "y", 0.2, 0.2);
  if (count == 0) a->wrong = !fluid;
  const mps_status status = mps_fluid_get_body_pressure(fluid, contact, count, x, pressure);
  if (status == MPS_OK && !isfinite(pressure[0])) api_broken(a, "pressure %g", pressure[0]);
  a->reads = false; /* readings before a step fill `surface_rise` and others */
  (void)api_end(a, status);
}

static void fluid_get_segments(api *a) {
  double force[9], moment[3];
  int64_t count = -1;
  mps_fluid *fluid = api_any(a, API_FLUID)->handle;
  const int32_t number = (int32_t)api_least(a, "number", 0, 3);
  const int64_t capacity = api_least(a, "capacity", 0, 3);
  const mps_status status = mps_fluid_get_segments(fluid, number, capacity, &count,
                                                   api_chance(a, 80) ? force : NULL, moment);
  for (int64_t k = 0; status == MPS_OK && k < count && k < capacity; k++)
    if (!isfinite(moment[k])) api_broken(a, "moment %g", moment[k]);
  (void)api_end(a, status);
}

static void fluid_get_levels(api *a) {
  double station[2], level[2] = {0};
  mps_fluid *fluid = api_any(a, API_FLUID)->handle;
  api_vector(a, "station", 2, 0.3, 0.5, station);
  const int64_t count = api_least(a, "count", 0, 2);
  if (count == 0 || (count == 1 && isfinite(station[0]))) a->wrong = !fluid;
  const mps_status status = mps_fluid_get_levels(fluid, count, station, level);
  a->reads = false; /* readings before a step fill `surface_rise` and others */
  (void)api_end(a, status);
}

/* ---- bodies and loads ------------------------------------------------------------------------ */

static void fluid_add_contact(api *a) {
  mps_contact *made = NULL;
  api_object *o = api_any(a, API_FLUID);
  mps_body *body = api_any(a, API_BODY)->handle;
  mps_fluid_contact_def def = mps_fluid_contact_defaults();
  if (api_chance(a, 50)) def.kind = MPS_BOUNDARY_ROLLER;
  api_define(a, MPS_DEF_FLUID_CONTACT, &def, 0, api_chance(a, 20) ? "kind" : "mover?");
  const bool kept = api_chance(a, 80);
  const mps_status status = mps_fluid_add_contact(
      o->handle, body, a->wrong == 0 && api_chance(a, 10) ? NULL : &def, kept ? &made : NULL);
  if (kept && (status == MPS_OK) != (made != NULL)) api_broken(a, "a contact, or none");
  (void)api_adopt(a, API_CONTACT, made, a->context, o);
  (void)api_end(a, status);
}

static void draw_load(api *a, mps_fluid *fluid, mps_fluid_load_def *def, int64_t *ids) {
  *def = mps_fluid_load_defaults();
  def->struct_size = api_struct_size(a, sizeof *def);
  def->kind = api_choice(a, "kind", 3);
  if (api_chance(a, 30)) {
    def->id_count = api_ids(a, mps_fluid_particles(fluid), 4, ids);
    def->ids = def->id_count ? ids : NULL;
  } else if (api_chance(a, 30)) {
    const int before = a->wrong;
    def->lower[1] = api_near(a, "lower", 0.3, 0.2);
    a->wrong = before;
  } else {
    def->all = 1;
  }
  if (def->kind == MPS_FLUID_LOAD_PRESSURE)
    def->pressure = api_real(a, "pressure", -1e12, 1e12, 100.0);
  else if (def->kind == MPS_FLUID_LOAD_DAMPING)
    def->rate = api_real(a, "rate", 0.0, 1e6, 5.0);
  else
    api_vector(a, "acceleration", 2, 0.0, 1.0, def->acceleration);
  if (api_chance(a, 40)) def->signal[0] = api_signal(a, true);
}

static void fluid_add_load(api *a) {
  mps_fluid_load_def def;
  int64_t ids[8] = {0};
  int32_t number = -1;
  mps_fluid *fluid = api_any(a, API_FLUID)->handle;
  draw_load(a, fluid, &def, ids);
  (void)api_end(a, mps_fluid_add_load(fluid, api_null(a, "def") ? NULL : &def, &number));
}

static void fluid_set_load(api *a) {
  mps_fluid_load_def def;
  int64_t ids[8] = {0};
  mps_fluid *fluid = api_any(a, API_FLUID)->handle;
  const int32_t number = (int32_t)api_least(a, "number", 0, 1);
  draw_load(a, fluid, &def, ids);
  (void)api_end(a, mps_fluid_set_load(fluid, number, &def));
}

/* ---- rock ------------------------------------------------------------------------------------ */

static void fluid_add_rock(api *a) {
  double corners[12];
  int32_t number = -1;
  mps_fluid *fluid = api_any(a, API_FLUID)->handle;
  mps_fluid_rock_def def = mps_fluid_rock_defaults();
  const double x = api_near(a, "corner", 0.3, 0.2);
  const double all[] = {x, 0.0, 0.0, x + 0.2, 0.0, 0.0, x + 0.2, 0.3, 0.0, x, 0.3, 0.0};
  memcpy(corners, all, sizeof all);
  def.corners = corners;
  api_define(
      a, MPS_DEF_FLUID_ROCK, &def, 0,
      "corner_count 4, porosity 0.5, diameter 0.02, alpha 1000, beta? 1.1, KC? 10, gamma 0.34, "
      "viscosity? 1e-6");
  api_arm(a);
  (void)api_end(a, mps_fluid_add_rock(fluid, api_null(a, "def") ? NULL : &def, &number));
}

static void fluid_remove_rock(api *a) {
  mps_fluid *fluid = api_any(a, API_FLUID)->handle;
  (void)api_end(a, mps_fluid_remove_rock(fluid, (int32_t)api_least(a, "number", 0, 2)));
}

/* ---- a step in parts ------------------------------------------------------------------------- */

static void fluid_begin_step(api *a) {
  api_object *o = api_any(a, API_FLUID);
  double dt = api_chance(a, 50) ? NAN : mps_fluid_dt(o->handle);
  if (a->mood == API_ABSURD && api_chance(a, 30)) dt = -1.0, api_wrong(a, "dt");
  api_say(a, "dt = %g, ", dt);
  api_run_solver(a, API_FLUID, o);
  a->change = API_CHANGES_ORDER;
  (void)api_end(a, mps_fluid_begin_step(o->handle, dt));
}

static void fluid_solve_pressure(api *a) {
  api_object *o = api_any(a, API_FLUID);
  api_run_solver(a, API_FLUID, o);
  const mps_status status = mps_fluid_solve_pressure(o->handle);
  if (status == MPS_ERROR_NUMERIC) a->change = API_CHANGES_ALL; /* the pressure so far */
  (void)api_end(a, status);
}

static void fluid_end_step(api *a) {
  api_object *o = api_any(a, API_FLUID);
  api_run_solver(a, API_FLUID, o);
  const mps_status status = mps_fluid_end_step(o->handle);
  /* the step is undone: readings of the open step are invalid */
  if (status == MPS_ERROR_MEMORY || status == MPS_ERROR_DIVERGED) a->change = API_CHANGES_ALL;
  (void)api_end(a, status);
}

static void fluid_abandon_step(api *a) {
  (void)api_end(a, mps_fluid_abandon_step(api_any(a, API_FLUID)->handle));
}

API_GETTER(fluid_get_report_sized, mps_fluid_get_report_sized, API_FLUID, mps_fluid,
           mps_fluid_report)

static void fluid_set_linear_solver(api *a) {
  mps_fluid *fluid = api_any(a, API_FLUID)->handle;
  api_set_linear_solver(a, mps_fluid_solver(fluid), MPS_LINEAR_EQUATION_PRESSURE);
}

static void experimental_classical(api *a) {
  mps_fluid *fluid = api_any(a, API_FLUID)->handle;
  (void)api_end(a, mps_experimental_fluid_classical(fluid, api_real(a, "gamma", 5e-324, 1.0, 0.2)));
}

static const api_call calls[] = {
    API_SOLVER_CALLS(fluid, API_FLUID),
    {"mps_fluid_create", 5, API_SET, fluid_create},
    {"mps_fluid_add_boundary", 4, API_FLUID, fluid_add_boundary},
    {"mps_fluid_set_boundary", 3, API_FLUID, fluid_set_boundary},
    {"mps_fluid_set_boundary_motion", 4, API_FLUID, fluid_set_boundary_motion},
    {"mps_fluid_get_boundary_points", 1, API_FLUID, fluid_get_wall},
    {"mps_fluid_get_pressure", 2, API_FLUID, fluid_get_pressure},
    {"mps_fluid_get_body_pressure", 1, API_FLUID, fluid_get_body_pressure},
    {"mps_fluid_get_segments", 1, API_FLUID, fluid_get_segments},
    {"mps_fluid_get_levels", 1, API_FLUID, fluid_get_levels},
    {"mps_fluid_add_rock", 1, API_FLUID, fluid_add_rock},
    {"mps_fluid_remove_rock", 1, API_FLUID, fluid_remove_rock},
    {"mps_fluid_add_contact", 3, API_FLUID, fluid_add_contact},
    {"mps_fluid_add_load", 3, API_FLUID, fluid_add_load},
    {"mps_fluid_set_load", 2, API_FLUID, fluid_set_load},
    {"mps_fluid_begin_step", 4, API_FLUID, fluid_begin_step},
    {"mps_fluid_solve_pressure", 6, API_FLUID, fluid_solve_pressure},
    {"mps_fluid_end_step", 5, API_FLUID, fluid_end_step},
    {"mps_fluid_abandon_step", 2, API_FLUID, fluid_abandon_step},
    {"mps_fluid_get_report_sized", 1, API_FLUID, fluid_get_report_sized},
    {"mps_solver_set_linear_solver", 1, API_FLUID, fluid_set_linear_solver},
    {"mps_experimental_fluid_classical", 1, API_FLUID, experimental_classical},
};
const api_table api_fluid_calls = API_TABLE(calls);
