/* test_domain_pore_water.c - water in the pores on several ranks: every particle, what has drained
 * and the budget have the bits of the run without a domain, whatever the number of ranks and
 * threads; so has a run that was cut in two and continues on another number of ranks. An error of
 * one rank is an error of all. SPDX-License-Identifier: BSD-3-Clause */
#include "mpm_ranks.h"
#include "ranks_team.h"

/* Ground that falls on a corner, so that its surface crosses cells: layers in the plane, a body
 * that goes into it, a ring and a block in space; a finer one has a coarse equation with implicit
 * pressures. */
enum { LAYERS, SETTLED, AROUND, BLOCK, FINE_BLOCK, UNDRAINED, KINDS };
enum { IMPLICIT = KINDS }; /* to add to these: pressures are implicit */

static bool in_space(int kind) { return kind == BLOCK || kind == FINE_BLOCK; }
static int dim_here(int kind) { return in_space(kind) ? 3 : 2; }

static mps_mpm_def ground_def(mps_domain *domain, int kind) {
  DEF(mpm, def, .domain = domain,
      .geometry = kind == AROUND   ? MPS_MPM_GEOMETRY_AXISYMMETRIC
                  : in_space(kind) ? MPS_MPM_GEOMETRY_SPACE
                                   : MPS_MPM_GEOMETRY_PLANE_STRAIN,
      .spline = kind == UNDRAINED ? 2 : 3,
      .cell = kind == BLOCK        ? 0.08
              : kind == FINE_BLOCK ? 0.062
                                   : 0.04,
      .gravity[1] = -9.81);
  if (kind == SETTLED || kind == UNDRAINED) def.flip_time = 0.02;
  for (int c = 0; c < dim_here(kind); c++) def.lower[c] = 0.0;
  return def;
}

static mps_status make_ground(mps_context *own, int kind, mps_particles **out) {
  const double lo[3] = {kind == AROUND ? 0.0 : 0.03, 0.01, 0.03};
  const double hi[3] = {in_space(kind) ? 0.83 : 1.13, 0.57, 0.75};
  mps_view x;
  mps_edit v, k_of;
  DEF(particles, def, .dim = dim_here(kind),
      .spacing = in_space(kind) ? 0.5 * ground_def(NULL, kind).cell : 0.02);
  mps_status status = mps_particles_create(own, &def, out);
  TRY(mps_particles_fill_box(*out, lo, hi, NULL));
  TRY(mps_particles_set(*out, "density", 0, 1900.0));
  TRY(mps_particles_set(*out, "velocity", 0, 0.0));
  if (kind != UNDRAINED) TRY(mps_particles_add_field(*out, "permeability", 0));
  TRY(mps_particles_view(*out, "position", &x));
  TRY(mps_particles_edit(*out, "velocity", &v));
  for (int64_t k = 0; status == MPS_OK && k < mps_particles_count(*out); k++) {
    *mps_edit_f64(&v, k, 0) = *mps_view_f64(&x, k, 0) * cos(5.0 * *mps_view_f64(&x, k, 1));
    *mps_edit_f64(&v, k, 1) = -2.0 + sin(4.0 * *mps_view_f64(&x, k, 0));
  }
  TRY(mps_particles_commit(*out, &v));
  if (kind == UNDRAINED) return status;
  TRY(mps_particles_edit(*out, "permeability", &k_of));
  for (int64_t k = 0; status == MPS_OK && k < mps_particles_count(*out); k++)
    *mps_edit_f64(&k_of, k, 0) = *mps_view_f64(&x, k, 1) < 0.3 ? 1e-3 : 1e-5;
  TRY(mps_particles_commit(*out, &k_of));
  return status;
}

static mps_status add_water(mps_mpm *mpm, int kind, bool implicit) {
  DEF(pore_water, def, .porosity = 0.4);
  const double level[3] = {0.0, 0.4, 0.0};
  if (implicit) def.scheme = MPS_PORE_SCHEME_IMPLICIT;
  if (kind != UNDRAINED) def.exponent = 2.0, def.ratio_slope = 0.5;
  DEF(pore_face, face, .kind = MPS_PORE_FACE_DRAINED, .sides = 1u << MPS_SIDE_Y_LOWER,
      .pressure = 3e3, .at_rest = 1, .upper[0] = 0.5);
  mps_status status = mps_mpm_add_pore_water(mpm, &def);
  TRY(mps_mpm_add_pore_face(mpm, &face, NULL));
  TRY(mps_mpm_set_pore_level(mpm, level));
  return status;
}

static mps_status add_disc(mps_context *own, mps_domain *domain, scene *s) {
  DEF(body, body, .position[0] = 0.6, .position[1] = 0.7);
  WITH_DEFAULTS(mps_body_motion, motion, .velocity[1] = -3.0);
  DEF(contact, contact, .friction = 0.3);
  mps_status status = mps_body_create_disc(own, &body, 0.1, &s->body[0]);
  TRY(mps_body_set_motion(s->body[0], &motion));
  if (domain) status = mps_domain_agree(domain, status);
  TRY(mps_mpm_add_contact(s->mpm, s->body[0], &contact, &s->contact[0]));
  return status;
}

static mps_status make_wet(mps_context *own, mps_domain *domain, int what, scene *s) {
  const int kind = what % IMPLICIT;
  const mps_mpm_def def = ground_def(domain, kind);
  mps_status status = make_ground(own, kind, &s->set);
  TRY(mps_material_create_linear_elastic(own, 2e5, 0.3, &s->material[0]));
  if (domain) status = mps_domain_agree(domain, status);
  TRY(mps_mpm_create(own, s->set, s->material[0], &def, &s->mpm));
  TRY(add_water(s->mpm, kind, what >= IMPLICIT));
  if (status == MPS_OK && kind == SETTLED) /* friction of the effective stress, at both */
    status = mps_mpm_set_side(s->mpm, MPS_SIDE_Y_LOWER, MPS_BOUNDARY_FRICTIONAL, 0.3);
  if (status == MPS_OK && kind == SETTLED) status = add_disc(own, domain, s);
  return status;
}

/* Also what the faces have let out. */
static mps_status keep_wet(mps_domain *domain, scene *s, result *r) {
  mps_pore_budget budget = {0};
  mps_status status = mps_mpm_get_totals(s->mpm, &r->totals);
  TRY(mps_mpm_get_pore_budget(s->mpm, &budget));
  memcpy(r->other, &budget, sizeof budget);
  TRY(mps_mpm_get_pore_flow(s->mpm, -1, r->other + 10, r->other + 11));
  TRY(mps_mpm_get_pore_flow(s->mpm, 0, r->other + 12, r->other + 13));
  TRY(keep_order(domain, s->set, r));
  r->dt = mps_mpm_dt(s->mpm), r->limit = mps_mpm_limit(s->mpm), r->time = mps_mpm_time(s->mpm);
  TRY(keep(s->set, r));
  return status;
}

/* With a step back in time on the way. */
static mps_status compute_wet(mps_context *own, mps_domain *domain, int what, int64_t steps,
                              result *r) {
  SCOPED(end_scene) scene s = {.set = NULL};
  mps_snapshot *then = NULL;
  mps_status status = make_wet(own, domain, what, &s);
  r->first = s.set ? mps_particles_count(s.set) : 0;
  TRY(mps_mpm_step(s.mpm, steps / 2));
  TRY(mps_mpm_snapshot(s.mpm, &then));
  TRY(mps_mpm_step(s.mpm, 5));
  TRY(mps_mpm_rollback(s.mpm, then));
  TRY(mps_mpm_step(s.mpm, steps - steps / 2));
  mps_snapshot_destroy(&then);
  TRY(keep_wet(domain, &s, r));
  mps_pore_report report = {0};
  TRY(mps_mpm_get_pore_report(s.mpm, &report));
  if (status == MPS_OK && (what == IMPLICIT + FINE_BLOCK || what == IMPLICIT + LAYERS) &&
      report.coarse < 16)
    status = MPS_ERROR_INTERNAL; /* with a coarse equation */
  if (status == MPS_OK && what % IMPLICIT != UNDRAINED &&
      (r->other[11] == 0.0 || r->other[13] == 0.0))
    status = MPS_ERROR_INTERNAL; /* water goes through both */
  return status;
}

TEST(test_layers) { compare_teams(compute_wet, LAYERS, 80, false); }
TEST(test_settled) { compare_teams(compute_wet, SETTLED, 60, true); }
TEST(test_around) { compare_teams(compute_wet, AROUND, 60, true); }
TEST(test_block) { compare_teams(compute_wet, BLOCK, 40, true); }
TEST(test_undrained) { compare_teams(compute_wet, UNDRAINED, 60, true); }

TEST(test_implicit_layers) { compare_teams(compute_wet, IMPLICIT + LAYERS, 24, false); }
TEST(test_implicit_settled) { compare_teams(compute_wet, IMPLICIT + SETTLED, 16, true); }
TEST(test_implicit_around) { compare_teams(compute_wet, IMPLICIT + AROUND, 16, true); }
TEST(test_implicit_block) { compare_teams(compute_wet, IMPLICIT + BLOCK, 8, true); }
TEST(test_implicit_fine_block) { compare_teams(compute_wet, IMPLICIT + FINE_BLOCK, 4, true); }
TEST(test_implicit_undrained) { compare_teams(compute_wet, IMPLICIT + UNDRAINED, 16, true); }

/* ---- cut in two ------------------------------------------------------------------------------ */

#define CHECKPOINT "test_domain_pore_water.h5"

static mps_status halve(mps_context *own, mps_domain *domain, int what, int64_t steps,
                        const char *from, const char *to, result *r) {
  SCOPED(end_scene) scene s = {.set = NULL};
  mps_status status = make_wet(own, domain, what, &s);
  if (from) TRY(mps_mpm_restore(s.mpm, from, NULL));
  TRY(mps_mpm_step(s.mpm, steps));
  if (to) TRY(mps_mpm_save(s.mpm, to, NULL));
  TRY(keep_wet(domain, &s, r));
  return status;
}

static mps_status begin(mps_context *own, mps_domain *domain, int what, int64_t steps, result *r) {
  return halve(own, domain, what, steps, NULL, CHECKPOINT, r);
}

static mps_status go_on(mps_context *own, mps_domain *domain, int what, int64_t steps, result *r) {
  return halve(own, domain, what, steps, CHECKPOINT, NULL, r);
}

/* Written on 4 ranks, a run continues with the bits of one that was not cut, on 3 and without a
 * domain; written without a domain, on 3. */
static void cut(int what, int64_t steps) {
  result half = {0}, whole = {0}, on = {0};
  mps_context *own = test_context(MPS_CONTEXT_EXECUTOR_SERIAL, 1);
  OK(halve(own, NULL, what, 2 * steps, NULL, NULL, &whole));
  OK(begin(own, NULL, what, steps, &half));
  compare_part(go_on, 3, what, steps, &whole, false);
  remove(CHECKPOINT);
  compare_part(begin, 4, what, steps, &half, false);
  compare_part(go_on, 3, what, steps, &whole, false);
  OK(go_on(own, NULL, what, steps, &on));
  int64_t *seen = calloc((size_t)whole.count + 1, sizeof *seen);
  compare(&whole, &on, seen);
  free(seen);
  drop(&half), drop(&whole), drop(&on);
  mps_context_destroy(&own);
  remove(CHECKPOINT);
}

TEST(test_cut) {
  if (!mps_library_has(MPS_FEATURE_HDF5)) skip();
  cut(LAYERS, 40);
  cut(IMPLICIT + LAYERS, 8);
}

/* ---- what goes wrong on one rank ------------------------------------------------------------- */

TEST(test_refused_memory) {
  refuse_memory(compute_wet, LAYERS, 8, 9);
  refuse_memory(compute_wet, IMPLICIT + LAYERS, 6, 9);
}

#define WATER_TROUBLES(ROW)                                                                        \
  ROW(OTHER_BULK, MPS_ERROR_ARGUMENT, "bulk is ")                                                  \
  ROW(BAD_POROSITY, MPS_ERROR_ARGUMENT, "rank 1: porosity is -1")                                  \
  ROW(OTHER_FACE, MPS_ERROR_ARGUMENT, "pressure is ")                                              \
  ROW(OTHER_LEVEL, MPS_ERROR_ARGUMENT, "point is ")                                                \
  ROW(OTHER_NUMBER, MPS_ERROR_ARGUMENT, "number is ")                                              \
  ROW(OTHER_SCHEME, MPS_ERROR_ARGUMENT, "scheme is ")                                              \
  ROW(NO_SOLUTION, MPS_ERROR_NUMERIC, "has the residual 1 of the right side")                      \
  ROW(NO_FORGETTING, MPS_ERROR_CANCELLED, "rank 1: ")
enum { WATER_TROUBLES(CASE_NAME) TROUBLES };

static const trouble_case trouble[TROUBLES] = {WATER_TROUBLES(CASE_ROW)};

/* ---- a solver of the caller that cannot forget, on one rank ---------------------------------- */

static mps_status take_nothing(void *user, const mps_linear_matrix *matrix) { return MPS_OK; }

static mps_status solve_nothing(void *user, const double *b, double tolerance, double *x,
                                mps_linear_result *out) {
  return MPS_OK;
}

static mps_status forget(void *user) {
  const int32_t *rank = user;
  return *rank == 1 ? MPS_ERROR_CANCELLED : MPS_OK;
}

static mps_status set_linear(mps_mpm *mpm, mps_domain *domain, mps_linear_forget_fn forgets,
                             int32_t *rank) {
  DEF(linear_solver, def, .rank = mps_domain_rank(domain), .ranks = mps_domain_size(domain),
      .user = rank, .matrix = take_nothing, .solve = solve_nothing, .forget = forgets);
  return mps_solver_set_linear_solver(mps_mpm_solver(mpm), MPS_LINEAR_EQUATION_PORE_PRESSURE, &def);
}

/* A rollback that one rank refuses is refused on all. */
static mps_status go_back(mps_mpm *mpm, mps_domain *domain, int32_t *rank) {
  scoped_snapshot *then = NULL;
  mps_status status = mps_mpm_snapshot(mpm, &then);
  TRY(set_linear(mpm, domain, forget, rank));
  TRY(mps_mpm_rollback(mpm, then));
  return status;
}

static mps_status run_trouble(mps_context *own, mps_domain *domain, int what, int32_t rank) {
  SCOPED(end_scene) scene s = {.set = NULL};
  const double level[2] = {0.0, what == OTHER_LEVEL ? 0.1 * rank : 0.4};
  const mps_mpm_def solver = ground_def(domain, LAYERS);
  double mass;
  mps_status status = make_ground(own, LAYERS, &s.set);
  TRY(mps_material_create_linear_elastic(own, 2e5, 0.3, &s.material[0]));
  status = mps_domain_agree(domain, status);
  TRY(mps_mpm_create(own, s.set, s.material[0], &solver, &s.mpm));
  TRY(mps_particles_set(s.set, "permeability", 0, 1e-4));
  DEF(pore_water, def, .porosity = what == BAD_POROSITY && rank == 1 ? -1.0 : 0.4);
  if (what == NO_SOLUTION || (what == OTHER_SCHEME && rank == 1))
    def.scheme = MPS_PORE_SCHEME_IMPLICIT;
  if (what == OTHER_BULK) def.bulk = 1e7 * (1 + rank);
  DEF(pore_face, face, .kind = MPS_PORE_FACE_DRAINED, .pressure = what == OTHER_FACE ? rank : 0.0);
  TRY(mps_mpm_add_pore_water(s.mpm, &def));
  TRY(mps_mpm_add_pore_face(s.mpm, &face, NULL));
  TRY(mps_mpm_set_pore_level(s.mpm, level));
  if (what == NO_SOLUTION) TRY(set_linear(s.mpm, domain, NULL, NULL));
  if (what == NO_SOLUTION) TRY(mps_mpm_step(s.mpm, 2));
  if (what == NO_FORGETTING) TRY(go_back(s.mpm, domain, &rank));
  TRY(mps_mpm_get_pore_flow(s.mpm, what == OTHER_NUMBER && rank == 2 ? 0 : -1, NULL, &mass));
  return status;
}

TEST(test_trouble) { meet_troubles(run_trouble, trouble, TROUBLES); }
