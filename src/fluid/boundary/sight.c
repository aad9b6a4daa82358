/* sight.c - visibility between particles and images. A wall that ends (the face of a body, a
 * boundary that joins another one at an angle other than 90 degrees) is a mirror of finite size: an
 * image in it is visible to a particle only where the straight line to the image passes through the
 * mirror, and another particle only where no face is in between. The line from a to the image of b
 * is the reflection of that from b to the image of a, so b's image is visible to a exactly when a's
 * is to b: the matrix is symmetric. Every line from a particle has one first mirror, so that images
 * neither overlap nor leave gaps, at concave and at convex corners. Around a convex corner
 * particles without a line of sight are neighbours at the length of the path around it: without
 * them the flow around the corner is too stiff.
 *
 * A boundary that a body stands on ends at the body: its images are visible like those of a face.
 * Where the body overhangs the water, lines of sight of several reflections have no image, as
 * images at walls at an angle are not mirrored again; these missing neighbours are no free surface.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "sight.h"
#include "fluid/base/flow_solver.h"

#define EDGE 1e-6  /* l0 */
#define CORNER 1.5 /* l0 */
#define WEDGE 3.1  /* l0: to the edge of an acute corner */
#define TOWARDS 0.5
#define RUSH 2.5       /* (g l0)^1/2: from there on l0/|u| limits the step */
#define RUSH_BELOW 1.0 /* (g l0)^1/2: past a body in open water */
#define ALONE 3.1      /* l0 */
#define SLOW 0.25      /* of its square: below, water is slow */

static bool join_at_an_angle(const mpsi_fluid_wall *a, const mpsi_fluid_wall *b) {
  const double cosine = a->normal[0] * b->normal[0] + a->normal[1] * b->normal[1];
  return fabs(cosine) > 1e-6 && fabs(cosine) < 1.0 - 1e-9;
}

static bool makes_wedge(const mps_fluid *f, const mpsi_fluid_wall *face, int end) {
  for (int b = 0; b < f->boundaries; b++) {
    const double *n = f->wall[b].normal;
    if (n[0] * face->normal[0] + n[1] * face->normal[1] < -1e-6 &&
        mpsi_fluid_stands_on(f, face, end, b))
      return true;
  }
  return false;
}

/* Acute corners of the water between faces and the boundary on which they stand. */
static void find_wedges(mps_fluid *f) {
  f->wedges = 0;
  for (int b = f->boundaries; b < f->walls; b++) {
    const mpsi_fluid_wall *w = &f->wall[b];
    for (int end = 0; w->used && end < 2; end++) {
      if (!makes_wedge(f, w, end)) continue;
      double *at = f->wedge[f->wedges++];
      const double along = end ? w->length : 0.0;
      at[0] = w->at[0] - along * w->normal[1], at[1] = w->at[1] + along * w->normal[0];
    }
  }
}

bool mpsi_fluid_near_wedge(const mps_fluid *f, int64_t i, const double *e) {
  for (int k = 0; k < f->wedges; k++) {
    const double dx = f->wedge[k][0] - f->x[0][i], dy = f->wedge[k][1] - f->x[1][i];
    const double r2 = dx * dx + dy * dy;
    if (!(r2 < WEDGE * WEDGE * f->l0 * f->l0)) continue;
    if (!e || dx * e[0] + dy * e[1] > TOWARDS * sqrt(r2)) return true;
  }
  return false;
}

bool mpsi_fluid_point_near_wedge(const mps_fluid *f, const double *x) {
  for (int k = 0; k < f->wedges; k++)
    if (hypot(f->wedge[k][0] - x[0], f->wedge[k][1] - x[1]) < WEDGE * f->l0) return true;
  return false;
}

static bool joins_another(const mps_fluid *f, int b) {
  for (int k = 0; k < f->boundaries; k++)
    if (k != b && f->wall[k].used && join_at_an_angle(&f->wall[b], &f->wall[k])) return true;
  return false;
}

static bool carries_a_body(const mps_fluid *f, int b) {
  for (int k = f->boundaries; k < f->walls; k++) {
    const mpsi_fluid_wall *w = &f->wall[k];
    if (w->used && (mpsi_fluid_stands_on(f, w, 0, b) || mpsi_fluid_stands_on(f, w, 1, b)))
      return true;
  }
  return false;
}

/* Finite walls, faces, and the acute corners between these and boundaries. */
void mpsi_fluid_find_limits(mps_fluid *f) {
  f->limited = f->faces = 0;
  for (int b = 0; b < f->walls; b++) {
    mpsi_fluid_wall *w = &f->wall[b];
    w->limited = w->used && (w->of_body || joins_another(f, b));
    w->stood_on = w->used && !w->of_body && carries_a_body(f, b);
    f->limited += w->limited;
    f->faces += w->used && w->of_body;
  }
  find_wedges(f);
}

static double ahead(const mpsi_fluid_wall *w, const double *x) {
  return mpsi_fluid_distance(w, w->now.s, x[0], x[1]);
}

/* Whether the line from a to b passes through the wall, and where. Through a corner counts as past
 * it, and so does it from b to a, whatever the rounding. */
static bool passes(const mps_fluid *f, const mpsi_fluid_wall *w, const double *a, const double *b,
                   double *at) {
  const double da = ahead(w, a), db = ahead(w, b);
  if ((da > 0.0) == (db > 0.0)) return false;
  const double t = da / (da - db);
  for (int c = 0; c < 2; c++) at[c] = a[c] + t * (b[c] - a[c]);
  if (!w->of_body) return true;
  const double along = mpsi_fluid_along(w, at[0], at[1]);
  return along > w->from + EDGE * f->l0 && along < w->to - EDGE * f->l0;
}

/* Whether the box of the way from a to b overlaps that of a body. */
static bool comes_by(const mpsi_fluid_body *body, const double *a, const double *b) {
  for (int c = 0; c < 2; c++)
    if ((a[c] < body->low[c] && b[c] < body->low[c]) ||
        (a[c] > body->high[c] && b[c] > body->high[c]))
      return false;
  return body->body != NULL;
}

/* Whether a face besides those of `except` is between a and b. */
static bool hidden(const mps_fluid *f, mpsi_fluid_flips except, const double *a, const double *b) {
  double at[2];
  for (int n = 0; n < f->bodies; n++) {
    const mpsi_fluid_body *body = &f->body[n];
    if (!comes_by(body, a, b)) continue;
    for (int k = body->first; k < body->first + body->faces; k++)
      if (f->wall[k].used && k != except.wall[0] && k != except.wall[1] &&
          passes(f, &f->wall[k], a, b, at))
        return true;
  }
  return false;
}

static const mpsi_fluid_flips none = {{MPSI_FLUID_NO_WALL, MPSI_FLUID_NO_WALL}};

bool mpsi_fluid_hidden(const mps_fluid *f, int wall, const double *a, const double *b) {
  mpsi_fluid_flips except = none;
  if (wall >= 0) except.wall[0] = (uint16_t)wall;
  return hidden(f, except, a, b);
}

/* Whether the mirror exists at the point of passage: not behind a boundary at an angle to it. */
static bool mirror_is_there(const mps_fluid *f, int wall, const double *at) {
  for (int b = 0; b < f->boundaries; b++) {
    const mpsi_fluid_wall *w = &f->wall[b];
    if (b != wall && w->used && join_at_an_angle(w, &f->wall[wall]) && ahead(w, at) < -EDGE * f->l0)
      return false;
  }
  return true;
}

/* Those of the walls that end, or that a body stands on. */
static mpsi_fluid_flips ending(const mps_fluid *f, mpsi_fluid_flips flips) {
  mpsi_fluid_flips found = none;
  int count = 0;
  MPSI_FLUID_FLIPS(k, flips)
  if (f->wall[flips.wall[k]].limited || f->wall[flips.wall[k]].stood_on)
    found.wall[count++] = flips.wall[k];
  return found;
}

static bool sees(const mps_fluid *f, int64_t i, int64_t j) {
  const double a[2] = {f->x[0][i], f->x[1][i]}, b[2] = {f->x[0][j], f->x[1][j]};
  const mpsi_fluid_flips flips = j < f->count ? none : ending(f, f->flips[j - f->count]);
  if (flips.wall[0] == MPSI_FLUID_NO_WALL) return !hidden(f, none, a, b);
  MPSI_FLUID_FLIPS(k, flips) {
    const mpsi_fluid_wall *w = &f->wall[flips.wall[k]];
    double at[2];
    if (!(ahead(w, a) > 0.0) || !passes(f, w, a, b, at) || !mirror_is_there(f, flips.wall[k], at))
      return false;
    const double d = ahead(w, b),
                 back[2] = {b[0] - 2.0 * d * w->normal[0], b[1] - 2.0 * d * w->normal[1]};
    if (hidden(f, flips, a, at) || hidden(f, flips, at, back)) return false;
  }
  return true;
}

/* Whether the list of particle i may have invisible entries: images are up to re behind and beyond
 * a wall that ends. */
static bool near_limit(const mps_fluid *f, int64_t i) {
  const double x[2] = {f->x[0][i], f->x[1][i]}, reach = 2.0 * f->reach;
  for (int k = 0; f->limited > f->faces && k < f->boundaries; k++)
    if (f->wall[k].limited && fabs(ahead(&f->wall[k], x)) < reach) return true;
  for (int n = 0; n < f->bodies; n++) {
    const mpsi_fluid_body *body = &f->body[n];
    if (!mpsi_fluid_beside(body, x, 2.0 * reach)) continue;
    for (int k = body->first; k < body->first + body->faces; k++) {
      const mpsi_fluid_wall *w = &f->wall[k];
      if (!w->used || !(fabs(ahead(w, x)) < reach)) continue;
      const double along = mpsi_fluid_along(w, x[0], x[1]);
      if (along > w->from - reach && along < w->to + reach) return true;
    }
  }
  return false;
}

bool mpsi_fluid_within(const mps_fluid *f, int64_t i, double reach) {
  const double x[2] = {f->x[0][i], f->x[1][i]};
  for (int n = 0; n < f->bodies; n++) {
    const mpsi_fluid_body *body = &f->body[n];
    if (!mpsi_fluid_beside(body, x, 2.0 * reach)) continue;
    for (int k = body->first; k < body->first + body->faces; k++) {
      const mpsi_fluid_wall *w = &f->wall[k];
      const double dx = x[0] - w->at[0], dy = x[1] - w->at[1];
      if (w->used && w->from == 0.0 && dx * dx + dy * dy < reach * reach) return true;
    }
  }
  return false;
}

/* Whether the box around a body lies ALONE from the water's level, walls and other bodies. */
static bool in_open_water(const mps_fluid *f, const mpsi_fluid_body *body) {
  const double far = ALONE * f->l0;
  double x[2]; /* the box's corner farthest along a direction */
  for (int c = 0; c < 2; c++) x[c] = f->up[c] > 0.0 ? body->high[c] : body->low[c];
  if (!(f->rest - f->up[0] * x[0] - f->up[1] * x[1] > far)) return false;
  for (int b = 0; b < f->boundaries; b++) {
    const mpsi_fluid_wall *w = &f->wall[b];
    for (int c = 0; c < 2; c++) x[c] = w->normal[c] > 0.0 ? body->low[c] : body->high[c];
    if (w->used && !w->line && !(mpsi_fluid_distance(w, w->now.s, x[0], x[1]) > far)) return false;
  }
  for (int n = 0; n < f->bodies; n++) {
    const mpsi_fluid_body *other = &f->body[n];
    if (other != body && other->body && mpsi_fluid_boxes_near(body, other, far)) return false;
  }
  return true;
}

/* 0 where particle i has less than half of the speed `fast`, (g l0)^1/2, relative to bodies within
 * `reach`, to 1 from `fast` on; of bodies in open water where `below`. */
static double rush_past(const mps_fluid *f, int64_t i, double reach, double fast, bool below) {
  const double x[2] = {f->x[0][i], f->x[1][i]}, fast2 = fast * fast * f->g * f->l0;
  double most2 = 0.0;
  for (int n = 0; n < f->bodies; n++) {
    if (!mpsi_fluid_beside(&f->body[n], x, reach)) continue;
    if (below && !in_open_water(f, &f->body[n])) continue;
    const mpsi_fluid_pose *p = &f->body[n].pose;
    const double v[2] = {f->u[0][i] - p->v[0] + p->spin * (x[1] - p->x[1]),
                         f->u[1][i] - p->v[1] - p->spin * (x[0] - p->x[0])};
    most2 = fmax(most2, v[0] * v[0] + v[1] * v[1]);
  }
  if (most2 >= fast2) return most2 > 0.0 ? 1.0 : 0.0;
  return fmax((most2 / fast2 - SLOW) / (1.0 - SLOW), 0.0);
}

double mpsi_fluid_rush(const mps_fluid *f, int64_t i, double reach) {
  return rush_past(f, i, reach, RUSH, false);
}

double mpsi_fluid_rush_below(const mps_fluid *f, int64_t i, double reach) {
  return rush_past(f, i, reach, RUSH_BELOW, true);
}

bool mpsi_fluid_near_corner(const mps_fluid *f, int64_t i) {
  return mpsi_fluid_within(f, i, CORNER * f->l0);
}

double mpsi_fluid_past_corner(const mps_fluid *f, int64_t i, int64_t ghost) {
  const int64_t j = f->count + ghost;
  double least = INFINITY;
  MPSI_FLUID_FLIPS(k, f->flips[ghost]) {
    const mpsi_fluid_wall *w = &f->wall[f->flips[ghost].wall[k]];
    double at[2];
    if (!w->of_body) continue;
    const double a[2] = {f->x[0][i], f->x[1][i]}, b[2] = {f->x[0][j], f->x[1][j]};
    if (!passes(f, w, a, b, at)) continue;
    const double along = mpsi_fluid_along(w, at[0], at[1]);
    if (w->from == 0.0) least = fmin(least, along);
    if (w->to == w->length) least = fmin(least, w->length - along);
  }
  return least;
}

/* Length of the path from a to b around the nearest corner of a body, m; INFINITY without one. */
static double way_around(const mps_fluid *f, const double *a, const double *b) {
  double least = INFINITY;
  for (int n = 0; n < f->bodies; n++) {
    const mpsi_fluid_body *body = &f->body[n];
    if (!mpsi_fluid_beside(body, a, 2.0 * f->reach)) continue;
    for (int k = body->first; k < body->first + body->faces; k++) {
      const mpsi_fluid_wall *w = &f->wall[k];
      if (!w->used || w->from < 0.0) continue; /* that corner stands on a boundary */
      const double way =
          hypot(a[0] - w->at[0], a[1] - w->at[1]) + hypot(b[0] - w->at[0], b[1] - w->at[1]);
      if (way < least && way < f->reach && !hidden(f, none, a, w->at) && !hidden(f, none, w->at, b))
        least = way;
    }
  }
  return least;
}

int64_t mpsi_fluid_keep_visible(const mps_fluid *f, int64_t i, int64_t count, int32_t *index,
                                double *r2) {
  if (!near_limit(f, i)) return count;
  int64_t kept = 0;
  const double own[2] = {f->x[0][i], f->x[1][i]};
  for (int64_t k = 0; k < count; k++) {
    const int64_t j = index[k];
    double square = r2[k];
    if (!sees(f, i, j)) {
      const double other[2] = {f->x[0][j], f->x[1][j]};
      const double way = j < f->count && f->faces ? way_around(f, own, other) : INFINITY;
      if (!(way < f->reach)) continue;
      square = way * way;
    }
    index[kept] = index[k], r2[kept] = square;
    kept++;
  }
  return kept;
}
