/* assemble.c - the sparse symmetric matrix of the free unknowns: lower triangle, compressed
 * columns, rows ascending.
 *
 * Row block p of K is gathered from all terms of the energy (see operator.c) that depend on p:
 * gradients of p and of its stencil neighbours, and pairs of which a site is p. Rows are
 * independent, so they are shared among threads and come out the same for every number of them.
 * Structural zeros (the offset stencils of a square lattice cancel in many places) are not stored:
 * the pattern depends on shape, supports and joints of materials, not on the moduli.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "assemble.h"
#include "implicit/base/implicit_solver.h"
#include "implicit/body/bending.h"

#include <string.h>

#define ROW_MAX 2048 /* sites that share an energy with one particle: (2 * 4 + 3)^3 and more */
#define PAIR_MAX 16  /* sites of a pair's relative displacement: 2 + 2 * 7 at most */
#define FORMS 256    /* of pairs that a worker remembers */

typedef struct block {
  int64_t site;
  uint32_t used; /* bit 3 * c + f */
  double value[3][3];
} block;

/* e_ij = sum_a c[a] u[site a] of a conservative pair. It depends on the pair's offset and on the
 * face neighbours of its ends, so that few forms occur; site a is end[a] (0: i, 1: j) or its
 * neighbour across face[a] = 2 * axis + up. */
typedef struct pair_form {
  uint32_t key; /* 0: none */
  int32_t count;
  int8_t end[PAIR_MAX], face[PAIR_MAX]; /* face -1: the end itself */
  double c[PAIR_MAX];
} pair_form;

/* One worker's sparse accumulator. */
typedef struct gather {
  int32_t *slot; /* of each site of the window, or -1 */
  int32_t count;
  int64_t particle;
  int64_t least; /* sites below it are left out: the particle, or 0 for whole rows */
  block blocks[ROW_MAX];
  const block *order[ROW_MAX]; /* of the columns: sort_blocks */
  pair_form forms[FORMS];
} gather;

typedef struct assembly {
  mps_elastic *e;
  gather *gathers; /* one a worker */
  int64_t *length; /* of each column, in the counting pass */
  bool fill;
} assembly;

typedef struct row_assembly {
  const mps_elastic *e;
  gather *gathers;
  mpsi_elastic_rows *out;
  double shift;
  bool fill;
} row_assembly;

static block *block_of(const mps_elastic *e, gather *g, int64_t site) {
  int32_t *slot = &g->slot[mpsi_elastic_slot(e, site)];
  if (*slot < 0) {
    *slot = g->count;
    block *b = &g->blocks[g->count++];
    memset(b, 0, sizeof *b);
    b->site = site;
  }
  return &g->blocks[*slot];
}

static void forget_blocks(const mps_elastic *e, gather *g) {
  for (int32_t a = 0; a < g->count; a++) g->slot[mpsi_elastic_slot(e, g->blocks[a].site)] = -1;
}

static void add(block *b, int c, int f, double value) {
  b->value[c][f] += value;
  b->used |= 1u << (3 * c + f);
}

/* ---- parts of the energy --------------------------------------------------------------------- */

/* Coupling of sites with gradient coefficients a and b in V W(G), conservative. */
static void couple_conservative(const mps_elastic *e, int64_t i, const double *a, const double *b,
                                block *out) {
  const double v = e->volume[i], lambda = v * e->lambda[i], mu = v * e->mu[i];
  double product = 0.0;
  bool any = false;
  for (int c = 0; c < e->dim; c++) {
    product += a[c] * b[c];
    any |= a[c] != 0.0 && b[c] != 0.0;
  }
  for (int c = 0; c < e->dim; c++)
    for (int f = 0; f < e->dim; f++) {
      const bool one = a[c] != 0.0 && b[f] != 0.0, two = b[c] != 0.0 && a[f] != 0.0;
      if (one || two || (c == f && any))
        add(out, c, f, lambda * a[c] * b[f] + mu * b[c] * a[f] + (c == f ? mu * product : 0.0));
    }
}

/* The same of (10) with R and D eliminated. */
static void couple_published(const mps_elastic *e, int64_t i, const double *a, const double *b,
                             block *out) {
  const double n = e->constant ? 1.0 : e->density[i] / e->density0;
  const double v = e->volume[i] * n;
  const double ra[2] = {-a[1], a[0]}, rb[2] = {-b[1], b[0]};
  for (int c = 0; c < 2; c++)
    for (int f = 0; f < 2; f++)
      if ((a[c] != 0.0 && b[f] != 0.0) || (ra[c] != 0.0 && rb[f] != 0.0))
        add(out, c, f, v * (e->lambda[i] * a[c] * b[f] - e->mu[i] * ra[c] * rb[f]));
}

/* ---- at joints of materials, where a site's components mix ---------------------------------- */

static int32_t find_site(const int64_t *sites, int32_t count, int64_t site) {
  int32_t s = 0;
  while (s < count && sites[s] != site) s++;
  return s < count ? s : -1;
}

static void gather_gradient_at_joint(const mps_elastic *e, int64_t i, gather *g) {
  const int d = e->dim;
  mpsi_wide w;
  mpsi_elastic_wide_gradient(e, i, &w);
  const int32_t mine = find_site(w.site, w.count, g->particle);
  if (mine < 0) return;
  for (int32_t s = 0; s < w.count; s++) {
    if (w.site[s] < g->least) continue;
    block *out = block_of(e, g, w.site[s]);
    for (int f = 0; f < d; f++) { /* stress of unit displacement f of the site */
      double P[9], trace = 0.0;
      for (int c = 0; c < d; c++) trace += w.c[s][c * d + c][f];
      for (int c = 0; c < d; c++)
        for (int b = 0; b < d; b++)
          P[c * d + b] = e->volume[i] * (e->mu[i] * (w.c[s][c * d + b][f] + w.c[s][b * d + c][f]) +
                                         (b == c ? e->lambda[i] * trace : 0.0));
      for (int c = 0; c < d; c++) {
        double sum = 0.0;
        for (int r = 0; r < d * d; r++) sum += w.c[mine][r][c] * P[r];
        add(out, c, f, sum);
      }
    }
  }
}

/* e_ij = sum_s c[s] u[site s], coefficient matrices dim x dim. */
typedef struct wide_pair {
  int32_t count;
  int64_t site[2 * MPSI_WIDE_MAX];
  double c[2 * MPSI_WIDE_MAX][3][3];
} wide_pair;

static void add_end(const mps_elastic *e, int64_t i, int32_t k, double sign, wide_pair *q) {
  const int d = e->dim;
  mpsi_wide w;
  mpsi_elastic_wide_gradient(e, i, &w);
  for (int32_t s = 0; s < w.count; s++) {
    int32_t at = find_site(q->site, q->count, w.site[s]);
    if (at < 0) {
      at = q->count++;
      q->site[at] = w.site[s];
      memset(q->c[at], 0, sizeof q->c[at]);
    }
    for (int c = 0; c < d; c++) {
      if (w.site[s] == i) q->c[at][c][c] += sign;
      for (int b = 0; b < d; b++)
        for (int f = 0; f < d; f++)
          q->c[at][c][f] -= 0.5 * e->spacing * e->links.step[k][b] * w.c[s][c * d + b][f];
    }
  }
}

static void gather_pair_at_joint(const mps_elastic *e, int64_t i, int64_t j, int32_t k, gather *g) {
  const int d = e->dim;
  const double stiffness = mpsi_elastic_bond(e, i, j, k);
  wide_pair q = {.count = 0};
  add_end(e, i, k, -1.0, &q);
  add_end(e, j, k, 1.0, &q);
  const int32_t mine = find_site(q.site, q.count, g->particle);
  for (int32_t s = 0; mine >= 0 && s < q.count; s++) {
    if (q.site[s] < g->least) continue;
    block *out = block_of(e, g, q.site[s]);
    for (int c = 0; c < d; c++)
      for (int f = 0; f < d; f++) {
        double sum = 0.0;
        for (int b = 0; b < d; b++) sum += q.c[mine][b][c] * q.c[s][b][f];
        add(out, c, f, stiffness * sum);
      }
  }
}

/* ---- gradients ------------------------------------------------------------------------------- */

/* Only sites from `least` on are gathered: K is symmetric. */
static void gather_gradient(const mps_elastic *e, int64_t i, gather *g) {
  if (mpsi_elastic_at_joint(e, i)) {
    gather_gradient_at_joint(e, i, g);
    return;
  }
  int64_t sites[MPSI_STENCIL_MAX];
  double coefficient[MPSI_STENCIL_MAX][3];
  const int32_t m = mpsi_elastic_stencil(e, i, sites, coefficient);
  int32_t mine = 0;
  while (sites[mine] != g->particle) mine++;
  for (int32_t b = 0; b < m; b++) {
    if (sites[b] < g->least) continue;
    block *out = block_of(e, g, sites[b]);
    if (e->conservative)
      couple_conservative(e, i, coefficient[mine], coefficient[b], out);
    else
      couple_published(e, i, coefficient[mine], coefficient[b], out);
  }
}

/* ---- conservative pairs ---------------------------------------------------------------------- */

/* A form under construction, with the offset of each site from i. */
typedef struct form_sites {
  pair_form *form;
  int32_t offset[PAIR_MAX][3];
} form_sites;

static void add_site(form_sites *s, const int32_t *from, int end, int face, double c) {
  pair_form *f = s->form;
  int32_t offset[3] = {from[0], from[1], from[2]};
  if (face >= 0) offset[face / 2] += face % 2 ? 1 : -1;
  for (int32_t a = 0; a < f->count; a++)
    if (memcmp(s->offset[a], offset, sizeof offset) == 0) {
      f->c[a] += c;
      return;
    }
  memcpy(s->offset[f->count], offset, sizeof offset);
  f->end[f->count] = (int8_t)end;
  f->face[f->count] = (int8_t)face;
  f->c[f->count++] = c;
}

/* -1/2 G (x_j - x_i) of one end, whose face neighbours are `faces`. */
static void add_gradient(form_sites *s, const int32_t *step, const int32_t *from, int end,
                         uint32_t faces, int dim) {
  for (int axis = 0; axis < dim; axis++) {
    const bool down = faces >> 2 * axis & 1, up = faces >> 2 * axis & 2;
    const double c = 0.5 * (down && up ? 0.5 : 1.0) * step[axis];
    if (step[axis] == 0) continue;
    if (up) add_site(s, from, end, 2 * axis + 1, -c);
    if (down) add_site(s, from, end, 2 * axis, c);
    if (up != down) add_site(s, from, end, -1, up ? c : -c);
  }
}

static const pair_form *form_of(const mps_elastic *e, gather *g, int64_t i, int64_t j, int32_t k) {
  static const int32_t origin[3] = {0, 0, 0};
  const uint32_t key = ((uint32_t)k << 12 | (uint32_t)e->faces[i] << 6 | e->faces[j]) + 1;
  pair_form *f = &g->forms[key * 2654435761u >> 24];
  if (f->key == key) return f;
  form_sites s = {.form = f};
  f->key = key;
  f->count = 0;
  add_site(&s, origin, 0, -1, -1.0);
  add_site(&s, e->links.step[k], 1, -1, 1.0);
  add_gradient(&s, e->links.step[k], origin, 0, e->faces[i], e->dim);
  add_gradient(&s, e->links.step[k], e->links.step[k], 1, e->faces[j], e->dim);
  return f;
}

static void gather_pair(const mps_elastic *e, int64_t i, int64_t j, int32_t k, gather *g) {
  if (mpsi_elastic_at_joint(e, i) || mpsi_elastic_at_joint(e, j)) {
    gather_pair_at_joint(e, i, j, k, g);
    return;
  }
  const pair_form *f = form_of(e, g, i, j, k);
  const mpsi_links *l = &e->links;
  int64_t sites[PAIR_MAX];
  int32_t mine = -1;
  for (int32_t a = 0; a < f->count; a++) {
    const int64_t end = f->end[a] ? j : i;
    sites[a] = f->face[a] < 0
                   ? end
                   : mpsi_elastic_neighbours(e, end)[l->face[f->face[a] / 2][f->face[a] % 2]];
    if (sites[a] == g->particle) mine = a;
  }
  if (mine < 0 || f->c[mine] == 0.0) return;
  const double s = mpsi_elastic_bond(e, i, j, k) * f->c[mine];
  for (int32_t b = 0; b < f->count; b++) {
    if (f->c[b] == 0.0 || sites[b] < g->least) continue;
    block *out = block_of(e, g, sites[b]);
    for (int x = 0; x < e->dim; x++) add(out, x, x, s * f->c[b]);
  }
}

/* ---- one row block --------------------------------------------------------------------------- */

/* Particles whose gradients use p: p itself, then its stencil neighbours, then those across a joint
 * whose face value takes a tangential derivative from a face neighbour of p. */
static int32_t users(const mps_elastic *e, int64_t p, int64_t *list) {
  double unused[MPSI_STENCIL_MAX][3];
  const int32_t near = mpsi_elastic_stencil(e, p, list, unused);
  const mpsi_links *l = &e->links;
  const int d = e->dim;
  int32_t count = near;
  if (!e->joint_at) return count;
  for (int side = 0; side < 2 * d; side++) {
    const int64_t q = mpsi_elastic_neighbours(e, p)[l->face[side / 2][side % 2]];
    if (q < 0) continue;
    for (int face = 0; face < 2 * d; face++) {
      if (face / 2 == side / 2 || e->joint_at[mpsi_elastic_slot(e, q) * 2 * d + face] < 0) continue;
      const int64_t i = mpsi_elastic_neighbours(e, q)[l->face[face / 2][face % 2]];
      if (find_site(list, count, i) < 0) list[count++] = i;
    }
  }
  return count;
}

static void gather_conservative(const mps_elastic *e, const int64_t *list, int32_t count,
                                gather *g) {
  const mpsi_links *l = &e->links;
  for (int32_t a = 0; a < count; a++) {
    const int64_t i = list[a], *to = mpsi_elastic_neighbours(e, i);
    for (int32_t k = 0; k < l->count; k++) {
      const int64_t j = to[k];
      if (j < 0) continue;
      bool twice = false; /* both ends are in the list: taken once, from the smaller */
      for (int32_t b = 0; b < count && !twice; b++) twice = list[b] == j;
      if (!twice || i < j) gather_pair(e, i, j, k, g);
    }
  }
}

static void gather_bending(const mps_elastic *e, int64_t p, gather *g) {
  mpsi_bending_term term[MPSI_BENDING_MAX];
  const int32_t count = mpsi_elastic_bending_row(e, p, term);
  for (int32_t k = 0; k < count; k++)
    for (int c = 0; c < e->dim && term[k].site >= g->least; c++)
      add(block_of(e, g, term[k].site), c, c, term[k].value[c]);
}

static void gather_row(const mps_elastic *e, int64_t p, bool whole, gather *g) {
  const mpsi_links *l = &e->links;
  int64_t list[MPSI_STENCIL_MAX];
  const int32_t count = users(e, p, list);
  g->count = 0;
  g->particle = p;
  g->least = whole ? 0 : p;
  for (int32_t a = 0; a < count; a++) gather_gradient(e, list[a], g);
  if (e->conservative) {
    gather_conservative(e, list, count, g);
    gather_bending(e, p, g);
    return;
  }
  for (int32_t k = 0; k < l->count; k++) {
    const int64_t j = mpsi_elastic_neighbours(e, p)[k];
    if (j < 0) continue;
    const double s = mpsi_elastic_bond(e, p, j, k);
    for (int c = 0; c < 2; c++) add(block_of(e, g, p), c, c, s);
    for (int c = 0; c < 2 && j >= g->least; c++) add(block_of(e, g, j), c, c, -s);
  }
}

/* To the local directions of both particles, where supports have rotated them. */
static void turn(const mps_elastic *e, int64_t p, block *b) {
  if (e->support_of[p] < 0 && e->support_of[b->site] < 0) return;
  double rows[3][3], cols[3][3], half[3][3];
  const int d = e->dim;
  for (int c = 0; c < d; c++) {
    mpsi_elastic_direction(e, p, c, rows[c]);
    mpsi_elastic_direction(e, b->site, c, cols[c]);
  }
  for (int r = 0; r < d; r++)
    for (int f = 0; f < d; f++) {
      half[r][f] = 0.0;
      for (int c = 0; c < d; c++) half[r][f] += rows[r][c] * b->value[c][f];
    }
  for (int r = 0; r < d; r++)
    for (int s = 0; s < d; s++) {
      b->value[r][s] = 0.0;
      b->used |= 1u << (3 * r + s);
      for (int f = 0; f < d; f++) b->value[r][s] += half[r][f] * cols[s][f];
    }
}

/* The gathered blocks in the order of columns, in local directions. */
static const block *const *sort_blocks(const mps_elastic *e, gather *g) {
  const block **order = g->order;
  for (int32_t a = 0; a < g->count; a++) {
    const int64_t column = mpsi_elastic_place(e, g->blocks[a].site);
    turn(e, g->particle, &g->blocks[a]);
    int32_t at = a;
    for (; at > 0 && mpsi_elastic_place(e, order[at - 1]->site) > column; at--)
      order[at] = order[at - 1];
    order[at] = &g->blocks[a];
  }
  return order;
}

/* Column block p. K is symmetric: row = column. */
static void emit(assembly *t, gather *g) {
  const mps_elastic *e = t->e;
  const int d = e->dim;
  const int64_t p = g->particle;
  const block *const *order = sort_blocks(e, g);
  for (int c = 0; c < d; c++) {
    const int64_t column = e->dof[p * d + c];
    if (column < 0) continue;
    int64_t at = t->fill ? e->column[column] : 0;
    for (int32_t a = 0; a < g->count; a++)
      for (int f = 0; f < d; f++) {
        const int64_t row = e->dof[order[a]->site * d + f];
        if (row < column || !(order[a]->used >> (3 * c + f) & 1)) continue;
        if (t->fill) {
          e->row[at] = row;
          e->value[at] = order[a]->value[c][f];
        }
        at++;
      }
    if (!t->fill) t->length[column] = at;
  }
}

static void assemble_chunk(void *data, int64_t chunk, int32_t worker) {
  assembly *t = data;
  gather *g = &t->gathers[worker];
  int64_t first, last;
  mpsi_elastic_chunk(t->e, chunk, &first, &last);
  for (int64_t p = first; p < last; p++) {
    gather_row(t->e, p, false, g);
    emit(t, g);
    forget_blocks(t->e, g);
  }
}

/* Whole rows of particle p. */
static void emit_rows(row_assembly *t, gather *g) {
  const mps_elastic *e = t->e;
  mpsi_elastic_rows *out = t->out;
  const int d = e->dim;
  const int64_t p = g->particle;
  const block *const *order = sort_blocks(e, g);
  for (int c = 0; c < d; c++) {
    const int64_t row = (mpsi_elastic_place(e, p) - out->from) * d + c;
    int64_t at = t->fill ? out->start[row] : 0;
    for (int32_t a = 0; a < g->count; a++)
      for (int f = 0; f < d; f++) {
        const int64_t site = order[a]->site;
        const bool diagonal = site == p && f == c;
        const bool both = e->dof[p * d + c] >= 0 && e->dof[site * d + f] >= 0;
        if (!diagonal && !(both && (order[a]->used >> (3 * c + f) & 1))) continue;
        if (t->fill) {
          out->column[at] = (int32_t)(mpsi_elastic_place(e, site) * d + f);
          out->value[at] = order[a]->value[c][f];
          if (diagonal && both && t->shift != 0.0) out->value[at] += t->shift * e->mass[p];
        }
        at++;
      }
    if (!t->fill) out->start[row + 1] = at;
  }
}

static void rows_chunk(void *data, int64_t chunk, int32_t worker) {
  row_assembly *t = data;
  gather *g = &t->gathers[worker];
  const int64_t first = t->out->from + chunk * MPSI_ELASTIC_CHUNK;
  const int64_t last =
      first + MPSI_ELASTIC_CHUNK < t->out->to ? first + MPSI_ELASTIC_CHUNK : t->out->to;
  for (int64_t k = first; k < last; k++) {
    gather_row(t->e, mpsi_elastic_in_order(t->e, k), true, g);
    emit_rows(t, g);
    forget_blocks(t->e, g);
  }
}

/* ---- the matrix ------------------------------------------------------------------------------ */

static void drop_matrix(mps_elastic *e) {
  MPSI_FREE(e->context, e->column, e->row, e->value, e->rhs, e->solution, e->cg_work);
  e->cg_work = NULL;
  e->column = e->row = NULL;
  e->value = e->rhs = e->solution = NULL;
  e->pattern_valid = e->values_valid = e->analysed = e->factored = false;
}

mps_status mpsi_elastic_make_vectors(mps_elastic *e, const char *function) {
  drop_matrix(e);
  mpsi_elastic_number(e);
  if ((e->rhs = mpsi_alloc(e->context, e->unknowns, sizeof *e->rhs)) &&
      (e->solution = mpsi_alloc(e->context, e->unknowns, sizeof *e->solution)))
    return MPS_OK;
  return mpsi_fail_memory(e->context, function, (size_t)e->unknowns * sizeof *e->rhs);
}

/* Counts the entries of each column and allocates the matrix. */
static mps_status make_pattern(mps_elastic *e, const char *function, assembly *t) {
  MPSI_TRY(mpsi_elastic_make_vectors(e, function));
  const int64_t n = e->unknowns;
  if (!(e->column = mpsi_alloc(e->context, n + 1, sizeof *e->column)))
    return mpsi_fail_memory(e->context, function, (size_t)n * sizeof *e->column);
  t->length = e->column + 1;
  t->fill = false;
  mpsi_parallel_for(e->context, mpsi_elastic_chunks(e), assemble_chunk, t);
  for (int64_t c = 0; c < n; c++) e->column[c + 1] += e->column[c];
  const int64_t nonzeros = e->column[n];
  if (!(e->row = mpsi_alloc(e->context, nonzeros, sizeof *e->row)) ||
      !(e->value = mpsi_alloc(e->context, nonzeros, sizeof *e->value)))
    return mpsi_fail_memory(e->context, function, (size_t)nonzeros * sizeof *e->value);
  return MPS_OK;
}

/* Accumulators of all workers, with *slots. */
static mps_status make_gathers(mps_elastic *e, const char *function, gather **gathers,
                               int32_t **slots) {
  const int32_t workers = mps_context_threads(e->context);
  const int64_t sites = mpsi_elastic_slots(e);
  if (!(*gathers = mpsi_alloc(e->context, workers, sizeof **gathers)) ||
      !(*slots = mpsi_alloc(e->context, workers * sites, sizeof **slots)))
    return mpsi_fail_memory(e->context, function, (size_t)(workers * sites) * sizeof **slots);
  for (int64_t k = 0; k < workers * sites; k++) (*slots)[k] = -1;
  for (int32_t w = 0; w < workers; w++) (*gathers)[w].slot = *slots + w * sites;
  return MPS_OK;
}

mps_status mpsi_elastic_assemble(mps_elastic *e, const char *function) {
  if (e->pattern_valid && e->values_valid) return MPS_OK;
  assembly t = {.e = e, .fill = true};
  int32_t *slots = NULL;
  mps_status status = make_gathers(e, function, &t.gathers, &slots);
  if (status == MPS_OK && !e->pattern_valid) status = make_pattern(e, function, &t);
  if (status == MPS_OK) {
    t.fill = true;
    mpsi_parallel_for(e->context, mpsi_elastic_chunks(e), assemble_chunk, &t);
    e->pattern_valid = e->values_valid = true;
    e->factored = false;
  }
  MPSI_FREE(e->context, t.gathers, slots);
  return status;
}

mps_status mpsi_elastic_assemble_rows(mps_elastic *e, const char *function, double shift,
                                      mpsi_elastic_rows *out) {
  row_assembly t = {.e = e, .out = out, .shift = shift};
  int32_t *slots = NULL;
  const int64_t rows = (out->to - out->from) * e->dim;
  const int64_t chunks = (out->to - out->from + MPSI_ELASTIC_CHUNK - 1) / MPSI_ELASTIC_CHUNK;
  mps_status status = MPS_OK;
  if (e->n * e->dim > INT32_MAX)
    return mpsi_fail(e->context, function, MPS_ERROR_UNSUPPORTED,
                     "%lld rows are too many for a linear solver of the caller",
                     (long long)(e->n * e->dim));
  if (!(out->start = mpsi_alloc(e->context, rows + 1, sizeof *out->start)))
    return mpsi_fail_memory(e->context, function, (size_t)rows * sizeof *out->start);
  status = make_gathers(e, function, &t.gathers, &slots);
  if (status == MPS_OK) {
    mpsi_parallel_for(e->context, chunks, rows_chunk, &t);
    for (int64_t r = 0; r < rows; r++) out->start[r + 1] += out->start[r];
    const int64_t count = out->start[rows];
    if (!(out->column = mpsi_alloc(e->context, count, sizeof *out->column)) ||
        !(out->value = mpsi_alloc(e->context, count, sizeof *out->value)))
      status = mpsi_fail_memory(e->context, function, (size_t)count * sizeof *out->value);
  }
  if (status == MPS_OK) {
    t.fill = true;
    mpsi_parallel_for(e->context, chunks, rows_chunk, &t);
  }
  MPSI_FREE(e->context, t.gathers, slots);
  return status;
}
