/* lattice.c - from reference positions to integer lattice sites, neighbours within the radius of
 * influence, the particle number densities n_i and n0, Chikazawa (6), (7), and the plain
 * displacement gradient (operator.c) on them. SPDX-License-Identifier: BSD-3-Clause */
#include "lattice.h"
#include "implicit/base/implicit_solver.h"

#include <stdlib.h>
#include <string.h>

#define SITE_LIMIT (1 << 20) /* lattice units between any two particles, per axis */
#define OFF_LATTICE 1e-5     /* tolerated distance from a site, in spacings */

/* Open-addressing table from packed site to particle. */
typedef struct site_table {
  uint64_t *key; /* 0: empty */
  int64_t *particle;
  uint64_t mask;
} site_table;

static uint64_t pack(const int32_t *site) {
  uint64_t key = 0;
  for (int c = 0; c < 3; c++) key = key << 21 | (uint64_t)(site[c] + SITE_LIMIT);
  return key + 1;
}

static uint64_t slot_of(const site_table *t, uint64_t key) {
  uint64_t slot = (key * 0x9E3779B97F4A7C15u) >> 20 & t->mask;
  while (t->key[slot] && t->key[slot] != key) slot = (slot + 1) & t->mask;
  return slot;
}

static int64_t find(const site_table *t, const int32_t *site) {
  const uint64_t slot = slot_of(t, pack(site));
  return t->key[slot] ? t->particle[slot] : -1;
}

struct mpsi_sites {
  site_table table;
  int32_t (*site)[3]; /* of each particle */
};

/* Integer sites relative to particle 0, entered in the table. */
static mps_status read_sites(const mps_elastic *e, const char *function, int32_t (*sites)[3],
                             site_table *t) {
  for (int64_t i = 0; i < e->n; i++) {
    for (int c = 0; c < e->dim; c++) {
      const double away = (e->x[i * e->dim + c] - e->x[c]) / e->spacing, near = rint(away);
      if (!(fabs(near) < SITE_LIMIT))
        return mpsi_fail(e->context, function, MPS_ERROR_UNSUPPORTED,
                         "particle %lld lies %g spacings from particle %lld along %c, at most %d "
                         "are possible",
                         (long long)e->id[i], away, (long long)e->id[0], "xyz"[c], SITE_LIMIT - 1);
      if (fabs(away - near) > OFF_LATTICE)
        return mpsi_fail(
            e->context, function, MPS_ERROR_ARGUMENT,
            "particles: particle %lld is off the lattice: it lies %.9g spacings (%g m) from "
            "particle %lld along %c, which must be a whole number",
            (long long)e->id[i], away, e->spacing, (long long)e->id[0], "xyz"[c]);
      sites[i][c] = (int32_t)near;
    }
    const uint64_t key = pack(sites[i]), slot = slot_of(t, key);
    if (t->key[slot])
      return mpsi_fail(e->context, function, MPS_ERROR_ARGUMENT,
                       "particles %lld and %lld are on the same lattice site",
                       (long long)e->id[t->particle[slot]], (long long)e->id[i]);
    t->key[slot] = key;
    t->particle[slot] = i;
  }
  return MPS_OK;
}

/* ---- offsets --------------------------------------------------------------------------------- */

/* All offsets shorter than re in lexicographic order, so that k and count - 1 - k are opposite.
 * With l->step NULL it only counts. */
static void list_offsets(const mps_elastic *e, mpsi_links *l) {
  const double ratio = e->def.radius_ratio;
  const int m = (int)ratio, mz = e->dim == 3 ? m : 0;
  l->count = 0;
  for (int a = -m; a <= m; a++)
    for (int b = -m; b <= m; b++)
      for (int c = -mz; c <= mz; c++) {
        const int square = a * a + b * b + c * c;
        /* At r = re the weight is zero: rounding must not make it a neighbour. */
        if (square == 0 || square >= ratio * ratio * (1.0 - 1e-12)) continue;
        const int32_t k = l->count++;
        if (!l->step) continue;
        l->step[k][0] = a;
        l->step[k][1] = b;
        l->step[k][2] = c;
        l->r2[k] = square * e->spacing * e->spacing;
        l->far[k] = abs(a) > 1 || abs(b) > 1 || abs(c) > 1;
        l->weight[k] = e->def.kernel ? mps_kernel_weight(e->def.kernel, e->spacing * sqrt(square))
                                     : ratio / sqrt((double)square) - 1.0;
        for (int axis = 0; axis < e->dim; axis++)
          if (square == 1 && l->step[k][axis] != 0) l->face[axis][l->step[k][axis] > 0] = k;
      }
}

/* Is site + step reached from site through faces of existing cells, in steps towards it? Cells with
 * a common corner only, or on both sides of a slot, are not connected. */
static bool reachable(const site_table *t, const int32_t *site, const int32_t *step) {
  if (!step[0] && !step[1] && !step[2]) return true;
  for (int axis = 0; axis < 3; axis++) {
    if (!step[axis]) continue;
    int32_t next[3], rest[3];
    memcpy(next, site, sizeof next);
    memcpy(rest, step, sizeof rest);
    next[axis] += step[axis] > 0 ? 1 : -1;
    rest[axis] -= step[axis] > 0 ? 1 : -1;
    if (find(t, next) >= 0 && reachable(t, next, rest)) return true;
  }
  return false;
}

typedef struct link_task {
  mps_elastic *e;
  const mpsi_sites *sites;
} link_task;

static void link_one(void *task, int64_t i) {
  const link_task *t = task;
  mps_elastic *e = t->e;
  const mpsi_links *l = &e->links;
  const site_table *table = &t->sites->table;
  const int32_t *own = t->sites->site[i];
  const int64_t slot = mpsi_elastic_slot(e, i);
  e->faces[i] = 0;
  for (int32_t k = 0; k < l->count; k++) {
    int32_t site[3];
    for (int c = 0; c < 3; c++) site[c] = own[c] + l->step[k][c];
    int64_t j = find(table, site);
    if (j >= 0 && e->conservative && !reachable(table, own, l->step[k])) j = -1;
    l->to[slot * l->count + k] = j;
    if (j < 0) continue;
    e->density[slot] += l->weight[k];
    for (int face = 0; face < 2 * e->dim; face++)
      if (l->face[face / 2][face % 2] == k) e->faces[i] |= (uint8_t)(1 << face);
  }
}

/* Of a particle outside the window, too. */
static void find_faces(void *task, int64_t i) {
  const link_task *t = task;
  t->e->faces[i] = 0;
  for (int face = 0; face < 2 * t->e->dim; face++)
    if (mpsi_elastic_beside(t->sites, i, face / 2, face % 2) >= 0)
      t->e->faces[i] |= (uint8_t)(1 << face);
}

/* A cell without a neighbour along some axis has no strain along it. */
static mps_status check_thickness(const mps_elastic *e, const char *function) {
  for (int64_t k = e->window.from; k < e->window.to; k++) {
    const int64_t i = mpsi_elastic_in_order(e, k);
    const bool any = e->density[mpsi_elastic_slot(e, i)] > 0.0;
    for (int axis = 0; axis < e->dim; axis++) {
      if (e->faces[i] >> 2 * axis & 3) continue;
      const mps_status status =
          any ? mpsi_fail(e->context, function, MPS_ERROR_ARGUMENT,
                          "the body is one particle thick along %c at particle %lld: at least two "
                          "are needed",
                          "xyz"[axis], (long long)e -> id[i])
              : mpsi_fail(e->context, function, MPS_ERROR_ARGUMENT,
                          "particle %lld is isolated: it has no neighbour within %g spacings",
                          (long long)e->id[i], e->def.radius_ratio);
      mpsi_fail_where(e->context, -1, e->id[i]);
      return status;
    }
  }
  return MPS_OK;
}

/* The operator's arrays of the window. */
static mps_status allocate_window(mps_elastic *e, const char *function) {
  mpsi_links *l = &e->links;
  const int64_t slots = mpsi_elastic_slots(e), tensor = slots * e->dim * e->dim;
  l->step = NULL;
  list_offsets(e, l);
  if (!(l->step = mpsi_alloc(e->context, l->count, sizeof *l->step)) ||
      !(l->weight = mpsi_alloc(e->context, l->count, sizeof(double))) ||
      !(l->r2 = mpsi_alloc(e->context, l->count, sizeof(double))) ||
      !(l->far = mpsi_alloc(e->context, l->count, sizeof *l->far)) ||
      !(l->to = mpsi_alloc(e->context, slots * l->count, sizeof(int64_t))) ||
      !(e->density = mpsi_alloc(e->context, slots, sizeof *e->density)) ||
      !(e->kappa = mpsi_alloc(e->context, slots, sizeof *e->kappa)) ||
      !(e->gradient = mpsi_alloc(e->context, tensor, sizeof *e->gradient)) ||
      !(e->stress_work = mpsi_alloc(e->context, tensor, sizeof *e->stress_work)))
    return mpsi_fail_memory(e->context, function, (size_t)(slots * l->count) * sizeof(int64_t));
  list_offsets(e, l);
  e->density0 = 0.0;
  for (int32_t k = 0; k < l->count; k++) e->density0 += l->weight[k];
  return MPS_OK;
}

void mpsi_elastic_disconnect(mps_elastic *e) {
  MPSI_FREE(e->context, e->links.step, e->links.weight, e->links.r2, e->links.far, e->links.to);
  MPSI_FREE(e->context, e->density, e->kappa, e->gradient, e->stress_work, e->at, e->place);
}

void mpsi_elastic_lose_window(mps_elastic *e) {
  e->links = (mpsi_links){.count = 0};
  e->density = e->kappa = e->gradient = e->stress_work = e->bending = NULL;
  e->at = e->place = e->joint_at = NULL;
  e->joints = NULL;
  e->joint_scratch = NULL;
  e->joint_count = 0;
}

/* ---- sites of all particles ------------------------------------------------------------------ */

mps_status mpsi_elastic_open_sites(mps_elastic *e, const char *function, mpsi_sites **out) {
  mps_context *context = e->context;
  int64_t slots = 64;
  while (slots < 2 * e->n) slots *= 2;
  mpsi_sites *s = mpsi_alloc(context, 1, sizeof *s);
  mps_status status = MPS_OK;
  if (!s || !(s->table.key = mpsi_alloc(context, slots, sizeof *s->table.key)) ||
      !(s->table.particle = mpsi_alloc(context, slots, sizeof *s->table.particle)) ||
      !(s->site = mpsi_alloc(context, e->n, sizeof *s->site)))
    status = mpsi_fail_memory(context, function, (size_t)slots * sizeof *s->table.key);
  if (status == MPS_OK) {
    s->table.mask = (uint64_t)slots - 1;
    status = read_sites(e, function, s->site, &s->table);
  }
  if (status != MPS_OK) mpsi_elastic_close_sites(e, s);
  *out = status == MPS_OK ? s : NULL;
  return status;
}

void mpsi_elastic_close_sites(mps_elastic *e, mpsi_sites *s) {
  if (!s) return;
  MPSI_FREE(e->context, s->table.key, s->table.particle, s->site, s);
}

int64_t mpsi_elastic_beside(const mpsi_sites *s, int64_t i, int axis, int up) {
  int32_t site[3];
  memcpy(site, s->site[i], sizeof site);
  site[axis] += up ? 1 : -1;
  return find(&s->table, site);
}

mps_status mpsi_elastic_connect(mps_elastic *e, const char *function) {
  mpsi_sites *sites = NULL;
  mps_status status = mpsi_elastic_open_sites(e, function, &sites);
  if (status == MPS_OK) status = mpsi_elastic_open_window(e, function);
  if (status == MPS_OK) status = allocate_window(e, function);
  if (status == MPS_OK) {
    link_task task = {.e = e, .sites = sites};
    if (e->shared) mpsi_elastic_for_each(e, e->n, find_faces, &task);
    mpsi_elastic_for_span(e, e->window, link_one, &task);
    status = check_thickness(e, function);
  }
  mpsi_elastic_close_sites(e, sites);
  return status;
}

/* ---- the plain gradient ---- */

double mpsi_elastic_divisor(const mps_elastic *e, int64_t i) {
  return e->constant ? e->density0 : e->density[mpsi_elastic_slot(e, i)];
}

static void conservative_coefficient(const mps_elastic *e, int64_t i, int32_t k, double *g) {
  const mpsi_links *l = &e->links;
  for (int axis = 0; axis < e->dim; axis++) {
    g[axis] = 0.0;
    if (k != l->face[axis][0] && k != l->face[axis][1]) continue;
    const bool both = (e->faces[i] >> 2 * axis & 3) == 3;
    g[axis] = (double)l->step[k][axis] * (both ? 0.5 : 1.0) / e->spacing;
  }
}

void mpsi_elastic_coefficient(const mps_elastic *e, int64_t i, int32_t k, double *g) {
  if (e->conservative) {
    conservative_coefficient(e, i, k, g);
    return;
  }
  const mpsi_links *l = &e->links;
  const double scale = e->dim / mpsi_elastic_divisor(e, i) * l->weight[k] / l->r2[k] * e->spacing;
  for (int c = 0; c < e->dim; c++) g[c] = scale * l->step[k][c];
}

/* The conservative stencil, without a search: two face neighbours an axis. */
static int32_t conservative_stencil(const mps_elastic *e, int64_t i, int64_t *sites,
                                    double (*g)[3]) {
  const mpsi_links *l = &e->links;
  const int64_t *to = mpsi_elastic_neighbours(e, i);
  int32_t m = 1;
  for (int axis = 0; axis < e->dim; axis++) {
    const uint32_t faces = e->faces[i] >> 2 * axis & 3;
    const double c = (faces == 3 ? 0.5 : 1.0) / e->spacing;
    for (int up = 0; up < 2; up++) {
      if (!(faces >> up & 1)) continue;
      sites[m] = to[l->face[axis][up]];
      g[m][0] = g[m][1] = g[m][2] = 0.0;
      g[m++][axis] = up ? c : -c;
    }
    if (faces != 3) g[0][axis] = faces == 2 ? -c : c;
  }
  return m;
}

int32_t mpsi_elastic_stencil(const mps_elastic *e, int64_t i, int64_t *sites, double (*g)[3]) {
  const mpsi_links *l = &e->links;
  sites[0] = i;
  g[0][0] = g[0][1] = g[0][2] = 0.0;
  if (e->conservative) return conservative_stencil(e, i, sites, g);
  const int64_t *to = mpsi_elastic_neighbours(e, i);
  int32_t m = 1;
  for (int32_t k = 0; k < l->count; k++) {
    const int64_t j = to[k];
    if (j < 0) continue;
    sites[m] = j;
    g[m][2] = 0.0;
    mpsi_elastic_coefficient(e, i, k, g[m]);
    /* Opposite neighbours cancel exactly: i itself has no coefficient inside the body. */
    if (to[l->count - 1 - k] < 0)
      for (int c = 0; c < e->dim; c++) g[0][c] -= g[m][c];
    m++;
  }
  return m;
}

/* ---- loops ----------------------------------------------------------------------------------- */

typedef struct loop {
  mpsi_elastic_work work;
  void *task;
  int64_t count;
  const int64_t *list; /* indices; NULL: 0, 1 ... */
} loop;

static void loop_chunk(void *data, int64_t chunk, int32_t worker) {
  const loop *l = data;
  const int64_t end = (chunk + 1) * MPSI_ELASTIC_CHUNK;
  for (int64_t k = chunk * MPSI_ELASTIC_CHUNK; k < end && k < l->count; k++)
    l->work(l->task, l->list ? l->list[k] : k);
}

static void run(mps_elastic *e, loop *l) {
  const int64_t chunks = (l->count + MPSI_ELASTIC_CHUNK - 1) / MPSI_ELASTIC_CHUNK;
  mpsi_parallel_for(e->context, chunks, loop_chunk, l);
}

void mpsi_elastic_for_each(mps_elastic *e, int64_t count, mpsi_elastic_work work, void *task) {
  loop l = {work, task, count, NULL};
  run(e, &l);
}

void mpsi_elastic_for_span(mps_elastic *e, mpsi_span span, mpsi_elastic_work work, void *task) {
  loop l = {work, task, span.to - span.from, e->at ? e->at + span.from : NULL};
  run(e, &l);
}
