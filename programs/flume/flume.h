/* flume.h - common declarations of mps-flume: settings, model, records of a run.
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef EXAMPLES_FLUME_H
#define EXAMPLES_FLUME_H

#include "common/document.h"
#include "common/output.h"
#include "common/resume.h"
#include "common/rows.h"
#include "common/waves.h"

#include <mps/body.h>
#include <mps/io.h>
#include <mps/experimental/wave_loads.h>
#include <mps/experimental/waves.h>
#include <mps/fluid.h>

enum { FLUME_REGULAR = 0, FLUME_JONSWAP, FLUME_PM, FLUME_FOCUSED, FLUME_FILE, FLUME_SOLITARY };
enum { FLUME_OPEN_END = 0, FLUME_VERTICAL, FLUME_CAISSON, FLUME_SLOPE, FLUME_PROFILE };
enum { FLUME_RETURNS = 0, FLUME_LEAVES };
enum { FLUME_ACTIVE = 0, FLUME_ZONE, FLUME_NONE };
enum { FLUME_POINTS = 64, FLUME_ROCKS = 8, FLUME_PROBES = 32, FLUME_GAUGES = 16 };
enum { FLUME_BED = 0, FLUME_MAKER, FLUME_END, FLUME_BODY }; /* boundaries of the fluid */

/* Radius of the weights in rock, in spacings, at most (mps/experimental/fluid_rock.h). */
#define FLUME_ROCK_RADIUS 3.6

/* Periods in which water that has passed the crest returns: with q = 1e-3 m2/s of a flume of 1.9 m2
 * .15 % of the water is on its way. */
#define FLUME_REFILL_PERIODS 2.0

/* Periods 2 pi/(k c) of a solitary wave after which its crest is asked for at the maker's place:
 * mps_waves has it at 4/(k c). */
#define FLUME_SOLITARY_START (2.0 / WAVES_PI)

/* A region of rock, in any convex or concave polygon. */
typedef struct flume_rock {
  int32_t corners;
  double corner[FLUME_POINTS][2];                    /* m */
  double porosity, diameter, alpha, beta, KC, gamma; /* mps_fluid_rock_def; NaN: its default */
} flume_rock;

/* What the flume is made of, by options or the model file. */
typedef struct flume_shapes {
  int32_t bed, structure, body, rocks, probes; /* counts; bed 0: a plane at height 0 */
  double bed_point[FLUME_POINTS][2];           /* m, from the foot of the maker, 0,0 */
  double structure_point[FLUME_POINTS]
                        [2];          /* m, face from the toe over the crest to its rear edge */
  double body_point[FLUME_POINTS][2]; /* m, clockwise: a caisson in the water, on rock */
  flume_rock rock[FLUME_ROCKS];
  double probe[FLUME_PROBES][2]; /* m, on the faces */
} flume_shapes;

typedef struct flume_settings {
  int waves, wall, absorb, form, order, random; /* FLUME_..., mps_absorber_form, mps_waves_theory */
  int closed;                                   /* the far end behind a structure */
  int leaves;                                   /* FLUME_RETURNS: what has passed the crest */
  int solver;                                   /* of the pressure: waves_choose_solver */
  double tolerance;                             /* of its residual */
  double depth, length, spacing;                /* m; length: to the toe of the wall, or the end */
  double height, period, gamma, repeat, ramp;   /* of the waves */
  double focus[2];                              /* m, s */
  double stroke, speed;                         /* m, m/s: of the maker, NaN: no limit */
  double zone, rate;                            /* wave lengths; 1/period */
  double crest, cotangent, width;               /* m, 1, m: of the wall */
  double density, friction;                     /* kg/m3, 1: of the caisson */
  double roughness;                             /* friction factor of the ground and the body */
  double dt;                                    /* s, at most */
  double duration, sample, disturb;             /* s, s, spacings */
  double gauge[FLUME_GAUGES], window[2];        /* m, s */
  flume_rock rock;                              /* of --rock, and what others have by default */
  int64_t seed, frames, animation, threads;
  double every_checkpoint; /* s */
  const char *file, *column, *out, *checkpoint, *restart, *model, *gauges, *profile, *rocks;
} flume_settings;

typedef struct flume_sample {
  double t, maker, end;       /* s, m, m: displacements of the pistons */
  double level[FLUME_GAUGES]; /* m above the water at rest */
  double force, moment;       /* N, N m about the heel of a structure, the foot of a wall: on it */
  double uplift, uplift_moment; /* N, N m about the heel: below a body on rock */
  double foot;                  /* Pa, before it */
  double volume, returned;      /* m2: has passed the crest so far, and returned to the flume */
  double water;                 /* m2: before the rear edge of the crest */
  double head; /* m: level before an upright face, above its crest; NaN: there is none */
  double run_up, resolved; /* m above the water at rest: end of the tongue on a slope, and of its
                              part that is a spacing thick; NaN: there is none */
  double layer; /* m above the water at rest: farthest particle of the layer on the slope */
  double probe[FLUME_PROBES]; /* Pa */
} flume_sample;

/* x, y (m), pressure (Pa) of each particle, and of points along the faces. */
typedef struct flume_look {
  double t, force; /* s, N */
  int64_t count, faces, room, face_room;
  float *value, *face;
} flume_look;

/* Loads of water at rest on the structure, and what is needed for its safeties. */
typedef struct flume_rest {
  double force, moment, foot, uplift; /* N, N m, Pa, N */
  double uplift_moment;               /* N m about the heel */
  double weight, arm;                 /* N in still water, m from the heel; of a caisson */
} flume_rest;

/* Cells of half a spacing that water at rest fills. */
typedef struct flume_cells {
  int64_t columns, rows;
  double lower, pitch; /* m: of the lowest row; of a cell */
  unsigned char *wet;
} flume_cells;

/* What a piston returns by, m: its mean place over some periods, and that over a shorter time; the
 * level at its face above the asked one over a period, the mean of that, and what of the level is
 * not absorbed. */
typedef struct flume_mean {
  double middle, place, slow, level, offset;
  double speed; /* m/s, of the return */
} flume_mean;

typedef struct flume {
  flume_settings s;
  const option *table;
  int gauges, fronts, rears;
  int front[FLUME_GAUGES], rear[FLUME_GAUGES]; /* gauges before and behind structure and rock */
  double wave_length, toe, outlet;             /* m; x of the far end */
  double heel[2];                              /* m: rear foot of the structure */
  flume_shapes shape;
  double ground[2 * FLUME_POINTS + 4][2]; /* m: bed, structure and the bed behind as one polyline */
  bool bedded;                            /* rock is below the middle of the body's base */
  int grounds, first, last; /* corners; segments of the structure, from the first to before last */
  flume_cells cells;
  flume_rest rest;
  int32_t probe_wall[FLUME_PROBES]; /* FLUME_BED, FLUME_END or FLUME_BODY */
  double record_height;             /* m: 4 standard deviations of the record of a file */
  document *text;                   /* the model file; NULL: none */
  mps_signal *record;               /* of --waves file */
  mps_waves *waves;
  mps_absorber *maker, *end;
  mps_particles *water;
  mps_fluid *fluid;
  mps_recorder *series;
  result_rows rows;
  const flume_sample *sample; /* of `rows` */
  int64_t samples, capacity;
  int64_t filled, returned; /* particles: at the start, that have returned */
  flume_mean mean[2];       /* of the maker and the far piston */
  double due;               /* part of the next particle that returns, 0 to 1 */
  flume_look look;          /* of the largest force */
  flume_look *frame;        /* of the animation */
  int64_t frames, frame_room;
  mps_fluid_report report;
  resume_schedule saves;
  double restarted; /* s, NaN: from the start */
  app *a;           /* borrowed */
  char why[400];    /* reason against a restart; "": recorded by the library */
} flume;

/* A polyline with the bed; a closed body in the water; anything that bears a force. */
static inline bool flume_has_structure(const flume *m) { return m->shape.structure > 0; }
static inline bool flume_has_body(const flume *m) { return m->shape.body > 0; }
static inline bool flume_is_loaded(const flume *m) {
  return flume_has_structure(m) || flume_has_body(m) || m->s.wall == FLUME_VERTICAL;
}
/* Water leaves behind the structure. */
static inline bool flume_is_open(const flume *m) { return flume_has_structure(m) && !m->s.closed; }
/* It stands by its weight: it has safeties. A body without rock below is held where it is. */
static inline bool flume_is_caisson(const flume *m) {
  return m->bedded || m->s.wall == FLUME_CAISSON;
}

/* options.c: the model of the command line and its file; *code: -1 to continue, or the exit code.
 */
flume *flume_read(int argc, char **argv, int *code);
/* file.c. options_refuse, with the line of the model file where the reason names an option that is
 * a key there. */
int flume_refuse(const options_program *program, const flume *m, const char *reason);
/* Returns -1, or the exit code after one error line. */
int flume_read_file(const options_program *program, flume *m);
/* Reads texts of points X,Y in m separated by commas, at most `most` of them; false when it is
 * none. */
bool flume_read_points(const char *text, int most, double (*point)[2], int32_t *count);
/* check.c: completes the settings and checks them; likewise. */
int flume_check(const options_program *program, flume *m);
/* sides.c: sides of shapes that are too short or cross one another, bodies and rock that lie where
 * they must not; likewise. flume_refuse_at adds the line of the model file of the point `at`. */
int flume_refuse_at(const options_program *program, const flume *m, const char *key,
                    const double *at, const char *why);
int flume_check_sides(const options_program *program, const flume *m, const char *what, int count,
                      bool closed, const double (*at)[2]);
int flume_check_body(const options_program *program, const flume *m);
int flume_check_rock(const options_program *program, const flume *m);
/* unused.c: refuses options that the rest of the model makes no use of; likewise. */
int flume_check_unused(const options_program *program, const flume *m);

/* shapes.c: the ground as one polyline, solids, rock, water at rest. */
void flume_make_ground(flume *m);
bool flume_is_solid(const flume *m, double x, double y);
/* Height (m) of the ground over a station, the highest where it hangs over; -INFINITY: none. */
double flume_ground_at(const flume *m, double x);
/* Depth (m) of the water at rest at the far end; whether a piston can follow its level there. */
double flume_end_depth(const flume *m);
bool flume_end_is_wet(const flume *m);
/* Whether segments p-q and r-s cross inside both, and their distance (m). */
bool flume_cross(const double *p, const double *q, const double *r, const double *s);
double flume_distance(const double *p, const double *q, const double *r, const double *s);
bool flume_in_rock(const flume_rock *r, double x, double y);
/* Number of the first rock at a point, -1: none. */
int flume_rock_at(const flume *m, double x, double y);
/* Distance (m) of a point from bed, structure and body. */
double flume_face_distance(const flume *m, const double *x);
/* The nearest point of these faces and the far end; *wall: its boundary. Returns the distance. */
double flume_nearest_face(const flume *m, const double *x, double *on, int32_t *wall);
bool flume_fill_cells(flume *m);
bool flume_is_wet(const flume *m, double x, double y);
/* gauges.c: the default ones, and which lie before and behind structure, rock, a
 * change of the bed and zone. */
void flume_place_gauges(flume *m);
/* fill.c: particles of the water at rest, appended. */
/* *cut: whether faces cut the lattice. */
mps_status flume_fill(const flume *m, mps_particles *water, bool *cut);
mps_status flume_clear_faces(const flume *m);

/* waves.c: the sea, and the pistons that absorb. */
mps_status flume_make_waves(app *a, flume *m);
mps_status flume_make_pistons(app *a, flume *m);
/* model.c: water, walls, structure; flume_rows sets `sample` from `rows`. */
void flume_rows(flume *m);
mps_status flume_build(app *a, flume *m);
void flume_free(flume *m);
/* loads.c: weight (N) of a caisson in still water. */
double flume_weight(flume *m);
/* Forces, moments, uplift and pressures of the present water; of water at rest. */
mps_status flume_measure_loads(flume *m, flume_sample *sample);
mps_status flume_look_at(flume *m, flume_look *look, bool faces);
/* Room for that many particles; false without memory. */
bool flume_look_room(flume_look *look, int64_t count);
void flume_find_rest(flume *m);
/* climb.c: whether the structure has a crest over an upright face, a slope where it leaves the
 * water; head and tongue of the present water. */
bool flume_has_head(const flume *m);
bool flume_has_slope(const flume *m);
mps_status flume_measure_climb(flume *m, flume_sample *sample);
/* refill.c: water that has passed the crest, returned after a step of `dt` (s). */
int64_t flume_count_water(const flume *m);
mps_status flume_refill(flume *m, double dt);
/* warnings.c: of waves, gauges and shapes that a run makes little of. */
void flume_warn(app *a, const flume *m);
/* After the run. */
void flume_warn_of_collisions(app *a, const flume *m);
/* run.c: displacement (m) of the maker; steps to the end, or until Ctrl-C, which leaves a
 * checkpoint. */
double flume_maker_place(const flume *m);
mps_status flume_run(app *a, flume *m);
/* Size (s) of the next step: that asked for, or less where the water is fast. */
double flume_dt(const flume *m);
/* restart.c. flume_peek compares the options of the file with these before the model is built. */
mps_status flume_save(void *user);
mps_status flume_peek(mps_context *context, flume *m);
mps_status flume_restore(mps_context *context, flume *m);

/* What a run is about, from the samples of its window. */
typedef struct flume_figures {
  double from, to; /* s, as used */
  bool separated;  /* there are incident and reflected waves */
  mps_separation split;
  bool passed; /* there are waves behind structure, rock or a change of the bed */
  mps_separation behind;
  int64_t bands;
  double *frequency, *incident, *reflected, *target; /* Hz, m: amplitudes */
  double target_height; /* m, Hm0 of the linear target at the gauges in the same window */
  double force_still, force_peak, force_least, peak_at, foot_peak; /* N, N, N, s, Pa above rest */
  double force_mean, force_harmonic, force_linear; /* N: of regular waves, see regular.c */
  double force_sainflou;                           /* N: under the crest, above rest */
  double sliding, overturning; /* least safeties of the caisson: uplift a triangle */
  double sliding_bedding, overturning_bedding; /* uplift as computed in the rock below it */
  double uplift_peak, uplift_triangle;         /* N, above rest, at the largest force */
  double discharge;                            /* m2/s */
  double *thin;        /* m2: of events too low for particles, so far at each sample; NULL: none */
  int64_t thin_events; /* of all times */
  double thrown;       /* m2/s: part of `discharge` that has passed the crest of a slope whose layer
                          has not come to it; NAN: no slope */
  int64_t climbs;      /* of the window, up a slope */
  double run_up_layer; /* m: what 2 % exceed by the layer on the slope */
  double run_up, run_up_mean, run_up_highest; /* m above the water at rest: what 2 % exceed; of the
                                                 highest reading of each climb */
  mps_eurotop_run_up formula;
  bool has_formula;
  double reflection;           /* of a sea from a smooth dike, by formula; NAN: none */
  double mean_level;           /* m above that at rest, of the gauges before */
  double mean_maker, mean_end; /* m from their places, into the water; NAN: no piston there */
  double water;                /* mean of the water before the crest, over that at the start */
  double loss;                 /* of the height, a wave length */
  double bound, bound_stokes, unbound, back, length; /* of regular waves, m the last: harmonics.c */
  double crest_first, crest_last, speed, trailing;   /* of a solitary wave: solitary.c; m, m, m/s;
                                                        over   the height */
  mps_goda goda;
  mps_eurotop eurotop;
  bool has_goda, has_eurotop;
  double front, crest; /* m: x of the front edge of a caisson's base; its crest above the water */
} flume_figures;

/* Waves of a gauge by crossings of the mean level upwards. */
typedef struct flume_statistics {
  int64_t waves;
  double mean, Hm0;             /* m above the water at rest; m, 4 standard deviations */
  double third, tenth, highest; /* m: mean heights of the highest third, tenth; the highest */
  double period, skewness;      /* s, mean; of the levels */
} flume_statistics;

/* separate.c: split to target_height, passed, behind. False after an error line. */
bool flume_separate(app *a, const flume *m, flume_figures *f);
/* statistics.c. False without memory. */
bool flume_find_statistics(const flume *m, int gauge, double from, double to, flume_statistics *s);
/* regular.c: force_mean and those after it, of an upright wall. */
void flume_find_regular_forces(const flume *m, flume_figures *f);
/* solitary.c: crest_first and those after it, NAN where there is none. */
void flume_find_solitary(const flume *m, flume_figures *f);
/* climb.c. False after an error line. Mean discharge (m2/s) of `thin` between two times, NAN where
 * there is none. */
bool flume_find_thin(app *a, const flume *m, flume_figures *f);
void flume_find_thrown(app *a, const flume *m, flume_figures *f);
bool flume_find_run_up(app *a, const flume *m, flume_figures *f);
double flume_thin_between(const flume *m, const flume_figures *f, double from, double to);
/* harmonics.c: bound and those after it, NAN where the gauges are too near. */
void flume_find_harmonics(const flume *m, flume_figures *f);
/* figures.c. False after an error line. */
bool flume_find_figures(app *a, flume *m, flume_figures *f);
void flume_free_figures(flume_figures *f);
/* results.c: tables and summary; pictures.c, and of the water water.c. */
bool flume_write(app *a, flume *m);
bool flume_draw(app *a, const flume *m, const flume_figures *f);
bool flume_draw_water(app *a, const flume *m);

#endif
