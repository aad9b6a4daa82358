/* coupled.c - water and a structure that move together, step by step until both agree. The
 * structure represents that of another code: shapes with a mass and a stiffness each (a wall on a
 * spring has one, a plate six), moved by the generalised-alpha method.
 *
 * In a step the pressures of the water are computed under a guess of the accelerations, and the
 * accelerations of the structure under these pressures; mps/experimental/coupling.h finds the
 * common solution. The pressures are those of the middle of the step; the structure's balance is
 * that of alpha_f before its end, and its forces are interpolated linearly there.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "tank.h"

#include <mps/experimental/fluid_parts.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#define HALVES 2 /* points of the plate in a spacing */

/* ---- structure ------------------------------------------------------------------------------- */

static void set_method(tank_structure *p, double rho_inf) {
  for (int k = 0; k < TANK_SHAPES; k++) p->force[k] = NAN;
  p->alpha_m = (2.0 * rho_inf - 1.0) / (rho_inf + 1.0);
  p->alpha_f = rho_inf / (rho_inf + 1.0);
  p->gamma = 0.5 - p->alpha_m + p->alpha_f;
  p->beta = 0.25 * (1.0 - p->alpha_m + p->alpha_f) * (1.0 - p->alpha_m + p->alpha_f);
}

/* The last step's end, where shape k changes its velocity by dt `mean`. */
static tank_motion go_on(const tank_structure *p, int k, double mean, double dt) {
  const tank_motion *m = &p->at[k];
  tank_motion next;
  next.a = (mean - (1.0 - p->gamma) * m->a) / p->gamma;
  next.v = m->v + dt * mean;
  next.d = m->d + dt * m->v + dt * dt * ((0.5 - p->beta) * m->a + p->beta * next.a);
  return next;
}

/* Mean acceleration of shape k over a step with the force (N) at its middle. */
static double respond(const tank_structure *p, int k, double middle, double dt) {
  const tank_motion *m = &p->at[k];
  const double change = isnan(p->force[k]) ? 0.0 : middle - p->force[k];
  const double force = middle + (0.5 - p->alpha_f) * change;
  const double early = m->d + dt * m->v + dt * dt * (0.5 - p->beta) * m->a;
  const double spring = p->stiffness[k] * ((1.0 - p->alpha_f) * early + p->alpha_f * m->d);
  const double heavy =
      p->mass[k] * (1.0 - p->alpha_m) + p->stiffness[k] * (1.0 - p->alpha_f) * p->beta * dt * dt;
  const double a = (force - spring - p->mass[k] * p->alpha_m * m->a) / heavy;
  return (1.0 - p->gamma) * m->a + p->gamma * a;
}

/* ---- making it ------------------------------------------------------------------------------- */

static mps_status make_spring(tank_model *m) {
  const tank_settings *s = &m->s;
  tank_structure *p = &m->structure;
  p->shapes = 1, p->wall = TANK_RIGHT;
  p->mass[0] = s->mass, p->stiffness[0] = s->stiffness;
  p->load[0] = 0.5 * WAVES_DENSITY * WAVES_G * s->depth * s->depth; /* at rest: no motion */
  p->at[0].d = p->start = s->kind == TANK_SPRING ? s->amplitude : 0.0;
  set_method(p, 1.0);
  return MPS_OK;
}

/* Shapes and points of the clamped plate, which is the bed; displacements upwards. */
static mps_status make_plate(tank_model *m) {
  const tank_settings *s = &m->s;
  tank_structure *p = &m->structure;
  const double weight = -s->plate_density * s->plate_thickness * WAVES_G, L = s->plate_length;
  p->shapes = TANK_SHAPES, p->wall = TANK_BED;
  p->points = HALVES * llround(L / s->spacing);
  p->each = L / (double)p->points;
  p->x = calloc(3 * (size_t)p->points, sizeof *p->x);
  p->shape = calloc((size_t)p->points * TANK_SHAPES, sizeof *p->shape);
  p->pressure = calloc(3 * (size_t)p->points, sizeof *p->pressure);
  if (!p->x || !p->shape || !p->pressure) return MPS_ERROR_MEMORY;
  p->displacement = p->pressure + p->points, p->velocity = p->displacement + p->points;
  for (int k = 0; k < TANK_SHAPES; k++) {
    p->mass[k] = s->plate_density * s->plate_thickness * L;
    p->stiffness[k] = tank_plate_rigidity(s) * pow(tank_plate_root(k) / L, 4.0) * L;
    for (int64_t i = 0; i < p->points; i++) {
      p->x[3 * i] = ((double)i + 0.5) * p->each;
      p->shape[k * p->points + i] = tank_plate_shape(k, p->x[3 * i] / L);
      p->load[k] += weight * p->each * p->shape[k * p->points + i];
    }
  }
  set_method(p, 0.5);
  return MPS_OK;
}

/* Relaxation of a coupling's first repeats: the share of the structure in what moves. More than
 * that overshoots the water's answer, and a light structure under much water never agreed with it.
 */
static double first_relaxation(const tank_settings *s, double most) {
  const bool plate = s->kind == TANK_PLATE; /* else the added mass of fast motion */
  const double own = plate ? s->plate_density * s->plate_thickness : s->mass;
  const double water = WAVES_DENSITY * s->depth * (plate ? 1.0 : 0.5428 * s->depth);
  return fmin(most, own / (own + water));
}

mps_status tank_make_structure(mps_context *context, tank_model *m) {
  mps_coupling_def def = mps_coupling_defaults();
  const mps_status status = m->s.kind == TANK_PLATE ? make_plate(m) : make_spring(m);
  if (status != MPS_OK) return status;
  def.size = m->structure.shapes;
  def.method = def.size > 1 ? MPS_COUPLING_METHOD_QUASI_NEWTON : MPS_COUPLING_METHOD_AITKEN;
  def.relaxation = first_relaxation(&m->s, def.relaxation);
  def.floor = 1e-4 * WAVES_G; /* accuracy of the pressure solution */
  m->structure.room = (def.columns + 4) * (1 + 2 * def.size);
  m->structure.memory = calloc((size_t)m->structure.room, sizeof(double));
  if (!m->structure.memory) return MPS_ERROR_MEMORY;
  return mps_coupling_create(context, &def, &m->structure.coupling);
}

mps_status tank_remember(tank_structure *p) {
  if (!p->coupling) return MPS_OK;
  return mps_coupling_get_memory(p->coupling, p->room, &p->learnt, p->memory);
}

mps_status tank_recall(tank_structure *p) {
  return p->coupling ? mps_coupling_set_memory(p->coupling, p->learnt, p->memory) : MPS_OK;
}

void tank_free_structure(tank_structure *p) {
  mps_coupling_destroy(&p->coupling);
  free(p->x);
  free(p->shape);
  free(p->pressure);
  free(p->memory);
}

/* ---- a step ---------------------------------------------------------------------------------- */

/* The wall at the end of the step, along its normal: the mean accelerations of the shapes. */
static mps_status move_wall(tank_model *m, const double *mean, double dt) {
  tank_structure *p = &m->structure;
  if (!p->points) {
    const tank_motion next = go_on(p, 0, mean[0], dt);
    const double d = next.d - p->start;
    return mps_fluid_set_boundary_motion(m->fluid, p->wall, &d, &next.v);
  }
  memset(p->displacement, 0, 2 * (size_t)p->points * sizeof *p->displacement);
  for (int k = 0; k < p->shapes; k++) {
    const tank_motion next = go_on(p, k, mean[k], dt);
    for (int64_t i = 0; i < p->points; i++) {
      p->displacement[i] += next.d * p->shape[k * p->points + i];
      p->velocity[i] += next.v * p->shape[k * p->points + i];
    }
  }
  return mps_fluid_set_boundary_motion(m->fluid, p->wall, p->displacement, p->velocity);
}

/* Force (N) of the water and of all else on each shape. */
static mps_status find_forces(tank_model *m, double *force) {
  tank_structure *p = &m->structure;
  mps_reaction r;
  mps_status status;
  memcpy(force, p->load, (size_t)p->shapes * sizeof *force);
  if (!p->points) {
    status = mps_fluid_get_reaction(m->fluid, p->wall, &r);
    if (status == MPS_OK) force[0] += r.force[0];
    return status;
  }
  status = mps_fluid_get_pressure(m->fluid, p->wall, p->points, p->x, p->pressure);
  for (int k = 0; status == MPS_OK && k < p->shapes; k++)
    for (int64_t i = 0; i < p->points; i++)
      force[k] -= p->pressure[i] * p->each * p->shape[k * p->points + i];
  return status;
}

/* `force` receives the force in the middle of the step. */
static mps_status agree(tank_model *m, double dt, double *mean, double *force) {
  tank_structure *p = &m->structure;
  double answer[TANK_SHAPES];
  int32_t done = 0;
  mps_status status = mps_coupling_begin(p->coupling, NULL, mean);
  while (status == MPS_OK && !done) {
    status = move_wall(m, mean, dt);
    if (status == MPS_OK) status = mps_fluid_solve_pressure(m->fluid);
    if (status == MPS_OK) status = find_forces(m, force);
    for (int k = 0; k < p->shapes; k++) answer[k] = respond(p, k, force[k], dt);
    if (status == MPS_OK) status = mps_coupling_next(p->coupling, answer, mean, &done);
  }
  return status == MPS_OK ? mps_coupling_accept(p->coupling) : status;
}

mps_status tank_coupled_step(tank_model *m) {
  tank_structure *p = &m->structure;
  const double dt = mps_fluid_dt(m->fluid);
  double mean[TANK_SHAPES], force[TANK_SHAPES];
  mps_status status = mps_fluid_begin_step(m->fluid, dt);
  if (status != MPS_OK) return status;
  status = tank_remember(p);
  if (status == MPS_OK) status = agree(m, dt, mean, force);
  if (status != MPS_OK) { /* all as before the step */
    mps_status given_up = mps_fluid_abandon_step(m->fluid);
    if (given_up == MPS_OK) given_up = tank_recall(p);
    return given_up == MPS_OK ? status : given_up;
  }
  status = mps_fluid_end_step(m->fluid);
  for (int k = 0; status == MPS_OK && k < p->shapes; k++) {
    p->at[k] = go_on(p, k, mean[k], dt);
    p->force[k] = force[k];
  }
  return status;
}

double tank_deflection(const tank_model *m) {
  const tank_structure *p = &m->structure;
  double d = 0.0;
  if (m->s.kind != TANK_PLATE) return p->at[0].d;
  for (int k = 0; k < p->shapes; k++) d -= p->at[k].d * tank_plate_shape(k, 0.5);
  return d;
}
