/* mps/body.h - rigid bodies: shape, motion and reaction (Nakamura 5).
 *
 * A body's shape is given in its own frame, whose origin is the body's reference point: the
 * rotation turns about it, moments refer to it, and a free body has its centre of mass there. In
 * space the reference point is `position` and the frame is turned by `rotation`.
 *
 * Mass, inertia, loads, forces and reactions are those of the whole body (kg, kg m2, N, N m), in 2D
 * too: of the thickness, or in axisymmetry of the angle, that the solver's `measure` says
 * (mps/solver.h). The reaction of soil 2 m thick is twice that of 1 m, and the motion is the same
 * where mass and inertia are doubled too. A body in several solvers receives the sum of their
 * forces, each over its own measure.
 *
 * A driven (prescribed) body follows signals, or the motion of mps_body_set_motion, whatever the
 * forces on it; without either it is at rest. A free body moves by the forces on it. Solvers exert
 * forces on it by contacts (mps/contact.h) and as a fluid around it (mps_fluid_add_contact). In
 * axisymmetry (mps/mpm.h) a free body moves along y, its axis, alone: radial forces cancel around
 * the ring, as do moments. At most one solver advances the body; otherwise the caller does, by
 * mps_body_advance. Thread rule: one thread at a time per body (and context).
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef LIBMPS_BODY_H
#define LIBMPS_BODY_H

#include "signal.h"
#include "solver.h"

MPS_EXTERN_C_BEGIN

typedef struct mps_body mps_body;

typedef enum mps_body_motion_kind {
  MPS_BODY_MOTION_DRIVEN = 0, /* by the signals of mps_body_drive, or mps_body_set_motion */
  MPS_BODY_MOTION_FREE = 1    /* by forces, with mass and inertia */
} mps_body_motion_kind;

/* Vectors have three components in 2D too; the out-of-plane ones (position[2], rotation[0] and [1],
 * velocity[2], spin[0] and [1], gravity[2], inertia[0] and [1]) must be 0. */
typedef struct mps_body_def {
  uint32_t struct_size;
  int32_t motion;     /* mps_body_motion_kind, default DRIVEN */
  double position[3]; /* m, at most 1e9: of the reference point at time 0 */
  double rotation[3]; /* rad, rotation vector (axis times angle) from the body's frame to space at
                         time 0; 2D: [2] is the angle, anticlockwise */
  double velocity[3]; /* m/s at time 0; free bodies only */
  double spin[3];     /* rad/s, in space, at time 0; free bodies only */
  double mass;        /* kg, of the whole body, 1e-30 to 1e30; free bodies only. NaN (default), or
                         0 of a driven one: none */
  double inertia[3];  /* kg m2, of the whole body about the reference point, 1e-30 to 1e30,
                         principal: the body's axes are the principal axes. 2D: [2]. Free bodies
                         only; NaN (default) and 0 as of the mass */
  double gravity[3];  /* m/s2; free bodies only */
  double damping[2];  /* 1/s, >= 0, of velocity and of spin: dv/dt = ... - damping v; free bodies
                         only */
} mps_body_def;

static inline mps_body_def mps_body_defaults(void) {
  mps_body_def def;
  memset(&def, 0, sizeof def);
  if (mps_def_init(MPS_DEF_BODY, &def, sizeof def) != MPS_OK) def.struct_size = 0;
  return def;
}

/* ---- shapes in 2D: `def` NULL means the defaults. Lengths: at most 1e9 m, radii, widths and
 * heights at least 1e-9 m -----------------------------------------------------------------------
 */

/** Simple polygon, convex or not, of `vertices` (3 to 10000) corners xy[2 * k], xy[2 * k + 1] (m,
 *  in the body's frame, either sense, not closed). Edge k runs from corner k to corner k + 1.
 *  MPS_ERROR_ARGUMENT: a corner or a member of `def` out of range, or edges that intersect;
 *  MPS_ERROR_MEMORY. */
MPS_API MPS_NODISCARD mps_status mps_body_create_polygon(mps_context *context,
                                                         const mps_body_def *def, int64_t vertices,
                                                         const double *xy, mps_body **out);
/** Rectangle of `width` along x and `height` along y (m, > 0) about the reference point: a polygon
 *  whose edges 0 to 3 are bottom, right, top and left. MPS_ERROR_ARGUMENT: a value or a member of
 *  `def` out of range; MPS_ERROR_MEMORY. */
MPS_API MPS_NODISCARD mps_status mps_body_create_box(mps_context *context, const mps_body_def *def,
                                                     double width, double height, mps_body **out);
/** Disc of `radius` (m, > 0) about the reference point. One edge, number 0. MPS_ERROR_ARGUMENT: a
 *  value or a member of `def` out of range; MPS_ERROR_MEMORY. */
MPS_API MPS_NODISCARD mps_status mps_body_create_disc(mps_context *context, const mps_body_def *def,
                                                      double radius, mps_body **out);
/** Half plane: all points x with normal . x < 0, the surface going through the reference point. The
 *  outward `normal` (2 values, in the body's frame) need not be a unit vector. One edge, number 0.
 *  MPS_ERROR_ARGUMENT: a value or a member of `def` out of range; MPS_ERROR_MEMORY. */
MPS_API MPS_NODISCARD mps_status mps_body_create_half_plane(mps_context *context,
                                                            const mps_body_def *def,
                                                            const double *normal, mps_body **out);
/* ---- shapes in 3D ---------------------------------------------------------------------------- */

/** Sphere of `radius` (m, > 0) about the reference point. One face, number 0. MPS_ERROR_ARGUMENT: a
 *  value or a member of `def` out of range; MPS_ERROR_MEMORY. */
MPS_API MPS_NODISCARD mps_status mps_body_create_sphere(mps_context *context,
                                                        const mps_body_def *def, double radius,
                                                        mps_body **out);
/** Half space: all points x with normal . x < 0, the surface going through the reference point. The
 *  outward `normal` (3 values, in the body's frame) need not be a unit vector. One face, number 0.
 *  MPS_ERROR_ARGUMENT: a value or a member of `def` out of range; MPS_ERROR_MEMORY. */
MPS_API MPS_NODISCARD mps_status mps_body_create_half_space(mps_context *context,
                                                            const mps_body_def *def,
                                                            const double *normal, mps_body **out);
/** Solid cylinder of `radius` and `length` (m, > 0) about the body's z axis, the reference point in
 *  its middle. Faces: 0 bottom (z = -length/2), 1 top, 2 side. MPS_ERROR_ARGUMENT: a value or a
 *  member of `def` out of range; MPS_ERROR_MEMORY. */
MPS_API MPS_NODISCARD mps_status mps_body_create_cylinder(mps_context *context,
                                                          const mps_body_def *def, double radius,
                                                          double length, mps_body **out);
/** Solid of revolution about the body's z axis: cone, pile, pipe, ring. The profile is a simple
 *  polygon of `vertices` (3 to 10000) corners rz[2 * k] = r >= 0, rz[2 * k + 1] = z (m, either
 *  sense, not closed); where the solid reaches the axis, the profile has one edge (or several
 *  apart) on it. Face k is the surface that edge k makes; an edge on the axis makes none but keeps
 *  its number. MPS_ERROR_ARGUMENT: a corner or a member of `def` out of range, or edges that
 *  intersect; MPS_ERROR_MEMORY. */
MPS_API MPS_NODISCARD mps_status mps_body_create_revolution(mps_context *context,
                                                            const mps_body_def *def,
                                                            int64_t vertices, const double *rz,
                                                            mps_body **out);
/** Closed mesh of `triangles` (4 to 20 million) triangles over `vertices` points xyz[3 * i], ...
 *  (m, in the body's frame): triangle k has the corners corner[3 * k], ..., anticlockwise seen from
 *  outside (if all are clockwise they are reversed). Each edge must belong to two triangles, in
 *  opposite directions; coinciding points are one, and where holes would be left, points up to 1e-6
 *  of the longest side of the box apart. MPS_ERROR_ARGUMENT: triangles with no area,
 *  holes, edges of three or more triangles, and volumes that are zero; the message names the
 *  triangle. Surfaces that intersect are not detected. Face k is triangle k. The data are copied.
 *  Needs Embree, loaded with the first mesh: MPS_ERROR_UNSUPPORTED where it cannot be, and in a
 *  libmps without (CMake option MPS_EMBREE); Embree's own memory, about 150 B a triangle, does not
 *  come from the context. */
MPS_API MPS_NODISCARD mps_status mps_body_create_mesh(mps_context *context, const mps_body_def *def,
                                                      int64_t vertices, const double *xyz,
                                                      int64_t triangles, const int32_t *corner,
                                                      mps_body **out);
/** As mps_body_create_mesh from an STL file, binary or ASCII, one solid; its coordinates times
 *  `scale` (> 0; 0.001 for a file in mm) are m; the normals in the file are not used. MPS_ERROR_IO
 * when it cannot be read, MPS_ERROR_FORMAT when it is not a whole STL file: the message has path
 * and line (ASCII) or byte (binary, as `path:@byte`). Other errors as mps_body_create_mesh. */
MPS_API MPS_NODISCARD mps_status mps_body_create_stl(mps_context *context, const mps_body_def *def,
                                                     const char *path, double scale,
                                                     mps_body **out);

/** Releases the caller's reference and nulls; accepts NULL. A contact keeps the body alive. */
MPS_API void mps_body_destroy(mps_body **body);
/** Dimension of the shape, 2 or 3; 0 for NULL. */
MPS_API int32_t mps_body_dim(const mps_body *body);
/** The definition that the body was made from: `position` and its like are those of time 0.
 * MPS_ERROR_ARGUMENT: NULL, or a `size` unknown to this library. */
MPS_API MPS_NODISCARD mps_status mps_body_get_def_sized(const mps_body *body, mps_body_def *out,
                                                        size_t size);
static inline mps_status mps_body_get_def(const mps_body *body, mps_body_def *out) {
  return mps_body_get_def_sized(body, out, sizeof *out);
}

/* ---- motion ---------------------------------------------------------------------------------- */

/** Drives component `component` of a prescribed body: 0 x, 1 y, 2 z in m, 3 to 5 the components of
 *  the rotation vector in rad (2D: 0, 1 and 5). The coordinate is the definition's value plus
 *  factor * displacement of `signal`; the orientation is the exponential of the whole rotation
 *  vector, the spin its rate. Replaces an earlier signal; NULL: the definition's value alone. The
 *  signal is kept alive. From now on the body follows its signals, also after mps_body_set_motion.
 *  A warning is logged where that does not continue the motion: the body is elsewhere at once.
 *  MPS_ERROR_ARGUMENT: `component` or `factor` out of range, or a place or rate beyond 1e9 m, rad
 *  (per s), which ends a later step too; MPS_ERROR_STATE: a free body, or a
 *  solver's callback is running. */
MPS_API MPS_NODISCARD mps_status mps_body_drive(mps_body *body, int32_t component,
                                                mps_signal *signal, double factor);

/** Present position and velocity of a body, to be set; always start from mps_body_motion_defaults.
 * In 2D position[2], rotation[0] and [1] are NaN or 0, velocity[2], spin[0] and [1] are 0. */
typedef struct mps_body_motion {
  uint32_t struct_size;
  int32_t reserved;
  double position[3]; /* m, of the reference point; NaN (default): this component stays as it is */
  double rotation[3]; /* rad, rotation vector; in 3D all or none NaN (default: stays). 2D: [2] */
  double velocity[3]; /* m/s, default 0 */
  double spin[3];     /* rad/s, in space, default 0 */
} mps_body_motion;
static inline mps_body_motion mps_body_motion_defaults(void) {
  mps_body_motion motion;
  memset(&motion, 0, sizeof motion);
  if (mps_def_init(MPS_DEF_BODY_MOTION, &motion, sizeof motion) != MPS_OK) motion.struct_size = 0;
  return motion;
}
/** Sets the motion of the body between steps, as for another code, or a servo controlled by the
 *  reaction. A prescribed body takes this position at once, and continues with this velocity and
 *  spin, instead of its signals, until it is set again; NULL: it follows its signals again. A free
 *  body takes the position and velocity and then moves by the forces; impulses received since its
 *  last step count as part of the given motion. MPS_ERROR_ARGUMENT: a value out of range, or NULL
 *  for a free body. */
MPS_API MPS_NODISCARD mps_status mps_body_set_motion(mps_body *body, const mps_body_motion *motion);

/** A load on a free body from now on: force[3] (N) at the reference point, moment[3] (N m), both in
 *  space; NULL is zero. In 2D force[2], moment[0] and moment[1] must be 0, in axisymmetry force[0]
 *  and moment[2] too. MPS_ERROR_ARGUMENT: a value that is not finite, or not 0 there;
 *  MPS_ERROR_STATE: a prescribed body. */
MPS_API MPS_NODISCARD mps_status mps_body_set_load(mps_body *body, const double *force,
                                                   const double *moment);
/** Advances the body by dt (s, > 0): a prescribed one along its signals, a free one under gravity,
 *  load, damping and the impulses of solvers since its last step (velocity first, then position).
 *  MPS_ERROR_ARGUMENT: dt out of range; MPS_ERROR_STATE: a solver moves the body;
 *  MPS_ERROR_DIVERGED: it would pass 1e100 m or m/s, and stays. */
MPS_API MPS_NODISCARD mps_status mps_body_advance(mps_body *body, double dt);

typedef struct mps_body_state {
  double time;        /* s */
  double position[3]; /* m */
  double rotation[3]; /* rad, rotation vector: by signals and in 2D not wrapped, else the shortest.
                         2D: [2] is the angle */
  double orientation[9]; /* matrix R, rows: a point X of the body's frame is at position + R X */
  double velocity[3];    /* m/s, of the reference point */
  double spin[3];        /* rad/s, in space */
} mps_body_state;
/** Present position, orientation, velocity and spin. MPS_ERROR_ARGUMENT: NULL, or a `size` unknown
 *  to this library. */
MPS_API MPS_NODISCARD mps_status mps_body_get_state_sized(const mps_body *body, mps_body_state *out,
                                                          size_t size);
static inline mps_status mps_body_get_state(const mps_body *body, mps_body_state *out) {
  return mps_body_get_state_sized(body, out, sizeof *out);
}

/** Momenta and energies of a free body; of a prescribed one, which has no mass, all 0. The sum
 *  kinetic + dissipated - work_contacts - work_loads keeps its value to rounding. */
typedef struct mps_body_totals {
  double mass;          /* kg */
  double linear[3];     /* kg m/s */
  double angular[3];    /* kg m2/s, about the origin of space, with the body's own spin */
  double kinetic;       /* J */
  double work_contacts; /* J, since creation, by the particles on the body */
  double work_loads;    /* J, since creation: gravity and mps_body_set_load */
  double dissipated;    /* J, since creation: damping, and in 3D the small error of the rotation's
                           splitting, of either sign */
} mps_body_totals;
/** The sums of the present state and since creation. MPS_ERROR_ARGUMENT: NULL, or a `size` unknown
 *  to this library. */
MPS_API MPS_NODISCARD mps_status mps_body_get_totals_sized(const mps_body *body,
                                                           mps_body_totals *out, size_t size);
static inline mps_status mps_body_get_totals(const mps_body *body, mps_body_totals *out) {
  return mps_body_get_totals_sized(body, out, sizeof *out);
}

/* ---- surface --------------------------------------------------------------------------------- */

/** For `count` (at most 2^40) points x of dim values each (m, finite): signed `distance` (m,
 *  negative inside), outward unit `normal` (dim values a point), `foot`, the nearest point of the
 *  surface (dim values a point, m), and the `face` it lies on (2D: the edge). Each result may be
 *  NULL. The normal is the gradient of the distance; on a corner it is the mean of the two edges'
 *  (mesh: of the triangles', weighted with their angles), and where two feet are equally near, that
 *  of the lower face. MPS_ERROR_ARGUMENT: `count` out of range, or a point that is not finite. */
MPS_API MPS_NODISCARD mps_status mps_body_distance(const mps_body *body, int64_t count,
                                                   const double *x, double *distance,
                                                   double *normal, double *foot, int64_t *face);

/** Names the faces (2D: edges) first, ..., first + count - 1 (around the end of the list if need
 *  be) a part of the surface, whose reaction is reported separately: tip, inside, outside. `part`
 *  (may be NULL) receives its number: 1, 2, ... Part 0, "rest", has the faces in no part; a face
 *  belongs to the part that named it last. Up to 999999 parts; names as those of fields.
 *  MPS_ERROR_ARGUMENT: a name that is not allowed, faces out of range, or too many parts.
 *  MPS_ERROR_MEMORY: nothing is changed. */
MPS_API MPS_NODISCARD mps_status mps_body_name_part(mps_body *body, const char *name, int64_t first,
                                                    int64_t count, int32_t *part);
/** Number of the part `name`, or -1. */
MPS_API int32_t mps_body_find_part(const mps_body *body, const char *name);

/** Reaction of all solvers on one part of the body, or on the whole body (`part` -1): the sum of
 *  their contacts and of the water around it; `count` is the number of particles in contact, and of
 *  wetted points (mps_fluid_get_boundary_points). MPS_ERROR_ARGUMENT: no part of that number, NULL,
 * or a `size` unknown to this library. */
MPS_API MPS_NODISCARD mps_status mps_body_get_reaction_sized(const mps_body *body, int32_t part,
                                                             mps_reaction *out, size_t size);
static inline mps_status mps_body_get_reaction(const mps_body *body, int32_t part,
                                               mps_reaction *out) {
  return mps_body_get_reaction_sized(body, part, out, sizeof *out);
}

MPS_EXTERN_C_END
#endif
