/* contacts.c - contacts with bodies in the operator of implicit pressures. Where the ground bears
 * on a body its velocity is that of the surface, whatever the pressures. With the rows C of the
 * contacts (psi n at their nodes, contact/constraints.c; -n at the body, which a free one moves
 * with its mass) a correction w = m^-1 G d of the velocities of nodes and bodies becomes
 *
 *   w - m^-1 C^T Y C w,   Y nearly (C m^-1 C^T)^-1
 *
 * by symmetric Gauss-Seidel sweeps from zero, extrapolated with Chebyshev's polynomials: these are
 * the same whatever w, so that Y is symmetric, and two cycles leave the square of what one leaves
 * of a motion, which is not negative: the operator stays positive definite. What bears the
 * correction is added to the impulses of the contacts. Without this the pressure that a body raises
 * comes as many steps late as the water's forces are stiffer than its storage; a motion that Y
 * leaves opens and closes contacts in turn, and grows. The part that is left must be small beside
 * the ratio of storage to dt^2 G^T m^-1 G: contacts that share their nodes converge slowly by
 * sweeps alone, and the ground tilts below the body.
 *
 * On several ranks partners have the same contacts (contact/exchange.h) and sweep alike; each
 * iteration takes the velocities of their nodes from the rank that counts these, as a sum of bits
 * over all ranks to which one alone contributes. SPDX-License-Identifier: BSD-3-Clause */
#include "contacts.h"

#include "core/base/room_array.h"
#include "mpm/contact/pairs.h"

#include <stddef.h>
#include <stdlib.h>
#include <string.h>

/* Sweeps of a cycle, and cycles. */
enum { SWEEPS = 16, CYCLES = 2 };
/* A cycle leaves little of the motions of which a sweep takes at least this part. */
#define LEAST_TAKEN 0.05
/* A contact that bears this part of what it can in shear slides. */
#define SLIDES 0.999999

/* ---- nodes ----------------------------------------------------------------------------------- */

/* Where a rank counts a node of contacts, as all ranks know it; bit c of `held`: component c is
 * prescribed. */
typedef struct known_node {
  int32_t at[3], held;
  int32_t slot;
} known_node;

enum { WORDS = 2 }; /* of a node in the sum that makes it known */

static int by_place(const void *left, const void *right) {
  return memcmp(((const known_node *)left)->at, ((const known_node *)right)->at,
                sizeof(int32_t[3]));
}

/* A node of a constraint: its number in the grid or, of a replica that has none there, behind those
 * (contact/exchange.h); -1 of one across a thin body. `at`: its place in the whole grid, cells. */
static int64_t index_of(const mps_mpm *mpm, int64_t n, const double *value, int32_t *at) {
  const mpsi_grid *grid = &mpm->grid;
  const int64_t nodes = grid->node_count * grid->block_nodes;
  if (mpm->contact.impulses.constraint[n].pair < 0) {
    const mpsi_shared_node *shared =
        (const void *)((const char *)value - offsetof(mpsi_shared_node, value));
    if (shared->kind != MPSI_SHARED_NODE) return -1;
    memcpy(at, shared->at, sizeof shared->at);
    if (!shared->home)
      return nodes + (shared - (const mpsi_shared_node *)mpm->contact.exchange.shared.item);
    value = shared->home;
  }
  const int64_t node = (const double(*)[4])value - (const double(*)[4])grid->node;
  if (node >= nodes) return -1;
  int local[3];
  mpsi_unravel((int)(node % grid->block_nodes), MPSI_SIDE, local);
  for (int c = 0; c < 3; c++)
    at[c] = grid->nodes[node / grid->block_nodes].at[c] * MPSI_SIDE + local[c];
  return node;
}

static bool make_room(mps_mpm *mpm, mpsi_pore_contacts *out) {
  const mpsi_impulses *all = &mpm->contact.impulses;
  mps_context *context = mpm->context;
  const int64_t count = all->constraint_count, most = count * all->stride;
  out->indices = mpm->grid.node_count * mpm->grid.block_nodes +
                 (mpm->partition ? mpm->contact.exchange.nodes : 0);
  const bool good =
      MPSI_ENSURE(context, out, contact, count) && MPSI_ENSURE(context, out, entry, most) &&
      MPSI_ENSURE(context, out, node, most) && MPSI_ENSURE(context, out, index, out->indices) &&
      MPSI_ENSURE(context, out, mover, mpm->contact.bodies);
  return good;
}

/* Node `value` of constraint n, made at its first use; -1: none. */
static int32_t take_node(const mps_mpm *mpm, mpsi_pore_contacts *out, int64_t n,
                         const double *value) {
  const mpsi_pore_system *s = mpm->water->system;
  int32_t at[3];
  const int64_t index = index_of(mpm, n, value, at);
  if (index < 0 || out->index[index] >= 0) return index < 0 ? -1 : out->index[index];
  mpsi_pore_contact_node *node = &out->node[out->nodes];
  *node = (mpsi_pore_contact_node){.at = {at[0], at[1], at[2]},
                                   .number = index,
                                   .slot = -1,
                                   .mass = value[MPSI_MASS] *
                                           (1.0 + mpm->def.viscous_damping * mpm->run.dt)};
  if (mpm->partition)
    node->number = mpsi_pore_node_at(&mpm->grid, s, at, &node->counted);
  else
    node->held = s->held[index];
  return out->index[index] = (int32_t)out->nodes++;
}

/* ---- the contacts of a step ------------------------------------------------------------------ */

static bool does_stick(const mpsi_impulse *c) {
  const double most = SLIDES * (c->friction * c->normal_impulse + c->adhesion);
  const double square = mpsi_dot3(c->tangent_impulse, c->tangent_impulse);
  return square < most * most && square < SLIDES * c->strength * c->strength;
}

static void add_contact(const mps_mpm *mpm, int64_t n, mpsi_pore_contacts *out) {
  const mpsi_impulses *all = &mpm->contact.impulses;
  const mpsi_constraint *from = &all->constraint[n];
  const double *weight = all->weight[n * all->stride];
  mpsi_pore_contact *to = &out->contact[out->count++];
  *to = (mpsi_pore_contact){.constraint = n,
                            .first = out->entries,
                            .body = from->body,
                            .sticks = does_stick(&from->impulse)};
  memcpy(to->normal, from->impulse.normal, sizeof to->normal);
  memcpy(to->at, from->impulse.at, sizeof to->at);
  for (int32_t i = 0; i < from->nodes; i++) {
    mpsi_pore_contact_entry *entry = &out->entry[out->entries];
    entry->node = take_node(mpm, out, n, all->node[n * all->stride + i]);
    if (entry->node < 0) continue;
    for (int a = 0; a < 3; a++)
      entry->psi[a] = from->even ? weight[2 * i + 1] : weight[4 * i + MPSI_VECTOR + a];
    to->entries++, out->entries++;
  }
}

/* Mobility of the body of a contact, 1/kg: along its normal or, of one that sticks, at least that
 * along any axis. */
static double mobility_of(const mps_mpm *mpm, const mpsi_pore_contacts *all,
                          const mpsi_pore_contact *c) {
  static const double axis[3][3] = {{1.0, 0.0, 0.0}, {0.0, 1.0, 0.0}, {0.0, 0.0, 1.0}};
  const mpsi_impulse_body *by = &all->mover[c->body].by;
  double sum = 0.0;
  if (!by->free) return 0.0;
  if (!c->sticks) return mpsi_impulse_mobility(by->body, c->at, c->normal);
  for (int a = 0; a < mpm->grid.dim; a++) sum += mpsi_impulse_mobility(by->body, c->at, axis[a]);
  return sum;
}

/* Prescribed components do not move; then 1/m_c of each contact. */
static void find_yields(const mps_mpm *mpm, mpsi_pore_contacts *all) {
  for (int64_t k = 0; k < all->count; k++) {
    mpsi_pore_contact *c = &all->contact[k];
    double sum[3] = {0.0}, across = 0.0;
    for (int64_t e = c->first; e < c->first + c->entries; e++) {
      const mpsi_pore_contact_node *node = &all->node[all->entry[e].node];
      for (int a = 0; a < 3; a++) {
        double *psi = &all->entry[e].psi[a];
        if (a >= mpm->grid.dim || node->held >> a & 1) *psi = 0.0;
        sum[a] += *psi * *psi / node->mass;
        across += *psi * *psi * c->normal[a] * c->normal[a] / node->mass;
      }
    }
    const double bodily = mobility_of(mpm, all, c);
    for (int a = 0; a < 3; a++) {
      const double yields = (c->sticks ? sum[a] : across) + bodily;
      c->yield[a] = yields > 0.0 ? 1.0 / yields : 0.0;
    }
  }
}

/* Sums over ranks of words to which one rank contributes. */
static mps_status share(mps_mpm *mpm, const char *function, int64_t words, int64_t *word) {
  return mpsi_domain_sum(mpm->domain, function, (int32_t)words, word);
}

/* The nodes that all ranks count, each with its slot, in order of places. */
static void list_known(const int64_t *word, int64_t known, known_node *out) {
  for (int64_t k = 0; k < known; k++, word += WORDS)
    out[k] =
        (known_node){.at = {(int32_t)(uint32_t)(word[0] & UINT32_MAX), (int32_t)(word[0] >> 32),
                            (int32_t)(uint32_t)(word[1] & UINT32_MAX)},
                     .held = (int32_t)(word[1] >> 32),
                     .slot = (int32_t)k};
  qsort(out, (size_t)known, sizeof *out, by_place);
}

static int64_t pack(int64_t low, int64_t high) {
  return (int64_t)((uint64_t)high << 32 | ((uint64_t)low & UINT32_MAX));
}

/* How many nodes all ranks count; *first: those of the ranks before. Collective. */
static mps_status count_slots(mps_mpm *mpm, const char *function, mpsi_pore_contacts *out,
                              int64_t *first) {
  mps_domain *domain = mpm->domain;
  const int32_t ranks = mps_domain_size(domain), own = mps_domain_rank(domain);
  const bool good = mpsi_room_ensure(mpm->context, &out->word_room, ranks, sizeof(int64_t));
  mps_status status = good ? MPS_OK : mpsi_fail_memory(mpm->context, function, 8);
  status = mpsi_domain_agree(domain, function, status);
  if (status != MPS_OK) return status;
  int64_t *word = out->word_room.item;
  memset(word, 0, (size_t)ranks * sizeof *word);
  for (int64_t k = 0; k < out->nodes; k++) word[own] += out->node[k].counted;
  status = share(mpm, function, ranks, word);
  if (status != MPS_OK) return status;
  out->slots = *first = 0;
  for (int32_t r = 0; r < ranks; r++) {
    if (r < own) *first += word[r];
    out->slots += word[r];
  }
  return MPS_OK;
}

/* Gives the nodes of all ranks their slots: those that rank 0 counts first. Collective. */
static mps_status find_slots(mps_mpm *mpm, const char *function, mpsi_pore_contacts *out) {
  mps_domain *domain = mpm->domain;
  const mpsi_pore_system *s = mpm->water->system;
  int64_t first = 0;
  mps_status status = count_slots(mpm, function, out, &first);
  if (status != MPS_OK || out->slots == 0) return status;
  const bool good =
      mpsi_room_ensure(mpm->context, &out->word_room, 3 * out->slots, sizeof(int64_t)) &&
      mpsi_room_ensure(mpm->context, &out->known_room, out->slots, sizeof(known_node));
  status = good ? MPS_OK : mpsi_fail_memory(mpm->context, function, (size_t)out->slots * 24);
  MPSI_TRY(mpsi_domain_agree(domain, function, status));
  int64_t *word = out->word_room.item;
  memset(word, 0, (size_t)(WORDS * out->slots) * sizeof *word);
  for (int64_t k = 0; k < out->nodes; k++) {
    const mpsi_pore_contact_node *node = &out->node[k];
    if (!node->counted) continue;
    word[WORDS * first] = pack(node->at[0], node->at[1]);
    word[WORDS * first++ + 1] = pack(node->at[2], s->held[node->number]);
  }
  MPSI_TRY(share(mpm, function, WORDS * out->slots, word));
  known_node *known = out->known_room.item;
  list_known(word, out->slots, known);
  for (int64_t k = 0; k < out->nodes; k++) {
    known_node like;
    memcpy(like.at, out->node[k].at, sizeof like.at);
    const known_node *found = bsearch(&like, known, (size_t)out->slots, sizeof *known, by_place);
    if (!found) continue; /* without particles: does not move */
    out->node[k].slot = found->slot;
    out->node[k].held = (uint8_t)found->held;
  }
  return MPS_OK;
}

void mpsi_pore_aim_contacts(mps_mpm *mpm) {
  const mpsi_impulses *all = &mpm->contact.impulses;
  const double damping = mpm->def.viscous_damping * mpm->run.dt;
  for (int64_t n = 0; n < all->constraint_count && mpsi_pore_predicts(mpm) && damping > 0.0; n++) {
    mpsi_constraint *c = &all->constraint[n];
    double surface[3];
    if (c->pair < 0) continue; /* of another rank, which has done so */
    mpsi_impulse_surface(&all->body[c->body], c->impulse.at, surface);
    c->impulse.aim += damping * (c->impulse.aim + mpsi_dot3(surface, c->impulse.normal));
  }
}

mps_status mpsi_pore_find_contacts(mps_mpm *mpm, const char *function) {
  mpsi_pore_contacts *out = &mpm->water->system->contacts;
  const mpsi_impulses *all = &mpm->contact.impulses;
  const bool any = mpm->contact.bodies > 0 &&
                   (mpm->partition ? mpm->contact.exchange.constraints > 0
                                   : mpm->contact.cell_pair_count > 0 && all->constraint_count > 0);
  mps_status status = MPS_OK;
  out->any = false;
  out->count = out->nodes = out->entries = out->slots = 0;
  if (!any) return MPS_OK;
  if (!make_room(mpm, out))
    status = mpsi_fail_memory(mpm->context, function,
                              (size_t)all->constraint_count * sizeof *out->contact);
  MPSI_TRY(mpsi_domain_agree(mpm->domain, function, status));
  if (out->indices > 0) memset(out->index, -1, (size_t)out->indices * sizeof *out->index);
  for (int64_t n = 0; n < all->constraint_count; n++)
    if (all->constraint[n].impulse.normal_impulse > 0.0) add_contact(mpm, n, out);
  if (mpm->partition) status = find_slots(mpm, function, out);
  out->any = mpm->partition ? out->slots > 0 : out->count > 0;
  out->movers = mpm->contact.bodies;
  for (int32_t b = 0; b < out->movers; b++) out->mover[b].by = all->body[b];
  if (status == MPS_OK) find_yields(mpm, out);
  return status;
}

/* ---- an iteration ---------------------------------------------------------------------------- */

static mps_status take_velocities(mps_mpm *mpm, const char *function, mpsi_pore_contacts *all) {
  const mpsi_pore_system *s = mpm->water->system;
  if (!mpm->partition) {
    for (int64_t k = 0; k < all->nodes; k++)
      memcpy(all->node[k].v, s->velocity[all->node[k].number], sizeof all->node[k].v);
    return MPS_OK;
  }
  int64_t *word = all->word_room.item;
  memset(word, 0, (size_t)(3 * all->slots) * sizeof *word);
  for (int64_t k = 0; k < all->nodes; k++)
    if (all->node[k].counted)
      memcpy(word + 3 * all->node[k].slot, s->velocity[all->node[k].number], 3 * sizeof *word);
  const mps_status status = share(mpm, function, 3 * all->slots, word);
  for (int64_t k = 0; k < all->nodes; k++) {
    memset(all->node[k].v, 0, sizeof all->node[k].v);
    if (all->node[k].slot >= 0)
      memcpy(all->node[k].v, word + 3 * all->node[k].slot, 3 * sizeof *word);
  }
  return status;
}

/* One Gauss-Seidel update: the contact's own motion is taken away. */
static void stop(mpsi_pore_contacts *all, mpsi_pore_contact *c) {
  double v[3] = {0.0}, by[3];
  for (int64_t e = c->first; e < c->first + c->entries; e++)
    for (int a = 0; a < 3; a++) v[a] += all->entry[e].psi[a] * all->node[all->entry[e].node].v[a];
  mpsi_impulse_body *body = &all->mover[c->body].by;
  double surface[3];
  mpsi_impulse_surface(body, c->at, surface);
  for (int a = 0; a < 3; a++) v[a] -= surface[a];
  const double across = mpsi_dot3(v, c->normal);
  for (int a = 0; a < 3; a++) {
    by[a] = c->yield[a] * (c->sticks ? v[a] : across * c->normal[a]);
    c->left[a] += by[a];
  }
  for (int64_t e = c->first; e < c->first + c->entries; e++) {
    mpsi_pore_contact_node *node = &all->node[all->entry[e].node];
    for (int a = 0; a < 3; a++) node->v[a] -= all->entry[e].psi[a] * by[a] / node->mass;
  }
  const double back[3] = {-by[0], -by[1], -by[2]};
  if (body->free) mpsi_impulse_kick(body, c->at, back);
}

/* A vector x' after a sweep, from those before it: omega (by (x' - x_k) + x_k - x_k-1) + x_k-1. */
static void extrapolate(double *x, const double *now, const double *past, double by, double omega) {
  for (int a = 0; a < 3; a++) x[a] = omega * (by * (x[a] - now[a]) + now[a] - past[a]) + past[a];
}

static void keep(mpsi_pore_contacts *all) {
  for (int64_t k = 0; k < all->count; k++)
    memcpy(all->contact[k].now, all->contact[k].left, sizeof all->contact[k].now);
  for (int64_t k = 0; k < all->nodes; k++)
    memcpy(all->node[k].now, all->node[k].v, sizeof all->node[k].now);
  for (int32_t b = 0; b < all->movers; b++) {
    memcpy(all->mover[b].now[0], all->mover[b].by.v, sizeof all->mover[b].now[0]);
    memcpy(all->mover[b].now[1], all->mover[b].by.spin, sizeof all->mover[b].now[1]);
  }
}

/* Each contact in turn, and back. */
static void sweep_once(mpsi_pore_contacts *all) {
  for (int64_t k = 0; k < all->count; k++) stop(all, &all->contact[k]);
  for (int64_t k = all->count - 1; k >= 0; k--) stop(all, &all->contact[k]);
}

/* Symmetric sweeps, extrapolated by Chebyshev's polynomial of [LEAST_TAKEN, 1]. */
static void run_cycle(mpsi_pore_contacts *all) {
  const double by = 2.0 / (1.0 + LEAST_TAKEN), rho = (1.0 - LEAST_TAKEN) / (1.0 + LEAST_TAKEN);
  double omega = 1.0;
  for (int sweep = 0; sweep < SWEEPS; sweep++) {
    keep(all);
    sweep_once(all);
    if (sweep > 0) omega = 1.0 / (1.0 - (sweep == 1 ? 0.5 : 0.25) * rho * rho * omega);
    for (int64_t k = 0; k < all->count; k++) {
      mpsi_pore_contact *c = &all->contact[k];
      extrapolate(c->left, c->now, sweep > 0 ? c->past : c->now, by, omega);
      memcpy(c->past, c->now, sizeof c->past);
    }
    for (int64_t k = 0; k < all->nodes; k++) {
      mpsi_pore_contact_node *node = &all->node[k];
      extrapolate(node->v, node->now, sweep > 0 ? node->past : node->now, by, omega);
      memcpy(node->past, node->now, sizeof node->past);
    }
    for (int32_t b = 0; b < all->movers; b++) {
      mpsi_pore_mover *m = &all->mover[b];
      extrapolate(m->by.v, m->now[0], sweep > 0 ? m->past[0] : m->now[0], by, omega);
      extrapolate(m->by.spin, m->now[1], sweep > 0 ? m->past[1] : m->now[1], by, omega);
      memcpy(m->past, m->now, sizeof m->past);
    }
  }
}

mps_status mpsi_pore_hold_contacts(mps_mpm *mpm, const char *function) {
  mpsi_pore_system *s = mpm->water->system;
  mpsi_pore_contacts *all = &s->contacts;
  if (!all->any) return MPS_OK;
  MPSI_TRY(take_velocities(mpm, function, all));
  for (int64_t k = 0; k < all->count; k++)
    memset(all->contact[k].left, 0, sizeof all->contact[k].left);
  for (int32_t b = 0; b < all->movers; b++) {
    memset(all->mover[b].by.v, 0, sizeof all->mover[b].by.v);
    memset(all->mover[b].by.spin, 0, sizeof all->mover[b].by.spin);
  }
  for (int cycle = 0; cycle < CYCLES; cycle++) run_cycle(all);
  for (int64_t k = 0; k < all->nodes; k++)
    if (all->node[k].number >= 0)
      memcpy(s->velocity[all->node[k].number], all->node[k].v, sizeof all->node[k].v);
  return MPS_OK;
}

void mpsi_pore_bear_contacts(mps_mpm *mpm) {
  const mpsi_pore_contacts *all = &mpm->water->system->contacts;
  for (int64_t k = 0; k < all->count; k++) {
    mpsi_impulse *c = &mpm->contact.impulses.constraint[all->contact[k].constraint].impulse;
    double by[3];
    for (int a = 0; a < 3; a++) by[a] = -mpm->run.dt * all->contact[k].left[a];
    const double across = mpsi_dot3(by, c->normal);
    c->normal_impulse = fmax(0.0, c->normal_impulse + across);
    for (int a = 0; a < 3; a++) c->tangent_impulse[a] += by[a] - across * c->normal[a];
  }
}
