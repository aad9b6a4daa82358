/* plain_dynamics.h - the equations of explicit MPS elastodynamics as one would first write them:
 * positions, a neighbour list, each directed pair on its own, one thread. Written from the
 * published equations alone; it shares nothing with the library. The benchmark measures the
 * library against it, and the verification test compares their results.
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef PLAIN_DYNAMICS_H
#define PLAIN_DYNAMICS_H

#include <math.h>
#include <stdint.h>
#include <stdlib.h>

enum { PLAIN_VERLET, PLAIN_LEAPFROG, PLAIN_EULER };

typedef struct plain_body {
  int64_t n;
  double D, re, n0, dt, alpha, beta;
  int integrator, removal;       /* removal 11 or 12 */
  double *r0, *r, *r_old;        /* x, y, theta of each particle: 3 n */
  double *v, *a, *G, *G_old;     /* 3 n */
  double *rho, *mu, *lambda, *p; /* n */
  double *cs;                    /* cos and sin of theta: 2 n */
  int *fixed;                    /* 3 n */
  int64_t *first;                /* n + 1: neighbours of i are neighbour[first[i]] .. */
  int32_t *neighbour;
  int64_t steps;
} plain_body;

static inline double *plain_doubles(int64_t count) {
  double *memory = calloc((size_t)count, sizeof *memory);
  if (!memory) abort();
  return memory;
}

/* n particles at xy (2 n values, m). The caller sets rho, mu, lambda, dt and the neighbours
 * (malloc'ed, taken over). */
static inline plain_body plain_create(int64_t n, const double *xy, double D, double re) {
  plain_body b = {.n = n, .D = D, .re = re, .integrator = PLAIN_VERLET, .removal = 12};
  double **triples[] = {&b.r0, &b.r, &b.r_old, &b.v, &b.a, &b.G, &b.G_old};
  double **singles[] = {&b.rho, &b.mu, &b.lambda, &b.p};
  for (int k = 0; k < 7; k++) *triples[k] = plain_doubles(3 * n);
  for (int k = 0; k < 4; k++) *singles[k] = plain_doubles(n);
  b.cs = plain_doubles(2 * n);
  b.fixed = calloc((size_t)(3 * n), sizeof *b.fixed);
  for (int64_t i = 0; i < n; i++)
    for (int c = 0; c < 2; c++)
      b.r0[3 * i + c] = b.r[3 * i + c] = b.r_old[3 * i + c] = xy[2 * i + c];
  for (int i = -4; i <= 4; i++)
    for (int j = -4; j <= 4; j++) {
      const double r = D * sqrt((double)(i * i + j * j));
      if (r > 0.0 && r < re * (1.0 - 1e-9)) b.n0 += re / r - 1.0; /* (A9) */
    }
  return b;
}

static inline void plain_free(plain_body *b) {
  void *parts[] = {b->r0, b->r,      b->r_old, b->v,  b->a,     b->G,     b->G_old,    b->rho,
                   b->mu, b->lambda, b->p,     b->cs, b->fixed, b->first, b->neighbour};
  for (size_t k = 0; k < sizeof parts / sizeof *parts; k++) free(parts[k]);
}

typedef struct plain_pair {
  double rx, ry, ex, ey, ux, uy, cn, w, r0;
} plain_pair;

static inline plain_pair plain_deform(const plain_body *b, int64_t i, int64_t j) {
  plain_pair q;
  const double *cs = b->cs;
  const double r0x = b->r0[3 * j] - b->r0[3 * i], r0y = b->r0[3 * j + 1] - b->r0[3 * i + 1];
  q.rx = b->r[3 * j] - b->r[3 * i];
  q.ry = b->r[3 * j + 1] - b->r[3 * i + 1];
  q.r0 = sqrt(r0x * r0x + r0y * r0y);
  q.w = b->re / q.r0 - 1.0; /* (A8) */
  double c, s;
  if (b->removal == 12) { /* (12) */
    c = 0.5 * (cs[2 * i] + cs[2 * j]);
    s = 0.5 * (cs[2 * i + 1] + cs[2 * j + 1]);
  } else { /* (11) */
    const double half = 0.5 * (b->r[3 * i + 2] + b->r[3 * j + 2]);
    c = cos(half);
    s = sin(half);
  }
  q.ux = q.rx - (c * r0x - s * r0y);
  q.uy = q.ry - (s * r0x + c * r0y);
  const double r = sqrt(q.rx * q.rx + q.ry * q.ry);
  q.ex = q.rx / r;
  q.ey = q.ry / r;
  q.cn = q.ux * q.ex + q.uy * q.ey; /* (A1) */
  return q;
}

/* (A6), (A7), (A10), (A11), (A14 corrected): G of all particles. */
static inline void plain_forces(plain_body *b) {
  const double d = 2.0;
  for (int64_t i = 0; i < b->n; i++) {
    b->cs[2 * i] = cos(b->r[3 * i + 2]);
    b->cs[2 * i + 1] = sin(b->r[3 * i + 2]);
  }
  for (int64_t i = 0; i < b->n; i++) {
    double sum = 0.0;
    for (int64_t k = b->first[i]; k < b->first[i + 1]; k++) {
      const plain_pair q = plain_deform(b, i, b->neighbour[k]);
      sum += q.w * q.cn / q.r0;
    }
    b->p[i] = -b->lambda[i] * d / b->n0 * sum;
  }
  for (int64_t i = 0; i < b->n; i++) {
    double fx = 0.0, fy = 0.0, torque = 0.0;
    for (int64_t k = b->first[i]; k < b->first[i + 1]; k++) {
      const int64_t j = b->neighbour[k];
      const plain_pair q = plain_deform(b, i, j);
      const double mu = 2.0 * b->mu[i] * b->mu[j] / (b->mu[i] + b->mu[j]),
                   p = 0.5 * (b->p[i] + b->p[j]);
      const double unx = q.cn * q.ex, uny = q.cn * q.ey;
      const double usx = q.ux - unx, usy = q.uy - uny; /* (A2) */
      const double stiff = mu * q.w / (q.r0 * q.r0), bx = stiff * usx, by = stiff * usy;
      fx += 4.0 * d / b->n0 * (stiff * unx + bx) - 2.0 * d / b->n0 * p * q.w * q.ex / q.r0;
      fy += 4.0 * d / b->n0 * (stiff * uny + by) - 2.0 * d / b->n0 * p * q.w * q.ey / q.r0;
      torque += d * 2.0 * b->D * b->D / b->n0 * (q.rx * by - q.ry * bx);
    }
    b->G[3 * i] = fx / b->rho[i];
    b->G[3 * i + 1] = fy / b->rho[i];
    b->G[3 * i + 2] = torque / (b->rho[i] * b->D * b->D * b->D * b->D / 6.0);
  }
}

/* One step: forces, damping (A24), integrator. */
static inline void plain_step(plain_body *b) {
  const double dt = b->dt;
  plain_forces(b);
  for (int64_t k = 0; k < 3 * b->n; k++) {
    if (b->steps == 0) b->G_old[k] = b->G[k];
    const double v = b->integrator == PLAIN_VERLET ? (b->r[k] - b->r_old[k]) / dt : b->v[k];
    const double a =
        b->fixed[k] ? 0.0
                    : -b->alpha * v + (1.0 + b->beta / dt) * b->G[k] - b->beta / dt * b->G_old[k];
    b->a[k] = a;
    b->G_old[k] = b->G[k];
    if (b->integrator == PLAIN_VERLET) {
      const double r = b->r[k];
      b->r[k] = 2.0 * r - b->r_old[k] + dt * dt * a;
      b->r_old[k] = r;
    } else if (b->integrator == PLAIN_LEAPFROG) {
      b->v[k] += dt * a;
      b->r[k] += dt * b->v[k];
    } else {
      b->r[k] += dt * b->v[k];
      b->v[k] += dt * a;
    }
  }
  b->steps++;
}

#endif
