/* compare.c - two results. SPDX-License-Identifier: BSD-3-Clause */
#include "metamorphic.h"

#include <float.h>
#include <math.h>
#include <stdio.h>

/* A step adds some ten units of round-off to each value, which the fit of cut supports multiplies
 * by up to the inverse of the least mass of a node (.02 of that by weights) and of its least second
 * moment (likewise), and later steps keep. Sweeps over contacts leave a hundred times their last
 * change where each of them takes a hundredth of what is left, and in an image something else. */
double bound_of(const plan *p, double left) {
  const double steps =
      (double)(p->steps[0] + p->steps[1] + p->steps[2]) + (p->event == SETTLES ? 60.0 : 0.0);
  const double rounding = 10.0 * DBL_EPSILON * 2500.0 * steps;
  return p->body && !p->penalty ? rounding + 100.0 * fmax(left, p->tolerance) * steps : rounding;
}

typedef struct found {
  const char *name;
  int64_t id;
  double apart, size, a, b; /* a, b: the values farthest apart */
  bool same;
} found;

static void look(found *f, int64_t id, double a, double b) {
  const double off = fabs(a - b);
  f->size = fmax(f->size, fabs(a));
  if (a != b) f->same = false;
  if (off > f->apart || off != off) f->apart = off, f->id = id, f->a = a, f->b = b;
}

enum { FIELDS = 11 };
/* What differences are measured by at least: cells, the strengths of the laws, a thousandth of the
 * time in which a wave passes a cell, ... */
static const double least[FIELDS] = {CELL, 0.1, 500.0, 0.1, 0.0, 0.0, 1e-3, 500.0, CELL, 0.1, 1.0};

static void look_at_particle(const result *a, const result *b, int64_t i, found *f) {
  for (int c = 0; c < 3; c++) {
    look(&f[0], i, a->position[i][c], b->position[i][c]);
    look(&f[1], i, a->velocity[i][c], b->velocity[i][c]);
    for (int d = 0; d < 3; d++) {
      look(&f[2], i, a->stress[i][c][d], b->stress[i][c][d]);
      look(&f[3], i, a->gradient[i][c][d], b->gradient[i][c][d]);
    }
  }
  for (int c = 0; c < 4; c++) look(&f[4 + c], i, a->scalar[c][i], b->scalar[c][i]);
}

/* With a body only the sum over the sides: at a node of two sides beside a body, of which one is
 * fixed, it depends on the body which of them bears. */
static void look_at_sides(const plan *p, const result *a, const result *b, found *f) {
  for (int c = 0; c < 3; c++) {
    double sum = 0.0, other = 0.0;
    for (int k = 0; k < 6; k++) {
      sum += a->impulse[k][c], other += b->impulse[k][c];
      if (!p->body) look(f, k, a->impulse[k][c], b->impulse[k][c]);
      f->size = fmax(f->size, fabs(a->impulse[k][c]));
    }
    look(f, -1, sum, other);
  }
}

static void look_at_others(const plan *p, const result *a, const result *b, found *f) {
  look_at_sides(p, a, b, &f[10]);
  for (int c = 0; c < 3; c++) {
    look(&f[8], -1, a->body[0][c], b->body[0][c]);
    look(&f[9], -1, a->body[1][c], b->body[1][c]);
    look(&f[10], -1, a->hit[c], b->hit[c]);
  }
  for (int c = 0; c < 2; c++) look(&f[8 + c], -1, a->turn[c], b->turn[c]);
}

static bool differ(const plan *p, const char *name, const char *what) {
  printf("seed %llu, %s: %s\n", (unsigned long long)p->seed, name, what);
  return false;
}

bool compare(const plan *p, const result *a, const result *b, double bound, const char *name,
             bool verbose, double *worst) {
  found f[FIELDS] = {
      {.name = "position"},          {.name = "velocity"},      {.name = "stress"},
      {.name = "velocity_gradient"}, {.name = "volume"},        {.name = "mass"},
      {.name = "plastic_strain"},    {.name = "pore_pressure"}, {.name = "body's place"},
      {.name = "body's velocity"},   {.name = "impulse"}};
  char text[500];
  if (a->status != b->status) {
    snprintf(text, sizeof text, "status %d (%s), else %d (%s)", (int)b->status, b->message,
             (int)a->status, a->message);
    return differ(p, name, text);
  }
  if (a->status != MPS_OK) return true;
  if (a->count != b->count || a->steps != b->steps) {
    snprintf(text, sizeof text, "%lld particles after %lld steps, else %lld after %lld",
             (long long)b->count, (long long)b->steps, (long long)a->count, (long long)a->steps);
    return differ(p, name, text);
  }
  for (int k = 0; k < FIELDS; k++) f[k].same = true;
  for (int64_t i = 0; i < 2 * MOST; i++) {
    if (a->here[i] != b->here[i]) return differ(p, name, "other particles are left");
    if (a->here[i]) look_at_particle(a, b, i, f);
  }
  look_at_others(p, a, b, f);
  for (int k = 0; k < FIELDS; k++)
    f[k].size = k == 0 || k == 8 ? CELL : fmax(f[k].size, least[k]); /* of places cells matter */
  for (int k = 0; k < FIELDS; k++) {
    const double relative = f[k].size > 0.0 ? f[k].apart / f[k].size : f[k].apart;
    *worst = fmax(*worst, relative);
    const bool good = bound > 0.0 ? relative <= bound : f[k].same;
    if (verbose || !good)
      printf("seed %llu, %s: %s apart by %.3g of %.3g (particle or side %lld: %.17g, %.17g), "
             "allowed %.3g\n",
             (unsigned long long)p->seed, name, f[k].name, f[k].apart, f[k].size,
             (long long)f[k].id, f[k].a, f[k].b, bound * f[k].size);
    if (!good && !verbose) return false;
    if (!good) bound = bound > 0.0 ? -1.0 : bound;
  }
  return bound >= 0.0;
}
