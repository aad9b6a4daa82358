/* state.c - the state of the fluid (core/state.h): snapshots, rollback, checkpoints. Data that
 * follow from the particles' positions, neighbours and the surface are computed again when needed.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "fluid/base/access.h"
#include "fluid/life/state.h"
#include "fluid/particles/holder.h"
#include "fluid/boundary/polyline.h"
#include "fluid/particles/rock.h"

#include "core/state/state.h"

static void list_wall(mpsi_state *s, mpsi_fluid_wall *w) {
  mpsi_state_agree_choice(s, "kind", "mps_boundary_kind", w->motion ? w->kind : -1);
  if (!w->motion) return;
  for (int c = 0; c < 2 && !w->of_body; c++) {
    mpsi_state_agree_number(s, c ? "point_y" : "point_x", w->at[c]);
    mpsi_state_agree_number(s, c ? "normal_y" : "normal_x", w->normal[c]);
  }
  mpsi_state_agree_integer(s, "segments", w->line ? w->line->count : 0);
  for (int64_t k = 0; w->line && k < w->line->count; k++) {
    mpsi_state_enter(s, "segment%d", (int)k);
    for (int c = 0; c < 2; c++)
      mpsi_state_agree_number(s, c ? "end_y" : "end_x", w->line->segment[k].end[1][c]);
    mpsi_state_leave(s);
  }
  mpsi_state_f64(s, "origin", &w->origin, 1);
  mpsi_state_f64(s, "rate", &w->rate, 1);
  mpsi_state_agree_integer(s, "nodes", w->nodes);
  mpsi_state_f64(s, "displacement", w->now.s, w->nodes);
  mpsi_state_f64(s, "velocity", w->now.u, w->nodes);
  mpsi_state_f64(s, "acceleration", w->now.a, w->nodes);
  mpsi_state_f64(s, "force", w->load.force, 2);
  mpsi_state_f64(s, "moment", &w->load.moment, 1);
  mpsi_state_f64(s, "impulse", w->impulse, 2);
  mpsi_state_f64(s, "moment_impulse", &w->moment_impulse, 1);
  mpsi_state_f64(s, "work", &w->work, 1);
  mpsi_state_i64(s, "wetted", &w->load.wetted, 1);
  mpsi_state_i64(s, "removed", &w->removed, 1);
  mpsi_state_f64(s, "removed_mass", &w->removed_mass, 1);
}

static void list_state(mpsi_state *s, void *solver) {
  mps_fluid *f = solver;
  mpsi_state_agree_number(s, "density", f->def.density);
  mpsi_state_agree_number(s, "radius_ratio", f->def.radius_ratio);
  mpsi_state_agree_number(s, "level", f->level);
  if (f->rest != f->level) mpsi_state_f64(s, "rest", &f->rest, 1);
  mpsi_state_agree_number(s, "gamma", f->classical.gamma);
  mpsi_fluid_list_rocks(s, f);
  mpsi_state_f64(s, "time", &f->time, 1);
  mpsi_state_i64(s, "steps", &f->steps, 1);
  mpsi_state_f64(s, "last_dt", &f->last_dt, 1);
  mpsi_state_f64(s, "load_time", &f->load_time, 1);
  mpsi_state_f64(s, "speed", &f->speed, 1);
  mpsi_state_f64(s, "energy", &f->energy, 1);
  mpsi_state_f64(s, "work_boundaries", &f->work_boundaries, 1);
  mpsi_state_f64(s, "work_loads", &f->work_loads, 1);
  mpsi_state_f64(s, "impulse_loads", f->exchange.loads, 2);
  mpsi_state_f64(s, "impulse_scheme", f->exchange.scheme, 2);
  mpsi_state_i64(s, "unknown", &f->unknown, 1);
  mpsi_state_i64(s, "ghosts", &f->report.ghosts, 1);
  mpsi_state_i64(s, "pairs", &f->report.pairs, 1);
  mpsi_state_i64(s, "surface", &f->report.surface, 1);
  mpsi_state_i64(s, "apart", &f->report.apart, 1);
  mpsi_state_i64(s, "last_iterations", &f->report.iterations, 1);
  mpsi_state_i64(s, "iterations", &f->report.all_iterations, 1);
  mpsi_state_i64(s, "collisions", &f->report.collisions, 1);
  mpsi_state_i64(s, "limited", &f->report.limited, 1);
  mpsi_state_i64(s, "pushed", &f->report.pushed, 1);
  mpsi_state_agree_integer(s, "boundaries", f->boundaries);
  mpsi_state_agree_integer(s, "bodies", f->bodies);
  for (int b = 0; b < f->boundaries; b++) {
    mpsi_state_enter(s, "boundary%d", b);
    list_wall(s, &f->wall[b]);
    mpsi_state_leave(s);
  }
  for (int b = 0; b < f->bodies; b++) {
    mpsi_fluid_pose *pose = &f->body[b].pose;
    mpsi_state_enter(s, "body%d", b);
    mpsi_state_agree_integer(s, "faces", f->body[b].faces);
    for (int k = 0; k < f->body[b].faces; k++) {
      mpsi_state_enter(s, "face%d", k);
      list_wall(s, &f->wall[f->body[b].first + k]);
      mpsi_state_leave(s);
    }
    mpsi_state_f64(s, "position", pose->x, 2);
    mpsi_state_f64(s, "orientation", pose->R, 4);
    mpsi_state_f64(s, "velocity", pose->v, 2);
    mpsi_state_f64(s, "spin", &pose->spin, 1);
    mpsi_state_agree_integer(s, "floats", f->body[b].floats);
    if (!f->body[b].body) {
      mpsi_state_leave(s);
      continue;
    }
    mpsi_body_list_source(s, f->body[b].body, f->body[b].source);
    for (int32_t part = 0; part < f->body[b].body->parts; part++) {
      mpsi_state_enter(s, "owed%d", part);
      mpsi_load *owed = &f->body[b].source->part[part].impulse;
      mpsi_state_f64(s, "force", owed->force, 3);
      mpsi_state_f64(s, "moment", owed->moment, 3);
      mpsi_state_leave(s);
    }
    mpsi_state_agree_integer(s, "moved", f->body[b].source->moves);
    if (f->body[b].floats) {
      mpsi_state_f64(s, "rate", f->body[b].rate, 3);
      mpsi_state_f64(s, "mass", f->body[b].mass, 9);
    }
    mpsi_state_enter(s, "felt");
    if (f->body[b].source->moves)
      mpsi_body_list_state(s, f->body[b].body);
    else
      mpsi_body_list_account(s, f->body[b].body);
    mpsi_state_leave(s);
    mpsi_state_leave(s);
  }
}

/* Of a file: positions must be finite. */
static bool fits(void *solver, mps_snapshot *values, const char **what) {
  const char *const names[] = {"position", "velocity", "reduced_pressure", "reduced_pressure_old"};
  for (size_t k = 0; k < sizeof names / sizeof *names; k++) {
    const mpsi_value *value = mpsi_values_find(&values->fields, names[k]);
    *what = "a particle's position, velocity or pressure is missing or not finite";
    if (!value || value->type != MPSI_STATE_F64 || value->rows < 1) return false;
    const double *x = value->data;
    for (int64_t i = 0; i < value->rows * value->columns; i++)
      if (!(fabs(x[i]) <= 1e150)) return false;
  }
  return true;
}

static bool reserve(void *solver, int64_t particles) {
  return particles <= MPSI_FLUID_MOST_PARTICLES && mpsi_fluid_reserve(solver, particles);
}

static void after(void *solver) {
  mps_fluid *f = solver;
  f->stale = f->renewed = true;
  f->count = mps_particles_count(f->particles);
  f->ghosts = 0; /* of other particles: computed again */
  mpsi_fluid_place_bodies(f);
  for (int b = 0; b < f->walls; b++) f->wall[b].given = f->wall[b].placed = false;
}

static mps_status settle(void *fluid, const char *function, mps_status status) {
  return mpsi_fluid_agree(fluid, function, status);
}

static mps_status have_read(void *fluid, const char *function, mps_status status,
                            mps_snapshot *values) {
  (void)values; /* every rank keeps all of them */
  return settle(fluid, function, status);
}

mpsi_state_of mpsi_fluid_state(void *solver) {
  mps_fluid *f = solver;
  return (mpsi_state_of){.solver = f,
                         .name = "fluid",
                         .context = f->context,
                         .particles = f->particles,
                         .identity = &f->identity,
                         .list = list_state,
                         .fits = fits,
                         .reserve = reserve,
                         .settle = settle,
                         .take_share = have_read,
                         .after = after,
                         .time = f->time,
                         .dt = f->dt,
                         .steps = f->steps};
}
