/* loads.c - loads of the water on the structure of mps-flume: force, moment about its heel, uplift
 * below a body on rock, pressures at the foot, at probes and along the faces; those of water at
 * rest. SPDX-License-Identifier: BSD-3-Clause */
#include "flume.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { MOST = 2 * FLUME_POINTS + 4 }; /* segments of a polyline */

typedef struct load {
  double force[2], moment; /* N; N m that tips over towards the lee, about the heel */
} load;

/* The force on a segment acts at points x, y: (y - yh) Fx - (x - xh) Fy. */
static void add(load *sum, const flume *m, double fx, double fy, double x, double y) {
  sum->force[0] += fx, sum->force[1] += fy;
  sum->moment += (y - m->heel[1]) * fx - (x - m->heel[0]) * fy;
}

/* Its face looks down. */
static bool is_underside(const double *p, const double *q) {
  return q[0] - p[0] < -0.5 * hypot(q[0] - p[0], q[1] - p[1]);
}

/* ---- the present water ----------------------------------------------------------------------- */

/* The library's are forces on the water, moments about the origin. */
static void take(load *sum, const flume *m, const double *force, double moment) {
  sum->force[0] -= force[0], sum->force[1] -= force[1];
  sum->moment += moment + m->heel[1] * force[0] - m->heel[0] * force[1];
}

static mps_status measure_structure(const flume *m, load *sum) {
  double force[3 * MOST], moment[MOST];
  int64_t count;
  const mps_status status =
      mps_fluid_get_segments(m->fluid, FLUME_BED, MOST, &count, force, moment);
  for (int k = m->first; status == MPS_OK && k < m->last && k < count; k++)
    take(sum, m, force + 3 * k, moment[k]);
  return status;
}

static mps_status measure_body(const flume *m, load *sum, load *below) {
  double force[3 * MOST], moment[MOST];
  int64_t count;
  const flume_shapes *p = &m->shape;
  const mps_status status =
      mps_fluid_get_segments(m->fluid, FLUME_BODY, MOST, &count, force, moment);
  for (int k = 0; status == MPS_OK && k < p->body && k < count; k++)
    take(is_underside(p->body_point[k], p->body_point[(k + 1) % p->body]) ? below : sum, m,
         force + 3 * k, moment[k]);
  return status;
}

/* Half a spacing before the toe; on the front of a body half a spacing above its base. */
static void find_foot(const flume *m, double foot[3], int32_t *wall) {
  const flume_shapes *p = &m->shape;
  const double *at = m->ground[m->first], *from = m->first > 0 ? m->ground[m->first - 1] : at;
  int lowest = 0;
  *wall = FLUME_BED;
  foot[2] = 0.0;
  if (flume_has_body(m)) {
    for (int k = 1; k < p->body; k++) {
      const double *a = p->body_point[k], *b = p->body_point[lowest];
      if (a[1] < b[1] || (a[1] == b[1] && a[0] < b[0])) lowest = k;
    }
    at = p->body_point[lowest], from = p->body_point[(lowest + 1) % p->body];
    *wall = FLUME_BODY;
  } else if (!flume_has_structure(m)) {
    foot[0] = m->outlet - 0.5 * m->s.spacing, foot[1] = m->ground[m->grounds - 1][1];
    return;
  }
  const double way = 0.5 * m->s.spacing / hypot(from[0] - at[0], from[1] - at[1]);
  for (int c = 0; c < 2; c++) foot[c] = at[c] + way * (from[c] - at[c]);
}

static mps_status measure_pressures(flume *m, flume_sample *sample) {
  double foot[3];
  int32_t wall;
  mps_status status = MPS_OK;
  if (flume_is_loaded(m)) {
    find_foot(m, foot, &wall);
    status = mps_fluid_get_pressure(m->fluid, wall, 1, foot, &sample->foot);
  }
  for (int k = 0; status == MPS_OK && k < m->shape.probes; k++) {
    const double at[3] = {m->shape.probe[k][0], m->shape.probe[k][1], 0.0};
    status = mps_fluid_get_pressure(m->fluid, m->probe_wall[k], 1, at, &sample->probe[k]);
  }
  return status;
}

mps_status flume_measure_loads(flume *m, flume_sample *sample) {
  load sum = {.moment = 0.0}, below = {.moment = 0.0};
  mps_reaction r;
  mps_status status = measure_pressures(m, sample);
  if (status == MPS_OK && flume_has_structure(m) && !flume_has_body(m))
    status = measure_structure(m, &sum);
  if (status == MPS_OK && flume_has_body(m)) status = measure_body(m, &sum, &below);
  sample->force = sum.force[0] + below.force[0], sample->moment = sum.moment;
  sample->uplift = below.force[1], sample->uplift_moment = below.moment;
  if (status != MPS_OK || m->s.wall != FLUME_VERTICAL) return status;
  status = mps_fluid_get_reaction(m->fluid, FLUME_END, &r);
  if (status == MPS_OK) /* opposite forces on wall and water */
    sample->force = -r.force[0],
    sample->moment = r.moment[2] + r.force[0] * m->ground[m->grounds - 1][1];
  return status;
}

/* ---- pressures along the faces --------------------------------------------------------------- */

static mps_status add_faces(flume *m, int32_t wall, double from, flume_look *look) {
  int64_t count;
  mps_status status = mps_fluid_get_boundary_points(m->fluid, wall, 0, &count, NULL, NULL);
  double *x = calloc(4 * (size_t)count + 1, sizeof *x), *p = x ? x + 3 * count : NULL;
  float *more = NULL;
  if (status == MPS_OK && x)
    status = mps_fluid_get_boundary_points(m->fluid, wall, count, &count, x, p);
  if (status == MPS_OK && x)
    more = realloc(look->face, 3 * (size_t)(look->faces + count + 1) * sizeof *more);
  if (more) look->face = more;
  for (int64_t k = 0; more && k < count; k++) {
    float *row = look->face + 3 * look->faces;
    if (x[3 * k] < from) continue;
    row[0] = (float)x[3 * k], row[1] = (float)x[3 * k + 1], row[2] = (float)p[k];
    look->faces++;
  }
  free(x);
  return status == MPS_OK && !more ? MPS_ERROR_MEMORY : status;
}

/* Water behind the crest and what has returned may together be more than at the start. */
bool flume_look_room(flume_look *look, int64_t count) {
  if (count <= look->room) return true;
  float *more = realloc(look->value, 3 * (size_t)count * sizeof *more);
  if (!more) return false;
  look->value = more, look->room = count;
  return true;
}

mps_status flume_look_at(flume *m, flume_look *look, bool faces) {
  mps_view x, p;
  mps_status status = mps_particles_view(m->water, "position", &x);
  if (status == MPS_OK) status = mps_particles_view(m->water, "pressure", &p);
  if (status != MPS_OK) return status;
  if (!flume_look_room(look, x.shape[0])) return MPS_ERROR_MEMORY;
  look->t = mps_fluid_time(m->fluid);
  look->count = x.shape[0];
  for (int64_t i = 0; i < look->count; i++) {
    for (int c = 0; c < 2; c++) look->value[3 * i + c] = (float)*mps_view_f64(&x, i, c);
    look->value[3 * i + 2] = (float)*mps_view_f64(&p, i, 0);
  }
  look->faces = 0;
  if (!faces) return MPS_OK;
  if (flume_has_structure(m)) status = add_faces(m, FLUME_BED, m->toe - 0.1 * m->s.spacing, look);
  if (status == MPS_OK && flume_has_body(m)) status = add_faces(m, FLUME_BODY, 0.0, look);
  if (status == MPS_OK && m->s.wall == FLUME_VERTICAL) status = add_faces(m, FLUME_END, 0.0, look);
  return status;
}

/* ---- water at rest --------------------------------------------------------------------------- */

/* Hydrostatic pressure on the part of a segment below the level; its moment is quadratic along it:
 * Simpson's rule is exact. */
static void add_rest(load *sum, const flume *m, const double *p, const double *q) {
  const double level = m->s.depth;
  double a[2] = {p[0], p[1]}, b[2] = {q[0], q[1]};
  if (a[1] >= level && b[1] >= level) return;
  for (int end = 0; end < 2; end++) {
    double *high = end ? b : a;
    if (high[1] <= level) continue;
    high[0] = p[0] + (q[0] - p[0]) * (level - p[1]) / (q[1] - p[1]), high[1] = level;
  }
  const double e[2] = {b[0] - a[0], b[1] - a[1]}, length = hypot(e[0], e[1]);
  const double out = 0.6 * m->s.spacing / length;
  if (length < 1e-9 ||
      !flume_is_wet(m, a[0] + 0.5 * e[0] - out * e[1], a[1] + 0.5 * e[1] + out * e[0]))
    return;
  for (int k = 0; k < 3; k++) {
    const double s = 0.5 * k, part = k == 1 ? 4.0 / 6.0 : 1.0 / 6.0, y = a[1] + s * e[1];
    const double pressure = part * WAVES_DENSITY * WAVES_G * (level - y);
    add(sum, m, pressure * e[1], -pressure * e[0], a[0] + s * e[0], y);
  }
}

/* Area of a polygon below a height, and its first moment about x = 0. */
static void find_area(int count, const double *point, double top, double *area, double *first) {
  *area = *first = 0.0;
  for (int k = 0; k < count; k++) { /* Green, of the corners lowered to the height */
    const double *p = point + 2 * k, *q = point + 2 * ((k + 1) % count);
    double x[3] = {p[0], q[0], q[0]}, y[3] = {fmin(p[1], top), fmin(q[1], top), fmin(q[1], top)};
    if ((p[1] - top) * (q[1] - top) < 0.0) {
      x[1] = p[0] + (q[0] - p[0]) * (top - p[1]) / (q[1] - p[1]), y[1] = top;
    }
    for (int j = 0; j < 2; j++) {
      const double cross = x[j] * y[j + 1] - x[j + 1] * y[j];
      *area += 0.5 * cross, *first += cross * (x[j] + x[j + 1]) / 6.0;
    }
  }
  if (*area < 0.0) *area = -*area, *first = -*first;
}

/* Weight in still water, and its arm about the heel. */
static void find_weight(flume *m) {
  const flume_shapes *p = &m->shape;
  double polygon[FLUME_POINTS + 1][2], area, first, below, below_first;
  int count = flume_has_body(m) ? p->body : p->structure;
  memcpy(polygon, flume_has_body(m) ? p->body_point : p->structure_point, sizeof p->body_point);
  if (!flume_has_body(m)) memcpy(polygon[count++], m->heel, sizeof m->heel);
  find_area(count, polygon[0], INFINITY, &area, &first);
  find_area(count, polygon[0], m->s.depth, &below, &below_first);
  m->rest.weight = WAVES_G * (m->s.density * area - WAVES_DENSITY * below);
  const double moment = WAVES_G * (m->s.density * first - WAVES_DENSITY * below_first);
  m->rest.arm = m->heel[0] - moment / m->rest.weight;
}

double flume_weight(flume *m) {
  find_weight(m);
  return m->rest.weight;
}

void flume_find_rest(flume *m) {
  const flume_shapes *p = &m->shape;
  load sum = {.moment = 0.0}, below = {.moment = 0.0};
  double foot[3];
  int32_t wall;
  m->rest = (flume_rest){.weight = NAN, .arm = NAN};
  if (!flume_is_loaded(m)) return;
  find_foot(m, foot, &wall);
  m->rest.foot = WAVES_DENSITY * WAVES_G * (m->s.depth - foot[1]);
  if (m->s.wall == FLUME_VERTICAL) {
    const double depth = m->s.depth - foot[1];
    sum.force[0] = 0.5 * m->rest.foot * depth, sum.moment = sum.force[0] * depth / 3.0;
  } else if (flume_has_body(m)) {
    for (int k = 0; k < p->body; k++) {
      const double *a = p->body_point[k], *b = p->body_point[(k + 1) % p->body];
      add_rest(is_underside(a, b) ? &below : &sum, m, a, b);
    }
  } else {
    for (int k = m->first; k < m->last; k++) add_rest(&sum, m, m->ground[k], m->ground[k + 1]);
  }
  m->rest.force = sum.force[0] + below.force[0], m->rest.moment = sum.moment;
  m->rest.uplift = below.force[1], m->rest.uplift_moment = below.moment;
  if (flume_is_caisson(m)) find_weight(m);
}
