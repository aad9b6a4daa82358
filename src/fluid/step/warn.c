/* warn.c - assumptions of the model: walls that move little in a step and bend little, particles
 * fine enough for the flow, bodies without acute corners of water at their boundary that stay
 * before it. A step that breaks them is an error, one that comes near is a warning in the log, once
 * a solver each, or once a body.
 *
 * Images are those of the step's beginning, so a wall that moves a spacing passes particles. A bent
 * wall mirrors at its local position along the normal that it has when plane: the error grows as
 * the square of the slope.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "warn.h"
#include "fluid/boundary/clearance.h"
#include "fluid/boundary/pose.h"

#define WARN_FROM 50      /* steps */
#define MOST_GUARDED 0.01 /* of the particles, in a step on average */
#define FAR_TRAVEL 0.5    /* l0 a step: above, a warning .. */
#define MOST_TRAVEL 1.5   /* .. and an error */
#define FAR_BEHIND 0.5    /* l0 of a floating body behind a boundary */
#define FACE_TO_FACE 0.01 /* l0: bodies that make one face of several parts */
#define FAR_SLOPE 0.1     /* of a bent wall */
#define MOST_SLOPE 1.0

/* True the first time that it is called for the solver. */
static bool first_time(mps_fluid *f, uint32_t warning) {
  const bool first = !(f->warned & warning);
  f->warned |= warning;
  return first;
}

void mpsi_fluid_warn_of_guards(mps_fluid *f) {
  const mps_fluid_report *r = &f->report;
  const double acted = (double)(r->collisions + r->limited + r->pushed);
  const double share = acted / ((double)f->steps * (double)f->count + 1.0);
  if (f->steps < WARN_FROM || !(share > MOST_GUARDED) || !first_time(f, MPSI_FLUID_WARNED_GUARDS))
    return;
  mpsi_log(
      f->context, MPS_CONTEXT_LOG_WARNING,
      "step %lld of the fluid: collisions, limited velocities and particles moved off walls are "
      "%.1f %% of the particles a step, above %g %%: the flow needs a smaller spacing or step",
      (long long)f->steps, 100.0 * share, 100.0 * MOST_GUARDED);
}

/* A rolling body may develop acute corners, which mps_fluid_add_contact does not accept. */
void mpsi_fluid_warn_of_angles(mps_fluid *f) {
  for (int number = 0; number < f->bodies; number++) {
    mpsi_fluid_body *body = &f->body[number];
    for (int k = 0; body->body && k < body->faces; k++)
      for (int b = 0; b < f->boundaries; b++) {
        const double angle = mpsi_fluid_angle(f, &f->wall[body->first + k], b);
        if (angle >= MPSI_FLUID_LEAST_ANGLE || body->warned) continue;
        body->warned = true;
        mpsi_log(f->context, MPS_CONTEXT_LOG_WARNING,
                 "step %lld of the fluid: edge %d of body %d and boundary %d enclose %.3g degrees "
                 "of fluid, below the %g degrees that the fluid resolves: pressures in that corner "
                 "are not to be relied on",
                 (long long)f->steps, k, number, b, angle, MPSI_FLUID_LEAST_ANGLE);
      }
  }
}

/* The corner of a body that is farthest behind a boundary, and still goes there: how far (m), and
 * which boundary. */
static double behind(const mps_fluid *f, const mpsi_fluid_body *body, int *boundary) {
  double most = -INFINITY;
  for (int b = 0; b < f->boundaries; b++) {
    const mpsi_fluid_wall *w = &f->wall[b];
    if (!w->used || w->line) continue;
    for (int k = 0; k < body->faces; k++) {
      double x[2];
      mpsi_fluid_corner(body, false, k, x);
      const double arm[2] = {x[0] - body->pose.x[0], x[1] - body->pose.x[1]},
                   spin = body->pose.spin;
      const double into = (body->pose.v[0] - spin * arm[1]) * w->normal[0] +
                          (body->pose.v[1] + spin * arm[0]) * w->normal[1];
      const double deep = -mpsi_fluid_distance(w, w->now.s, x[0], x[1]);
      if (into >= 0.0 || deep <= most) continue;
      most = deep, *boundary = b;
    }
  }
  return most;
}

/* Boundaries are those of the water: a body that sinks, or drifts to a wall, continues through it.
 */
void mpsi_fluid_warn_of_ground(mps_fluid *f) {
  for (int number = 0; number < f->bodies; number++) {
    mpsi_fluid_body *body = &f->body[number];
    int b = 0;
    if (!body->body || !body->floats || body->warned_of_ground) continue;
    const double deep = behind(f, body, &b);
    if (!(deep > FAR_BEHIND * f->l0)) continue;
    body->warned_of_ground = true;
    mpsi_log(
        f->context, MPS_CONTEXT_LOG_WARNING,
        "step %lld of the fluid: floating body %d goes through boundary %d, and is %g m behind "
        "it: boundaries hold water alone; what holds a body is the caller's or another solver's",
        (long long)f->steps, number, b, deep);
  }
}

/* Distance (m) of two bodies along the normal of a face of the first one, of the face that parts
 * them best; below 0 where none does. */
static double apart_by(const mps_fluid *f, const mpsi_fluid_body *one,
                       const mpsi_fluid_body *other) {
  double most = -INFINITY;
  for (int k = one->first; k < one->first + one->faces; k++) {
    const mpsi_fluid_wall *w = &f->wall[k];
    double least = INFINITY, x[2];
    for (int c = 0; c < other->faces; c++) {
      mpsi_fluid_corner(other, false, c, x);
      least = fmin(least, mpsi_fluid_distance(w, w->now.s, x[0], x[1]));
    }
    most = fmax(most, least);
  }
  return most;
}

static bool in_water(const mps_fluid *f, const mpsi_fluid_body *body) {
  for (int k = body->first; k < body->first + body->faces; k++)
    if (f->wall[k].images > 0) return true;
  return false;
}

/* Gap (m) between the body's nearest corner and a plane boundary, of less than a spacing and more
 * than what closes; 0: none. */
static double gap_to(const mps_fluid *f, const mpsi_fluid_body *body, int b) {
  const mpsi_fluid_wall *w = &f->wall[b];
  double least = INFINITY, x[2];
  if (!w->used || w->line || w->open) return 0.0;
  for (int k = 0; k < body->faces; k++) {
    mpsi_fluid_corner(body, false, k, x);
    least = fmin(least, mpsi_fluid_distance(w, w->now.s, x[0], x[1]));
  }
  return least > MPSI_FLUID_FLUSH * f->l0 && least < (1.0 - FACE_TO_FACE) * f->l0 ? least : 0.0;
}

/* A body so near to a boundary, without standing on it, has no water in between: the uplift of a
 * box a quarter of a spacing above the bed is missing, as if it stood there. */
static void warn_of_gaps(mps_fluid *f, int number) {
  mpsi_fluid_body *body = &f->body[number];
  for (int b = 0; b < f->boundaries && !body->warned_of_gap; b++) {
    const double gap = gap_to(f, body, b);
    if (!(gap > 0.0)) continue;
    body->warned_of_gap = true;
    mpsi_log(f->context, MPS_CONTEXT_LOG_WARNING,
             "step %lld of the fluid: body %d has a gap of %g m to boundary %d, less than the "
             "spacing of %g m: no water is in it, and none presses there; below %g m it closes",
             (long long)f->steps, number, gap, b, f->l0, MPSI_FLUID_FLUSH * f->l0);
  }
}

/* Bodies that come nearer than a spacing, or pass into one another, and do not lie face to face:
 * looked at in the first step of a body and while it moves. */
void mpsi_fluid_warn_of_bodies(mps_fluid *f) {
  for (int number = 0; number < f->bodies; number++) {
    mpsi_fluid_body *body = &f->body[number];
    const mpsi_fluid_pose *pose = &body->pose;
    if (!body->body) continue;
    if (body->looked && pose->v[0] == 0.0 && pose->v[1] == 0.0 && pose->spin == 0.0) continue;
    body->looked = true;
    if (in_water(f, body)) warn_of_gaps(f, number);
    for (int n = 0; n < f->bodies && !body->warned_of_bodies && in_water(f, body); n++) {
      mpsi_fluid_body *other = &f->body[n];
      if (n == number || !other->body || !mpsi_fluid_boxes_near(body, other, f->l0)) continue;
      const double gap = fmax(apart_by(f, body, other), apart_by(f, other, body));
      if (gap >= f->l0 || fabs(gap) <= FACE_TO_FACE * f->l0) continue;
      body->warned_of_bodies = other->warned_of_bodies = true;
      mpsi_log(f->context, MPS_CONTEXT_LOG_WARNING,
               "step %lld of the fluid: bodies %d and %d %s %g m, %s: what keeps bodies apart is "
               "the caller's or another solver's",
               (long long)f->steps, number, n, gap < 0.0 ? "overlap by" : "have a gap of",
               fabs(gap),
               gap < 0.0 ? "and forces on them are not to be relied on"
                         : "less than the spacing, which holds no particles of water");
      break;
    }
  }
}

/* Largest displacement of a node of the wall in the step, m. */
static double travel_of(const mpsi_fluid_wall *w) {
  double most = 0.0;
  for (int64_t k = 0; k < w->nodes; k++) most = fmax(most, fabs(w->next.s[k] - w->now.s[k]));
  return most;
}

/* The steepest slope of a bent wall at the end of the step. Faces are straight. */
static double slope_of(const mpsi_fluid_wall *w) {
  double most = 0.0;
  for (int64_t k = 1; !w->of_body && k < w->nodes; k++)
    most = fmax(most, fabs(w->next.s[k] - w->next.s[k - 1]) / (w->node[k] - w->node[k - 1]));
  return most;
}

/* "boundary 2" or "body 0", of a message. */
static const char *kind_of(const mpsi_fluid_wall *w) { return w->of_body ? "body" : "boundary"; }

mps_status mpsi_fluid_check_walls(mps_fluid *f, const char *function) {
  for (int32_t b = 0; f->segments > 0 && b < f->bodies; b++) {
    MPSI_TRY(f->body[b].body ? mpsi_fluid_check_clearance(f, function, true, b) : MPS_OK);
  }
  for (int b = 0; b < f->walls; b++) {
    const mpsi_fluid_wall *w = &f->wall[b];
    if (!w->used) continue;
    const int number = w->of_body ? w->of_body - 1 : b;
    const double travel = travel_of(w), slope = slope_of(w);
    if (!(travel <= MOST_TRAVEL * f->l0))
      return mpsi_fail(
          f->context, function, MPS_ERROR_DIVERGED,
          "step %lld, t = %g s: %s %d moves %g m in the step of %g s, allowed is %g l0 = %g "
          "m; the step is not made",
          (long long)f->steps, f->time, kind_of(w), number, travel, f->dt, MOST_TRAVEL,
          MOST_TRAVEL * f->l0);
    if (!(slope <= MOST_SLOPE))
      return mpsi_fail(
          f->context, function, MPS_ERROR_DIVERGED,
          "step %lld, t = %g s: boundary %d bends to a slope of %g, allowed is %g: walls "
          "bend little; the step is not made",
          (long long)f->steps, f->time, b, slope, MOST_SLOPE);
    if (travel > FAR_TRAVEL * f->l0 && first_time(f, MPSI_FLUID_WARNED_TRAVEL))
      mpsi_log(f->context, MPS_CONTEXT_LOG_WARNING,
               "step %lld of the fluid: %s %d moves %g m in the step of %g s, more than half the "
               "spacing of %g m: the pressure there needs a smaller step",
               (long long)f->steps, kind_of(w), number, travel, f->dt, f->l0);
    if (slope > FAR_SLOPE && first_time(f, MPSI_FLUID_WARNED_SLOPE))
      mpsi_log(
          f->context, MPS_CONTEXT_LOG_WARNING,
          "step %lld of the fluid: boundary %d bends to a slope of %g, above %g: its images are "
          "those of walls that bend little",
          (long long)f->steps, b, slope, FAR_SLOPE);
  }
  return MPS_OK;
}

/* The air's pressure on a body's dry faces is not known: a load has the surface's particles alone.
 * Without it the water lifts the body by that pressure. */
void mpsi_fluid_warn_of_air(mps_fluid *f) {
  for (int b = 0; f->over && b < f->bodies; b++) {
    const double *load = f->body[b].floats ? f->body[b].body->load.force : NULL;
    if (!load || load[0] != 0.0 || load[1] != 0.0 || !first_time(f, MPSI_FLUID_WARNED_AIR))
      continue;
    mpsi_log(
        f->context, MPS_CONTEXT_LOG_WARNING,
        "step %lld of the fluid: a load presses on the water's surface, not on the dry faces of "
        "floating body %d, which the water lifts by that pressure: give the force on these "
        "faces with mps_body_set_load",
        (long long)f->steps, b);
  }
}
