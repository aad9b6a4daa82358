/* contacts.c - the contacts of a solver with bodies: adding, querying and ending them. What they do
 * in a step: pairs.c, inside.c, constraints.c, impulses.c, penalty.c.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "particle.h"
#include "mpm/base/run.h"
#include "mpm/ranks/partition.h"

#include "core/particles/particles_internal.h"

#include <string.h>

#define OVERLAP 0.1 /* cells: most that two bodies may overlap */
#define SHARP 1e-3  /* cells: a thinner wall is the edge of two faces */

/* ---- checks ---------------------------------------------------------------------------------- */

static mps_status check_body(mps_context *context, const mpsi_grid *grid,
                             const mpsi_contacts *contacts, const char *function,
                             const mps_body *body) {
  if (!body) return mpsi_fail(context, function, MPS_ERROR_ARGUMENT, "body is NULL");
  if (body->context != context)
    return mpsi_fail(context, function, MPS_ERROR_ARGUMENT,
                     "the body was made from another context");
  if (body->dim != grid->dim)
    return mpsi_fail(context, function, MPS_ERROR_ARGUMENT, "the body is %dD, the solver %dD",
                     body->dim, grid->dim);
  for (int32_t b = 0; b < contacts->bodies; b++)
    if (contacts->body[b] == body)
      return mpsi_fail(context, function, MPS_ERROR_STATE,
                       "the solver is in contact with the body already (contact %d)", b);
  return MPS_OK;
}

/* A body on the axis of one solver has nothing to do with a plane one. */
static mps_status check_geometry(mps_context *context, const mpsi_grid *grid, const char *function,
                                 const mps_body *body) {
  const bool axial = grid->geometry == MPS_MPM_GEOMETRY_AXISYMMETRIC;
  if (body->sources && axial != body->axial)
    return mpsi_fail(context, function, MPS_ERROR_ARGUMENT,
                     "the body is in contact with another solver, which is %saxisymmetric: make "
                     "a body for each",
                     axial ? "not " : "");
  if (!axial || body->def.motion != MPS_BODY_MOTION_FREE) return MPS_OK;
  if (body->load.force[0] != 0.0 || body->load.moment[2] != 0.0)
    return mpsi_fail(context, function, MPS_ERROR_ARGUMENT,
                     "the load on the body has force[0] %g N and moment[2] %g N m: a free body in "
                     "axisymmetry moves along its axis alone, they must be 0",
                     body->load.force[0], body->load.moment[2]);
  return mpsi_body_check_axial(context, function, body->pose.v, body->pose.spin, body->def.gravity);
}

/* Half spaces may overlap, as a floor and a wall do. */
static bool overlap(const mpsi_grid *grid, const mps_body *a, const mps_body *b) {
  return (a->shape != MPSI_HALF || b->shape != MPSI_HALF) &&
         mpsi_body_overlap(a, b, OVERLAP * grid->cell);
}

/* Refuses overlapping bodies. */
static mps_status check_overlap(mps_context *context, const mpsi_grid *grid,
                                const mpsi_contacts *contacts, const char *function,
                                const mps_body *body) {
  for (int32_t b = 0; b < contacts->bodies && contacts->body[b] != body; b++) {
    if (!overlap(grid, contacts->body[b], body)) continue;
    return mpsi_fail(context, function, MPS_ERROR_ARGUMENT,
                     "body: it overlaps body %d of the solver by more than %g m (%g cells)", b,
                     OVERLAP * grid->cell, OVERLAP);
  }
  return MPS_OK;
}

static bool moves(const mps_body *body) {
  return mpsi_dot3(body->pose.v, body->pose.v) > 0.0 ||
         mpsi_dot3(body->pose.spin, body->pose.spin) > 0.0;
}

void mpsi_mpm_warn_about_overlaps(mps_context *context, const mpsi_grid *grid,
                                  const mpsi_contacts *contacts, int64_t steps) {
  for (int32_t b = 1; b < contacts->bodies; b++) {
    for (int32_t a = 0; a < b; a++) {
      const mps_body *one = contacts->body[a], *other = contacts->body[b];
      if (contacts->state[b].overlaps || !(moves(one) || moves(other)) ||
          !overlap(grid, one, other))
        continue;
      contacts->state[b].overlaps = true;
      mpsi_log(context, MPS_CONTEXT_LOG_WARNING,
               "step %lld: bodies %d and %d overlap by more than %g m (%g cells): bodies pass "
               "through one another, their contact is with particles alone",
               (long long)steps, a, b, OVERLAP * grid->cell, OVERLAP);
    }
  }
}

mps_status mpsi_mpm_check_overlaps(mps_context *context, const mpsi_grid *grid,
                                   const mpsi_contacts *contacts, const char *function) {
  for (int32_t b = 1; b < contacts->bodies; b++)
    MPSI_TRY(check_overlap(context, grid, contacts, function, contacts->body[b]));
  return MPS_OK;
}

/* Contact by impulses separates the sides of a thin wall (thin_bodies.h), penalty contact does
 * not. */
static mps_status check_thickness(mps_context *context, const mpsi_grid *grid,
                                  const mpsi_contacts *contacts, const char *function,
                                  mps_contact *contact) {
  const double wall = mpsi_body_thickness(contact->body), cells = wall * grid->inverse;
  contact->thin = cells < MPSI_THIN_CELLS * (1.0 - 1e-9);
  contact->convex = mpsi_body_is_convex(contact->body);
  if (!contact->thin || mpsi_by_impulses(contact)) return MPS_OK;
  if (!contact->def.thin && cells < SHARP)
    return mpsi_fail(context, function, MPS_ERROR_ARGUMENT,
                     "two faces of the body meet at less than 20 degrees: momentum passes through "
                     "such an edge where it is thinner than %g cells; blunt it, or allow it with "
                     "thin = 1",
                     MPSI_THIN_CELLS);
  if (!contact->def.thin)
    return mpsi_fail(context, function, MPS_ERROR_ARGUMENT,
                     "the body has a wall %.4g m thin, %.3g cells: below %g cells momentum passes "
                     "through it; use a cell of at most %.4g m, a thicker wall, or allow it with "
                     "thin = 1",
                     wall, cells, MPSI_THIN_CELLS, wall / MPSI_THIN_CELLS);
  mpsi_log(context, MPS_CONTEXT_LOG_WARNING,
           "body %d has a wall %.4g m thin, %.3g cells: below %g cells momentum leaks through it",
           contacts->bodies, wall, cells, MPSI_THIN_CELLS);
  return MPS_OK;
}

mps_status mpsi_mpm_check_inside(mps_context *context, const mpsi_grid *grid, const mpsi_columns *p,
                                 const char *function, const mps_contact *contact, int64_t from) {
  int64_t count = 0, first = -1;
  double deepest = 0.0;
  for (int64_t k = from; k < p->count; k++) {
    double x[3] = {0.0};
    for (int c = 0; c < grid->dim; c++) x[c] = p->x[c][k];
    if (!mpsi_body_reaches(contact->body, x, 0.0)) continue;
    const double depth = -mpsi_body_foot(contact->body, x).distance;
    if (!(depth > 0.0)) continue;
    if (first < 0) first = mpsi_particles_integers(p->set, "id")[k];
    deepest = fmax(deepest, depth);
    count++;
  }
  if (count == 0 || contact->def.inside == MPS_CONTACT_INSIDE_PUSH) return MPS_OK;
  const mps_status status = mpsi_fail(context, function, MPS_ERROR_ARGUMENT,
                                      "%lld particles lie inside the body, the first is %lld, the "
                                      "deepest %.4g m below the surface: "
                                      "place it outside, or make inside MPS_CONTACT_INSIDE_PUSH, "
                                      "which pushes them out, or _REMOVE",
                                      (long long)count, (long long)first, deepest);
  mpsi_fail_where(context, -1, first);
  return status;
}

/* Where the faces of the body end for particles. */
static mps_status find_insets(mps_context *context, const mpsi_grid *grid, const char *function,
                              mps_contact *contact) {
  const mps_body *body = contact->body;
  if (!(contact->def.inset > 0.0) || body->shape != MPSI_POLYGON) return MPS_OK;
  contact->inset = mpsi_alloc(context, body->edges, sizeof *contact->inset);
  if (contact->inset) contact->bearer = mpsi_alloc(context, body->edges, sizeof *contact->bearer);
  if (!contact->bearer)
    return mpsi_fail_memory(context, function,
                            (size_t)body->edges *
                                (sizeof *contact->inset + sizeof *contact->bearer));
  mpsi_edge_insets(body, contact->def.inset, grid->geometry == MPS_MPM_GEOMETRY_AXISYMMETRIC,
                   contact->inset);
  return MPS_OK;
}

/* Warns of a spacing of particles for which areas (area.c) are too small on curved surfaces. */
static void warn_of_areas(mps_context *context, const mpsi_grid *grid, const mpsi_columns *p,
                          const mpsi_contacts *contacts, const mps_contact *contact) {
  const double spacing = mps_particles_spacing(p->set);
  if (!mpsi_has_strength(contact) || 2.0 * spacing <= grid->cell * (1.0 + 1e-9)) return;
  mpsi_log(
      context, MPS_CONTEXT_LOG_WARNING,
      "body %d bears shear by strength or adhesion, and the particles' spacing of %.4g m is more "
      "than half a cell, %.4g m: on curved surfaces that is a fifth too little",
      contacts->bodies, spacing, 0.5 * grid->cell);
}

/* Checks that all ranks make the same contact with the same body. */
static mps_status compare_ranks(mpsi_partition *partition, const char *function, mps_status status,
                                const mps_contact *contact) {
  if (!partition) return status;
  mpsi_given given = MPSI_GIVEN;
  if (status == MPS_OK) {
    const mps_contact_def *d = &contact->def;
    MPSI_GIVE(&given, d, mover);
    MPSI_GIVE(&given, d, method);
    MPSI_GIVE(&given, d, sweeps);
    MPSI_GIVE(&given, d, friction);
    mpsi_signal_give(&given, "friction_factor", d->friction_factor);
    MPSI_GIVE(&given, d, penalty);
    MPSI_GIVE(&given, d, xi);
    MPSI_GIVE(&given, d, offset);
    MPSI_GIVE(&given, d, depth);
    MPSI_GIVE(&given, d, thin);
    MPSI_GIVE(&given, d, inside);
    MPSI_GIVE(&given, d, adhesion);
    MPSI_GIVE(&given, d, strength);
    MPSI_GIVE(&given, d, corner);
    MPSI_GIVE(&given, d, tolerance);
    MPSI_GIVE(&given, d, inset);
    mpsi_body_give(&given, contact->body);
  }
  return mpsi_domain_agree_given(partition->domain, function, status, &given);
}

/* ---- queries of a contact -------------------------------------------------------------------- */

/* Empties the lists of pairs, which steps without bodies do not rebuild. */
static void clear_pairs(const mpsi_grid *grid, mpsi_contacts *contacts) {
  contacts->cell_pair_count = contacts->node_pair_count = contacts->mask_count = 0;
  contacts->thin = false;
  for (int64_t b = 0; b < grid->cell_count; b++) grid->cells[b].pairs = 0;
  for (int64_t g = 0; g < grid->node_count; g++) {
    mpsi_node_block *nodes = &grid->nodes[g];
    nodes->near = -1;
    nodes->inside = nodes->thin = false;
    nodes->across = -1;
    nodes->pairs = 0;
  }
}

void mpsi_mpm_end_contact(const mpsi_grid *grid, mpsi_contacts *all, mps_contact *contact) {
  int32_t to = 0, ended = 0;
  for (int32_t b = 0; b < all->bodies; b++) {
    if (all->handle[b] == contact) {
      ended = b;
      continue;
    }
    all->handle[to] = all->handle[b];
    all->body[to] = all->body[b];
    all->state[to++] = all->state[b];
  }
  all->bodies = to;
  mpsi_mpm_forget_impulses(all, ended);
  for (int32_t b = 0; b < to; b++)
    all->state[b].warned = all->state[b].overlaps = all->state[b].leaves = false;
  clear_pairs(grid, all);
  mpsi_contact_leave(contact);
}

/* A particle in contact with a body. */
typedef struct contact_now {
  mpsi_contact_particle c; /* force and depth */
  mpsi_foot foot;          /* nearest point of the surface */
  double half;             /* half size, m, from which the gap counts */
} contact_now;

/* Whether particle k at x is in contact with the body now, by the method of the contact; by
 * impulses: whether the body exerted an impulse on it in the last step. */
static bool is_in_contact(const mpsi_contact_setup *setup, const mps_contact *contact, int32_t body,
                          int64_t k, int64_t id, const double *x, contact_now *now) {
  now->half = contact->def.offset;
  if (!mpsi_by_impulses(contact)) {
    if (!mpsi_body_reaches(contact->body, x, contact->def.offset) ||
        !mpsi_find_contact(setup->grid, setup->p, setup->def, contact, setup->grid->dim, k,
                           &now->c))
      return false;
    now->foot = mpsi_body_foot(contact->body, x);
    return true;
  }
  const mpsi_warm_impulse *warm = mpsi_mpm_warm_impulse(setup->contact, id, body, 0);
  if (!warm) return false;
  for (int a = 0; a < 3; a++) now->c.force[a] = warm->by[a] / setup->contact->impulses.warm_dt;
  const mpsi_bearing bearing = mpsi_mpm_bearing(setup->grid, setup->p, contact, k, x);
  now->foot = bearing.foot;
  now->half = bearing.half;
  return true;
}

mps_status mpsi_mpm_list_in_contact(const mpsi_contact_setup *setup, const mps_contact *contact,
                                    const mpsi_contact_list *out, int64_t *count) {
  const int64_t *id = mpsi_particles_integers(setup->p->set, "id");
  int64_t n = 0;
  int32_t body = 0;
  if (!mpsi_mpm_index_impulses(setup->context, setup->contact))
    return mpsi_fail_memory(setup->context, "mps_contact_get_particles",
                            (size_t)setup->contact->impulses.warm_count * 4 * sizeof(int32_t));
  while (setup->contact->handle[body] != contact) body++;
  for (int64_t k = 0; k < setup->p->count; k++) {
    contact_now now;
    double x[3] = {0.0};
    for (int a = 0; a < setup->grid->dim; a++) x[a] = setup->p->x[a][k];
    if (!is_in_contact(setup, contact, body, k, id[k], x, &now)) continue;
    if (n < out->capacity) {
      if (out->ids) out->ids[n] = id[k];
      if (out->gap) out->gap[n] = now.foot.distance - now.half;
      for (int a = 0; a < 3; a++) {
        if (out->normal) out->normal[3 * n + a] = a < setup->grid->dim ? now.foot.normal[a] : 0.0;
        if (out->force) out->force[3 * n + a] = a < setup->grid->dim ? now.c.force[a] : 0.0;
        if (out->foot) out->foot[3 * n + a] = a < setup->grid->dim ? now.foot.at[a] : 0.0;
      }
    }
    n++;
  }
  *count = n;
  return MPS_OK;
}

/* ---- adding and ending ----------------------------------------------------------------------- */

/* Memory for one more contact. */
static mps_status ensure_contact(mps_context *context, mpsi_contacts *all, const char *function) {
  const int64_t count = (int64_t)all->bodies + 1;
  const bool good = mpsi_room_keep(context, &all->handle_room, count, sizeof(mps_contact *)) &&
                    mpsi_room_keep(context, &all->body_room, count, sizeof(mps_body *)) &&
                    mpsi_room_keep(context, &all->state_room, count, sizeof *all->state);
  all->handle = all->handle_room.item;
  all->body = all->body_room.item;
  all->state = all->state_room.item;
  return good ? MPS_OK : mpsi_fail_memory(context, function, (size_t)count * sizeof *all->state);
}

/* Releases both references to a contact that could not be added. */
static void release_failed(mps_contact *contact) {
  if (!contact) return;
  mpsi_contact_release(contact);
  mpsi_contact_release(contact);
}

mps_status mpsi_mpm_add_contact(const mpsi_contact_setup *setup, const char *function,
                                const mpsi_contact_owner *owner, void *self, mps_body *body,
                                const mps_contact_def *def, mps_contact **out) {
  mps_contact *contact = NULL;
  if (out) *out = NULL;
  mps_status status = mpsi_mpm_between_steps(setup->context, setup->run, function);
  if (status == MPS_OK) status = mpsi_particles_ready(setup->p->set, function);
  if (status == MPS_OK)
    status = check_body(setup->context, setup->grid, setup->contact, function, body);
  if (status == MPS_OK) status = check_geometry(setup->context, setup->grid, function, body);
  if (status == MPS_OK && setup->run->begun)
    status = check_overlap(setup->context, setup->grid, setup->contact, function, body);
  if (status == MPS_OK)
    status = mpsi_contact_new(setup->context, function, body, def, owner, self, &contact);
  if (status == MPS_OK) status = find_insets(setup->context, setup->grid, function, contact);
  if (status == MPS_OK) status = ensure_contact(setup->context, setup->contact, function);
  if (status == MPS_OK && setup->partition)
    status = mpsi_mpm_begin_partners(&setup->contact->partners, setup->partition->domain, function);
  status = compare_ranks(setup->partition, function, status, contact);
  if (status != MPS_OK) {
    release_failed(contact);
    return status;
  }
  mps_contact_def *d = &contact->def;
  if (isnan(d->offset)) d->offset = 0.5 * mps_particles_spacing(setup->p->set);
  if (isnan(d->depth))
    d->depth = d->inside == MPS_CONTACT_INSIDE_PUSH     ? INFINITY
               : d->inside == MPS_CONTACT_INSIDE_REMOVE ? 0.5 * mps_particles_spacing(setup->p->set)
                                                        : setup->grid->cell;
  status = check_thickness(setup->context, setup->grid, setup->contact, function, contact);
  if (status == MPS_OK && d->inside == MPS_CONTACT_INSIDE_REMOVE)
    status = mpsi_mpm_clear_body(setup, function, contact);
  else if (status == MPS_OK && setup->run->begun)
    status = mpsi_mpm_agree(
        setup->partition, function,
        mpsi_mpm_check_inside(setup->context, setup->grid, setup->p, function, contact, 0));
  if (status != MPS_OK) {
    release_failed(contact);
    return status;
  }
  /* before the first step the bodies may be placed for particles that are restored */
  if (!setup->run->begun) setup->run->unchecked = true;
  warn_of_areas(setup->context, setup->grid, setup->p, setup->contact, contact);
  mpsi_contact_join(contact);
  body->axial = setup->grid->geometry == MPS_MPM_GEOMETRY_AXISYMMETRIC;
  setup->contact->state[setup->contact->bodies] =
      (mpsi_contact_state){.first_step = setup->run->steps};
  setup->contact->handle[setup->contact->bodies] = contact;
  setup->contact->body[setup->contact->bodies++] = body;
  if (out)
    *out = contact;
  else
    mpsi_contact_release(contact);
  return MPS_OK;
}

void mpsi_mpm_end_contacts(mpsi_contacts *contacts) {
  for (int32_t b = 0; b < contacts->bodies; b++) mpsi_contact_leave(contacts->handle[b]);
  contacts->bodies = 0;
}

mps_status mpsi_mpm_check_depth(mps_context *context, const mpsi_columns *p,
                                const mpsi_contacts *contacts, const mpsi_run *run,
                                const char *function) {
  for (int64_t k = 0; k < contacts->cell_pair_count; k++) {
    const mpsi_cell_pair *pair = &contacts->cell_pair[k];
    const double most = contacts->handle[pair->body]->def.depth;
    if (!pair->in_contact || !(pair->deepest > most) ||
        contacts->handle[pair->body]->def.inside == MPS_CONTACT_INSIDE_REMOVE)
      continue;
    const int64_t id = mpsi_particles_integers(p->set, "id")[pair->deep];
    const mps_status status = mpsi_fail(
        context, function, MPS_ERROR_DIVERGED,
        "step %lld, t = %.6g s: particle %lld is %.4g m below the surface of body %d, at most %.4g "
        "m is allowed (`depth` of the contact): the body moves too fast or against material that "
        "cannot yield, or the contact is too soft",
        (long long)run->steps, run->time, (long long)id, pair->deepest, pair->body, most);
    mpsi_fail_where(context, run->steps, id);
    return status;
  }
  return MPS_OK;
}
