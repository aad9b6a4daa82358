/* mps/experimental/waves.h - waves for a flume: seas and the motion of a piston that makes them,
 * the level that is asked for at any station, absorbing pistons, separation of incident and
 * reflected waves.
 *
 * A sea (mps_waves) is a sum of linear waves over a flat bed and what second-order theory adds to
 * it,
 *
 *   eta(x, t) = sum_n Re A_n exp(i (omega_n t - k_n x)) + sum_nm of sums and differences,
 *
 * x (m) from the mean position of the piston into the water, t (s). It is immutable after creation
 * and may be shared by objects and threads. Nothing here uses a solver: the sea gives a signal or
 * numbers, levels that a solver or an instrument has measured come in as numbers. docs/waves.md has
 * the equations, docs/references.md the sources. Loads of waves on walls are in
 * mps/experimental/wave_loads.h.
 *
 * A quantity that must be > 0 is 1e-12 to 1e12 in SI units, so that no answer overflows.
 *
 * Thread rule: one thread at a time per context for the functions that can fail.
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef LIBMPS_EXPERIMENTAL_WAVES_H
#define LIBMPS_EXPERIMENTAL_WAVES_H

#ifndef MPS_EXPERIMENTAL
#error                                                                                             \
    "experimental interface, which may change in any minor release: #define MPS_EXPERIMENTAL first"
#endif

#include "../context.h"
#include "../signal.h"

MPS_EXTERN_C_BEGIN

/* ---- seas ------------------------------------------------------------------------------------ */

typedef struct mps_waves mps_waves;

typedef enum mps_waves_kind {
  MPS_WAVES_REGULAR = 0,           /* one wave */
  MPS_WAVES_JONSWAP = 1,           /* Hasselmann et al. (1973) */
  MPS_WAVES_PIERSON_MOSKOWITZ = 2, /* Pierson and Moskowitz (1964): JONSWAP of gamma 1 */
  MPS_WAVES_SPECTRUM = 3,          /* a table of the caller */
  MPS_WAVES_RECORD = 4,            /* a level in time */
  MPS_WAVES_SOLITARY = 5           /* one wave of Boussinesq, height sech^2(k (c t - x) - 4), c^2 =
                                                gravity (depth + height), k^2 = 3 height/(4 depth^3), up to .7
                                                depth; the piston (Goring 1979) starts at t = 0 and comes to
                                                rest 2 height/(k depth) ahead */
} mps_waves_kind;

/** How the components of a spectrum are combined. */
typedef enum mps_waves_phases {
  MPS_WAVES_PHASES_RANDOM = 0,     /* amplitudes by the spectrum, phases by the seed */
  MPS_WAVES_PHASES_AMPLITUDES = 1, /* both by the seed: a^2 times -ln(r), r in (0, 1), as in a
                                      Gaussian sea */
  MPS_WAVES_PHASES_FOCUSED = 2 /* all crests at `position` at `time`, amplitudes in proportion to
                                  the spectrum (Tromans, Anaturk and Hagemeijer 1991) */
} mps_waves_phases;

/** Theory of levels and of the piston. */
typedef enum mps_waves_theory {
  MPS_WAVES_THEORY_SECOND = 0, /* sums and differences of all pairs of components, and the piston's
                                  motion that makes no free waves with them (Schaeffer 1996) */
  MPS_WAVES_THEORY_LINEAR = 1, /* the piston by its linear transfer alone */
  MPS_WAVES_THEORY_NARROW = 2, /* differences alone, by the limit of a narrow band: for more
                                  components than SECOND takes */
  MPS_WAVES_THEORY_STREAM = 3  /* REGULAR, k depth <= 1: waves of the stream function (Rienecker and
                                  Fenton 1981), and the piston by their flux (Goring 1979) */
} mps_waves_theory;

/** Definition of a sea; always start from mps_waves_defaults. */
typedef struct mps_waves_def {
  uint32_t struct_size;
  int32_t kind;   /* mps_waves_kind, default REGULAR */
  int32_t phases; /* mps_waves_phases, default RANDOM; read for spectra */
  int32_t theory; /* mps_waves_theory, default SECOND */
  double depth;   /* m, of the water at rest, > 0; no default */
  double gravity; /* m/s2, > 0; default 9.81 */
  double height; /* m: height of a regular wave (of first order), Hm0 of a spectrum, scaled to it; >
                    0; no default. Not read with a record; NaN with SPECTRUM: that of the table */
  double period; /* s, > 0: of a regular wave, of the peak (1/fp); no default. SPECTRUM, RECORD: NaN
                    (default) takes that of the largest component. Not of SOLITARY */
  double gamma;  /* peak enhancement of JONSWAP, 1 to 20; default 3.3 */
  double repeat; /* s: the sea repeats itself, its frequencies are multiples of 1/repeat; at least 2
                    periods. NaN (default): 100 periods; of a record its length. Not of REGULAR
                    and SOLITARY */
  double lower,
      upper;       /* frequencies over that of the peak, 0 < lower < upper <= 10; default .6, 2.5 */
  double crest;    /* m, FOCUSED: linear crest at the focus, > 0; no default */
  double position; /* m from the piston, >= 0: of the focus, of a record; default 0 */
  double time;     /* s: of the focus, finite; no default */
  double ramp;     /* s, >= 0: the piston's motion rises from rest; NaN (default): 2 periods. Not of
                    SOLITARY */
  double
      stroke; /* m, > 0: farthest position of the piston on either side; NaN (default): no limit */
  double speed;            /* m/s, > 0: its highest speed; NaN (default): no limit */
  int64_t seed;            /* of random phases and amplitudes; default 1 */
  int64_t count;           /* SPECTRUM: rows of the table, >= 2 */
  const double *frequency; /* Hz, > 0, strictly increasing; `count` values, copied */
  const double *density;   /* m2 s, >= 0, linear between rows; `count` values, copied */
  int64_t samples;         /* RECORD: >= 8 */
  const double *times;     /* s, evenly spaced to 1e-3 of the interval; `samples` values, copied */
  const double *levels;    /* m above the water at rest, finite; `samples` values, copied. Its
                              components within lower..upper are taken as linear */
} mps_waves_def;

static inline mps_waves_def mps_waves_defaults(void) {
  mps_waves_def def;
  memset(&def, 0, sizeof def);
  if (mps_def_init(MPS_DEF_WAVES, &def, sizeof def) != MPS_OK) def.struct_size = 0;
  return def;
}

/** Creates a sea. The piston's motion over `repeat` is examined: MPS_ERROR_ARGUMENT names a member
 *  of `def` that is out of range, a piston that would go beyond `stroke` or `speed` (with the value
 *  and its time) or be faster than 2 (gravity depth)^1/2, a regular wave or a sea (Hm0) higher than
 *  waves that break (.142 L tanh kd, Miche 1944), a crest or a record higher than long ones (.89
 *  depth), levels below the bed, and with SECOND a regular wave whose height L^2/depth^3 is 8
 * pi^2/3 or more, where the second order has crests of its own. SECOND takes at most 1024
 * components, the others 4096. MPS_ERROR_MEMORY. */
MPS_API MPS_NODISCARD mps_status mps_waves_create(mps_context *context, const mps_waves_def *def,
                                                  mps_waves **out);
/** Releases and nulls; accepts NULL. Objects that use the sea keep their own reference. */
MPS_API void mps_waves_destroy(mps_waves **waves);

typedef struct mps_waves_report {
  int64_t components; /* of first order; SOLITARY: 0 */
  double period; /* s: of a regular wave, of the largest component of others; SOLITARY: 2 pi/(k c)
                  */
  double wave_number; /* rad/m, of that period */
  double height;      /* m: H, or Hm0 of the components */
  double repeat;      /* s */
  double stroke[2]; /* m: least and largest displacement of the piston over `repeat`, into the water
                       positive */
  double speed;     /* m/s, highest */
  double acceleration; /* m/s2, highest */
} mps_waves_report;
/** What the sea is made of, and how far and fast the piston moves. MPS_ERROR_ARGUMENT: NULL, or a
 *  `size` unknown to this library. */
MPS_API MPS_NODISCARD mps_status mps_waves_get_report_sized(const mps_waves *waves,
                                                            mps_waves_report *out, size_t size);
static inline mps_status mps_waves_get_report(const mps_waves *waves, mps_waves_report *out) {
  return mps_waves_get_report_sized(waves, out, sizeof *out);
}

/** Components of first order in ascending frequency: at most `capacity` (>= 0) are written, `count`
 *  receives their number. `frequency` (Hz), `amplitude` (m), `phase` (rad, of the cosine at x = 0,
 *  t = 0) may be NULL. MPS_ERROR_ARGUMENT: `count` NULL, `capacity` below 0. */
MPS_API MPS_NODISCARD mps_status mps_waves_get_components(const mps_waves *waves, int64_t capacity,
                                                          int64_t *count, double *frequency,
                                                          double *amplitude, double *phase);
/** Level (m above the water at rest) of the progressive waves that are asked for, at `station` (m
 *  from the piston, >= 0) at `count` times t (s): `linear` and, with second order, `level`; either
 *  may be NULL. The mean level is left out, as is the ramp; nearer than 3 depths to the piston its
 *  evanescent modes come to this. MPS_ERROR_ARGUMENT: `station`, `count` or a time out of range;
 *  MPS_ERROR_MEMORY. */
MPS_API MPS_NODISCARD mps_status mps_waves_get_levels(const mps_waves *waves, double station,
                                                      int64_t count, const double *t,
                                                      double *linear, double *level);
/** Motion of the piston with its ramp at `count` times t (s): displacement (m, into the water),
 *  velocity (m/s), acceleration (m/s2), and the level (m) at the piston that is asked for,
 *  evanescent modes of first order included. Each but `t` may be NULL. At rest before t = 0.
 *  MPS_ERROR_ARGUMENT: `count` below 0, a time that is not finite. */
MPS_API MPS_NODISCARD mps_status mps_waves_get_piston(const mps_waves *waves, int64_t count,
                                                      const double *t, double *displacement,
                                                      double *velocity, double *acceleration,
                                                      double *level);
/** The motion of the piston as a signal, which keeps the sea alive: of a wall of mps/fluid.h whose
 *  normal shows into the water. MPS_ERROR_ARGUMENT: `waves` or `out` NULL; MPS_ERROR_MEMORY. */
MPS_API MPS_NODISCARD mps_status mps_signal_create_waves(mps_context *context, mps_waves *waves,
                                                         mps_signal **out);

/* ---- absorbing pistons ----------------------------------------------------------------------- */

/* A piston whose velocity is corrected by the level measured at its face, such that waves that come
 * back leave: u = u_asked + s (eta_asked - eta), after Schaeffer and Klopman (2000). It stands at
 * either end; displacement and velocity count into the water. The caller advances it each step:
 *
 *   mps_fluid_get_levels(fluid, 1, &station, &level);          half a spacing before its face
 *   mps_absorber_advance(absorber, t, dt, level - depth, &s, &u);   less s times its slope into
 *                                     the water: else its mean and slow part move the piston off
 *   mps_fluid_set_boundary_motion(fluid, wall, &s, &u);
 *   mps_fluid_step(fluid, 1); */

typedef struct mps_absorber mps_absorber;

typedef enum mps_absorber_form {
  MPS_ABSORBER_FORM_SHALLOW = 0, /* s = (g/depth)^1/2: complete where waves are long */
  MPS_ABSORBER_FORM_TUNED = 1    /* s = omega/c0 and the evanescent level subtracted, high-passed:
                                    complete at `period` */
} mps_absorber_form;

typedef struct mps_absorber_def {
  uint32_t struct_size;
  int32_t form;     /* mps_absorber_form, default SHALLOW */
  double depth;     /* m, > 0; no default */
  double gravity;   /* m/s2, > 0; default 9.81 */
  double period;    /* s, > 0: of the waves, which TUNED absorbs and the rates below refer to; NaN
                       (default): that of `waves` */
  double high_pass; /* rad/s, TUNED: rate f of the high-pass of the displacement, above s C, C the
                       evanescent transfer at `period`: two pistons would else run away together.
                       NaN (default): the larger of .15 times 2 pi/period and 2 s C */
  double leak;      /* 1/s, >= 0: rate at which the correction's displacement is withdrawn; NaN
                       (default): .02/period */
  double stroke;    /* m, > 0: the piston stays within; NaN (default): depth */
  double acceleration; /* m/s2, > 0: most that the correction changes the velocity by; NaN
                        * (default): 2 g
                        */
  mps_waves
      *waves; /* the sea asked for; NULL (default): still water, an absorbing end. Kept alive */
} mps_absorber_def;

static inline mps_absorber_def mps_absorber_defaults(void) {
  mps_absorber_def def;
  memset(&def, 0, sizeof def);
  if (mps_def_init(MPS_DEF_ABSORBER, &def, sizeof def) != MPS_OK) def.struct_size = 0;
  return def;
}

/** Creates the controller of one piston, at rest. MPS_ERROR_ARGUMENT names a member of `def` that
 *  is out of range; `depth` and `gravity` must be those of `waves`. MPS_ERROR_MEMORY. */
MPS_API MPS_NODISCARD mps_status mps_absorber_create(mps_context *context,
                                                     const mps_absorber_def *def,
                                                     mps_absorber **out);
/** Destroys and nulls; accepts NULL. */
MPS_API void mps_absorber_destroy(mps_absorber **absorber);
/** One step from t to t + dt (s; dt > 0): takes the `level` (m above the water at rest) at the face
 *  at time t, NaN where there is none (no correction then), and gives `displacement` (m) and
 *  `velocity` (m/s) at t + dt, into the water, the mean velocity between leading from the last
 *  displacement to this one. MPS_ERROR_ARGUMENT: a time that is not finite, `dt` not > 0, a level
 *  that is infinite, NULL. On an error nothing has changed. */
MPS_API MPS_NODISCARD mps_status mps_absorber_advance(mps_absorber *absorber, double t, double dt,
                                                      double level, double *displacement,
                                                      double *velocity);
/** Reflection coefficient (0 to 1) of the piston by linear theory for waves of `period` (s, > 0)
 *  that come to it, without limits of stroke and acceleration and without the time between level
 *  and motion. MPS_ERROR_ARGUMENT: `period` out of
 *  range, or omega^2 depth/g beyond 1e-6 to 1e4. */
MPS_API MPS_NODISCARD mps_status mps_absorber_get_reflection(const mps_absorber *absorber,
                                                             double period, double *reflection);

typedef struct mps_absorber_report {
  double displacement, velocity; /* m, m/s: present */
  double correction;             /* m: part of the displacement that is not asked for */
  int64_t limited;               /* steps in which stroke or acceleration limited the motion */
} mps_absorber_report;
/** Present state. MPS_ERROR_ARGUMENT: NULL, or a `size` unknown to this library. */
MPS_API MPS_NODISCARD mps_status mps_absorber_get_report_sized(const mps_absorber *absorber,
                                                               mps_absorber_report *out,
                                                               size_t size);
static inline mps_status mps_absorber_get_report(const mps_absorber *absorber,
                                                 mps_absorber_report *out) {
  return mps_absorber_get_report_sized(absorber, out, sizeof *out);
}

#define MPS_ABSORBER_MEMORY 5
/** The state as MPS_ABSORBER_MEMORY numbers, to keep with a checkpoint. MPS_ERROR_ARGUMENT: NULL.
 *  */
MPS_API MPS_NODISCARD mps_status mps_absorber_get_memory(const mps_absorber *absorber,
                                                         double *values);
/** Restores it: the run continues bit for bit. MPS_ERROR_FORMAT: a number that is not finite, or
 *  that is beyond the limits of this absorber; MPS_ERROR_ARGUMENT: NULL. */
MPS_API MPS_NODISCARD mps_status mps_absorber_set_memory(mps_absorber *absorber,
                                                         const double *values);

/* ---- incident and reflected waves ------------------------------------------------------------ */

typedef struct mps_separation_def {
  uint32_t struct_size;
  int32_t gauges;      /* 2 to 16; 3 to 5 that lie at unequal distances; no default */
  double depth;        /* m, > 0; no default */
  double gravity;      /* m/s2, > 0; default 9.81 */
  double from, to;     /* s: window of the analysis, of regular waves a whole number of periods; NaN
                          (default): all times */
  double lower, upper; /* Hz: band, 0 < lower < upper; no default */
  const double
      *position;       /* m along the flume, incident waves going to larger ones; `gauges` values */
  int64_t samples;     /* >= 8 */
  const double *times; /* s, strictly increasing; `samples` values; linear between them */
  const double *levels; /* m, finite; `samples` rows of `gauges` values */
} mps_separation_def;

static inline mps_separation_def mps_separation_defaults(void) {
  mps_separation_def def;
  memset(&def, 0, sizeof def);
  if (mps_def_init(MPS_DEF_SEPARATION, &def, sizeof def) != MPS_OK) def.struct_size = 0;
  return def;
}

typedef struct mps_separation {
  double incident_height;  /* m: Hm0 = 4 (sum a^2/2)^1/2 of the incident components */
  double reflected_height; /* m */
  double reflection;       /* their ratio; NaN without incident waves */
  double peak_period;      /* s: of the incident spectrum, smoothed over 1/20 of its frequency */
  double energy_period;    /* s: T(m-1,0) of the incident waves */
  double residual;    /* share of the levels' energy in the band that linear waves do not explain */
  int64_t bands;      /* frequencies in the band */
  int64_t unresolved; /* of them, those left out as the gauges lie half a wavelength apart there */
} mps_separation;

/** Incident and reflected waves by least squares over the gauges at each frequency, multiples of
 *  1/(to - from): Mansard and Funke (1980). Of at most `capacity` (>= 0) frequencies in the band
 *  `frequency` (Hz), `incident` and `reflected` amplitudes (m; 0 where the gauges do not resolve
 *  it) are written, each may be NULL; `count` (may be NULL) receives their number, `out` the sums.
 *  MPS_ERROR_ARGUMENT: a member of `def` out of range, gauges that coincide, a band without a
 *  frequency, `capacity` below 0; MPS_ERROR_MEMORY. */
MPS_API MPS_NODISCARD mps_status mps_separation_find_sized(
    mps_context *context, const mps_separation_def *def, int64_t capacity, int64_t *count,
    double *frequency, double *incident, double *reflected, mps_separation *out, size_t size);
static inline mps_status mps_separation_find(mps_context *context_, const mps_separation_def *def,
                                             int64_t capacity, int64_t *count, double *frequency,
                                             double *incident, double *reflected,
                                             mps_separation *out) {
  return mps_separation_find_sized(context_, def, capacity, count, frequency, incident, reflected,
                                   out, sizeof *out);
}

MPS_EXTERN_C_END
#endif
