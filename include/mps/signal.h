/* mps/signal.h - functions of time: motions, with displacement u(t), velocity v(t) and acceleration
 * a(t), and numbers, such as the factor on a load.
 *
 * What moves (boundaries, bodies) takes a motion, what has a size (loads) a number; each refuses
 * the other. A number is one of MPS_SIGNAL_QUANTITY_VALUE, read by mps_signal_value.
 *
 * A signal is immutable after creation: it may be shared by objects, contexts and threads (one of
 * the caller's own, mps_signal_create_user, as far as its function may). Before its first instant a
 * signal is at rest: v = a = 0, and u is 0, or what a table begins with.
 *
 * Motion before t = 0 gives no displacement at the start: tables of velocities and accelerations
 * are integrated so that u(0) = 0 when they begin before t = 0, and u = 0 at their first sample
 * otherwise. Formats, units and the baseline correction of recorded motions are explained in
 * docs/signals.md.
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef LIBMPS_SIGNAL_H
#define LIBMPS_SIGNAL_H

#include "context.h"

MPS_EXTERN_C_BEGIN

typedef struct mps_signal mps_signal;

/** Quantity that a signal is made of. The first three give a motion, the others a number. */
typedef enum mps_signal_quantity {
  MPS_SIGNAL_QUANTITY_ACCELERATION = 0, /* m/s2 */
  MPS_SIGNAL_QUANTITY_VELOCITY = 1,     /* m/s */
  MPS_SIGNAL_QUANTITY_DISPLACEMENT = 2, /* m */
  MPS_SIGNAL_QUANTITY_VALUE = 3,        /* a number: between samples of a table linear */
  MPS_SIGNAL_QUANTITY_VALUE_STEPS = 4   /* a number: a table's sample holds until the next one */
} mps_signal_quantity;

/** Baseline correction of an accelerogram, made before it is integrated. T is its length, and v its
 *  integral from v(0) = 0. LINEAR, QUADRATIC and CUBIC find the trend of the *velocity*,
 *  p(t) = c1 t + c2 t^2 + c3 t^3 up to the degree named, by least squares over the record (no
 *  constant term: the motion starts from rest), and subtract its derivative p'(t) from the
 *  acceleration. An offset of the instrument is a velocity trend of degree 1, a linear drift one of
 *  degree 2, a parabolic drift one of degree 3. */
typedef enum mps_signal_baseline {
  MPS_SIGNAL_BASELINE_NONE = 1,      /* without correction */
  MPS_SIGNAL_BASELINE_MEAN = 2,      /* a - v(T)/T: the mean over time, so that v(T) = 0 */
  MPS_SIGNAL_BASELINE_LINEAR = 0,    /* a - c1 */
  MPS_SIGNAL_BASELINE_QUADRATIC = 3, /* a - c1 - 2 c2 t */
  MPS_SIGNAL_BASELINE_CUBIC = 4      /* a - c1 - 2 c2 t - 3 c3 t^2 */
} mps_signal_baseline;

/** Ricker wavelet, acceleration Yoshida (9): a(t) = amplitude (2 c (t-tp)^2 - 1) exp(-c (t-tp)^2)
 *  with c = (pi fc)^2, its exact velocity -amplitude (t-tp) exp(-c (t-tp)^2), and its exact
 *  displacement amplitude (exp(-c (t-tp)^2) - exp(-c tp^2)) / (2 c), which starts from zero. The
 *  first instant is t = 0: there the wavelet already moves a little, by exp(-c tp^2) relative to
 *  its peak (fc = 4 Hz, tp = 0.25 s: 5.2e-5), so choose tp of one period 1/fc or more. `frequency`
 *  fc (Hz, 1e-9 to 1e9), `peak_time` tp (s, >= 0), `amplitude` (m/s2, finite). MPS_ERROR_ARGUMENT:
 *  a value out of range, or a motion that overflows; MPS_ERROR_MEMORY. */
MPS_API MPS_NODISCARD mps_status mps_signal_create_ricker(mps_context *context, double frequency,
                                                          double peak_time, double amplitude,
                                                          mps_signal **out);
/** amplitude sin(2 pi f t + phase) for t >= 0, 0 before. `quantity` DISPLACEMENT: of a motion u(t)
 *  with its derivatives, of which one jumps at t = 0, depending on the phase; VALUE: of a number.
 *  f (Hz, 1e-9 to 1e9), amplitude (m, or of the number, finite), phase (rad, finite).
 *  MPS_ERROR_ARGUMENT: another quantity, a value out of range, or a motion that overflows;
 *  MPS_ERROR_MEMORY. */
MPS_API MPS_NODISCARD mps_status mps_signal_create_sine(mps_context *context, int32_t quantity,
                                                        double frequency, double amplitude,
                                                        double phase, mps_signal **out);
/** Rises from 0 at t = start (s, finite) to `amplitude` at t = start + duration (s, at least
 *  1e-100) along the quintic with zero end velocity and acceleration, amplitude (10 x^3 - 15 x^4 +
 * 6 x^5) with x = (t - start)/duration, and stays there. `quantity` DISPLACEMENT: of a motion u(t)
 *  (m) with its derivatives; VALUE: of a number. MPS_ERROR_ARGUMENT: another quantity, a value out
 *  of range, or a motion that overflows; MPS_ERROR_MEMORY. */
MPS_API MPS_NODISCARD mps_status mps_signal_create_ramp(mps_context *context, int32_t quantity,
                                                        double start, double duration,
                                                        double amplitude, mps_signal **out);
/** Table of `count` (2 to 2147483646) finite samples of `quantity` (MPS_SIGNAL_...) at strictly
 *  increasing `times` (s, within 1e15); both arrays have `count` elements and are copied.
 *  Accelerations are linear between samples and integrated exactly from v = 0 at the first sample;
 *  velocities are linear between samples (their acceleration is a step function, continuous from
 *  the right), and both are integrated exactly to u, which is 0 at the first sample or at t = 0,
 *  whichever is later; displacements are a natural cubic spline, with a warning where it leaves the
 *  range of the samples by 5 % of that. Before the table: at rest at the first displacement. After
 * it: acceleration 0, and velocity 0 for a table of displacements, the last velocity otherwise.
 * Numbers are linear between samples (VALUE), or that of the last sample up to t (VALUE_STEPS);
 * before and after the table the first and the last. MPS_ERROR_ARGUMENT: `count` out of range,
 * times that do not increase, a value that is not finite; MPS_ERROR_NUMERIC: the signal overflows.
 */
MPS_API MPS_NODISCARD mps_status mps_signal_create_table(mps_context *context, int32_t quantity,
                                                         int64_t count, const double *times,
                                                         const double *values, mps_signal **out);

/** The motion at time t (s, finite), by the caller: motion[0] displacement (m), motion[1] velocity
 *  (m/s), motion[2] acceleration (m/s2), all finite; of a number motion[0], the others are not
 *  read. It is called by the thread that steps, never by a worker, a few times a step, at times
 * that may go back by a step. A status other than MPS_OK ends the library's call, which returns it
 *  without making the step. It must not call into a solver that is stepping. */
typedef mps_status (*mps_signal_fn)(void *user, double t, double motion[3]);
/** A motion (`quantity` DISPLACEMENT) or a number (VALUE) computed by the caller's function: a
 *  servo, another code, a formula. `user` is passed to `fn`, and to `release` (may be NULL) with
 *  the last object that uses the signal. It spans all times; its peak acceleration is unknown
 *  (NaN). MPS_ERROR_ARGUMENT: another quantity, `fn` or `out` NULL; MPS_ERROR_MEMORY. */
MPS_API MPS_NODISCARD mps_status mps_signal_create_user(mps_context *context, int32_t quantity,
                                                        mps_signal_fn fn, void *user,
                                                        mps_release_fn release, mps_signal **out);

/** Format of a recorded motion. */
typedef enum mps_signal_record_format {
  MPS_SIGNAL_RECORD_FORMAT_AUTO = 0, /* recognised by the content */
  MPS_SIGNAL_RECORD_FORMAT_AT2 =
      1, /* PEER NGA .AT2: acceleration in g; NPTS and DT end its header */
  MPS_SIGNAL_RECORD_FORMAT_KNET = 2, /* K-NET / KiK-net ASCII: counts with a scale factor, gal */
  MPS_SIGNAL_RECORD_FORMAT_CSV = 3,  /* columns of text, of which a header line gives names and
    units;  separated by commas, semicolons or blanks; without a header time (s) and value; one
    column  with a step */
  MPS_SIGNAL_RECORD_FORMAT_SMC = 4,  /* USGS .SMC: acceleration in cm/s2 */
  MPS_SIGNAL_RECORD_FORMAT_COSMOS =
      5 /* COSMOS V1 and V2: acceleration, unit and step by its header */
} mps_signal_record_format;

/** Reading of a record; always start from mps_signal_record_defaults. */
typedef struct mps_signal_record_def {
  uint32_t struct_size;
  int32_t format;   /* mps_signal_record_format, default AUTO */
  int32_t quantity; /* mps_signal_quantity of a CSV, default ACCELERATION; the others are always
                       accelerations */
  int32_t baseline; /* mps_signal_baseline, default LINEAR; not used for other than accelerations */
  double scale;     /* factor on the values in SI units (an AT2 at half strength: 0.5), finite, not
                       0; default 1 */
  double taper;     /* s of cosine taper at both ends, made before the baseline correction, 0 to
                       half the record; accelerations only; default 0 */
  double step; /* s between values of a file that has no times, > 0; default NaN: by its header.
                  One that the file contradicts is an error */
  const char
      *unit; /* of the values of a CSV, such as "g", "gal", "mm"; default NULL: by its header,
                SI where that names none. One that the header contradicts is an error */
  const char *column; /* name of the values' column in the header of a CSV, case not counted;
                         default NULL: the only one */
} mps_signal_record_def;

static inline mps_signal_record_def mps_signal_record_defaults(void) {
  mps_signal_record_def def;
  memset(&def, 0, sizeof def);
  if (mps_def_init(MPS_DEF_SIGNAL_RECORD, &def, sizeof def) != MPS_OK) def.struct_size = 0;
  return def;
}

/** Reads a recorded motion from `path` and makes a table of it; its first sample is put at t = 0.
 *  `def` NULL: the defaults. MPS_ERROR_IO when the file cannot be read, MPS_ERROR_FORMAT with
 *  "path:line: reason" when it is malformed (bad number, non-finite value, fewer or more samples
 *  than announced, time not increasing, unknown unit, a response spectrum). The host's locale does
 *  not matter. */
MPS_API MPS_NODISCARD mps_status mps_signal_create_record(mps_context *context, const char *path,
                                                          const mps_signal_record_def *def,
                                                          mps_signal **out);

/** What mps_signal_create_record has read. */
typedef struct mps_signal_record_report {
  int32_t format;   /* mps_signal_record_format */
  int32_t quantity; /* mps_signal_quantity */
  int64_t count;    /* samples */
  double step;      /* s, mean interval */
  double gap;       /* s, longest interval */
  double length;    /* s, from the first to the last sample */
  double peak;      /* largest |value|, SI units, before scale, taper and baseline correction */
  double factor;    /* SI units of one `unit` */
  const char *unit; /* of the values in the file, "g"; "": none is named, SI is assumed. Lives as
                       long as the library */
} mps_signal_record_report;
/** What the file was read as. MPS_ERROR_ARGUMENT: NULL, or a `size` unknown to this library;
 *  MPS_ERROR_STATE: the signal is not of mps_signal_create_record. */
MPS_API MPS_NODISCARD mps_status mps_signal_get_record_sized(const mps_signal *signal,
                                                             mps_signal_record_report *out,
                                                             size_t size);
static inline mps_status mps_signal_get_record(const mps_signal *signal,
                                               mps_signal_record_report *out) {
  return mps_signal_get_record_sized(signal, out, sizeof *out);
}

/** Releases and nulls; accepts NULL. Objects that use the signal keep their own reference. */
MPS_API void mps_signal_destroy(mps_signal **signal);

/** Displacement (m) at time t (s). NaN when t or the motion is not finite, as far behind a table
 *  that leaves a velocity, the caller's function fails, or the signal is a number; 0 when signal is
 *  NULL. Thread safe, except for mps_signal_create_user. */
MPS_API double mps_signal_displacement(const mps_signal *signal, double t);
/** Velocity (m/s) at time t (s), otherwise as mps_signal_displacement. */
MPS_API double mps_signal_velocity(const mps_signal *signal, double t);
/** Acceleration (m/s2) at time t (s), otherwise as mps_signal_displacement. */
MPS_API double mps_signal_acceleration(const mps_signal *signal, double t);
/** Number at time t (s): NaN when t is not finite, the caller's function fails, or the signal is a
 *  motion; 0 when signal is NULL. Thread safe, except for mps_signal_create_user. */
MPS_API double mps_signal_value(const mps_signal *signal, double t);

/** First and last instant (s) of the signal; start or end may be NULL. A sine ends at infinity, a
 *  Ricker wavelet where its exponential has fallen to exp(-40), 4e-18 of the peak. A table ends
 *  with its last sample, even when it leaves a constant velocity behind. */
MPS_API void mps_signal_span(const mps_signal *signal, double *start, double *end);

MPS_EXTERN_C_END
#endif
