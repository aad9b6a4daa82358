/* metamorphic.h - random scenes of WLS-MPM, explicit dynamics and implicit elasticity, of mixed
 * features, and the same scenes mirrored, turned, shifted and scaled, on other threads, rolled back
 * and restored: what must stay the same. With halved steps, where a scene is smooth, what must come
 * nearer.
 *
 *   plan.c     what a seed makes: the features of a scene of WLS-MPM
 *   scene.c    the scene of a plan under a change, its steps, its result
 *   plane.c    lattices in the plane, of dynamics.c and elastic.c
 *   dynamics.c layers of explicit dynamics
 *   elastic.c  blocks of implicit elasticity in motion
 *   compare.c  two results, and how far they may be apart
 *   main.c     seeds, the command line
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef TESTS_METAMORPHIC_H
#define TESTS_METAMORPHIC_H

#include <mps/mps.h>

#include <stdbool.h>
#include <stdint.h>

/* Component c of a vector becomes component axis[c] times sign[c]. Lengths, masses and times are
 * multiplied by length, mass and time, positions then moved by shift[] cells (by new axis). */
typedef struct change {
  int axis[3];
  double sign[3];
  int shift[3];
  double length, mass, time;
  int32_t threads; /* 0: serial */
  int32_t halved;  /* steps, so many times */
  enum { STRAIGHT, ROLLED_BACK, RESTORED, AT_ONCE } way;
} change;

typedef enum law {
  ELASTIC,
  STIFF_ELASTIC, /* nu = .48: means by cell */
  NEO_HOOKEAN,
  VON_MISES,
  DRUCKER_PRAGER,
  MOHR_COULOMB,
  TRESCA,
  NEWTONIAN,
  LAWS
} law;

typedef enum event { NOTHING, INSERTS, REMOVES, SETTLES, SETS_SIDE, ADDS_LOAD, EVENTS } event;

enum { MOST = 700 }; /* particles */

typedef struct side {
  int32_t kind;
  double friction, settle;
  bool moves[3]; /* components driven by the plan's signal */
} side;

typedef struct plan {
  uint64_t seed;
  int dim;
  int32_t geometry, spline, volumetric, walls, budget;
  double flip_time, viscous, local, courant; /* flip_time in steps of the first length */
  double gravity[3];
  int low[3], high[3]; /* cells, the domain */
  side side[6];
  double frequency, amplitude, phase; /* of the signal: 1/s, m, rad */
  law law[2];                         /* the second of every third particle, with `two` */
  bool two;
  bool water, flows;
  int32_t body; /* 0 none, 1 disc or sphere, 2 box */
  bool free_body, penalty;
  int32_t sweeps; /* of its contact, with the tolerance: so that images agree (docs/limits.md) */
  double tolerance;
  double size, place[3], angle, velocity[3], spin, friction; /* of the body */
  double inset;                                              /* of a box, cells */
  bool load;
  double traction[3];
  event event;
  int64_t steps[3]; /* before the event, before the save, after it */
  int64_t count, inserted;
  int per_cell; /* particles an axis */
  double x[MOST][3], v[MOST][3];
} plan;

/* m: cells of all plans, before a change of lengths. */
#define CELL 0.25

/* Values of the particles by id, of bodies and of sides, at the end. */
typedef struct result {
  mps_status status;
  char message[200];
  int64_t steps, count;
  double time, left; /* left: most of the last sweep of a step */
  bool here[2 * MOST];
  double position[2 * MOST][3], velocity[2 * MOST][3], stress[2 * MOST][3][3],
      gradient[2 * MOST][3][3], scalar[4][2 * MOST]; /* volume, mass, plastic strain, pressure */
  double body[2][3], turn[2], impulse[6][3], hit[3];
} result;

static inline uint64_t mix(uint64_t *state) { /* splitmix64 */
  uint64_t z = *state += UINT64_C(0x9E3779B97F4A7C15);
  z = (z ^ z >> 30) * UINT64_C(0xBF58476D1CE4E5B9);
  z = (z ^ z >> 27) * UINT64_C(0x94D049BB133111EB);
  return z ^ z >> 31;
}
static inline double uniform(uint64_t *r, double low, double high) {
  return low + (high - low) * ((double)(mix(r) >> 11) * 0x1p-53);
}
static inline int below(uint64_t *r, int n) { return (int)(mix(r) % (uint64_t)n); }

/* Of turns in the plane, under a change. */
static inline double sense_of_turns(const change *by) {
  return (by->axis[0] == 0 ? 1.0 : -1.0) * by->sign[0] * by->sign[1];
}

void make_plan(uint64_t seed, plan *out);
/* The features of a plan, in words. */
void print_plan(const plan *p);

/* Runs a plan under a change; `out` is in the units and axes of the plan again. */
void run_plan(const plan *p, const change *by, const char *folder, result *out);

/* The same for layers of explicit dynamics; of the plan only the seed is used. */
void print_layers(const plan *p);
void run_layers(const plan *p, const change *by, const char *folder, result *out);
double bound_of_layers(const plan *p, double left);

/* The same for blocks of implicit elasticity. */
void print_blocks(const plan *p);
void run_blocks(const plan *p, const change *by, const char *folder, result *out);
double bound_of_blocks(const plan *p, double left);

extern const change no_change;
/* How far results may be apart: by how much rounding may grow in a plan, and by the `left` of
 * sweeps over its contacts. */
double bound_of(const plan *p, double left);
/* Compares; prints the first difference and returns false where there is one. `bound` 0: bit for
 * bit. `worst` receives the largest difference over what it is measured by. */
bool compare(const plan *p, const result *a, const result *b, double bound, const char *name,
             bool verbose, double *worst);

#endif
