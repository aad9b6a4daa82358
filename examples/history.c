/* history.c - a table of numbers in time that belongs to a run: it is part of snapshots and
 * checkpoints, and a CSV file follows it. A layer of soil on rock oscillates in its first mode, by
 * explicit MPS; the period is read from the table, against 4 H/Vs.
 * SPDX-License-Identifier: BSD-3-Clause */
#include <mps/dynamics.h>
#include <mps/history.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

static const char *const file = "example-history.csv";
static const double height = 10.0, vs = 100.0; /* m, m/s */
static const double spacing = 10.0 / 40.5;     /* m */

/* Stops where a call fails, with the library's message. */
static void ok(mps_status status) {
  if (status == MPS_OK) return;
  fprintf(stderr, "%s\n", mps_last_error()->message);
  exit(1);
}

/* One line of the results; 1 where `got` is farther from the right value than `bound`. */
static int compare(const char *what, double got, double right, double bound) {
  printf("%-44s %11.5g   right: %11.5g +- %.2g\n", what, got, right, bound);
  return !(fabs(got - right) <= bound);
}

/* The rock's surface passes through the lowest row; velocities are those of the first mode. */
static void make(mps_context *context, mps_particles **soil, mps_dynamics **dynamics) {
  const double lo[2] = {0.0, -0.5 * spacing}, hi[2] = {8.0 * spacing, height};
  mps_particles_def set = mps_particles_defaults();
  set.spacing = spacing, set.origin[1] = lo[1];
  ok(mps_particles_create(context, &set, soil));
  ok(mps_particles_fill_box(*soil, lo, hi, NULL));
  ok(mps_particles_set(*soil, "density", 0, 1800.0));
  ok(mps_particles_set(*soil, "shear_velocity", 0, vs));
  ok(mps_particles_set(*soil, "pressure_velocity", 0, 2.0 * vs));
  mps_edit v;
  mps_view x;
  ok(mps_particles_add_field(*soil, "velocity", 0));
  ok(mps_particles_edit(*soil, "velocity", &v));
  ok(mps_particles_view(*soil, "position", &x));
  for (int64_t i = 0; i < x.shape[0]; i++)
    *mps_edit_f64(&v, i, 0) = 0.1 * sin(0.5 * acos(-1.0) * *mps_view_f64(&x, i, 1) / height);
  ok(mps_particles_commit(*soil, &v));

  mps_dynamics_def def = mps_dynamics_defaults();
  mps_dynamics_boundary_def rock = mps_dynamics_boundary_defaults();
  def.period_x = 8.0 * spacing;
  rock.upper[1] = 0.1 * spacing; /* held, free to turn */
  rock.dofs = MPS_DOF_X | MPS_DOF_Y;
  ok(mps_dynamics_create(context, *soil, &def, dynamics));
  ok(mps_dynamics_add_boundary(*dynamics, &rock, NULL));
}

typedef struct run {
  mps_particles *soil;
  mps_dynamics *dynamics;
  mps_history *history;
  int64_t surface; /* id */
} run;

/* A column of the table that the library asks for itself. */
static mps_status kinetic(void *user, mps_solver *solver, double *value) {
  mps_totals totals;
  (void)user;
  const mps_status status = mps_solver_get_totals(solver, &totals);
  *value = totals.kinetic;
  return status;
}

/* In the callback of the run: a row, with the column that the program gives. */
static mps_status note(void *user, mps_dynamics *dynamics) {
  const run *r = user;
  mps_view u;
  (void)dynamics;
  ok(mps_particles_view(r->soil, "displacement", &u));
  const double surface = *mps_view_f64(&u, mps_particles_index(r->soil, r->surface), 0);
  return mps_history_record(r->history, NAN, &surface, 1);
}

int main(void) {
  static const char *const names[2] = {"surface", "kinetic"}, *const units[2] = {"m", "J"};
  const double top[2] = {0.0, height};
  mps_context *context = NULL;
  run r = {0};
  ok(mps_context_create(NULL, &context, NULL, 0));
  make(context, &r.soil, &r.dynamics);
  r.surface = mps_particles_nearest(r.soil, top);
  ok(mps_history_create(mps_dynamics_solver(r.dynamics), "swing", names, units, 2, &r.history));
  ok(mps_history_set_source(r.history, "kinetic", kinetic, NULL, NULL));
  ok(mps_history_open(r.history, file, 100)); /* t_s, surface_m, kinetic_J; in blocks of 100 rows */
  ok(mps_dynamics_run(r.dynamics, 2.0, 1, note, &r));
  ok(mps_history_flush(r.history));

  /* the surface passes its place at rest, upwards in time, once a period */
  mps_view t, u;
  double first = NAN, last = NAN, periods = -1.0;
  ok(mps_history_view(r.history, "t", &t));
  ok(mps_history_view(r.history, "surface", &u));
  for (int64_t i = 1; i < mps_history_count(r.history); i++) {
    const double a = *mps_view_f64(&u, i - 1, 0), b = *mps_view_f64(&u, i, 0);
    if (a >= 0.0 || b < 0.0) continue;
    last = *mps_view_f64(&t, i, 0) -
           (*mps_view_f64(&t, i, 0) - *mps_view_f64(&t, i - 1, 0)) * b / (b - a);
    if (periods++ < 0.0) first = last;
  }
  const double period = 4.0 * height / vs;
  int wrong = compare("period, s", (last - first) / periods, period, 0.005 * period);

  int64_t lines = 0;
  FILE *table = fopen(file, "r");
  for (int c; table && (c = fgetc(table)) != EOF;) lines += c == '\n';
  if (table) fclose(table);
  wrong += compare("lines of the file, with the names", (double)lines,
                   (double)mps_dynamics_steps(r.dynamics) + 2.0, 0.0);

  mps_history_destroy(&r.history);
  mps_dynamics_destroy(&r.dynamics);
  mps_particles_destroy(&r.soil);
  mps_context_destroy(&context);
  remove(file); /* here alone: a program would keep it */
  return wrong > 0;
}
