/* rigid.c - rigid motions without support. For each connected part of the body the rows normal . u
 * of its supports are written in its rigid motions (translations, and rotations about its centre
 * scaled by its size); the null space of these rows is named.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "rigid.h"
#include "implicit/base/implicit_solver.h"

#include <lapacke.h>

#include <stdio.h>
#include <string.h>

#define FREE 1e-10 /* smallest eigenvalue, relative to the largest, of a supported motion */

typedef struct part {
  double centre[3], size;
  int64_t count, example; /* particles; one of them */
  double gram[36];        /* sum of row row^T, modes * modes */
} part;

/* Velocity at x of rigid motion `mode` of the part: translations first. */
static void motion(const mps_elastic *e, const part *p, int32_t mode, const double *x, double *v) {
  double r[3] = {0.0, 0.0, 0.0};
  v[0] = v[1] = v[2] = 0.0;
  if (mode < e->dim) {
    v[mode] = 1.0;
    return;
  }
  for (int c = 0; c < e->dim; c++) r[c] = (x[c] - p->centre[c]) / p->size;
  const int about = e->dim == 2 ? 2 : mode - 3;
  v[(about + 1) % 3] = -r[(about + 2) % 3];
  v[(about + 2) % 3] = r[(about + 1) % 3];
}

/* Neighbour k of particle i, or -1: across faces where a window has not all neighbours, which
 * connects the same particles (reachable, lattice.c). */
static int64_t neighbour(const mps_elastic *e, const mpsi_sites *sites, int64_t i, int32_t k) {
  return sites ? mpsi_elastic_beside(sites, i, k / 2, k % 2) : mpsi_elastic_neighbours(e, i)[k];
}

/* Labels connected parts in part_of; the number of parts. */
static int64_t label(const mps_elastic *e, const mpsi_sites *sites, int64_t *part_of,
                     int64_t *stack) {
  const int32_t around = sites ? 2 * e->dim : e->links.count;
  int64_t parts = 0;
  for (int64_t i = 0; i < e->n; i++) part_of[i] = -1;
  for (int64_t seed = 0; seed < e->n; seed++) {
    if (part_of[seed] >= 0) continue;
    int64_t top = 0;
    stack[top++] = seed;
    part_of[seed] = parts;
    while (top > 0) {
      const int64_t i = stack[--top];
      for (int32_t k = 0; k < around; k++) {
        const int64_t j = neighbour(e, sites, i, k);
        if (j < 0 || part_of[j] >= 0) continue;
        part_of[j] = parts;
        stack[top++] = j;
      }
    }
    parts++;
  }
  return parts;
}

static void measure(const mps_elastic *e, const int64_t *part_of, int64_t parts, part *p) {
  const int d = e->dim;
  for (int64_t i = 0; i < e->n; i++) {
    part *mine = &p[part_of[i]];
    if (mine->count++ == 0) mine->example = i;
    for (int c = 0; c < d; c++) mine->centre[c] += e->x[i * d + c];
  }
  for (int64_t k = 0; k < parts; k++)
    for (int c = 0; c < d; c++) p[k].centre[c] /= (double)p[k].count;
  for (int64_t i = 0; i < e->n; i++) {
    part *mine = &p[part_of[i]];
    for (int c = 0; c < d; c++)
      mine->size = fmax(mine->size, fabs(e->x[i * d + c] - mine->centre[c]));
  }
  for (int64_t s = 0; s < e->support_count; s++) {
    const mpsi_support *support = &e->supports[s];
    part *mine = &p[part_of[support->particle]];
    for (int32_t r = 0; r < support->count; r++) {
      double row[6];
      for (int32_t m = 0; m < e->modes; m++) {
        double v[3];
        motion(e, mine, m, e->x + support->particle * d, v);
        row[m] =
            v[0] * support->basis[r][0] + v[1] * support->basis[r][1] + v[2] * support->basis[r][2];
      }
      for (int32_t a = 0; a < e->modes; a++)
        for (int32_t b = 0; b < e->modes; b++) mine->gram[a * e->modes + b] += row[a] * row[b];
    }
  }
}

/* Reduces `count` null vectors so that each shows one simple motion: rotations are eliminated
 * first, so that as many as possible are pure translations along an axis. */
static void simplify(double *null, int32_t count, int32_t modes, int32_t d) {
  int32_t done = 0;
  for (int32_t step = 0; step < modes && done < count; step++) {
    const int32_t mode = step < modes - d ? d + step : step - (modes - d);
    int32_t pivot = done;
    for (int32_t r = done; r < count; r++)
      if (fabs(null[r * modes + mode]) > fabs(null[pivot * modes + mode])) pivot = r;
    if (fabs(null[pivot * modes + mode]) < 1e-6) continue;
    for (int32_t m = 0; m < modes; m++) {
      const double swap = null[pivot * modes + m];
      null[pivot * modes + m] = null[done * modes + m];
      null[done * modes + m] = swap;
    }
    const double scale = 1.0 / null[done * modes + mode];
    for (int32_t m = 0; m < modes; m++) null[done * modes + m] *= scale;
    for (int32_t r = 0; r < count; r++) {
      const double factor = r == done ? 0.0 : null[r * modes + mode];
      for (int32_t m = 0; m < modes; m++) null[r * modes + m] -= factor * null[done * modes + m];
    }
    done++;
  }
}

/* Rounding errors are no part of a direction. */
static double round_off(double v) { return fabs(v) < 1e-9 ? 0.0 : v; }

static void describe(const mps_elastic *e, const part *p, const double *null, char *text,
                     size_t size) {
  const double *t = null, *r = null + e->dim;
  const double turn = e->dim == 2 ? fabs(r[0]) : sqrt(r[0] * r[0] + r[1] * r[1] + r[2] * r[2]);
  if (turn < 1e-6) {
    int only = -1, many = 0;
    for (int c = 0; c < e->dim; c++)
      if (fabs(t[c]) > 1e-6) {
        only = c;
        many++;
      }
    if (many == 1)
      snprintf(text, size, "translation along %c", "xyz"[only]);
    else
      snprintf(text, size, "translation along (%.3g, %.3g, %.3g)", round_off(t[0]), round_off(t[1]),
               e->dim == 3 ? round_off(t[2]) : 0.0);
  } else if (e->dim == 2) {
    /* v = t + r (-y, x) / size vanishes at the centre of rotation. */
    snprintf(text, size, "rotation about (%.4g, %.4g)", p->centre[0] - t[1] / r[0] * p->size,
             p->centre[1] + t[0] / r[0] * p->size);
  } else {
    snprintf(text, size, "rotation about the direction (%.3g, %.3g, %.3g)", round_off(r[0] / turn),
             round_off(r[1] / turn), round_off(r[2] / turn));
  }
}

static mps_status check_part(const mps_elastic *e, const char *function, const part *p) {
  const int32_t m = e->modes;
  double vectors[36], values[6], null[36], work[64];
  memcpy(vectors, p->gram, sizeof vectors); /* symmetric: by columns as by rows */
  if (LAPACKE_dsyev_work(LAPACK_COL_MAJOR, 'V', 'U', m, vectors, m, values, work, 64) != 0)
    return mpsi_fail(e->context, function, MPS_ERROR_INTERNAL, "dsyev failed on a %d x %d matrix",
                     m, m);
  int32_t count = 0;
  for (int32_t a = 0; a < m; a++) /* ascending */
    if (values[a] <= FREE * values[m - 1] || values[m - 1] <= 0.0) {
      for (int32_t b = 0; b < m; b++) null[count * m + b] = vectors[a * m + b];
      count++;
    }
  if (count == 0) return MPS_OK;
  simplify(null, count, m, e->dim);
  char list[320] = "", one[96];
  for (int32_t a = 0; a < count; a++) {
    describe(e, p, null + a * m, one, sizeof one);
    const size_t used = strlen(list);
    snprintf(list + used, sizeof list - used, "%s%s", a ? "; " : "", one);
  }
  const mps_status status =
      mpsi_fail(e->context, function, MPS_ERROR_STATE,
                "the supports leave %d of the %d rigid motions of the part of %lld particles with "
                "particle %lld free: %s",
                count, m, (long long)p->count, (long long)e->id[p->example], list);
  mpsi_fail_where(e->context, -1, e->id[p->example]);
  return status;
}

mps_status mpsi_elastic_check_supported(mps_elastic *e, const char *function) {
  mps_context *context = e->context;
  int64_t *part_of = mpsi_alloc(context, 2 * e->n, sizeof *part_of);
  if (!part_of) return mpsi_fail_memory(context, function, (size_t)(2 * e->n) * sizeof *part_of);
  mpsi_sites *sites = NULL;
  mps_status status = e->shared ? mpsi_elastic_open_sites(e, function, &sites) : MPS_OK;
  const int64_t parts = status == MPS_OK ? label(e, sites, part_of, part_of + e->n) : 0;
  mpsi_elastic_close_sites(e, sites);
  part *p = mpsi_alloc(context, parts, sizeof *p);
  if (status == MPS_OK && !p)
    status = mpsi_fail_memory(context, function, (size_t)parts * sizeof *p);
  if (status == MPS_OK) measure(e, part_of, parts, p);
  for (int64_t k = 0; k < parts && status == MPS_OK; k++) status = check_part(e, function, &p[k]);
  MPSI_FREE(context, p, part_of);
  return status;
}
