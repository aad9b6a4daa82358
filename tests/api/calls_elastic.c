/* calls_elastic.c - implicit elasticity: statics, motions, facets, modes, a foreign solver.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "calls_solver.h"

#include <mps/experimental/linear_solver.h>
#include <mps/experimental/papers.h>
#include <mps/mps.h>

#define SOLVER_DEF MPS_DEF_ELASTIC
#define SOLVER_BOUNDARY MPS_DEF_ELASTIC_BOUNDARY
#define SOLVER_LOAD MPS_DEF_ELASTIC_LOAD
#define SOLVER_GRAVITY(s, account) (void)(account);
#define SOLVER_MOMENTUM true
#define SOLVER_COUNTS(s) true
#define SOLVER_DT(s) mps_elastic_dt(s)
API_SOLVER(elastic, API_ELASTIC)

enum { MOST = 128 }; /* particles or facets that arrays here have room for */

static void draw_def(api *a, mps_elastic_def *def) {
  *def = mps_elastic_defaults();
  def->struct_size = api_struct_size(a, sizeof *def);
  def->state = api_choice(a, "state", 2);
  if (a->dim == 3 && (def->state < 0 || def->state > 1)) a->wrong--; /* of the plane alone */
  def->solver = api_choice(a, "solver", 4);
  def->ordering = api_choice(a, "ordering", 3);
  def->alpha = api_real_or_nan(a, "alpha", 0.03, 100.0, 1.0);
  def->tolerance = api_real_or_nan(a, "tolerance", 1e-14, 1e-2, 1e-10);
  def->refinements = (int32_t)api_whole(a, "refinements", 0, 10);
  if (api_chance(a, 20)) def->memory_limit = api_optional(a, "memory_limit", 0.0, INFINITY, 1e5);
  if (api_chance(a, 20)) def->bending = api_optional(a, "bending", 0.0, 1.0, 0.5);
  if (api_chance(a, 20)) def->radius_ratio = api_optional(a, "radius_ratio", 1.001, 4.0, 1.5);
  if (a->wrong == 1 && def->radius_ratio > 1.0 && def->radius_ratio <= 1.001) a->wrong = 0;
  if (!a->latest && api_chance(a, 20)) def->material = api_maybe(a, API_MATERIAL, "material");
  if (!a->latest && api_chance(a, 5)) def->kernel = api_maybe(a, API_KERNEL, "kernel");
  if (def->kernel) a->wrong = 0;
  if (a->steady) def->blas_threads = 1; /* LLT has the bits of its number of them */
}

/* The scheme of direct solvers, and of conjugate gradients to many digits, has the energy of
 * rounding alone. */
static void made_elastic(api *a, mps_status status, const mps_elastic_def *def, mps_elastic *made) {
  const bool direct =
      def->solver == MPS_ELASTIC_SOLVER_LLT || def->solver == MPS_ELASTIC_SOLVER_LDLT;
  (void)api_end_made(a, status, API_ELASTIC, made, NULL);
  for (int k = 0; k < API_SLOTS; k++)
    if (made && a->objects[API_ELASTIC][k].handle == made)
      a->objects[API_ELASTIC][k].exact = direct || def->tolerance <= 1e-10;
}

static void create(api *a, bool published) {
  mps_elastic *made = NULL;
  mps_elastic_def def;
  mps_context *context = api_context(a);
  mps_particles *set = api_any(a, API_SET)->handle;
  draw_def(a, &def);
  mps_status status;
  if (published) {
    status =
        mps_experimental_elastic_published(context, set, &def, (int32_t)api_below(a, 2), &made);
  } else {
    const mps_elastic_def *given = a->wrong == 0 && api_chance(a, 5) ? NULL : &def;
    status = mps_elastic_create(context, set, given, api_null(a, "out") ? NULL : &made);
  }
  made_elastic(a, status, &def, made);
}

static void elastic_create(api *a) { create(a, false); }

static void experimental_published(api *a) { create(a, true); }

static void elastic_set_material(api *a) {
  int64_t ids[8] = {0};
  api_object *o = api_any(a, API_ELASTIC);
  mps_elastic *e = o->handle;
  o->drags = o->drags || !a->latest;
  mps_material *material = api_any(a, API_MATERIAL)->handle;
  const int64_t count = api_chance(a, 60) ? api_ids(a, mps_elastic_particles(e), 8, ids) : 0;
  (void)api_end(a, mps_elastic_set_material(e, material, count ? ids : NULL, count));
}

/* Ids of the particles in the lowest layer. */
static int64_t base(mps_particles *set, int64_t *ids) {
  double lo[3] = {-INFINITY, -INFINITY, -INFINITY}, hi[3] = {INFINITY, INFINITY, INFINITY};
  int64_t count = 0;
  const int last = mps_particles_dim(set) == 3 ? 2 : 1;
  hi[last] = 0.075;
  if (mps_particles_select_box(set, lo, hi, MOST, &count, ids) != MPS_OK || count > MOST) return 0;
  return count;
}

static void elastic_cut(api *a) {
  int64_t ids[MOST];
  mps_elastic *e = api_any(a, API_ELASTIC)->handle;
  mps_particles *set = mps_elastic_particles(e);
  const int32_t axis = mps_particles_dim(set) == 3 ? 2 : 1;
  int64_t count = base(set, ids);
  if (count == 0 || api_chance(a, 20)) count = api_ids(a, set, 4, ids);
  const int32_t side = api_chance(a, 80)
                           ? mps_side_of(axis, 0)
                           : (int32_t)api_whole(a, "side", 0, 2 * mps_particles_dim(set) - 1);
  api_say(a, "side = %d, %d ids, ", side, (int)count);
  (void)api_end(a, mps_elastic_cut(e, side, ids, count));
}

/* ---- boundaries and loads -------------------------------------------------------------------- */

static void draw_boundary(api *a, mps_elastic *e, mps_elastic_boundary_def *def, int64_t *ids,
                          double *values) {
  *def = mps_elastic_boundary_defaults();
  def->struct_size = api_struct_size(a, sizeof *def);
  mps_particles *set = mps_elastic_particles(e);
  def->ids = ids;
  def->id_count = a->latest || api_chance(a, 60) ? base(set, ids) : api_ids(a, set, 4, ids);
  if (!a->latest) {
    def->kind = api_choice(a, "kind", 3);
    if (def->kind != MPS_BOUNDARY_ROLLER)
      def->dofs = api_below(a, 4);
    else
      api_vector(a, "normal", 3, 0.0, 1.0, def->normal);
    if (a->wrong && def->kind == MPS_BOUNDARY_ROLLER && mps_particles_dim(set) == 2 &&
        !isfinite(def->normal[2]))
      a->wrong = 0;
    if (api_chance(a, 20)) {
      for (int64_t k = 0; k < 3 * def->id_count && k < 3 * MOST; k++) values[k] = 1e-4;
      def->values = values;
    }
    if (api_chance(a, 40)) def->signal[0] = api_signal(a, false);
  }
  api_say(a, "%d ids, ", (int)def->id_count);
}

static void elastic_add_boundary(api *a) {
  mps_elastic_boundary_def def;
  int64_t ids[MOST];
  double values[3 * MOST];
  int32_t number = -1;
  api_object *o = api_any(a, API_ELASTIC);
  mps_elastic *e = o->handle;
  o->drags = o->drags || !a->latest;
  draw_boundary(a, e, &def, ids, values);
  api_arm(a);
  (void)api_end(a, mps_elastic_add_boundary(e, api_null(a, "def") ? NULL : &def,
                                            api_chance(a, 80) ? &number : NULL));
}

static void elastic_set_boundary(api *a) {
  mps_elastic_boundary_def def;
  int64_t ids[MOST];
  double values[3 * MOST];
  api_object *o = api_any(a, API_ELASTIC);
  mps_elastic *e = o->handle;
  o->drags = o->drags || !a->latest;
  const int32_t number = (int32_t)api_least(a, "number", 0, 2);
  draw_boundary(a, e, &def, ids, values);
  api_arm(a);
  (void)api_end(a, mps_elastic_set_boundary(e, number, &def));
}

static void draw_load(api *a, mps_elastic *e, mps_elastic_load_def *def, int64_t *ids) {
  *def = mps_elastic_load_defaults();
  def->struct_size = api_struct_size(a, sizeof *def);
  def->kind = api_choice(a, "kind", 6);
  const int64_t facets = mps_elastic_facet_count(e);
  if (def->kind == MPS_ELASTIC_LOAD_FORCE) {
    def->id_count = api_ids(a, mps_elastic_particles(e), 4, ids);
  } else if (def->kind >= MPS_ELASTIC_LOAD_TRACTION && def->kind <= MPS_ELASTIC_LOAD_FUNCTION) {
    def->id_count = 1 + api_below(a, 3);
    for (int k = 0; k < 3; k++) ids[k] = facets > 0 ? (int64_t)api_below(a, (uint32_t)facets) : 0;
    if (a->mood == API_ABSURD && api_chance(a, 10)) ids[0] = facets, api_wrong(a, "ids");
  }
  def->ids = def->id_count ? ids : NULL;
  def->all = !def->ids;
  api_vector(a, "force", mps_particles_dim(mps_elastic_particles(e)), 0.0, 100.0, def->force);
  if (def->kind >= MPS_ELASTIC_LOAD_PRESSURE && a->wrong == 1) a->wrong = 0;
  if (def->kind == MPS_ELASTIC_LOAD_FUNCTION) def->function = api_traction, def->user = &a->plan;
  if (api_chance(a, 40)) def->signal[0] = api_signal(a, true);
}

static void elastic_add_load(api *a) {
  mps_elastic_load_def def;
  int64_t ids[8] = {0};
  int32_t number = -1;
  mps_elastic *e = api_any(a, API_ELASTIC)->handle;
  draw_load(a, e, &def, ids);
  api_arm(a);
  (void)api_end(a, mps_elastic_add_load(e, api_null(a, "def") ? NULL : &def, &number));
}

static void elastic_set_load(api *a) {
  mps_elastic_load_def def;
  int64_t ids[8] = {0};
  mps_elastic *e = api_any(a, API_ELASTIC)->handle;
  const int32_t number = (int32_t)api_least(a, "number", 0, 2);
  draw_load(a, e, &def, ids);
  api_arm(a);
  (void)api_end(a, mps_elastic_set_load(e, number, &def));
}

static void elastic_load_resultant(api *a) {
  double about[3] = {0}, force[3] = {0}, moment[3] = {0};
  api_object *o = api_any(a, API_ELASTIC);
  api_vector(a, "about", 3, 0.0, 1.0, about);
  if (a->wrong == 1 && !isfinite(about[2]) && isfinite(about[0] + about[1])) a->wrong = !o->handle;
  api_run_solver(a, API_ELASTIC, o);
  const mps_status status =
      mps_elastic_get_load_resultant(o->handle, about, force, api_chance(a, 80) ? moment : NULL);
  if (status == MPS_OK && !isfinite(force[0] + force[1] + force[2])) api_broken(a, "not finite");
  a->reads = true;
  (void)api_end(a, status);
}

/* ---- facets ---------------------------------------------------------------------------------- */

API_QUERY(elastic_facet_count, API_ELASTIC)

static void elastic_select_facets(api *a) {
  int64_t facets[MOST + 1], count = -1;
  const mps_elastic *e = api_any(a, API_ELASTIC)->handle;
  const int32_t side = (int32_t)api_whole(a, "side", MPS_SIDE_ANY, 2 * a->dim - 1);
  if (a->wrong == 1 && side >= 4 && side <= 5) a->wrong = !e; /* of a scene in space */
  int64_t capacity = (int64_t)api_below(a, MOST);
  if (a->mood == API_ABSURD && api_chance(a, 20)) capacity = -1, api_wrong(a, "capacity");
  facets[capacity < 0 ? 0 : capacity] = -7;
  const mps_status status =
      mps_elastic_select_facets(e, side, NULL, NULL, capacity, &count, facets);
  if (facets[capacity < 0 ? 0 : capacity] != -7) api_broken(a, "writes behind the capacity");
  a->reads = true;
  (void)api_end(a, status);
}

static void elastic_get_facets_sized(api *a) {
  int64_t particle[4];
  double centre[12], normal[12], extent[12], area[4], displacement[12], velocity[12];
  mps_elastic *e = api_any(a, API_ELASTIC)->handle;
  const mps_elastic_facet_arrays arrays = {
      particle, centre, normal, extent, area, api_chance(a, 80) ? displacement : NULL, velocity};
  int64_t facets[4];
  const int64_t count = api_least(a, "count", 0, 4);
  const int64_t all = mps_elastic_facet_count(e);
  for (int k = 0; k < 4; k++) facets[k] = all > 0 ? (int64_t)api_below(a, (uint32_t)all) : 0;
  if (a->mood == API_ABSURD && count > 0 && api_chance(a, 20))
    facets[0] = -1, api_wrong(a, "facet");
  const mps_status status = mps_elastic_get_facets_sized(e, facets, count, &arrays,
                                                         api_chance(a, 90) ? sizeof arrays : 8);
  a->reads = true;
  (void)api_end(a, status);
}

/* ---- solutions ------------------------------------------------------------------------------- */

static void elastic_analyse_sized(api *a) {
  mps_elastic *e = api_any(a, API_ELASTIC)->handle;
  API_SIZED(a, mps_elastic_estimate, size, out);
  const mps_status status = mps_elastic_analyse_sized(e, out, size);
  API_SIZED_END(a, status, size, out, false);
}

static void elastic_solve(api *a) {
  api_object *o = api_any(a, API_ELASTIC);
  api_run_solver(a, API_ELASTIC, o);
  a->change = API_CHANGES_ORDER; /* edited moduli are read before the solution */
  (void)api_end(a, mps_elastic_solve(o->handle));
}

static void elastic_solve_cases(api *a) {
  static double loads[2 * 3 * MOST], displacements[2 * 3 * MOST];
  api_object *o = api_any(a, API_ELASTIC);
  const int64_t n = mps_particles_count(mps_elastic_particles(o->handle));
  const int64_t count = n > MOST ? 0 : api_least(a, "count", n > 0 ? 0 : 1, 2);
  for (int k = 0; k < 2 * 3 * MOST; k++) loads[k] = 1.0 - 0.01 * k;
  if (a->mood == API_ABSURD && n > 0 && api_chance(a, 20)) loads[0] = NAN;
  api_run_solver(a, API_ELASTIC, o);
  a->change = API_CHANGES_ORDER; /* edited moduli are read before the solution */
  const mps_status status = mps_elastic_solve_cases(o->handle, count, loads, displacements);
  for (int64_t k = 0; status == MPS_OK && k < 3 * n * count; k++)
    if (!isfinite(displacements[k]))
      api_broken(a, "succeeds, and a displacement is %g", displacements[k]);
  a->reads = true;
  (void)api_end(a, status);
}

API_GETTER(elastic_get_report_sized, mps_elastic_get_report_sized, API_ELASTIC, mps_elastic,
           mps_elastic_report)

static void elastic_stress(api *a) {
  (void)api_end(a, mps_elastic_update_stress(api_any(a, API_ELASTIC)->handle));
}

static void elastic_section(api *a) {
  double force[3] = {0}, moment[3] = {0};
  api_object *o = api_any(a, API_ELASTIC);
  const int32_t axis = (int32_t)api_whole(a, "axis", 0, a->dim - 1);
  if (a->wrong == 1 && axis == 2) a->wrong = !o->handle;
  const double position = api_near(a, "position", 0.2, 0.2);
  if (isinf(position)) a->wrong = axis < 0 || axis > 2 || !o->handle;
  const mps_status status = mps_elastic_get_section(o->handle, axis, position, NULL, force, moment);
  if (status == MPS_OK && !isfinite(force[0] + moment[2])) api_broken(a, "not finite");
  a->reads = true;
  (void)api_end(a, status);
}

static void elastic_modes(api *a) {
  static double omega[4], shapes[4 * 3 * MOST];
  api_object *o = api_any(a, API_ELASTIC);
  const bool room = mps_particles_count(mps_elastic_particles(o->handle)) <= MOST;
  int32_t count = (int32_t)api_least(a, "count", 1, 4);
  if (a->mood == API_ABSURD && api_chance(a, 10)) count = 100000, api_wrong(a, "count");
  api_run_solver(a, API_ELASTIC, o);
  const mps_status status =
      mps_elastic_modes(o->handle, count, omega, room && api_chance(a, 50) ? shapes : NULL);
  for (int k = 0; status == MPS_OK && k < count; k++)
    if (!isfinite(omega[k])) api_broken(a, "omega %g", omega[k]);
  a->reads = false; /* the masses are read */
  (void)api_end(a, status);
}

static void elastic_start(api *a) {
  api_object *o = api_any(a, API_ELASTIC);
  mps_elastic_motion_def def = mps_elastic_motion_defaults();
  api_define(a, MPS_DEF_ELASTIC_MOTION, &def, 0,
             "dt 1e-3, rho_inf 1, mass_damping? 1, stiffness_damping? 1e-4, time 0");
  /* momenta are those of forces at both ends of a step, with Newmark's average acceleration */
  o->drags = o->drags || def.rho_inf != 1.0 || def.mass_damping != 0.0;
  o->exact = o->exact && def.rho_inf == 1.0 && def.stiffness_damping == 0.0;
  api_run_solver(a, API_ELASTIC, o);
  (void)api_end(a, mps_elastic_start(o->handle, api_null(a, "def") ? NULL : &def));
}

static void elastic_set_linear_solver(api *a) {
  api_object *o = api_any(a, API_ELASTIC);
  o->exact = false;
  api_set_linear_solver(a, mps_elastic_solver(o->handle), MPS_LINEAR_EQUATION_STIFFNESS);
}

static const api_call calls[] = {
    API_SOLVER_CALLS(elastic, API_ELASTIC),
    {"mps_elastic_create", 5, API_SET, elastic_create},
    {"mps_experimental_elastic_published", 1, API_SET, experimental_published},
    {"mps_elastic_set_material", 2, API_ELASTIC, elastic_set_material},
    {"mps_elastic_cut", 2, API_ELASTIC, elastic_cut},
    {"mps_elastic_add_boundary", 3, API_ELASTIC, elastic_add_boundary},
    {"mps_elastic_set_boundary", 2, API_ELASTIC, elastic_set_boundary},
    {"mps_elastic_add_load", 4, API_ELASTIC, elastic_add_load},
    {"mps_elastic_set_load", 2, API_ELASTIC, elastic_set_load},
    {"mps_elastic_get_load_resultant", 2, API_ELASTIC, elastic_load_resultant},
    {"mps_elastic_facet_count", 1, API_ELASTIC, query_elastic_facet_count},
    {"mps_elastic_select_facets", 1, API_ELASTIC, elastic_select_facets},
    {"mps_elastic_get_facets_sized", 2, API_ELASTIC, elastic_get_facets_sized},
    {"mps_elastic_analyse_sized", 2, API_ELASTIC, elastic_analyse_sized},
    {"mps_elastic_solve", 6, API_ELASTIC, elastic_solve},
    {"mps_elastic_solve_cases", 2, API_ELASTIC, elastic_solve_cases},
    {"mps_elastic_get_report_sized", 1, API_ELASTIC, elastic_get_report_sized},
    {"mps_elastic_update_stress", 3, API_ELASTIC, elastic_stress},
    {"mps_elastic_get_section", 1, API_ELASTIC, elastic_section},
    {"mps_elastic_modes", 1, API_ELASTIC, elastic_modes},
    {"mps_elastic_start", 6, API_ELASTIC, elastic_start},
    {"mps_solver_set_linear_solver", 1, API_ELASTIC, elastic_set_linear_solver},
};
const api_table api_elastic_calls = API_TABLE(calls);
