/* fill.c - fills: particles at the lattice sites of a shape, at most one a site.
 *
 * A shape becomes runs of sites, row by row. The set keeps the runs that its fills have occupied; a
 * fill adds particles at its runs less these. Runs, not sites: a box of a million particles is a
 * thousand runs, and the difference and the union of sorted runs take one pass.
 *
 * Half-open convention: site i of an axis belongs to [lo, hi) when lo <= its centre < hi, where a
 * centre within round-off of a bound (1e-9 spacings) lies on it. So boxes and polygons with a
 * common edge neither share nor omit a site.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "core/context/guard.h"
#include "particles_private.h"

#include "core/base/hash.h"
#include "core/base/polygon.h"

#include <stdio.h>
#include <string.h>

#define ON_EDGE 1e-9        /* spacings: a centre this close to a bound lies on it */
#define MAX_INDEX 0x1p40    /* spacings from the origin */
#define MAX_SITES 0x1p31    /* of one fill, before the shape is cut out */
#define MAX_CORNERS 1000000 /* of a polygon */
#define ROUND_OFF 0x1p-50   /* a few units of relative rounding error */
#define OFF_BALL 0.1        /* of a ball's volume */
#define OFF_LATTICE 1e-6    /* spacings: a face this far from the sites' own is another size */

/* ---- runs ------------------------------------------------------------------------------------ */

/* Adds a run behind all others; false when out of memory. */
static bool append_run(mps_context *context, mpsi_site_runs *runs, mpsi_site_run run) {
  if (runs->count > 0) {
    mpsi_site_run *last = &runs->item[runs->count - 1];
    if (last->k == run.k && last->j == run.j && last->end == run.begin) {
      last->end = run.end;
      return true;
    }
  }
  if (runs->count == runs->capacity) {
    const int64_t capacity = runs->capacity ? 2 * runs->capacity : 64;
    void *item = runs->item;
    if (!mpsi_grow(context, &item, runs->count, capacity, sizeof *runs->item)) return false;
    runs->item = item;
    runs->capacity = capacity;
  }
  runs->item[runs->count++] = run;
  return true;
}

static bool row_before(const mpsi_site_run *a, const mpsi_site_run *b) {
  return a->k != b->k ? a->k < b->k : a->j < b->j;
}

/* a before b, with no site in common. */
static bool run_before(const mpsi_site_run *a, const mpsi_site_run *b) {
  return row_before(a, b) || (!row_before(b, a) && a->end <= b->begin);
}

/* out = a less b */
static bool runs_subtract(mps_context *context, const mpsi_site_runs *a, const mpsi_site_runs *b,
                          mpsi_site_runs *out) {
  int64_t n = 0;
  for (int64_t m = 0; m < a->count; m++) {
    mpsi_site_run rest = a->item[m];
    while (n < b->count && run_before(&b->item[n], &rest)) n++;
    /* The last run of b that overlaps `rest` may overlap the next one too: n stays at it. */
    for (int64_t q = n; q < b->count && !run_before(&rest, &b->item[q]); q++) {
      mpsi_site_run head = rest;
      head.end = b->item[q].begin;
      if (head.begin < head.end && !append_run(context, out, head)) return false;
      rest.begin = b->item[q].end;
      if (rest.begin >= rest.end) break;
    }
    if (rest.begin < rest.end && !append_run(context, out, rest)) return false;
  }
  return true;
}

/* out = a and b together, which have no site in common */
static bool runs_unite(mps_context *context, const mpsi_site_runs *a, const mpsi_site_runs *b,
                       mpsi_site_runs *out) {
  int64_t m = 0, n = 0;
  while (m < a->count || n < b->count) {
    const bool from_a = n == b->count || (m < a->count && run_before(&a->item[m], &b->item[n]));
    if (!append_run(context, out, from_a ? a->item[m++] : b->item[n++])) return false;
  }
  return true;
}

static double runs_sites(const mpsi_site_runs *runs) {
  double sites = 0.0;
  for (int64_t m = 0; m < runs->count; m++)
    sites += (double)(runs->item[m].end - runs->item[m].begin);
  return sites;
}

/* ---- the lattice ----------------------------------------------------------------------------- */

static double centre(const mps_particles *p, int32_t axis, int64_t i) {
  return p->def.origin[axis] + ((double)i + 0.5) * p->def.spacing;
}

/* First site of the axis whose centre is >= x (m). |x| is within the range of check_bound. */
static int64_t first_site(const mps_particles *p, int32_t axis, double x) {
  const double spacing = p->def.spacing, origin = p->def.origin[axis];
  const double edge = ON_EDGE + ROUND_OFF * ((fabs(x) + fabs(origin)) / spacing);
  return (int64_t)ceil((x - origin) / spacing - 0.5 - edge);
}

static mps_status check_bound(const mps_particles *p, const char *function, const char *what,
                              int32_t axis, double x) {
  if (!isfinite(x))
    return mpsi_fail(p->context, function, MPS_ERROR_ARGUMENT, "%s has %c = %g m, must be finite",
                     what, "xyz"[axis], x);
  if (!(fabs(x - p->def.origin[axis]) / p->def.spacing <= MAX_INDEX))
    return mpsi_fail(p->context, function, MPS_ERROR_ARGUMENT,
                     "%s has %c = %g m, more than 2^40 spacings of %g m from the origin at %g m",
                     what, "xyz"[axis], x, p -> def.spacing, p->def.origin[axis]);
  return MPS_OK;
}

/* Particles at the sites of `slab` (NULL: all), with ids from `id` on, from index n on. */
static void put_sites(mps_particles *p, const mpsi_site_runs *fresh, mpsi_slab *slab, int64_t id,
                      int64_t n) {
  int64_t *number = p->fields[MPSI_FIELD_ID]->data;
  double *x[3] = {0};
  for (int32_t c = 0; c < p->def.dim; c++)
    x[c] = mpsi_field_column(p->fields[MPSI_FIELD_POSITION], c);
  for (int64_t m = 0; m < fresh->count; m++) {
    const mpsi_site_run run = fresh->item[m];
    int64_t begin = run.begin, end = run.end;
    if (slab) mpsi_slab_next(slab, &run, &begin, &end);
    for (int64_t i = begin; i < end; i++, n++) {
      number[n] = id + i - run.begin;
      x[0][n] = centre(p, 0, i);
      x[1][n] = centre(p, 1, run.j);
      if (p->def.dim == 3) x[2][n] = centre(p, 2, run.k);
    }
    id += run.end - run.begin;
  }
}

/* Largest distance of a bound from the nearest face of a site, in spacings. */
static double off_lattice(const mps_particles *p, int32_t axis, double x) {
  const double at = (x - p->def.origin[axis]) / p->def.spacing;
  const double rounded = ROUND_OFF * ((fabs(x) + fabs(p->def.origin[axis])) / p->def.spacing);
  return fmax(fabs(at - nearbyint(at)) - rounded, 0.0);
}

/* The calling fill: its function, and the arguments of the shape; what chooses its sites. */
typedef struct filler {
  const char *function, *shape;
  mps_particles_predicate_fn inside; /* NULL: all */
  void *user;
} filler;

/* Adds the particles of `count` free sites, or this rank's part of them. */
static mps_status put_fresh(mps_particles *p, filler by, mps_status status,
                            const mpsi_site_runs *fresh, int64_t count) {
  const char *function = by.function;
  const int64_t first = p->count, id = p->next_id;
  const bool deals = mpsi_particles_deals(p);
  mpsi_slab slab = {.count = count};
  if (deals) {
    if (status == MPS_OK && !mpsi_slab_cut(p, fresh, &slab))
      status = mpsi_fail(p->context, function, MPS_ERROR_MEMORY,
                         "could not allocate the numbers of sites in each column of the lattice");
    const size_t bytes = (size_t)fresh->count * sizeof *fresh->item;
    status = mpsi_deal_agree(p, function, status, count, mpsi_hash(MPSI_HASH, fresh->item, bytes));
    if (status != MPS_OK) return status;
  }
  if (status == MPS_OK) status = mpsi_particles_extend_part(p, function, count, slab.count);
  if (status == MPS_OK) {
    put_sites(p, fresh, deals ? &slab : NULL, id, first);
    mpsi_particles_number(p, first);
  }
  return mpsi_particles_arrive(p, function, by.shape, status, first);
}

/* Adds particles at the free sites of `runs`, and frees the runs in any case. `status`: that of the
 * runs; `complete` false: out of memory for them. */
static mps_status put_runs(mps_particles *p, filler by, mps_status status, mpsi_site_runs *runs,
                           bool complete, int64_t *added) {
  mps_context *context = p->context;
  mpsi_site_runs fresh = {0}, sites = {0};
  if (status == MPS_OK && !(complete && runs_subtract(context, runs, &p->sites, &fresh) &&
                            runs_unite(context, &p->sites, &fresh, &sites)))
    status = mpsi_fail(context, by.function, MPS_ERROR_MEMORY,
                       "could not allocate the list of lattice sites");
  const int64_t count = (int64_t)runs_sites(&fresh);
  status = put_fresh(p, by, status, &fresh, count);
  if (status == MPS_OK) {
    const mpsi_site_runs former = p->sites;
    p->sites = sites;
    sites = former;
    if (added) *added = count;
  }
  MPSI_FREE(context, runs->item, fresh.item, sites.item);
  return status;
}

/* ---- box, predicate, ball -------------------------------------------------------------------- */

/* Sites begin[c] <= index < end[c] of each axis; one row of k in 2D. */
typedef struct site_box {
  int64_t begin[3], end[3];
} site_box;

static mps_status read_box(const mps_particles *p, filler by, const double *lo, const double *hi,
                           site_box *out) {
  const char *function = by.function;
  if (!lo || !hi)
    return mpsi_fail(p->context, function, MPS_ERROR_ARGUMENT, "%s is NULL", lo ? "hi" : "lo");
  *out = (site_box){.end = {1, 1, 1}};
  double sites = 1.0;
  for (int32_t c = 0; c < p->def.dim; c++) {
    MPSI_TRY(check_bound(p, function, "lo", c, lo[c]));
    MPSI_TRY(check_bound(p, function, "hi", c, hi[c]));
    if (!(lo[c] < hi[c]))
      return mpsi_fail(
          p->context, function, MPS_ERROR_ARGUMENT,
          "%s: the box in %c is [%.17g, %.17g) m, its upper bound must be above the lower "
          "one",
          by.shape, "xyz"[c], lo[c], hi[c]);
    out->begin[c] = first_site(p, c, lo[c]);
    out->end[c] = first_site(p, c, hi[c]);
    sites *= (double)(out->end[c] - out->begin[c]);
  }
  if (sites > MAX_SITES)
    return mpsi_fail(p->context, function, MPS_ERROR_ARGUMENT,
                     "%s: the box holds %.4g sites of spacing %g m, allowed are 2^31 (2.1e9)",
                     by.shape, sites, p->def.spacing);
  return MPS_OK;
}

/* A row of a box. */
static bool append_row(const mps_particles *p, const site_box *box, int64_t j, int64_t k,
                       mpsi_site_runs *out) {
  const mpsi_site_run row = {.begin = box->begin[0], .end = box->end[0], .j = j, .k = k};
  return row.begin >= row.end || append_run(p->context, out, row);
}

/* The sites of a row that the caller's predicate chooses. `*complete` is false where memory was
 * refused. */
static mps_status append_wanted(const mps_particles *p, filler by, const site_box *box, int64_t j,
                                int64_t k, mpsi_site_runs *out, bool *complete) {
  for (int64_t i = box->begin[0]; i < box->end[0] && *complete; i++) {
    const double x[3] = {centre(p, 0, i), centre(p, 1, j), centre(p, 2, k)};
    const mpsi_site_run site = {.begin = i, .end = i + 1, .j = j, .k = k};
    int32_t wanted = 0;
    mpsi_guard guard = {0};
    mpsi_guard_enter(&guard, p->context, "the predicate of the fill");
    MPSI_TRY(mpsi_guard_leave(&guard, p->context, by.function, by.inside(by.user, x, &wanted)));
    if (wanted) *complete = append_run(p->context, out, site);
  }
  return MPS_OK;
}

/* The runs of a box, restricted to sites that the predicate chooses, if there is one. */
static mps_status box_runs(const mps_particles *p, filler by, const site_box *box,
                           mpsi_site_runs *out, bool *complete) {
  mps_status status = MPS_OK;
  *complete = true;
  for (int64_t k = box->begin[2]; k < box->end[2]; k++)
    for (int64_t j = box->begin[1]; j < box->end[1] && status == MPS_OK && *complete; j++)
      if (by.inside)
        status = append_wanted(p, by, box, j, k, out, complete);
      else
        *complete = append_row(p, box, j, k, out);
  return status;
}

/* A box has whole sites: where its faces are not theirs, what is made has other faces. */
static void warn_of_faces(const mps_particles *p, filler by, const site_box *box, const double *lo,
                          const double *hi) {
  char asked[200] = "", made[200] = "";
  double most = 0.0;
  size_t a = 0, m = 0;
  for (int32_t c = 0; c < p->def.dim; c++) {
    const double D = p->def.spacing, origin = p->def.origin[c];
    most = fmax(most, fmax(off_lattice(p, c, lo[c]), off_lattice(p, c, hi[c])));
    a += (size_t)snprintf(asked + a, sizeof asked - a, "%s%c %.9g to %.9g", c ? ", " : "", "xyz"[c],
                          lo[c], hi[c]);
    m += (size_t)snprintf(made + m, sizeof made - m, "%s%c %.9g to %.9g", c ? ", " : "", "xyz"[c],
                          origin + (double)box->begin[c] * D, origin + (double)box->end[c] * D);
  }
  if (most > OFF_LATTICE)
    mpsi_log(p->context, MPS_CONTEXT_LOG_WARNING,
             "%s: the box asked for is %s m, the one made %s m: its faces lie up to %.3g spacings "
             "off those of the lattice of %g m about the origin",
             by.function, asked, made, most, p->def.spacing);
}

/* Only if `status`, of the caller's arguments, is MPS_OK. */
static mps_status fill_box(mps_particles *p, filler by, mps_status status, const double *lo,
                           const double *hi, int64_t *added) {
  const char *function = by.function;
  site_box box;
  mpsi_site_runs runs = {0};
  bool complete = true;
  MPSI_TRY(mpsi_particles_outside_callbacks(p, function));
  if (status == MPS_OK) status = mpsi_particles_check_free(p, function);
  if (status == MPS_OK) status = read_box(p, by, lo, hi, &box);
  if (status == MPS_OK) status = box_runs(p, by, &box, &runs, &complete);
  status = put_runs(p, by, status, &runs, complete, added);
  if (status == MPS_OK && !by.inside) warn_of_faces(p, by, &box, lo, hi);
  return status;
}

mps_status mps_particles_fill_box(mps_particles *particles, const double *lo, const double *hi,
                                  int64_t *added) {
  if (!particles) return mpsi_null(__func__, "particles");
  return fill_box(particles, (filler){__func__, "lo, hi", NULL, NULL}, MPS_OK, lo, hi, added);
}

mps_status mps_particles_fill_where(mps_particles *particles, const double *lo, const double *hi,
                                    mps_particles_predicate_fn inside, void *user, int64_t *added) {
  if (!particles) return mpsi_null(__func__, "particles");
  mps_status status = MPS_OK;
  if (!inside)
    status = mpsi_fail(particles->context, __func__, MPS_ERROR_ARGUMENT, "inside is NULL");
  return fill_box(particles, (filler){__func__, "lo, hi", inside, user}, status, lo, hi, added);
}

typedef struct ball {
  double centre[3], square; /* m, m2 */
  int32_t dim;
} ball;

static mps_status in_ball(void *user, const double *x, int32_t *inside) {
  const ball *b = user;
  double square = 0.0;
  for (int32_t c = 0; c < b->dim; c++) square += (x[c] - b->centre[c]) * (x[c] - b->centre[c]);
  *inside = square < b->square;
  return MPS_OK;
}

static mps_status read_ball(const mps_particles *p, const char *function, const double *centre_of,
                            double radius, ball *out) {
  if (!centre_of) return mpsi_fail(p->context, function, MPS_ERROR_ARGUMENT, "centre is NULL");
  if (!isfinite(radius) || radius <= 0.0)
    return mpsi_fail(p->context, function, MPS_ERROR_ARGUMENT,
                     "radius is %g m, must be finite and > 0", radius);
  /* A centre on the surface is out on every side alike, so that a symmetric ball stays so. */
  const double inner = radius - ON_EDGE * p->def.spacing;
  *out = (ball){.square = inner > 0.0 ? inner * inner : 0.0, .dim = p->def.dim};
  for (int32_t c = 0; c < out->dim; c++) {
    mps_status status = check_bound(p, function, "centre", c, centre_of[c]);
    for (int side = -1; side <= 1 && status == MPS_OK; side += 2)
      status = check_bound(p, function, "radius: the ball", c, centre_of[c] + side * radius);
    if (status != MPS_OK) return status;
    out->centre[c] = centre_of[c];
  }
  return MPS_OK;
}

/* A ball is made of whole sites: small ones are another size. `sites` NaN: others were there. */
static void warn_of_ball(const mps_particles *p, const ball *b, double radius, double sites) {
  const double pi = 3.14159265358979324, D = p->def.spacing;
  const double asked =
      b->dim == 3 ? 4.0 / 3.0 * pi * radius * radius * radius : pi * radius * radius;
  const double made = sites * (b->dim == 3 ? D * D * D : D * D);
  if (fabs(made - asked) > OFF_BALL * asked)
    mpsi_log(p->context, MPS_CONTEXT_LOG_WARNING,
             "mps_particles_fill_ball: the ball asked for has %.6g m%d, the one made %.6g: radius "
             "is %.3g spacings",
             asked, b->dim, made, radius / D);
}

mps_status mps_particles_fill_ball(mps_particles *particles, const double *centre_of_ball,
                                   double radius, int64_t *added) {
  if (!particles) return mpsi_null(__func__, "particles");
  ball b = {.dim = 0};
  double lo[3] = {0.0}, hi[3] = {0.0};
  const mps_status status = read_ball(particles, __func__, centre_of_ball, radius, &b);
  for (int32_t c = 0; c < b.dim; c++) {
    lo[c] = b.centre[c] - radius;
    hi[c] = b.centre[c] + radius;
  }
  int64_t made = 0;
  const filler by = {__func__, "centre, radius", in_ball, &b};
  const double before = runs_sites(&particles->sites);
  MPSI_TRY(fill_box(particles, by, status, lo, hi, &made));
  if (added) *added = made;
  warn_of_ball(particles, &b, radius, before == 0.0 ? (double)made : NAN);
  return MPS_OK;
}

/* ---- polygon --------------------------------------------------------------------------------- */

typedef struct polygon {
  const double *xy;
  int64_t n;
} polygon;

static const double *corner(const polygon *s, int64_t k) { return s->xy + 2 * (k % s->n); }

static mps_status check_polygon(const mps_particles *p, const char *function, const polygon *s) {
  if (p->def.dim != 2)
    return mpsi_fail(p->context, function, MPS_ERROR_ARGUMENT,
                     "particles has %d dimensions, a polygon needs 2", p->def.dim);
  if (!s->xy) return mpsi_fail(p->context, function, MPS_ERROR_ARGUMENT, "xy is NULL");
  if (s->n < 3 || s->n > MAX_CORNERS)
    return mpsi_fail(p->context, function, MPS_ERROR_ARGUMENT,
                     "vertices is %lld, allowed are 3 to %d", (long long)s->n, MAX_CORNERS);
  mps_status status = MPS_OK;
  for (int64_t k = 0; k < 2 * s->n && status == MPS_OK; k++)
    status = check_bound(p, function, "xy: a corner", k % 2, s->xy[k]);
  return status == MPS_OK ? mpsi_polygon_check(p->context, function, s->n, s->xy) : status;
}

/* Crossings of row j and the edges, as sites, ascending; returns their number, which is even. A
 * corner lies below the first row whose centre is not below it: each has one such row, so that no
 * crossing is counted twice or lost at a corner. */
static int64_t cross_row(const mps_particles *p, const polygon *s, const int64_t *row_of, int64_t j,
                         int64_t *sites) {
  int64_t count = 0;
  for (int64_t k = 0; k < s->n; k++) {
    const int64_t from = row_of[k], to = row_of[(k + 1) % s->n];
    if ((from <= j) == (to <= j)) continue;
    const double *a = corner(s, k), *b = corner(s, k + 1);
    const double t = fmin(fmax((centre(p, 1, j) - a[1]) / (b[1] - a[1]), 0.0), 1.0);
    const int64_t site = first_site(p, 0, a[0] + t * (b[0] - a[0]));
    int64_t place = count++;
    for (; place > 0 && sites[place - 1] > site; place--) sites[place] = sites[place - 1];
    sites[place] = site;
  }
  return count;
}

/* Even-odd rule along each row. `more` is set when there are more sites than allowed. */
static bool polygon_runs(const mps_particles *p, const polygon *s, const int64_t *row_of,
                         int64_t *sites, mpsi_site_runs *out, bool *more) {
  int64_t first = row_of[0], last = row_of[0];
  for (int64_t k = 1; k < s->n; k++) {
    if (row_of[k] < first) first = row_of[k];
    if (row_of[k] > last) last = row_of[k];
  }
  double total = 0.0;
  *more = (double)(last - first) > MAX_SITES;
  for (int64_t j = first; j < last && !*more; j++) {
    const int64_t crossings = cross_row(p, s, row_of, j, sites);
    for (int64_t m = 0; m + 1 < crossings; m += 2) {
      const mpsi_site_run run = {.begin = sites[m], .end = sites[m + 1], .j = j};
      total += (double)(run.end - run.begin);
      if (run.begin < run.end && !append_run(p->context, out, run)) return false;
    }
    *more = total > MAX_SITES;
  }
  return true;
}

/* The runs of a polygon. `*complete` is false where memory was refused. */
static mps_status fill_shape(const mps_particles *p, const char *function, const polygon *shape,
                             mpsi_site_runs *runs, bool *complete) {
  mps_context *context = p->context;
  int64_t *row_of = mpsi_alloc(context, shape->n, sizeof *row_of);
  int64_t *sites = mpsi_alloc(context, shape->n, sizeof *sites);
  bool more = false;
  *complete = row_of && sites;
  for (int64_t k = 0; *complete && k < shape->n; k++)
    row_of[k] = first_site(p, 1, shape->xy[2 * k + 1]);
  *complete = *complete && polygon_runs(p, shape, row_of, sites, runs, &more);
  MPSI_FREE(context, row_of, sites);
  if (!more) return MPS_OK;
  return mpsi_fail(context, function, MPS_ERROR_ARGUMENT,
                   "xy: the polygon holds more than 2^31 sites of spacing %g m", p->def.spacing);
}

/* Of edges along an axis the one farthest off the faces of the sites; oblique ones are stairs. */
static void warn_of_edges(const mps_particles *p, const polygon *s) {
  double most = 0.0, at = 0.0;
  int32_t across = 0;
  for (int64_t k = 0; k < s->n; k++)
    for (int32_t c = 0; c < 2; c++) {
      const double *a = corner(s, k), *b = corner(s, k + 1);
      if (fabs(a[c] - b[c]) > ON_EDGE * p->def.spacing) continue;
      const double off = off_lattice(p, c, a[c]);
      if (off > most) most = off, at = a[c], across = c;
    }
  if (!(most > OFF_LATTICE)) return;
  const double made = p->def.origin[across] + (double)first_site(p, across, at) * p->def.spacing;
  mpsi_log(p->context, MPS_CONTEXT_LOG_WARNING,
           "mps_particles_fill_polygon: the edge at %c = %.9g m is made at %.9g m: it lies %.3g "
           "spacings off the faces of the lattice of %g m about the origin",
           "xyz"[across], at, made, most, p -> def.spacing);
}

mps_status mps_particles_fill_polygon(mps_particles *particles, int64_t vertices, const double *xy,
                                      int64_t *added) {
  if (!particles) return mpsi_null(__func__, "particles");
  const polygon shape = {.xy = xy, .n = vertices};
  mpsi_site_runs runs = {0};
  bool complete = true;
  MPSI_TRY(mpsi_particles_outside_callbacks(particles, __func__));
  mps_status status = mpsi_particles_check_free(particles, __func__);
  if (status == MPS_OK) status = check_polygon(particles, __func__, &shape);
  if (status == MPS_OK) status = fill_shape(particles, __func__, &shape, &runs, &complete);
  status =
      put_runs(particles, (filler){__func__, "xy", NULL, NULL}, status, &runs, complete, added);
  if (status == MPS_OK) warn_of_edges(particles, &shape);
  return status;
}
