/* mps/body.h - rigid bodies in 2D: shape, motion, friction, and the reaction they feel (seed B 5).
 *
 * A body's shape is given in its own frame, whose origin is the body's reference point: the
 * rotation turns about it, moments refer to it, and a free body has its centre of mass there. In
 * space the reference point is `position` and the frame is turned by `angle`. All forces are per
 * unit thickness in plane strain, per radian in axisymmetry.
 *
 * A prescribed body follows signals; a free body moves by the forces on it. A solver that uses the
 * body moves it and writes the reaction; without one, mps_body_advance does. One solver at a time
 * may use a body. Thread rule: one thread at a time per body (and context).
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef MPS_BODY_H
#define MPS_BODY_H

#include <mps/signal.h>

MPS_EXTERN_C_BEGIN

typedef struct mps_body mps_body;

typedef enum mps_motion {
  MPS_MOTION_PRESCRIBED = 0, /* position and angle plus what the signals of mps_body_drive say */
  MPS_MOTION_FREE = 1        /* by forces, with mass and inertia */
} mps_motion;

typedef struct mps_body_def {
  uint32_t struct_size;
  int32_t motion;       /* mps_motion, default PRESCRIBED */
  double position[2];   /* m: of the reference point at time 0 */
  double angle;         /* rad, anticlockwise, at time 0 */
  double velocity[2];   /* m/s at time 0; free bodies only */
  double spin;          /* rad/s at time 0; free bodies only */
  double friction;      /* Coulomb's mu on the surface, >= 0; default 0 */
  double penalty;       /* contact stiffness k of seed B (28), N/m per unit thickness, > 0; 0
                           (default): the solver chooses 1.33 (K + 4G/3) of the particle's material.
                           In axisymmetry either is multiplied by the particle's radius */
  double mass, inertia; /* kg and kg m2 about the reference point per unit thickness, > 0; free
                           bodies only */
  double gravity[2];    /* m/s2; free bodies only */
  double damping[2];    /* 1/s, >= 0, of velocity and of spin: dv/dt = ... - damping v; free bodies
                           only */
} mps_body_def;

MPS_API mps_status mps_body_def_init(mps_body_def *def, size_t size);
static inline mps_body_def mps_body_defaults(void) {
  mps_body_def def;
  memset(&def, 0, sizeof def);
  if (mps_body_def_init(&def, sizeof def) != MPS_OK) def.struct_size = 0;
  return def;
}

/* ---- shapes: `def` NULL means the defaults ----------------------------------------------------
 */

/** Simple polygon, convex or not, of `vertices` (3 to 10000) corners xy[2 * k], xy[2 * k + 1] (m,
 * in the body's frame, either sense, not closed). Edge k runs from corner k to corner k + 1. */
MPS_API MPS_NODISCARD mps_status mps_body_create_polygon(mps_context *context,
                                                         const mps_body_def *def, int64_t vertices,
                                                         const double *xy, mps_body **out);
/** Rectangle of `width` along x and `height` along y (m, > 0) about the reference point: a polygon
 *  whose edges 0 to 3 are bottom, right, top and left. */
MPS_API MPS_NODISCARD mps_status mps_body_create_box(mps_context *context, const mps_body_def *def,
                                                     double width, double height, mps_body **out);
/** Disc of `radius` (m, > 0) about the reference point. One edge, number 0. */
MPS_API MPS_NODISCARD mps_status mps_body_create_disc(mps_context *context, const mps_body_def *def,
                                                      double radius, mps_body **out);
/** Half plane: all points x with normal . x < 0, the surface going through the reference point. The
 *  outward `normal` (2 values, in the body's frame) need not be a unit vector. One edge, number 0.
 */
MPS_API MPS_NODISCARD mps_status mps_body_create_half_plane(mps_context *context,
                                                            const mps_body_def *def,
                                                            const double *normal, mps_body **out);
/** Gives up the caller's share and nulls; accepts NULL. A solver keeps the body alive. */
MPS_API void mps_body_destroy(mps_body **body);

/* ---- motion ---------------------------------------------------------------------------------- */

/** Drives component `component` (0 x, 1 y in m; 2 rotation in rad) of a prescribed body: it is the
 *  definition's value plus factor * displacement of `signal`. Replaces an earlier signal; NULL
 *  holds the component. The signal is kept alive. */
MPS_API MPS_NODISCARD mps_status mps_body_drive(mps_body *body, int32_t component,
                                                mps_signal *signal, double factor);
/** A load on a free body from now on: force[2] (N) at the reference point, moment (N m). */
MPS_API MPS_NODISCARD mps_status mps_body_load(mps_body *body, const double *force, double moment);
/** Moves the body on by dt (s, > 0): a prescribed one to where its signals are, a free one under
 *  gravity, load, damping and the reaction of the last step (velocity first, then position). A body
 *  that a solver uses is MPS_ERROR_STATE. */
MPS_API MPS_NODISCARD mps_status mps_body_advance(mps_body *body, double dt);

typedef struct mps_body_state {
  double time;        /* s */
  double position[2]; /* m */
  double angle;       /* rad, not wrapped */
  double velocity[2]; /* m/s */
  double spin;        /* rad/s */
} mps_body_state;
MPS_API MPS_NODISCARD mps_status mps_body_get_state(mps_body *body, mps_body_state *out);

/* ---- surface --------------------------------------------------------------------------------- */

/** For `count` points x[2 * i], x[2 * i + 1] (m, finite): signed `distance` (m, negative inside),
 *  outward unit `normal` (2 a point), `foot`, the nearest point of the surface (2 a point, m), and
 *  the `edge` it lies on. Each result may be NULL. The normal is the gradient of the distance; on a
 *  corner it is the mean of the two edges', and where two feet are equally near, that of the lower
 *  edge. */
MPS_API MPS_NODISCARD mps_status mps_body_distance(mps_body *body, int64_t count, const double *x,
                                                   double *distance, double *normal, double *foot,
                                                   int64_t *edge);

#define MPS_BODY_MAX_PARTS 16

/** Names the edges first, ..., first + count - 1 (around the end of the list if need be) a part of
 *  the surface, so that reactions are told apart: tip, inside, outside. `part` (may be NULL)
 *  receives its number: 1, 2, ... Part 0, "rest", has the edges in no part; an edge belongs to the
 *  part that named it last. At most 15 parts; names are as of fields. */
MPS_API MPS_NODISCARD mps_status mps_body_name_part(mps_body *body, const char *name, int64_t first,
                                                    int64_t count, int32_t *part);
MPS_API int32_t mps_body_part_count(const mps_body *body); /* "rest" included */
/** Number of the part `name`, or -1. */
MPS_API int32_t mps_body_part(const mps_body *body, const char *name);

/** What particles do to the body. The last step's force is its mean over the step. */
typedef struct mps_reaction {
  double force[2];       /* N, of the last step */
  double moment;         /* N m about the reference point, of the last step */
  double impulse[2];     /* N s since creation */
  double moment_impulse; /* N m s since creation, about the reference point as it moved */
  int64_t contacts;      /* particles in contact in the last step */
} mps_reaction;
/** Reaction on one part, or on the whole body (`part` -1). */
MPS_API MPS_NODISCARD mps_status mps_body_get_reaction(mps_body *body, int32_t part,
                                                       mps_reaction *out);

MPS_EXTERN_C_END
#endif
