/* inset_edges.c - inset edges of bodies (contact/edge.h) in a step: the particle that bears there,
 * and those in the strip beyond.
 *
 * Bearers: of the candidates for contact whose feet lie within 3/4 of a spacing of an inset edge
 * the nearest one along the face. So the edge is borne wherever particles are, and at most by one:
 * ground that flows past hands it from particle to particle. The impulse of the last step and the
 * closed gap belong to the edge (contact/constraints.c), so that the next particle need not come to
 * the face first.
 *
 * Strips: the body does not bear particles there. The ground flows on between the face and free
 * ground, and would enter the body by some 1e-4 cells a step. Its places are corrected, not its
 * velocities: a particle nearer to the body than its half size e is moved along the normal to that
 * distance, no farther than e in a step. So no force acts, and no work is done; momentum does not
 * change, and moment of momentum, which a moved particle has less of, goes to the spin of its
 * velocity gradient, from which the next transfer gives it to the nodes (transfer/spin.h).
 * SPDX-License-Identifier: BSD-3-Clause */
#include "mpm/base/mpm_solver.h"
#include "mpm/grid/pass.h"
#include "mpm/ranks/partition.h"

#include "contact/edge.h"
#include "core/particles/particles_internal.h"
#include "domain/domain_internal.h"

#define WINDOW 1.5  /* half spacings: how far a bearer may be off the edge, and */
#define NEAR 1.2    /* off the body, unless the edge bears and none is so near (impulses.h) */
#define KEEPS 0.1   /* half spacings: by which another must be nearer than the present bearer */
#define BEYOND 1e-6 /* half spacings: for of two alike the one within the edge bears */
#define LOWER 1e-3  /* of the distance from the face: of two in a column the upper one bears */
#define FAR 1e300   /* m, of no particle */

/* ---- bearers of this rank -------------------------------------------------------------------- */

static void begin(mpsi_contacts *contacts) {
  const mpsi_impulses *all = &contacts->impulses;
  for (int32_t b = 0; b < contacts->bodies; b++) {
    mps_contact *contact = contacts->handle[b];
    for (int64_t k = 0; contact->inset && k < contact->body->edges; k++)
      for (int c = 0; c < 2; c++) contact->bearer[k][c] = (mpsi_edge_bearer){-1, FAR, -1};
  }
  for (int64_t k = 0; k < all->warm_count; k++) {
    const mpsi_warm_impulse *warm = &all->warm[k];
    mpsi_edge_bearer *at = mpsi_edge_bearer_of(contacts->handle[warm->body], warm->point);
    if (at) at->warm = k;
  }
}

/* Particle k, a candidate for contact with the body, may be a bearer. */
static void consider(const mpsi_contact_stage *stage, mps_contact *contact, int64_t k, int64_t id) {
  const mpsi_columns *p = stage->transfer.p;
  const double x[3] = {p->x[0][k], p->x[1][k], 0.0}, half = contact->def.offset;
  const mpsi_foot foot = mpsi_mpm_bearing(stage->transfer.grid, p, contact, k, x).foot;
  const mpsi_inset_edge edge =
      mpsi_edge_find(contact->body, (const double(*)[2])contact->inset, &foot);
  mpsi_edge_bearer *at = mpsi_edge_bearer_of(contact, edge.point);
  if (!at || !(fabs(edge.inside) <= MPSI_EDGE_WINDOW * half)) return;
  double apart = fabs(edge.inside) + LOWER * fmax(foot.distance, 0.0);
  if (fabs(edge.inside) > WINDOW * half || foot.distance > NEAR * half) {
    if (at->warm < 0) return;
    apart += WINDOW * half;
  }
  if (edge.inside < 0.0) apart += BEYOND * half;
  if (at->warm >= 0 && stage->contact->impulses.warm[at->warm].id == id) apart -= KEEPS * half;
  if (apart < at->apart || (apart == at->apart && id < at->id)) at->apart = apart, at->id = id;
}

static void find_nearest(const mpsi_contact_stage *stage) {
  const mpsi_contacts *contacts = stage->contact;
  const int64_t *id = mpsi_particles_integers(stage->transfer.p->set, "id");
  for (int64_t t = 0; t < contacts->cell_pair_count; t++) {
    const mpsi_cell_pair *pair = &contacts->cell_pair[t];
    mps_contact *contact = contacts->handle[pair->body];
    const int64_t begin_at = stage->transfer.grid->cells[pair->cells].begin;
    if (!contact->inset) continue;
    for (int64_t i = 0; i < pair->candidates; i++) {
      const int64_t k = begin_at + contacts->impulses.candidate[pair->first_candidate + i];
      consider(stage, contact, k, id[k]);
    }
  }
}

/* ---- bearers of all ranks -------------------------------------------------------------------- */

/* The greatest of each value on all ranks: of the nearness of the bearers, then, among equals, of
 * less their ids. Ranks whose particle is farther have none. */
static mps_status agree_on(mpsi_edge_bearer **list, int32_t count, mps_domain *domain,
                           const char *function, mps_status status) {
  for (int round = 0; round < 2; round++) {
    double value[MPSI_DOMAIN_ALONG];
    for (int32_t i = 0; i < count; i++)
      value[i] = list[i]->id < 0 ? -FAR : round == 0 ? -list[i]->apart : -(double)list[i]->id;
    status = mpsi_domain_agree_max(domain, function, status, count, value);
    if (status != MPS_OK) return status;
    for (int32_t i = 0; i < count; i++)
      if (value[i] != (round == 0 ? -list[i]->apart : -(double)list[i]->id)) list[i]->id = -1;
  }
  return status;
}

static mps_status agree(const mpsi_contacts *contacts, mps_domain *domain, const char *function,
                        mps_status status) {
  mpsi_edge_bearer *list[MPSI_DOMAIN_ALONG];
  int32_t count = 0;
  for (int32_t b = 0; b < contacts->bodies; b++) {
    mps_contact *contact = contacts->handle[b];
    for (int64_t k = 0; contact->inset && k < contact->body->edges; k++)
      for (int c = 0; c < 2; c++) {
        if (!(contact->inset[k][c] > 0.0)) continue;
        list[count++] = &contact->bearer[k][c];
        if (count < MPSI_DOMAIN_ALONG) continue;
        status = agree_on(list, count, domain, function, status);
        count = 0;
      }
  }
  return count > 0 ? agree_on(list, count, domain, function, status) : status;
}

mps_status mpsi_mpm_find_bearers(const mpsi_contact_stage *stage, const char *function,
                                 mps_status status) {
  begin(stage->contact);
  if (status == MPS_OK) find_nearest(stage);
  return stage->partition ? agree(stage->contact, stage->partition->domain, function, status)
                          : status;
}

/* ---- strips ---------------------------------------------------------------------------------- */

/* Whether x lies in the domain; `left`: its stencil leaves the tile of the block (g2p.c). */
static bool is_in_domain(const mpsi_grid *grid, const mpsi_cell_block *cells, const double *x,
                         bool *left) {
  const double first = grid->spline == 3 ? 1.0 : 0.5;
  if (grid->geometry == MPS_MPM_GEOMETRY_AXISYMMETRIC && !(x[0] > 0.0)) return false;
  for (int c = 0; c < grid->dim; c++) {
    const double X = mpsi_grid_at(grid, c, x[c]), own = X - (double)cells->at[c] * MPSI_SIDE;
    if (!(X >= (double)grid->low[c]) || !(X <= (double)grid->high[c])) return false;
    if (!(own >= first + cells->low[c]) || !(own < first + (cells->high[c] - mpsi_reach(grid, c))))
      *left = true;
  }
  return true;
}

static void move_off(const mpsi_grid *grid, const mpsi_columns *p, const mps_contact *contact,
                     mpsi_cell_block *cells, int64_t k) {
  double x[3] = {0.0}, to[3], v[2];
  for (int c = 0; c < grid->dim; c++) x[c] = p->x[c][k];
  const mpsi_bearing bearing = mpsi_mpm_bearing(grid, p, contact, k, x);
  const double by = fmin(bearing.half, bearing.half - bearing.foot.distance);
  if (!(by > 0.0)) return;
  for (int c = 0; c < 3; c++) to[c] = x[c] + by * bearing.foot.normal[c];
  if (!is_in_domain(grid, cells, to, &cells->left)) return;
  for (int c = 0; c < grid->dim; c++) p->x[c][k] = to[c], v[c] = p->v[c][k];
  if (grid->geometry == MPS_MPM_GEOMETRY_AXISYMMETRIC) return; /* rings */
  const double moment = (to[0] - x[0]) * v[1] - (to[1] - x[1]) * v[0];
  const double spin = mpsi_inverse_moment(grid->spline) * moment * grid->inverse * grid->inverse;
  p->L[2][k] -= 0.5 * spin, p->L[1][k] += 0.5 * spin;
}

static void clear_block(void *solver, int64_t b, int32_t worker) {
  mps_mpm *mpm = solver;
  mpsi_cell_block *cells = &mpm->grid.cells[b];
  for (int32_t q = 0; q < cells->pairs; q++) {
    const mpsi_cell_pair *pair = &mpm->contact.cell_pair[cells->first_pair + q];
    const int32_t *strip = mpm->contact.impulses.candidate + pair->first_candidate;
    for (int64_t i = 0; i < pair->strips; i++)
      move_off(&mpm->grid, &mpm->p, mpm->contact.handle[pair->body], cells,
               cells->begin + strip[i]);
  }
}

void mpsi_mpm_clear_strips(mps_mpm *mpm) {
  mpsi_mpm_for_cells(mpm->context, &mpm->grid, &mpm->p, clear_block, mpm);
}
