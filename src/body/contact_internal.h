/* contact_internal.h - the contact of one solver with one body: the caller's handle, and its
 * interface for solvers. SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include "body_internal.h"
#include "signal/signal_internal.h"

/* Arrays of mps_contact_get_particles, with room for `capacity` particles; NULL: not wanted. */
typedef struct mpsi_contact_list {
  int64_t capacity;
  int64_t *ids;
  double *gap, *normal, *force, *foot;
} mpsi_contact_list;

/* Functions of a kind of solver for the handles of its contacts. */
typedef struct mpsi_contact_owner {
  /* MPS_ERROR_STATE where the contact cannot end now. */
  mps_status (*check)(void *owner, const char *function);
  /* The solver removes the contact, and releases its reference by mpsi_contact_leave. */
  void (*end)(void *owner, mps_contact *contact);
  /* Lists the particles in contact with the body; `count`: all of them, whatever the capacity. */
  mps_status (*particles)(void *owner, mps_contact *contact, const mpsi_contact_list *out,
                          int64_t *count);
  /* Writes the reaction by one part of the body; NULL: that of `source` is this. */
  void (*reaction)(const void *owner, const mps_contact *contact, int32_t part, mps_reaction *out);
  /* Its kind of definition, MPS_DEF_...; NULL: `def` of the contact is that. */
  int32_t def_kind;
  void (*get_def)(const void *owner, const mps_contact *contact, void *def);
} mpsi_contact_owner;

/* The particle that bears at an inset edge (contact/edge.h), as if the edge were a point of it. */
typedef struct mpsi_edge_bearer {
  int64_t id;   /* -1: no particle is near */
  double apart; /* m, along the face */
  int64_t warm; /* index of the impulse of the last step at that edge, on this particle or another;
                   -1: none is known here */
} mpsi_edge_bearer;

struct mps_contact {
  mps_context *context;
  int32_t references;  /* the solver, and the caller's handle; one thread at a time: no atomics */
  mps_contact_def def; /* friction_factor: a share in the signal */
  double friction;     /* mu in the step being made: mpsi_contact_set_friction */
  mps_body *body;
  double extent;      /* m: see mpsi_body_extent */
  bool thin;          /* the solver separates both sides of a thin wall */
  bool convex;        /* whether the body is known to be */
  int32_t parts;      /* of the body's surface, in the step being made */
  double (*inset)[2]; /* m, of each edge of a polygon at both of its ends: contact/edge.h. NULL:
                         faces end at their edges */
  mpsi_edge_bearer (*bearer)[2]; /* likewise, in the step being made */
  const mpsi_contact_owner *kind;
  void *owner; /* the solver; NULL: the contact has ended */
  mpsi_body_source source;
};

/* The bearer of the inset edge `point` (mpsi_inset_edge); NULL: there is no such edge. */
static inline mpsi_edge_bearer *mpsi_edge_bearer_of(const mps_contact *contact, int32_t point) {
  if (!contact->inset || point < 1 || point > 2 * contact->body->edges) return NULL;
  return &contact->bearer[(point - 1) / 2][(point - 1) % 2];
}

/* A contact of two references (the solver's and the caller's), not yet a source of the body; checks
 * `def`, NULL means the defaults. */
mps_status mpsi_contact_new(mps_context *context, const char *function, mps_body *body,
                            const mps_contact_def *def, const mpsi_contact_owner *kind, void *owner,
                            mps_contact **out);
/* The same without a definition of WLS-MPM. */
mps_status mpsi_contact_make(mps_context *context, const char *function, mps_body *body,
                             const mpsi_contact_owner *kind, void *owner, mps_contact **out);
/* Makes it a source of the body. */
void mpsi_contact_join(mps_contact *contact);
/* Releases the solver's reference; the contact ends. */
void mpsi_contact_leave(mps_contact *contact);
/* Releases one reference; the last frees. */
void mpsi_contact_release(mps_contact *contact);

/* The part that a face belongs to. One that a callback has named within the step is part 0 there.
 */
static inline int32_t mpsi_contact_part(const mps_contact *contact, int64_t face) {
  const int32_t part = contact->body->part_of[face];
  return part < contact->parts ? part : 0;
}

/* Adds the forces of a step of dt, in source.part, to the body; advances the body where this solver
 * moves it and `moves` is true. */
void mpsi_contact_react(mps_contact *contact, double dt, bool moves);

/* Contact stiffness k (N/m, 2D per m of thickness) of Nakamura (28) or (58) against particles of
 * `modulus` K + 4G/3 (Pa) and `spacing` (m) in cells of size `cell` (m). In axisymmetry the caller
 * multiplies by the radius. */
double mpsi_contact_penalty(const mps_contact *contact, double modulus, double spacing, double cell,
                            double courant);

/* Of a step that begins at t (s): mu with its factor in time. `number`: of the contact, for
 * records.
 */
mps_status mpsi_contact_set_friction(mps_contact *contact, const char *function, int32_t number,
                                     double t);

/* Largest speed (m/s) of the body's surface. */
double mpsi_contact_speed(const mps_contact *contact);

void mpsi_contact_list_state(mpsi_state *state, mps_contact *contact);
