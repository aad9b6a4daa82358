/* calls_mpm.c - WLS-MPM: its solver, boundaries, loads, contacts and grid.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "calls_solver.h"

#include "body/contact_internal.h"

#include <float.h>
#include <mps/experimental/papers.h>
#include <mps/mps.h>
#include <mps/experimental/mpm_energy.h>
#include <mps/experimental/linear_solver.h>
#include <mps/experimental/pore_water.h>
#include <mps/experimental/pore_water.h>
#include <mps/experimental/settle.h>

/* Water that has drained takes its mass from the particles. */
static double drained_from(const mps_mpm *mpm) {
  mps_particles *set = mps_mpm_particles(mpm);
  mps_pore_budget budget = {.drained = 0.0};
  mps_particles_field_info info;
  bool wet = false; /* asked without an error record of a solver that has none */
  for (int32_t f = 0; f < mps_particles_field_count(set); f++)
    wet = wet || (mps_particles_get_field_info(set, f, &info) == MPS_OK &&
                  strcmp(info.name, "pore_pressure_gradient") == 0);
  return wet && mps_mpm_get_pore_budget(mpm, &budget) == MPS_OK ? budget.drained : 0.0;
}

/* Damping of nodes takes momentum. Around an axis the sum of m v_r is no momentum, as radial
 * directions differ: hoop stress changes it without any force from outside. */
static void mpm_gravity(mps_mpm *mpm, api_account *account) {
  mps_mpm_def def;
  if (mps_mpm_get_def(mpm, &def) != MPS_OK) return;
  account->removed += drained_from(mpm);
  memcpy(account->gravity, def.gravity, sizeof def.gravity);
  account->pushed = account->pushed || def.local_damping != 0.0 || def.viscous_damping != 0.0;
  account->radial = def.geometry == MPS_MPM_GEOMETRY_AXISYMMETRIC;
}
#define SOLVER_DEF MPS_DEF_MPM
#define SOLVER_BOUNDARY MPS_DEF_MPM_BOUNDARY
#define SOLVER_LOAD MPS_DEF_MPM_LOAD
#define SOLVER_GRAVITY(s, account) mpm_gravity(s, account);
#define SOLVER_MOMENTUM true
#define SOLVER_COUNTS(s) true
#define SOLVER_DT(s) mps_mpm_dt(s)
API_SOLVER(mpm, API_MPM)
API_QUERY(mpm_grid, API_MPM)

static void draw_choices(api *a, mps_mpm_def *def) {
  def->spline = api_chance(a, 50) ? 3 : 2;
  def->volumetric = api_choice(a, "volumetric", 4);
  def->step_from = api_choice(a, "step_from", 2);
  def->budget = (int32_t)api_below(a, 2);
  def->edge = api_choice(a, "edge", 2);
  if (api_chance(a, 20)) def->local_damping = api_real(a, "local_damping", 0.0, 0.999, 0.1);
  if (api_chance(a, 20)) def->viscous_damping = api_real(a, "viscous_damping", 0.0, 1e300, 1.0);
  if (api_chance(a, 20)) def->flip_time = api_real(a, "flip_time", 0.0, 1e9, 1e-3);
}

static void mpm_create(api *a) {
  mps_mpm *made = NULL;
  mps_context *context = api_context(a);
  mps_particles *set = api_any(a, API_SET)->handle;
  mps_material *material = api_any(a, API_MATERIAL)->handle;
  mps_mpm_def def = mps_mpm_defaults();
  def.struct_size = api_struct_size(a, sizeof def);
  const int dim = mps_particles_dim(set) == 3 ? 3 : 2;
  def.geometry = dim == 3            ? MPS_MPM_GEOMETRY_SPACE
                 : api_chance(a, 25) ? MPS_MPM_GEOMETRY_AXISYMMETRIC
                                     : 0;
  if (a->mood == API_ABSURD && api_chance(a, 10)) def.geometry = api_choice(a, "geometry", 3);
  draw_choices(a, &def);
  def.cell = api_real(a, "cell", 5e-324, 1e300, 0.2);
  const bool walls = a->latest || api_chance(a, 70);
  for (int c = 0; walls && c < dim; c++) {
    if (a->latest || api_chance(a, 80)) def.lower[c] = -0.4;
    if (a->latest || api_chance(a, 60)) def.upper[c] = 1.2;
  }
  if (def.geometry == MPS_MPM_GEOMETRY_AXISYMMETRIC) def.lower[0] = 0.0;
  api_say(a, "lower = {%g, %g}, upper = {%g, %g}, ", def.lower[0], def.lower[1], def.upper[0],
          def.upper[1]);
  if (api_chance(a, 20)) def.measure = api_real(a, "measure", 5e-324, 1e300, 1.0);
  if (dim == 3 || isnan(def.measure) || def.geometry == MPS_MPM_GEOMETRY_AXISYMMETRIC)
    a->wrong *= isfinite(def.cell);
  if (api_chance(a, 80)) def.gravity[dim - 1] = -9.81;
  if (!a->latest && api_chance(a, 30)) def.dt = api_real(a, "dt", 5e-324, 1e300, 1e-3);
  def.courant = api_real(a, "courant", 5e-324, 1.0, 0.5);
  if (!a->latest && api_chance(a, 10)) def.kernel = api_maybe(a, API_KERNEL, "kernel");
  if (isnan(def.dt) || isnan(def.measure)) a->wrong = a->wrong > 1; /* NaN stands for the default */
  const mps_status status = mps_mpm_create(context, set, material, api_null(a, "def") ? NULL : &def,
                                           api_null(a, "out") ? NULL : &made);
  (void)api_end_made(a, status, API_MPM, made, NULL);
}

static void mpm_set_material(api *a) {
  int64_t ids[8] = {0};
  mps_mpm *mpm = api_any(a, API_MPM)->handle;
  mps_material *material = api_any(a, API_MATERIAL)->handle;
  const int64_t count = api_chance(a, 60) ? api_ids(a, mps_mpm_particles(mpm), 8, ids) : 0;
  (void)api_end(a, mps_mpm_set_material(mpm, material, count ? ids : NULL, count));
}

/* ---- boundaries and loads -------------------------------------------------------------------- */

static void draw_boundary(api *a, mps_mpm *mpm, mps_mpm_boundary_def *def, int64_t *ids,
                          bool side) {
  *def = mps_mpm_boundary_defaults();
  def->struct_size = api_struct_size(a, sizeof *def);
  if (!side) def->kind = api_chance(a, 70) ? MPS_BOUNDARY_DRIVEN : MPS_BOUNDARY_HELD;
  if (side || api_chance(a, 10)) def->kind = api_choice(a, "kind", 8);
  if (!side && api_chance(a, 50)) {
    def->id_count = api_ids(a, mps_mpm_particles(mpm), 4, ids);
    def->ids = def->id_count ? ids : NULL;
  } else if (!side) {
    for (int c = 0; c < 3; c++)
      if (api_chance(a, 50)) {
        def->lower[c] = api_near(a, "lower", 0.0, 0.1);
        def->upper[c] = api_near(a, "upper", 0.4, 0.1);
      }
    a->wrong = 0; /* boxes may be infinite */
  }
  if (!side) def->dofs = api_below(a, 4);
  if (api_chance(a, 30)) {
    const int c = (int)api_below(a, 2);
    def->signal[c] = api_signal(a, false);
    def->factor[c] = api_near(a, "factor", 1.0, 0.5);
    if (!def->signal[c] && !isfinite(def->factor[c])) a->wrong = 0;
  }
  if (def->kind == MPS_BOUNDARY_FRICTIONAL) def->friction = api_real(a, "friction", 0.0, 1e3, 0.3);
  if (def->kind == MPS_BOUNDARY_ABSORBING && api_chance(a, 50))
    def->settle = api_real(a, "settle", 0.0, DBL_MAX, 0.01);
}

static void mpm_add_boundary(api *a) {
  mps_mpm_boundary_def def;
  int64_t ids[8];
  int32_t number = -1;
  api_object *o = api_any(a, API_MPM);
  mps_mpm *mpm = o->handle;
  draw_boundary(a, mpm, &def, ids, false);
  o->loose = o->loose || def.ids;
  api_arm(a);
  (void)api_end(a, mps_mpm_add_boundary(mpm, api_null(a, "def") ? NULL : &def,
                                        api_chance(a, 80) ? &number : NULL));
}

static void mpm_set_boundary(api *a) {
  mps_mpm_boundary_def def;
  int64_t ids[8];
  api_object *o = api_any(a, API_MPM);
  mps_mpm *mpm = o->handle;
  const int32_t number = (int32_t)api_least(a, "number", 0, 8);
  draw_boundary(a, mpm, &def, ids, number < 6);
  o->loose = o->loose || def.ids;
  api_arm(a);
  (void)api_end(a, mps_mpm_set_boundary(mpm, number, api_null(a, "def") ? NULL : &def));
}

static void draw_load(api *a, mps_mpm *mpm, mps_mpm_load_def *def, int64_t *ids, double *area) {
  *def = mps_mpm_load_defaults();
  def->struct_size = api_struct_size(a, sizeof *def);
  if (api_chance(a, 20)) {
    def->all = 1;
  } else {
    def->id_count = api_ids(a, mps_mpm_particles(mpm), 4, ids);
    def->ids = ids;
  }
  if (def->ids && api_chance(a, 30)) {
    for (int k = 0; k < 4; k++) area[k] = k < def->id_count ? api_near(a, "area", 0.1, 0.05) : 0.0;
    def->area = area;
  }
  api_vector(a, "traction", mps_particles_dim(mps_mpm_particles(mpm)), 0.0, 100.0, def->traction);
  if (api_chance(a, 40)) def->signal[0] = api_signal(a, true);
  if (api_chance(a, 30)) def->factor[1] = api_near(a, "factor", 1.0, 0.5);
}

static void mpm_add_load(api *a) {
  mps_mpm_load_def def;
  int64_t ids[8] = {0};
  double area[8];
  int32_t number = -1;
  mps_mpm *mpm = api_any(a, API_MPM)->handle;
  draw_load(a, mpm, &def, ids, area);
  (void)api_end(a, mps_mpm_add_load(mpm, api_null(a, "def") ? NULL : &def, &number));
}

static void mpm_set_load(api *a) {
  mps_mpm_load_def def;
  int64_t ids[8] = {0};
  double area[8];
  mps_mpm *mpm = api_any(a, API_MPM)->handle;
  const int32_t number = (int32_t)api_least(a, "number", 0, 2);
  draw_load(a, mpm, &def, ids, area);
  (void)api_end(a, mps_mpm_set_load(mpm, number, &def));
}

/* ---- sums and equilibrium -------------------------------------------------------------------- */

API_GETTER(mpm_get_usage_sized, mps_mpm_get_report_sized, API_MPM, mps_mpm, mps_mpm_report)
API_GETTER(mpm_get_energy_report_sized, mps_mpm_get_energy_report_sized, API_MPM, mps_mpm,
           mps_mpm_energy_report)

static void mpm_settle_sized(api *a) {
  api_object *o = api_any(a, API_MPM);
  mps_mpm_settle_def def = mps_mpm_settle_defaults();
  api_define(a, MPS_DEF_MPM_SETTLE, &def, 0, "max_steps 30, tolerance? 1e-2");
  mps_mpm_settled out[2];
  memset(out, 0x5a, sizeof out);
  const size_t size = api_size(a, sizeof *out);
  api_run_solver(a, API_MPM, o);
  const int64_t before = mps_mpm_steps(o->handle);
  const mps_status status =
      mps_mpm_settle_sized(o->handle, &def, out, size < sizeof out ? size : 8);
  api_stepped(a, status, before, mps_mpm_steps(o->handle));
  (void)api_end(a, status);
}

/* ---- pore water ------------------------------------------------------------------------------ */

API_GETTER(mpm_get_pore_water_sized, mps_mpm_get_pore_water_sized, API_MPM, mps_mpm,
           mps_pore_water_def)
API_GETTER(mpm_get_pore_budget_sized, mps_mpm_get_pore_budget_sized, API_MPM, mps_mpm,
           mps_pore_budget)
API_GETTER(mpm_get_pore_report_sized, mps_mpm_get_pore_report_sized, API_MPM, mps_mpm,
           mps_pore_report)

static void mpm_add_pore_water(api *a) {
  mps_mpm *mpm = api_any(a, API_MPM)->handle;
  mps_pore_water_def def = mps_pore_water_defaults();
  api_define(a, MPS_DEF_PORE_WATER, &def, 0,
             "scheme, porosity? 0.3, permeability? 1e-4, bulk? 1e6, density 1, exponent 1, "
             "ratio_slope? 1");
  a->change = API_CHANGES_ORDER;
  (void)api_end(a, mps_mpm_add_pore_water(mpm, &def));
}

static void mpm_set_pore_level(api *a) {
  mps_mpm *mpm = api_any(a, API_MPM)->handle;
  double point[3];
  api_vector(a, "point", mps_particles_dim(mps_mpm_particles(mpm)), 0.0, 1.0, point);
  (void)api_end(a, mps_mpm_set_pore_level(mpm, api_null(a, "point") ? NULL : point));
}

static mps_pore_face_def draw_face(api *a) {
  mps_pore_face_def def = mps_pore_face_defaults();
  api_define(a, MPS_DEF_PORE_FACE, &def, 0, "kind, at_rest?, pressure? 100");
  return def;
}

static void mpm_add_pore_face(api *a) {
  mps_mpm *mpm = api_any(a, API_MPM)->handle;
  const mps_pore_face_def def = draw_face(a);
  int32_t number = -1;
  (void)api_end(a, mps_mpm_add_pore_face(mpm, &def, &number));
}

static void mpm_set_pore_face(api *a) {
  mps_mpm *mpm = api_any(a, API_MPM)->handle;
  const int32_t number = (int32_t)api_least(a, "number", 0, 2);
  const mps_pore_face_def def = draw_face(a);
  (void)api_end(a, mps_mpm_set_pore_face(mpm, number, &def));
}

static void mpm_set_linear_solver(api *a) {
  mps_mpm *mpm = api_any(a, API_MPM)->handle;
  api_set_linear_solver(a, mps_mpm_solver(mpm), MPS_LINEAR_EQUATION_PORE_PRESSURE);
}

static void mpm_get_pore_flow(api *a) {
  mps_mpm *mpm = api_any(a, API_MPM)->handle;
  const int32_t number = (int32_t)api_least(a, "number", -1, 2);
  double rate, mass;
  (void)api_end(a, mps_mpm_get_pore_flow(mpm, number, &rate, &mass));
}

/* ---- contacts -------------------------------------------------------------------------------- */

static void mpm_add_contact(api *a) {
  mps_contact *made = NULL;
  api_object *o = api_any(a, API_MPM);
  mps_body *body = api_any(a, API_BODY)->handle;
  mps_contact_def def = mps_contact_defaults();
  if (!a->latest)
    api_define(
        a, MPS_DEF_CONTACT, &def, 0,
        api_chance(a, 60)
            ? "mover, sweeps 30, inside, thin, friction 0.3, offset? 0.05, depth? 0.2, "
              "adhesion? 1, strength? 100, corner? 0.02, tolerance? 0.1"
            : "mover, method, sweeps 30, inside, thin, friction 0.3, penalty? 1e5, offset? 0.05, "
              "depth? 0.2");
  const bool kept = api_chance(a, 80);
  const mps_status status = mps_mpm_add_contact(
      o->handle, body, a->wrong == 0 && api_chance(a, 10) ? NULL : &def, kept ? &made : NULL);
  if (kept && (status == MPS_OK) != (made != NULL)) api_broken(a, "a contact, or none");
  (void)api_adopt(a, API_CONTACT, made, a->context, o);
  (void)api_end(a, status);
}

API_DESTROY(contact_destroy, API_CONTACT)

static void contact_get_reaction_sized(api *a) {
  mps_contact *contact = api_any(a, API_CONTACT)->handle;
  const int32_t parts = contact ? contact->body->parts : 0;
  const int32_t part = (int32_t)api_whole(a, "part", -1, parts > 0 ? parts - 1 : -1);
  API_SIZED(a, mps_reaction, size, out);
  const mps_status status = mps_contact_get_reaction_sized(contact, part, out, size);
  API_SIZED_END(a, status, size, out, true);
}

/* The definition is that of the solver that has made the contact. */
static void contact_get_def(api *a) {
  api_begin(a, "mps_contact_get_def");
  mps_contact *contact = api_any(a, API_CONTACT)->handle;
  const int32_t own = contact ? contact->kind->def_kind : (int32_t)MPS_DEF_CONTACT;
  int32_t kind = own;
  if (a->mood == API_ABSURD && api_chance(a, 20)) kind = MPS_DEF_BODY, api_wrong(a, "kind");
  API_SIZED(a, mps_contact_def, size, out);
  mps_fluid_contact_def of_fluid;
  const bool whole = own == MPS_DEF_CONTACT;
  void *to = whole ? (void *)out : (void *)&of_fluid;
  const mps_status status = mps_contact_get_def(contact, kind, api_null(a, "out") ? NULL : to,
                                                whole ? size : sizeof of_fluid);
  API_SIZED_END(a, status, size, out, true);
}

static void contact_get_particles(api *a) {
  int64_t count = -1, ids[65];
  double gap[65], normal[195], force[195], foot[195];
  mps_contact *contact = api_any(a, API_CONTACT)->handle;
  int64_t capacity = (int64_t)api_below(a, 65);
  if (a->mood == API_ABSURD && api_chance(a, 20)) capacity = -1, api_wrong(a, "capacity");
  const mps_status status = mps_contact_get_particles(
      contact, capacity, &count, api_chance(a, 80) ? ids : NULL, api_chance(a, 80) ? gap : NULL,
      api_chance(a, 80) ? normal : NULL, api_chance(a, 80) ? force : NULL, foot);
  const int64_t written = count < capacity ? count : capacity;
  for (int64_t k = 0; status == MPS_OK && k < 3 * written; k++)
    if (!isfinite(foot[k])) api_broken(a, "foot %g", foot[k]);
  a->reads = true;
  a->change = API_CHANGES_ORDER;
  (void)api_end(a, status);
}

/* ---- grid ------------------------------------------------------------------------------------ */

static mps_grid *grid(api *a) { return mps_mpm_grid(api_any(a, API_MPM)->handle); }

static void grid_get_info_sized(api *a) {
  mps_grid *g = grid(a);
  API_SIZED(a, mps_grid_info, size, out);
  const mps_status status = mps_grid_get_info_sized(g, api_null(a, "out") ? NULL : out, size);
  API_SIZED_END(a, status, size, out, true);
}

static void grid_get_nodes(api *a) {
  enum { MOST = 300 };
  static double position[3 * MOST], mass[MOST], velocity[3 * MOST], force[3 * MOST];
  int64_t count = -1;
  mps_grid *g = grid(a);
  int64_t capacity = api_chance(a, 50) ? MOST : (int64_t)api_below(a, MOST);
  if (a->mood == API_ABSURD && api_chance(a, 20)) capacity = -1, api_wrong(a, "capacity");
  const mps_status status =
      mps_grid_get_nodes(g, capacity, &count, api_chance(a, 80) ? position : NULL, mass,
                         api_chance(a, 80) ? velocity : NULL, api_chance(a, 80) ? force : NULL);
  for (int64_t k = 0; status == MPS_OK && k < count && k < capacity; k++)
    if (!isfinite(mass[k])) api_broken(a, "mass %g of node %d", mass[k], (int)k);
  a->reads = true;
  a->change = API_CHANGES_ORDER;
  (void)api_end(a, status);
}

/* 0 also where the set lacks the field. */
static int32_t last_component(mps_particles *set, const char *name) {
  int32_t last = 0;
  for (int32_t f = 0; f < mps_particles_field_count(set); f++) {
    mps_particles_field_info info;
    if (mps_particles_get_field_info(set, f, &info) == MPS_OK && strcmp(info.name, name) == 0)
      last = info.components - 1;
  }
  return last;
}

static void grid_evaluate(api *a) {
  double points[6], values[2 * 16];
  int32_t states[2];
  api_object *o = api_any(a, API_MPM);
  mps_particles *set = mps_mpm_particles(o->handle);
  const char *field = api_field(a, set);
  const int32_t component = (int32_t)api_whole(a, "component", -1, last_component(set, field));
  api_vector(a, "points", 6, 0.3, 0.5, points);
  if (mps_particles_dim(set) == 2) a->wrong -= a->wrong == 1 && !isfinite(points[2] + points[5]);
  int64_t count = (int64_t)api_below(a, 3);
  if (count == 0 || (count == 1 && a->wrong == 1)) a->wrong = !o->handle;
  if (a->mood == API_ABSURD && api_chance(a, 20)) count = -1, api_wrong(a, "count");
  api_say(a, "count = %d, ", (int)count);
  const mps_status status = mps_grid_evaluate(mps_mpm_grid(o->handle), field, component, count,
                                              points, values, api_chance(a, 80) ? states : NULL);
  a->reads = true;
  a->change = API_CHANGES_ORDER;
  (void)api_end(a, status);
}

/* ---- experimental ---------------------------------------------------------------------------- */

static void experimental_transfer(api *a) {
  api_object *o = api_any(a, API_MPM);
  mps_mpm *mpm = o->handle;
  o->loose = true;
  (void)api_end(a, mps_experimental_mpm_transfer(mpm, api_choice(a, "transfer", 2)));
}

static void experimental_strain(api *a) {
  api_object *o = api_any(a, API_MPM);
  mps_mpm *mpm = o->handle;
  o->loose = true;
  (void)api_end(a, mps_experimental_mpm_strain(mpm, api_choice(a, "strain", 2)));
}

static void experimental_standard(api *a) {
  api_object *o = api_any(a, API_MPM);
  mps_mpm *mpm = o->handle;
  o->loose = true;
  (void)api_end(a, mps_experimental_mpm_standard(mpm, api_real(a, "flip", 0.0, 1.0, 0.9)));
}

static const api_call calls[] = {
    API_SOLVER_CALLS(mpm, API_MPM),
    {"mps_mpm_add_pore_water", 2, API_MPM, mpm_add_pore_water},
    {"mps_mpm_get_pore_water_sized", 1, API_MPM, mpm_get_pore_water_sized},
    {"mps_mpm_set_pore_level", 1, API_MPM, mpm_set_pore_level},
    {"mps_mpm_add_pore_face", 2, API_MPM, mpm_add_pore_face},
    {"mps_mpm_set_pore_face", 1, API_MPM, mpm_set_pore_face},
    {"mps_solver_set_linear_solver", 1, API_MPM, mpm_set_linear_solver},
    {"mps_mpm_get_pore_flow", 1, API_MPM, mpm_get_pore_flow},
    {"mps_mpm_get_pore_budget_sized", 1, API_MPM, mpm_get_pore_budget_sized},
    {"mps_mpm_get_pore_report_sized", 1, API_MPM, mpm_get_pore_report_sized},
    {"mps_mpm_create", 8, API_MATERIAL, mpm_create},
    {"mps_mpm_grid", 1, API_MPM, query_mpm_grid},
    {"mps_mpm_set_material", 4, API_MPM, mpm_set_material},
    {"mps_mpm_add_boundary", 4, API_MPM, mpm_add_boundary},
    {"mps_mpm_set_boundary", 5, API_MPM, mpm_set_boundary},
    {"mps_mpm_add_load", 3, API_MPM, mpm_add_load},
    {"mps_mpm_set_load", 3, API_MPM, mpm_set_load},
    {"mps_mpm_get_report_sized", 1, API_MPM, mpm_get_usage_sized},
    {"mps_mpm_get_energy_report_sized", 1, API_MPM, mpm_get_energy_report_sized},
    {"mps_mpm_settle_sized", 2, API_MPM, mpm_settle_sized},
    {"mps_mpm_add_contact", 6, API_MPM, mpm_add_contact},
    {"mps_contact_destroy", 1, API_CONTACT, destroy_contact_destroy},
    {"mps_contact_get_reaction_sized", 2, API_CONTACT, contact_get_reaction_sized},
    {"mps_contact_get_def", 2, API_CONTACT, contact_get_def},
    {"mps_contact_get_particles", 3, API_CONTACT, contact_get_particles},
    {"mps_grid_get_info_sized", 1, API_MPM, grid_get_info_sized},
    {"mps_grid_get_nodes", 2, API_MPM, grid_get_nodes},
    {"mps_grid_evaluate", 3, API_MPM, grid_evaluate},
    {"mps_experimental_mpm_transfer", 1, API_MPM, experimental_transfer},
    {"mps_experimental_mpm_strain", 1, API_MPM, experimental_strain},
    {"mps_experimental_mpm_standard", 1, API_MPM, experimental_standard},
};
const api_table api_mpm_calls = API_TABLE(calls);
