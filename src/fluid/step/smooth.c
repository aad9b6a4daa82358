/* smooth.c - smoothing of velocities and viscosity. Gently, each particle takes over a part of what
 * a linear velocity field leaves over of its neighbours' (moments.c),
 *
 *   u += a (1 - s) v,  a = .6 dt s0 + 2 |v|^2/(l0^2 |G|^2 + 1e-4 g l0) <= .5,  s0 = sqrt(g/l0),
 *
 * the first part a .12 dt s0 near the surface but in breakers, and the second times 10 dt s0 <= 1
 * at walls. This is not the same from both sides of a pair. Where the flow is steep,
 * s = 10 |G|^2/(.05 s0^2) - 2 within [0, 1], as in breakers, pairs exchange momentum instead:
 *
 *   u_i += sum w 1/2 (b_i + b_j) (u_j - u_i - 1/2 (G_i + G_j) dx),
 *   b = s (1.8 dt s0 + 2 |v|^2/(...))/n, the sum <= .5.
 *
 * What i gets from j is the opposite of what j gets from i, bit for bit, and 0 in a linear field.
 * Of a smooth field this form takes the fourth derivatives, where the other one takes the second,
 * so its first part is three times as large; waves need the other one, as the step itself adds to
 * their energy. An image has its parent's b and the mirrored G: of what it exchanges the part along
 * normals goes to the wall, and the rest cancels with what its parent gets from the image of i.
 *
 * What is rough in less steep flow, behind a bore, pairs exchange too: the second part of a where
 * it is larger than the first and the steepness |G|^2/(.05 s0^2) above .02, off the surface. From
 * one side it gave bores up to a third of the force of their jump, always ahead.
 *
 * The Laplacian of u is n v/S: a viscosity nu takes the share nu dt n/S of v, and a only what that
 * leaves. Beside the surface the force is that of a stress which is 0 along it (add_surface). To a
 * wall of no slip goes the part of sum w du that is of its images, as between two particles.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "fluid/base/access.h"
#include "fluid/step/smooth.h"

#include "fluid/base/loops.h"
#include "fluid/boundary/polyline.h"
#include "fluid/boundary/turn.h"
#include "fluid/particles/pores.h"
#include "fluid/ranks/partition.h"
#include "fluid/step/exchange.h"

#define SMOOTH 0.6
#define FREE_SMOOTH 0.18 /* the same without gravity, where the rate is that of the fastest jet */
#define ZONE_SMOOTH 0.2  /* of it, within 1.6 l0 of the surface */
#define BREAKING 0.05    /* g/l0: |G|^2 where all of smoothing and shift is left there */
#define MOST_SMOOTH 0.5
#define PAIRED 10.0       /* times the steepness: share of smoothing between pairs */
#define PAIRED_FROM 2.0   /* of that, where it begins */
#define PAIRED_SMOOTH 3.0 /* times the first part of a, between pairs */
#define SHARED_FROM 0.02  /* steepness from which what is rough is smoothed between pairs */
#define LONGEST_STEP 0.1  /* (l0/g)^1/2: the limit of a fluid at rest */

double mpsi_fluid_steepness(const mps_fluid *f, int64_t i) {
  const double s0 = mpsi_fluid_rate(f);
  double G[4];
  mpsi_fluid_gradient(&f->local[i], G);
  const double square = G[0] * G[0] + G[1] * G[1] + G[2] * G[2] + G[3] * G[3];
  return s0 > 0.0 ? square / (BREAKING * s0 * s0) : 0.0;
}

/* Less near the surface, `least` in gentle waves, all where the flow is as steep as in breakers;
 * round a body's corner it is as steep without breaking. */
double mpsi_fluid_near_surface(const mps_fluid *f, int64_t i, double least) {
  if (!f->zone[i] || !(mpsi_fluid_rate(f) > 0.0)) return 1.0;
  if (f->company[i] & MPSI_FLUID_NEAR_CORNER) return least;
  return fmin(1.0, least + mpsi_fluid_steepness(f, i));
}

/* Whether the surface ends the particle's neighbourhood. */
static bool below_surface(const mps_fluid *f, int64_t i) { return f->local[i].h > 0.0; }

static double viscous_share(const mps_fluid *f, int64_t i) {
  const double S = below_surface(f, i) ? mpsi_fluid_weight_of(f, i)->square : f->local[i].S;
  return f->def.viscosity / f->def.density * f->dt * f->local[i].n / S;
}

/* Parts of smoothing at a particle. */
typedef struct parts {
  double gentle, rough; /* of a */
  double paired;        /* s */
  double shared;        /* part of `rough` that pairs exchange where s is 0 */
} parts;

/* Of a rough velocity field more, but not where the flow turns around a corner, which is no linear
 * field however smooth it is. Near the surface less: among neighbours on one side v is not 0 for
 * the curved field of a wave, which it would damp. Where a wall and the surface join the water
 * rises by ln r beside it: v is no roughness there either, and what is taken of it in a step must
 * not grow as the steps get shorter. */
static parts find_parts(const mps_fluid *f, int64_t i) {
  const mpsi_fluid_local *local = &f->local[i];
  double scale = 1e-4 * f->g * f->l0, v2 = 0.0, G[4];
  mpsi_fluid_gradient(local, G);
  for (int c = 0; c < 4; c++) scale += f->l0 * f->l0 * G[c] * G[c];
  for (int c = 0; c < 2; c++) v2 += (double)local->rest[c] * local->rest[c];
  const bool corner = f->company[i] & MPSI_FLUID_NEAR_CORNER;
  const bool waterline = f->zone[i] && (f->company[i] & MPSI_FLUID_NEAR_IMAGES);
  const double time = waterline ? fmin(f->dt * mpsi_fluid_rate(f) / LONGEST_STEP, 1.0) : 1.0;
  const double part = f->g > 0.0 ? SMOOTH : FREE_SMOOTH;
  parts p;
  p.rough = scale > 0.0 && !corner ? 2.0 * time * v2 / scale : 0.0;
  p.gentle = part * mpsi_fluid_near_surface(f, i, ZONE_SMOOTH) * f->dt * mpsi_fluid_rate(f);
  p.paired = fmin(fmax(PAIRED * mpsi_fluid_steepness(f, i) - PAIRED_FROM, 0.0), 1.0);
  if (f->company[i] & MPSI_FLUID_NEAR_ROUGH) p.paired = 1.0;
  const double steep = mpsi_fluid_steepness(f, i) / SHARED_FROM - 1.0;
  const double rough = p.rough / (part * f->dt * mpsi_fluid_rate(f) + 1e-300) - 1.0;
  p.shared = f->zone[i] ? 0.0 : fmin(fmax(steep, 0.0), 1.0) * fmin(fmax(rough, 0.0), 1.0);
  return p;
}

/* What viscosity leaves of a part. */
static double left(double part, double share) { return fmax(fmin(part, MOST_SMOOTH) - share, 0.0); }

/* a (1 - s) of particle i. */
static double one_sided(const mps_fluid *f, int64_t i, double share) {
  const parts p = find_parts(f, i);
  return (1.0 - p.paired) * left(p.gentle + (1.0 - p.shared) * p.rough, share);
}

/* ---- between pairs --------------------------------------------------------------------------- */

static void prepare(mps_fluid *f, int64_t begin, int64_t end, int64_t chunk) {
  double any = 0.0;
  for (int64_t i = begin; i < end; i++) {
    const mpsi_fluid_local *local = &f->local[i];
    f->flux[0][i] = 0.0f;
    double G[4];
    mpsi_fluid_gradient(local, G);
    for (int k = 0; k < 4; k++) f->flux[1 + k][i] = (float)G[k];
    if (f->state[i] == MPSI_FLUID_APART) continue;
    const parts p = find_parts(f, i);
    const double share = viscous_share(f, i), rest = p.gentle + (1.0 - p.shared) * p.rough;
    const double a = p.paired * left(PAIRED_SMOOTH * p.gentle + p.rough, share) +
                     (1.0 - p.paired) * (left(p.gentle + p.rough, share) - left(rest, share));
    f->flux[0][i] = (float)(a / local->n);
    any = fmax(any, a);
  }
  f->system.sums[2 * chunk] = any;
}

/* G of an image in polylines: M G M^T. */
static void mirror_in_lines(const mps_fluid *f, int64_t ghost, double *G) {
  const mpsi_fluid_path *path = mpsi_fluid_path_of(f, ghost);
  for (int c = 0; path && c < 2; c++) { /* columns */
    double column[2] = {G[c], G[2 + c]};
    mpsi_fluid_reflect(path, column);
    G[c] = column[0], G[2 + c] = column[1];
  }
  for (int r = 0; path && r < 2; r++) mpsi_fluid_reflect(path, G + 2 * r);
}

/* G of an image: R G R^T, R the reflections at its walls. */
static void mirror_images(mps_fluid *f, int64_t begin, int64_t end, int64_t chunk) {
  for (int64_t g = begin; g < end; g++) {
    const int64_t j = f->count + g, own = f->parent[g];
    double G[4];
    for (int k = 0; k < 4; k++) G[k] = f->flux[1 + k][own];
    MPSI_FLUID_FLIPS(n, f->flips[g]) {
      const double *N = f->wall[f->flips[g].wall[n]].normal;
      for (int c = 0; c < 2; c++) { /* columns, then rows */
        const double across = G[c] * N[0] + G[2 + c] * N[1];
        G[c] -= 2.0 * across * N[0], G[2 + c] -= 2.0 * across * N[1];
      }
      for (int r = 0; r < 2; r++) {
        const double across = G[2 * r] * N[0] + G[2 * r + 1] * N[1];
        G[2 * r] -= 2.0 * across * N[0], G[2 * r + 1] -= 2.0 * across * N[1];
      }
    }
    mirror_in_lines(f, g, G);
    f->flux[0][j] = f->flux[0][own];
    for (int k = 0; k < 4; k++) f->flux[1 + k][j] = (float)G[k];
  }
}

/* Sums of a run without pairs are 0, whether they are made or not: ranks need not agree. */
void mpsi_fluid_prepare_smoothing(mps_fluid *f) {
  const int64_t padded = mpsi_fluid_sorted_room(f->count + f->ghosts);
  for (int k = 0; k < 5; k++) f->flux[k] = (float *)f->lower_room.item + k * padded;
  mpsi_fluid_for(f, f->count, MPSI_FLUID_CHUNK, prepare);
  mpsi_fluid_send_sums(f, MPSI_FLUID_CHUNK);
  double any = 0.0;
  for (int64_t k = 0; k * MPSI_FLUID_CHUNK < f->count; k++)
    any = mpsi_fluid_larger(f->system.sums[2 * k], any);
  f->paired = any > 0.0;
  if (!f->paired) return;
  mpsi_fluid_send_flux(f);
  mpsi_fluid_for_all(f, f->ghosts, MPSI_FLUID_CHUNK, mirror_images);
}

/* ---- of a particle --------------------------------------------------------------------------- */

/* The first wall of no slip that an image is mirrored at; -1: none. */
static int first_sticky(const mps_fluid *f, int64_t ghost) {
  MPSI_FLUID_FLIPS(k, f->flips[ghost])
  if (f->wall[f->flips[ghost].wall[k]].sticky) return f->flips[ghost].wall[k];
  return -1;
}

/* Beside the surface the neighbours are on one side, and what a linear field leaves over is not the
 * viscous force: the part of sum w du that bears a shear along the surface, which there is none of,
 * is G m of its tangent t, and with -(G + G^T) m along t instead of -G m the stress is 0 there.
 * Along the normal the surface's pressure balances the stress (mpsi_fluid_surface_stress). Where G
 * is not known well, sum w du stands alone. */
static void add_surface(const mps_fluid *f, const mpsi_fluid_local *local, double *v) {
  double G[4];
  mpsi_fluid_gradient(local, G);
  const double *m = local->m, square = m[0] * m[0] + m[1] * m[1];
  const double part = mpsi_fluid_stressed(f, local);
  const double shear =
      part / square *
      ((G[1] + G[2]) * (m[0] * m[0] - m[1] * m[1]) + 2.0 * (G[3] - G[0]) * m[0] * m[1]);
  const double alone = 1.0 - part;
  v[0] += (alone * (G[0] * m[0] + G[1] * m[1]) - shear * m[1]) / local->n;
  v[1] += (alone * (G[2] * m[0] + G[3] * m[1]) + shear * m[0]) / local->n;
}

/* v of the velocity field that sticks to the walls of no slip: there an image moves with the
 * opposite velocity. */
static void viscous_rest(const mps_fluid *f, int64_t i, double *v) {
  const mpsi_fluid_local *local = &f->local[i];
  const int32_t *index = f->index + mpsi_fluid_pairs(f, i);
  const float *w = f->w + mpsi_fluid_pairs(f, i);
  v[0] = local->rest[0], v[1] = local->rest[1];
  for (int32_t k = 0; (f->sticky || f->segments > 0) && k < f->near[i]; k++) {
    const int64_t j = index[k], ghost = j - f->count;
    if (ghost < 0 || !(first_sticky(f, ghost) >= 0 || mpsi_fluid_path_of(f, ghost))) continue;
    double stuck[2] = {f->u[0][j], f->u[1][j]};
    mpsi_fluid_stick(f, ghost, stuck);
    for (int c = 0; c < 2; c++) v[c] += w[k] * (stuck[c] - f->u[c][j]) / local->n;
  }
  if (below_surface(f, i)) add_surface(f, local, v);
}

/* ---- at walls -------------------------------------------------------------------------------- */

/* Of the viscosity's change of velocity what is not along a normal: to the first wall of no slip.
 */
static void exchange_along(const mps_fluid *f, int64_t chunk, int64_t ghost, int64_t i,
                           const double *dv) {
  const int first = first_sticky(f, ghost);
  double along[2] = {dv[0], dv[1]};
  mpsi_fluid_exchange_along_line(f, chunk, ghost, i, dv);
  if (first < 0 || mpsi_fluid_path_of(f, ghost)) return;
  MPSI_FLUID_FLIPS(k, f->flips[ghost]) {
    const double *N = f->wall[f->flips[ghost].wall[k]].normal;
    const double across = along[0] * N[0] + along[1] * N[1];
    for (int c = 0; c < 2; c++) along[c] -= across * N[c];
  }
  mpsi_fluid_exchange_drag(f, chunk, first, i, along);
}

/* Spin (1/s) of the body that the first wall of no slip of an image is a face of. The stress on a
 * face is mu (G + G^T) N, of which what pairs exchange is G N: along a face that turns G^T N is mu
 * times the spin, whatever the water does, and adds up to no force on a body under water. */
static double spin_at(const mps_fluid *f, int64_t ghost) {
  const int first = first_sticky(f, ghost);
  const int32_t body = first < 0 ? 0 : f->wall[first].of_body;
  return body > 0 ? f->body[body - 1].next.spin : 0.0;
}

/* To walls what particle i, which keeps the part `smooth` of v, exchanges with their images. */
static void exchange(const mps_fluid *f, int64_t chunk, int64_t i, double smooth, double viscous) {
  const mpsi_fluid_local *local = &f->local[i];
  const int32_t *index = f->index + mpsi_fluid_pairs(f, i);
  const float *w = f->w + mpsi_fluid_pairs(f, i);
  double G[4];
  mpsi_fluid_turn turn;
  const bool turns = (f->faces || f->segments > 0) && mpsi_fluid_fit_turn(f, i, &turn);
  mpsi_fluid_gradient(local, G);
  for (int32_t k = 0; k < f->near[i]; k++) {
    const int64_t j = index[k], ghost = j - f->count;
    if (ghost < 0) continue;
    const double dx = f->x[0][j] - f->x[0][i], dy = f->x[1][j] - f->x[1][i];
    const double part = w[k] / local->n;
    const double pair = f->paired ? 0.5 * w[k] * (f->flux[0][i] + f->flux[0][j]) : 0.0;
    double dv[2], stuck[2] = {f->u[0][j], f->u[1][j]};
    if (viscous > 0.0 && (f->sticky || f->segments > 0)) mpsi_fluid_stick(f, ghost, stuck);
    double bent[2] = {0.0, 0.0};
    if (turns) mpsi_fluid_add_turn(f, &turn, i, j, bent);
    for (int c = 0; c < 2; c++) {
      const double linear = f->u[c][i] + G[2 * c] * dx + G[2 * c + 1] * dy + bent[c];
      stuck[c] = part * viscous * (stuck[c] - f->u[c][i]);
      dv[c] = part * (smooth * (f->u[c][j] - linear)) + stuck[c];
      if (!(pair > 0.0)) continue;
      const float *gx = f->flux[1 + 2 * c], *gy = f->flux[2 + 2 * c];
      dv[c] +=
          pair * (f->u[c][j] - f->u[c][i] - 0.5 * ((gx[i] + gx[j]) * dx + (gy[i] + gy[j]) * dy));
    }
    mpsi_fluid_exchange_image(f, chunk, ghost, i, dv);
    if (!(viscous > 0.0)) continue;
    const double spin = spin_at(f, ghost);
    stuck[0] += part * viscous * spin * dy, stuck[1] -= part * viscous * spin * dx;
    exchange_along(f, chunk, ghost, i, stuck);
  }
}

void mpsi_fluid_smooth(const mps_fluid *f, int64_t chunk, int64_t i, double *du) {
  double a = 0.0, share = 0.0;
  du[0] = du[1] = 0.0;
  if (f->paired) f->loops->smooth(f, i, du);
  if (f->state[i] != MPSI_FLUID_APART) {
    double v[2] = {0.0, 0.0};
    share = viscous_share(f, i), a = one_sided(f, i, share);
    if (share > 0.0) viscous_rest(f, i, v);
    for (int c = 0; c < 2; c++) du[c] += share * v[c] + a * f->local[i].rest[c];
  }
  if ((f->company[i] & MPSI_FLUID_NEAR_IMAGES) && (a + share > 0.0 || f->paired))
    exchange(f, chunk, i, a, share);
}
