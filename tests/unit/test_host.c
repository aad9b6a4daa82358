/* test_host.c - one host program and every solver, through the public interface only: soil
 * (WLS-MPM) under a plate, the ground below it (explicit dynamics), a wall (implicit elasticity)
 * and water against it (fluid). In each of its steps the host carries forces and motions from one
 * to the other, takes particles away and brings others, makes the step, goes back, makes it with
 * other loads, goes back again, and repeats the first: the same bits. In each step the energy
 * budget of every solver closes. What the solvers have in common (mps/solver.h) is queried in one
 * way. SPDX-License-Identifier: BSD-3-Clause */
#include "test_fixture.h"

#define STEP 2e-3 /* s, of the host: each solver takes its own steps in it */
#define STEPS 12

/* ---- one vocabulary -------------------------------------------------------------------------- */

typedef struct verbs {
  const char *name;
  mps_status (*run)(void *solver, double t_end);
  mps_status (*snapshot)(void *solver, mps_snapshot **snapshot);
  mps_status (*rollback)(void *solver, const mps_snapshot *snapshot);
  mps_status (*totals)(void *solver, mps_totals *totals);
  mps_status (*reaction)(void *solver, int32_t number, mps_reaction *reaction);
  double (*time)(const void *solver);
  mps_particles *(*particles)(const void *solver);
} verbs;

#define VERBS(S)                                                                                   \
  static mps_status S##_run(void *s, double t) { return mps_##S##_run(s, t, 1, NULL, NULL); }      \
  static mps_status S##_snapshot(void *s, mps_snapshot **to) { return mps_##S##_snapshot(s, to); } \
  static mps_status S##_rollback(void *s, const mps_snapshot *to) {                                \
    return mps_##S##_rollback(s, to);                                                              \
  }                                                                                                \
  static mps_status S##_totals(void *s, mps_totals *t) { return mps_##S##_get_totals(s, t); }      \
  static mps_status S##_reaction(void *s, int32_t n, mps_reaction *r) {                            \
    return mps_##S##_get_reaction(s, n, r);                                                        \
  }                                                                                                \
  static double S##_time(const void *s) { return mps_##S##_time(s); }                              \
  static mps_particles *S##_particles(const void *s) { return mps_##S##_particles(s); }            \
  static const verbs of_##S = {#S,         S##_run,      S##_snapshot, S##_rollback,               \
                               S##_totals, S##_reaction, S##_time,     S##_particles};

VERBS(mpm)
VERBS(dynamics)
VERBS(elastic)
VERBS(fluid)

enum { SOIL, GROUND, WALL, WATER, SOLVERS };

typedef struct host {
  const verbs *verb[SOLVERS];
  void *solver[SOLVERS];
  mps_snapshot *before[SOLVERS];
  int32_t boundary[SOLVERS]; /* whose reaction is queried */
  int32_t wall_load, water_wall;
  mps_body *plate;
  mps_contact *contact;
  mps_signal *shake;
  int64_t facets[32], facet_count; /* of the wall, towards the water */
  double amplitude;                /* m, of the signal's value */
  double time;
} host;

/* ---- the scene ------------------------------------------------------------------------------- */

static mps_particles *box(double spacing, double width, double height) {
  mps_particles *set = box_of(context, spacing, AT(0.0, 0.0), AT(width, height));
  OK(mps_particles_set(set, "density", 0, 2000.0));
  return set;
}

static mps_material *stuff(double young) {
  MAKE_KEPT(material, material, create_linear_elastic, context, young, 0.25);
  return material;
}

static void make_soil(host *h) {
  scoped_particles *set = box(0.1, 1.0, 0.8);
  scoped_material *sand = stuff(2e6);
  DEF(mpm, def, .cell = 0.2, .gravity[1] = -9.81, .budget = 1);
  for (int c = 0; c < 2; c++) def.lower[c] = 0.0, def.upper[c] = c ? 3.0 : 1.0;
  OK(mps_particles_add_field(set, "external_force", 0));
  OK(mps_mpm_create(context, set, sand, &def, (mps_mpm **)&h->solver[SOIL]));
  DEF(body, place, .position[0] = 0.5, .position[1] = 1.05);
  OK(mps_body_create_box(context, &place, 0.6, 0.5, &h->plate));
  OK(mps_mpm_add_contact(h->solver[SOIL], h->plate, NULL, &h->contact));
  h->boundary[SOIL] = MPS_SIDE_Y_LOWER;
}

/* Values of the host's signals: the ground's base is shaken by it. */
static mps_status shake(void *user, double t, double motion[3]) {
  const host *h = user;
  const double w = 60.0;
  motion[0] = h->amplitude * (1.0 - cos(w * t));
  motion[1] = h->amplitude * w * sin(w * t);
  motion[2] = h->amplitude * w * w * cos(w * t);
  return MPS_OK;
}

static void make_ground(host *h) {
  scoped_particles *set = box(0.25, 3.0, 2.0);
  DEF(dynamics, def, .dt = 2.5e-4, .material = stuff(5e7));
  OK(mps_particles_add_field(set, "external_force", 0));
  OK(mps_dynamics_create(context, set, &def, (mps_dynamics **)&h->solver[GROUND]));
  OK(mps_signal_create_user(context, MPS_SIGNAL_QUANTITY_DISPLACEMENT, shake, h, NULL, &h->shake));
  DEF(dynamics_boundary, base, .kind = MPS_BOUNDARY_DRIVEN, .lower[0] = base.lower[1] = -1.0,
      .upper[0] = 9.0, .upper[1] = 0.3, .dofs = MPS_DOF_Y, .signal[0] = h->shake);
  OK(mps_dynamics_add_boundary(h->solver[GROUND], &base, &h->boundary[GROUND]));
  mps_material_destroy(&def.material);
}

static void start_wall(host *h) {
  DEF(elastic_motion, motion, .dt = STEP / 2.0, .time = h->time);
  OK(mps_elastic_start(h->solver[WALL], &motion));
  OK(mps_elastic_select_facets(h->solver[WALL], MPS_SIDE_X_UPPER, NULL, NULL, 32, &h->facet_count,
                               h->facets));
}

static void make_wall(host *h) {
  scoped_particles *set = box(0.1, 0.4, 1.2);
  DEF(elastic, def, .material = stuff(3e7));
  OK(mps_elastic_create(context, set, &def, (mps_elastic **)&h->solver[WALL]));
  DEF(elastic_boundary, foot, .lower[0] = foot.lower[1] = -1.0, .upper[0] = 9.0, .upper[1] = 0.1);
  OK(mps_elastic_add_boundary(h->solver[WALL], &foot, &h->boundary[WALL]));
  start_wall(h);
  USING(elastic_load, mps_elastic_add_load(h->solver[WALL], &given, &h->wall_load),
        .kind = MPS_ELASTIC_LOAD_PRESSURE, .ids = h->facets, .id_count = h->facet_count);
  mps_material_destroy(&def.material);
}

static void make_water(host *h) {
  scoped_particles *set = box(0.05, 0.8, 0.4);
  const double wall[3][5] = {{0, 0, 0, 1, 0}, {0, 0, 1, 0, 1}, {0.8, 0, -1, 0, 0}};
  OK(mps_fluid_create(context, set, NULL, (mps_fluid **)&h->solver[WATER]));
  for (int k = 0; k < 3; k++) {
    mps_fluid_boundary_def def = mps_fluid_boundary_defaults();
    def.kind = MPS_BOUNDARY_ROLLER; /* slip */
    int32_t number;
    for (int c = 0; c < 2; c++) def.point[c] = wall[k][c], def.normal[c] = wall[k][2 + c];
    OK(mps_fluid_add_boundary(h->solver[WATER], &def, &number));
    if (wall[k][4] > 0.0) h->water_wall = h->boundary[WATER] = number;
  }
}

/* ---- exchange -------------------------------------------------------------------------------- */

/* Forces (N) on the particles above `level`, shared evenly, times a factor by place. */
static void push(mps_particles *set, double level, double fx, double fy) {
  int64_t met = 0;
  mps_view x = view_field(set, "position");
  for (int64_t k = 0; k < x.shape[0]; k++) met += *mps_view_f64(&x, k, 1) > level;
  EDIT(f, set, "external_force")
    for (int64_t k = 0; k < x.shape[0]; k++) {
      const double part = *mps_view_f64(&x, k, 1) > level ? 1.0 / (double)met : 0.0;
      *mps_edit_f64(&f, k, 0) = fx * part;
      *mps_edit_f64(&f, k, 1) = fy * part;
    }
}

/* What the solvers feel now, to their input of the next step; `more` makes it another. */
static void exchange(host *h, double more) {
  mps_reaction plate, base, water;
  OK(mps_contact_get_reaction(h->contact, -1, &plate));
  OK(mps_dynamics_get_reaction(h->solver[GROUND], h->boundary[GROUND], &base));
  OK(mps_fluid_get_reaction(h->solver[WATER], h->water_wall, &water));
  /* the soil's weight on the ground, the ground's drag on the soil */
  push(h->verb[GROUND]->particles(h->solver[GROUND]), 1.7, 0.0, -1.5e4 - plate.force[1]);
  push(h->verb[SOIL]->particles(h->solver[SOIL]), 0.5, more + 1e-3 * base.force[0], 0.0);
  /* the plate keeps a load of 2 kN */
  WITH_DEFAULTS(mps_body_motion, motion, .velocity[1] = -1e-4 * (2e3 + more - plate.force[1]));
  OK(mps_body_set_motion(h->plate, &motion));
  /* water on the wall, the wall's velocity to the water */
  USING(elastic_load, mps_elastic_set_load(h->solver[WALL], h->wall_load, &given),
        .kind = MPS_ELASTIC_LOAD_PRESSURE, .ids = h->facets, .id_count = h->facet_count,
        .force[0] = (water.force[0] + more) / (0.1 * (double)h->facet_count));
  double velocity[3 * 32], mean = 0.0;
  const mps_elastic_facet_arrays arrays = {.velocity = velocity};
  OK(mps_elastic_get_facets(h->solver[WALL], h->facets, h->facet_count, &arrays));
  for (int64_t k = 0; k < h->facet_count; k++) mean += velocity[3 * k] / (double)h->facet_count;
  mean += 1e-5 * more;
  OK(mps_fluid_set_boundary_motion(h->solver[WATER], h->water_wall, NULL, &mean));
  h->amplitude = 1e-4 + 1e-7 * more;
}

/* Particles that go and come: one of the soil is thrown on top again, water is scooped and poured
 * in, the ground is dug, the wall erodes. */
static void trade(host *h, int step) {
  mps_particles *soil = h->verb[SOIL]->particles(h->solver[SOIL]);
  mps_particles *ground = h->verb[GROUND]->particles(h->solver[GROUND]);
  mps_view id = view_field(soil, "id");
  const int64_t gone[1] = {*mps_view_i64(&id, 3, 0)};
  const double back[2] = {0.1, 1.3 + 0.01 * step};
  OK(mps_particles_remove(soil, gone, 1));
  OK(mps_particles_append(soil, 1, back));
  OK(mps_particles_set(soil, "density", 0, 2000.0));
  OK(mps_particles_view(ground, "id", &id));
  int64_t dug[1] = {-1};
  mps_view x = view_field(ground, "reference");
  for (int64_t k = 0; k < x.shape[0] && dug[0] < 0; k++)
    if (*mps_view_f64(&x, k, 1) > 1.7) dug[0] = *mps_view_i64(&id, k, 0);
  OK(mps_particles_remove(ground, dug, 1));
  FAILS(mps_particles_append(ground, 1, back), MPS_ERROR_STATE, "takes no more particles");
  mps_particles *water = h->verb[WATER]->particles(h->solver[WATER]);
  int64_t scooped[1] = {-1};
  OK(mps_particles_view(water, "id", &id));
  OK(mps_particles_view(water, "position", &x));
  for (int64_t k = 0; k < x.shape[0] && scooped[0] < 0; k++)
    if (*mps_view_f64(&x, k, 1) > 0.35) scooped[0] = *mps_view_i64(&id, k, 0);
  if (scooped[0] >= 0) OK(mps_particles_remove(water, scooped, 1));
  const double poured[2] = {0.1 + 0.05 * step, 0.6};
  OK(mps_particles_append(water, 1, poured));
  if (step != STEPS / 2) return;
  mps_particles *wall = h->verb[WALL]->particles(h->solver[WALL]);
  int64_t top[8], count;
  const double lo[2] = {-1.0, 1.1}, hi[2] = {9.0, 9.0};
  OK(mps_particles_select_box(wall, lo, hi, 8, &count, top));
  OK(mps_particles_remove(wall, top, count));
  mps_elastic_load_def none = mps_elastic_load_defaults(); /* loads do not go back: begin alike */
  none.kind = MPS_ELASTIC_LOAD_PRESSURE, none.all = 1;
  OK(mps_elastic_set_load(h->solver[WALL], h->wall_load, &none));
  start_wall(h);
}

/* ---- a step ---------------------------------------------------------------------------------- */

static void mix(uint64_t *hash, const void *data, size_t bytes) {
  for (size_t k = 0; k < bytes; k++)
    *hash = (*hash ^ ((const unsigned char *)data)[k]) * 0x100000001b3u;
}

/* All that can be seen of a solver. */
static uint64_t look(const host *h, int k) {
  uint64_t hash = 0xcbf29ce484222325u;
  const verbs *v = h->verb[k];
  mps_particles *set = v->particles(h->solver[k]);
  mps_totals totals;
  mps_reaction reaction;
  for (int32_t f = 0; f < mps_particles_field_count(set); f++) {
    mps_particles_field_info info;
    OK(mps_particles_get_field_info(set, f, &info));
    mps_view view = view_field(set, info.name);
    for (int64_t c = 0; c < view.shape[1]; c++)
      mix(&hash, (const char *)view.data + 8 * c * view.stride[1], 8 * (size_t)view.shape[0]);
  }
  OK(v->reaction(h->solver[k], h->boundary[k], &reaction));
  OK(v->totals(h->solver[k], &totals));
  mix(&hash, &reaction, sizeof reaction);
  mix(&hash, &totals, sizeof totals);
  return hash;
}

/* Largest rotation of a particle, rad. */
static double largest_rotation(mps_particles *set) {
  double largest = 0.0;
  mps_view r = view_field(set, "rotation");
  for (int64_t k = 0; k < r.shape[0]; k++) largest = fmax(largest, fabs(*mps_view_f64(&r, k, 0)));
  return largest;
}

/* What the budget of mps/solver.h leaves of a step is rounding; what the scheme takes is, of
 * Newmark's average acceleration, that too, and of explicit dynamics as much as rotations are not
 * small. (WLS-MPM's scheme takes what its transfers do, the fluid's counts all that is missing.) */
static void check_budget(const host *h, int k, const mps_totals *a, const mps_totals *b) {
  const double terms[] = {b->kinetic - a->kinetic,
                          b->strain - a->strain,
                          b->dissipated - a->dissipated,
                          a->work_loads - b->work_loads,
                          a->work_boundaries - b->work_boundaries,
                          a->work_bodies - b->work_bodies};
  double sum = 0.0, largest = 0.0, scheme = INFINITY;
  for (int t = 0; t < 6; t++) sum += terms[t], largest = fmax(largest, fabs(terms[t]));
  largest = fmax(largest, fmax(fabs(b->kinetic), fabs(b->strain)));
  if (!(fabs(sum) <= 1e-12 * largest))
    fail_msg("%s: %g J of %g are missing", h->verb[k]->name, sum, largest);
  if (k == WALL) scheme = 1e-10;
  if (k == GROUND)
    scheme = fmax(1e-10, largest_rotation(h->verb[GROUND]->particles(h->solver[GROUND])));
  if (!(fabs(b->scheme - a->scheme) <= scheme * largest))
    fail_msg("%s: the scheme takes %g J of %g", h->verb[k]->name, b->scheme - a->scheme, largest);
}

static void step(host *h, uint64_t *hash) {
  for (int k = 0; k < SOLVERS; k++) {
    mps_totals before, after;
    OK(h->verb[k]->totals(h->solver[k], &before));
    OK(h->verb[k]->run(h->solver[k], h->time + STEP));
    OK(h->verb[k]->totals(h->solver[k], &after));
    check_budget(h, k, &before, &after);
    assert_true(h->verb[k]->time(h->solver[k]) == h->time + STEP); /* all are there, to the bit */
    hash[k] = look(h, k);
  }
}

static void go_back(host *h) {
  for (int k = 0; k < SOLVERS; k++) OK(h->verb[k]->rollback(h->solver[k], h->before[k]));
}

TEST(a_host_exchanges_and_repeats) {
  host h = {.verb = {&of_mpm, &of_dynamics, &of_elastic, &of_fluid}, .amplitude = 1e-4};
  double most = 0.0;
  make_soil(&h);
  make_ground(&h);
  make_wall(&h);
  make_water(&h);
  for (int n = 0; n < STEPS; n++) {
    uint64_t first[SOLVERS], other[SOLVERS], again[SOLVERS];
    for (int k = 0; k < SOLVERS; k++) OK(h.verb[k]->snapshot(h.solver[k], &h.before[k]));
    trade(&h, n);
    exchange(&h, 0.0);
    step(&h, first);
    go_back(&h); /* removed particles are restored, added ones are not */
    trade(&h, n);
    exchange(&h, 50.0);
    step(&h, other);
    go_back(&h);
    trade(&h, n);
    exchange(&h, 0.0);
    step(&h, again);
    for (int k = 0; k < SOLVERS; k++) {
      if (first[k] != again[k]) fail_msg("%s, step %d: not the same bits", h.verb[k]->name, n);
      if (first[k] == other[k]) fail_msg("%s, step %d: loads changed nothing", h.verb[k]->name, n);
    }
    h.time += STEP;
    mps_reaction plate;
    OK(mps_contact_get_reaction(h.contact, -1, &plate));
    most = fmax(most, plate.force[1]);
  }
  assert_true(most > 1e3); /* soil and plate are in contact */
  for (int k = 0; k < SOLVERS; k++) mps_snapshot_destroy(&h.before[k]);
  mps_contact_destroy(&h.contact);
  mps_mpm_destroy((mps_mpm **)&h.solver[SOIL]);
  mps_dynamics_destroy((mps_dynamics **)&h.solver[GROUND]);
  mps_elastic_destroy((mps_elastic **)&h.solver[WALL]);
  mps_fluid_destroy((mps_fluid **)&h.solver[WATER]);
  mps_body_destroy(&h.plate);
  mps_signal_destroy(&h.shake);
}
