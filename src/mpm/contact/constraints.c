/* constraints.c - contact constraints of a step: particles that may reach a body in dt, their
 * weights at the foot (the nearest point of the surface), and the warm start from the impulses of
 * the last step. A particle becomes a candidate by its distance from the surface, whether or not
 * its stencil has nodes inside the body: thin bodies have contacts too.
 *
 * The impulse acts at the foot x_c through psi_i = phi_i(x_p) + grad phi_i . (x_c - x_p): sum psi_i
 * = 1 and sum psi_i x_i = x_c, so that the nodes receive its force and its moment about any point.
 *
 * Blocks of cells are listed colour by colour (blocks.h), the constraints of a block by place, then
 * by body: the order in which impulses.c sweeps, whatever the order of the particles.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "core/base/room_array.h"
#include "mpm/base/kernels.h"
#include "mpm/base/run.h"
#include "mpm/boundary/mirror.h"
#include "mpm/contact/prescribed.h"
#include "mpm/ranks/partition.h"
#include "mpm/step/damping.h"

#include "core/particles/particles_internal.h"

#include <stdlib.h>
#include <string.h>

/* ---- candidates ------------------------------------------------------------------------------ */

/* Half the size (m) of a particle along n. */
static double half_size(const mpsi_grid *grid, const mpsi_columns *p, const mps_contact *contact,
                        int64_t particle, const double *n) {
  double wave, shear, stress[6] = {0.0};
  mpsi_mpm_elastic(p, particle, &wave, &shear);
  for (int c = 0; c < 2 * grid->dim; c++) stress[c] = p->s[c][particle];
  return mpsi_impulse_half_size(contact->def.offset, wave, shear, stress, n);
}

mpsi_bearing mpsi_mpm_bearing(const mpsi_grid *grid, const mpsi_columns *p,
                              const mps_contact *contact, int64_t particle, const double *x) {
  const mpsi_foot own = mpsi_body_foot(contact->body, x);
  const double half = half_size(grid, p, contact, particle, own.normal);
  return mpsi_corner_bearing(contact->body, contact->def.corner, x, half, &own);
}

static void place_of(const mpsi_grid *grid, const mpsi_columns *p, int64_t k, double *x) {
  for (int c = 0; c < 3; c++) x[c] = c < grid->dim ? p->x[c][k] : 0.0;
}

/* Distance (m) from the body beyond which no particle of the block can come into contact in dt. */
static double longest_reach(const mpsi_grid *grid, const mpsi_columns *p,
                            const mpsi_kernels *kernels, double dt, const mpsi_cell_block *cells,
                            const mps_contact *contact) {
  const double fastest = kernels->fastest(grid, p, cells->begin, cells->end);
  const double most = contact->inset ? 1.2 * (1.0 + MPSI_EDGE_REACH) : 1.4; /* half spacings */
  return (most * contact->def.offset + dt * (mpsi_contact_speed(contact) + fastest)) * (1.0 + 1e-9);
}

/* Bounds from the foot of x, which exclude other particles without a search: the distance from a
 * body changes at most by the distance moved, and a convex body lies behind its tangent plane. */
static mpsi_far far_by(const mps_contact *contact, const mpsi_foot *foot, const double *x,
                       double reach) {
  const double slack = fmax(foot->distance - reach, 0.0);
  mpsi_far out = {.square = slack * slack, .before = INFINITY};
  if (contact->convex && foot->distance > 0.0) out.before = reach * (1.0 + 1e-9);
  memcpy(out.x, x, sizeof out.x);
  memcpy(out.at, foot->at, sizeof out.at);
  memcpy(out.normal, foot->normal, sizeof out.normal);
  return out;
}

/* Whether the particle may take over an inset edge that bears (step/inset_edges.c). */
static bool may_bear_at_edge(const mps_contact *contact, const mpsi_foot *foot, double half) {
  if (!contact->inset || foot->distance > (1.0 + MPSI_EDGE_REACH) * half) return false;
  const mpsi_inset_edge edge =
      mpsi_edge_find(contact->body, (const double(*)[2])contact->inset, foot);
  return fabs(edge.inside) <= MPSI_EDGE_WINDOW * half;
}

static bool may_be_in_contact(const mpsi_grid *grid, const mpsi_columns *p, double dt,
                              const mps_contact *contact, int64_t k, const double *x,
                              const mpsi_foot *foot) {
  const double half = half_size(grid, p, contact, k, foot->normal);
  double surface[3], closing = 0.0;
  mpsi_body_velocity(&contact->body->pose, foot->at, surface);
  for (int c = 0; c < grid->dim; c++) closing += (surface[c] - p->v[c][k]) * foot->normal[c];
  return mpsi_impulse_near(foot->distance - half, half, closing, dt) ||
         may_bear_at_edge(contact, foot, contact->def.offset);
}

/* Whether the box around all particles of the block (mpsi_cell_block.left) lies farther than
 * `reach` (m) from the body. */
static bool is_block_far(const mpsi_grid *grid, const mpsi_cell_block *cells,
                         const mps_contact *contact, double reach) {
  const double first = grid->spline == 3 ? 1.0 : 0.5;
  double middle[3] = {0.0}, half[3] = {0.0}, x[3], square = 0.0, before = 0.0;
  for (int c = 0; c < grid->dim; c++) {
    const double low = first + cells->low[c], high = first + (cells->high[c] - mpsi_reach(grid, c));
    middle[c] = 0.5 * (low + high);
    half[c] = 0.5 * grid->cell * (high - low) * (1.0 + 1e-9);
    square += half[c] * half[c];
  }
  mpsi_node_position(grid, cells->at, middle, x);
  const mpsi_foot foot = mpsi_body_foot(contact->body, x);
  if (foot.distance > reach + sqrt(square)) return true;
  if (!contact->convex || !(foot.distance > 0.0)) return false;
  for (int c = 0; c < grid->dim; c++)
    before += (x[c] - foot.at[c]) * foot.normal[c] - half[c] * fabs(foot.normal[c]);
  return before > reach * (1.0 + 1e-9);
}

/* Lists the candidates of a pair of block and body; bounds from the last foot exclude most
 * particles. */
static void find_candidates(const mpsi_grid *grid, const mpsi_columns *p,
                            const mpsi_contacts *contacts, const mpsi_kernels *kernels, double dt,
                            const mpsi_cell_block *cells, mpsi_cell_pair *pair) {
  const mps_contact *contact = contacts->handle[pair->body];
  const double reach = longest_reach(grid, p, kernels, dt, cells, contact);
  int32_t *out = contacts->impulses.candidate + pair->first_candidate;
  mpsi_far far = {.before = INFINITY};
  pair->candidates = 0;
  if (is_block_far(grid, cells, contact, reach)) return;
  for (int64_t k = cells->begin;
       (k = kernels->next_near(grid, p, &far, k, cells->end)) < cells->end; k++) {
    double x[3];
    place_of(grid, p, k, x);
    const mpsi_foot foot = mpsi_body_foot(contact->body, x);
    far = far_by(contact, &foot, x, reach);
    if (foot.distance <= reach && may_be_in_contact(grid, p, dt, contact, k, x, &foot))
      out[pair->candidates++] = (int32_t)(k - cells->begin);
  }
}

static void find_in_block(void *data, int64_t b, int32_t worker) {
  const mpsi_contact_stage *stage = data;
  const mpsi_cell_block *cells = &stage->transfer.grid->cells[b];
  for (int32_t q = 0; q < cells->pairs; q++) {
    mpsi_cell_pair *pair = &stage->contact->cell_pair[cells->first_pair + q];
    if (mpsi_by_impulses(stage->contact->handle[pair->body]))
      find_candidates(stage->transfer.grid, stage->transfer.p, stage->contact, stage->kernels,
                      stage->transfer.run->dt, cells, pair);
  }
}

/* Divides the list of candidates among the pairs: as many places as there are particles in the
 * blocks near each body. */
static int64_t share_candidates(const mpsi_grid *grid, const mpsi_contacts *contacts) {
  int64_t count = 0;
  for (int64_t t = 0; t < contacts->cell_pair_count; t++) {
    mpsi_cell_pair *pair = &contacts->cell_pair[t];
    const mpsi_cell_block *cells = &grid->cells[pair->cells];
    pair->first_candidate = count;
    pair->candidates = pair->strips = 0;
    /* also for blocks that are scattered after the contacts are solved (step.c) */
    pair->in_contact = false;
    pair->deepest = 0.0;
    if (mpsi_by_impulses(contacts->handle[pair->body])) count += cells->end - cells->begin;
  }
  return count;
}

/* Lists the blocks with candidates, colour by colour. */
static void list_blocks(const mpsi_grid *grid, const mpsi_prescribed *prescribed,
                        mpsi_contacts *contacts) {
  mpsi_impulses *all = &contacts->impulses;
  all->constraint_count = all->contact_count = all->block_count = 0;
  for (int colour = 0; colour < MPSI_CORNERS; colour++) {
    all->colour[colour] = all->block_count;
    for (int64_t i = grid->colour[colour]; i < grid->colour[colour + 1]; i++) {
      const mpsi_cell_block *cells = &grid->cells[grid->coloured[i]];
      const int64_t groups = mpsi_groups_of(prescribed, grid->coloured[i]);
      int64_t count = 0;
      for (int32_t q = 0; q < cells->pairs && contacts->bodies > 0; q++)
        count += contacts->cell_pair[cells->first_pair + q].candidates;
      if (count + groups == 0) continue;
      all->block[all->block_count++] =
          (mpsi_constraint_block){.first = all->constraint_count,
                                  .count = count,
                                  .groups = groups,
                                  .cells = grid->coloured[i],
                                  .at = {cells->at[0], cells->at[1], cells->at[2]}};
      all->constraint_count += count + groups;
      all->contact_count += contacts->bodies > 0 ? count : groups;
    }
  }
  all->colour[MPSI_CORNERS] = all->block_count;
}

mps_status mpsi_mpm_find_constraints(const mpsi_contact_stage *stage, const char *function) {
  const mpsi_grid *grid = stage->transfer.grid;
  mpsi_impulses *all = &stage->contact->impulses;
  mps_context *context = stage->context;
  all->constraint_count = all->contact_count = all->block_count = 0;
  if (stage->contact->bodies == 0 && !stage->prescribed) return MPS_OK;
  const int64_t candidates = share_candidates(grid, stage->contact);
  const int32_t side = grid->spline + 1;
  all->stride = grid->dim == 3 ? side * side * side : side * side;
  if (stage->prescribed) all->stride *= 2; /* a thin body may divide a group */
  bool good = MPSI_ENSURE(context, all, candidate, candidates) &&
              MPSI_ENSURE(context, all, block, grid->cell_count) &&
              MPSI_ENSURE(context, all, body, stage->contact->bodies);
  if (good && candidates > 0)
    mpsi_mpm_for_cells(context, grid, stage->transfer.p, find_in_block, (void *)stage);
  if (good && (candidates > 0 || stage->prescribed))
    list_blocks(grid, stage->prescribed, stage->contact);
  const int64_t n = all->constraint_count;
  good = good && MPSI_ENSURE(context, all, constraint, n) &&
         MPSI_ENSURE(context, all, weight, n * all->stride) &&
         MPSI_ENSURE(context, all, node, n * all->stride) &&
         mpsi_room_ensure(context, &all->next_room, 2 * n, sizeof *all->warm) &&
         mpsi_mpm_index_impulses(stage->context, stage->contact) &&
         mpsi_mpm_area_room(stage->context, grid, stage->contact, stage->partition, n);
  if (!good) {
    all->constraint_count = all->contact_count = all->block_count = 0;
    return mpsi_fail_memory(context, function,
                            (size_t)(n + 1) * (sizeof *all->constraint + (size_t)all->stride * 40) +
                                (size_t)candidates * sizeof *all->candidate);
  }
  all->free_bodies = false;
  for (int32_t b = 0; b < stage->contact->bodies; b++) {
    mpsi_impulse_begin_body(&all->body[b], stage->contact->body[b], stage->transfer.run->dt);
    if (stage->settling) all->body[b].free = false;
    all->free_bodies = all->free_bodies || all->body[b].free;
  }
  return MPS_OK;
}

/* ---- weights of the constraints -------------------------------------------------------------- */

static int by_place(const void *a, const void *b) {
  const mpsi_constraint *s = a, *t = b;
  for (int c = 0; c < 3; c++)
    if (s->x[c] != t->x[c]) return s->x[c] < t->x[c] ? -1 : 1;
  if (s->id != t->id) return s->id < t->id ? -1 : 1;
  return (s->body > t->body) - (s->body < t->body);
}

/* Where a particle bears that is near an edge of a body with inset edges (contact/edge.h): the
 * bearer of an inset edge at this, others at their feet. False: it lies in the strip beyond. */
static bool place_at_edge(const mps_contact *contact, const mpsi_foot *foot, mpsi_constraint *out) {
  const mpsi_inset_edge edge =
      mpsi_edge_find(contact->body, (const double(*)[2])contact->inset, foot);
  const mpsi_edge_bearer *bearer = mpsi_edge_bearer_of(contact, edge.point);
  if (!bearer || bearer->id != out->id) return !(edge.inside < 0.0);
  out->point = edge.point;
  for (int c = 0; c < 3; c++) out->impulse.at[c] += edge.shift[c];
  return true;
}

/* The gap of an inset edge that bore in the last step is closed, also where another particle bears
 * now. */
static bool is_held(const mps_contact *contact, const mpsi_constraint *constraint) {
  const mpsi_edge_bearer *bearer = mpsi_edge_bearer_of(contact, constraint->point);
  return bearer && bearer->warm >= 0;
}

#define BEARS 1e-6 /* half spacings */

/* m: way of the particle along the surface in a step. */
static double way_along(const mpsi_contact_stage *stage, const mpsi_constraint *constraint,
                        const mpsi_foot *foot) {
  const mpsi_columns *p = stage->transfer.p;
  double surface[3], v[3] = {0.0}, normal = 0.0, square = 0.0;
  mpsi_body_velocity(&stage->contact->handle[constraint->body]->body->pose, foot->at, surface);
  for (int c = 0; c < stage->transfer.grid->dim; c++) {
    v[c] = p->v[c][constraint->particle] - surface[c];
    normal += v[c] * foot->normal[c];
  }
  for (int c = 0; c < 3; c++)
    square += (v[c] - normal * foot->normal[c]) * (v[c] - normal * foot->normal[c]);
  return stage->transfer.run->dt * sqrt(square);
}

/* Rest gap of a particle of half size `half`, at the gap `gap` now. */
static double rest_gap_of(const mpsi_contact_stage *stage, const mpsi_constraint *constraint,
                          const mpsi_foot *foot, double half) {
  const double gap = foot->distance - half;
  const mpsi_contacts *contacts = stage->contact;
  const mps_contact_def *def = &contacts->handle[constraint->body]->def;
  if (contacts->state[constraint->body].first_step == stage->transfer.run->steps) {
    const bool bears = foot->distance <= def->offset * (1.0 + BEARS);
    return !bears ? 0.0 : def->inside == MPS_CONTACT_INSIDE_PUSH ? fmax(gap, 0.0) : gap;
  }
  const mpsi_warm_impulse *before =
      mpsi_mpm_warm_impulse(contacts, constraint->id, constraint->body, MPSI_REST_GAP);
  if (!before) return 0.0;
  return mpsi_impulse_rest_gap(gap, before->by[0], way_along(stage, constraint, foot), half);
}

/* Contact of particle k with the body of pair t; false: it lies in the strip beyond an inset edge,
 * where it has none. */
static bool begin_constraint(const mpsi_contact_stage *stage, int64_t t, int64_t k,
                             const int64_t *id, mpsi_constraint *out) {
  mpsi_cell_pair *pair = &stage->contact->cell_pair[t];
  const mps_contact *contact = stage->contact->handle[pair->body];
  *out = (mpsi_constraint){.particle = k, .id = id[k], .pair = t, .body = pair->body};
  place_of(stage->transfer.grid, stage->transfer.p, k, out->x);
  const mpsi_bearing bearing =
      mpsi_mpm_bearing(stage->transfer.grid, stage->transfer.p, contact, k, out->x);
  const mpsi_foot foot = bearing.foot;
  mpsi_impulse *c = &out->impulse;
  if (-bearing.outside > pair->deepest) {
    pair->in_contact = true;
    pair->deepest = -bearing.outside, pair->deep = k;
  }
  const double lever = mpsi_impulse_lever(foot.distance, bearing.half);
  for (int a = 0; a < stage->transfer.grid->dim; a++) {
    c->normal[a] = foot.normal[a];
    c->at[a] = out->x[a] + lever * (foot.at[a] - out->x[a]);
  }
  if (contact->inset && !place_at_edge(contact, &foot, out)) return false;
  out->part = mpsi_contact_part(contact, foot.face);
  const double gap = foot.distance - bearing.half;
  out->rest_gap = rest_gap_of(stage, out, &foot, bearing.half);
  c->aim =
      mpsi_impulse_aim(gap - out->rest_gap, stage->transfer.run->dt,
                       fmax(stage->transfer.run->dt, stage->next_dt), stage->transfer.run->speed);
  if (is_held(contact, out)) c->aim = fmax(c->aim, 0.0);
  c->friction = contact->friction;
  c->strength = INFINITY;
  return true;
}

/* Solution q of the moment equations M q = (1, 0, 0), M positive definite; false where the nodes
 * hardly determine it. */
static bool solve_moments(double (*M)[4], double *q) {
  M[0][3] = 1.0;
  for (int i = 0; i < 3; i++) {
    if (!(M[i][i] > 1e-3)) return false;
    for (int k = i + 1; k < 3; k++)
      for (int j = 3; j >= i; j--) M[k][j] -= M[k][i] / M[i][i] * M[i][j];
  }
  for (int i = 2; i >= 0; i--) {
    q[i] = M[i][3];
    for (int j = i + 1; j < 3; j++) q[i] -= M[i][j] * q[j];
    q[i] /= M[i][i];
  }
  return true;
}

/* Shape functions of the least-squares fit at the point x in the plane over the active nodes of a
 * particle near it, in place of those extrapolated from the particle: an impulse at an inset edge
 * then acts on the same nodes, whichever particle it stands for. */
static void fit_at_point(const mpsi_transfer *work, const double *x, mpsi_foot_weights *out) {
  const mpsi_grid *grid = work->grid;
  double r[MPSI_STENCIL][2], w[MPSI_STENCIL], M[3][4] = {{0.0}}, q[3];
  for (uint64_t left = out->active; left != 0; left &= left - 1) {
    const int s = __builtin_ctzll(left);
    const double local[3] = {out->at[0] + s % 4, out->at[1] + s / 4 % 4, 0.0};
    double node[3];
    mpsi_node_position(grid, work->cells->at, local, node);
    for (int c = 0; c < 2; c++) r[s][c] = (node[c] - x[c]) * grid->inverse;
    w[s] = mpsi_spline_at(grid->spline, r[s][0]) * mpsi_spline_at(grid->spline, r[s][1]);
    const double base[3] = {1.0, r[s][0], r[s][1]};
    for (int i = 0; i < 3; i++)
      for (int j = 0; j < 3; j++) M[i][j] += w[s] * base[i] * base[j];
  }
  if (!solve_moments(M, q)) return;
  for (uint64_t left = out->active; left != 0; left &= left - 1) {
    const int s = __builtin_ctzll(left);
    out->psi[s] = w[s] * (q[0] + q[1] * r[s][0] + q[2] * r[s][1]);
  }
}

/* Shape functions psi, extrapolated to the point where the impulse acts, at the nodes of the
 * constraint's stencil. */
static void find_psi(const mpsi_kernels *kernels, const mpsi_transfer *work,
                     const mpsi_constraint *constraint, mpsi_foot_weights *out) {
  double d[3];
  for (int a = 0; a < 3; a++) d[a] = constraint->impulse.at[a] - constraint->x[a];
  kernels->foot(work, constraint->particle, d, out);
  if (constraint->point > 0) fit_at_point(work, constraint->impulse.at, out);
}

/* Tile node of stencil node s. */
static void find_place(const mpsi_foot_weights *f, int s, int *place) {
  place[0] = f->at[0] + s % 4, place[1] = f->at[1] + s / 4 % 4, place[2] = f->at[2] + s / 16;
}

/* Weights and mobility of a constraint at mirrors or on several ranks, where ghosts are replaced by
 * their images: psi differs between components. */
static void fit_unevenly(const mpsi_grid *grid, const mpsi_boundaries *boundaries,
                         const mpsi_mirrors *mirrors, mpsi_contacts *contacts,
                         const mpsi_cell_block *cells, const mpsi_foot_weights *f, int64_t n) {
  mpsi_impulses *all = &contacts->impulses;
  mpsi_constraint *constraint = &all->constraint[n];
  double(*weight)[4] = all->weight + n * all->stride, **node = all->node + n * all->stride;
  for (uint64_t left = f->active; left != 0; left &= left - 1) {
    const int s = __builtin_ctzll(left);
    int place[3];
    find_place(f, s, place);
    const double psi = f->psi[s];
    double psis[3] = {psi, psi, psi}, keeps[3], carried[3];
    const bool image = cells->mirrors &&
                       mpsi_mpm_find_image(grid, boundaries, mirrors, cells, place, keeps, carried);
    for (int a = 0; a < 3 && image; a++) {
      psis[a] *= keeps[a];
      constraint->carried[a] += psi * carried[a];
    }
    const int64_t g = f->across >> s & 1
                          ? mpsi_node_across(grid, cells, place[0], place[1], place[2])
                          : mpsi_node_under(grid, cells, place[0], place[1], place[2]);
    if (grid->node[g][MPSI_MASS] > 0.0)
      mpsi_mpm_add_node(constraint, node, weight, grid->node[g], psis, cells->mirrors != 0);
  }
  for (int32_t i = 0; i < constraint->nodes; i++)
    for (int a = 0; a < 3; a++) {
      const double psi = weight[i][MPSI_VECTOR + a];
      constraint->impulse.mobility[a] += psi * psi * weight[i][MPSI_MASS];
    }
}

/* Weights and mobility of an even constraint: nodes without mirrors, on one rank. */
static void fit_evenly(const mpsi_grid *grid, mpsi_contacts *contacts, const mpsi_cell_block *cells,
                       const mpsi_foot_weights *f, int64_t n) {
  mpsi_impulses *all = &contacts->impulses;
  mpsi_constraint *constraint = &all->constraint[n];
  double(*weight)[2] = mpsi_even_weights(all, n), **node = all->node + n * all->stride;
  double mobility = 0.0;
  int32_t count = 0;
  for (uint64_t left = f->active; left != 0; left &= left - 1) {
    const int s = __builtin_ctzll(left);
    int place[3];
    find_place(f, s, place);
    const int64_t g = f->across >> s & 1
                          ? mpsi_node_across(grid, cells, place[0], place[1], place[2])
                          : mpsi_node_under(grid, cells, place[0], place[1], place[2]);
    double *at = grid->node[g];
    if (!(at[MPSI_MASS] > 0.0)) continue;
    weight[count][0] = 1.0 / at[MPSI_MASS];
    weight[count][1] = f->psi[s];
    mobility += f->psi[s] * f->psi[s] * weight[count][0];
    node[count++] = at;
  }
  constraint->nodes = count;
  for (int a = 0; a < 3; a++) constraint->impulse.mobility[a] = mobility;
}

/* Weights and mobility (inverse of the effective mass) of a constraint. */
static void fit_constraint(const mpsi_contact_stage *stage, const mpsi_transfer *work, int64_t n) {
  const mpsi_cell_block *cells = work->cells;
  mpsi_constraint *constraint = &stage->contact->impulses.constraint[n];
  mpsi_foot_weights f;
  find_psi(stage->kernels, work, constraint, &f);
  constraint->nodes = 0;
  constraint->even = !stage->partition && !cells->mirrors;
  if (constraint->even)
    fit_evenly(stage->transfer.grid, stage->contact, cells, &f, n);
  else
    fit_unevenly(stage->transfer.grid, stage->transfer.boundaries, stage->transfer.mirrors,
                 stage->contact, cells, &f, n);
}

/* States of nodes (support.h) where some fit has not been stored by the scatter. */
static void find_states(const mpsi_transfer *work, const mpsi_impulses *impulses,
                        const mpsi_constraint_block *block) {
  const mpsi_cell_block *cells = work->cells;
  const mpsi_constraint *constraint = impulses->constraint + block->first;
  bool all = cells->first_fit >= 0;
  for (int64_t n = 0; n < block->count && all; n++)
    all = work->grid->fitted[cells->first_fit + (constraint[n].particle - cells->begin)] != 0;
  if (!all) mpsi_mpm_find_states(work);
}

/* Adds the mirrors' part of the impulses of a block's constraints to the walls. */
static void mirror_block(void *data, int64_t unit, int32_t number) {
  const mpsi_contact_stage *stage = data;
  mpsi_impulses *all = &stage->contact->impulses;
  const mpsi_constraint_block *block = &all->block[unit];
  if (block->cells < 0) return;
  const mpsi_transfer work = mpsi_contact_transfer(stage, block->cells, number);
  const mpsi_cell_block *cells = work.cells;
  if (!cells->mirrors) return;
  find_states(&work, all, block);
  for (int64_t n = block->first; n < block->first + block->count; n++) {
    const mpsi_constraint *constraint = &all->constraint[n];
    const mpsi_impulse *c = &constraint->impulse;
    mpsi_foot_weights f;
    if (!(c->normal_impulse > 0.0)) continue;
    find_psi(stage->kernels, &work, constraint, &f);
    for (uint64_t left = f.active; left != 0; left &= left - 1) {
      const int s = __builtin_ctzll(left);
      int place[3];
      double by[3];
      find_place(&f, s, place);
      for (int a = 0; a < 3; a++)
        by[a] = f.psi[s] * (c->normal_impulse * c->normal[a] + c->tangent_impulse[a]);
      if (f.psi[s] != 0.0)
        mpsi_mpm_reflect_impulse(stage->transfer.grid, stage->transfer.boundaries,
                                 stage->transfer.mirrors, cells, place, by);
    }
  }
}

void mpsi_mpm_mirror_constraints(const mpsi_contact_stage *stage) {
  if (stage->transfer.mirrors->sides)
    mpsi_parallel_for(stage->context, stage->contact->impulses.block_count, mirror_block,
                      (void *)stage);
}

/* Makes the constraints of a block's candidates. Those in the strips beyond inset edges get none:
 * their places in the list, after the groups, stay empty. */
static void begin_block(const mpsi_contact_stage *stage, const mpsi_cell_block *cells,
                        mpsi_constraint_block *block) {
  mpsi_impulses *all = &stage->contact->impulses;
  const int64_t *id = mpsi_particles_integers(stage->transfer.p->set, "id");
  int64_t n = block->first;
  for (int32_t q = 0; q < cells->pairs && block->count > 0; q++) {
    const int64_t t = cells->first_pair + q;
    mpsi_cell_pair *pair = &stage->contact->cell_pair[t];
    int32_t *candidate = all->candidate + pair->first_candidate;
    for (int64_t i = 0; i < pair->candidates; i++)
      if (begin_constraint(stage, t, cells->begin + candidate[i], id, &all->constraint[n]))
        n++;
      else
        candidate[pair->strips++] = candidate[i];
  }
  const int64_t made = n - block->first;
  if (made < block->count)
    memset(all->constraint + n + block->groups, 0,
           (size_t)(block->count - made) * sizeof *all->constraint);
  block->count = made;
}

/* Impulse from which the sweeps start: that on the particle in the last step and, of the bearer of
 * an inset edge, that at the edge, which another may have borne. */
static void begin_warm(const mpsi_contacts *contacts, mpsi_constraint *constraint) {
  const mpsi_edge_bearer *bearer =
      mpsi_edge_bearer_of(contacts->handle[constraint->body], constraint->point);
  const mpsi_warm_impulse *from[2] = {
      mpsi_mpm_warm_impulse(contacts, constraint->id, constraint->body, 0),
      bearer && bearer->warm >= 0 ? &contacts->impulses.warm[bearer->warm] : NULL};
  double *by = constraint->impulse.tangent_impulse;
  for (int a = 0; a < 3; a++)
    by[a] = (from[0] ? from[0]->by[a] : 0.0) + (from[1] ? from[1]->by[a] : 0.0);
}

static void fit_block(void *data, int64_t unit, int32_t worker) {
  const mpsi_contact_stage *stage = data;
  mpsi_impulses *all = &stage->contact->impulses;
  mpsi_constraint_block *block = &all->block[unit];
  const mpsi_transfer work = mpsi_contact_transfer(stage, block->cells, worker);
  int64_t n;
  begin_block(stage, work.cells, block);
  if (block->count > 0)
    qsort(all->constraint + block->first, (size_t)block->count, sizeof *all->constraint, by_place);
  find_states(&work, all, block);
  for (n = block->first; n < block->first + block->count; n++) {
    fit_constraint(stage, &work, n);
    mpsi_constraint *constraint = &all->constraint[n];
    begin_warm(stage->contact, constraint);
  }
  if (block->groups > 0) mpsi_mpm_fit_prescribed(stage, &work, block);
}

void mpsi_mpm_fit_constraints(const mpsi_contact_stage *stage) {
  mpsi_parallel_for(stage->context, stage->contact->impulses.block_count, fit_block, (void *)stage);
  if (!stage->partition) mpsi_mpm_find_areas(stage);
}
