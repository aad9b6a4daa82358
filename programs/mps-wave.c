/* mps-wave - earthquake wave through a soil column or slope of particles, Yoshida, Figure 2.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "common/output.h"
#include "common/parts.h"
#include "common/resume.h"
#include "wave/wave.h"

#include <mps/experimental/papers.h>

#include <math.h>
#include <stdio.h>

enum { MAX_ROWS = 5000 };

typedef struct simulation {
  column ground;
  mps_signal *signal;
  mps_dynamics *dynamics;
  receivers record;
  files files;
  field peaks;
  results_so_far so_far;
  mps_domain *domain; /* borrowed; NULL: one process */
  int64_t particles;  /* of all ranks */
  double duration;    /* s */
} simulation;

/* ---- building -------------------------------------------------------------------------------- */

static mps_status build_boundaries(const settings *s, simulation *sim) {
  const char wave = settings_wave(s);
  mps_status status = MPS_OK;
  if (s->base == BASE_RIGID)
    status = column_drive_base(&sim->ground, sim->dynamics, wave, sim->signal);
  else
    status = column_viscous_base(&sim->ground, sim->dynamics, wave, sim->signal, &s->half_space);
  if (status == MPS_OK && s->sides == SIDES_ROLLER)
    status = column_hold_sides(&sim->ground, sim->dynamics, wave);
  return status;
}

/* The ground, in parts unless its free-field columns need all of it on each rank, and its outputs.
 */
static bool build_ground(app *a, const settings *s, simulation *sim) {
  const column_def def = {.width = s->width,
                          .height = s->height,
                          .radius = 0.5 * s->spacing,
                          .ground = &s->ground,
                          .sloped = s->sloped,
                          .slope = {s->slope[0], s->slope[1], s->slope[2]},
                          .open = s->base == BASE_VISCOUS,
                          .domain = s->sides == SIDES_FREEFIELD ? NULL : a->domain};
  if (!app_check(a, column_create(a->context, &def, &sim->ground))) return false;
  if (!receivers_create(a, &sim->ground, settings_wave(s), s->receivers, &sim->record))
    return false;
  mps_particles *particles = sim->ground.particles;
  for (int32_t side = MPS_SIDE_X_LOWER; side <= MPS_SIDE_X_UPPER && s->sides == SIDES_FREEFIELD;
       side++)
    if (!app_check(a, mps_dynamics_add_free_field(particles, side, 2))) return false;
  sim->particles = mps_particles_count(particles);
  if (!app_check(a, parts_sum(def.domain, &sim->particles))) return false;
  sim->so_far =
      (results_so_far){.s = s, .record = &sim->record, .peaks = &sim->peaks, .same = true};
  return field_create(a, s, particles, sim->particles, &sim->peaks);
}

/* The solver, of all ranks together, which leaves each its share of the ground. */
static bool build_solver(app *a, const settings *s, simulation *sim) {
  mps_dynamics_def dynamics = settings_dynamics(s, sim->ground.width);
  dynamics.domain = sim->domain = a->domain;
  return app_check(a, mps_dynamics_create(a->context, sim->ground.particles, &dynamics,
                                          &sim->dynamics)) &&
         (s->torque == 0 ||
          app_check(a, mps_experimental_dynamics_printed_torque(sim->dynamics))) &&
         app_check(a, build_boundaries(s, sim)) &&
         files_open(a, s, sim->duration, &sim->so_far, sim->dynamics, &sim->files);
}

static void destroy(simulation *sim) {
  mps_dynamics_destroy(&sim->dynamics);
  receivers_destroy(&sim->record);
  field_destroy(&sim->peaks);
  column_destroy(&sim->ground);
  mps_signal_destroy(&sim->signal);
}

/* ---- running --------------------------------------------------------------------------------- */

/* The paper's 2.5 s, or the record and the time for its wave to rise and return. */
static double find_duration(const settings *s, const simulation *sim) {
  if (!isnan(s->duration)) return s->duration;
  if (s->ricker) return 2.5;
  double end;
  mps_signal_span(sim->signal, NULL, &end);
  return end + 2.0 * layers_travel_time(&s->ground, settings_wave(s), sim->ground.height, 0.0);
}

/* Energy is constant without dissipation once the input has ended. */
static void watch_energy(const settings *s, simulation *sim) {
  bool damped = s->base == BASE_VISCOUS || s->sides == SIDES_FREEFIELD;
  for (int64_t i = 0; i < s->ground.count; i++) damped = damped || s->ground.layer[i].damping > 0.0;
  sim->record.energy = !damped;
  /* the energy of these may grow below the limit too; free-field columns have their own */
  sim->record.watch = s->sides != SIDES_FREEFIELD &&
                      (s->torque != 0 || s->integrator == MPS_DYNAMICS_INTEGRATOR_EULER);
  mps_signal_span(sim->signal, NULL, &sim->record.energy_from);
  for (int k = 0; k <= 1000; k++)
    sim->record.speed =
        fmax(sim->record.speed,
             fabs(mps_signal_velocity(sim->signal, 1e-3 * k * sim->record.energy_from)));
}

/* The library reports where and why it diverged; this adds the remedy. */
static void explain_divergence(app *a, const results *x) {
  const char *why = mps_context_error(a->context)->message;
  if (x->dt_limit == 0.0)
    app_error(a, "%s: Euler without damping has no stable step, try --integrator verlet", why);
  else
    app_error(
        a,
        "%s: dt is below the linear limit %.4g s, look for very strong motion in the input, or "
        "try --courant 0.5",
        why, x->dt_limit);
}

static mps_status record(void *user, mps_dynamics *dynamics) {
  simulation *sim = user;
  mps_status status = receivers_record(&sim->record, dynamics, sim->domain);
  return status == MPS_OK ? files_record(&sim->files, field_record(&sim->peaks)) : status;
}

/* A restarted run records at the steps of the first: to the next of them. The last row of a
 * complete run may lie between them, and is removed. */
static bool align_rows(app *a, simulation *sim) {
  const int64_t every = sim->so_far.every, past = mps_dynamics_steps(sim->dynamics) % every;
  receivers *r = &sim->record;
  if (past == 0) return true;
  if (r->rows > 0) { /* a row is of the beginning of its step */
    const double begun = receivers_time(r, r->rows - 1) / mps_dynamics_dt(sim->dynamics);
    if ((llround(begun) + 1) % every != 0) r->rows--;
  }
  return app_check(a, mps_dynamics_step(sim->dynamics, every - past));
}

static bool check_dt(app *a, const settings *s, double limit) {
  if (isnan(s->dt) || s->dt <= limit || limit == 0.0) return true;
  return app_error(
      a,
      "--dt is %g s, must be at most the linear stability limit, %.4g s: try --dt %.2g "
      "or --courant 0.9",
      s->dt, limit, 0.9 * limit);
}

/* Energy that nothing has put in: what was recorded is no motion of the ground. */
static int report_growth(app *a, const simulation *sim, results *x) {
  x->end = OUTCOME_DIVERGED;
  a->outcome = "diverged";
  app_error(a,
            "unstable: at t = %.4g s the energy is %.3g J, the most that was put in %.3g J: take "
            "--integrator verlet and --torque conserving, or a smaller --dt",
            mps_dynamics_time(sim->dynamics), sim->record.grown, sim->record.given);
  return APP_FAILED;
}

/* Exit code; the results are filled as far as the run came. */
static int march(app *a, const settings *s, simulation *sim, results *x) {
  mps_dynamics_linear_limit limit;
  x->particles = sim->particles;
  x->dt_limit = NAN;
  if (!app_check(a, mps_dynamics_find_limit(sim->dynamics, 0.0, &limit))) return APP_FAILED;
  x->dt_limit = limit.dt;
  if (!check_dt(a, s, limit.dt)) return APP_FAILED;
  x->dt = mps_dynamics_dt(sim->dynamics);
  if (!(x->dt > 0.0)) {
    app_check(a, mps_context_error(a->context)->status);
    return APP_FAILED;
  }
  /* to the first whole step at or after the duration, so that all steps are dt */
  const double end = x->dt * ceil(sim->duration / x->dt - 1e-9);
  int64_t *every = &sim->so_far.every;
  if (*every == 0) *every = (int64_t)(sim->duration / x->dt / MAX_ROWS) + 1;
  if (s->restart && !align_rows(a, sim)) return APP_FAILED;
  printf("%s wave, %lld particles, dt %.4g s (linear limit %.4g s), %.0f steps\n",
         s->wave == WAVE_S ? "S" : "P", (long long)x->particles, x->dt, x->dt_limit,
         fmax(0.0, ceil((sim->duration - mps_dynamics_time(sim->dynamics)) / x->dt)));
  fflush(stdout);
  watch_energy(s, sim);
  const mps_status status = mps_dynamics_run(
      sim->dynamics, fmax(end, mps_dynamics_time(sim->dynamics)), *every, record, sim);
  x->steps = mps_dynamics_steps(sim->dynamics);
  x->end = OUTCOME_COMPLETE;
  if (sim->record.grown > 0.0) return report_growth(a, sim, x);
  if (status == MPS_ERROR_DIVERGED) {
    x->end = OUTCOME_DIVERGED;
    a->outcome = "diverged";
    explain_divergence(a, x);
    return APP_FAILED;
  }
  if (status == MPS_ERROR_CANCELLED) {
    x->end = OUTCOME_INTERRUPTED;
    return app_end_run(a, status, mps_dynamics_time(sim->dynamics), sim->record.rows > 1);
  }
  return app_check(a, status) ? APP_OK : APP_FAILED;
}

/* Writes the records, also of a run that ended early, on rank 0. */
static bool write_results(app *a, const settings *s, simulation *sim, results *x,
                          mps_particles *whole) {
  if (!results_find(a, s, &sim->ground, &sim->record, sim->signal, x) ||
      !receivers_write(a, &sim->record, s->out) || !results_write(a, s, x, sim->signal))
    return false;
  if (x->end != OUTCOME_DIVERGED && (!results_draw(a, s, &sim->ground, &sim->record, x) ||
                                     !field_write(a, s, &sim->peaks, whole)))
    return false;
  results_print(a, s, x);
  return true;
}

static bool finish(app *a, const settings *s, simulation *sim, results *x) {
  mps_particles *whole = sim->ground.particles;
  bool ok = true;
  if (sim->peaks.count > 0 && sim->domain)
    ok = app_check(a, field_join(&sim->peaks, sim->domain)) &&
         app_check(a, files_gather(&sim->files, &whole));
  if (ok && a->rank == 0) ok = write_results(a, s, sim, x, whole);
  return app_agree(a, ok);
}

static int run(app *a, settings *s) {
  simulation sim = {0};
  results x = {0};
  int code = APP_FAILED;
  bool ready = app_agree(
      a, settings_ground(a, s) && resume_places(a, s->restart, &s->checkpoint, &s->out) &&
             (a->rank > 0 || (output_directory(a, s->out) && summary_reserve(a, s->out))));
  app_leave_at_once(a, ready && !a->domain); /* no hook reaches into building */
  ready = ready && app_agree(a, files_peek(a, s) && settings_signal(a, s, &sim.signal));
  ready = ready && app_agree(a, build_ground(a, s, &sim));
  if (ready) sim.duration = find_duration(s, &sim);
  ready = ready && app_agree(a, build_solver(a, s, &sim));
  app_leave_at_once(a, false);
  if (ready) {
    code = march(a, s, &sim, &x);
    if (!files_close(a, &sim.files, x.end == OUTCOME_DIVERGED, x.end == OUTCOME_INTERRUPTED) &&
        code == APP_OK)
      code = APP_FAILED;
    if (sim.record.rows > 1 && !finish(a, s, &sim, &x) && code == APP_OK) code = APP_FAILED;
    if (sim.record.rows <= 1 && code == APP_INTERRUPTED && a->rank == 0 && !summary_bare(a, s->out))
      code = APP_FAILED;
    if (code == APP_FAILED) app_agree(a, false); /* all ranks know */
  }
  files_destroy(&sim.files);
  destroy(&sim);
  return code;
}

int main(int argc, char **argv) {
  settings s;
  app a;
  const int code = settings_parse(&s, argc, argv);
  if (code >= 0) return code;
  if (!app_start(&a, "mps-wave", s.threads)) return app_finish(&a, APP_FAILED);
  return app_finish(&a, run(&a, &s));
}
