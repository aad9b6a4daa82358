/* body_internal.h - the interface of a rigid body for solvers, besides the public functions.
 * SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include "core/base/given.h"
#include "core/state/state.h"

#include <mps/contact.h>

typedef enum mpsi_shape {
  MPSI_POLYGON = 0,    /* 2D */
  MPSI_BALL = 1,       /* disc or sphere */
  MPSI_HALF = 2,       /* half plane or half space */
  MPSI_REVOLUTION = 3, /* 3D: a polygon (r, z) turned about the z axis */
  MPSI_MESH = 4        /* 3D: closed triangles */
} mpsi_shape;

typedef struct mpsi_mesh mpsi_mesh;

enum { MPSI_MOTIONS = 6 };
/* Allowed ranges of a body: beyond them squares and quotients lose their digits. */
#define MPSI_BODY_SMALL 1e-9 /* m: radii and sides */
#define MPSI_PART_NAME 48    /* bytes, with the terminating zero */

/* Vectors of space have three components in 2D too, z being 0 there: in 2D x may be read as two. */

/* The nearest point of a surface. */
typedef struct mpsi_foot {
  double distance;  /* m, negative inside */
  double normal[3]; /* outward unit vector */
  double at[3];     /* m */
  int64_t face;     /* in the caller's order; 2D: the edge */
  double narrowing; /* area of the surface for a unit of the parallel surface through the point: the
                       determinant of the foot as a function of place. 1 at a plane, (R/(R + D))^n
                       at n curvatures 1/R, 0 where the foot is an edge or a corner */
} mpsi_foot;

/* The narrowing at a foot on the rim of a plane face, seen along the unit vector `along`: edges
 * between faces of one plane are none. */
static inline double mpsi_rim_narrowing(double along_normal) {
  return fabs(along_normal) > 1.0 - 1e-9 ? 1.0 : 0.0;
}

/* A force on a part of the surface. */
typedef struct mpsi_load {
  double force[3], moment[3]; /* N, N m about the reference point; 2D: force[0], [1], moment[2] */
} mpsi_load;

typedef struct mpsi_pose {
  double x[3], R[9];    /* reference point (m); rotation from the body's frame to space, rows */
  double v[3], spin[3]; /* m/s, rad/s in space */
} mpsi_pose;

/* What a solver exerts on a part of the surface. */
typedef struct mpsi_part_load {
  mpsi_load force;   /* N, N m: of the step that ends */
  mpsi_load impulse; /* N s, N m s: besides, that act at once or in the next step */
  int64_t count;     /* particles, or points of its water, in contact */
} mpsi_part_load;

/* A solver's forces on a body: one of its contacts, or its water. The force on the body is the sum
 * of all sources. */
typedef struct mpsi_body_source {
  mps_reaction *reaction; /* by this solver; one a part, as the next */
  mpsi_part_load *part;
  bool moves; /* the body, at the end of each of its steps */
  struct mpsi_body_source *next;
} mpsi_body_source;

/* Values of the signals of a prescribed body: position (m) and rotation vector (rad), and their
 * rates. */
typedef struct mpsi_course {
  double at[MPSI_MOTIONS], rate[MPSI_MOTIONS];
} mpsi_course;

struct mps_body {
  mps_context *context;
  int32_t references; /* one thread at a time: no atomics */
  mps_body_def def;
  int32_t dim; /* 2 or 3 */
  mpsi_shape shape;
  double radius;    /* ball, m */
  double normal[3]; /* half plane or space, body's frame */
  int64_t faces;    /* as the caller counts them */
  int64_t edges;    /* of the polygon */
  double *xy;       /* polygon: anticlockwise corners, the first repeated at the end */
  int64_t *face_of; /* face of each edge */
  mpsi_mesh *mesh;
  int32_t *part_of; /* one a face, in the caller's order */
  char (*names)[MPSI_PART_NAME];
  int32_t parts, part_capacity;     /* part_room: as many have memory here and in all sources */
  mps_signal *signal[MPSI_MOTIONS]; /* of x and of the rotation vector */
  double factor[MPSI_MOTIONS];
  mpsi_load load;
  double time;        /* s */
  double rotation[3]; /* rad: as of mps_body_state, but of a free body in 3D unused */
  double angular[3];  /* kg m2/s, angular momentum in space: free bodies in 3D */
  mpsi_course ahead;  /* prescribed: at the end of the step being made */
  bool outside;       /* prescribed: moves by mps_body_set_motion, not by the signals */
  bool jumped;        /* the log has a warning that its signals do not continue its motion */
  bool axial; /* in contact in axisymmetry: a free one moves along y alone, mpsi_body_moves_along */
  mpsi_pose pose;
  /* m/s, rad/s: those of the last advance by which forces do their work; of a free body the means
   * of before it and after it, without damping */
  double middle_v[3], middle_spin[3];
  double work_contacts, work_loads, dissipated; /* J: see mps_body_totals */
  mps_reaction *reaction;                       /* by all sources; one a part */
  mpsi_load pending; /* N s, N m s: impulses by all sources since the body last moved */
  mpsi_body_source *sources;
};

/* Whether forces move a free body along axis c. In axisymmetry those along r cancel around the
 * ring, as do all moments. */
static inline bool mpsi_body_moves_along(const mps_body *body, int c) {
  return !body->axial || c == 1;
}
/* Refuses (MPS_ERROR_ARGUMENT) what a free body in axisymmetry cannot have: velocity or gravity
 * along r, or spin. */
mps_status mpsi_body_check_axial(mps_context *context, const char *function, const double *velocity,
                                 const double *spin, const double *gravity);

/* Lists the state of the body as it moves, and its definition. */
void mpsi_body_list_state(mpsi_state *state, mps_body *body);
/* The part of it to which solvers add: reactions, and impulses since its last step. */
void mpsi_body_list_account(mpsi_state *state, mps_body *body);
/* The reactions by one source. */
void mpsi_body_list_source(mpsi_state *state, const mps_body *body, mpsi_body_source *source);

/* Adds the body's definition and pose; the latter alone. */
void mpsi_body_give(mpsi_given *list, const mps_body *body);
void mpsi_body_give_state(mpsi_given *list, const mps_body *body);
/* Adds the pose by the body's signals at the end of the step being made. */
void mpsi_body_give_ahead(mpsi_given *list, const mps_body *body);

/* Nearest surface point to x (dim values, finite). Reads only: any number of threads. */
mpsi_foot mpsi_body_foot(const mps_body *body, const double *x);
/* Whether the body or its inside is within `reach` (m, >= 0) of x; cheap far from a mesh. */
bool mpsi_body_reaches(const mps_body *body, const double *x, double reach);
/* The same along a sequence of points: a distance changes no faster than the position, so that the
 * last one found excludes points near it and well beyond the reach. Starts with {.distance = 0}. */
typedef struct mpsi_last_distance {
  double x[3], distance;
} mpsi_last_distance;
bool mpsi_body_reaches_next(const mps_body *body, const double *x, double reach,
                            mpsi_last_distance *last);

/* Velocity v[3] (m/s) of the body's material at x[3]. */
static inline void mpsi_body_velocity(const mpsi_pose *pose, const double *x, double *v) {
  const double *w = pose->spin;
  const double r[3] = {x[0] - pose->x[0], x[1] - pose->x[1], x[2] - pose->x[2]};
  v[0] = pose->v[0] + w[1] * r[2] - w[2] * r[1];
  v[1] = pose->v[1] + w[2] * r[0] - w[0] * r[2];
  v[2] = pose->v[2] + w[0] * r[1] - w[1] * r[0];
}

/* Whether two bodies of one dimension overlap by more than `depth` (m, > 0): bodies in contact do
 * not. Two solids without a half space or sphere between them cost up to (size / depth)^2 distances
 * where faces lie on each other; the round surface of a solid of revolution then counts 0.2 % of
 * its radius too small. */
bool mpsi_body_overlap(const mps_body *a, const mps_body *b, double depth);
/* Two faces are a wall's two sides where their normals are opposite within 20 degrees: a plate's.
 * Those of a wedge or cone of more than that join in a tip, around which the ground flows. */
#define MPSI_BODY_OPPOSITE -0.94
/* Smallest wall thickness (m): from samples of the surface, straight inwards, to the other side.
 * INFINITY of a half space. */
double mpsi_body_thickness(const mps_body *body);
/* Whether it is known to be convex: balls, half spaces, polygons and solids of revolution that are.
 */
bool mpsi_body_is_convex(const mps_body *body);

/* A new body of `faces` faces without its shape, at its first position; checks `def`, NULL means
 * the defaults. */
mps_status mpsi_body_new(mps_context *context, const char *function, const mps_body_def *def,
                         int32_t dim, mpsi_shape shape, int64_t faces, mps_body **out);
/* Releases one reference; the last frees. */
void mpsi_body_release(mps_body *body);

/* Sets a new body to the pose of its definition. */
void mpsi_body_begin(mps_body *body);

/* Distance (m) of the furthest point of the surface from the reference point; 0 of half spaces. */
double mpsi_body_extent(const mps_body *body);

/* Memory of a source for all parts of the body; false: refused. Freed by the owner of the source.
 */
bool mpsi_body_make_source(mps_body *body, mpsi_body_source *source);
void mpsi_body_free_source(mps_body *body, mpsi_body_source *source);
/* Adds or removes one of the body's sources. */
void mpsi_body_join(mps_body *body, mpsi_body_source *source);
void mpsi_body_leave(mps_body *body, const mpsi_body_source *source);
/* The source whose solver moves the body, or NULL. */
static inline const mpsi_body_source *mpsi_body_mover(const mps_body *body) {
  const mpsi_body_source *s = body->sources;
  while (s && !s->moves) s = s->next;
  return s;
}
/* MPS_ERROR_STATE where there is one. */
mps_status mpsi_body_check_mover(const mps_body *body, const char *function);
/* Adds the forces (N, N m, of the whole body) of a step of dt by one source, those of its parts;
 * the body's present forces become the sum over its sources. */
void mpsi_body_react(mps_body *body, mpsi_body_source *source, double dt);
/* Adds the impulses (N s, N m s) of its parts, which are no forces of a step, and clears them: the
 * body moves by them in its next step. */
void mpsi_body_strike(mps_body *body, mpsi_body_source *source);
/* MPS_ERROR_ARGUMENT where the body has no such part; -1: all. */
mps_status mpsi_body_check_part(const mps_body *body, const char *function, int32_t part);
/* Adds the reaction of a part to `sum`. */
void mpsi_body_add_reaction(mps_reaction *sum, const mps_reaction *r);
/* Evaluates the signals of a prescribed body for the end of a step of dt that has not begun, so
 * that the body's advance at its end cannot fail. `number` names the body in a record; -1: it has
 * none.
 */
mps_status mpsi_body_look_ahead(mps_body *body, const char *function, int32_t number, double dt);
/* Advances the body by dt: see mps_body_advance. Its signals have been evaluated. */
void mpsi_body_advance(mps_body *body, double dt);
