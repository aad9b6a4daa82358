/* test_domain_random.c - random cases on one to seven ranks, by seed: WLS-MPM with bodies, the
 * fluid, explicit dynamics; refused calls, edits, particles that leave. Where all ranks do the same
 * they have the bits of one process; where one rank defines or calls something else, the others get
 * an error at once, and none waits. MPS_TEST_SEED=n runs that seed alone, MPS_TEST_SEEDS=n the
 * first n, from MPS_TEST_FIRST on; MPS_TEST_SPRINGS: free bodies by springs alone.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "ranks_team.h"

#include <time.h>

enum { MPM, FLUID, DYNAMICS, SOLVERS };
enum { ALIKE, OTHER_VALUE, OTHER_CALL, NO_CALL };
enum { STEP, RUN, TOTALS, DT, BOUNDARY, REFUSED, REMOVE, EDIT, BACK, MOVE, REACTION, OPERATIONS };

/* ---- what a seed means ----------------------------------------------------------------------- */

typedef struct plan {
  uint64_t seed, state;
  int solver, ranks, threads, operations, trouble, at, odd; /* at: operation of the rank `odd` */
  bool springs; /* a free body by penalty springs, which push particles out at the start */
} plan;

static uint32_t next(plan *p) {
  p->state = p->state * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
  return (uint32_t)(p->state >> 33);
}
static int pick(plan *p, int count) { return (int)(next(p) % (uint32_t)count); }
static double uniform(plan *p, double low, double high) {
  return low + (high - low) * (next(p) / 2147483648.0);
}

static plan make_plan(uint64_t seed) {
  plan p = {.seed = seed, .state = seed * 2654435761u + 12345u};
  for (int k = 0; k < 4; k++) (void)next(&p);
  p.solver = pick(&p, SOLVERS);
  p.ranks = 1 + pick(&p, 7);
  p.threads = 1 + pick(&p, 2);
  p.operations = 2 + pick(&p, 5);
  p.trouble = p.ranks > 1 && pick(&p, 2) == 0 ? 1 + pick(&p, 3) : ALIKE;
  p.odd = pick(&p, p.ranks);
  p.at = pick(&p, p.operations);
  if (getenv("MPS_TEST_SPRINGS")) p.solver = MPM, p.springs = true, p.trouble = ALIKE;
  return p;
}

/* ---- a case ---------------------------------------------------------------------------------- */

typedef struct subject {
  mps_context *own;
  mps_particles *set;
  mps_material *material;
  mps_body *body;
  mps_contact *contact;
  mps_mpm *mpm;
  mps_fluid *fluid;
  mps_dynamics *dynamics;
  int32_t wall;
  double gravity, off; /* m/s2; the worst of a step's momentum balance, of what moves */
} subject;

/* What a rank defines otherwise than the others, of the number that a solver has. */
static int otherwise(plan *p, int count, bool odd) {
  const int which = pick(p, count);
  return odd ? which : -1;
}

static mps_status fill(subject *s, int dim, double spacing, double width, double height) {
  DEF(particles, def, .dim = dim, .spacing = spacing);
  mps_status status = mps_particles_create(s->own, &def, &s->set);
  TRY(mps_particles_fill_box(s->set, AT(0.0, 0.0, 0.0), AT(width, height, 4.0 * spacing), NULL));
  TRY(mps_particles_set(s->set, "density", 0, 1000.0));
  return status;
}

static mps_status edit_velocity(subject *s, double factor, double add) {
  mps_edit v;
  mps_status status = mps_particles_edit(s->set, "velocity", &v);
  for (int64_t k = 0; status == MPS_OK && k < mps_particles_count(s->set); k++)
    *mps_edit_f64(&v, k, 0) = factor * *mps_edit_f64(&v, k, 0) + add;
  TRY(mps_particles_commit(s->set, &v));
  return status;
}

static mps_status add_body(subject *s, plan *p, double width, double height, int other) {
  const bool free_body = p->springs || pick(p, 2) == 0, springs = p->springs || pick(p, 2) == 0;
  mps_body_motion motion = mps_body_motion_defaults();
  const bool within = pick(p, 3) == 0; /* the soil, which is pushed out at the start */
  DEF(body, def, .position[0] = uniform(p, 0.2, 0.8) * width,
      .position[1] = height + (within ? uniform(p, 0.02, 0.1) : 0.111));
  if (free_body) {
    def.motion = MPS_BODY_MOTION_FREE;
    def.mass = 20.0, def.inertia[2] = 0.2, def.velocity[1] = -2.0, def.gravity[1] = -9.81;
  }
  DEF(contact, contact, .friction = uniform(p, 0.0, 0.6) + (other == 0 ? 0.01 : 0.0));
  if (other == 1) def.position[0] += 1e-9;
  if (other == 2 && free_body) def.mass = 20.001;
  if (other == 2 && !free_body) contact.depth = 0.05;
  contact.inside = MPS_CONTACT_INSIDE_PUSH;
  if (springs) contact.method = MPS_CONTACT_METHOD_PENALTY;
  mps_status status = pick(p, 2) ? mps_body_create_disc(s->own, &def, 0.1, &s->body)
                                 : mps_body_create_box(s->own, &def, 0.2, 0.2, &s->body);
  motion.velocity[1] = -uniform(p, 0.5, 3.0);
  if (!free_body) TRY(mps_body_set_motion(s->body, &motion));
  TRY(mps_mpm_add_contact(s->mpm, s->body, &contact, &s->contact));
  return status;
}

static mps_status make_mpm(subject *s, plan *p, mps_domain *domain, bool odd) {
  static const int32_t kinds[3] = {MPS_BOUNDARY_ROLLER, MPS_BOUNDARY_HELD, MPS_BOUNDARY_FRICTIONAL};
  const double width = uniform(p, 0.8, 1.6), height = uniform(p, 0.3, 0.6), h = 0.08;
  const int body = p->springs || pick(p, 3) > 0, other = otherwise(p, body ? 10 : 7, odd);
  mps_status status = fill(s, 2, 0.04, width, height);
  const double young = uniform(p, 2e5, 2e6) * (other == 0 ? 1.001 : 1.0);
  if (pick(p, 2)) {
    TRY(mps_material_create_linear_elastic(s->own, young, 0.3, &s->material));
  } else {
    DEF(material_drucker_prager, law, .young = young, .poisson = 0.3, .friction = 0.5,
        .cohesion = 1e3);
    TRY(mps_material_create_drucker_prager(s->own, &law, &s->material));
  }
  DEF(mpm, def, .domain = domain, .cell = h, .spline = 2 + (pick(p, 2) + (other == 1)) % 2,
      .lower[0] = def.lower[1] = 0.0, .upper[0] = 40.0 * h);
  s->gravity = def.gravity[1] = other == 2 ? -9.80 : -9.81;
  def.edge = pick(p, 2) ? MPS_MPM_EDGE_FIT : MPS_MPM_EDGE_MIRROR;
  def.volumetric = (pick(p, 3) + (other == 3)) % 3;
  def.budget = (pick(p, 2) + (other == 4)) % 2;
  if (pick(p, 4) == 0 || p->springs) def.dt = 1e-6;
  const int transfer = (pick(p, 3) == 0) != (other == 5), side = kinds[pick(p, 3)];
  TRY(mps_mpm_create(s->own, s->set, s->material, &def, &s->mpm));
  if (transfer) TRY(mps_experimental_mpm_transfer(s->mpm, MPS_EXPERIMENTAL_TRANSFER_WEIGHT));
  TRY(mps_mpm_set_side(s->mpm, MPS_SIDE_Y_LOWER, side, other == 6 ? 0.31 : 0.3));
  if (pick(p, 2)) TRY(mps_mpm_set_side(s->mpm, MPS_SIDE_X_LOWER, MPS_BOUNDARY_OPEN, 0.0));
  TRY(edit_velocity(s, 0.0, uniform(p, -3.0, 3.0)));
  if (status == MPS_OK && body) status = add_body(s, p, width, height, other - 7);
  return status;
}

static mps_status make_fluid(subject *s, plan *p, mps_domain *domain, bool odd) {
  const double width = uniform(p, 0.8, 1.2);
  const double wall[3][4] = {{0, 0, 0, 1}, {0, 0, 1, 0}, {2.0 * width, 0, -1, 0}};
  const int other = otherwise(p, 6, odd);
  DEF(fluid, def, .domain = domain, .viscosity = other == 0 ? 1.0 : 0.1);
  mps_status status = fill(s, 2, 0.02, width, uniform(p, 0.3, 0.5));
  if (other == 1) def.dt = 1e-4;
  if (other == 2) def.tolerance = 1e-7;
  TRY(mps_fluid_create(s->own, s->set, &def, &s->fluid));
  for (int k = 0; k < 3; k++) {
    mps_fluid_boundary_def b = mps_fluid_boundary_defaults();
    b.kind = MPS_BOUNDARY_ROLLER; /* slip */
    for (int c = 0; c < 2; c++) b.point[c] = wall[k][c], b.normal[c] = wall[k][2 + c];
    if (other == 3 && k == 2) b.point[0] += 1e-9;
    TRY(mps_fluid_add_boundary(s->fluid, &b, &s->wall));
  }
  DEF(fluid_load, load, .lower[0] = 0.1, .upper[0] = 0.5, .lower[1] = 0.0, .upper[1] = 0.2,
      .acceleration[0] = other == 4 ? 1.01 : 1.0);
  if (pick(p, 2) || other == 5) TRY(mps_fluid_add_load(s->fluid, &load, NULL));
  return status;
}

/* A motion of the caller's; with `user` another one from the first step on. */
static mps_status shake(void *user, double t, double motion[3]) {
  motion[0] = 1e-4 * sin(200.0 * t) + (user && t > 0.0 ? 1e-12 : 0.0);
  motion[1] = 2e-2 * cos(200.0 * t), motion[2] = -4.0 * sin(200.0 * t);
  return MPS_OK;
}

static mps_status make_dynamics(subject *s, plan *p, mps_domain *domain, bool odd) {
  static int any;
  const int other = otherwise(p, 6, odd), shaken = pick(p, 2);
  scoped_signal *signal = NULL;
  mps_status status = fill(s, 2, 0.1, uniform(p, 6.0, 10.0), uniform(p, 3.0, 6.0));
  if (other == 1) TRY(mps_particles_set(s->set, "density", 0, 1000.5));
  TRY(mps_material_create_linear_elastic(s->own, other == 0 ? 2e7 : 1e7, 0.25, &s->material));
  DEF(dynamics, def, .domain = domain, .material = s->material,
      .rotation = (pick(p, 2) + (other == 2)) % 2);
  TRY(mps_dynamics_create(s->own, s->set, &def, &s->dynamics));
  DEF(dynamics_boundary, floor, .lower[0] = -1.0, .upper[0] = 20.0, .lower[1] = -1.0,
      .upper[1] = other == 3 ? 0.2 : 0.1);
  TRY(mps_signal_create_user(s->own, MPS_SIGNAL_QUANTITY_DISPLACEMENT, shake,
                             other == 4 ? &any : NULL, NULL, &signal));
  if (shaken || other == 4) {
    floor.kind = MPS_BOUNDARY_DRIVEN;
    floor.dofs = MPS_DOF_X | MPS_DOF_Y, floor.signal[0] = signal;
  }
  if (other == 5) floor.dofs = MPS_DOF_X;
  TRY(mps_dynamics_add_boundary(s->dynamics, &floor, &s->wall));
  TRY(edit_velocity(s, 0.0, uniform(p, -1.0, 1.0)));
  if (shaken) TRY(mps_dynamics_step(s->dynamics, 1)); /* which shows whether motions differ */
  return status;
}

static void forget(subject *s) {
  mps_contact_destroy(&s->contact);
  mps_body_destroy(&s->body);
  mps_mpm_destroy(&s->mpm);
  mps_fluid_destroy(&s->fluid);
  mps_dynamics_destroy(&s->dynamics);
  mps_particles_destroy(&s->set);
  mps_material_destroy(&s->material);
}

/* ---- operations ------------------------------------------------------------------------------ */

#define EACH(s, m, f, d) ((s)->mpm ? (m) : (s)->fluid ? (f) : (d))

static mps_status step(subject *s, int64_t count) {
  return EACH(s, mps_mpm_step(s->mpm, count), mps_fluid_step(s->fluid, count),
              mps_dynamics_step(s->dynamics, count));
}

static mps_status run(subject *s, double steps) {
  const double t = EACH(s, mps_mpm_time(s->mpm) + steps * mps_mpm_dt(s->mpm),
                        mps_fluid_time(s->fluid) + steps * mps_fluid_dt(s->fluid),
                        mps_dynamics_time(s->dynamics) + steps * mps_dynamics_dt(s->dynamics));
  return EACH(s, mps_mpm_run(s->mpm, t, 2, NULL, NULL), mps_fluid_run(s->fluid, t, 2, NULL, NULL),
              mps_dynamics_run(s->dynamics, t, 2, NULL, NULL));
}

static mps_status totals(subject *s, mps_totals *out) {
  return EACH(s, mps_mpm_get_totals(s->mpm, out), mps_fluid_get_totals(s->fluid, out),
              mps_dynamics_get_totals(s->dynamics, out));
}

static mps_status reaction(subject *s, int32_t number, mps_reaction *out) {
  return EACH(s, mps_mpm_get_reaction(s->mpm, number, out),
              mps_fluid_get_reaction(s->fluid, number, out),
              mps_dynamics_get_reaction(s->dynamics, number, out));
}

static mps_status back_and_forth(subject *s) {
  scoped_snapshot *kept = NULL;
  mps_status status = EACH(s, mps_mpm_snapshot(s->mpm, &kept), mps_fluid_snapshot(s->fluid, &kept),
                           mps_dynamics_snapshot(s->dynamics, &kept));
  TRY(step(s, 2));
  TRY(EACH(s, mps_mpm_rollback(s->mpm, kept), mps_fluid_rollback(s->fluid, kept),
           mps_dynamics_rollback(s->dynamics, kept)));
  return status;
}

static mps_status set_boundary(subject *s, double x) {
  mps_fluid_boundary_def wall = mps_fluid_boundary_defaults();
  wall.kind = MPS_BOUNDARY_ROLLER; /* slip */
  wall.point[0] = 2.5 + x, wall.normal[0] = -1.0;
  if (s->mpm) return mps_mpm_set_side(s->mpm, MPS_SIDE_X_UPPER, MPS_BOUNDARY_FRICTIONAL, x);
  return s->fluid ? mps_fluid_set_boundary(s->fluid, s->wall, &wall)
                  : mps_dynamics_set_dt(s->dynamics, 1e-4 * (1.0 + x));
}

static mps_status set_dt(subject *s, double factor) {
  return EACH(s, mps_mpm_set_dt(s->mpm, factor * 0.2 * mps_mpm_limit(s->mpm)),
              mps_fluid_set_dt(s->fluid, factor * 1e-3),
              mps_dynamics_set_dt(s->dynamics, factor * 1e-4));
}

static mps_status move(subject *s, double speed) {
  WITH_DEFAULTS(mps_body_motion, motion, .velocity[1] = -speed);
  mps_status status = s->body ? mps_body_set_motion(s->body, &motion) : MPS_OK;
  TRY(step(s, 1));
  return status;
}

/* What walls and bodies have given to the soil so far (N s), up. */
static mps_status given_impulse(subject *s, double *sum, double *size) {
  mps_reaction r = {0};
  mps_status status = MPS_OK;
  *sum = *size = 0.0;
  for (int32_t side = 0; side < 4; side++) {
    TRY(mps_mpm_get_reaction(s->mpm, side, &r));
    *sum += r.impulse[1], *size += fabs(r.impulse[1]);
  }
  if (!s->contact) return status;
  TRY(mps_contact_get_reaction(s->contact, -1, &r));
  *sum -= r.impulse[1], *size += fabs(r.impulse[1]);
  return status;
}

/* Steps of WLS-MPM: the soil's momentum changes by what gravity, walls and bodies give. */
static mps_status step_in_balance(subject *s, int64_t count) {
  mps_totals before, after;
  double sum[2], size[2];
  const double t = mps_mpm_time(s->mpm);
  mps_status status = mps_mpm_get_totals(s->mpm, &before);
  TRY(given_impulse(s, &sum[0], &size[0]));
  TRY(mps_mpm_step(s->mpm, count));
  TRY(given_impulse(s, &sum[1], &size[1]));
  TRY(mps_mpm_get_totals(s->mpm, &after));
  if (status != MPS_OK || after.mass != before.mass) return status; /* some have left, pushed out */
  const double weight = before.mass * s->gravity * (mps_mpm_time(s->mpm) - t);
  const double off = after.linear[1] - before.linear[1] - weight - (sum[1] - sum[0]);
  s->off = fmax(s->off, fabs(off) / (fabs(before.linear[1]) + fabs(weight) + size[1] + 1e-9));
  return status;
}

/* `odd`: this rank gives another value. */
static mps_status operate(subject *s, plan *p, int what, bool odd, result *r, int k) {
  const int number = pick(p, 6);
  const double x = uniform(p, 0.1, 0.9);
  const int64_t ids[2] = {3 + number + odd, 40 + number};
  switch (what) {
  case STEP:
    return s->mpm && p->trouble == ALIKE ? step_in_balance(s, 1 + number)
                                         : step(s, 1 + number + odd);
  case RUN:
    return run(s, 1.5 + number + (odd ? 0.25 : 0.0));
  case TOTALS:
    return odd ? step(s, 1) : totals(s, &r->totals);
  case DT:
    return set_dt(s, x * (odd ? 1.01 : 1.0));
  case BOUNDARY:
    return set_boundary(s, x * (odd ? 1.01 : 1.0));
  case REFUSED:
    return step(s, odd ? 1 : -1 - number);
  case REMOVE:
    return s->dynamics ? step(s, 1 + odd) : mps_particles_remove(s->set, ids, 2);
  case EDIT: {
    const mps_status status = edit_velocity(s, x, 0.0);
    return status == MPS_OK ? step(s, 1 + odd) : status;
  }
  case BACK:
    return odd ? step(s, 3) : back_and_forth(s);
  case MOVE:
    return move(s, x * (odd && s->body ? 1.01 : 1.0));
  default:
    return reaction(s, odd ? 55 : s->mpm ? 2 : s->wall, &r->reaction[k % 8]);
  }
}

static bool has_other_value(const subject *s, int what) { return what != MOVE || s->body; }

/* What comes out is compared where all ranks do the same; `status` and `other[k]` are the results
 * of each operation. */
static mps_status compute(mps_context *own, mps_domain *domain, int seed, int64_t length,
                          result *r) {
  (void)length;
  plan p = make_plan((uint64_t)seed);
  SCOPED(forget) subject s = {.own = own};
  const bool odd = domain && p.trouble != ALIKE && mps_domain_rank(domain) == p.odd;
  const bool made = p.trouble == OTHER_VALUE && p.at == 0;
  mps_status status = p.solver == MPM     ? make_mpm(&s, &p, domain, odd && made)
                      : p.solver == FLUID ? make_fluid(&s, &p, domain, odd && made)
                                          : make_dynamics(&s, &p, domain, odd && made);
  for (int k = 0; status == MPS_OK && k < p.operations; k++) {
    plan fork = p;
    (void)next(&p), (void)next(&p), (void)next(&p);
    const int what = pick(&fork, OPERATIONS);
    const bool here = odd && k == p.at && !made;
    mps_status own_status = MPS_OK;
    if (here &&
        (p.trouble == OTHER_CALL || (p.trouble == OTHER_VALUE && !has_other_value(&s, what))))
      own_status = what == TOTALS ? back_and_forth(&s) : totals(&s, &r->totals);
    else if (!here || p.trouble != NO_CALL)
      own_status = operate(&s, &fork, what, here, r, k);
    r->other[k] = own_status;
    if (own_status == MPS_ERROR_STATE ||
        (domain && p.trouble != ALIKE && own_status != MPS_OK && k >= p.at && what != REFUSED))
      status = own_status;
  }
  if (status == MPS_OK && p.trouble == ALIKE) {
    TRY(totals(&s, &r->totals));
    r->time = EACH(&s, mps_mpm_time(s.mpm), mps_fluid_time(s.fluid), mps_dynamics_time(s.dynamics));
    TRY(keep(s.set, r));
    r->omega = s.off;
  }
  return status;
}

/* ---- seeds ----------------------------------------------------------------------------------- */

static void check_alike(const plan *p, ranks *s) {
  result alone = {.count = 0};
  scoped_context *serial = test_context(MPS_CONTEXT_EXECUTOR_SERIAL, 1);
  alone.status = compute(serial, NULL, (int)p->seed, 0, &alone);
  if (alone.status == MPS_OK && !(alone.omega < 1e-10))
    fail_msg("seed %d: the momentum is off by %g of what moves", (int)p->seed, alone.omega);
  int64_t *seen = calloc((size_t)alone.count + 1, sizeof *seen);
  for (int32_t r = 0; r < p->ranks; r++) {
    if (s->rank[r].status != alone.status)
      fail_msg("seed %d, rank %d of %d: status %d (%s), alone %d", (int)p->seed, (int)r, p->ranks,
               (int)s->rank[r].status, s->rank[r].message, (int)alone.status);
    if (alone.status == MPS_OK) compare(&alone, &s->rank[r], seen);
    drop(&s->rank[r]);
  }
  for (int64_t i = 0; i < alone.count; i++)
    if (seen[i] != 1 && seen[i] != p->ranks)
      fail_msg("seed %d: particle %lld is on %lld ranks", (int)p->seed, (long long)alone.id[i],
               (long long)seen[i]);
  free(seen);
  drop(&alone);
}

/* All ranks but the odd one have an error: it may have done no more than end early. Questions of
 * the fluid, which has all particles on each rank, need no other rank: there all or none have one.
 */
static void check_trouble(const plan *p, ranks *s) {
  int32_t failed = 0;
  for (int32_t r = 0; r < p->ranks; r++) {
    bool fails = s->rank[r].status != MPS_OK;
    for (int k = 0; k < p->operations; k++) fails = fails || s->rank[r].other[k] != MPS_OK;
    if (fails && r != p->odd) failed++;
    drop(&s->rank[r]);
  }
  if (failed != p->ranks - 1 && !(failed == 0 && p->solver == FLUID))
    fail_msg("seed %d (trouble %d at %d on rank %d of %d): %d of the others have an error",
             (int)p->seed, p->trouble, p->at, p->odd, p->ranks, (int)failed);
}

static void run_seed(uint64_t seed) {
  const plan p = make_plan(seed);
  ranks *s = calloc(1, sizeof *s);
  team t;
  s->compute = compute, s->what = (int)seed, s->threads = p.threads;
  team_begin(&t, p.ranks);
  team_run(&t, run_rank, s);
  if (t.lost || t.mixed)
    fail_msg("seed %d (trouble %d at %d on rank %d of %d): ranks %s; rank 0: %s; rank 1: %s",
             (int)seed, p.trouble, p.at, p.odd, p.ranks,
             t.mixed ? "are in different callbacks" : "waited for one another", s->rank[0].message,
             s->rank[1].message);
  team_end(&t);
  if (p.trouble == ALIKE)
    check_alike(&p, s);
  else
    check_trouble(&p, s);
  free(s);
}

TEST(test_seeds) {
  const char *one = getenv("MPS_TEST_SEED"), *many = getenv("MPS_TEST_SEEDS");
  const char *from = getenv("MPS_TEST_FIRST");
  const uint64_t count = many ? strtoull(many, NULL, 10) : test_quick() ? 40 : 200;
  if (one) {
    run_seed(strtoull(one, NULL, 10));
    return;
  }
  const uint64_t first = from ? strtoull(from, NULL, 10) : 1;
  for (uint64_t seed = first; seed < first + count; seed++) run_seed(seed);
}
