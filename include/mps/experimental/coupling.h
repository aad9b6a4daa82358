/* mps/experimental/coupling.h - implicit (strong) coupling of two partitioned solvers: the
 * interface values at the end of a step (accelerations of a wall, forces of an interface) are the
 * fixed point of the repeated step, found by quasi-Newton or Aitken iterations, faster and more
 * robustly than by plain fixed-point iterations.
 *
 * One solver maps values x to values H(x), by a step made from the same state as before (by
 * mps_S_rollback, or the parts of a step of mps/fluid.h). The coupling solves x = H(x):
 *
 *   mps_coupling_begin(c, NULL, x);                      a guess, from the steps before
 *   for (int32_t done = 0; !done;) {
 *     step both codes with x from the state before; one answers H
 *     mps_coupling_next(c, H, x, &done);                 the next x, or done
 *   }
 *   mps_coupling_accept(c);                              the step is made
 *
 * The object is independent of the solvers, which may be of this library or not. docs/coupling.md
 * has a whole program and a guide to the options. Thread rule: one thread at a time
 * per context. SPDX-License-Identifier: BSD-3-Clause */
#ifndef LIBMPS_EXPERIMENTAL_COUPLING_H
#define LIBMPS_EXPERIMENTAL_COUPLING_H

#ifndef MPS_EXPERIMENTAL
#error                                                                                             \
    "experimental interface, which may change in any minor release: #define MPS_EXPERIMENTAL first"
#endif

#include "../context.h"

MPS_EXTERN_C_BEGIN

typedef struct mps_coupling mps_coupling;

typedef enum mps_coupling_method {
  MPS_COUPLING_METHOD_QUASI_NEWTON = 0, /* IQN-ILS: inverse Jacobian from earlier iterations by
                                           least squares (Degroote, Bathe and Vierendeels 2009) */
  MPS_COUPLING_METHOD_AITKEN = 1,       /* one factor for all values; right for one value */
  MPS_COUPLING_METHOD_CONSTANT = 2      /* constant `relaxation` */
} mps_coupling_method;

typedef struct mps_coupling_def {
  uint32_t struct_size;
  int32_t method;    /* mps_coupling_method, default QUASI_NEWTON */
  int64_t size;      /* number of values, 1 to 2^31; no default */
  double relaxation; /* x + relaxation (H - x) while there is no secant information, in (0, 1];
                        default .1 */
  double tolerance;  /* converged when |H - x| <= tolerance |H| (Euclidean norm), in (0, 1); default
                        1e-4 */
  double floor;      /* ... or when the root mean square of H - x is at most this, in the values'
                        unit, >= 0; default 0. For accelerations with mps_fluid 1e-4 g, the accuracy of
                        its pressure solution */
  double filter;     /* QUASI_NEWTON: columns whose component orthogonal to the others is below this
                        fraction are dropped (QR filter), in [0, 1); default 1e-4 */
  int32_t repeats;   /* most iterations of a step, >= 1; default 50 */
  int32_t reuse;     /* QUASI_NEWTON: earlier steps whose columns are reused, >= 0; default 4 */
  int32_t columns;   /* QUASI_NEWTON: most columns (differences of iterates), >= 1; default 40 */
  int32_t order;     /* of the extrapolation to the first guess: 0 constant, 1 (default) linear, 2
                        quadratic */
} mps_coupling_def;

static inline mps_coupling_def mps_coupling_defaults(void) {
  mps_coupling_def def;
  memset(&def, 0, sizeof def);
  if (mps_def_init(MPS_DEF_COUPLING, &def, sizeof def) != MPS_OK) def.struct_size = 0;
  return def;
}

/** Creates the coupling of one pair of solvers, which keeps the context alive. MPS_ERROR_ARGUMENT
 *  names the member of `def` that is out of range. */
MPS_API MPS_NODISCARD mps_status mps_coupling_create(mps_context *context,
                                                     const mps_coupling_def *def,
                                                     mps_coupling **out);
/** Destroys and nulls; accepts NULL. */
MPS_API void mps_coupling_destroy(mps_coupling **coupling);

/** Begins a step: `guess` (size values) receives the first iterate: `start` (size values, finite)
 *  or, where that is NULL, the extrapolation of the accepted steps (0 before the first). A step
 *  that was begun and not accepted is discarded. MPS_ERROR_ARGUMENT: a value of `start` that is not
 *  within 1e100. */
MPS_API MPS_NODISCARD mps_status mps_coupling_begin(mps_coupling *coupling, const double *start,
                                                    double *guess);
/** Takes H of the last iterate, `answer` (size values). `done` receives 1 on convergence, and
 *  `guess` is unchanged; else 0, and `guess` (it may be the array of `answer`) receives the next
 *  iterate. MPS_ERROR_NUMERIC: no convergence within `repeats`, or an answer or iterate not within
 *  1e100; begin the step again, with a shorter one if need be (mps_coupling_set_memory with the
 *  numbers kept before the step discards the columns of the failed one). MPS_ERROR_STATE: none is
 *  begun. */
MPS_API MPS_NODISCARD mps_status mps_coupling_next(mps_coupling *coupling, const double *answer,
                                                   double *guess, int32_t *done);
/** Accepts the step: its last iterate and columns are used in the next steps. Logs a warning, once,
 *  where the values oscillate by more than .3 rad a step (omega dt, over some 64 steps): such a
 *  step does not resolve them, and the coupling may become unstable. MPS_ERROR_STATE: the step has
 *  not converged. */
MPS_API MPS_NODISCARD mps_status mps_coupling_accept(mps_coupling *coupling);

typedef struct mps_coupling_report {
  int64_t steps;       /* accepted */
  int64_t all_repeats; /* iterations, since creation */
  int32_t repeats;     /* of the last step */
  int32_t columns;     /* columns kept */
  double residual;     /* |H - x|/|H| of the last answer */
} mps_coupling_report;
/** Iteration statistics. MPS_ERROR_ARGUMENT: NULL, or a `size` unknown to this library. */
MPS_API MPS_NODISCARD mps_status mps_coupling_get_report_sized(const mps_coupling *coupling,
                                                               mps_coupling_report *out,
                                                               size_t size);
static inline mps_status mps_coupling_get_report(const mps_coupling *coupling,
                                                 mps_coupling_report *out) {
  return mps_coupling_get_report_sized(coupling, out, sizeof *out);
}

/** The state of the coupling between steps (iterates and columns), as numbers to keep with a
 *  checkpoint: with them the run continues bit for bit. Writes at most `capacity` to `values`;
 *  `count` receives their number. MPS_ERROR_ARGUMENT: `capacity` below 0; MPS_ERROR_STATE: a step
 *  is under way. */
MPS_API MPS_NODISCARD mps_status mps_coupling_get_memory(const mps_coupling *coupling,
                                                         int64_t capacity, int64_t *count,
                                                         double *values);
/** Restores them in an object of the same definition. MPS_ERROR_FORMAT: the numbers are not of such
 *  an object. */
MPS_API MPS_NODISCARD mps_status mps_coupling_set_memory(mps_coupling *coupling, int64_t count,
                                                         const double *values);

MPS_EXTERN_C_END
#endif
