/* cut_scatter.c - particles to nodes where bodies or sides of the domain cut the support: momentum,
 * force and excess mass by the least-squares fit, each particle in a lane of a vector, and penalty
 * contact. The variants for comparison (standard MPM, momentum by weights) go particle by particle,
 * by the shape functions. Compiled once for each instruction set.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "cut_contact.h"
#include "spin.h"

#include "mpm/water/water.h"

/* ---- contributions of the particles ---------------------------------------------------------- */

/* Forces of a batch as factors of w_i: internal force - V sigma . grad phi, where grad phi along
 * axis d is w q[1 + d], and body forces by phi = w q[0]. */
MPSI_INLINE void find_force(const mpsi_transfer *work, int dim, const mpsi_cut *b,
                            mpsi_source *out) {
  static const int symmetric[3][3] = {{0, 3, 4}, {3, 1, 5}, {4, 5, 2}};
  const mpsi_columns *from = work->p;
  const int64_t p = b->first;
  const int n = b->lanes;
  const mpsi_mask there = (mpsi_mask){0, 1, 2, 3} < n;
  const mpsi_quad V = (mpsi_quad)((mpsi_mask)mpsi_get_some(from->V + p, n) & there);
  const double viscosity = work->water ? work->water->viscosity : 0.0;
  mpsi_quad u = from->slow ? mpsi_get_some(from->slow + p, n) : (mpsi_quad){0.0};
  for (int c = 0; from->slow && c < dim; c++)
    u -= viscosity * mpsi_get_some(from->L[(dim + 1) * c] + p, n);
  if (from->slow && work->grid->geometry == MPS_MPM_GEOMETRY_AXISYMMETRIC)
    u -= viscosity * mpsi_get_some(from->L[4] + p, n);
  for (int a = 0; a < dim; a++) {
    mpsi_quad body = out->m * work->def->gravity[a];
    if (from->f[a]) body += (mpsi_quad)((mpsi_mask)mpsi_get_some(from->f[a] + p, n) & there);
    if (work->grid->geometry == MPS_MPM_GEOMETRY_AXISYMMETRIC && a == 0)
      body -= V * (mpsi_get_some(from->s[2] + p, n) - u) / mpsi_get_some(from->x[0] + p, n);
    for (int c = 0; c <= dim; c++) out->force[a][c] = body * b->q[0][c];
    for (int d = 0; d < dim; d++) {
      const mpsi_quad s = mpsi_get_some(from->s[symmetric[a][d]] + p, n);
      const mpsi_quad stress = V * (a == d ? s - u : s);
      for (int c = 0; c <= dim; c++) out->force[a][c] -= stress * b->q[1 + d][c];
    }
  }
}

/* Mass, momentum and force of a batch. Lanes without a particle have no mass and no volume. */
MPSI_INLINE void find_source(const mpsi_transfer *work, int dim, const mpsi_cut *b,
                             mpsi_source *out) {
  const mpsi_columns *from = work->p;
  const int64_t p = b->first;
  const int n = b->lanes;
  const mpsi_mask there = (mpsi_mask){0, 1, 2, 3} < n;
  out->m = (mpsi_quad)((mpsi_mask)mpsi_get_some(from->m + p, n) & there);
  const mpsi_quad mh = out->m * work->grid->cell;
  for (int a = 0; a < dim; a++) {
    out->momentum[a][0] = out->m * mpsi_get_some(from->v[a] + p, n);
    for (int d = 0; d < dim; d++) {
      out->momentum[a][1 + d] = mh * mpsi_get_some(from->L[dim * a + d] + p, n);
      out->turn[a][d] = (mpsi_quad){0.0};
    }
  }
  find_force(work, dim, b, out);
}

/* The linear functions of mpsi_source on one row of nodes along x, for each particle: values at s_x
 * = 0. */
typedef struct row_source {
  mpsi_quad phi, momentum[3], by_weight[3], force[3];
} row_source;

MPSI_INLINE void find_row(int dim, const mpsi_cut *b, const mpsi_source *s, bool turns, int j,
                          int k, row_source *out) {
  out->phi = mpsi_row_value(dim, b, b->q[0], j, k);
  for (int a = 0; a < dim; a++) {
    out->momentum[a] = mpsi_row_value(dim, b, s->momentum[a], j, k);
    out->force[a] = mpsi_row_value(dim, b, s->force[a], j, k);
    if (turns) out->by_weight[a] = mpsi_row_value(dim, b, s->by_weight[a], j, k);
  }
}

/* Adds the particles of a batch to the sums of a row, whose nodes are the lanes: `sum` is mass and
 * momentum, `force` excess mass (by weights less by phi) and force. */
MPSI_INLINE void add_row(int dim, const mpsi_cut *b, const mpsi_source *s, const row_source *row,
                         bool turns, const mpsi_quad *w, mpsi_quad *sum, mpsi_quad *force) {
  const mpsi_quad nodes = {0.0, 1.0, 2.0, 3.0};
  for (int l = 0; l < b->lanes; l++) {
    const mpsi_quad x = nodes + b->s[0][0][l];
    const mpsi_quad phi = w[l] * (row->phi[l] + b->q[0][1][l] * x);
    sum[0] += s->m[l] * phi;
    force[0] += s->m[l] * w[l];
    for (int a = 0; a < dim; a++) {
      sum[1 + a] += phi * (row->momentum[a][l] + s->momentum[a][1][l] * x);
      force[1 + a] += w[l] * (row->force[a][l] + s->force[a][1][l] * x);
      if (turns) sum[1 + a] += w[l] * (row->by_weight[a][l] + s->by_weight[a][1][l] * x);
    }
  }
  force[0] -= sum[0];
}

/* Adds a batch to the nodes: mass and momentum to the tile, force and excess mass to the tile of
 * forces. */
MPSI_INLINE void add_stencil(int dim, int spline, const mpsi_cut *b, const mpsi_source *s,
                             bool turns, const mpsi_quad *weight, mpsi_node *tile,
                             mpsi_node *forces) {
  for (int k = 0; k <= (dim == 3 ? spline : 0); k++)
    for (int j = 0; j <= spline; j++) {
      const int t = mpsi_tile_index(b->at[0], b->at[1] + j, b->at[2] + k);
      mpsi_quad w[4] = {{0.0}}, sum[4] = {{0.0}}, force[4] = {{0.0}};
      row_source row;
      find_row(dim, b, s, turns, j, k, &row);
      for (int i = 0; i <= spline; i++) w[i] = weight[16 * k + 4 * j + i];
      mpsi_transpose(w);
      add_row(dim, b, s, &row, turns, w, sum, force);
      mpsi_transpose(sum);
      mpsi_transpose(force);
      for (int i = 0; i <= spline; i++) {
        mpsi_put(tile[t + i], mpsi_get(tile[t + i]) + sum[i]);
        mpsi_put(forces[t + i], mpsi_get(forces[t + i]) + force[i]);
      }
    }
}

/* Adds a batch beside thin bodies: a node that these separate from a particle gets its contribution
 * in the second tiles, the values across. */
MPSI_INLINE void add_two_sided(const mpsi_worker *worker, int dim, int spline, const mpsi_cut *b,
                               const mpsi_source *s) {
  const bool parted = mpsi_any_lane(b->across != 0);
  mpsi_quad w[MPSI_STENCIL];
  for (int side = 0; side <= (parted ? 1 : 0); side++) {
    const int64_t flip = side == 0 ? -1 : 0;
    MPSI_FOR_NODES(dim, spline)
    w[n] = (mpsi_quad)((mpsi_mask)b->w[n] & (mpsi_has_node(b->across, n) ^ flip));
    add_stencil(dim, spline, b, s, true, w, side ? worker->across_tile : worker->tile,
                side ? worker->across_force : worker->force);
  }
}

MPSI_INLINE void scatter(const mpsi_transfer *work, int dim, int spline, bool thin,
                         const mpsi_cut *b) {
  const mpsi_worker *worker = work->worker;
  mpsi_source s;
  find_source(work, dim, b, &s);
  const mpsi_mask keeps = mpsi_conserves_spin(work->grid, b);
  const bool turns = work->run->moments && mpsi_any_lane(keeps) &&
                     mpsi_add_rotation(work->grid, dim, spline, b, keeps, &s);
  if (thin) {
    if (!turns) memset(s.by_weight, 0, sizeof s.by_weight);
    add_two_sided(worker, dim, spline, b, &s);
  } else if (turns) {
    add_stencil(dim, spline, b, &s, true, b->w, worker->tile, worker->force);
  } else {
    add_stencil(dim, spline, b, &s, false, b->w, worker->tile, worker->force);
  }
}

/* ---- variants for comparison ----------------------------------------------------------------- */

/* Contributions of one particle besides mass: momentum m (v + L dx), forces by phi and by its
 * gradient. */
typedef struct particle_source {
  mpsi_quad v, L[3];   /* 1, v; 0, h dv/ds */
  mpsi_quad body;      /* 0, force by phi */
  mpsi_quad stress[3]; /* 0, -V sigma by the derivative along each axis */
} particle_source;

static particle_source source_of(const mpsi_grid *grid, const mpsi_columns *c,
                                 const mps_mpm_def *def, int dim, double viscosity, int64_t p) {
  static const int symmetric[3][3] = {{0, 3, 4}, {3, 1, 5}, {4, 5, 2}};
  double u = c->slow ? c->slow[p] : 0.0;
  for (int a = 0; c->slow && a < dim; a++) u -= viscosity * c->L[(dim + 1) * a][p];
  if (c->slow && grid->geometry == MPS_MPM_GEOMETRY_AXISYMMETRIC) u -= viscosity * c->L[4][p];
  particle_source out = {.v = {1.0}};
  for (int a = 0; a < dim; a++) {
    out.v[1 + a] = c->v[a][p];
    out.body[1 + a] = c->m[p] * def->gravity[a];
    if (c->f[a]) out.body[1 + a] += c->f[a][p];
    for (int d = 0; d < dim; d++) {
      if (!grid->standard) out.L[d][1 + a] = grid->cell * c->L[dim * a + d][p];
      out.stress[d][1 + a] = -c->V[p] * (c->s[symmetric[a][d]][p] - (a == d ? u : 0.0));
    }
  }
  if (grid->geometry == MPS_MPM_GEOMETRY_AXISYMMETRIC)
    out.body[1] -= c->V[p] * (c->s[2][p] - u) / c->x[0][p];
  return out;
}

/* Adds one particle to the tiles by its shape functions, its momentum by these or by the
 * weights. */
MPSI_INLINE void scatter_one(const mpsi_transfer *work, int dim, int spline,
                             const mpsi_single *one) {
  const mpsi_worker *worker = work->worker;
  const mpsi_shape_values *f = &one->f;
  const mpsi_cut *b = one->batch;
  const int lane = one->lane;
  const double m = work->p->m[one->particle];
  const double viscosity = work->water ? work->water->viscosity : 0.0;
  const particle_source s =
      source_of(work->grid, work->p, work->def, dim, viscosity, one->particle);
  MPSI_FOR_NODES(dim, spline) {
    const double w = f->w[n], phi = f->phi[n];
    if (w == 0.0) continue;
    const int t = mpsi_tile_index(b->at[0] + i, b->at[1] + j, b->at[2] + k);
    mpsi_quad v = s.v + s.L[0] * b->s[0][i][lane] + s.L[1] * b->s[1][j][lane];
    mpsi_quad force =
        s.body * phi + s.stress[0] * f->gradient[0][n] + s.stress[1] * f->gradient[1][n];
    if (dim == 3) {
      v += s.L[2] * b->s[2][k][lane];
      force += s.stress[2] * f->gradient[2][n];
    }
    mpsi_quad sum = v * (m * (work->grid->by_weight ? w : phi));
    sum[MPSI_MASS] = m * phi;
    force[MPSI_EXCESS] = m * (w - phi);
    const bool across = f->across >> n & 1;
    double *to = (across ? worker->across_tile : worker->tile)[t];
    double *force_to = (across ? worker->across_force : worker->force)[t];
    mpsi_put(to, mpsi_get(to) + sum);
    mpsi_put(force_to, mpsi_get(force_to) + force);
  }
}

/* Work done particle by particle: variants for comparison, and penalty contact. */
MPSI_APART void scatter_each(const mpsi_transfer *work, int dim, int spline, bool variant,
                             const mpsi_cut *b) {
  const int32_t pairs = b->held & MPSI_PENALTY ? work->cells->pairs : 0;
  mpsi_support at;
  mpsi_make_support(work->grid, work->cells, dim, b->at, &at);
  for (int lane = 0; lane < b->lanes; lane++) {
    mpsi_single one;
    mpsi_take_single(work->grid, dim, spline, b, &at, lane, &one);
    if (variant) scatter_one(work, dim, spline, &one);
    for (int32_t q = 0; q < pairs; q++)
      if (mpsi_sees_body(work, dim, spline, &one, q))
        mpsi_scatter_contact(work, dim, spline, &one, q);
  }
}

/* ---- full supports --------------------------------------------------------------------------- */

/* Stores the fit of a full support, M^-1 = diag(1, 1/m2, ...), for particles p, p + 1, ...: see
 * shape.h. */
MPSI_INLINE void store_full_fits(const mpsi_grid *grid, const mpsi_cell_block *cells, int dim,
                                 int spline, int64_t p, int particles) {
  const int64_t slot = cells->first_fit + (p - cells->begin);
  mpsi_kept_fit fit = {.q = {1.0}};
  int count = 0;
  for (int r = 0; r <= dim; r++)
    for (int c = r; c <= dim; c++, count++)
      if (r == c && r > 0) fit.q[count] = mpsi_inverse_moment(spline);
  MPSI_FOR_NODES(dim, spline) fit.active |= UINT64_C(1) << n;
  for (int l = 0; l < particles; l++) {
    grid->fit[slot + l] = fit;
    grid->fitted[slot + l] = MPSI_FITTED_FULL;
  }
}

/* Whether the supports of a segment are full although all its particles see nodes in bodies; stores
 * the fits if so. */
MPSI_INLINE bool find_full(const mpsi_transfer *work, int dim, int spline,
                           const mpsi_segment *segment, mpsi_cut *b) {
  const mpsi_places *places = segment->places;
  const int begin = segment->begin, end = segment->end;
  if (!mpsi_may_be_full(work->worker, dim, spline, places->first[begin])) return false;
  for (int k = begin; k < end; k += 4) {
    mpsi_place_cut(work->worker, dim, spline, segment, k, MPSI_IMPULSE, b);
    if (mpsi_any_lane(~b->beside) || !mpsi_is_full(work, dim, spline, b)) return false;
  }
  store_full_fits(work->grid, work->cells, dim, spline, places->chunk + begin, end - begin);
  return true;
}

/* ---- segments -------------------------------------------------------------------------------- */

MPSI_INLINE void scatter_cut(const mpsi_transfer *work, int dim, int spline, bool thin,
                             mpsi_cut *b) {
  const bool variant = work->grid->standard || work->grid->by_weight;
  if (!work->grid->standard) mpsi_make_fit(work, dim, spline, thin, b);
  for (int l = 0; l < b->lanes && thin; l++) /* for the gather */
    work->contact->across[b->first + l] =
        (mpsi_parted){(uint64_t)b->across[l], (uint64_t)b->parted[l]};
  if (!variant) scatter(work, dim, spline, thin, b);
  if (variant || b->held & MPSI_PENALTY) scatter_each(work, dim, spline, variant, b);
}

/* Adds a segment beside thin bodies, where no support counts as full. */
MPSI_INLINE bool scatter_thin(const mpsi_transfer *work, int dim, int spline, uint32_t held,
                              const mpsi_segment *segment, mpsi_cut *b) {
  for (int k = segment->begin; k < segment->end; k += 4) {
    mpsi_place_cut(work->worker, dim, spline, segment, k, held, b);
    scatter_cut(work, dim, spline, true, b);
  }
  return true;
}

/* Adds a segment beside bodies or sides of the domain; false if its supports are full (loops.h). */
MPSI_INLINE bool scatter_body(const mpsi_transfer *work, int dim, int spline, uint32_t held,
                              const mpsi_segment *segment, mpsi_cut *b) {
  if (held == MPSI_IMPULSE && work->cells->first_fit >= 0 && !work->grid->by_weight &&
      !work->grid->standard && find_full(work, dim, spline, segment, b))
    return false;
  for (int k = segment->begin; k < segment->end; k += 4) {
    mpsi_place_cut(work->worker, dim, spline, segment, k, held, b);
    scatter_cut(work, dim, spline, false, b);
  }
  return true;
}

#define DEFINE(body, dim, spline)                                                                  \
  MPSI_APART bool body##_##dim##_##spline(const mpsi_transfer *work, uint32_t held,                \
                                          const mpsi_segment *segment) {                           \
    mpsi_cut b;                                                                                    \
    return body(work, dim, spline, held, segment, &b);                                             \
  }
MPSI_INSTANCES(DEFINE, scatter_thin)
MPSI_INSTANCES(DEFINE, scatter_body)

bool MPSI_LEVELLED(mpsi_mpm_scatter_cut)(const mpsi_transfer *work, const mpsi_segment *segment) {
  const int32_t first = segment->places->first[segment->begin];
  const uint32_t held =
      mpsi_support_state(work->worker, work->grid->dim, work->grid->spline, first) & MPSI_HELD;
  return work->cells->thin ? MPSI_CHOOSE_INSTANCE(scatter_thin, held, segment)
                           : MPSI_CHOOSE_INSTANCE(scatter_body, held, segment);
}
