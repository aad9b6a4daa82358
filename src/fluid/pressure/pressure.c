/* pressure.c - the equation of the reduced pressure q,
 *
 *   sum w (q_j - q_i) + c (q_s - q_i) = S (rho/dt) (D - D_v - k/dt),  D = div u,
 *
 * symmetric and positive definite, exact for a linear q (Chen 2014, Tsuruta 2015). k has the
 * density: .003 (n/n0 - 1), not below -.0003; near the surface only what is above 0 (Tanaka 2010,
 * Khayyer and Gotoh 2011). It is a rate in time: with steps below .05 (l0/g)^1/2 it is that much
 * less. And it is less by |n/n0 - 1|/.003 where that is below 1: waves change n slightly without
 * changing the density, and a source in proportion to it damped a wave by 1.5 % in 20 periods, at
 * any spacing. D_v keeps volumes in a step (step_divergence). Images of particles beyond a wall
 * have their parent's q and an offset that the wall's acceleration a gives, -rho (a . N) times
 * their distance, so they add no unknowns; isolated particles have no row and no column.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "pressure.h"
#include "fluid/base/access.h"
#include "fluid/boundary/closed.h"
#include "fluid/boundary/sight.h"
#include "fluid/boundary/walls.h"
#include "fluid/pressure/pcg.h"
#include "fluid/particles/kink.h"
#include "fluid/particles/pores.h"
#include "fluid/ranks/partition.h"

#define DENSITY 0.003       /* k over the excess of n/n0 */
#define SMALL_EXCESS 0.003  /* of n/n0: below, k falls as its square */
#define STEEP 0.05          /* g/l0: |G|^2 as in breakers */
#define FULL_STEP 0.05      /* (l0/g)^1/2: with shorter steps k is less */
#define LEAST_DENSITY -3e-4 /* k */
#define FAR 4.0             /* times the differences along the surface: its mean */
#define LOOSE 0.03          /* of n/n0: missing around bodies in any flow */
#define LOOSE_BELOW 0.01    /* beside a body in open water */
#define CLOSING 4.0         /* |G|: rate at which more than that closes where water rushes past */
#define MOST_CLOSED 0.5     /* of it, in a step */
#define HELD 5.0            /* n: of a particle in a gap without others, to its last pressure */
#define IN_ROCK 0.1         /* of k, in rock and beside it */
#define CORNER 1.5          /* l0 */
#define PAST_CORNER 6.0     /* l0: where water that passes a corner expands */
#define EXPANDED 5.0        /* times k, besides k, there .. */
#define PASSES 5e-5         /* g/l0: .. where |G|^2 is that large */

/* Fraction of k in a step of this length. */
static double step_share(const mps_fluid *f) {
  return fmin(f->dt * mpsi_fluid_rate(f) / FULL_STEP, 1.0);
}

/* |G|^2, 1/s2. */
static double squared_gradient(const mps_fluid *f, int64_t i) {
  double G[4];
  mpsi_fluid_gradient(&f->local[i], G);
  return G[0] * G[0] + G[1] * G[1] + G[2] * G[2] + G[3] * G[3];
}

/* Around a corner of a body n is that of a bent neighbourhood, .5 to 1.3 % above the lattice's in
 * water at rest: that is no excess, and a source for it lifted a floating box with its water by .1
 * mm. What passes the corner to and fro expands instead, the more the longer the step. */
static double share_at_corner(const mps_fluid *f, int64_t i, double excess) {
  if (excess > 0.0) return mpsi_fluid_within(f, i, CORNER * f->l0) ? 0.0 : 1.0;
  if (!mpsi_fluid_within(f, i, PAST_CORNER * f->l0)) return 1.0;
  const double rate = mpsi_fluid_rate(f);
  return 1.0 + EXPANDED * fmin(squared_gradient(f, i) / (PASSES * rate * rate + 1e-300), 1.0);
}

/* Water that rushes along a convex body turns with it, and a step leaves half of that turn out: n
 * falls by u^2 dt/(2 R l0), dt a quarter of l0/u, by an eighth on the way of a radius. Below .72 it
 * would pass for a free surface, in the middle of the water: bodies that rose at 3 (g l0)^1/2 got
 * blows of their own buoyancy there. Such gaps close in the time 1/|G| in which the flow makes
 * them. Beside a body in open water they close from a lower speed on: behind the corners of a
 * square of 8 spacings in heave, at .9 (g l0)^1/2, they took .43 of its area in 1.5 periods. */
static double gap_source(const mps_fluid *f, int64_t i, double excess) {
  const double rush = mpsi_fluid_rush(f, i, PAST_CORNER * f->l0);
  const double below = mpsi_fluid_rush_below(f, i, PAST_CORNER * f->l0);
  if (!(rush > 0.0 || below > 0.0)) return 0.0;
  const double part = fmin(CLOSING * f->dt * sqrt(squared_gradient(f, i)), MOST_CLOSED);
  return part * fmin(rush * fmin(excess + LOOSE, 0.0), below * (excess + LOOSE_BELOW));
}

/* The particles of rock go 1/e of the way of those of water, so gaps of up to half a spacing open
 * and close at a face as water flows through it. They are no error of the density, and a source for
 * them makes the rock's discharge lag: with resistance up to a fifth more inertia of the rock,
 * where water goes a third of a spacing to and fro. */
static double density_source(const mps_fluid *f, int64_t i, double share) {
  const double excess = mpsi_fluid_fill(f, i) / mpsi_fluid_full(f, i) - 1.0;
  double k = DENSITY * excess * fmin(fabs(excess) / SMALL_EXCESS, 1.0);
  if (f->rocks && (mpsi_fluid_is_mixed(f, i) || mpsi_fluid_pore_of(f, i)->porosity < 1.0))
    k *= IN_ROCK;
  if (f->faces) k *= share_at_corner(f, i, excess);
  k = share * fmax(k, f->zone[i] ? 0.0 : LEAST_DENSITY);
  return f->faces && excess < -LOOSE_BELOW && !f->zone[i] ? k + gap_source(f, i, excess) : k;
}

/* Divergence (1/s) with which a step keeps volumes: they change by det(1 + dt G) = 1 + dt D + dt^2
 * det G. Without it standing waves of a fifth of the depth lose .4 % of their level with steps of
 * .2 (l0/g)^1/2. Where strain is steep, as beside a body that strikes, G is that of one side, and
 * there is none. A steep rotation inside the water is that of a vortex, which would expand. */
static double step_divergence(const mps_fluid *f, int64_t i) {
  double G[4];
  mpsi_fluid_gradient(&f->local[i], G);
  const double rate = mpsi_fluid_rate(f), det = G[0] * G[3] - G[1] * G[2];
  const double steep = squared_gradient(f, i) / (STEEP * rate * rate + 1e-300);
  const bool vortex = det > 0.0 && !f->zone[i];
  return -f->dt * det * (vortex ? 1.0 : fmax(1.0 - steep, 0.0));
}

/* Factors of the surface's term and of the source: 1 without rock. */
typedef struct factors {
  double surface, source, porosity;
} factors;

static factors factors_of(const mps_fluid *f, int64_t i) {
  if (!f->rocks) return (factors){1.0, 1.0, 1.0};
  const mpsi_fluid_pore *pore = mpsi_fluid_pore_of(f, i);
  const double square = pore->porosity * pore->porosity;
  return (factors){pore->ease / square, 1.0 / square, pore->porosity};
}

/* Sums over the surface of c (q_s - datum) and c. */
static void sum_surface(mps_fluid *f, int64_t begin, int64_t end, int64_t chunk) {
  double sum = 0.0, weight = 0.0;
  for (int64_t i = begin; i < end; i++) {
    if (f->state[i] != MPSI_FLUID_SURFACE) continue;
    const double c = mpsi_fluid_surface_weight(&f->local[i]);
    sum += c * (f->local[i].qs - f->system.datum), weight += c;
  }
  f->system.sums[2 * chunk] = sum, f->system.sums[2 * chunk + 1] = weight;
}

static void sum_squares(mps_fluid *f, int64_t begin, int64_t end, int64_t chunk) {
  double sum = 0.0;
  for (int64_t i = begin; i < end; i++) {
    if (f->state[i] != MPSI_FLUID_SURFACE) continue;
    const double off = f->local[i].qs - f->system.datum;
    sum += mpsi_fluid_surface_weight(&f->local[i]) * off * off;
  }
  f->system.sums[2 * chunk] = sum, f->system.sums[2 * chunk + 1] = 0.0;
}

static double sum_of(mps_fluid *f, mpsi_fluid_task over, double *second) {
  double sum = 0.0;
  *second = 0.0;
  mpsi_fluid_for(f, f->count, MPSI_FLUID_CHUNK, over);
  mpsi_fluid_send_sums(f, MPSI_FLUID_CHUNK);
  for (int64_t k = 0; k * MPSI_FLUID_CHUNK < f->count; k++)
    sum += f->system.sums[2 * k], *second += f->system.sums[2 * k + 1];
  return sum;
}

/* The surface's mean q_s, where that is far more than its differences: 100 kPa of air on it, or a
 * `level` of another datum. The equation is solved for q - datum. A constant changes nothing but
 * the size of the right side, and the tolerance is a part of that: with the air's pressure some Pa
 * were left, and bodies afloat did not agree with the water; with a level 100 m off the force of
 * still water on a wall was off by 4 %. */
static void find_datum(mps_fluid *f) {
  double weight, none;
  f->system.datum = 0.0;
  const double sum = sum_of(f, sum_surface, &weight);
  if (!(weight > 0.0)) return;
  const double mean = sum / weight;
  if (!(fabs(mean) > f->def.density * f->g * f->l0)) return;
  f->system.datum = mean;
  if (sum_of(f, sum_squares, &none) > weight * mean * mean / (FAR * FAR)) f->system.datum = 0.0;
}

/* Weight with which a particle in a narrow gap is held to its pressure of the step before. Some
 * that part from the others there, or a row that is cut off, see one another alone, with no
 * surface: their pressure had no datum, and the water pressed on a box .5 l0 above the bed with
 * 2e11 N, on one 1.1 l0 before a wall with 3e11 N. */
static double hold_of(const mps_fluid *f, int64_t i) {
  return f->faces ? HELD * f->local[i].n * mpsi_fluid_squeezed(f, i) : 0.0;
}

/* The diagonal, and a start vector by extrapolation of q over the last step. */
static void make_rows(mps_fluid *f, int64_t begin, int64_t end, int64_t chunk) {
  const bool by_pairs = f->any_apart || mpsi_fluid_near_rock(f, chunk);
  mpsi_fluid_system *s = &f->system;
  const double *old = mpsi_particles_column(f->particles, "reduced_pressure_old", 0);
  const double ahead = f->last_dt > 0.0 ? f->dt / f->last_dt : 0.0;
  for (int64_t i = begin; i < end; i++) {
    s->diagonal[i] = 1.0;
    if (f->state[i] == MPSI_FLUID_APART) continue;
    const int32_t *index = f->index + mpsi_fluid_pairs(f, i);
    const float *w = f->w + mpsi_fluid_pairs(f, i);
    double sum = factors_of(f, i).surface * mpsi_fluid_surface_weight(&f->local[i]) +
                 (by_pairs ? 0.0 : f->local[i].n);
    for (int32_t k = 0; by_pairs && k < f->near[i]; k++) {
      const int64_t j = index[k], ghost = j - f->count;
      if (f->state[ghost < 0 ? j : f->parent[ghost]] != MPSI_FLUID_APART) sum += w[k];
    }
    s->diagonal[i] = sum * (1.0 + 1e-10) + 1e-12 + hold_of(f, i);
    s->x[i] = f->q[i] + ahead * (f->q[i] - old[i]);
  }
}

/* The right side, with the walls' accelerations. */
static void make_right(mps_fluid *f, int64_t begin, int64_t end, int64_t chunk) {
  const double rho = f->def.density, dt = f->dt, share = step_share(f);
  const double *old = mpsi_particles_column(f->particles, "reduced_pressure_old", 0);
  for (int64_t i = begin; i < end; i++) {
    f->system.right[i] = 0.0;
    f->system.x[i] -= f->system.datum;
    if (f->state[i] == MPSI_FLUID_APART) {
      f->system.x[i] = 0.0; /* q of the solution before */
      continue;
    }
    const mpsi_fluid_local *local = &f->local[i];
    const int32_t *index = f->index + mpsi_fluid_pairs(f, i);
    const float *w = f->w + mpsi_fluid_pairs(f, i);
    const factors part = factors_of(f, i);
    double right = part.surface * mpsi_fluid_surface_weight(local) * (local->qs - f->system.datum);
    right += hold_of(f, i) * (old[i] - f->system.datum);
    const int32_t near = f->company[i] & MPSI_FLUID_NEAR_IMAGES ? f->near[i] : 0;
    for (int32_t k = 0; k < near; k++) {
      const int64_t ghost = index[k] - f->count;
      if (ghost >= 0 && f->state[f->parent[ghost]] != MPSI_FLUID_APART)
        right += w[k] * f->offset[ghost];
    }
    const double jump = mpsi_fluid_is_mixed(f, i) ? mpsi_fluid_jump(f, i) : 0.0;
    f->system.right[i] =
        right - part.source * local->S * rho / dt *
                    (local->divergence + jump - part.porosity * density_source(f, i, share) / dt -
                     step_divergence(f, i) / part.porosity);
  }
}

/* No suction beyond that of the surface: where p would be below 0 it is 0. Isolated particles have
 * p = 0. */
static void take_solution(mps_fluid *f, int64_t begin, int64_t end, int64_t chunk) {
  for (int64_t i = begin; i < end; i++) {
    const double none = mpsi_fluid_head(f, f->x[0][i], f->x[1][i]);
    const double p =
        f->state[i] == MPSI_FLUID_APART ? 0.0 : f->system.x[i] + f->system.datum - none;
    const double least =
        mpsi_fluid_least(f, i) + fmin(mpsi_fluid_surface_stress(f, &f->local[i]), 0.0);
    f->pressure[i] = fmax(p, least);
    f->q[i] = f->state[i] == MPSI_FLUID_APART
                  ? none
                  : fmax(f->system.x[i] + f->system.datum, none + least);
  }
}

mps_status mpsi_fluid_prepare_pressure(mps_fluid *f, const char *function) {
  const bool classical = f->classical.gamma > 0.0;
  MPSI_TRY(mpsi_fluid_weigh_flow(f, function));
  mpsi_fluid_use_flow(f, true);
  if (!classical) find_datum(f);
  mpsi_fluid_for(f, f->count, MPSI_FLUID_CHUNK, classical ? mpsi_fluid_classical_rows : make_rows);
  const bool outside = mpsi_fluid_solved_outside(f);
  mps_status status =
      outside ? mpsi_fluid_hand_matrix(f, function) : mpsi_fluid_factor(f, function);
  mpsi_fluid_use_flow(f, false);
  return status;
}

static mps_status solve_inside(mps_fluid *f, const char *function) {
  const int64_t iterations = mpsi_fluid_pcg(f);
  MPSI_TRY(mpsi_fluid_lost(f, function));
  if (iterations < 0)
    return mpsi_fail(f->context, function, MPS_ERROR_NUMERIC,
                     "step %lld, t = %g s: the pressure has not converged to %g in %d iterations; "
                     "the step is not made",
                     (long long)f->steps, f->time, f->def.tolerance, f->def.iterations);
  f->report.iterations = iterations;
  f->report.all_iterations += iterations;
  return MPS_OK;
}

mps_status mpsi_fluid_solve_pressure(mps_fluid *f, const char *function) {
  const bool classical = f->classical.gamma > 0.0;
  mps_status status = MPS_OK;
  if (!classical) {
    MPSI_TRY(mpsi_fluid_check_space(f, function));
    mpsi_fluid_press_ghosts(f);
    mpsi_fluid_use_flow(f, true);
    mpsi_fluid_for(f, f->count, MPSI_FLUID_CHUNK, make_right);
    mpsi_fluid_balance(f);
  }
  status = mpsi_fluid_solved_outside(f) ? mpsi_fluid_solve_outside(f, function)
                                        : solve_inside(f, function);
  mpsi_fluid_use_flow(f, false);
  if (status != MPS_OK) return status;
  if (!classical) mpsi_fluid_set_level(f);
  mpsi_fluid_for(f, f->count, MPSI_FLUID_CHUNK,
                 classical ? mpsi_fluid_classical_solution : take_solution);
  mpsi_fluid_send_all(f, classical ? 2 : 1, (double *const[]){f->q, f->pressure});
  if (classical) return MPS_OK;
  for (int64_t g = 0; g < f->ghosts; g++) f->q[f->count + g] = f->q[f->parent[g]] + f->offset[g];
  return MPS_OK;
}
