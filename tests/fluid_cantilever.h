/* fluid_cantilever.h - an elastic wall, held at its foot, that closes a tank, for tests: water and
 * wall agree on the accelerations of its wetted face in every step. A step of load from behind
 * makes it swing. SPDX-License-Identifier: BSD-3-Clause */
#ifndef MPS_FLUID_CANTILEVER_H
#define MPS_FLUID_CANTILEVER_H

#include "fluid_tank.h"

#define CANTILEVER_LENGTH 0.8 /* m, of the water */
#define CANTILEVER_DEPTH 0.4
#define CANTILEVER_HEIGHT 0.5 /* of the wall */
#define CANTILEVER_THICK 0.04
#define CANTILEVER_SPACING 0.01 /* of its particles */
#define CANTILEVER_WATER 0.02
#define CANTILEVER_FACETS 64
#define CANTILEVER_LOAD 300.0 /* N, from behind */

typedef struct cantilever {
  mps_particles *wall;
  mps_elastic *elastic;
  tank water;
  mps_coupling *coupling;
  mps_snapshot *before;
  mps_elastic_facet_arrays face;
  mps_elastic_load_def load;
  int32_t pressed, boundary;
  int64_t facets, ids[CANTILEVER_FACETS], top;
  double centre[3 * CANTILEVER_FACETS], displacement[3 * CANTILEVER_FACETS],
      velocity[3 * CANTILEVER_FACETS], rest[CANTILEVER_FACETS];
  double p[CANTILEVER_FACETS], last[CANTILEVER_FACETS], at_end[CANTILEVER_FACETS],
      next[CANTILEVER_FACETS];
} cantilever;

static inline void cantilever_hold(mps_context *c, cantilever *w) {
  enum { ROOM = 4000 };
  int64_t *ids = malloc(ROOM * sizeof *ids), count;
  const double low[2] = {-9.0, -1e-6}, high[2] = {9.0, 1e-6};
  DEF(elastic, def, .state = MPS_ELASTIC_STATE_PLANE_STRAIN);
  OK(mps_elastic_create(c, w->wall, &def, &w->elastic));
  OK(mps_particles_select_box(w->wall, low, high, ROOM, &count, ids));
  OK(mps_elastic_cut(w->elastic, MPS_SIDE_Y_LOWER, ids, count));
  DEF(elastic_boundary, held, .ids = ids, .id_count = count);
  OK(mps_elastic_add_boundary(w->elastic, &held, NULL));
  free(ids);
}

/* The wall at rest under the still water. */
static inline void cantilever_rest(cantilever *w, double dt, double rho_inf) {
  OK(mps_elastic_select_facets(w->elastic, MPS_SIDE_X_LOWER, NULL, NULL, CANTILEVER_FACETS,
                               &w->facets, w->ids));
  assert_in_range(w->facets, 1, CANTILEVER_FACETS);
  w->face = (mps_elastic_facet_arrays){
      .centre = w->centre, .displacement = w->displacement, .velocity = w->velocity};
  OK(mps_elastic_get_facets(w->elastic, w->ids, w->facets, &w->face));
  for (int64_t k = 0; k < w->facets; k++) {
    const double y = w->centre[3 * k + 1];
    w->p[k] = y < CANTILEVER_DEPTH ? 1000.0 * TANK_G * (CANTILEVER_DEPTH - y) : 0.0;
    w->last[k] = w->at_end[k] = w->p[k];
  }
  w->load = mps_elastic_load_defaults();
  w->load.kind = MPS_ELASTIC_LOAD_PRESSURE;
  w->load.ids = w->ids, w->load.id_count = w->facets, w->load.values = w->p;
  OK(mps_elastic_add_load(w->elastic, &w->load, &w->pressed));
  OK(mps_elastic_solve(w->elastic));
  USING(elastic_motion, mps_elastic_start(w->elastic, &given), .dt = dt, .rho_inf = rho_inf);
  OK(mps_elastic_get_facets(w->elastic, w->ids, w->facets, &w->face));
  for (int64_t k = 0; k < w->facets; k++) w->rest[k] = w->displacement[3 * k];
}

static inline void cantilever_make(mps_context *c, cantilever *w, double dt, double rho_inf) {
  mps_fluid_def def = mps_fluid_defaults();
  mps_fluid_boundary_def wall = mps_fluid_boundary_defaults();
  wall.kind = MPS_BOUNDARY_ROLLER; /* slip */
  mps_elastic_load_def behind = mps_elastic_load_defaults();
  int64_t back[CANTILEVER_FACETS], count;
  const double low[2] = {CANTILEVER_LENGTH, -0.5 * CANTILEVER_SPACING};
  const double high[2] = {CANTILEVER_LENGTH + CANTILEVER_THICK, CANTILEVER_HEIGHT - 1e-9};
  DEF(particles, set, .spacing = CANTILEVER_SPACING, .origin[0] = low[0], .origin[1] = low[1]);
  OK(mps_particles_create(c, &set, &w->wall));
  OK(mps_particles_fill_box(w->wall, low, high, NULL));
  SET_FIELDS(w->wall, {"young", 1.6e9}, {"poisson", 0.25}, {"density", 2000.0});
  cantilever_hold(c, w);
  cantilever_rest(w, dt, rho_inf);
  OK(mps_elastic_select_facets(w->elastic, MPS_SIDE_X_UPPER, NULL, NULL, CANTILEVER_FACETS, &count,
                               back));
  behind.kind = MPS_ELASTIC_LOAD_PRESSURE, behind.ids = back, behind.id_count = count;
  behind.force[0] = CANTILEVER_LOAD;
  OK(mps_elastic_add_load(w->elastic, &behind, NULL));
  set = mps_particles_defaults();
  set.spacing = CANTILEVER_WATER, def.dt = dt, def.level = CANTILEVER_DEPTH;
  OK(mps_particles_create(c, &set, &w->water.water));
  tank_fill(w->water.water, CANTILEVER_LENGTH, CANTILEVER_DEPTH, NULL, NULL);
  OK(mps_fluid_create(c, w->water.water, &def, &w->water.fluid));
  tank_wall(w->water.fluid, 0.0, 0.0, 0.0, 1.0, NULL);
  tank_wall(w->water.fluid, 0.0, 0.0, 1.0, 0.0, NULL);
  wall.point[0] = CANTILEVER_LENGTH, wall.normal[0] = -1.0;
  wall.nodes = w->centre, wall.node_count = w->facets;
  OK(mps_fluid_add_boundary(w->water.fluid, &wall, &w->boundary));
  DEF(coupling, agree, .size = w->facets, .floor = 1e-4 * TANK_G);
  OK(mps_coupling_create(c, &agree, &w->coupling));
  w->top = mps_particles_nearest(w->wall, (double[2]){CANTILEVER_LENGTH, CANTILEVER_HEIGHT});
}

/* The face's velocity at the end of a step under its mean accelerations `a`; its response to the
 * water's pressures then to `a`. The pressures are those of the middle of the step; the elastic
 * solver takes its loads at alpha_f before the end, in a straight line. */
static inline void cantilever_try(cantilever *w, double dt, double alpha, const double *d,
                                  const double *v, const double *a, double *answer) {
  double place[CANTILEVER_FACETS], speed[CANTILEVER_FACETS];
  for (int64_t k = 0; k < w->facets; k++)
    speed[k] = v[k] + dt * a[k], place[k] = d[k] + 0.5 * dt * (v[k] + speed[k]);
  OK(mps_fluid_set_boundary_motion(w->water.fluid, w->boundary, place, speed));
  OK(mps_fluid_solve_pressure(w->water.fluid));
  OK(mps_fluid_get_pressure(w->water.fluid, w->boundary, w->facets, w->centre, w->p));
  OK(mps_elastic_rollback(w->elastic, w->before));
  for (int64_t k = 0; k < w->facets; k++)
    w->next[k] =
        (w->p[k] + (0.5 - alpha) * (w->p[k] - w->last[k]) - alpha * w->at_end[k]) / (1.0 - alpha);
  w->load.values = w->next;
  OK(mps_elastic_set_load(w->elastic, w->pressed, &w->load));
  OK(mps_elastic_step(w->elastic, 1));
  OK(mps_elastic_get_facets(w->elastic, w->ids, w->facets, &w->face));
  for (int64_t k = 0; k < w->facets; k++) answer[k] = (-w->velocity[3 * k] - v[k]) / dt;
}

static inline void cantilever_step(cantilever *w, double dt, double alpha) {
  double d[CANTILEVER_FACETS], v[CANTILEVER_FACETS], a[CANTILEVER_FACETS],
      answer[CANTILEVER_FACETS];
  int32_t done = 0;
  OK(mps_fluid_begin_step(w->water.fluid, dt));
  OK(mps_elastic_snapshot(w->elastic, &w->before));
  OK(mps_elastic_get_facets(w->elastic, w->ids, w->facets, &w->face));
  for (int64_t k = 0; k < w->facets; k++)
    d[k] = w->rest[k] - w->displacement[3 * k], v[k] = -w->velocity[3 * k];
  OK(mps_coupling_begin(w->coupling, NULL, a));
  while (!done) {
    cantilever_try(w, dt, alpha, d, v, a, answer);
    OK(mps_coupling_next(w->coupling, answer, a, &done));
  }
  OK(mps_coupling_accept(w->coupling));
  for (int64_t k = 0; k < w->facets; k++) w->last[k] = w->p[k], w->at_end[k] = w->next[k];
  OK(mps_fluid_end_step(w->water.fluid));
}

/* Growth (1/s) of the crest's swing about its mean: from its root mean square in the second and in
 * the last quarter of t_end s. */
static inline double cantilever_growth(mps_context *c, double dt, double rho_inf, double t_end) {
  cantilever *w = calloc(1, sizeof *w);
  const double alpha = rho_inf / (1.0 + rho_inf);
  double n[2] = {0.0, 0.0}, sum[2] = {0.0, 0.0}, square[2] = {0.0, 0.0}, rms[2];
  cantilever_make(c, w, dt, rho_inf);
  while (mps_fluid_time(w->water.fluid) < t_end) {
    cantilever_step(w, dt, alpha);
    const double part = mps_fluid_time(w->water.fluid) / t_end;
    if (part < 0.25 || (part > 0.5 && part < 0.75)) continue;
    const int at = part > 0.5;
    mps_view u = view_field(w->wall, "displacement");
    const double x = *mps_view_f64(&u, mps_particles_index(w->wall, w->top), 0);
    n[at] += 1.0, sum[at] += x, square[at] += x * x;
  }
  for (int k = 0; k < 2; k++) {
    const double mean = sum[k] / n[k];
    rms[k] = sqrt(square[k] / n[k] - mean * mean);
  }
  mps_coupling_destroy(&w->coupling);
  mps_snapshot_destroy(&w->before);
  tank_free(&w->water);
  mps_elastic_destroy(&w->elastic);
  mps_particles_destroy(&w->wall);
  free(w);
  const double growth = log(rms[1] / rms[0]) / (0.5 * t_end);
  print_message("cantilever, dt %g ms, rho_inf %g: swing %.4g, then %.4g mm: growth %+.3f 1/s\n",
                1e3 * dt, rho_inf, 1e3 * rms[0], 1e3 * rms[1], growth);
  return growth;
}

#endif
