/* support.h - cut supports: the active nodes of particles whose stencil is cut by bodies, sides of
 * the domain or thin bodies. Particles are processed in batches of up to four that share a stencil,
 * each in a lane of a vector.
 *
 * Active for a particle are the nodes of its stencil in the domain that lie outside all bodies; the
 * corners of its own cell; and corners of other cells with particles, if they are on the
 * particle's side of the surface, n . (x_p - x_i) > 0. Without the corners of its own cell the
 * moment matrix M can be singular; without the test of the side momentum passes through thin walls.
 * SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include "mpm/base/loops.h"
#include "mpm/boundary/mirror.h"

#define MPSI_HELD (MPSI_IMPULSE | MPSI_PENALTY)

/* Up to four particles of one stencil. A lane without a particle repeats the position of lane 0,
 * with no mass. */
typedef struct mpsi_cut {
  int at[3];                /* lowest node of the stencil, in the tile */
  int lanes;                /* lanes with a particle, 1 to 4 */
  int64_t first;            /* index of the particle in lane 0 */
  uint32_t held;            /* MPSI_HELD bits of the bodies that contain any node of the stencil */
  mpsi_mask beside;         /* lanes that see such a node */
  mpsi_mask across, parted; /* bit n: of node n the values across a thin body are used; node n is
                               inactive (thin_bodies.h) */
  mpsi_quad s[3][4], along[3][4]; /* (x_i - x_p)/h along each axis; B-spline weights */
  mpsi_quad w[MPSI_STENCIL];      /* weights of the active nodes, else 0 */
  mpsi_quad q[4][4];              /* M^-1; the rows from 1 on divided by h */
} mpsi_cut;

/* Loop over the nodes n = 16 k + 4 j + i of a stencil. */
#define MPSI_FOR_NODES(dim, spline)                                                                \
  for (int k = 0; k <= ((dim) == 3 ? (spline) : 0); k++)                                           \
    for (int j = 0; j <= (spline); j++)                                                            \
      for (int i = 0, n = 16 * k + 4 * j; i <= (spline); i++, n++)

/* ---- nodes of a stencil ---------------------------------------------------------------------- */

/* Indices of a stencil's nodes in the blocks of nodes. A ghost beyond a mirror has those of its
 * image, the node as far inside (mirror.h). */
typedef struct mpsi_support {
  int corner[3][4], local[3][4]; /* block under the tile; the node's number in that block */
  bool ghost[3][4];              /* nodes beyond a mirror, by axis */
  bool folds[3][4], any_folds;   /* nodes on a mirror or beyond it */
} mpsi_support;

/* Image of tile node t along axis c in a mirror, itself where it is on the mirror; -1 inside the
 * domain. */
MPSI_INLINE int mpsi_partner_of(const mpsi_grid *grid, const mpsi_cell_block *cells, int c, int t) {
  const int64_t first = (int64_t)cells->at[c] * MPSI_SIDE;
  if (cells->mirrors >> (2 * c) & 1 && t <= grid->low[c] - first)
    return 2 * (int)(grid->low[c] - first) - t;
  if (cells->mirrors >> (2 * c + 1) & 1 && t >= grid->high[c] - first)
    return 2 * (int)(grid->high[c] - first) - t;
  return -1;
}

/* Indices of the stencil whose lowest node in the tile is `at`. */
MPSI_INLINE void mpsi_make_support(const mpsi_grid *grid, const mpsi_cell_block *cells, int dim,
                                   const int *at, mpsi_support *out) {
  out->any_folds = false;
  for (int c = 0, stride = 1; c < 3; c++, stride *= MPSI_SIDE)
    for (int i = 0; i < 4; i++) {
      const int node = at[c] + i;
      const int partner = cells->mirrors && c < dim ? mpsi_partner_of(grid, cells, c, node) : -1;
      const int t = partner >= 0 ? partner : node;
      out->ghost[c][i] = t != node;
      out->folds[c][i] = partner >= 0;
      out->any_folds = out->any_folds || partner >= 0;
      out->corner[c][i] = c < dim && t >= MPSI_SIDE ? 1 << c : 0;
      out->local[c][i] = c < dim ? (t & (MPSI_SIDE - 1)) * stride : 0;
    }
}

/* Block that contains node (i, j, k) of the stencil, and the node's number in that block. */
MPSI_INLINE int32_t mpsi_support_block(const mpsi_cell_block *cells, const mpsi_support *s, int i,
                                       int j, int k) {
  return cells->to[s->corner[0][i] | s->corner[1][j] | s->corner[2][k]];
}

MPSI_INLINE int mpsi_support_local(const mpsi_support *s, int i, int j, int k) {
  return s->local[0][i] + s->local[1][j] + s->local[2][k];
}

MPSI_INLINE bool mpsi_is_folded(const mpsi_support *s, int i, int j, int k) {
  return s->any_folds && (s->folds[0][i] || s->folds[1][j] || s->folds[2][k]);
}

/* Reflects the contact force on a folded node, or its slip, to the node's image; `impulse` times
 * the change of `vector` is added to the impulse of the walls. */
static inline void mpsi_reflect_at(const mpsi_transfer *work, const mpsi_cut *b, int i, int j,
                                   int k, double *vector, double impulse) {
  int at[3] = {b->at[0] + i, b->at[1] + j, b->at[2] + k};
  mpsi_mpm_reflect(work->grid, work->boundaries, work->mirrors, work->cells, at, vector, impulse);
}

/* Surface normal, at node `local` of a block, of the next body that contains the node, which is
 * MPSI_REACHED; NULL after the last. *pair starts as nodes->first_pair and counts the pairs of
 * block and body. */
MPSI_INLINE const double *mpsi_next_normal(const mpsi_grid *grid, const mpsi_contacts *contacts,
                                           const mpsi_node_block *nodes, int local, int32_t *pair) {
  if (nodes->near < 0) return NULL;
  while (*pair < nodes->first_pair + nodes->pairs) {
    const int64_t at = (int64_t)(*pair)++ * grid->block_nodes + local;
    if (contacts->held[at]) return contacts->normal[at];
  }
  return NULL;
}

/* ---- active nodes ---------------------------------------------------------------------------- */

/* Lanes that see a node of the stencil, by their weights along each axis. */
MPSI_INLINE mpsi_mask mpsi_sees(int dim, const mpsi_cut *b, int i, int j, int k) {
  const mpsi_mask plane = (b->along[0][i] > MPSI_SEEN) & (b->along[1][j] > MPSI_SEEN);
  return dim == 3 ? plane & (b->along[2][k] > MPSI_SEEN) : plane;
}

/* Lanes that see a node in a body. */
MPSI_INLINE mpsi_mask mpsi_find_beside(const mpsi_worker *worker, int dim, int spline,
                                       const mpsi_cut *b) {
  mpsi_mask beside = {0};
  MPSI_FOR_NODES(dim, spline) {
    const int t = mpsi_tile_index(b->at[0] + i, b->at[1] + j, b->at[2] + k);
    if (worker->state[t] & MPSI_HELD) beside |= mpsi_sees(dim, b, i, j, k);
    (void)n;
  }
  return beside;
}

/* Batch of up to four particles of a segment, from number k of the chunk on. Sets distances and
 * weights by axis, not yet the active nodes. */
MPSI_INLINE void mpsi_place_cut(const mpsi_worker *worker, int dim, int spline,
                                const mpsi_segment *segment, int k, uint32_t held, mpsi_cut *out) {
  const mpsi_places *places = segment->places;
  const int n = segment->end - k < 4 ? segment->end - k : 4;
  out->first = places->chunk + k, out->lanes = n, out->held = held;
  out->across = out->parted = (mpsi_mask){0};
  mpsi_unravel(places->first[k], MPSI_TILE_SIDE, out->at);
  for (int c = 0; c < dim; c++) {
    const mpsi_quad t = mpsi_get_some(places->t[c] + k, n);
    mpsi_lane_weights(spline, t, out->along[c]);
    for (int i = 0; i <= spline; i++) out->s[c][i] = (double)i - t;
  }
  out->beside = held ? mpsi_find_beside(worker, dim, spline, out) : (mpsi_mask){0};
}

/* Lanes for which a node, by axis, is a corner of the particle's own cell: at a side of the domain
 * of the cell inside, on a border of cells of both of them, or of `either`. */
MPSI_INLINE void mpsi_find_corners(const mpsi_grid *grid, const mpsi_cell_block *cells, int dim,
                                   int spline, bool either, const mpsi_cut *b,
                                   mpsi_mask (*corner)[4]) {
  const double reach = either ? 1.0 + MPSI_ON_BORDER : 1.0 - MPSI_ON_BORDER;
  for (int c = 0; c < dim; c++) {
    const int64_t first = (int64_t)cells->at[c] * MPSI_SIDE + b->at[c];
    const double low = (double)(grid->low[c] - first), high = (double)(grid->high[c] - first);
    mpsi_quad t = -b->s[c][0];
    for (int l = 0; l < 4; l++) {
      if (t[l] < low + MPSI_ON_BORDER) t[l] = low + 0.5;
      if (t[l] > high - MPSI_ON_BORDER) t[l] = high - 0.5;
    }
    for (int i = 0; i <= spline; i++) {
      const mpsi_quad s = (double)i - t;
      corner[c][i] = (s > -reach) & (s < reach);
    }
  }
}

/* Where particles on a border of cells have no active node beside it: makes the corners of either
 * cell theirs, and returns true. */
MPSI_INLINE bool mpsi_widen_corners(int dim, int spline, const mpsi_cut *b,
                                    mpsi_mask (*corner)[4]) {
  mpsi_mask widened = {0};
  for (int c = 0; c < dim; c++) {
    mpsi_mask alone = {-1, -1, -1, -1}, count = {0};
    for (int i = 0; i <= spline; i++) count -= corner[c][i];
    alone &= count == 1;
    if ((alone[0] | alone[1] | alone[2] | alone[3]) == 0) continue;
    MPSI_FOR_NODES(dim, spline) {
      const int at = c == 0 ? i : c == 1 ? j : k;
      alone &= corner[c][at] | (b->w[n] == 0.0) | (b->along[c][at] < MPSI_SEEN);
    }
    for (int i = 0; i <= spline; i++)
      corner[c][i] |= alone & (b->s[c][i] > -1.5) & (b->s[c][i] < 1.5);
    widened |= alone;
  }
  return (widened[0] | widened[1] | widened[2] | widened[3]) != 0;
}

/* Lanes whose particles lie on the outer side, n . (x_p - x_i) > 0, of all bodies that contain node
 * (i, j, k). A ghost has the normals of its image with the component across the mirror reversed. */
MPSI_INLINE mpsi_mask mpsi_same_side(const mpsi_grid *grid, const mpsi_contacts *contacts,
                                     const mpsi_cell_block *cells, int dim, const mpsi_cut *b,
                                     int i, int j, int k) {
  const int place[3] = {i, j, k};
  mpsi_quad s[3];
  int t[3] = {0};
  for (int c = 0; c < dim; c++) {
    const int node = b->at[c] + place[c];
    const int partner = cells->mirrors ? mpsi_partner_of(grid, cells, c, node) : -1;
    t[c] = partner >= 0 ? partner : node;
    s[c] = t[c] != node ? -b->s[c][place[c]] : b->s[c][place[c]];
  }
  const mpsi_node_block *nodes = &grid->nodes[mpsi_block_under(cells, t[0], t[1], t[2])];
  const int local = mpsi_local_under(t[0], t[1], t[2]);
  mpsi_mask same = {-1, -1, -1, -1};
  int32_t pair = nodes->first_pair;
  for (const double *n; (n = mpsi_next_normal(grid, contacts, nodes, local, &pair)) != NULL;) {
    const mpsi_quad across = n[0] * s[0] + n[1] * s[1];
    same &= (dim == 3 ? across + n[2] * s[2] : across) < 0.0;
  }
  return same;
}

/* Lanes for which node (i, j, k) is active although it lies in a body. */
MPSI_INLINE mpsi_mask mpsi_is_active(const mpsi_transfer *work, uint8_t state, int dim,
                                     const mpsi_cut *b, mpsi_mask (*corner)[4], int i, int j,
                                     int k) {
  mpsi_mask active = corner[0][i] & corner[1][j];
  if (dim == 3) active &= corner[2][k];
  if ((active[0] & active[1] & active[2] & active[3]) != 0 || !(state & MPSI_REACHED))
    return active;
  return active | mpsi_same_side(work->grid, work->contact, work->cells, dim, b, i, j, k);
}

/* Nodes that thin bodies separate from each particle: as stored by the scatter of this step
 * (`known`), or found here. Corners of the particle's own cell stay active. */
MPSI_INLINE void mpsi_find_parted(const mpsi_transfer *work, int dim, int spline, bool known,
                                  mpsi_mask (*corner)[4], mpsi_cut *b) {
  for (int l = 0; l < b->lanes; l++) {
    const int64_t p = b->first + l;
    mpsi_parted found = work->contact->across[p];
    if (!known) {
      double x[3] = {0.0};
      for (int c = 0; c < dim; c++) x[c] = work->p->x[c][p];
      found = mpsi_mpm_find_parted(work->grid, work->contact, work->cells, b->at, x);
      MPSI_FOR_NODES(dim, spline) {
        if (corner[0][i][l] & corner[1][j][l] & (dim == 3 ? corner[2][k][l] : -1))
          found.cut &= ~(UINT64_C(1) << n);
      }
    }
    b->across[l] = (int64_t)found.across;
    b->parted[l] = (int64_t)found.cut;
  }
  for (int l = b->lanes; l < 4; l++) b->across[l] = b->across[0], b->parted[l] = b->parted[0];
}

/* Lanes in whose set `bits` node n is. */
MPSI_INLINE mpsi_mask mpsi_has_node(mpsi_mask bits, int n) {
  return (bits & (int64_t)(UINT64_C(1) << n)) != 0;
}

/* Weights of the nodes that are in the domain and active, thin bodies apart; 0 at the others. */
MPSI_INLINE void mpsi_weigh_nodes(const mpsi_transfer *work, int dim, int spline,
                                  mpsi_mask (*corner)[4], mpsi_cut *b) {
  for (int k = 0; k <= (dim == 3 ? spline : 0); k++)
    for (int j = 0; j <= spline; j++) {
      const uint8_t *state =
          work->worker->state + mpsi_tile_index(b->at[0], b->at[1] + j, b->at[2] + k);
      mpsi_quad *w = b->w + 16 * k + 4 * j, across = b->along[1][j];
      if (dim == 3) across *= b->along[2][k];
      for (int i = 0; i <= spline; i++) w[i] = b->along[0][i] * across;
      uint32_t any;
      memcpy(&any, state, sizeof any);
      for (int i = 0; i <= spline && any != 0; i++) {
        if (state[i] & MPSI_OUTSIDE)
          w[i] = (mpsi_quad){0.0};
        else if (state[i] & MPSI_INSIDE)
          w[i] = (mpsi_quad)((mpsi_mask)w[i] &
                             mpsi_is_active(work, state[i], dim, b, corner, i, j, k));
      }
    }
}

/* Weights of the active nodes, 0 at the others. `thin`: nodes may be inactive because of thin
 * bodies. */
MPSI_INLINE void mpsi_find_active(const mpsi_transfer *work, int dim, int spline, bool thin,
                                  bool known, mpsi_cut *b) {
  mpsi_mask corner[3][4];
  mpsi_find_corners(work->grid, work->cells, dim, spline, true, b, corner);
  if (thin) mpsi_find_parted(work, dim, spline, known, corner, b);
  mpsi_find_corners(work->grid, work->cells, dim, spline, false, b, corner);
  mpsi_weigh_nodes(work, dim, spline, corner, b);
  if (mpsi_widen_corners(dim, spline, b, corner)) mpsi_weigh_nodes(work, dim, spline, corner, b);
  if (!thin) return;
  MPSI_FOR_NODES(dim, spline) {
    b->w[n] = (mpsi_quad)((mpsi_mask)b->w[n] & ~mpsi_has_node(b->parted, n));
  }
}

/* Whether the stencil from tile node `first` may be full for its particles: its nodes are in the
 * domain, not beside thin bodies nor in bodies with penalty contact, and those in other bodies are
 * corners of cells with particles. */
MPSI_INLINE bool mpsi_may_be_full(const mpsi_worker *worker, int dim, int spline, int32_t first) {
  const uint32_t in = spline == 3 ? 0x01010101u : 0x00010101u;
  uint32_t other = 0;
  for (int k = 0; k <= (dim == 3 ? spline : 0); k++)
    for (int j = 0; j <= spline; j++) {
      uint32_t row;
      memcpy(&row, worker->state + first + mpsi_tile_index(0, j, k), sizeof row);
      row &= in * 0xffu;
      other |= row & ~(in * (MPSI_INSIDE | MPSI_REACHED |
                             MPSI_IMPULSE)); /* outside the domain, thin, penalty */
      other |= (row / MPSI_INSIDE ^ row / MPSI_REACHED) & in;
    }
  return other == 0;
}

/* Whether all nodes of the stencil are active for all particles of the batch; mpsi_may_be_full is
 * known to be true. */
MPSI_INLINE bool mpsi_is_full(const mpsi_transfer *work, int dim, int spline, const mpsi_cut *b) {
  mpsi_mask corner[3][4];
  mpsi_find_corners(work->grid, work->cells, dim, spline, false, b, corner);
  for (int k = 0; k <= (dim == 3 ? spline : 0); k++)
    for (int j = 0; j <= spline; j++) {
      const uint8_t *state =
          work->worker->state + mpsi_tile_index(b->at[0], b->at[1] + j, b->at[2] + k);
      for (int i = 0; i <= spline; i++) {
        if (state[i] == 0) continue;
        const mpsi_mask active = mpsi_is_active(work, state[i], dim, b, corner, i, j, k);
        if ((active[0] & active[1] & active[2] & active[3]) == 0) return false;
      }
    }
  return true;
}
