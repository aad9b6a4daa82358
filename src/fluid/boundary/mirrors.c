/* mirrors.c - images of particles in polylines. A line of sight that reaches a segment continues
 * reflected, at a corner of less than 180 degrees of fluid as often as the angle asks: what a
 * particle sees is the plane without gaps and without overlaps, however acute the corner. The image
 * of b by the mirrors 1, 2, ..., n, in the order in which the sight of a reaches them, is
 * R1 R2 ... Rn b. The way back has the same mirrors in the opposite order, so that b has the image
 * of a at the same distance: the matrix is symmetric.
 *
 * Around a convex corner particles without a line of sight are neighbours at the length of the path
 * around it (sight.c). Images in plane boundaries at right angles to a segment are mirrored in it
 * like particles. SPDX-License-Identifier: BSD-3-Clause */
#include "fluid/boundary/sight.h"
#include "fluid/boundary/vicinity.h"

#include <string.h>

#define EDGE 1e-6     /* l0: a sight through a concave corner is reflected there */
#define CORNER 1.5    /* l0 */
#define TURN 0.5236   /* rad: of a convex corner that counts as one */
#define STRAIGHT 1e-9 /* rad */
#define PI 3.141592653589793
#define TIED 1e-9   /* of a way: no distance between two segments */
#define SQUARE 1e-6 /* cosine of the angle of walls at right angles */

/* ---- images ---------------------------------------------------------------------------------- */

static const mpsi_fluid_flips no_flips = {{MPSI_FLUID_NO_WALL, MPSI_FLUID_NO_WALL}};

/* Appends the image of entry i of the cloud at a segment; false: no room. */
static bool add_image(mps_fluid *f, int64_t i, const mpsi_fluid_segment *s) {
  const int64_t before = i - f->count;
  if (f->ghosts == f->ghost_capacity) return false;
  const double *n = s->wall.normal, x[2] = {f->x[0][i], f->x[1][i]};
  const double d = mpsi_fluid_before_segment(s, x);
  const int64_t g = f->ghosts++;
  mpsi_fluid_path *paths = f->path_room.item, *path = &paths[g];
  for (int c = 0; c < 2; c++) f->x[c][f->count + g] = x[c] - 2.0 * d * n[c];
  f->parent[g] = before < 0 ? (int32_t)i : f->parent[before];
  f->flips[g] = before < 0 ? no_flips : f->flips[before];
  const mpsi_fluid_path none = {.M = {1.0, 0.0, 0.0, 1.0}},
                        *from = before < 0 ? &none : &paths[before];
  path->count = from->count + 1;
  path->segment[0] = s->all;
  memcpy(path->segment + 1, from->segment, (size_t)from->count * sizeof *path->segment);
  for (int c = 0; c < 2; c++) { /* R of the segment times the product so far */
    const double across = n[0] * from->M[c] + n[1] * from->M[2 + c];
    for (int r = 0; r < 2; r++) path->M[2 * r + c] = from->M[2 * r + c] - 2.0 * across * n[r];
  }
  return true;
}

/* Whether entry i of the cloud is in front of a segment and within re of it. */
static bool in_reach(const mps_fluid *f, int64_t i, const mpsi_fluid_segment *s) {
  const double x[2] = {f->x[0][i], f->x[1][i]}, re = f->reach;
  const double d = mpsi_fluid_before_segment(s, x);
  if (!(d > 0.0 && d < re)) return false;
  return mpsi_fluid_from_segment(s, x) < re * re;
}

/* Whether a sight can reach segment s first and segment p next: some of s is in front of p. */
static bool leads_to(const mps_fluid *f, const mpsi_fluid_segment *s, const mpsi_fluid_segment *p) {
  const double slope =
      -(s->wall.normal[0] * p->wall.normal[1] - s->wall.normal[1] * p->wall.normal[0]);
  for (int c = 0; c < 2; c++) {
    if (mpsi_fluid_before_segment(p, s->end[c]) > EDGE * f->l0) return true;
    if (s->infinite[c] && (c ? -slope : slope) < -1e-12) return true;
  }
  return false;
}

/* An image in boundaries is mirrored at segments at right angles to all of them. */
static bool square_to_flips(const mps_fluid *f, int64_t ghost, const mpsi_fluid_segment *s) {
  MPSI_FLUID_FLIPS(k, f->flips[ghost]) {
    const double *n = f->wall[f->flips[ghost].wall[k]].normal;
    if (fabs(n[0] * s->wall.normal[0] + n[1] * s->wall.normal[1]) > SQUARE) return false;
  }
  return true;
}

/* Images of the particles, segment by segment. */
static bool mirror_particles(mps_fluid *f) {
  for (int64_t k = 0; k < f->segments; k++) {
    mpsi_fluid_segment *s = mpsi_fluid_segment_of(f, k);
    const mpsi_fluid_listed chunks = mpsi_fluid_chunks_near(f, k);
    s->wall.first_image = f->ghosts;
    for (int64_t c = 0; c < chunks.count; c++) {
      const int64_t begin = (int64_t)chunks.item[c] * MPSI_FLUID_CHUNK;
      for (int64_t i = begin; i < begin + MPSI_FLUID_CHUNK && i < f->count; i++)
        if (in_reach(f, i, s) && !add_image(f, i, s)) return false;
    }
    s->wall.images = f->ghosts - s->wall.first_image;
  }
  return true;
}

/* Images of the first `ghosts` ghosts, those of boundaries, segment by segment. */
static bool mirror_ghosts(mps_fluid *f, int64_t ghosts) {
  const int64_t entries = f->segments;
  bool *const near = f->near_line_room.item;
  memset(near, 0, (size_t)entries * sizeof *near);
  for (int64_t i = f->count; i < f->count + ghosts; i++) {
    const mpsi_fluid_listed list = mpsi_fluid_near_place(f, (double[]){f->x[0][i], f->x[1][i]});
    for (int64_t n = 0; n < list.count; n++)
      near[list.item[n]] |= in_reach(f, i, mpsi_fluid_segment_of(f, list.item[n]));
  }
  for (int64_t k = 0; k < entries; k++) {
    const mpsi_fluid_segment *s = mpsi_fluid_segment_of(f, k);
    for (int64_t g = 0; near[k] && g < ghosts; g++)
      if (in_reach(f, f->count + g, s) && square_to_flips(f, g, s) &&
          !add_image(f, f->count + g, s))
        return false;
  }
  return true;
}

bool mpsi_fluid_mirror_lines(mps_fluid *f) {
  const int64_t of_boundaries = f->ghosts;
  if (!mpsi_room_fit(f->context, &f->path_room, f->ghost_capacity, sizeof(mpsi_fluid_path)) ||
      !mpsi_room_ensure(f->context, &f->near_line_room, f->segments, sizeof(bool)))
    return false;
  mpsi_fluid_path *path = f->path_room.item;
  for (int64_t g = 0; g < of_boundaries; g++)
    path[g] = (mpsi_fluid_path){.M = {1.0, 0.0, 0.0, 1.0}};
  if (!mirror_particles(f)) return false;
  const int64_t first = f->ghosts;
  if (!mirror_ghosts(f, of_boundaries)) return false;
  for (int64_t g = of_boundaries; g < f->ghosts; g++) {
    const int64_t i = f->count + g;
    if (g >= first && f->flips[g].wall[0] != MPSI_FLUID_NO_WALL) continue; /* corners are far */
    const mpsi_fluid_segment *p = mpsi_fluid_segment_of(f, path[g].segment[0]);
    const mpsi_fluid_listed near = mpsi_fluid_near_place(f, (double[]){f->x[0][i], f->x[1][i]});
    for (int64_t n = 0; n < near.count && path[g].count < MPSI_FLUID_REFLECTIONS; n++) {
      const mpsi_fluid_segment *s = mpsi_fluid_segment_of(f, near.item[n]);
      if (s != p && in_reach(f, i, s) && leads_to(f, s, p) && !add_image(f, i, s)) return false;
    }
  }
  return true;
}

/* ---- sight ----------------------------------------------------------------------------------- */

/* Whether the way from a to b passes through a segment from its front, and at which share of it.
 * Through a convex corner counts as past it, through a concave one as through both segments. */
static bool crosses(const mps_fluid *f, const mpsi_fluid_segment *s, const double *a,
                    const double *b, double *share) {
  const double da = mpsi_fluid_before_segment(s, a), db = mpsi_fluid_before_segment(s, b);
  if (!(db < 0.0 && da > -EDGE * f->l0)) return false;
  *share = da > 0.0 ? da / (da - db) : 0.0;
  const double x = a[0] + *share * (b[0] - a[0]), y = a[1] + *share * (b[1] - a[1]);
  const double along = mpsi_fluid_along(&s->wall, x, y), edge = EDGE * f->l0;
  return along > s->wall.from + (s->angle[1] < PI + STRAIGHT ? -edge : edge) &&
         along < s->wall.to - (s->angle[0] < PI + STRAIGHT ? -edge : edge);
}

/* The segments within re of a particle, or where those are more than `own` has room for, all that
 * are listed. */
typedef struct vicinity {
  int64_t count;
  const int32_t *segment;
  int32_t own[32];
} vicinity;

static void look_about(const mps_fluid *f, int64_t i, const double *x, vicinity *near) {
  enum { MOST = sizeof near->own / sizeof *near->own };
  const mpsi_fluid_listed list = mpsi_fluid_near_chunk(f, i / MPSI_FLUID_CHUNK);
  const double re2 = f->reach * f->reach;
  near->count = 0, near->segment = near->own;
  for (int64_t n = 0; n < list.count; n++) {
    const mpsi_fluid_segment *s = mpsi_fluid_segment_of(f, list.item[n]);
    const double d = mpsi_fluid_before_segment(s, x);
    if (!(d * d < re2 && mpsi_fluid_from_segment(s, x) < re2)) continue;
    if (near->count == MOST) {
      near->count = list.count, near->segment = list.item;
      return;
    }
    near->own[near->count++] = list.item[n];
  }
}

/* The first segment that the way from a to b passes; not the one that it comes from. Of two at a
 * corner that with the lower number: a particle in a corner of 90 degrees sees its image by both
 * segments through the corner, once, however numbers are rounded. */
static int32_t first_mirror(const mps_fluid *f, const vicinity *near, int32_t from, const double *a,
                            const double *b, double *share) {
  int32_t first = -1;
  for (int64_t n = 0; n < near->count; n++) {
    double at = 0.0;
    if (near->segment[n] == from) continue;
    if (!crosses(f, mpsi_fluid_segment_of(f, near->segment[n]), a, b, &at)) continue;
    const bool tied = fabs(at - *share) < TIED;
    if (first < 0 || (tied ? near->segment[n] < first : at < *share))
      first = near->segment[n], *share = at;
  }
  return first;
}

/* Whether the sight of a towards entry j of the cloud is reflected at the mirrors of its path, and
 * no other.
 */
static bool follows(const mps_fluid *f, const vicinity *near, const double *a, int64_t j) {
  const mpsi_fluid_path *path = j < f->count ? NULL : mpsi_fluid_path_of(f, j - f->count);
  double at[2] = {a[0], a[1]}, to[2] = {f->x[0][j], f->x[1][j]}, share = 0.0;
  int32_t from = -1;
  for (int32_t n = 0; path && n < path->count; n++) {
    const mpsi_fluid_segment *s = mpsi_fluid_segment_of(f, path->segment[n]);
    if (first_mirror(f, near, from, at, to, &share) != path->segment[n]) return false;
    if (f->faces && mpsi_fluid_hidden(f, -1, at, to)) return false;
    for (int c = 0; c < 2; c++) at[c] += share * (to[c] - at[c]);
    const double d = mpsi_fluid_before_segment(s, to);
    for (int c = 0; c < 2; c++) to[c] -= 2.0 * d * s->wall.normal[c];
    from = path->segment[n];
  }
  return first_mirror(f, near, from, at, to, &share) < 0;
}

/* Length of the way from a to b around the nearest convex corner, m; INFINITY without one. */
static double way_around(const mps_fluid *f, const vicinity *near, const double *a,
                         const double *b) {
  double least = INFINITY, share = 0.0;
  for (int64_t n = 0; n < near->count; n++) {
    const mpsi_fluid_segment *s = mpsi_fluid_segment_of(f, near->segment[n]);
    const double *tip = s->end[1];
    if (s->infinite[1] || !(s->angle[1] > PI + STRAIGHT)) continue;
    const double way = hypot(a[0] - tip[0], a[1] - tip[1]) + hypot(b[0] - tip[0], b[1] - tip[1]);
    if (way < least && way < f->reach && first_mirror(f, near, -1, a, tip, &share) < 0 &&
        first_mirror(f, near, -1, b, tip, &share) < 0)
      least = way;
  }
  return least;
}

/* A single segment, whose corners are out of reach. */
static bool plain(const mps_fluid *f, const vicinity *near, const double *x) {
  if (near->count != 1) return false;
  const mpsi_fluid_segment *s = mpsi_fluid_segment_of(f, near->segment[0]);
  const double along = mpsi_fluid_along(&s->wall, x[0], x[1]), re = f->reach;
  return along > s->wall.from + re && along < s->wall.to - re;
}

int64_t mpsi_fluid_keep_seen(const mps_fluid *f, int64_t i, int64_t count, int32_t *index,
                             double *r2) {
  const double x[2] = {f->x[0][i], f->x[1][i]};
  vicinity near;
  int64_t kept = 0;
  look_about(f, i, x, &near);
  const bool simple = near.count == 0 || plain(f, &near, x);
  for (int64_t k = 0; k < count; k++) {
    const int64_t j = index[k];
    double square = r2[k];
    if (simple) {
      const mpsi_fluid_path *path = j < f->count ? NULL : mpsi_fluid_path_of(f, j - f->count);
      if (path && (near.count == 0 || path->count != 1 || path->segment[0] != near.segment[0]))
        continue;
    } else if (!follows(f, &near, x, j)) {
      const double other[2] = {f->x[0][j], f->x[1][j]};
      const double way = j < f->count ? way_around(f, &near, x, other) : INFINITY;
      if (!(way < f->reach)) continue;
      square = way * way;
    }
    index[kept] = index[k], r2[kept] = square;
    kept++;
  }
  return kept;
}

const mpsi_fluid_segment *mpsi_fluid_crossed(const mps_fluid *f, const mpsi_fluid_listed *list,
                                             const mpsi_fluid_segment *except, const double *a,
                                             const double *b, double *share) {
  const mpsi_fluid_segment *first = NULL;
  for (int64_t n = 0; n < list->count; n++) {
    const mpsi_fluid_segment *s = mpsi_fluid_segment_of(f, list->item[n]);
    double at = 0.0;
    if (s == except || !crosses(f, s, a, b, &at)) continue;
    if (!first || at < *share) first = s, *share = at;
  }
  return first;
}

bool mpsi_fluid_behind_line(const mps_fluid *f, const mpsi_fluid_segment *except, const double *a,
                            const double *b) {
  const mpsi_fluid_listed near = mpsi_fluid_near_place(f, a);
  double share = 0.0;
  return mpsi_fluid_crossed(f, &near, except, a, b, &share) != NULL;
}

bool mpsi_fluid_in_solid(const mps_fluid *f, const double *x, double least) {
  const mpsi_fluid_listed near = mpsi_fluid_near_place(f, x);
  for (int64_t n = 0; n < near.count;) {
    const mpsi_fluid_segment *nearest = NULL;
    const double d = mpsi_fluid_before_listed(f, &near, &n, x, &nearest);
    if (d < -least && d > -mpsi_fluid_listed_reach(f)) return true;
  }
  return false;
}

bool mpsi_fluid_near_turn(const mps_fluid *f, int64_t i) {
  const mpsi_fluid_listed near = mpsi_fluid_near_chunk(f, i / MPSI_FLUID_CHUNK);
  const double reach = CORNER * f->l0;
  for (int64_t n = 0; n < near.count; n++) {
    const mpsi_fluid_segment *s = mpsi_fluid_segment_of(f, near.item[n]);
    const double dx = f->x[0][i] - s->end[1][0], dy = f->x[1][i] - s->end[1][1];
    if (s->angle[1] > PI + TURN && dx * dx + dy * dy < reach * reach) return true;
  }
  return false;
}
