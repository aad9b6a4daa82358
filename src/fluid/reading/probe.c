/* probe.c - pressures along walls, their forces, and the level of the surface.
 *
 * The pressure at a point of a wall is a weighted least-squares fit, linear ALONG the wall, with
 * the weight (1 - r/(2.1 l0))^2, of q - rho (a . N)(distance from the wall), N out of the fluid;
 * then p = q - rho g (height - level), and 0 where that is less than the air's at a surface near,
 * or suction. The acceleration of a particle by loads counts like -a of the wall.
 *
 * Where a wall that moves ends in a free surface, q is r ln r: a line through the particles alone,
 * extrapolated over the half spacing above them, has .1 rho a l0^2 too much force. So the surface
 * above a particle is a point of the fit too, with the air's pressure. A particle represents a
 * spacing along the wall, the surface point the end of one: it has half the weight, less where the
 * water's surface is along the wall, or the wall is level.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "probe.h"
#include "fluid/boundary/sight.h"
#include "fluid/particles/look.h"
#include "fluid/boundary/polyline.h"
#include "fluid/ranks/partition.h"

#define REACH 2.1         /* l0 */
#define LEAST_SUM 0.05    /* of weights: below, there is no water */
#define LEAST_SPREAD 0.02 /* l0^2: below, the mean is taken */
#define SURFACE_PART 0.5  /* of a particle's weight, for the surface above it */
#define LEVEL_RISE 0.5    /* l0: from a particle of an undisturbed surface to that */

/* A particle near a wall. */
typedef struct neighbour {
  double d, s, q; /* distance; coordinate along the wall; q extrapolated to it */
  double air;     /* pressure on its surface, Pa; -infinity where it is inside */
  double least;   /* its least pressure, Pa */
  double part;    /* of the weight, for the surface above; 0: none */
  double top[3];  /* d, s and q there */
  int64_t i;
} neighbour;

/* Sums of a fit. */
typedef struct fit {
  double water; /* the weights of particles */
  double w, ws, wss, wq, wsq;
  double air;   /* Pa, the largest of surfaces near; -infinity where none is */
  double least; /* Pa, <= 0 */
} fit;

static const fit no_fit = {.air = -INFINITY};

static double weight_of(const mps_fluid *f, double d, double s) {
  const double a = 1.0 - sqrt(d * d + s * s) / (REACH * f->l0);
  return a > 0.0 ? a * a : 0.0;
}

static void fit_point(fit *sum, double w, double s, double q) {
  sum->w += w, sum->ws += w * s, sum->wss += w * s * s;
  sum->wq += w * q, sum->wsq += w * s * q;
}

/* A particle near the point at `at` along the wall. */
static void fit_add(const mps_fluid *f, fit *sum, double w, double at, const neighbour *n) {
  sum->air = mpsi_fluid_larger(sum->air, n->air);
  sum->least = -mpsi_fluid_larger(-sum->least, -n->least);
  sum->water += w;
  fit_point(sum, w, n->s - at, n->q);
  if (n->part > 0.0)
    fit_point(sum, n->part * weight_of(f, n->top[0], n->top[1] - at), n->top[1] - at, n->top[2]);
}

/* A point has water where its pressure is more than this: than that of the air at a surface. */
static double driest(const fit *sum) { return sum->air > -INFINITY ? sum->air : sum->least; }

/* Reduced pressure at s = 0. */
static double fit_value(const mps_fluid *f, const fit *sum) {
  const double det = sum->w * sum->wss - sum->ws * sum->ws;
  const bool line = det > LEAST_SPREAD * sum->w * sum->w * f->l0 * f->l0;
  return line ? (sum->wss * sum->wq - sum->ws * sum->wsq) / det : sum->wq / sum->w;
}

/* The place of a coordinate along the wall in space. */
static void place(const mps_fluid *f, const mpsi_fluid_wall *w, double along, double *x) {
  const double *at = mpsi_fluid_places(f, w);
  const double s = w->nodes == 1 ? at[0] : mpsi_fluid_between(w, at, along);
  x[0] = w->at[0] + s * w->normal[0] - along * w->normal[1];
  x[1] = w->at[1] + s * w->normal[1] + along * w->normal[0];
}

/* Height (m) of the surface above particle i. Between steps it is the field's, as the moments are
 * not of the present order of the particles. */
static double rise_of(const mps_fluid *f, int64_t i) {
  if (f->stage == MPSI_FLUID_BETWEEN)
    return mpsi_particles_column(f->particles, "surface_rise", 0)[i];
  return mpsi_fluid_rise(f, i);
}

/* The surface above particle i as a point of the fit. */
static void find_top(const mps_fluid *f, const mpsi_fluid_wall *w, neighbour *n) {
  const double along = w->normal[0] * f->up[1] - w->normal[1] * f->up[0];
  const double across = w->normal[0] * f->up[0] + w->normal[1] * f->up[1];
  const double rise = f->state[n->i] == MPSI_FLUID_SURFACE && f->g > 0.0 ? rise_of(f, n->i) : 0.0;
  n->part = 0.0;
  if (!(rise > 0.0)) return;
  const double level = fmin(rise / (LEVEL_RISE * f->l0), 1.0);
  const double *x[2] = {f->x[0], f->x[1]};
  n->part = SURFACE_PART * along * along * level * level;
  n->top[0] = n->d + rise * across, n->top[1] = n->s + rise * along;
  n->top[2] =
      n->air + mpsi_fluid_head(f, x[0][n->i] + rise * f->up[0], x[1][n->i] + rise * f->up[1]);
}

/* Term of a particle in the fit: false where it is too far from the wall. Its acceleration is along
 * the normal into the fluid, -N. */
static bool near_wall(const mps_fluid *f, const mpsi_fluid_wall *w, int64_t i, neighbour *out) {
  const double x = f->x[0][i], y = f->x[1][i];
  out->d = mpsi_fluid_distance(w, mpsi_fluid_places(f, w), x, y);
  if (fabs(out->d) >= REACH * f->l0 || f->state[i] == MPSI_FLUID_APART) return false;
  if ((w->of_body || w->of_line) && out->d < 0.0) return false;
  double a = mpsi_fluid_of_wall(w, mpsi_fluid_accelerations(f, w), x, y);
  if (f->push[0]) a -= f->push[0][i] * w->normal[0] + f->push[1][i] * w->normal[1];
  out->s = mpsi_fluid_along(w, x, y);
  out->q = f->q[i] + f->def.density * a * out->d;
  out->air = f->state[i] != MPSI_FLUID_SURFACE ? -INFINITY : f->over ? f->over[i] : 0.0;
  out->least = mpsi_fluid_least(f, i);
  out->i = i;
  find_top(f, w, out);
  return true;
}

/* Whether each particle near a wall has an image there: unless displacements since exceed the reach
 * of images beyond the fit. */
static bool has_images(const mps_fluid *f) { return f->travel < f->weight.re - REACH * f->l0; }

/* The particles near a wall, in the order of the set, to near_wall_room. */
static mps_status gather(mps_fluid *f, const mpsi_fluid_wall *w, const char *function,
                         int64_t *count) {
  const bool imaged = has_images(f);
  const int64_t candidates = imaged ? w->images : f->count;
  if (!mpsi_room_ensure(f->context, &f->near_wall_room, candidates + 1, sizeof(neighbour)))
    return mpsi_fail_memory(f->context, function, (size_t)candidates * sizeof(neighbour));
  neighbour *list = f->near_wall_room.item;
  int64_t found = 0;
  for (int64_t k = 0; k < candidates; k++) {
    const int64_t i = imaged ? f->parent[w->first_image + k] : k;
    if (near_wall(f, w, i, &list[found])) found++;
  }
  *count = found;
  return MPS_OK;
}

#define ON_LINE 1e-3 /* l0 */

/* Whether a point of a wall lies on its wetted side of the boundaries and outside of bodies. */
static bool among_walls(const mps_fluid *f, const mpsi_fluid_wall *own, const double *x) {
  for (int32_t k = 0; k < f->boundaries; k++) {
    const mpsi_fluid_wall *w = &f->wall[k];
    if (w != own && w->used && mpsi_fluid_distance(w, mpsi_fluid_places(f, w), x[0], x[1]) < 0.0)
      return false;
  }
  if (f->segments > 0 && mpsi_fluid_in_solid(f, x, ON_LINE * f->l0)) return false;
  return !f->faces || !mpsi_fluid_inside_body(f, own->of_body, x);
}

/* Spacing of a wall's points: l0, or a face's length in whole parts. */
static double pitch(const mps_fluid *f, const mpsi_fluid_wall *w) {
  return w->of_body || w->of_line ? w->length / fmax(round(w->length / f->l0), 1.0) : f->l0;
}

/* Points of the wall with particles near: numbers low to high - 1. */
static void wetted_range(const mps_fluid *f, const mpsi_fluid_wall *w, int64_t near, int64_t *low,
                         int64_t *high) {
  const neighbour *list = f->near_wall_room.item;
  double least = INFINITY, most = -INFINITY;
  for (int64_t k = 0; k < near; k++) least = fmin(least, list[k].s), most = fmax(most, list[k].s);
  *low = *high = 0;
  if (!(least <= most)) return;
  const double step = pitch(f, w);
  *low = (int64_t)floor(least / step) - 4;
  *high = (int64_t)ceil(most / step) + 4;
  if (!w->of_body && !w->of_line) return;
  const int64_t points = (int64_t)round(w->length / step);
  if (w->of_body || isfinite(w->from)) *low = *low > 0 ? *low : 0;
  if (w->of_body || isfinite(w->to)) *high = *high < points ? *high : points;
}

/* Whether nothing that ends is between particle i and the point of a wall. */
static bool sees_point(const mps_fluid *f, const mpsi_fluid_wall *w, double along, int64_t i) {
  double at[2];
  const double x[2] = {f->x[0][i], f->x[1][i]};
  place(f, w, along, at);
  if (f->faces && mpsi_fluid_hidden(f, w->of_line ? -1 : (int)(w - f->wall), x, at)) return false;
  const mpsi_fluid_segment *own = w->of_line ? (const mpsi_fluid_segment *)w : NULL;
  return f->segments == 0 || !mpsi_fluid_behind_line(f, own, x, at);
}

#define GAP_POINTS 3 /* from a point in the gap of an acute corner to the next with particles */

/* Whether a point of a wall lies in an acute corner between a body and a boundary, in the water. */
static bool in_acute_corner(const mps_fluid *f, const double *x) {
  if (!mpsi_fluid_point_near_wedge(f, x)) return false;
  for (int b = 0; b < f->bodies; b++) { /* not below a body, whose lower face is no wall */
    double most = -INFINITY;
    for (int k = f->body[b].first; k < f->body[b].first + f->body[b].faces; k++)
      if (f->wall[k].used)
        most = fmax(
            most, mpsi_fluid_distance(&f->wall[k], mpsi_fluid_places(f, &f->wall[k]), x[0], x[1]));
    if (most > -INFINITY && most < -ON_LINE * f->l0) return false;
  }
  return true;
}

/* Whether the water at one point of a wall reaches another one: no body stands between them. */
static bool reaches(const mps_fluid *f, const mpsi_fluid_wall *w, double from, double to) {
  double a[2], b[2];
  place(f, w, from, a), place(f, w, to, b);
  return !mpsi_fluid_hidden(f, (int)(w - f->wall), a, b);
}

/* The point whose sums give the pressure at point k of `count`: itself; in an acute corner, where
 * the water's last two spacings hold no particle, the nearest one that has some; -1: it is dry. */
static int64_t wet_point(const mps_fluid *f, const mpsi_fluid_wall *w, const fit *sum, int64_t low,
                         int64_t count, int64_t k, const double *x) {
  if (sum[k].water > LEAST_SUM) return k;
  if (w->of_line || f->wedges == 0 || !in_acute_corner(f, x)) return -1;
  const double step = pitch(f, w), at = ((double)(low + k) + 0.5) * step;
  for (int64_t n = 1; n <= GAP_POINTS; n++)
    for (int64_t other = k - n; other <= k + n; other += 2 * n)
      if (other >= 0 && other < count && sum[other].water > LEAST_SUM &&
          reaches(f, w, at, at + (double)(other - k) * step))
        return other;
  return -1;
}

/* Pressure of the water, p at a point, over the length of wall that it stands for: with air's on
 * the surface a part of the length is dry, where that is near, and has none of it. With all or
 * nothing the force of 100 Pa had steps of 2 N at the waterline of a box, as p passed the air's,
 * and no acceleration of it was in balance. */
static double from_water(const mps_fluid *f, double p, double air) {
  const double unit = f->def.density * f->g * f->l0;
  if (!isfinite(air) || air == 0.0 || !(unit > 0.0)) return p > air ? p : 0.0;
  return fmax(p - air, 0.0) + air * fmin(fmax(0.5 + (p - air) / unit, 0.0), 1.0);
}

/* Calls `point` for each wetted point of a wall with its position and pressure. */
typedef void (*point_fn)(void *user, const double *x, double p);

static mps_status for_points(mps_fluid *f, const mpsi_fluid_wall *w, const char *function,
                             point_fn point, void *user) {
  const double step = pitch(f, w);
  const bool ends = f->faces || f->segments > 0;
  int64_t low, high, near;
  MPSI_TRY(gather(f, w, function, &near));
  wetted_range(f, w, near, &low, &high);
  fit *sum = NULL;
  if (high > low) {
    if (!mpsi_room_ensure(f->context, &f->fit_room, high - low, sizeof *sum))
      return mpsi_fail_memory(f->context, function, (size_t)(high - low) * sizeof *sum);
    sum = f->fit_room.item;
    for (int64_t k = 0; k < high - low; k++) sum[k] = no_fit;
  }
  const neighbour *list = f->near_wall_room.item;
  for (int64_t n = 0; n < near && high > low; n++) {
    const double s = list[n].s;
    const double reach = REACH * f->l0 / step;
    const int64_t first = (int64_t)floor(s / step - reach), last = (int64_t)(s / step + reach);
    for (int64_t k = first > low ? first : low; k <= last && k < high; k++) {
      const double at = ((double)k + 0.5) * step, weight = weight_of(f, list[n].d, s - at);
      if (weight > 0.0 && (!ends || sees_point(f, w, at, list[n].i)))
        fit_add(f, &sum[k - low], weight, at, &list[n]);
    }
  }
  for (int64_t k = low; k < high; k++) {
    double x[2];
    place(f, w, ((double)k + 0.5) * step, x);
    const int64_t of = wet_point(f, w, sum, low, high - low, k - low, x);
    if (of < 0 || !among_walls(f, w, x)) continue;
    const double p = fit_value(f, &sum[of]) - mpsi_fluid_head(f, x[0], x[1]);
    const double air = driest(&sum[of]), bears = from_water(f, p, air);
    if (p > air || bears != 0.0) point(user, x, bears);
  }
  return MPS_OK;
}

/* ---- forces ---------------------------------------------------------------------------------- */

typedef struct resultant {
  mpsi_fluid_wall *wall;
  double area;
} resultant;

static void add_force(void *user, const double *x, double p) {
  const resultant *r = user;
  const double force[2] = {p * r->area * r->wall->normal[0], p * r->area * r->wall->normal[1]};
  mpsi_fluid_load *load = &r->wall->load;
  for (int c = 0; c < 2; c++) load->force[c] += force[c];
  load->moment += x[0] * force[1] - x[1] * force[0];
  load->power += p * r->area * mpsi_fluid_of_wall(r->wall, r->wall->mean, x[0], x[1]);
  load->wetted++;
}

/* Friction, which is known once the water has moved. */
static void add_friction(const mps_fluid *f, mpsi_fluid_wall *w) {
  if (!(w->friction > 0.0)) return;
  for (int c = 0; c < 2; c++) w->load.force[c] += w->sheared.impulse[c] / f->dt;
  w->load.moment += w->sheared.moment / f->dt;
  w->load.power += w->sheared.work / f->dt;
}

/* The force of a polyline is that of its segments. */
static mps_status load_line(mps_fluid *f, const char *function, mpsi_fluid_wall *boundary) {
  mpsi_fluid_load *all = &boundary->load;
  *all = (mpsi_fluid_load){0};
  for (int64_t k = 0; k < boundary->line->count; k++) {
    mpsi_fluid_wall *w = &boundary->line->segment[k].wall;
    w->load = (mpsi_fluid_load){0};
    if (has_images(f) && w->images == 0) continue; /* far from the water */
    resultant r = {w, pitch(f, w) * f->def.measure};
    MPSI_TRY(for_points(f, w, function, add_force, &r));
    add_friction(f, w);
    for (int c = 0; c < 2; c++) all->force[c] += w->load.force[c];
    all->moment += w->load.moment, all->wetted += w->load.wetted;
  }
  return MPS_OK;
}

mps_status mpsi_fluid_load_walls(mps_fluid *f, const char *function) {
  mps_status status = MPS_OK;
  if (f->stage != MPSI_FLUID_MOVED) mpsi_fluid_send_local(f); /* the memory is allocated by then */
  for (int32_t b = 0; status == MPS_OK && b < f->walls; b++) {
    mpsi_fluid_wall *w = &f->wall[b];
    if (w->line) status = load_line(f, function, w);
    if (!w->used) continue;
    w->load = (mpsi_fluid_load){0};
    resultant r = {w, pitch(f, w) * f->def.measure};
    status = for_points(f, w, function, add_force, &r);
    if (status == MPS_OK) add_friction(f, w);
  }
  return mpsi_fluid_agree(f, function, status);
}

static mps_status check_wall(const mps_fluid *f, const char *function, int32_t number) {
  if (!MPSI_FLUID_IS_BOUNDARY(f, number) || f->wall[number].open)
    return mpsi_fail(f->context, function, MPS_ERROR_ARGUMENT,
                     "number is %d: there is no boundary of this number", number);
  return MPS_OK;
}

mps_status mpsi_fluid_get_reaction(void *solver, const char *function, mps_status status,
                                   int32_t number, mps_reaction *out) {
  const mps_fluid *f = solver;
  if (status != MPS_OK) return status;
  const mpsi_fluid_wall *w = &f->wall[number];
  mps_reaction reaction = {.count = w->load.wetted,
                           .work = w->work,
                           .removed = w->removed,
                           .removed_mass = w->removed_mass};
  for (int c = 0; c < 2; c++)
    reaction.force[c] = w->load.force[c], reaction.impulse[c] = w->impulse[c];
  reaction.moment[2] = w->load.moment;
  reaction.moment_impulse[2] = w->moment_impulse;
  *out = reaction;
  return MPS_OK;
}

/* Pressures belong to a state: of the last step, or of the last solution in an open step. */
static mps_status check_pressure(mps_fluid *f, const char *function) {
  f->report_before_look = f->report;
  if (f->stage == MPSI_FLUID_BEGUN)
    return mpsi_fail(f->context, function, MPS_ERROR_STATE,
                     "the open step's pressure has not been solved");
  MPSI_TRY(mpsi_fluid_agree(f, function, mpsi_particles_committed(f->particles, function)));
  return mpsi_fluid_refresh(f, function);
}

/* ---- pressures ------------------------------------------------------------------------------- */

typedef struct listing {
  int64_t capacity, count;
  double *x, *pressure;
} listing;

static void list_point(void *user, const double *x, double p) {
  listing *list = user;
  const int64_t k = list->count++;
  if (k >= list->capacity) return;
  if (list->x) list->x[3 * k] = x[0], list->x[3 * k + 1] = x[1], list->x[3 * k + 2] = 0.0;
  if (list->pressure) list->pressure[k] = p;
}

static mps_status list_points(mps_fluid *f, const char *function, const mpsi_fluid_wall *w,
                              listing *list) {
  if (!w->line) return for_points(f, w, function, list_point, list);
  for (int64_t k = 0; k < w->line->count; k++)
    MPSI_TRY(for_points(f, &w->line->segment[k].wall, function, list_point, list));
  return MPS_OK;
}

mps_status mps_fluid_get_boundary_points(const mps_fluid *handle, int32_t number, int64_t capacity,
                                         int64_t *count, double *x, double *pressure) {
  mps_fluid *f = (mps_fluid *)handle; /* scratch and messages only: the state stays */
  if (!f) return mpsi_null(__func__, "fluid");
  MPSI_TRY(check_wall(f, __func__, number));
  if (!count) return mpsi_fail(f->context, __func__, MPS_ERROR_ARGUMENT, "count is NULL");
  if (capacity < 0)
    return mpsi_fail(f->context, __func__, MPS_ERROR_ARGUMENT, "capacity is %lld, must be >= 0",
                     (long long)capacity);
  listing list = {.capacity = capacity, .x = x, .pressure = pressure};
  mps_status status = check_pressure(f, __func__);
  if (status == MPS_OK) status = list_points(f, __func__, &f->wall[number], &list);
  status = mpsi_fluid_show_surface(f, mpsi_fluid_agree(f, __func__, status));
  if (status == MPS_OK) *count = list.count;
  return status;
}

/* Whether a point is on a wall at its present position, or without displacement; *off: how far (m).
 */
static bool is_on(const mps_fluid *f, const mpsi_fluid_wall *w, const double *x, double *off) {
  *off = mpsi_fluid_distance(w, w->now.s, x[0], x[1]);
  const double s = mpsi_fluid_of_wall(w, w->now.s, x[0], x[1]);
  return fabs(*off) <= 0.01 * f->l0 || fabs(*off + s) <= 0.01 * f->l0;
}

/* Walls whose pressures are asked for: one, the segments of one, or the faces of a body. */
typedef struct place_of {
  const mpsi_fluid_wall *wall; /* NULL: the body */
  const mpsi_fluid_body *body;
} place_of;

static const mpsi_fluid_wall *face_at(const mps_fluid *f, const mpsi_fluid_body *body,
                                      const double *x, double *off) {
  const double edge = 0.01 * f->l0;
  const mpsi_fluid_wall *found = NULL;
  *off = INFINITY;
  for (int k = 0; k < body->faces; k++) {
    const mpsi_fluid_wall *w = &f->wall[body->first + k];
    const double d = mpsi_fluid_distance(w, w->now.s, x[0], x[1]);
    const double along = mpsi_fluid_along(w, x[0], x[1]);
    if (along < -edge || along > w->length + edge || fabs(d) >= fabs(*off)) continue;
    *off = d, found = w;
  }
  return fabs(*off) <= edge ? found : NULL;
}

/* The wall, or the segment of a polyline, that a point is on; NULL: none. */
static const mpsi_fluid_wall *wall_at(const mps_fluid *f, const mpsi_fluid_wall *w, const double *x,
                                      double *off) {
  if (!w->line) return is_on(f, w, x, off) ? w : NULL;
  const mpsi_fluid_segment *nearest = NULL;
  *off = mpsi_fluid_before_line(w->line, x, &nearest);
  return fabs(*off) <= 0.01 * f->l0 ? &nearest->wall : NULL;
}

static const mpsi_fluid_wall *find_place(const mps_fluid *f, const place_of *of, const double *x,
                                         double *off) {
  return of->wall ? wall_at(f, of->wall, x, off) : face_at(f, of->body, x, off);
}

static mps_status check_points(mps_fluid *f, const char *function, const place_of *of,
                               int64_t count, const double *x, const double *pressure) {
  if (count < 0)
    return mpsi_fail(f->context, function, MPS_ERROR_ARGUMENT, "count is %lld, must be >= 0",
                     (long long)count);
  if (count > 0 && (!x || !pressure))
    return mpsi_fail(f->context, function, MPS_ERROR_ARGUMENT, "%s is NULL", x ? "pressure" : "x");
  for (int64_t k = 0; k < count; k++) {
    double off;
    if (!find_place(f, of, x + 3 * k, &off))
      return mpsi_fail(f->context, function, MPS_ERROR_ARGUMENT,
                       "x: point %lld (%g, %g) m is %g m off the wall, allowed is l0/100 = %g m",
                       (long long)k, x[3 * k], x[3 * k + 1], off, 0.01 * f->l0);
  }
  return MPS_OK;
}

static fit fit_at(const mps_fluid *f, const mpsi_fluid_wall *w, int64_t near, double at) {
  const neighbour *list = f->near_wall_room.item;
  fit sum = no_fit;
  for (int64_t i = 0; i < near; i++) {
    const double s = list[i].s - at, weight = weight_of(f, list[i].d, s);
    if (weight > 0.0 && (!(w->of_line || w->of_body) || sees_point(f, w, at, list[i].i)))
      fit_add(f, &sum, weight, at, &list[i]);
  }
  return sum;
}

/* The same; in an acute corner without particles that of the nearest point with some. */
static fit wet_fit(const mps_fluid *f, const mpsi_fluid_wall *w, int64_t near, double at,
                   const double *x) {
  const fit own = fit_at(f, w, near, at);
  if (own.water > LEAST_SUM || w->of_line || f->wedges == 0 || !in_acute_corner(f, x)) return own;
  for (int n = 1; n <= GAP_POINTS; n++)
    for (int side = -1; side <= 1; side += 2) {
      const double to = at + side * n * f->l0;
      const fit other = fit_at(f, w, near, to);
      if (other.water > LEAST_SUM && reaches(f, w, at, to)) return other;
    }
  return own;
}

/* Pressure at a point of a wall near which `near` particles have been gathered. */
static double pressure_at(const mps_fluid *f, const mpsi_fluid_wall *w, int64_t near,
                          const double *x) {
  const double at = mpsi_fluid_along(w, x[0], x[1]);
  double to[2];
  place(f, w, at, to);
  const fit sum = wet_fit(f, w, near, at, to);
  const double head = mpsi_fluid_head(f, to[0], to[1]);
  const double p = sum.water > LEAST_SUM ? fit_value(f, &sum) - head : 0.0;
  return p > driest(&sum) ? p : 0.0;
}

/* Points one after the other on the same segment share what is gathered. */
static mps_status find_pressures(mps_fluid *f, const char *function, const place_of *of,
                                 int64_t count, const double *x, double *pressure) {
  const mpsi_fluid_wall *last = NULL;
  int64_t near = 0;
  for (int64_t k = 0; k < count; k++) {
    double off;
    const mpsi_fluid_wall *w = find_place(f, of, x + 3 * k, &off);
    MPSI_TRY(w == last ? MPS_OK : gather(f, w, function, &near));
    last = w;
    pressure[k] = pressure_at(f, w, near, x + 3 * k);
  }
  return MPS_OK;
}

/* `status`: of this rank's arguments so far, on which all ranks agree first. */
static mps_status get_pressures(mps_fluid *f, const char *function, mps_status status,
                                const place_of *of, int64_t count, const double *x,
                                double *pressure) {
  if (status == MPS_OK) status = check_points(f, function, of, count, x, pressure);
  MPSI_TRY(mpsi_fluid_agree(f, function, status));
  status = check_pressure(f, function);
  if (status == MPS_OK) status = find_pressures(f, function, of, count, x, pressure);
  return mpsi_fluid_show_surface(f, mpsi_fluid_agree(f, function, status));
}

mps_status mps_fluid_get_pressure(const mps_fluid *handle, int32_t number, int64_t count,
                                  const double *x, double *pressure) {
  mps_fluid *f = (mps_fluid *)handle; /* scratch and messages only: the state stays */
  if (!f) return mpsi_null(__func__, "fluid");
  const mps_status status = check_wall(f, __func__, number);
  const place_of of = {.wall = status == MPS_OK ? &f->wall[number] : NULL};
  return get_pressures(f, __func__, status, &of, count, x, pressure);
}

mps_status mps_fluid_get_body_pressure(const mps_fluid *handle, const mps_contact *contact,
                                       int64_t count, const double *x, double *pressure) {
  mps_fluid *f = (mps_fluid *)handle; /* scratch and messages only: the state stays */
  if (!f) return mpsi_null(__func__, "fluid");
  const int32_t number = mpsi_fluid_body_number(f, contact);
  const place_of of = {.body = number < 0 ? NULL : &f->body[number]};
  mps_status status = MPS_OK;
  if (number < 0)
    status = mpsi_fail(f->context, __func__, MPS_ERROR_ARGUMENT,
                       "contact is %s: give one that mps_fluid_add_contact has made for this fluid",
                       contact ? "that of another solver, or has ended" : "NULL");
  return get_pressures(f, __func__, status, &of, count, x, pressure);
}

mps_status mps_fluid_get_segments(const mps_fluid *f, int32_t number, int64_t capacity,
                                  int64_t *count, double *force, double *moment) {
  if (!f) return mpsi_null(__func__, "fluid");
  const bool line = MPSI_FLUID_IS_BOUNDARY(f, number) && f->wall[number].line;
  if (!line)
    return mpsi_fail(f->context, __func__, MPS_ERROR_ARGUMENT,
                     "number is %d: there is no polyline of this number, and other boundaries have "
                     "no segments",
                     number);
  if (capacity < 0)
    return mpsi_fail(f->context, __func__, MPS_ERROR_ARGUMENT, "capacity is %lld, must be >= 0",
                     (long long)capacity);
  if (!count) return mpsi_fail(f->context, __func__, MPS_ERROR_ARGUMENT, "count is NULL");
  const mpsi_fluid_polyline *of = f->wall[number].line;
  *count = of->count;
  for (int64_t k = 0; k < of->count && k < capacity; k++) {
    const mpsi_fluid_load *load = &of->segment[k].wall.load;
    for (int c = 0; c < 3 && force; c++) force[3 * k + c] = c < 2 ? load->force[c] : 0.0;
    if (moment) moment[k] = load->moment;
  }
  return MPS_OK;
}

/* ---- level ----------------------------------------------------------------------------------- */

mps_status mps_fluid_get_levels(const mps_fluid *handle, int64_t count, const double *station,
                                double *level) {
  mps_fluid *f = (mps_fluid *)handle; /* scratch and messages only: the state stays */
  if (!f) return mpsi_null(__func__, "fluid");
  if (count < 0)
    return mpsi_fail(f->context, __func__, MPS_ERROR_ARGUMENT, "count is %lld, must be >= 0",
                     (long long)count);
  if (count > 0 && (!station || !level))
    return mpsi_fail(f->context, __func__, MPS_ERROR_ARGUMENT, "%s is NULL",
                     station ? "level" : "station");
  for (int64_t k = 0; k < count; k++)
    if (!isfinite(station[k]))
      return mpsi_fail(f->context, __func__, MPS_ERROR_ARGUMENT,
                       "station %lld is %g m, must be finite", (long long)k, station[k]);
  MPSI_TRY(mpsi_fluid_agree(f, __func__, mpsi_particles_committed(f->particles, __func__)));
  MPSI_TRY(mpsi_fluid_ensure_surface(f, __func__));
  const double *x = mpsi_particles_column(f->particles, "position", 0);
  const double *y = mpsi_particles_column(f->particles, "position", 1);
  const double *rise = mpsi_particles_column(f->particles, "surface_rise", 0);
  for (int64_t k = 0; k < count; k++) {
    double sum = 0.0, height = 0.0;
    for (int64_t i = 0; i < f->count; i++) {
      if (rise[i] == 0.0) continue;
      const double across = f->up[1] * x[i] - f->up[0] * y[i];
      const double weight = 1.0 - fabs(across - station[k]) / (2.0 * f->l0);
      if (!(weight > 0.0)) continue;
      sum += weight;
      height += weight * (f->up[0] * x[i] + f->up[1] * y[i] + rise[i]);
    }
    level[k] = sum > 0.0 ? height / sum : (double)NAN;
  }
  return MPS_OK;
}
