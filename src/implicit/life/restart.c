/* restart.c - the state of a motion (core/state.h): snapshots, rollback, checkpoints.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "implicit/base/implicit_solver.h"
#include "implicit/base/motion_state.h"
#include "implicit/life/change.h"
#include "implicit/life/restart.h"

#include "core/state/state.h"
#include "domain/moment.h"

#include <string.h>

/* The motion under way, or the numbers of one that a removal has ended. */
static mpsi_elastic_motion *motion_of(const mps_elastic *e) {
  return e->motion ? e->motion : e->ended;
}

/* Arrays of the body, whose length and place change with it. */
static void read_array(const double *from, int64_t rows, double *to) {
  if (from)
    memcpy(to, from, (size_t)rows * sizeof *to);
  else
    memset(to, 0, (size_t)rows * sizeof *to);
}

/* With other masses the factor of K + shift M is another. */
static void set_array(mps_elastic *e, double *array, int64_t rows, const void *values) {
  const size_t bytes = (size_t)rows * sizeof *array;
  if (array == e->mass && e->factored_shift != 0.0 && memcmp(array, values, bytes) != 0)
    e->factored = false;
  memcpy(array, values, bytes);
}

#define ARRAY(name, array, each)                                                                   \
  static int64_t count_##name(const void *solver) {                                                \
    const mps_elastic *e = solver;                                                                 \
    return e->n * (each);                                                                          \
  }                                                                                                \
  static void get_##name(const void *solver, void *values) {                                       \
    const mps_elastic *e = solver;                                                                 \
    read_array(array, e->n *(each), values);                                                       \
  }                                                                                                \
  static void set_##name(void *solver, int64_t rows, const void *values) {                         \
    mps_elastic *e = solver;                                                                       \
    set_array(e, array, rows, values);                                                             \
  }                                                                                                \
  static const mpsi_state_table table_of_##name = {MPSI_STATE_F64, 1,    count_##name,             \
                                                   get_##name,     NULL, set_##name};
ARRAY(reference, e->x, e->dim)
ARRAY(mass, e->mass, 1)
ARRAY(displacement, e->displacement, e->dim)
ARRAY(reaction, e->reaction, e->dim)
ARRAY(velocity, motion_of(e)->velocity, e->dim)
ARRAY(acceleration, motion_of(e)->acceleration, e->dim)
ARRAY(force, motion_of(e)->force, e->dim)
ARRAY(inner, motion_of(e)->inner, e->dim)
ARRAY(held, motion_of(e)->held, e->dim)

static int64_t count_cuts(const void *solver) { return ((const mps_elastic *)solver)->n; }
static void get_cuts(const void *solver, void *values) {
  const mps_elastic *e = solver;
  for (int64_t i = 0; i < e->n; i++) ((int64_t *)values)[i] = e->cut[i];
}
/* Cuts stay; those of restored particles are set already (change.c). */
static void keep_cuts(void *solver, int64_t rows, const void *values) {}
static const mpsi_state_table table_of_cuts = {MPSI_STATE_I64, 1,    count_cuts,
                                               get_cuts,       NULL, keep_cuts};

static void list_body(mpsi_state *s, mps_elastic *e) {
  mpsi_ledger *l = &e->ledger;
  mpsi_state_agree_number(s, "spacing", e->spacing);
  mpsi_state_agree_number(s, "measure", e->def.measure);
  mpsi_state_agree_integer(s, "particles_made", mpsi_particles_made(e->particles));
  mpsi_state_i64(s, "fixed_particles", &e->support_count, 1);
  mpsi_state_add_table(s, "reference", &table_of_reference);
  mpsi_state_add_table(s, "cut", &table_of_cuts);
  mpsi_state_add_table(s, "mass", &table_of_mass);
  mpsi_state_add_table(s, "displacement", &table_of_displacement);
  mpsi_state_add_table(s, "reaction", &table_of_reaction);
  double *works[] = {&l->loads, &l->boundaries, &l->inner, &l->mass_damping,
                     &l->left,  &l->kinetic,    &l->strain};
  static const char *const names[] = {"work_loads",   "work_boundaries", "work_inner",
                                      "mass_damping", "work_left",       "kinetic_start",
                                      "strain_start"};
  for (int k = 0; k < 7; k++) mpsi_state_f64(s, names[k], works[k], 1);
  for (int32_t k = 0; k < mpsi_elastic_boundary_count(e); k++) {
    mpsi_elastic_boundary *b = mpsi_elastic_boundary_of(e, k);
    if (!b) continue;
    mpsi_state_enter(s, "boundary%d", k);
    mpsi_state_i64(s, "particles", &b->present, 1);
    mpsi_state_reaction(s, &b->reaction);
    mpsi_state_leave(s);
  }
}

static void list_state(mpsi_state *s, void *solver) {
  mps_elastic *e = solver;
  mpsi_elastic_motion *m = motion_of(e);
  list_body(s, e);
  mpsi_state_agree_number(s, "alpha_m", m->alpha_m);
  mpsi_state_agree_number(s, "alpha_f", m->alpha_f);
  mpsi_state_agree_number(s, "beta", m->beta);
  mpsi_state_agree_number(s, "gamma", m->gamma);
  mpsi_state_agree_number(s, "mass_damping_coefficient", m->a0);
  mpsi_state_agree_number(s, "stiffness_damping_coefficient", m->a1);
  mpsi_state_f64(s, "time", &m->time, 1);
  mpsi_state_i64(s, "steps", &m->steps, 1);
  mpsi_state_bits(s, "fabric", m->fabric, 2);
  mpsi_state_add_table(s, "velocity", &table_of_velocity);
  mpsi_state_add_table(s, "acceleration", &table_of_acceleration);
  mpsi_state_add_table(s, "force", &table_of_force);
  mpsi_state_add_table(s, "inner", &table_of_inner);
  mpsi_state_add_table(s, "held", &table_of_held);
}

static mps_status settle(void *solver, const char *function, mps_status status) {
  return mpsi_domain_agree(((mps_elastic *)solver)->domain, function, status);
}

static mps_status have_read(void *solver, const char *function, mps_status status,
                            mps_snapshot *values) {
  /* every rank keeps all of them */
  return mpsi_domain_agree_moment(((mps_elastic *)solver)->domain, function, status, values);
}

mpsi_state_of mpsi_elastic_state(void *solver) {
  mps_elastic *e = solver;
  return (mpsi_state_of){.solver = e,
                         .name = "implicit elasticity",
                         .context = e->context,
                         .particles = e->particles,
                         .identity = &e->identity,
                         .list = list_state,
                         .prepare = mpsi_elastic_prepare_state,
                         .settle = settle,
                         .take_share = have_read,
                         .bind = mpsi_elastic_bind,
                         .time = mpsi_elastic_time(e),
                         .dt = mpsi_elastic_dt(e, NULL),
                         .steps = mpsi_elastic_steps(e)};
}

static mps_status check_motion(const mps_elastic *e, const char *function, bool under_way) {
  if (under_way) return MPS_OK;
  return mpsi_fail(e->context, function, MPS_ERROR_STATE,
                   "no motion under way: call mps_elastic_start first");
}

mps_status mpsi_elastic_settle(void *solver, const char *function) {
  const mps_elastic *e = solver;
  return check_motion(e, function, e->motion != NULL);
}

mps_status mpsi_elastic_leave_state(void *solver, const char *function) {
  const mps_elastic *e = solver;
  return check_motion(e, function, motion_of(e) != NULL);
}
