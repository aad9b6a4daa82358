/* tank.h - common declarations of mps-tank: the settings, the model, the records of a run.
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef EXAMPLES_TANK_H
#define EXAMPLES_TANK_H

#include "common/output.h"
#include "common/resume.h"
#include "common/rows.h"
#include "common/waves.h"

#include <mps/body.h>
#include <mps/experimental/coupling.h>
#include <mps/fluid.h>
#include <mps/io.h>

enum {
  TANK_STILL = 0,
  TANK_SLOSHING,
  TANK_PISTON,
  TANK_SPRING,
  TANK_PLATE,
  TANK_DROP,
  TANK_RESONANCE,
  TANK_FLOAT,
  TANK_KINDS
};
enum { TANK_SHAPES = 6, TANK_GAUGES = 8, TANK_BED = 0, TANK_LEFT = 1, TANK_RIGHT = 2 };

typedef struct tank_settings {
  int kind;         /* TANK_... */
  int scheme;       /* 1: classical */
  int solver;       /* of the pressure: waves_choose_solver */
  double tolerance; /* of its residual */
  double length, depth, spacing, amplitude, period, ramp, duration, sample, dt, viscosity, disturb;
  double mass, stiffness; /* kg and N/m, of a wall of 1 m */
  double ratio;           /* of the waves' frequency to that of the wall in water */
  double width, draft;    /* m, of the box that floats */
  double plate_length, plate_thickness, young, poisson, plate_density;
  double gauge[TANK_GAUGES]; /* m, NaN where there is none */
  double window[2];          /* s: of the harmonics and means */
  double density_at;         /* m: x of a vertical line; NaN: none */
  int64_t threads, frames;
  double every_checkpoint; /* s */
  const char *out, *checkpoint, *restart;
} tank_settings;

/* A moment of the run; of a drop only the last three. */
typedef struct tank_sample {
  double t, left, right,
      level[TANK_GAUGES +
            1];        /* s, N, N, m above the water at rest; the last gauge is at the right wall */
  double a, b, centre; /* m, m, Pa */
  double kinetic, potential; /* J */
  double deflection; /* m: of the wall into the water, of the plate downwards, of the box upwards */
} tank_sample;

typedef struct tank_motion {
  double d, v, a; /* m, m/s, m/s2 */
} tank_motion;

/* A structure coupled with the water: shapes, each with its mass, stiffness and motion along the
 * normal of a wall, into the water. */
typedef struct tank_structure {
  int shapes, wall;
  double mass[TANK_SHAPES], stiffness[TANK_SHAPES], load[TANK_SHAPES]; /* kg, N/m, N */
  double start;                         /* m: the spring's first displacement */
  double alpha_m, alpha_f, beta, gamma; /* of the generalised-alpha method */
  tank_motion at[TANK_SHAPES];
  double force[TANK_SHAPES]; /* N, at the middle of the last step; NaN before the first */
  int64_t points;            /* of the plate; 0: the wall stays plane */
  double *x, *shape, each;   /* m; values of each shape; m between them */
  double *pressure, *displacement, *velocity; /* at the points */
  mps_coupling *coupling;
  double *memory; /* of the coupling: between steps, before the step under way */
  int64_t room, learnt;
} tank_structure;

typedef struct tank_model {
  tank_settings s;
  mps_particles *water;
  waves_piston motion;
  mps_signal *piston;
  mps_fluid *fluid;
  mps_body *box;
  tank_structure structure;
  mps_recorder *series;
  result_rows rows;
  const tank_sample *sample; /* of `rows` */
  int64_t samples, capacity;
  double roll;         /* rad: of the box, the largest since the start or restart */
  tank_sample *linear; /* tank_linear at the samples, NULL where there is no piston */
  mps_fluid_report report;
  const option *table;
  resume_schedule saves;
  double restarted; /* s, NaN: from the start */
  app *a;           /* borrowed */
  char why[400];    /* reason against a restart; "": recorded by the library */
} tank_model;

static inline bool tank_is_coupled(const tank_settings *s) {
  return s->kind == TANK_SPRING || s->kind == TANK_PLATE || s->kind == TANK_RESONANCE;
}

/* Whether something moves with the water. */
static inline bool tank_swings(const tank_settings *s) {
  return tank_is_coupled(s) || s->kind == TANK_FLOAT;
}

/* model.c: water, walls, fluid; a run that fills `sample`; tank_look sets it from `rows`. */
void tank_look(tank_model *m);
mps_status tank_build(app *a, tank_model *m);
mps_status tank_run(app *a, tank_model *m);
void tank_free(tank_model *m);

/* restart.c. tank_peek compares the options of the file with these before the model is built. */
mps_status tank_save(void *user);
mps_status tank_peek(mps_context *context, tank_model *m);
mps_status tank_restore(mps_context *context, tank_model *m);

/* coupled.c */
mps_status tank_make_structure(mps_context *context, tank_model *m);
void tank_free_structure(tank_structure *p);
mps_status tank_coupled_step(tank_model *m);
/* Saves and restores the memory of the coupling; nothing without a structure. */
mps_status tank_remember(tank_structure *p);
mps_status tank_recall(tank_structure *p);
double tank_deflection(const tank_model *m); /* m: of the wall, of the plate's middle */

/* theory.c */
/* The clamped plate in cylindrical bending: rigidity of 1 m (N m), roots of cos r cosh r = 1,
 * shapes at x/L whose mean square is 1; deflection (m) of the middle under water and own weight. */
double tank_plate_rigidity(const tank_settings *s);
double tank_plate_root(int k);
double tank_plate_shape(int k, double at);
double tank_plate_deflection(const tank_settings *s);
/* Frequency (rad/s) of the wall on a spring and of the plate, with the water's added mass by linear
 * potential flow. */
double tank_spring_omega(const tank_settings *s);
double tank_plate_omega(const tank_settings *s);
/* Added mass (kg) of the end wall of a tank (length INFINITY: of an infinite flume) that oscillates
 * with w (rad/s), without the part of the travelling wave. */
double tank_added_mass(double w, double length, double depth);
/* Semi-axes (m) and pressure in the middle (Pa) of the drop of radius R at time t. */
void tank_drop(double radius, double t, double *a, double *b, double *centre);

/* afloat.c: the box; its place in the water; stiffness (N/m) and period (s) of its heave. */
mps_status tank_make_box(mps_context *context, tank_model *m);
mps_status tank_launch(tank_model *m);
bool tank_in_box(const tank_settings *s, double x, double y);
double tank_float_stiffness(const tank_settings *s);
double tank_float_period(const tank_settings *s);

/* linear.c: waves of a piston before a wall. */
typedef struct tank_response {
  double added_mass, damping; /* kg, N s/m: of the waves that the wall sends out */
  double amplitude, lag;      /* m; rad, behind the force of the waves on a wall at rest */
  double ratio;               /* of the waves' frequency to the wall's in water */
} tank_response;
/* The steady part in an infinite flume. */
void tank_flume(const tank_settings *s, tank_response *r);
/* Stiffness (N/m) of the wall whose frequency is the waves' over `ratio`. */
double tank_resonant_stiffness(const tank_settings *s, double ratio);
/* In the closed tank, from rest, at the times of the samples: levels, deflection of the wall, and
 * the force on it above that of water at rest. */
mps_status tank_linear(const tank_settings *s, int64_t count, const tank_sample *sample,
                       tank_sample *out);

/* density.c: how far the line must be from the walls (m); its table and picture, nothing without
 * one. */
double tank_density_reach(const tank_settings *s);
bool tank_write_density(app *a, const tank_model *m);
/* results.c: tables, summary, pictures, the last lines on stdout. */
bool tank_write(app *a, tank_model *m);
/* theory.c: warns of motions beyond the range of model and theory. */
void tank_warn(app *a, const tank_model *m);

#endif
