/* coupled.c - two-way coupling of wall and water: in every step the accelerations of the wall's
 * facets are found at which the response of the structure to the pressures is that given to the
 * water.
 *
 * The water keeps its step open and solves again for each guess; the structure is rolled back to
 * the beginning of the step. The pressures are those of the middle of the step; the
 * generalised-alpha method of the structure balances (1 - alpha) of the load at the end and alpha
 * of that before, which is the load 1/2 - alpha later, so the pressures are interpolated linearly
 * there.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "seawall.h"

#include <mps/experimental/fluid_parts.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#define RHO_INF 0.5
#define ALPHA (RHO_INF / (1.0 + RHO_INF))

/* Displacement and velocity of the facets' centres into the water, which lies at smaller x. */
static mps_status look_at_facets(seawall *w, double *displacement, double *velocity) {
  const strip *wall = &w->wall;
  seawall_both *b = &w->both;
  const mps_elastic_facet_arrays arrays = {.displacement = b->vector,
                                           .velocity = b->vector + 3 * wall->count};
  const mps_status status = mps_elastic_get_facets(wall->solver, wall->facet, wall->count, &arrays);
  for (int64_t k = 0; status == MPS_OK && k < wall->count; k++) {
    displacement[k] = -arrays.displacement[3 * k];
    velocity[k] = -arrays.velocity[3 * k];
  }
  return status;
}

/* ---- start ----------------------------------------------------------------------------------- */

static bool allocate(seawall_both *b, size_t n) {
  double **const arrays[] = {&b->rest,   &b->displacement, &b->velocity, &b->mean,
                             &b->answer, &b->moved,        &b->speed,    &b->before,
                             &b->given,  &b->middle,       &b->vector};
  enum { ARRAYS = sizeof arrays / sizeof *arrays };
  b->block = calloc((ARRAYS + 5) * n, sizeof *b->block); /* the last one has 6 a facet */
  for (size_t k = 0; b->block && k < ARRAYS; k++) *arrays[k] = b->block + k * n;
  return b->block != NULL;
}

/* At rest under still water: the position of the water's wall. */
static mps_status rest(seawall *w) {
  strip *wall = &w->wall;
  seawall_both *b = &w->both;
  for (int64_t k = 0; k < wall->count; k++)
    b->before[k] = b->middle[k] =
        WAVES_DENSITY * WAVES_G * fmax(w->s.depth - wall->centre[3 * k + 1], 0.0);
  mps_elastic_motion_def motion = mps_elastic_motion_defaults();
  motion.dt = w->s.dt;
  motion.rho_inf = RHO_INF;
  mps_status status = strip_load(wall, b->before);
  if (status == MPS_OK) status = mps_elastic_solve(wall->solver);
  if (status == MPS_OK) status = mps_elastic_start(wall->solver, &motion);
  return status == MPS_OK ? look_at_facets(w, b->rest, b->velocity) : status;
}

mps_status seawall_couple(mps_context *context, seawall *w) {
  seawall_both *b = &w->both;
  mps_coupling_def def = mps_coupling_defaults();
  def.size = w->wall.count;
  def.floor = 1e-4 * WAVES_G; /* accuracy of the pressure solution */
  b->room = (def.columns + 4) * (1 + 2 * def.size);
  b->memory = calloc((size_t)b->room, sizeof *b->memory);
  const bool room = b->memory && allocate(b, (size_t)w->wall.count);
  mps_status status = room ? MPS_OK : MPS_ERROR_MEMORY;
  if (room) status = mps_coupling_create(context, &def, &b->coupling);
  status = app_settle(w->a, status);
  return status == MPS_OK ? rest(w) : status;
}

void seawall_free_coupled(seawall_both *b) {
  mps_coupling_destroy(&b->coupling);
  mps_snapshot_destroy(&b->start);
  free(b->block);
  free(b->memory);
}

/* ---- a step ---------------------------------------------------------------------------------- */

/* Pressures (Pa) at the middle of the step if the facets change their velocities by dt `mean`. */
static mps_status ask_water(seawall *w, double dt) {
  const strip *wall = &w->wall;
  seawall_both *b = &w->both;
  for (int64_t k = 0; k < wall->count; k++) {
    b->speed[k] = b->velocity[k] + dt * b->mean[k];
    b->moved[k] = b->displacement[k] - b->rest[k] + 0.5 * dt * (b->velocity[k] + b->speed[k]);
  }
  mps_status status = mps_fluid_set_boundary_motion(w->fluid, SEAWALL_WALL, b->moved, b->speed);
  if (status == MPS_OK) status = mps_fluid_solve_pressure(w->fluid);
  return status == MPS_OK ? mps_fluid_get_pressure(w->fluid, SEAWALL_WALL, wall->count,
                                                   wall->centre, w->pressure)
                          : status;
}

/* Mean accelerations of the facets under these pressures, from where the step began. */
static mps_status ask_wall(seawall *w, double dt) {
  strip *wall = &w->wall;
  seawall_both *b = &w->both;
  for (int64_t k = 0; k < wall->count; k++) {
    const double p = w->pressure[k] + (0.5 - ALPHA) * (w->pressure[k] - b->middle[k]);
    b->given[k] = (p - ALPHA * b->before[k]) / (1.0 - ALPHA);
  }
  mps_status status = mps_elastic_rollback(wall->solver, b->start);
  if (status == MPS_OK) status = strip_load(wall, b->given);
  if (status == MPS_OK) status = mps_elastic_step(wall->solver, 1);
  if (status == MPS_OK) status = look_at_facets(w, b->moved, b->answer);
  for (int64_t k = 0; status == MPS_OK && k < wall->count; k++)
    b->answer[k] = (b->answer[k] - b->velocity[k]) / dt;
  return status;
}

static mps_status agree(seawall *w, double dt) {
  seawall_both *b = &w->both;
  int32_t done = 0;
  mps_status status = look_at_facets(w, b->displacement, b->velocity);
  if (status == MPS_OK) status = mps_elastic_snapshot(w->wall.solver, &b->start);
  if (status == MPS_OK)
    status = mps_coupling_get_memory(b->coupling, b->room, &b->learnt, b->memory);
  if (status == MPS_OK) status = mps_coupling_begin(b->coupling, NULL, b->mean);
  while (status == MPS_OK && !done) {
    status = ask_water(w, dt);
    if (status == MPS_OK) status = ask_wall(w, dt);
    if (status == MPS_OK) status = mps_coupling_next(b->coupling, b->answer, b->mean, &done);
  }
  return status == MPS_OK ? mps_coupling_accept(b->coupling) : status;
}

/* All as before a step that failed or was interrupted; `why` it was. */
static mps_status go_back(seawall *w, mps_status why) {
  seawall_both *b = &w->both;
  mps_status status = mps_fluid_abandon_step(w->fluid);
  if (status == MPS_OK) status = mps_elastic_rollback(w->wall.solver, b->start);
  if (status == MPS_OK) status = mps_coupling_set_memory(b->coupling, b->learnt, b->memory);
  return status == MPS_OK ? why : status;
}

mps_status seawall_coupled_step(seawall *w) {
  seawall_both *b = &w->both;
  const double dt = w->s.dt;
  mps_status status = mps_fluid_begin_step(w->fluid, dt);
  if (status != MPS_OK) return status;
  status = agree(w, dt);
  if (status != MPS_OK) return go_back(w, status);
  memcpy(b->before, b->given, (size_t)w->wall.count * sizeof *b->before);
  memcpy(b->middle, w->pressure, (size_t)w->wall.count * sizeof *b->middle);
  return mps_fluid_end_step(w->fluid);
}
