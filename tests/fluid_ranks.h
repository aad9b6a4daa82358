/* fluid_ranks.h - scenes of the fluid, computed by one process or by the ranks of a domain.
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef MPS_TEST_FLUID_RANKS_H
#define MPS_TEST_FLUID_RANKS_H

#include "ranks_result.h"

/* A column that falls against a wall that does not slip; a tank with a piston, a load and a body
 * afloat, made in parts; water that runs out of an open side, and is added to; all of two to three
 * blocks. Beds and the body have friction but where water runs out. PUDDLE is less than one, POND
 * little more, EXACT the same with a closer pressure. CLASSICAL: the column by the classical
 * scheme. BREAKWATER: a column beside rock that has water too, on a polyline, which collapses.
 */
enum { COLLAPSE, AFLOAT, SPILL, PUDDLE, POND, EXACT, CLASSICAL, BREAKWATER };

typedef struct scene {
  mps_particles *set;
  mps_fluid *fluid;
  mps_body *body;
  mps_signal *piston;
  mps_contact *contact; /* of the body and the fluid */
} scene;

static inline void drop_scene(scene *s) {
  mps_fluid_destroy(&s->fluid);
  mps_contact_destroy(&s->contact);
  mps_body_destroy(&s->body);
  mps_signal_destroy(&s->piston);
  mps_particles_destroy(&s->set);
}

static inline mps_status rough_wall(scene *s, int32_t kind, double x, double y, double nx,
                                    double ny, double friction) {
  DEF(fluid_boundary, def, .kind = kind, .point[0] = x, .point[1] = y, .normal[0] = nx,
      .normal[1] = ny, .friction_factor = friction);
  return mps_fluid_add_boundary(s->fluid, &def, NULL);
}

static inline mps_status wall(scene *s, int32_t kind, double x, double y, double nx, double ny,
                              mps_signal *signal) {
  DEF(fluid_boundary, def, .kind = kind, .point[0] = x, .point[1] = y, .normal[0] = nx,
      .normal[1] = ny, .signal = signal);
  return mps_fluid_add_boundary(s->fluid, &def, NULL);
}

/* An error on one rank in the creation of the fluid's parts is sent to all. */
static inline mps_domain *def_domain(const scene *s) {
  mps_fluid_def def = {0};
  return mps_fluid_get_def(s->fluid, &def) == MPS_OK ? def.domain : NULL;
}

static inline mps_status add_float(mps_context *own, scene *s) {
  mps_status status =
      mps_signal_create_sine(own, MPS_SIGNAL_QUANTITY_DISPLACEMENT, 1.0, 0.3, 0.0, &s->piston);
  mps_domain *domain = def_domain(s);
  DEF(body, body, .motion = MPS_BODY_MOTION_FREE, .position[0] = 1.6, .position[1] = 0.9,
      .mass = 40.0, .inertia[2] = 1.0, .gravity[1] = -9.81);
  const double xy[] = {-0.2, -0.1, 0.2, -0.1, 0.2, 0.1, -0.2, 0.1};
  TRY(mps_body_create_polygon(own, &body, 4, xy, &s->body));
  if (domain) status = mps_domain_agree(domain, status);
  TRY(wall(s, MPS_BOUNDARY_ROLLER, 0.0, 0.0, 0.0, 1.0, NULL));
  TRY(wall(s, MPS_BOUNDARY_ROLLER, 0.0, 0.0, 1.0, 0.0, s->piston));
  TRY(wall(s, MPS_BOUNDARY_ROLLER, 4.0, 0.0, -1.0, 0.0, NULL));
  DEF(fluid_contact, afloat, .kind = MPS_BOUNDARY_ROLLER, .friction_factor = 0.1);
  TRY(mps_fluid_add_contact(s->fluid, s->body, &afloat, &s->contact));
  DEF(fluid_load, load, .kind = MPS_FLUID_LOAD_PRESSURE, .pressure = 200.0, .lower[0] = 3.0);
  TRY(mps_fluid_add_load(s->fluid, &load, NULL));
  return status;
}

/* Water in rock of porosity 4/9, whose particles lie .03 m apart. */
static inline mps_status fill_breakwater(mps_particles *set) {
  mps_status status = mps_particles_fill_box(set, AT(0.0, 0.0), AT(0.9, 1.0), NULL);
  for (int n = 0; status == MPS_OK && n < 528; n++) {
    const double at[2] = {0.9 + 0.03 * (n / 33 + 0.5), 0.03 * (n % 33 + 0.5)};
    status = mps_particles_append(set, 1, at);
  }
  return status;
}

static inline mps_status add_breakwater(scene *s) {
  const double bed[4][3] = {{-0.5, 0.0, 0.0}, {2.0, 0.0, 0.0}, {2.5, 0.3, 0.0}, {2.5, 1.5, 0.0}};
  const double stones[4][3] = {
      {0.9, -0.1, 0.0}, {1.5, -0.1, 0.0}, {1.4, 1.2, 0.0}, {0.9, 1.2, 0.0}};
  DEF(fluid_boundary, line, .corners = bed[0], .corner_count = 4, .friction_factor = 0.1);
  mps_status status = mps_fluid_add_boundary(s->fluid, &line, NULL);
  TRY(wall(s, MPS_BOUNDARY_ROLLER, 0.0, 0.0, 1.0, 0.0, NULL));
  TRY(wall(s, MPS_BOUNDARY_ROLLER, 3.5, 0.0, -1.0, 0.0, NULL));
  DEF(fluid_rock, rock, .corners = stones[0], .corner_count = 4, .porosity = 4.0 / 9.0,
      .diameter = 0.02);
  TRY(mps_fluid_add_rock(s->fluid, &rock, NULL));
  return status;
}

static inline mps_status make_scene(mps_context *own, mps_domain *domain, int what, scene *s) {
  DEF(particles, set, .spacing = 0.02);
  DEF(fluid, def, .domain = domain);
  const double lower[2] = {0.0, 0.0}, small[2] = {0.6, 0.4}, middle[2] = {1.12, 1.0},
               large[2] = {2.0, 1.6};
  if (what == EXACT) def.tolerance = 1e-11;
  def.viscosity = what == COLLAPSE ? 0.5 : 0.0;
  mps_status status = mps_particles_create(own, &set, &s->set);
  if (what == AFLOAT) { /* below the body, and beside it */
    const double parts[3][4] = {
        {0.0, 0.0, 4.0, 0.78}, {0.0, 0.78, 1.38, 0.9}, {1.82, 0.78, 4.0, 0.9}};
    for (int k = 0; k < 3; k++)
      TRY(mps_particles_fill_box(s->set, &parts[k][0], &parts[k][2], NULL));
  } else if (what == BREAKWATER) {
    status = status == MPS_OK ? fill_breakwater(s->set) : status;
  } else {
    const double *upper = what == PUDDLE ? small : what == POND || what == EXACT ? middle : large;
    TRY(mps_particles_fill_box(s->set, lower, upper, NULL));
  }
  if (domain) status = mps_domain_agree(domain, status);
  TRY(mps_fluid_create(own, s->set, &def, &s->fluid));
  if (what == CLASSICAL) TRY(mps_experimental_fluid_classical(s->fluid, 0.2));
  if (status != MPS_OK || what == AFLOAT) return status == MPS_OK ? add_float(own, s) : status;
  if (what == BREAKWATER) return add_breakwater(s);
  const double friction = what == COLLAPSE || what == CLASSICAL ? 0.1 : 0.0; /* of the bed */
  TRY(rough_wall(s, MPS_BOUNDARY_ROLLER, 0.0, 0.0, 0.0, 1.0, friction));
  TRY(wall(s, MPS_BOUNDARY_HELD, 0.0, 0.0, 1.0, 0.0, NULL));
  if (what == SPILL) TRY(wall(s, MPS_BOUNDARY_OPEN, 2.02, 0.0, -1.0, 0.0, NULL));
  if (what != SPILL) TRY(wall(s, MPS_BOUNDARY_ROLLER, 2.5, 0.0, -1.0, 0.0, NULL));
  return status;
}

static inline mps_status step_in_parts(scene *s) {
  mps_status status = mps_fluid_begin_step(s->fluid, NAN);
  TRY(mps_fluid_solve_pressure(s->fluid));
  TRY(mps_fluid_solve_pressure(s->fluid));
  TRY(mps_fluid_end_step(s->fluid));
  return status;
}

/* Steps; in the middle what the scene has of its own. */
static inline mps_status take_steps(scene *s, int what, int64_t steps) {
  mps_snapshot *kept = NULL;
  mps_status status = mps_fluid_step(s->fluid, steps / 2);
  if (what == AFLOAT) TRY(step_in_parts(s));
  if (what == SPILL) {
    const double x[4] = {0.5, 1.9, 0.54, 1.9};
    TRY(mps_particles_append(s->set, 2, x));
    if (def_domain(s)) status = mps_domain_agree(def_domain(s), status);
  }
  if (what == COLLAPSE) {
    TRY(mps_fluid_snapshot(s->fluid, &kept));
    TRY(mps_fluid_step(s->fluid, 3));
    TRY(mps_fluid_rollback(s->fluid, kept));
    mps_snapshot_destroy(&kept);
  }
  TRY(mps_fluid_step(s->fluid, steps - steps / 2));
  return status;
}

static inline mps_status tell(scene *s, int what, result *r) {
  const double station[4] = {0.1, 0.7, 1.4, 2.2};
  mps_fluid_report report;
  mps_status status = mps_fluid_get_totals(s->fluid, &r->totals);
  for (int b = 0; b < 3; b++) TRY(mps_fluid_get_reaction(s->fluid, b, &r->reaction[b]));
  if (what == AFLOAT) TRY(mps_contact_get_reaction(s->contact, -1, &r->reaction[3]));
  if (what != CLASSICAL) TRY(mps_fluid_get_levels(s->fluid, 4, station, r->other));
  double points[12] = {0.1, 0.0, 0.0, 0.5, 0.0, 0.0, 1.1, 0.0, 0.0, 1.7, 0.0, 0.0};
  TRY(mps_fluid_get_pressure(s->fluid, 0, 4, points, r->other + 4));
  TRY(mps_fluid_get_report(s->fluid, &report));
  if (status != MPS_OK) return status;
  const int64_t counts[] = {report.ghosts,     report.surface,        report.apart,
                            report.iterations, report.collisions,     report.limited,
                            report.pushed,     report.all_iterations, report.pairs};
  for (int k = 0; k < 9; k++) r->other[8 + k] = (double)counts[k];
  r->dt = mps_fluid_dt(s->fluid), r->limit = mps_fluid_limit(s->fluid);
  r->time = mps_fluid_time(s->fluid);
  return keep(s->set, r);
}

/* `from`, `to`: checkpoints, or NULL. */
static inline mps_status compute_half(mps_context *own, mps_domain *domain, int what, int64_t steps,
                                      const char *from, const char *to, result *r) {
  SCOPED(drop_scene) scene s = {.set = NULL};
  mps_status status = make_scene(own, domain, what, &s);
  if (from) TRY(mps_fluid_restore(s.fluid, from, NULL));
  TRY(take_steps(&s, what, steps));
  if (to) TRY(mps_fluid_save(s.fluid, to, NULL));
  TRY(tell(&s, what, r));
  return status;
}

static inline mps_status compute(mps_context *own, mps_domain *domain, int what, int64_t steps,
                                 result *r) {
  return compute_half(own, domain, what, steps, NULL, NULL, r);
}

#endif
