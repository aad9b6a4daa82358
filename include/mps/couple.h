/* mps/couple.h - implicit coupling of two codes, each of which goes on by its own means: the values
 * that both must agree on at the end of a step (accelerations of a wall, forces of an interface)
 * are found by repeating the step, faster and more surely than by handing them to and fro.
 *
 * One code answers values x with values H(x), after a step made from the same state as before (by
 * mps_S_rollback, or the parts of a step of mps/fluid.h). Agreed is x = H(x):
 *
 *   mps_coupling_begin(c, NULL, x);                      a guess, from the steps before
 *   for (int32_t done = 0; !done;) {
 *     step both codes with x from the state before; one answers H
 *     mps_coupling_next(c, H, x, &done);                 the next x, or done
 *   }
 *   mps_coupling_accept(c);                              the step is made
 *
 * The object knows nothing of the codes: they may be solvers of this library or not.
 * docs/coupling.md has a whole program, and says what to choose. Thread rule: one thread at a time
 * per context. SPDX-License-Identifier: BSD-3-Clause */
#ifndef LIBMPS_COUPLE_H
#define LIBMPS_COUPLE_H

#include "context.h"

MPS_EXTERN_C_BEGIN

typedef struct mps_coupling mps_coupling;

typedef enum mps_coupling_method {
  MPS_COUPLING_METHOD_QUASI_NEWTON = 0, /* IQN-ILS: from what earlier repeats have shown, by least
                                    squares (Degroote, Bathe and Vierendeels 2009) */
  MPS_COUPLING_METHOD_AITKEN = 1,       /* one factor for all values; right for one value */
  MPS_COUPLING_METHOD_CONSTANT = 2      /* `relaxation` at each repeat */
} mps_coupling_method;

typedef struct mps_coupling_def {
  uint32_t struct_size;
  int32_t method;    /* mps_coupling_method, default QUASI_NEWTON */
  int64_t size;      /* number of values, 1 to 2^31; no default */
  double relaxation; /* x + relaxation (H - x) where nothing is known yet, in (0, 1]; default .1 */
  double tolerance;  /* agreed when |H - x| <= tolerance |H| (Euclid), in (0, 1); default 1e-4 */
  double floor;      /* ... or when the root mean square of H - x is at most this, in the values'
                        unit, >= 0; default 0. Of accelerations under mps_fluid 1e-4 g: its own
                        solution leaves as much open */
  double filter;     /* QUASI_NEWTON: a difference is left out of which less than this share is
                        news, in [0, 1); default 1e-4 */
  int32_t repeats;   /* most a step, >= 1; default 50 */
  int32_t reuse;     /* QUASI_NEWTON: steps whose differences are used again, >= 0; default 4 */
  int32_t columns;   /* QUASI_NEWTON: most differences, >= 1; default 40 */
  int32_t order;     /* of the guess: 0 the last values, 1 (default) on a line, 2 on a parabola */
} mps_coupling_def;

MPS_API mps_status mps_coupling_def_init(mps_coupling_def *def, size_t size);
static inline mps_coupling_def mps_coupling_defaults(void) {
  mps_coupling_def def;
  memset(&def, 0, sizeof def);
  if (mps_coupling_def_init(&def, sizeof def) != MPS_OK) def.struct_size = 0;
  return def;
}

/** Creates the coupling of one pair of codes, which keeps the context alive. MPS_ERROR_ARGUMENT
 * names the member of `def` that is out of range. */
MPS_API MPS_NODISCARD mps_status mps_coupling_create(mps_context *context,
                                                     const mps_coupling_def *def,
                                                     mps_coupling **out);
/** Destroys and nulls; accepts NULL. */
MPS_API void mps_coupling_destroy(mps_coupling **coupling);

/** Begins a step: `guess` (size values) receives what to try first: `start` (size values, finite)
 *  or, where that is NULL, what the accepted steps lead to (0 before the first). A step that was
 *  begun and not accepted is forgotten. */
MPS_API MPS_NODISCARD mps_status mps_coupling_begin(mps_coupling *coupling, const double *start,
                                                    double *guess);
/** What the codes answered to the last guess (size values). `done` receives 1 where they agree:
 *  `guess` is then as it was; else 0, and `guess` (it may be the array of `answer`) receives what
 *  to try next. MPS_ERROR_NUMERIC: no agreement after `repeats`, or an answer that is not finite;
 *  begin the step again, with a shorter one if need be (mps_coupling_set_memory with what was kept
 *  before the step takes back what the failed one has taught). MPS_ERROR_STATE: none is begun. */
MPS_API MPS_NODISCARD mps_status mps_coupling_next(mps_coupling *coupling, const double *answer,
                                                   double *guess, int32_t *done);
/** The step is made: the last guess and the differences seen serve the next ones. Logs a warning,
 *  once, where the values swing by more than .3 rad a step (omega dt, over some 64 steps): a longer
 *  step does not follow them, and the codes may drive one another. */
MPS_API MPS_NODISCARD mps_status mps_coupling_accept(mps_coupling *coupling);

typedef struct mps_coupling_report {
  int64_t steps;       /* accepted */
  int64_t all_repeats; /* answers told, since creation */
  int32_t repeats;     /* of the last step */
  int32_t columns;     /* differences kept */
  double residual;     /* |H - x|/|H| of the last answer */
} mps_coupling_report;
/** What the steps so far have taken. */
MPS_API MPS_NODISCARD mps_status mps_coupling_get_report_sized(const mps_coupling *coupling,
                                                               mps_coupling_report *out,
                                                               size_t size);
static inline mps_status mps_coupling_get_report(const mps_coupling *coupling,
                                                 mps_coupling_report *out) {
  return mps_coupling_get_report_sized(coupling, out, sizeof *out);
}

/** What the object has learnt, between steps, as numbers to keep with a checkpoint: with them the
 *  run goes on bit for bit. Writes at most `capacity` to `values`; `count` receives how many there
 *  are. */
MPS_API MPS_NODISCARD mps_status mps_coupling_get_memory(const mps_coupling *coupling,
                                                         int64_t capacity, int64_t *count,
                                                         double *values);
/** Puts them into an object of the same definition. MPS_ERROR_FORMAT: they are not of one. */
MPS_API MPS_NODISCARD mps_status mps_coupling_set_memory(mps_coupling *coupling, int64_t count,
                                                         const double *values);

MPS_EXTERN_C_END
#endif
