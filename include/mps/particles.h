/* mps/particles.h - a set of particles: positions on or off a lattice, and named fields.
 *
 * Storage is a structure of arrays: each component of a field is one contiguous array, aligned to
 * 64 bytes. docs/fields.md lists the fields that the library knows, with unit and range. Fields are
 * read through zero-copy views and written between mps_particles_edit and mps_particles_commit.
 * Each particle has an `id` that no other one had or will have; ids need not be consecutive.
 * Adding, removing and sorting change the order and the epoch, and end views. Thread rule: one
 * thread at a time per set (and per context). SPDX-License-Identifier: BSD-3-Clause */
#ifndef LIBMPS_PARTICLES_H
#define LIBMPS_PARTICLES_H

#include "context.h"

MPS_EXTERN_C_BEGIN

typedef struct mps_particles mps_particles;

typedef struct mps_particles_def {
  uint32_t struct_size;
  int32_t dim;      /* 2 (default) or 3 */
  double spacing;   /* D, m, 1e-12 to 1e12; no default */
  double origin[3]; /* m, default 0; the fills put particles at origin + (i + 1/2) D (cell centred),
                       so that a box of whole spacings is filled exactly */
} mps_particles_def;

static inline mps_particles_def mps_particles_defaults(void) {
  mps_particles_def def;
  memset(&def, 0, sizeof def);
  if (mps_def_init(MPS_DEF_PARTICLES, &def, sizeof def) != MPS_OK) def.struct_size = 0;
  return def;
}

/** Creates an empty set, which keeps the context alive. It has the fields `id` and `position`;
 *  others are added by name. MPS_ERROR_ARGUMENT: NULL, `dim` or `spacing` out of range, a place
 *  beyond 1e15 m; MPS_ERROR_MEMORY. */
MPS_API MPS_NODISCARD mps_status mps_particles_create(mps_context *context,
                                                      const mps_particles_def *def,
                                                      mps_particles **out);
/** Creates a set with the same particles, of the same context: ids, order, all fields, spacing,
 *  origin, and the lattice sites that fills have occupied. It is independent of the first: no
 *  solver, no recorder and no domain has it. Of a set on several ranks it has the particles of this
 *  rank; not collective. Allowed in callbacks of a solver. MPS_ERROR_ARGUMENT: NULL;
 *  MPS_ERROR_STATE: a field is being edited; MPS_ERROR_MEMORY. */
MPS_API MPS_NODISCARD mps_status mps_particles_copy(const mps_particles *particles,
                                                    mps_particles **out);
/** Releases the caller's reference and nulls; accepts NULL. A solver that uses the set keeps it
 *  alive. */
MPS_API void mps_particles_destroy(mps_particles **particles);

/* Queries; 0 for NULL. */

/** Present number of particles. */
MPS_API int64_t mps_particles_count(const mps_particles *particles);
/** 2 or 3. */
MPS_API int32_t mps_particles_dim(const mps_particles *particles);
/** D, m. */
MPS_API double mps_particles_spacing(const mps_particles *particles);
/** Changes whenever the order or number of particles does. */
MPS_API uint64_t mps_particles_epoch(const mps_particles *particles);

/* ---- filling -------------------------------------------------------------------------------
 * Every fill appends and may be repeated; `added` (may be NULL) receives the number of particles
 * appended, other fields of the new particles are zero. On any error nothing is appended. A solver
 * that holds the set may refuse positions outside its domain, or (MPS_ERROR_STATE) all. Lattice
 * fills never put a second particle on a lattice site that an earlier lattice fill occupied. Sites
 * are numbered x fastest, then y, then z; a shape may hold up to 2^31 sites. A site's centre within
 * 1e-9 spacings of a bound counts as on it: in at `lo` and at the left and lower edges of a
 * polygon, out at `hi`, at the right and upper edges and on the surface of a ball. So shapes that
 * share an edge share no site. What is made has whole sites: where a face of a box, or an edge of a
 * polygon along an axis, lies more than 1e-6 spacings off the faces of the lattice, or a ball's
 * volume differs by more than a tenth, a warning says what was asked for and what is made. A solver
 * refuses particles that share a place (1e-6 spacings), and logs a warning where particles fill
 * space above 1.5 of its volume, as two clouds that overlap do. */

/** Appends `count` particles at given positions: positions[i * dim + c] in m, within 1e15 m. This
 *  and the fills, of a set that lies on several ranks (mps/experimental/domain.h): collective; all
 * ranks pass the same arguments, and each keeps the particles of its part. MPS_ERROR_ARGUMENT:
 * `count` or a position out of range; MPS_ERROR_STATE: the solver that holds the set takes no
 * particles; MPS_ERROR_MEMORY. */
MPS_API MPS_NODISCARD mps_status mps_particles_append(mps_particles *particles, int64_t count,
                                                      const double *positions);
/** Lattice sites whose centre lies in the box [lo, hi) (dim values each, m). MPS_ERROR_ARGUMENT: an
 *  empty box, or one of more than 2^31 sites; MPS_ERROR_STATE and MPS_ERROR_MEMORY as
 *  mps_particles_append. */
MPS_API MPS_NODISCARD mps_status mps_particles_fill_box(mps_particles *particles, const double *lo,
                                                        const double *hi, int64_t *added);
/** 2D: lattice sites inside the simple polygon of `vertices` corners xy[2 * k], xy[2 * k + 1] (m,
 *  either sense, not closed, convex or not). At least 3 corners; no two edges may intersect, except
 *  neighbours at their common corner. MPS_ERROR_ARGUMENT: `vertices`, a corner or the set's
 *  dimension is not allowed, or edges intersect; MPS_ERROR_STATE and MPS_ERROR_MEMORY as
 *  mps_particles_append. */
MPS_API MPS_NODISCARD mps_status mps_particles_fill_polygon(mps_particles *particles,
                                                            int64_t vertices, const double *xy,
                                                            int64_t *added);
/** Lattice sites inside the disc (2D) or ball (3D) of `radius` (m, > 0) about `centre`.
 *  MPS_ERROR_ARGUMENT: `centre` or `radius` out of range, or more than 2^31 sites; MPS_ERROR_STATE
 *  and MPS_ERROR_MEMORY as mps_particles_append. */
MPS_API MPS_NODISCARD mps_status mps_particles_fill_ball(mps_particles *particles,
                                                         const double *centre, double radius,
                                                         int64_t *added);
/** Writes to *inside, 0 on entry, 1 where the position x (m, dim values) receives a particle. Any
 *  status but MPS_OK ends the call, which returns it with a record and adds nothing. It must not
 *  use the set. */
typedef mps_status (*mps_particles_predicate_fn)(void *user, const double *x, int32_t *inside);
/** Lattice sites in the box [lo, hi) at which inside(user, x, ...) gives 1. MPS_ERROR_ARGUMENT:
 *  `inside` NULL, an empty box, or one of more than 2^31 sites; MPS_ERROR_STATE and
 *  MPS_ERROR_MEMORY as mps_particles_append; or the status of `inside`. */
MPS_API MPS_NODISCARD mps_status mps_particles_fill_where(mps_particles *particles,
                                                          const double *lo, const double *hi,
                                                          mps_particles_predicate_fn inside,
                                                          void *user, int64_t *added);

/** Removes `count` particles, by their ids (all different). The other particles keep their ids and
 *  their order; the lattice sites of removed particles stay occupied. On an error nothing has
 *  changed. MPS_ERROR_ARGUMENT: an id that the set lacks, or one twice; MPS_ERROR_STATE: the solver
 *  that holds the set does not allow it, or a field is being edited. On several ranks collective:
 *  all pass the same list, or each the ids of its own particles. */
MPS_API MPS_NODISCARD mps_status mps_particles_remove(mps_particles *particles, const int64_t *ids,
                                                      int64_t count);

/* ---- fields -------------------------------------------------------------------------------- */

/** Description of a field. Strings live as long as the field. */
typedef struct mps_particles_field_info {
  const char *name;
  const char *unit;
  const char *meaning;
  mps_dtype dtype;
  int32_t components;
  uint32_t flags; /* MPS_VIEW_READONLY where only the library writes */
} mps_particles_field_info;

/** Adds a field, zero filled. A name of the library's field table (docs/fields.md) gets its
 *  documented type; there `components` must be 0 or the table's. "user.NAME" (NAME
 *  [A-Za-z_][A-Za-z0-9_]*, at most 47 characters) makes a field of the caller's own, of
 *  `components` float64 (1..16), whose name no later version takes. Other names are refused. The
 *  history of a law, "<law>.<column>", is added by the solver that the law is given to. Adding a
 *  field that exists with the same shape does nothing. Keeps the epoch. On several ranks all add
 *  the same fields. MPS_ERROR_ARGUMENT: no such name (the message says what to write);
 *  MPS_ERROR_FIELD: the field has another number of components; MPS_ERROR_MEMORY. */
MPS_API MPS_NODISCARD mps_status mps_particles_add_field(mps_particles *particles, const char *name,
                                                         int32_t components);
/** Removes a field and its memory. The epoch changes: views end. On several ranks all remove the
 *  same fields before the next step, which is else refused. MPS_ERROR_FIELD: no such field.
 * MPS_ERROR_STATE: `id` or `position`, which every set has; while a solver holds the set any field
 * but the caller's own ("user.NAME"), as the solver may read it; a field that a recorder writes; a
 * field is being edited, or a solver's callback is running. */
MPS_API MPS_NODISCARD mps_status mps_particles_remove_field(mps_particles *particles,
                                                            const char *name);
/** 1 where the set has a field of that name, else 0; 0 for NULL. */
MPS_API int32_t mps_particles_has_field(const mps_particles *particles, const char *name);
/** Borrows a field for reading (MPS_VIEW_READONLY), until the epoch changes. MPS_ERROR_FIELD when
 *  the set has none of that name (the message lists the names it has). */
MPS_API MPS_NODISCARD mps_status mps_particles_view(mps_particles *particles, const char *name,
                                                    mps_view *out);
/** Borrows a field for writing, until mps_particles_commit or _abandon: meanwhile steps of solvers,
 *  and adding or removing particles, return MPS_ERROR_STATE. Several fields may be open at once,
 *  each once. The set keeps memory for the former values. MPS_ERROR_FIELD: no such field, or one
 *  that only the library writes. MPS_ERROR_STATE: it is open already, or a solver that holds the
 *  set is running this callback (mps/solver.h). */
MPS_API MPS_NODISCARD mps_status mps_particles_edit(mps_particles *particles, const char *name,
                                                    mps_edit *out);
/** Ends the editing of a field. Its values must be finite and in the field's range
 *  (docs/fields.md), and satisfy the solver that holds the set: positions inside its domain. It
 *  reads them before its next step, and renews neighbours and blocks of particles only where that
 *  is `position`. On MPS_ERROR_ARGUMENT, which names the particle, the field stays open with the
 *  values written: correct them and commit again. Then `edit->data` is NULL, and the view is for
 *  reading as any other. MPS_ERROR_STATE: `edit` is of no open field. */
MPS_API MPS_NODISCARD mps_status mps_particles_commit(mps_particles *particles, mps_edit *edit);
/** Ends the editing with the values from before mps_particles_edit; solvers are not notified.
 *  MPS_ERROR_ARGUMENT: NULL; MPS_ERROR_STATE: `edit` is of no open field. */
MPS_API MPS_NODISCARD mps_status mps_particles_abandon(mps_particles *particles, mps_edit *edit);
/** Sets component `component` of a float64 field to `value` (in the field's range) for every
 *  particle, adding a field of the table that the set lacks; edit and commit in one.
 *  MPS_ERROR_ARGUMENT: `component` or `value` out of range; MPS_ERROR_FIELD: no such field, or one
 *  of int64; MPS_ERROR_STATE: the field is being edited, or a solver's callback is running. */
MPS_API MPS_NODISCARD mps_status mps_particles_set(mps_particles *particles, const char *name,
                                                   int32_t component, double value);
/** Sets a field, or one component of it, from an array, adding a field of the table that the set
 *  lacks; edit and commit in one: on an error nothing has changed. `count` is the number of
 *  particles, value i that of the particle at present index i. `component` 0 and above: `values`
 *  has `count` numbers, as a column of a view has; -1: all components, values[i * components + c].
 *  All are in the unit and range of the field; of a field of int64 whole numbers within 2^53. They
 *  are copied. On several ranks each gives those of its own particles; not collective.
 *  MPS_ERROR_ARGUMENT: `component`, `count` or one of `values`, whose particle the message names,
 *  or a value that the solver refuses that holds the set; MPS_ERROR_FIELD: no such field, or one
 *  that only the library writes; MPS_ERROR_STATE: the field is being edited, or a solver's callback
 *  is running; MPS_ERROR_MEMORY. */
MPS_API MPS_NODISCARD mps_status mps_particles_set_array(mps_particles *particles, const char *name,
                                                         int32_t component, const double *values,
                                                         int64_t count);
/** Number of fields, with `id` and `position`. */
MPS_API int32_t mps_particles_field_count(const mps_particles *particles);
/** Describes field `index` (0 to the count - 1, in order of addition). MPS_ERROR_ARGUMENT: `index`
 *  out of range, NULL, or a `size` unknown to this library. */
MPS_API MPS_NODISCARD mps_status mps_particles_get_field_info_sized(const mps_particles *particles,
                                                                    int32_t index,
                                                                    mps_particles_field_info *out,
                                                                    size_t size);
MPS_NODISCARD static inline mps_status mps_particles_get_field_info(const mps_particles *particles,
                                                                    int32_t index,
                                                                    mps_particles_field_info *out) {
  return mps_particles_get_field_info_sized(particles, index, out, sizeof *out);
}

/* ---- selection ----------------------------------------------------------------------------- */

/** Ids of the particles with position in the box [lo, hi] (dim values, infinities allowed), in
 *  ascending order. Writes at most `capacity` of them to `ids` (may be NULL when capacity is 0);
 *  `count` receives their number. MPS_ERROR_ARGUMENT: a NULL array, `capacity` below 0, lo above
 *  hi; MPS_ERROR_STATE: a field is being edited; MPS_ERROR_MEMORY. */
MPS_API MPS_NODISCARD mps_status mps_particles_select_box(const mps_particles *particles,
                                                          const double *lo, const double *hi,
                                                          int64_t capacity, int64_t *count,
                                                          int64_t *ids);
/** Present index of the particle `id` in every view, or -1. */
MPS_API int64_t mps_particles_index(const mps_particles *particles, int64_t id);
/** Id of the particle nearest to x (dim values, m), the lowest of equally near ones; -1 for an
 *  empty set, and with MPS_ERROR_STATE recorded while a field is being edited. Takes time in
 *  proportion to the number of particles. */
MPS_API int64_t mps_particles_nearest(const mps_particles *particles, const double *x);

MPS_EXTERN_C_END
#endif
