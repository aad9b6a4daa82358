/* plan.c - the features that a seed makes. SPDX-License-Identifier: BSD-3-Clause */
#include "metamorphic.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static bool chance(uint64_t *r, int percent) { return below(r, 100) < percent; }

/* A multiple of 2^-20: shifts by whole cells are exact. */
static double fine(double x) { return nearbyint(x * 0x1p20) * 0x1p-20; }

static void choose_method(uint64_t *r, plan *p) {
  const int shape = below(r, 100);
  p->geometry = shape < 75   ? MPS_MPM_GEOMETRY_PLANE_STRAIN
                : shape < 88 ? MPS_MPM_GEOMETRY_AXISYMMETRIC
                             : MPS_MPM_GEOMETRY_SPACE;
  p->dim = p->geometry == MPS_MPM_GEOMETRY_SPACE ? 3 : 2;
  p->spline = 2 + below(r, 2);
  p->volumetric = below(r, 4);
  p->walls = chance(r, 70) ? MPS_MPM_EDGE_MIRROR : MPS_MPM_EDGE_FIT;
  p->budget = chance(r, 25);
  p->flip_time = chance(r, 30) ? uniform(r, 2.0, 30.0) : 0.0;
  p->viscous = chance(r, 15) ? uniform(r, 1.0, 20.0) : 0.0;
  p->local = chance(r, 15) ? 0.25 : 0.0;
  p->courant = chance(r, 70) ? 0.5 : 0.3;
  p->body = chance(r, 30), p->water = chance(r, 25);
  p->gravity[0] = chance(r, 30) ? fine(uniform(r, -3.0, 3.0)) : 0.0;
  p->gravity[1] = chance(r, 80) ? -9.8125 : 0.0;
  if (p->dim == 3 && chance(r, 30)) p->gravity[2] = fine(uniform(r, -3.0, 3.0));
  if (p->geometry == MPS_MPM_GEOMETRY_AXISYMMETRIC) p->gravity[0] = 0.0;
}

static void choose_side(uint64_t *r, const plan *p, int k, side *out) {
  static const int32_t kinds[] = {
      MPS_BOUNDARY_ROLLER,     MPS_BOUNDARY_ROLLER,    MPS_BOUNDARY_HELD, MPS_BOUNDARY_DRIVEN,
      MPS_BOUNDARY_FRICTIONAL, MPS_BOUNDARY_ABSORBING, MPS_BOUNDARY_FREE, MPS_BOUNDARY_OPEN};
  out->kind = kinds[below(r, 8)];
  out->friction = out->kind == MPS_BOUNDARY_FRICTIONAL ? uniform(r, 0.0, 0.8) : 0.0;
  if (out->kind == MPS_BOUNDARY_ABSORBING && chance(r, 30)) out->settle = uniform(r, 1e-3, 1e-2);
  const bool moved = chance(r, 50);
  for (int c = 0; c < p->dim && moved; c++) {
    out->moves[c] = out->kind == MPS_BOUNDARY_DRIVEN || out->kind == MPS_BOUNDARY_ABSORBING ||
                    out->kind == MPS_BOUNDARY_FRICTIONAL ||
                    (out->kind == MPS_BOUNDARY_ROLLER && c == k / 2);
    if (p->geometry == MPS_MPM_GEOMETRY_AXISYMMETRIC && c == 0) out->moves[c] = false;
  }
  if (p->geometry == MPS_MPM_GEOMETRY_AXISYMMETRIC && k == 0)
    *out = (side){.kind = MPS_BOUNDARY_ROLLER};
}

static void choose_domain(uint64_t *r, plan *p) {
  const int most = p->dim == 3 ? 3 : 7;
  for (int c = 0; c < p->dim; c++) {
    const int cells = p->dim == 3 ? 3 + below(r, 2) : 4 + below(r, most);
    p->low[c] = c == 1 || p->geometry == MPS_MPM_GEOMETRY_AXISYMMETRIC ? 0 : -cells / 2;
    p->high[c] = p->low[c] + cells + (c == 1 ? 3 : 0);
  }
  for (int k = 0; k < 2 * p->dim; k++) choose_side(r, p, k, &p->side[k]);
  p->frequency = uniform(r, 5.0, 40.0), p->amplitude = uniform(r, 1e-4, 3e-3);
  p->phase = uniform(r, 0.0, 3.0);
  if (p->geometry != MPS_MPM_GEOMETRY_PLANE_STRAIN || !chance(r, 12)) return;
  for (int k = 0; k < 2; k++) p->side[k] = (side){.kind = MPS_BOUNDARY_FREE_FIELD};
  if (p->side[2].kind == MPS_BOUNDARY_FRICTIONAL || p->side[2].kind == MPS_BOUNDARY_OPEN)
    p->side[2] = (side){.kind = MPS_BOUNDARY_HELD};
  p->side[3] = (side){.kind = MPS_BOUNDARY_FREE};
  p->gravity[0] = 0.0;
}

static bool beside_field(const plan *p) { return p->side[0].kind == MPS_BOUNDARY_FREE_FIELD; }

/* A block on the floor, or in the air, of whole rows of cells; on a lattice whose particles may lie
 * on borders of cells and on sides, or in disorder. */
static void choose_particles(uint64_t *r, plan *p) {
  static const int per[] = {1, 2, 2, 2, 3, 4};
  p->per_cell = p->dim == 3 ? 1 + below(r, 2) : per[below(r, 6)];
  const bool whole = beside_field(p) || chance(r, 40), still = beside_field(p) || chance(r, 30);
  /* Water shares its change of volume within a block of cells (docs/limits.md). */
  const bool apart = p->water, disorder = chance(r, 40), shifted = chance(r, 20);
  const double d = 1.0 / p->per_cell;
  const double jitter = !beside_field(p) && (apart || disorder) ? 0.2 * d : 0.0;
  const double offset = !beside_field(p) && !apart && shifted ? 0.5 * d : 0.0;
  double low[3] = {0.0}, high[3] = {0.0}, speed = chance(r, 50) || p->water ? 0.5 : 3.0;
  for (int c = 0; c < p->dim; c++) {
    const int cells = p->high[c] - p->low[c];
    low[c] = p->low[c], high[c] = c == 1 ? p->high[c] - 3 : p->high[c];
    if (c == 1 || whole || cells < 4) continue;
    low[c] += p->geometry == MPS_MPM_GEOMETRY_AXISYMMETRIC ? 0 : below(r, 2);
    high[c] -= below(r, 2);
  }
  int64_t n[3] = {1, 1, 1};
  for (int c = 0; c < p->dim; c++)
    n[c] = (int64_t)llround((high[c] - low[c]) * p->per_cell) + (offset > 0.0);
  while (n[0] * n[1] * n[2] > MOST - 20) n[1]--;
  const double drift[3] = {uniform(r, -1.0, 1.0), uniform(r, -1.0, 1.0), uniform(r, -1.0, 1.0)};
  for (int64_t i = 0; i < n[0] * n[1] * n[2]; i++) {
    const int64_t at[3] = {i % n[0], i / n[0] % n[1], i / n[0] / n[1]};
    double *x = p->x[p->count], *v = p->v[p->count];
    bool inside = true;
    for (int c = 0; c < p->dim; c++) {
      double X = low[c] + ((double)at[c] + 0.5) * d - offset;
      if (jitter > 0.0) X = fine(X + uniform(r, -jitter, jitter));
      x[c] = CELL * X;
      v[c] = still ? 0.0 : fine(speed * (drift[c] + uniform(r, -0.5, 0.5)));
      inside = inside && X >= p->low[c] && X <= p->high[c];
      if (c == 0 && p->geometry == MPS_MPM_GEOMETRY_AXISYMMETRIC) inside = inside && X > 0.0;
    }
    p->count += inside;
  }
}

static void choose_ground(uint64_t *r, plan *p) {
  p->law[0] = (law)below(r, LAWS), p->law[1] = (law)below(r, LAWS);
  p->two = chance(r, 20);
  if (p->two && ((p->law[0] == NEWTONIAN) != (p->law[1] == NEWTONIAN))) p->two = false;
  if (p->law[0] == NEWTONIAN || p->two) p->water = false;
  if (beside_field(p) && p->spline == 2 && p->per_cell % 2 != 0) p->water = false; /* borders */
  if (p->water) p->budget = 0;
  p->flows = p->water && chance(r, 60);
  p->load = !beside_field(p) && chance(r, 30);
  for (int c = 0; c < p->dim; c++) p->traction[c] = fine(uniform(r, -2e3, 2e3));
  if (p->geometry == MPS_MPM_GEOMETRY_AXISYMMETRIC) p->traction[0] = 0.0;
}

static void choose_body(uint64_t *r, plan *p) {
  const bool some = p->body != 0, box = chance(r, 50);
  p->body = 0;
  p->free_body = chance(r, 50), p->penalty = chance(r, 30);
  p->friction = chance(r, 50) ? uniform(r, 0.1, 0.6) : 0.0;
  p->sweeps = 20000, p->tolerance = 1e-8;
  p->size = CELL * uniform(r, 1.2, 1.6);
  p->angle = box ? uniform(r, -0.4, 0.4) : 0.0;
  p->velocity[0] = fine(uniform(r, -0.5, 0.5)), p->velocity[1] = fine(uniform(r, -2.0, -0.2));
  p->spin = uniform(r, -2.0, 2.0);
  if (!some || beside_field(p) || p->count == 0) return;
  p->body = box && p->dim == 2 && p->geometry != MPS_MPM_GEOMETRY_AXISYMMETRIC ? 2 : 1;
  if (p->body == 1) p->angle = p->spin = 0.0;
  const bool axial = p->geometry == MPS_MPM_GEOMETRY_AXISYMMETRIC;
  if (axial) p->angle = p->spin = p->velocity[0] = 0.0;
  if (p->penalty && p->body == 2) p->penalty = false;
  double top = 0.0;
  for (int64_t k = 0; k < p->count; k++) top = fmax(top, p->x[k][1]);
  p->place[0] = fine(CELL * uniform(r, -0.7, 0.7));
  const int where = below(r, 4); /* some cross a side */
  if (where < 2) p->place[0] += CELL * (where ? p->low[0] : p->high[0]);
  if (axial) p->place[0] = 0.0;
  p->place[1] = fine(top + (p->body == 2 ? 1.6 : 1.0) * p->size + 0.6 * CELL / p->per_cell);
  p->place[2] = p->dim == 3 ? fine(CELL * uniform(r, -0.3, 0.3)) : 0.0;
  if (p->dim == 3) p->velocity[2] = 0.0;
  p->inset = p->body == 2 && p->count % 2 == 0 ? 0.6 : 0.0;
}

void make_plan(uint64_t seed, plan *p) {
  uint64_t r = seed * UINT64_C(0x2545F4914F6CDD1D) + 1;
  memset(p, 0, sizeof *p);
  p->seed = seed;
  choose_method(&r, p);
  choose_domain(&r, p);
  choose_particles(&r, p);
  choose_ground(&r, p);
  choose_body(&r, p);
  p->event = (event)below(&r, EVENTS);
  const bool flows = p->flows || (p->body && p->free_body) || beside_field(p);
  if (p->event == SETTLES && (flows || p->law[0] != ELASTIC || p->two)) p->event = NOTHING;
  if (beside_field(p) && p->event != NOTHING) p->event = NOTHING;
  if ((p->event == INSERTS || p->event == SETS_SIDE) && p->water) p->event = NOTHING;
  if (p->geometry == MPS_MPM_GEOMETRY_AXISYMMETRIC && p->event == ADDS_LOAD) p->event = NOTHING;
  for (int k = 0; k < 3; k++) p->steps[k] = 6 + below(&r, 14);
}

/* ---- words ----------------------------------------------------------------------------------- */

void print_plan(const plan *p) {
  static const char *const kind[] = {"HELD",      "DRIVEN",     "ROLLER", "FRICTIONAL",
                                     "ABSORBING", "FREE_FIELD", "FREE",   "OPEN"};
  static const char *const laws[] = {"elastic",   "elastic nu .48", "neo-Hookean",
                                     "von Mises", "Drucker-Prager", "Mohr-Coulomb",
                                     "Tresca",    "Newtonian"};
  static const char *const events[] = {"nothing", "insertion",  "removal",
                                       "settle",  "a side set", "a load added"};
  printf("  geometry %d, spline %d, volumetric %d, walls %d, budget %d, courant %g, flip %g, "
         "viscous %g, local %g\n",
         (int)p->geometry, (int)p->spline, (int)p->volumetric, (int)p->walls, (int)p->budget,
         p->courant, p->flip_time, p->viscous, p->local);
  printf("  gravity %g %g %g; domain %d..%d, %d..%d, %d..%d cells; %d particles, %d an axis of a "
         "cell\n",
         p->gravity[0], p->gravity[1], p->gravity[2], p->low[0], p->high[0], p->low[1], p->high[1],
         p->low[2], p->high[2], (int)p->count, p->per_cell);
  for (int k = 0; k < 2 * p->dim; k++)
    printf("  side %d %s, mu %g, settle %g, driven %d%d%d\n", k, kind[p->side[k].kind],
           p->side[k].friction, p->side[k].settle, p->side[k].moves[0], p->side[k].moves[1],
           p->side[k].moves[2]);
  printf("  law %s", laws[p->law[0]]);
  if (p->two) printf(" and %s", laws[p->law[1]]);
  if (p->water) printf(", water%s", p->flows ? " that flows" : ", undrained");
  if (p->body)
    printf(", %s %s%s, mu %g", p->free_body ? "free" : "driven", p->body == 2 ? "box" : "ball",
           p->penalty       ? " by penalty"
           : p->inset > 0.0 ? " with inset edges"
                            : "",
           p->friction);
  if (p->load) printf(", a load");
  printf("; then %s; steps %d %d %d\n", events[p->event], (int)p->steps[0], (int)p->steps[1],
         (int)p->steps[2]);
}
