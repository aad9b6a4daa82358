/* restart.c - the state of a motion (core/state.h): snapshots, rollback, checkpoints.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "implicit/base/implicit_solver.h"
#include "implicit/base/motion_state.h"
#include "implicit/life/change.h"

#include "core/state/state.h"
#include "io/checkpoint.h"
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
static void keep_cuts(void *solver, int64_t rows, const void *values) {
  (void)solver, (void)rows, (void)values;
}
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
  for (int32_t k = 0; k < e->boundary_count; k++) {
    if (!e->boundaries[k].used) continue;
    mpsi_state_enter(s, "boundary%d", k);
    mpsi_state_i64(s, "particles", &e->boundaries[k].present, 1);
    mpsi_state_reaction(s, &e->boundaries[k].reaction);
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
  mpsi_state_i64(s, "fabric", m->fabric, 2);
  mpsi_state_add_table(s, "velocity", &table_of_velocity);
  mpsi_state_add_table(s, "acceleration", &table_of_acceleration);
  mpsi_state_add_table(s, "force", &table_of_force);
  mpsi_state_add_table(s, "inner", &table_of_inner);
  mpsi_state_add_table(s, "held", &table_of_held);
}

static mps_status settle(void *solver, const char *function, mps_status status) {
  return mpsi_domain_agree(((mps_elastic *)solver)->def.domain, function, status);
}

static mps_status have_read(void *solver, const char *function, mps_status status,
                            mps_snapshot *values) {
  /* every rank keeps all of them */
  return mpsi_domain_agree_moment(((mps_elastic *)solver)->def.domain, function, status, values);
}

static mpsi_state_of state_of(mps_elastic *e) {
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
                         .time = mps_elastic_time(e),
                         .dt = mps_elastic_dt(e),
                         .steps = mps_elastic_steps(e)};
}

/* Between steps, and to change the state not from a callback either. */
static mps_status check(mps_elastic *e, const char *function, bool changes) {
  mps_status status = mpsi_guard_check_between(&e->guard, e->context, function);
  if (status == MPS_OK && changes) {
    status = mpsi_elastic_enter(e, function);
    if (status == MPS_OK) (void)mpsi_elastic_leave(e, status);
  }
  if (status == MPS_OK && !(changes ? motion_of(e) : e->motion))
    status = mpsi_fail(e->context, function, MPS_ERROR_STATE,
                       "no motion under way: call mps_elastic_start first");
  return status;
}

mps_status mps_elastic_snapshot(mps_elastic *e, mps_snapshot **snapshot) {
  if (!e) return MPS_ERROR_ARGUMENT;
  const mpsi_state_of of = state_of(e);
  const mps_status status = check(e, __func__, false);
  return settle(e, __func__,
                status == MPS_OK ? mpsi_state_snapshot(&of, __func__, snapshot) : status);
}

mps_status mps_elastic_rollback(mps_elastic *e, const mps_snapshot *snapshot) {
  if (!e) return MPS_ERROR_ARGUMENT;
  const mpsi_state_of of = state_of(e);
  mps_status status = check(e, __func__, true);
  if (status == MPS_OK)
    status = mpsi_domain_agree_moment(e->def.domain, __func__, status, snapshot);
  return status == MPS_OK ? mpsi_state_rollback(&of, __func__, snapshot) : status;
}

mps_status mps_elastic_save(mps_elastic *e, const char *path, const mps_checkpoint *info) {
  if (!e) return MPS_ERROR_ARGUMENT;
  const mpsi_state_of of = state_of(e);
  mps_status status = check(e, __func__, false);
  if (status == MPS_OK && mps_domain_rank(e->def.domain) <= 0) /* all ranks have the same */
    status = mpsi_checkpoint_save(&of, __func__, path, info);
  return settle(e, __func__, status);
}

mps_status mps_elastic_restore(mps_elastic *e, const char *path, mps_checkpoint *info) {
  if (!e) return MPS_ERROR_ARGUMENT;
  const mpsi_state_of of = state_of(e);
  const mps_status status = check(e, __func__, true);
  return status == MPS_OK ? mpsi_checkpoint_restore(&of, __func__, path, info) : status;
}
