/* mpm_ranks.h - WLS-MPM on several ranks: bodies that move through the grid, and what each rank
 * ends with. SPDX-License-Identifier: BSD-3-Clause */
#ifndef MPS_TEST_MPM_RANKS_H
#define MPS_TEST_MPM_RANKS_H

#include "ranks_result.h"

enum { SLIDE, SPREAD, RING, ROOM, WIDE, PRESS, CONE, BALLS, PLATES, PILES, SCENES };
enum { BODIES = 3 }; /* at most, of PRESS and what follows */

typedef struct scene {
  mps_particles *set;
  mps_material *material[2];
  mps_mpm *mpm;
  mps_body *body[BODIES];
  mps_contact *contact[BODIES];
} scene;

static inline int dim_of(int what) { return what == ROOM || what == BALLS ? 3 : 2; }

/* Whether the scenes' sets lie in parts on the ranks from the first on. */
#ifndef RANKS_IN_PARTS
#define RANKS_IN_PARTS false
#endif

/* `domain` NULL: all of it here. */
static inline mps_status make_set(mps_context *own, mps_domain *domain, int what,
                                  mps_particles **out) {
  const bool space = dim_of(what) == 3, touched = what >= PRESS;
  DEF(particles, def, .dim = dim_of(what), .spacing = space ? 0.04 : what == WIDE ? 0.01 : 0.02);
  mps_status status = domain ? mps_domain_create_particles(domain, &def, out)
                             : mps_particles_create(own, &def, out);
  TRY(mps_particles_fill_box(*out, AT(0.0, 0.0, 0.0),
                             AT(1.2,
                                touched ? 0.4
                                : space ? 0.6
                                        : 0.8,
                                0.8),
                             NULL));
  TRY(mps_particles_set(*out, "density", 0, 1800.0));
  TRY(mps_particles_set(*out, "velocity", 0, 0.0));
  mps_view x;
  mps_edit v;
  TRY(mps_particles_view(*out, "position", &x));
  TRY(mps_particles_edit(*out, "velocity", &v));
  for (int64_t k = 0; status == MPS_OK && k < mps_particles_count(*out); k++)
    for (int c = 0; c < dim_of(what); c++) {
      const bool ring = what == RING || what == CONE; /* r = 0 stays */
      const double first = ring ? 0.0 : touched ? 3.0 : 6.0;
      *mps_edit_f64(&v, k, c) =
          c == 0 ? first + 2.0 * *mps_view_f64(&x, k, 0) * cos(5.0 * *mps_view_f64(&x, k, 1))
                 : (touched ? 0.5 : 1.0) * (1.0 + 2.0 * cos(4.0 * *mps_view_f64(&x, k, 0)));
    }
  TRY(mps_particles_commit(*out, &v));
  return status;
}

/* Plastic in part of it. */
static inline mps_status add_soil(mps_context *own, mps_domain *domain, scene *s) {
  DEF(material_drucker_prager, law, .young = 2e6, .poisson = 0.25, .friction = 0.5,
      .cohesion = 2e3);
  mps_status status = mps_material_create_drucker_prager(own, &law, &s->material[1]);
  int64_t ids[900];
  for (int64_t k = 0; k < 900; k++) ids[k] = 100 + k;
  if (domain) status = mps_domain_agree(domain, status);
  TRY(mps_mpm_set_material(s->mpm, s->material[1], ids, 900));
  return status;
}

static inline mps_status swing(void *user, double t, double motion[3]) {
  (void)user;
  motion[0] = 1e-2 * sin(50.0 * t);
  motion[1] = 0.5 * cos(50.0 * t);
  motion[2] = -25.0 * sin(50.0 * t);
  return MPS_OK;
}

/* A frictional floor, an open or fixed end, a box and particles that are driven, a load. */
static inline mps_status add_conditions(mps_context *own, mps_domain *domain, int what, scene *s) {
  const int64_t ids[5] = {7, 1203, 44, 900, 1101}, loaded[4] = {350, 351, 352, 1190};
  scoped_signal *signal = NULL, *factor = NULL;
  int32_t number;
  mps_status status =
      mps_signal_create_user(own, MPS_SIGNAL_QUANTITY_DISPLACEMENT, swing, NULL, NULL, &signal);
  TRY(mps_signal_create_user(own, MPS_SIGNAL_QUANTITY_VALUE, swing, NULL, NULL, &factor));
  if (domain) status = mps_domain_agree(domain, status);
  TRY(mps_mpm_set_side(s->mpm, MPS_SIDE_Y_LOWER, MPS_BOUNDARY_FRICTIONAL, 0.3));
  TRY(mps_mpm_set_side(s->mpm, MPS_SIDE_X_UPPER,
                       what == SPREAD ? MPS_BOUNDARY_OPEN : MPS_BOUNDARY_HELD, 0.0));
  if (what == SPREAD || what == ROOM) {
    DEF(mpm_boundary, side, .kind = MPS_BOUNDARY_ABSORBING);
    /* R contains what stops the ground while the side is held: less of it the longer that is */
    side.settle = what == SPREAD ? 1e-2 : 0.0;
    TRY(mps_mpm_set_boundary(s->mpm, MPS_SIDE_X_LOWER, &side));
    if (what == ROOM) TRY(mps_mpm_set_boundary(s->mpm, MPS_SIDE_Z_LOWER, &side));
  }
  DEF(mpm_boundary, box, .lower[0] = 0.55, .upper[0] = 0.66, .lower[1] = 0.3, .upper[1] = 0.5,
      .dofs = MPS_DOF_Y, .kind = MPS_BOUNDARY_DRIVEN, .signal[1] = signal);
  TRY(mps_mpm_add_boundary(s->mpm, &box, &number));
  DEF(mpm_boundary, driven, .ids = ids, .id_count = 5, .kind = MPS_BOUNDARY_DRIVEN,
      .signal[0] = signal);
  TRY(mps_mpm_add_boundary(s->mpm, &driven, &number));
  DEF(mpm_load, load, .ids = loaded, .id_count = 4, .traction[0] = 3e4, .traction[1] = -1e4,
      .signal[1] = factor);
  TRY(mps_mpm_add_load(s->mpm, &load, &number));
  return status;
}

static inline mps_mpm_def scene_def(mps_domain *domain, int what) {
  DEF(mpm, def, .domain = domain);
  const bool space = dim_of(what) == 3;
  def.geometry = what == RING || what == CONE ? MPS_MPM_GEOMETRY_AXISYMMETRIC
                 : space                      ? MPS_MPM_GEOMETRY_SPACE
                                              : MPS_MPM_GEOMETRY_PLANE_STRAIN;
  def.spline = space ? 2 : 3;
  def.cell = space ? 0.08 : what == WIDE ? 0.02 : 0.04;
  for (int c = 0; c < 3; c++) def.lower[c] = 0.0;
  def.upper[0] = what == SPREAD ? 1.28 : 2.4;
  def.gravity[1] = -9.81;
  if (what == SLIDE) def.dt = 1e-4;
  if (what == SPREAD) def.edge = MPS_MPM_EDGE_FIT, def.viscous_damping = 0.5;
  if (what == RING) def.local_damping = 0.1;
  if (what == RING || what == PLATES) def.flip_time = 2e-3;
  def.budget = what == RING || what == PRESS || what == PLATES;
  if (what == PRESS || what == ROOM || what == RING) def.volumetric = MPS_MPM_VOLUMETRIC_CELL;
  if (what == PLATES) def.volumetric = MPS_MPM_VOLUMETRIC_NODES;
  return def;
}

/* A free one that spins and rolls, and two that are driven into the soil; or (PILES) three driven
 * ones far apart. */
static inline mps_body_def body_def(int what, int number) {
  static const double place[SCENES][BODIES][3] = {
      [PRESS] = {{0.5, 0.531}, {0.95, 0.51}, {1.22, 0.0}},
      [CONE] = {{0.0, 0.42}, {0.6, 0.51}},
      [PILES] = {{0.15, 0.51}, {0.6, 0.52}, {1.05, 0.515}},
      [PLATES] = {{0.35, 0.43}, {0.8, 0.41}, {1.22, 0.0}},
      [BALLS] = {{0.4, 0.541, 0.4}, {0.9, 0.52, 0.2}, {0.85, 0.56, 0.62}}};
  mps_body_def def = mps_body_defaults();
  memcpy(def.position, place[what][number], sizeof def.position);
  if (number > 0 || what == CONE || what == PILES) return def;
  def.motion = MPS_BODY_MOTION_FREE;
  def.mass = 40.0;
  for (int c = dim_of(what) == 2 ? 2 : 0; c < 3; c++) def.inertia[c] = 0.3;
  def.velocity[0] = 1.0, def.velocity[1] = -2.0;
  def.spin[2] = 20.0;
  def.gravity[1] = -9.81;
  return def;
}

static inline mps_status make_body(mps_context *own, int what, int number, mps_body **out) {
  static const double cone[6] = {0.0, 0.0, 0.15, 0.25, 0.0, 0.25}, wall[2] = {-1.0, 0.2};
  static const double pile[8] = {0.0, -0.2, 0.1, -0.1, 0.1, 0.2, 0.0, 0.2};
  const mps_body_def def = body_def(what, number);
  if (what == BALLS)
    return number == 0   ? mps_body_create_sphere(own, &def, 0.12, out)
           : number == 1 ? mps_body_create_revolution(own, &def, 4, pile, out)
                         : mps_body_create_sphere(own, &def, 0.15, out);
  if (what == PILES) return mps_body_create_box(own, &def, 0.12, 0.2, out);
  if (number == 1)
    return mps_body_create_box(own, &def, what == PLATES ? 0.06 : 0.2, what == PLATES ? 0.4 : 0.2,
                               out);
  if (what == CONE) return mps_body_create_polygon(own, &def, 3, cone, out);
  if (what == PLATES && number == 0) return mps_body_create_box(own, &def, 0.05, 0.5, out);
  return number == 0 ? mps_body_create_disc(own, &def, 0.12, out)
                     : mps_body_create_half_plane(own, &def, wall, out);
}

/* Friction that grows within the steps of a test. */
static inline mps_status make_rise(mps_context *own, mps_signal **out) {
  const double t[2] = {0.0, 0.02}, v[2] = {0.8, 1.4};
  return mps_signal_create_table(own, MPS_SIGNAL_QUANTITY_VALUE, 2, t, v, out);
}

static inline mps_status add_bodies(mps_context *own, mps_domain *domain, int what, scene *s) {
  mps_body_motion motion = mps_body_motion_defaults();
  scoped_signal *rise = NULL;
  mps_status status = make_rise(own, &rise);
  for (int k = 0; k < (what == CONE ? 2 : BODIES); k++) {
    DEF(contact, def, .friction = 0.2 + 0.2 * k);
    if (k != 1) def.friction_factor = rise;
    if (what == (k == 0 ? PRESS : CONE)) def.method = MPS_CONTACT_METHOD_PENALTY;
    if (k == 1 && what != CONE) def.adhesion = 500.0, def.strength = 4e3;
    if (what == PLATES) def.inside = MPS_CONTACT_INSIDE_REMOVE, def.thin = k < 2;
    if ((what == PILES || what == BALLS) && k == 1) def.corner = 0.03;
    if ((what == PILES && k != 1) || (what == CONE && k == 0)) def.inset = 0.03;
    if (status == MPS_OK) status = make_body(own, what, k, &s->body[k]);
    motion.velocity[1] = k == 0 ? -4.0 : -2.0;
    if (k > 0 || what == CONE || what == PILES) TRY(mps_body_set_motion(s->body[k], &motion));
    if (k == 1) TRY(mps_body_name_part(s->body[k], "side", 1, 1, NULL));
    if (domain) status = mps_domain_agree(domain, status);
    TRY(mps_mpm_add_contact(s->mpm, s->body[k], &def, &s->contact[k]));
  }
  return status;
}

static inline mps_status make_scene(mps_context *own, mps_domain *domain, int what, scene *s) {
  const mps_mpm_def def = scene_def(domain, what);
  mps_status status = make_set(own, RANKS_IN_PARTS ? domain : NULL, what, &s->set);
  TRY(mps_material_create_linear_elastic(own, 1e6, 0.3, &s->material[0]));
  if (domain) status = mps_domain_agree(domain, status);
  TRY(mps_mpm_create(own, s->set, s->material[0], &def, &s->mpm));
  if (status == MPS_OK && what != SLIDE && what < PRESS)
    status = add_conditions(own, domain, what, s);
  if (status == MPS_OK && what != SLIDE) status = add_soil(own, domain, s);
  if (status == MPS_OK && what >= PRESS) status = add_bodies(own, domain, what, s);
  return status;
}

static inline void end_scene(scene *s) {
  for (int k = 0; k < BODIES; k++) {
    mps_contact_destroy(&s->contact[k]);
    mps_body_destroy(&s->body[k]);
  }
  mps_mpm_destroy(&s->mpm);
  mps_particles_destroy(&s->set);
  for (int k = 0; k < 2; k++) mps_material_destroy(&s->material[k]);
}

/* Where a body is and what it bears, which is something. */
static inline mps_status keep_body(scene *s, int k, result *r) {
  enum {
    STATE = (int)(sizeof(mps_body_state) / 8),
    EACH = STATE + (int)(sizeof(mps_reaction) / 8)
  };
  _Static_assert(BODIES * EACH + 1 + sizeof(mps_mpm_energy_report) / 8 <= RESULT_OTHERS, "room");
  mps_body_state state;
  mps_reaction touch;
  mps_status status = mps_contact_get_reaction(s->contact[k], k == 1 ? 0 : -1, &touch);
  TRY(mps_body_get_state(s->body[k], &state));
  if (status != MPS_OK) return status;
  memcpy(r->other + k * EACH, &state, sizeof state);
  memcpy(r->other + k * EACH + STATE, &touch, sizeof touch);
  return touch.impulse[1] != 0.0 ? MPS_OK : MPS_ERROR_INTERNAL;
}

/* The order of the particles, of all ranks too, as a number that ranks can agree upon. */
static inline mps_status keep_order(mps_domain *domain, mps_particles *set, result *r) {
  scoped_particles *whole = NULL;
  mps_view id;
  double hash = 0.0;
  mps_status status = domain ? mps_domain_gather_fields(domain, set, 0, NULL, &whole) : MPS_OK;
  if (status == MPS_OK && (whole || !domain)) {
    status = mps_particles_view(whole ? whole : set, "id", &id);
    for (int64_t k = 0; status == MPS_OK && k < id.shape[0]; k++)
      hash = fmod(31.0 * hash + (double)*mps_view_i64(&id, k, 0), 1e12);
  }
  if (domain) status = mps_domain_agree(domain, status);
  if (domain) TRY(mps_domain_max(domain, 1, &hash));
  r->other[RESULT_OTHERS - 1] = hash;
  return status;
}

/* What a reader of the grid gets: of nodes, by places, the largest hash of their bits on any rank,
 * and how many there are on all; values at points. */
static inline mps_status keep_grid(mps_domain *domain, scene *s, double *out) {
  enum { BUCKETS = 16, RANKS = 16, NODES = 8192 };
  static const double points[9] = {0.31, 0.2, 0.3, 0.62, 0.33, 0.41, 1.1, 0.1, 0.2};
  double *node = calloc(10 * NODES, sizeof *node), *v = node + 3 * NODES, *f = v + 3 * NODES;
  double *mass = f + 3 * NODES, most[BUCKETS + RANKS] = {0.0}, value[9] = {0.0};
  int64_t count = 0, all = 0;
  mps_grid *grid = mps_mpm_grid(s->mpm);
  mps_status status = mps_grid_get_nodes(grid, NODES, &count, node, mass, v, f);
  for (int64_t k = 0; status == MPS_OK && k < count; k++) {
    uint64_t hash = 0, bits;
    for (int c = 0; c < 10; c++) {
      const double number = (c < 9 ? node[c / 3 * 3 * NODES + 3 * k + c % 3] : mass[k]) + 0.0;
      memcpy(&bits, &number, sizeof bits);
      hash = (hash ^ bits) * UINT64_C(0x9E3779B97F4A7C15), hash ^= hash >> 29;
    }
    const int bucket = (int)(llround(100.0 * (node[3 * k] + 7.0 * node[3 * k + 1])) & 15);
    most[bucket] = fmax(most[bucket], (double)(hash >> 12));
  }
  most[BUCKETS + (domain ? mps_domain_rank(domain) : 0)] = (double)count;
  if (domain) TRY(mps_domain_max(domain, BUCKETS + RANKS, most));
  for (int k = 0; k < RANKS; k++) all += (int64_t)most[BUCKETS + k];
  TRY(mps_grid_evaluate(grid, "velocity", -1, 3, points, value, NULL));
  for (int k = 0; k < 9; k++) value[k] = value[k] == value[k] ? value[k] : 0.0; /* none there */
  if (count > NODES) status = MPS_ERROR_INTERNAL;
  memcpy(out, most, BUCKETS * sizeof *out);
  memcpy(out + BUCKETS, value, sizeof value);
  out[BUCKETS + 9] = (double)all;
  free(node);
  return status;
}

static inline mps_status keep_scene(mps_domain *domain, int what, scene *s, result *r) {
  mps_status status = mps_mpm_get_totals(s->mpm, &r->totals);
  static const int32_t asked[] = {
      MPS_SIDE_X_LOWER, MPS_SIDE_X_UPPER, MPS_SIDE_Y_LOWER, MPS_SIDE_Z_LOWER, 6, 7};
  for (int k = 0; k < 6; k++)
    if (k < 3 || (k > 3 ? what != SLIDE && what < PRESS : dim_of(what) == 3))
      TRY(mps_mpm_get_reaction(s->mpm, asked[k], &r->reaction[asked[k]]));
  for (int k = 0; k < BODIES && s->contact[k]; k++) TRY(keep_body(s, k, r));
  mps_mpm_energy_report losses = {0};
  if (r->totals.work_loads == r->totals.work_loads) TRY(mps_mpm_get_energy_report(s->mpm, &losses));
  memcpy(r->other + RESULT_OTHERS - 1 - (int)(sizeof losses / 8), &losses, sizeof losses);
  if (what == SLIDE || what == ROOM || what == CONE) TRY(keep_grid(domain, s, r->other + 120));
  TRY(keep_order(domain, s->set, r));
  r->dt = mps_mpm_dt(s->mpm), r->limit = mps_mpm_limit(s->mpm), r->time = mps_mpm_time(s->mpm);
  TRY(keep(s->set, r));
  return status;
}

/* Some steps towards equilibrium, which it does not reach. */
static inline mps_status relax(mps_mpm *mpm, result *r) {
  DEF(mpm_settle, def, .max_steps = 25);
  mps_mpm_settled now = {0};
  const mps_status status = mps_mpm_settle(mpm, &def, &now);
  r->other[0] = now.unbalanced, r->other[1] = now.applied, r->other[2] = now.kinetic;
  return status == MPS_ERROR_NUMERIC ? MPS_OK : status;
}

static inline mps_status compute(mps_context *own, mps_domain *domain, int what, int64_t steps,
                                 result *r) {
  SCOPED(end_scene) scene s = {.set = NULL};
  mps_status status = make_scene(own, domain, what, &s);
  r->first = s.set ? mps_particles_count(s.set) : 0;
  mps_snapshot *then = NULL;
  TRY(mps_mpm_step(s.mpm, steps / 4));
  TRY(mps_mpm_snapshot(s.mpm, &then));
  TRY(mps_mpm_step(s.mpm, steps / 2));
  TRY(mps_mpm_rollback(s.mpm, then));
  TRY(mps_mpm_step(s.mpm, steps / 2 - steps / 4));
  if (what == RING) TRY(relax(s.mpm, r));
  mps_snapshot_destroy(&then);
  TRY(mps_mpm_run(s.mpm, mps_mpm_time(s.mpm) + (double)(steps - steps / 2) * 1e-4, 10, NULL, NULL));
  TRY(keep_scene(domain, what, &s, r));
  return status;
}

/* ---- the caller puts particles in and takes some out ----------------------------------------- */

/* Received particles have their values by their positions. */
static inline mps_status give_values(mps_particles *set, int64_t first) {
  mps_view x;
  mps_edit density, velocity;
  mps_status status = mps_particles_view(set, "position", &x);
  TRY(mps_particles_edit(set, "density", &density));
  TRY(mps_particles_edit(set, "velocity", &velocity));
  for (int64_t k = first; status == MPS_OK && k < mps_particles_count(set); k++) {
    *mps_edit_f64(&density, k, 0) = 1700.0 + 100.0 * *mps_view_f64(&x, k, 0);
    *mps_edit_f64(&velocity, k, 1) = -2.0 - *mps_view_f64(&x, k, 1);
  }
  TRY(mps_particles_commit(set, &density));
  TRY(mps_particles_commit(set, &velocity));
  return status;
}

/* Soil for received particles, of which each rank lists its own. */
static inline mps_status make_soil(scene *s, int64_t first) {
  enum { MOST = 4096 };
  int64_t ids[MOST], count = 0;
  mps_view id;
  mps_status status = mps_particles_view(s->set, "id", &id);
  for (int64_t k = first; status == MPS_OK && k < mps_particles_count(s->set) && count < MOST; k++)
    ids[count++] = *mps_view_i64(&id, k, 0);
  TRY(mps_mpm_set_material(s->mpm, s->material[1], ids, count));
  return status;
}

/* Some rain and a block, of which the soil's sites are left out. */
static inline mps_status put_in(mps_context *own, mps_domain *domain, int what, scene *s,
                                result *r) {
  enum { DROPS = 45 };
  double drop[3 * DROPS];
  const int dim = dim_of(what);
  int64_t added = 0;
  for (int k = 0; k < DROPS; k++) {
    const double place[3] = {0.03 + 0.0243 * k, 1.1 + 0.31 * sin(7.0 * k),
                             0.4 + 0.39 * cos(3.0 * k)};
    memcpy(drop + dim * k, place, (size_t)dim * sizeof *place);
  }
  const double here[3] = {0.0, 0.2, 0.3}, there[3] = {0.3, 0.36, 0.5};
  const int64_t first = mps_particles_count(s->set);
  mps_status status = mps_particles_append(s->set, DROPS, drop);
  TRY(mps_particles_fill_box(s->set, AT(0.3, 1.5, 0.0), AT(0.62, 1.7, 0.8), &added));
  r->other[RESULT_OTHERS - 20] = (double)added;
  TRY(mps_particles_fill_box(s->set, here, there, &added)); /* the soil has been there */
  if (status == MPS_OK && added != 0) status = MPS_ERROR_INTERNAL;
  TRY(give_values(s->set, first));
  if (domain) status = mps_domain_agree(domain, status); /* edits are a rank's own */
  TRY(make_soil(s, first));
  (void)own;
  TRY(keep_order(domain, s->set, r));
  r->other[RESULT_OTHERS - 19] = r->other[RESULT_OTHERS - 1];
  return status;
}

/* Each rank removes what it has in a box. */
static inline mps_status clear_box(scene *s, const double *lo, const double *hi) {
  enum { MOST = 4096 };
  int64_t ids[MOST], count = 0;
  mps_status status = mps_particles_select_box(s->set, lo, hi, MOST, &count, ids);
  TRY(mps_particles_remove(s->set, ids, count));
  return status;
}

/* A list that all ranks give, and then what each has in a box. */
static inline mps_status take_out(mps_domain *domain, scene *s, result *r) {
  enum { LISTED = 90 };
  int64_t ids[LISTED];
  const double lo[3] = {0.7, 0.1, 0.1}, hi[3] = {0.8, 0.25, 0.6};
  for (int64_t k = 0; k < LISTED; k++) ids[k] = 5 + 13 * k;
  mps_status status = mps_particles_remove(s->set, ids, LISTED);
  TRY(clear_box(s, lo, hi));
  TRY(keep_order(domain, s->set, r));
  r->other[RESULT_OTHERS - 18] = r->other[RESULT_OTHERS - 1];
  return status;
}

/* In, out, back in time to before that, out and in again. */
static inline mps_status compute_changes(mps_context *own, mps_domain *domain, int what,
                                         int64_t steps, result *r) {
  SCOPED(end_scene) scene s = {.set = NULL};
  mps_snapshot *then = NULL;
  mps_status status = make_scene(own, domain, what, &s);
  r->first = s.set ? mps_particles_count(s.set) : 0;
  TRY(mps_mpm_step(s.mpm, steps / 4));
  TRY(put_in(own, domain, what, &s, r));
  TRY(mps_mpm_snapshot(s.mpm, &then));
  TRY(mps_mpm_step(s.mpm, steps / 4));
  TRY(take_out(domain, &s, r));
  TRY(mps_mpm_step(s.mpm, steps / 4));
  TRY(mps_mpm_rollback(s.mpm, then));
  TRY(take_out(domain, &s, r));
  TRY(mps_mpm_step(s.mpm, steps / 4));
  TRY(put_in(own, domain, what, &s, r));
  TRY(mps_mpm_step(s.mpm, steps / 4));
  mps_snapshot_destroy(&then);
  TRY(keep_scene(domain, what, &s, r));
  return status;
}

/* Half of a run that is cut in two: to a checkpoint, or on from it; `steps` are those of a half. */
static inline mps_status compute_half(mps_context *own, mps_domain *domain, int what, int64_t steps,
                                      const char *from, const char *to, result *r) {
  const double above[2] = {0.0, 1.4}, far[2] = {1.28, 2.0};
  SCOPED(end_scene) scene s = {.set = NULL};
  mps_status status = make_scene(own, domain, what, &s);
  if (from) TRY(mps_mpm_restore(s.mpm, from, NULL));
  TRY(mps_mpm_step(s.mpm, steps));
  if (what == SPREAD) TRY(put_in(own, domain, what, &s, r));
  if (to && what == SPREAD) TRY(clear_box(&s, above, far)); /* with the last ids */
  if (from) TRY(mps_mpm_step(s.mpm, 5));
  if (to) TRY(mps_mpm_save(s.mpm, to, NULL));
  TRY(keep_scene(domain, what, &s, r));
  return status;
}

#endif
