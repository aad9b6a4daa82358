/* bodies.c - rigid bodies in the fluid: convex polygons whose edges are walls of finite length
 * (faces). A face has two nodes, its corners: the velocity of a rigid body along a straight edge's
 * normal is linear between them. The caller moves the body between steps; the fluid keeps its pose
 * at the last step, and uses the present one as that of the end of the next.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "bodies.h"
#include "fluid/base/access.h"
#include "fluid/boundary/slots.h"
#include "fluid/boundary/clearance.h"
#include "fluid/boundary/pose.h"
#include "fluid/ranks/partition.h"
#include "signal/signal_internal.h"

#include "body/contact_internal.h"

#include <string.h>

#define LEAST_BODY 0.3 /* l0: distance of a particle from a face */

static mpsi_fluid_pose pose_of(const mps_body *body) {
  const mpsi_pose *p = &body->pose;
  return (mpsi_fluid_pose){.x = {p->x[0], p->x[1]},
                           .R = {p->R[0], p->R[1], p->R[3], p->R[4]},
                           .v = {p->v[0], p->v[1]},
                           .spin = p->spin[2]};
}

/* Velocity of a body's point at x. */
static void velocity_at(const mpsi_fluid_pose *pose, const double *x, double *v) {
  v[0] = pose->v[0] - pose->spin * (x[1] - pose->x[1]);
  v[1] = pose->v[1] + pose->spin * (x[0] - pose->x[0]);
}

/* ---- places ---------------------------------------------------------------------------------- */

bool mpsi_fluid_stands_on(const mps_fluid *f, const mpsi_fluid_wall *face, int end, int b) {
  const mpsi_fluid_wall *w = &f->wall[b];
  const double *x = end ? face->tip : face->at;
  return w->used && mpsi_fluid_distance(w, w->now.s, x[0], x[1]) < MPSI_FLUID_FLUSH * f->l0;
}

/* Where an end stands on a boundary the face extends behind it; one that stands there with both
 * ends is no wall. */
static void extend(const mps_fluid *f, mpsi_fluid_wall *w) {
  bool on[2] = {false, false}, flat = false;
  for (int b = 0; b < f->boundaries; b++) {
    const bool here[2] = {mpsi_fluid_stands_on(f, w, 0, b), mpsi_fluid_stands_on(f, w, 1, b)};
    on[0] |= here[0], on[1] |= here[1], flat |= here[0] && here[1];
  }
  w->from = on[0] ? -INFINITY : 0.0;
  w->to = on[1] ? (double)INFINITY : w->length;
  w->used = !flat;
}

static void find_box(const mps_fluid *f, mpsi_fluid_body *body) {
  for (int c = 0; c < 2; c++) body->low[c] = INFINITY, body->high[c] = -INFINITY;
  for (int k = 0; k < body->faces; k++) {
    const mpsi_fluid_wall *w = &f->wall[body->first + k];
    const bool open = w->from < 0.0 || w->to > w->length;
    for (int c = 0; c < 2; c++) {
      body->low[c] = open ? -INFINITY : fmin(body->low[c], w->at[c]);
      body->high[c] = open ? (double)INFINITY : fmax(body->high[c], w->at[c]);
    }
    if (open) return;
  }
}

/* Places the faces at the pose. */
static void place_faces(mps_fluid *f, mpsi_fluid_body *body) {
  for (int k = 0; k < body->faces; k++) {
    mpsi_fluid_wall *w = &f->wall[body->first + k];
    double end[2][2], v[2];
    mpsi_fluid_corner_at(body->body, &body->pose, k, end[0]);
    mpsi_fluid_corner_at(body->body, &body->pose, k + 1, end[1]);
    const double d[2] = {end[1][0] - end[0][0], end[1][1] - end[0][1]}, length = hypot(d[0], d[1]);
    w->normal[0] = d[1] / length, w->normal[1] = -d[0] / length;
    w->node[0] = 0.0, w->node[1] = w->length = length;
    for (int c = 0; c < 2; c++) w->at[c] = end[0][c], w->tip[c] = end[1][c];
    for (int n = 0; n < 2; n++) {
      velocity_at(&body->pose, end[n], v);
      w->now.s[n] = 0.0;
      w->now.u[n] = v[0] * w->normal[0] + v[1] * w->normal[1];
    }
    extend(f, w);
  }
  find_box(f, body);
}

void mpsi_fluid_place_bodies(mps_fluid *f) {
  for (int k = 0; k < f->bodies; k++)
    if (f->body[k].body) place_faces(f, &f->body[k]);
}

/* m: half its circumference over pi. */
double mpsi_fluid_body_length(const mpsi_fluid_body *body, const mps_fluid *f) {
  double sum = 0.0;
  for (int k = 0; k < body->faces; k++) sum += f->wall[body->first + k].length;
  return sum / 6.283185307179586;
}

/* Pose of the body at the end of a step with the accelerations `rate`. */
static void drift(const mps_fluid *f, mpsi_fluid_body *body, double dt) {
  const mps_body_def *def = &body->body->def;
  mpsi_fluid_pose *p = &body->next;
  for (int c = 0; c < 2; c++) {
    p->v[c] = (p->v[c] + dt * body->rate[c]) / (1.0 + dt * def->damping[0]);
    p->x[c] += dt * p->v[c];
  }
  p->spin = (p->spin + dt * body->rate[2] / mpsi_fluid_body_length(body, f)) /
            (1.0 + dt * def->damping[1]);
  const double angle = dt * p->spin, C = cos(angle), S = sin(angle);
  const double R[4] = {p->R[0], p->R[1], p->R[2], p->R[3]};
  for (int c = 0; c < 2; c++)
    p->R[c] = C * R[c] - S * R[2 + c], p->R[2 + c] = S * R[c] + C * R[2 + c];
}

/* Whether the fluid moves the body along its signals. */
static bool is_driven(const mpsi_fluid_body *own) { return own->source->moves && !own->floats; }

mps_status mpsi_fluid_look_ahead_of_bodies(mps_fluid *f, const char *function, double dt) {
  mps_status status = MPS_OK;
  for (int b = 0; b < f->bodies && status == MPS_OK; b++)
    if (f->body[b].body && is_driven(&f->body[b]))
      status = mpsi_body_look_ahead(f->body[b].body, function, b, dt);
  return status;
}

/* Motion of the faces in the step being made. */
void mpsi_fluid_drive_bodies(mps_fluid *f, double dt) {
  for (int b = 0; b < f->bodies; b++) {
    mpsi_fluid_body *body = &f->body[b];
    if (!body->body) continue;
    mps_body end = *body->body;
    if (is_driven(body)) mpsi_body_advance(&end, dt);
    body->next = pose_of(&end);
    if (body->floats) drift(f, body, dt);
    for (int k = 0; k < body->faces; k++) {
      mpsi_fluid_wall *w = &f->wall[body->first + k];
      for (int n = 0; n < 2; n++) {
        double from[2], to[2], v[2];
        mpsi_fluid_corner_at(body->body, &body->pose, k + n, from);
        mpsi_fluid_corner_at(body->body, &body->next, k + n, to);
        velocity_at(&body->next, to, v);
        w->next.s[n] = (to[0] - from[0]) * w->normal[0] + (to[1] - from[1]) * w->normal[1];
        w->next.u[n] = v[0] * w->normal[0] + v[1] * w->normal[1];
        w->next.a[n] = (w->next.u[n] - w->now.u[n]) / dt;
        w->mean[n] = w->next.s[n] / dt;
      }
    }
  }
}

/* Forces of the water on a body whose reference point is at `about`, by parts. */
void mpsi_fluid_load_body(const mps_fluid *f, mpsi_fluid_body *own, const double *about) {
  const mps_body *body = own->body;
  mpsi_part_load *by = own->source->part;
  for (int32_t part = 0; part < body->parts; part++)
    by[part].force = (mpsi_load){{0.0}, {0.0}}, by[part].count = 0;
  for (int k = 0; k < own->faces; k++) {
    const mpsi_fluid_wall *w = &f->wall[own->first + k];
    if (!w->used) continue;
    const int32_t part = body->part_of[body->face_of[k]];
    const double *force = w->load.force;
    for (int c = 0; c < 2; c++) by[part].force.force[c] -= force[c];
    by[part].force.moment[2] -= w->load.moment - (about[0] * force[1] - about[1] * force[0]);
    by[part].count += w->load.wetted;
  }
}

/* Adds the impulses (N s) of collisions and smoothing on the body in the step to those of its
 * parts, about `about`; on a floating one those of friction too, which are not in the forces that
 * its accelerations balance. */
static void add_struck(const mps_fluid *f, mpsi_fluid_body *own, const double *about) {
  const mps_body *body = own->body;
  for (int k = 0; k < own->faces; k++) {
    const mpsi_fluid_wall *w = &f->wall[own->first + k];
    if (!w->used) continue;
    mpsi_load *to = &own->source->part[body->part_of[body->face_of[k]]].impulse;
    const double moment = w->struck.moment + (own->floats ? w->sheared.moment : 0.0);
    double of[2];
    for (int c = 0; c < 2; c++) {
      of[c] = w->struck.impulse[c] + (own->floats ? w->sheared.impulse[c] : 0.0);
      to->force[c] -= of[c];
    }
    to->moment[2] -= moment - (about[0] * of[1] - about[1] * of[0]);
  }
}

/* Applies the step's forces to the body: to a floating one those in balance with its accelerations.
 * The other impulses act in its next step, where the water around it takes part: otherwise a light
 * body would be unstable. */
static void end_body(mps_fluid *f, mpsi_fluid_body *own) {
  if (!own->floats) mpsi_fluid_load_body(f, own, own->next.x);
  mpsi_body_react(own->body, own->source, f->dt);
  mpsi_body_strike(own->body, own->source);
  add_struck(f, own, own->next.x);
  if (!own->floats) mpsi_body_strike(own->body, own->source);
  if (own->source->moves) mpsi_body_advance(own->body, f->dt);
  own->pose = own->floats ? pose_of(own->body) : own->next;
}

void mpsi_fluid_end_bodies(mps_fluid *f) {
  for (int b = 0; b < f->bodies; b++) {
    mpsi_fluid_body *body = &f->body[b];
    if (!body->body) continue;
    end_body(f, body);
    for (int k = 0; k < body->faces; k++) {
      mpsi_fluid_wall *w = &f->wall[body->first + k];
      for (int n = 0; n < 2; n++) w->now.a[n] = w->next.a[n];
    }
  }
  mpsi_fluid_place_bodies(f);
}

int mpsi_fluid_face_of(const mps_fluid *f, const mpsi_fluid_body *body, bool moved, const double *x,
                       double *distance) {
  int face = 0;
  *distance = -INFINITY;
  for (int k = 0; k < body->faces; k++) {
    const mpsi_fluid_wall *w = &f->wall[body->first + k];
    const double d = mpsi_fluid_distance(w, moved ? w->next.s : w->now.s, x[0], x[1]);
    if (d > *distance) *distance = d, face = body->first + k;
  }
  return face;
}

bool mpsi_fluid_inside_body(const mps_fluid *f, int besides, const double *x) {
  for (int b = 0; b < f->bodies; b++) {
    double d; /* the box is that of the beginning of the step */
    if (b + 1 == besides || !mpsi_fluid_beside(&f->body[b], x, 2.0 * f->reach)) continue;
    mpsi_fluid_face_of(f, &f->body[b], f->stage == MPSI_FLUID_MOVED, x, &d);
    if (d < 0.0) return true;
  }
  return false;
}

/* ---- the caller's bodies --------------------------------------------------------------------- */

static mps_status check_body(mps_fluid *f, const char *function, const mps_body *body) {
  if (!body) return mpsi_fail(f->context, function, MPS_ERROR_ARGUMENT, "body is NULL");
  for (int b = 0; b < f->bodies; b++)
    if (f->body[b].body == body)
      return mpsi_fail(f->context, function, MPS_ERROR_STATE,
                       "the fluid is in contact with the body already");
  if (body->context != f->context)
    return mpsi_fail(f->context, function, MPS_ERROR_ARGUMENT,
                     "the body was made from another context");
  if (body->dim != 2 || body->shape != MPSI_POLYGON)
    return mpsi_fail(f->context, function, MPS_ERROR_ARGUMENT,
                     "body is a disc, a half-plane or in space, must be a polygon of the plane "
                     "(mps_body_create_polygon, _box)");
  if (body->axial)
    return mpsi_fail(f->context, function, MPS_ERROR_ARGUMENT,
                     "the body is in contact with another solver, which is axisymmetric: make a "
                     "body for each");
  for (int64_t k = 0; k < body->edges; k++) {
    const double *a = body->xy + 2 * k, *b = a + 2;
    const double *c = k + 1 < body->edges ? b + 2 : body->xy + 2;
    const double turn = (b[0] - a[0]) * (c[1] - b[1]) - (b[1] - a[1]) * (c[0] - b[0]);
    if (!(turn > 0.0) || !(hypot(b[0] - a[0], b[1] - a[1]) >= f->l0))
      return mpsi_fail(f->context, function, MPS_ERROR_ARGUMENT,
                       "edge %lld of the body is shorter than l0 = %g m, or its end is no convex "
                       "corner",
                       (long long)k, f->l0);
  }
  return MPS_OK;
}

double mpsi_fluid_angle(const mps_fluid *f, const mpsi_fluid_wall *face, int b) {
  const double *n = f->wall[b].normal;
  if (!face->used || !(mpsi_fluid_stands_on(f, face, 0, b) || mpsi_fluid_stands_on(f, face, 1, b)))
    return 180.0;
  const double cosine = -(face->normal[0] * n[0] + face->normal[1] * n[1]);
  return acos(fmax(fmin(cosine, 1.0), -1.0)) * (180.0 / 3.141592653589793);
}

static mps_status check_angles(mps_fluid *f, const char *function, const mpsi_fluid_body *body) {
  for (int k = 0; k < body->faces; k++)
    for (int b = 0; b < f->boundaries; b++) {
      const double angle = mpsi_fluid_angle(f, &f->wall[body->first + k], b);
      if (angle < MPSI_FLUID_LEAST_ANGLE - 1e-6)
        return mpsi_fail(f->context, function, MPS_ERROR_ARGUMENT,
                         "edge %d of the body and boundary %d enclose %g degrees of fluid, allowed "
                         "are %g and more",
                         k, b, angle, MPSI_FLUID_LEAST_ANGLE);
    }
  return MPS_OK;
}

static mps_status check_place(mps_fluid *f, const char *function, const mpsi_fluid_body *body) {
  const double *x = mpsi_particles_column(f->particles, "position", 0);
  const double *y = mpsi_particles_column(f->particles, "position", 1);
  for (int64_t i = 0; i < f->count; i++) {
    double d;
    const double at[2] = {x[i], y[i]};
    mpsi_fluid_face_of(f, body, false, at, &d);
    if (d < LEAST_BODY * f->l0)
      return mpsi_fail(f->context, function, MPS_ERROR_ARGUMENT,
                       "particle %lld at (%g, %g) m is %g m from the body, must be at least %g l0 "
                       "= %g m",
                       (long long)mpsi_particles_integers(f->particles, "id")[i], x[i], y[i], d,
                       LEAST_BODY, LEAST_BODY * f->l0);
  }
  return MPS_OK;
}

/* What the fluid exerts on a part of the body: pressures of its faces, and impulses that it has
 * felt or is owed. */
static void find_reaction(const mpsi_fluid_body *own, const mps_fluid *f, int32_t part,
                          mps_reaction *r) {
  const mps_body *body = own->body;
  const double *at = own->pose.x;
  double sum[2] = {0.0};
  *r = (mps_reaction){.count = 0};
  for (int c = 0; c < 2; c++)
    r->impulse[c] =
        own->source->reaction[part].impulse[c] + own->source->part[part].impulse.force[c];
  for (int k = 0; k < own->faces; k++) {
    const mpsi_fluid_wall *w = &f->wall[own->first + k];
    if (body->part_of[body->face_of[k]] != part) continue;
    for (int c = 0; c < 2; c++) r->force[c] -= w->load.force[c], sum[c] -= w->impulse[c];
    r->moment[2] -= w->load.moment;
    r->moment_impulse[2] -= w->moment_impulse;
    r->work += w->work;
    r->count += w->load.wetted;
  }
  r->moment[2] -= at[0] * r->force[1] - at[1] * r->force[0];
  r->moment_impulse[2] -= at[0] * sum[1] - at[1] * sum[0];
}

void mpsi_fluid_drop_body(mps_fluid *f, mpsi_fluid_body *body) {
  for (int k = 0; k < body->faces; k++) mpsi_fluid_drop_wall(f, &f->wall[body->first + k]);
  if (body->contact) {
    for (int32_t part = 0; part < body->body->parts; part++) { /* the handle still answers it */
      mps_reaction last;
      find_reaction(body, f, part, &last);
      body->source->reaction[part] = last;
    }
    mpsi_contact_leave(body->contact);
  }
  mps_body_destroy(&body->body);
  const int first = body->first, faces = body->faces;
  *body = (mpsi_fluid_body){0};
  mpsi_fluid_drop_slots(f, first, faces);
}

/* Status of all ranks, and a check that all have the same body (NULL: none) of this number. */
static mps_status settle(mps_fluid *f, const char *function, mps_status status, int32_t number,
                         const mps_fluid_contact_def *def, const mps_body *body) {
  if (!f->partition) return status;
  mpsi_given given = MPSI_GIVEN;
  mpsi_give(&given, "number", number);
  MPSI_GIVE_DEF(&given, mps_fluid_contact_def, def);
  if (status == MPS_OK) mpsi_body_give(&given, body);
  return mpsi_domain_agree_given(f->domain, function, status, &given);
}

/* Body number `b` and the walls of its faces. */
static mps_status make_faces(mps_fluid *f, const char *function, mps_contact *contact,
                             const mps_fluid_contact_def *def, int32_t b) {
  mps_body *body = contact->body;
  const int first = mpsi_fluid_make_body(f, b) ? mpsi_fluid_make_faces(f, (int)body->edges) : -1;
  if (first < 0)
    return mpsi_fail_memory(f->context, function, (size_t)body->edges * sizeof *f->wall);
  mpsi_fluid_body *own = &f->body[b];
  mps_status status = MPS_OK;
  body->references++;
  *own = (mpsi_fluid_body){.body = body,
                           .contact = contact,
                           .source = &contact->source,
                           .first = first,
                           .faces = (int)body->edges};
  own->pose = own->next = pose_of(body);
  const double ends[6] = {0.0, 0.0, 0.0, 1.0, 0.0, 0.0}; /* along the normal (0, -1) */
  for (int k = 0; k < own->faces && status == MPS_OK; k++) {
    mpsi_fluid_wall *w = &f->wall[first + k];
    *w = (mpsi_fluid_wall){.of_body = b + 1,
                           .kind = def->kind,
                           .friction = def->friction_factor,
                           .normal = {0.0, -1.0}};
    status = mpsi_fluid_make_motion(f, function, w, 2, ends);
  }
  if (status != MPS_OK) return status;
  place_faces(f, own);
  status = check_angles(f, function, own);
  if (status == MPS_OK) status = mpsi_fluid_check_clearance(f, function, false, b);
  return status == MPS_OK ? check_place(f, function, own) : status;
}

/* ---- the handle ------------------------------------------------------------------------------ */

int32_t mpsi_fluid_body_number(const mps_fluid *f, const mps_contact *contact) {
  for (int32_t b = 0; b < f->bodies; b++)
    if (contact && f->body[b].contact == contact) return b;
  return -1;
}

/* From now on the fluid moves the body: a free one floats, a driven one follows its signals. */
static void take_over(mps_fluid *f, int32_t number) {
  mpsi_fluid_body *own = &f->body[number];
  own->source->moves = true;
  own->floats = own->body->def.motion == MPS_BODY_MOTION_FREE;
  if (own->floats) memset(&own->body->pending, 0, sizeof own->body->pending);
}

static mps_status check_owner(void *owner, const char *function) {
  return mpsi_fluid_free(owner, function);
}

static void drop(mps_fluid *f, mpsi_fluid_body *own) {
  mpsi_fluid_drop_body(f, own);
  f->stale = true, f->unknown = 1;
}

/* A destructor cannot be refused, nor tried again by an owner that runs out of scope: in an open
 * step, whose matrix has the body, that step is the body's last. */
static void end(void *owner, mps_contact *contact) {
  mps_fluid *f = owner;
  mpsi_fluid_body *own = &f->body[mpsi_fluid_body_number(f, contact)];
  if (f->stage == MPSI_FLUID_BETWEEN)
    drop(f, own);
  else
    own->leaves = true;
}

void mpsi_fluid_drop_leaving(mps_fluid *f) {
  for (int b = f->bodies - 1; b >= 0; b--)
    if (f->body[b].leaves) drop(f, &f->body[b]);
}

/* The water presses on faces, not by particles. */
static mps_status list_particles(void *owner, mps_contact *contact, const mpsi_contact_list *out,
                                 int64_t *count) {
  return mpsi_fail(contact->context, "mps_contact_get_particles", MPS_ERROR_UNSUPPORTED,
                   "contact is that of a fluid, whose pressure on a body belongs to no particles: "
                   "mps_contact_get_reaction gives it by parts");
}

static void reaction(const void *owner, const mps_contact *contact, int32_t part,
                     mps_reaction *out) {
  const mps_fluid *f = owner;
  find_reaction(&f->body[mpsi_fluid_body_number(f, contact)], f, part, out);
}

static void get_def(const void *owner, const mps_contact *contact, void *out) {
  const mps_fluid *f = owner;
  const mpsi_fluid_body *body = &f->body[mpsi_fluid_body_number(f, contact)];
  mps_fluid_contact_def *def = out;
  def->kind = f->wall[body->first].kind;
  def->friction_factor = f->wall[body->first].friction;
  def->mover = body->source->moves ? MPS_CONTACT_MOVER_SOLVER : MPS_CONTACT_MOVER_OTHER;
}

static const mpsi_contact_owner owner_of_contacts = {.check = check_owner,
                                                     .end = end,
                                                     .particles = list_particles,
                                                     .reaction = reaction,
                                                     .def_kind = MPS_DEF_FLUID_CONTACT,
                                                     .get_def = get_def};

/* Lowest free number of a body, and whether there is room for its edges. */
static mps_status find_room(mps_fluid *f, const char *function, const mps_body *body,
                            int32_t *number) {
  const int32_t faces = f->walls - f->boundaries;
  *number = 0;
  while (*number < f->bodies && f->body[*number].body) ++*number;
  if (faces + body->edges <= MPSI_FLUID_MOST_FACES) return MPS_OK;
  return mpsi_fail(f->context, function, MPS_ERROR_ARGUMENT,
                   "body has %lld edges, and the bodies in the fluid %d: allowed are %d together",
                   (long long)body->edges, faces, MPSI_FLUID_MOST_FACES);
}

mps_status mps_fluid_add_contact(mps_fluid *f, mps_body *body, const mps_fluid_contact_def *user,
                                 mps_contact **out) {
  if (!f) return mpsi_null(__func__, "fluid");
  if (out) *out = NULL;
  mps_fluid_contact_def def = mps_fluid_contact_defaults();
  mps_contact *contact = NULL;
  int32_t b = 0;
  MPSI_TRY(mpsi_fluid_ready(f, __func__));
  mps_status status =
      MPSI_DEF_READ_OR_DEFAULTS(f->context, __func__, mps_fluid_contact_def, user, &def);
  if (status == MPS_OK) status = check_body(f, __func__, body);
  if (status == MPS_OK) status = find_room(f, __func__, body, &b);
  if (status == MPS_OK && def.mover == MPS_CONTACT_MOVER_SOLVER)
    status = mpsi_body_check_mover(body, __func__);
  if (status == MPS_OK)
    status = mpsi_contact_make(f->context, __func__, body, &owner_of_contacts, f, &contact);
  if (status == MPS_OK) status = make_faces(f, __func__, contact, &def, b);
  status = settle(f, __func__, status, b, &def, body);
  if (status != MPS_OK) {
    if (contact && b < f->bodies && f->body[b].contact == contact)
      mpsi_fluid_drop_body(f, &f->body[b]);
    else if (contact)
      mpsi_contact_release(contact);
    mpsi_fluid_drop_slots(f, 0, 0);
    if (contact) mpsi_contact_release(contact);
    return status;
  }
  mpsi_contact_join(contact);
  if (def.mover == MPS_CONTACT_MOVER_SOLVER) take_over(f, b);
  f->stale = true, f->unknown = 1;
  if (out)
    *out = contact;
  else
    mpsi_contact_release(contact);
  return MPS_OK;
}
