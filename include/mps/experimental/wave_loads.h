/* mps/experimental/wave_loads.h - design values of waves at a wall: pressures and forces by
 * Sainflou and by Goda with the impulsive part of Takahashi, mean overtopping discharge and run-up
 * by EurOtop (2018). Closed formulas, each with its range of validity, which is refused outside;
 * docs/waves.md has them, docs/references.md the sources. Forces are per metre of wall. Beside them
 * the overtopping by heads too low for a count of what passes a crest, from the level at the wall.
 *
 * A quantity that must be > 0 is 1e-12 to 1e12 in SI units (a weight to 1e15), so that no answer
 * overflows.
 *
 * Thread rule: one thread at a time per context.
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef LIBMPS_EXPERIMENTAL_WAVE_LOADS_H
#define LIBMPS_EXPERIMENTAL_WAVE_LOADS_H

#ifndef MPS_EXPERIMENTAL
#error                                                                                             \
    "experimental interface, which may change in any minor release: #define MPS_EXPERIMENTAL first"
#endif

#include "../context.h"

MPS_EXTERN_C_BEGIN

/* ---- Sainflou -------------------------------------------------------------------------------- */

typedef struct mps_sainflou_def {
  uint32_t struct_size;
  int32_t reserved;
  double height;  /* m, of the regular incident wave, > 0; no default */
  double period;  /* s, > 0; no default */
  double depth;   /* m, at the wall, which stands on the bed, > 0; no default */
  double density; /* kg/m3, > 0; default 1000 */
  double gravity; /* m/s2, > 0; default 9.81 */
} mps_sainflou_def;

static inline mps_sainflou_def mps_sainflou_defaults(void) {
  mps_sainflou_def def;
  memset(&def, 0, sizeof def);
  if (mps_def_init(MPS_DEF_SAINFLOU, &def, sizeof def) != MPS_OK) def.struct_size = 0;
  return def;
}

typedef struct mps_sainflou {
  double rise;          /* m, of the mean level at the wall: pi H^2 coth(kd)/L */
  double bed;           /* Pa, amplitude of the wave's pressure at the bed: rho g H/cosh kd */
  double crest_force;   /* N/m under the crest, that of the water at rest, rho g d^2/2, included */
  double crest_moment;  /* N m/m about the bed, likewise */
  double trough_force;  /* N/m under the trough */
  double trough_moment; /* N m/m */
} mps_sainflou;
/** Standing wave at a vertical wall, reflected fully: Sainflou (1928), with pressures linear from
 *  the surface to the bed. MPS_ERROR_ARGUMENT: a member of `def` out of range, a height above .142
 *  L tanh kd (Miche 1944: it breaks), a trough at the bed. */
MPS_API MPS_NODISCARD mps_status mps_sainflou_evaluate_sized(mps_context *context,
                                                             const mps_sainflou_def *def,
                                                             mps_sainflou *out, size_t size);
static inline mps_status mps_sainflou_evaluate(mps_context *context_, const mps_sainflou_def *def,
                                               mps_sainflou *out) {
  return mps_sainflou_evaluate_sized(context_, def, out, sizeof *out);
}

/* ---- Goda ------------------------------------------------------------------------------------ */

/** A caisson on a berm or on the bed. */
typedef struct mps_goda_def {
  uint32_t struct_size;
  int32_t impulsive; /* 0 (default): Goda (1974, 2000); 1: alpha_2 not less than the impulsive
                        coefficient of Takahashi, Tanimoto and Shimosako (1994) */
  double height;     /* m, of the design wave: Hmax, 1.8 H1/3 off the surf zone; > 0; no default */
  double period;     /* s, T1/3, > 0; no default */
  double depth;      /* m, h: at the wall, > 0; no default */
  double seaward;    /* m, hb: depth 5 H1/3 seaward of the wall, >= depth; NaN (default): depth */
  double berm_depth; /* m, d: over the armour of the berm, in (0, depth]; NaN (default): depth */
  double base;  /* m, h': depth of the caisson's base, berm_depth to depth; NaN (default): depth */
  double crest; /* m, hc: of the caisson above the water at rest, > 0; no default */
  double width; /* m, of its base, > 0; no default */
  double berm_width; /* m, >= 0: seaward of the caisson, read with `impulsive`; default 0 */
  double angle;      /* rad, 0 to pi/2: of the waves from the wall's normal; default 0 */
  double weight;   /* N/m, in still water: weight less buoyancy, > 0; NaN (default): no safeties */
  double arm;      /* m, of the weight about the heel, in (0, width]; NaN (default): width/2 */
  double friction; /* coefficient at the base, > 0; default .6 */
  double density;  /* kg/m3, > 0; default 1000 */
  double gravity;  /* m/s2, > 0; default 9.81 */
} mps_goda_def;

static inline mps_goda_def mps_goda_defaults(void) {
  mps_goda_def def;
  memset(&def, 0, sizeof def);
  if (mps_def_init(MPS_DEF_GODA, &def, sizeof def) != MPS_OK) def.struct_size = 0;
  return def;
}

typedef struct mps_goda {
  double alpha[3];  /* alpha_1, alpha_2 (or the impulsive one, where larger), alpha_3 */
  double impulsive; /* alpha_I of Takahashi; NaN without `impulsive` */
  double reach;     /* m, eta*: where the pressure ends above the water at rest */
  double p1, p2, p3,
      p4;    /* Pa, at the still level, the bed, the base, the crest; of the wave alone */
  double pu; /* Pa, uplift at the seaward edge of the base, 0 at the heel */
  double force, moment;         /* N/m, N m/m about the base: horizontal */
  double uplift, uplift_moment; /* N/m, N m/m about the heel */
  double sliding;               /* friction (weight - uplift)/force; NaN without weight */
  double overturning;           /* (weight arm - uplift_moment)/moment; NaN without weight */
} mps_goda;
/** Pressures of the highest wave on a caisson, and its safeties. MPS_ERROR_ARGUMENT: a member of
 *  `def` out of range. */
MPS_API MPS_NODISCARD mps_status mps_goda_evaluate_sized(mps_context *context,
                                                         const mps_goda_def *def, mps_goda *out,
                                                         size_t size);
static inline mps_status mps_goda_evaluate(mps_context *context_, const mps_goda_def *def,
                                           mps_goda *out) {
  return mps_goda_evaluate_sized(context_, def, out, sizeof *out);
}

/* ---- EurOtop --------------------------------------------------------------------------------- */

typedef enum mps_eurotop_wall {
  MPS_EUROTOP_WALL_VERTICAL = 0, /* plain vertical wall */
  MPS_EUROTOP_WALL_SLOPE = 1     /* smooth or rough slope, 1:2 to 1:8 */
} mps_eurotop_wall;

typedef enum mps_eurotop_formula {
  MPS_EUROTOP_FORMULA_DEEP = 0,           /* EurOtop (7.1): vertical, no influencing foreshore */
  MPS_EUROTOP_FORMULA_FORESHORE = 1,      /* (7.5): vertical, foreshore, non-impulsive */
  MPS_EUROTOP_FORMULA_IMPULSIVE_LOW = 2,  /* (7.7): vertical, impulsive, Rc/Hm0 < 1.35 */
  MPS_EUROTOP_FORMULA_IMPULSIVE_HIGH = 3, /* (7.8): vertical, impulsive, Rc/Hm0 >= 1.35 */
  MPS_EUROTOP_FORMULA_BREAKING = 4,       /* (5.10): slope */
  MPS_EUROTOP_FORMULA_NON_BREAKING = 5    /* (5.11): slope, the upper limit */
} mps_eurotop_formula;

typedef struct mps_eurotop_def {
  uint32_t struct_size;
  int32_t wall;      /* mps_eurotop_wall, default VERTICAL */
  int32_t foreshore; /* VERTICAL: 0 (default): there is an influencing foreshore where depth/Hm0 is
                        4 or less; 1: in any depth */
  int32_t design;   /* 0 (default): mean of the tests; 1: coefficients one standard deviation on the
                       safe side */
  double height;    /* m, Hm0 at the toe, > 0; no default */
  double period;    /* s, T(m-1,0), > 0; no default */
  double depth;     /* m, at the toe, > 0; no default */
  double crest;     /* m, Rc: crest above the water at rest, > 0; no default */
  double cotangent; /* SLOPE: 2 to 8; no default */
  double berm, roughness, obliquity, crown, promenade; /* SLOPE: influence factors gamma_b, gamma_f,
                        gamma_beta, gamma_v, gamma*, each in (0, 1]; default 1 */
  double gravity;                                      /* m/s2, > 0; default 9.81 */
} mps_eurotop_def;

static inline mps_eurotop_def mps_eurotop_defaults(void) {
  mps_eurotop_def def;
  memset(&def, 0, sizeof def);
  if (mps_def_init(MPS_DEF_EUROTOP, &def, sizeof def) != MPS_OK) def.struct_size = 0;
  return def;
}

typedef struct mps_eurotop {
  double discharge; /* m3/s per m: mean overtopping */
  double low, high; /* m3/s per m: with all coefficients one standard deviation off the mean */
  double breaker;   /* xi(m-1,0) of a slope; NaN of a vertical wall */
  int32_t formula;  /* mps_eurotop_formula */
  int32_t reserved;
} mps_eurotop;
/** Mean overtopping discharge of a storm by the formula that the wall, its foreshore and the number
 *  of impulsiveness depth^2/(Hm0 L(m-1,0)) choose. MPS_ERROR_ARGUMENT: a member of `def` out of
 *  range; a crest above 3.5 Hm0; a slope with xi(m-1,0) of 5 or more. */
MPS_API MPS_NODISCARD mps_status mps_eurotop_evaluate_sized(mps_context *context,
                                                            const mps_eurotop_def *def,
                                                            mps_eurotop *out, size_t size);
static inline mps_status mps_eurotop_evaluate(mps_context *context_, const mps_eurotop_def *def,
                                              mps_eurotop *out) {
  return mps_eurotop_evaluate_sized(context_, def, out, sizeof *out);
}

typedef struct mps_eurotop_run_up {
  double height;    /* m above the water at rest: Ru2%, which 2 % of the incident waves exceed */
  double low, high; /* m: with the coefficient one standard deviation off the mean */
  double breaker;   /* xi(m-1,0) */
  int32_t breaking; /* 1: (5.1), 0: its limit, (5.2) */
  int32_t reserved;
} mps_eurotop_run_up;
/** Run-up on a slope, the lesser of EurOtop (2018) (5.1), 1.65 gb gf gB xi Hm0, and (5.2), gf gB (4
 *  - 1.5/(gb xi)^1/2) Hm0. Of `def` wall (SLOPE), design, height, period, depth, cotangent, berm,
 *  roughness, obliquity and gravity are read. MPS_ERROR_ARGUMENT: one of them out of range;
 *  xi(m-1,0) of 5 or more. */
MPS_API MPS_NODISCARD mps_status mps_eurotop_find_run_up_sized(mps_context *context,
                                                               const mps_eurotop_def *def,
                                                               mps_eurotop_run_up *out,
                                                               size_t size);
static inline mps_status mps_eurotop_find_run_up(mps_context *context_, const mps_eurotop_def *def,
                                                 mps_eurotop_run_up *out) {
  return mps_eurotop_find_run_up_sized(context_, def, out, sizeof *out);
}

/* ---- overtopping by low heads ---------------------------------------------------------------- */

/** What a run or a test has recorded at a wall with an upright face that waves pass. */
typedef struct mps_overtopping_def {
  uint32_t struct_size;
  int32_t reserved;
  int64_t samples;     /* 2 to 2^28 */
  const double *times; /* s, strictly increasing, `samples` values */
  const double *heads; /* m: level at the wall above its crest, `samples` values; NaN as below 0 */
  const double *volumes; /* m2, finite: counted so far behind the crest, as `heads`; or NULL */
  double resolved;       /* m, > 0: the count resolves events of a higher head; no default */
  double pause;   /* s, >= 0: heads above 0 that are at most that apart are one event; default 0 */
  double depth;   /* m, of the water before the wall, > 0: see below; NaN (default): infinite */
  double gravity; /* m/s2, > 0; default 9.81 */
} mps_overtopping_def;

static inline mps_overtopping_def mps_overtopping_defaults(void) {
  mps_overtopping_def def;
  memset(&def, 0, sizeof def);
  if (mps_def_init(MPS_DEF_OVERTOPPING, &def, sizeof def) != MPS_OK) def.struct_size = 0;
  return def;
}

typedef struct mps_overtopping {
  double counted;      /* m2: volumes[samples - 1] - volumes[0] */
  double thin;         /* m2: of thin events, beyond what is counted in them */
  double highest;      /* m: head; 0 without an event */
  int64_t events;      /* with a head above 0 */
  int64_t thin_events; /* of them, those whose highest head is `resolved` or less */
} mps_overtopping;
/** Overtopping where the heads are too low for a count, as of particles or drops, which lacks it. A
 *  thin event is one whose highest head is at most `resolved`; its flow is that of a free overfall
 *  over a broad crest, q = (2/3)^(3/2) g^(1/2) h^(3/2), of the head h = head - q/(g depth)^(1/2): a
 *  flow that the record lacks would have lowered the level at the wall by the long wave that it
 *  sends back. Of other events nothing is added, so that a film which stays on the crest after one
 *  is no flow. `thin` (m2; may be NULL) receives the volume so far at the first `capacity` (>= 0)
 *  samples at most, which grows with the last sample of each event; what is counted from the
 *  beginning of a thin event to that of the next event is taken off it. The sum of `counted` and
 *  `thin` is an estimate of all that passes. MPS_ERROR_ARGUMENT: a member of `def` out of range,
 *  `capacity` below 0. */
MPS_API MPS_NODISCARD mps_status mps_overtopping_find_sized(mps_context *context,
                                                            const mps_overtopping_def *def,
                                                            int64_t capacity, double *thin,
                                                            mps_overtopping *out, size_t size);
static inline mps_status mps_overtopping_find(mps_context *context_, const mps_overtopping_def *def,
                                              int64_t capacity, double *thin,
                                              mps_overtopping *out) {
  return mps_overtopping_find_sized(context_, def, capacity, thin, out, sizeof *out);
}

MPS_EXTERN_C_END
#endif
