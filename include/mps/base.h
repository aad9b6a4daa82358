/* mps/base.h - what every other header of libmps needs: version, status codes, the
 * description of an array (mps_view) and the macros of the ABI.
 *
 * Units: SI throughout (m, kg, s, N, Pa, rad) unless a docstring says otherwise. Coordinates are
 * Cartesian (a right-hand system); no axis is vertical of itself, gravity says which. Angles and
 * rotations are anticlockwise; tension and outward normals are positive.
 *
 * Words of the comments:
 *
 *   definition    a struct mps_x_def that a create or add function reads. Start from
 *                 mps_x_defaults(), which writes struct_size too, and set what differs;
 *                 `reserved` members stay 0
 *   NaN           a real number that is not given, where the comment of a member allows it
 *   lent          a pointer to what the library owns: the caller does not destroy it
 *   kept alive    the object holds a reference: the caller may destroy its own handle at any time
 *   copied        the caller's array may change or go after the call
 *   ..._sized     what an inline function of the name without _sized calls with the size of its
 *                 struct: programs in C and C++ call the inline one
 *   collective    on several ranks (mps/experimental/domain.h) all of them call it
 *   thread safe   any thread may call it at any time
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef LIBMPS_BASE_H
#define LIBMPS_BASE_H

#include <stddef.h>
#include <stdint.h>
#include <string.h>

#define MPS_VERSION_MAJOR 1
#define MPS_VERSION_MINOR 0
#define MPS_VERSION_PATCH 0
#define MPS_VERSION_SUFFIX "-rc.1" /* "" in a release */
/* The same as one number: 10000 major + 100 minor + patch. */
#define MPS_VERSION_NUMBER (MPS_VERSION_MAJOR * 10000 + MPS_VERSION_MINOR * 100 + MPS_VERSION_PATCH)

/* MPS_API_VERSION: the version that a program is written for, as a number like 10200. A program may
 * define it before it includes a header: functions that were deprecated later do not warn. */
#ifndef MPS_API_VERSION
#define MPS_API_VERSION MPS_VERSION_NUMBER
#endif

/* MPS_API: linkage of the functions, which a program may define itself. MPS_STATIC, set by the
 * CMake target mps::mps_static and by pkg-config --static, is for the archive: what links it keeps
 * its copy of the library to itself. */
#ifndef MPS_API
#if !defined(__GNUC__) && !defined(__clang__)
#define MPS_API
#elif defined(MPS_STATIC)
#define MPS_API __attribute__((visibility("hidden")))
#else
#define MPS_API __attribute__((visibility("default")))
#endif
#endif

#if defined(__GNUC__) || defined(__clang__)
#define MPS_NODISCARD __attribute__((warn_unused_result))
#else
#define MPS_NODISCARD
#endif

/* MPS_DEPRECATED(1, 2, "use mps_y"), behind MPS_API: deprecated since 1.2, for programs that are
 * written for 1.2 or later. Every minor version that deprecates a function has a macro here. */
#define MPS_DEPRECATED(major, minor, text) MPS_DEPRECATED_##major##_##minor(text)
#if MPS_API_VERSION >= 10100 && (defined(__GNUC__) || defined(__clang__))
#define MPS_DEPRECATED_1_1(text) __attribute__((deprecated(text)))
#else
#define MPS_DEPRECATED_1_1(text)
#endif

#ifdef __cplusplus
#define MPS_EXTERN_C_BEGIN extern "C" {
#define MPS_EXTERN_C_END }
#else
#define MPS_EXTERN_C_BEGIN
#define MPS_EXTERN_C_END
#endif

MPS_EXTERN_C_BEGIN

/* The one table of status codes: X(name, value, text). */
#define MPS_STATUS_TABLE(X)                                                                        \
  X(OK, 0, "success")                                                                              \
  X(ERROR_ARGUMENT, 1, "an argument is outside its allowed range")                                 \
  X(ERROR_STATE, 2, "the call is not allowed in the object's present state")                       \
  X(ERROR_MEMORY, 3, "memory could not be allocated")                                              \
  X(ERROR_FIELD, 4, "unknown or wrongly shaped particle field")                                    \
  X(ERROR_IO, 5, "a file could not be opened, read or written")                                    \
  X(ERROR_FORMAT, 6, "a file's content is malformed")                                              \
  X(ERROR_DIVERGED, 7, "the computation diverged")                                                 \
  X(ERROR_CANCELLED, 8, "the caller's cancel hook asked to stop")                                  \
  X(ERROR_UNSUPPORTED, 9, "not available in this build or for this input")                         \
  X(ERROR_NUMERIC, 10, "a numerical method failed to converge or met a singular system")           \
  X(ERROR_INTERNAL, 11, "an internal invariant is broken: please report it")

/** Outcome of every fallible call. MPS_OK is zero. Values are never renumbered. The comment of a
 *  function names the statuses that it returns. Beyond these, any function may return
 *  MPS_ERROR_ARGUMENT for a NULL object, array or struct, or a struct_size unknown to this library;
 *  MPS_ERROR_MEMORY where it allocates; MPS_ERROR_STATE where it changes an object whose callback
 *  is running, or where the caller's executor has lost a unit of work; and, on the ranks of a
 *  domain, the status of a rank that has failed. */
typedef enum mps_status {
#define MPS_STATUS_ENTRY(name, value, text) MPS_##name = value,
  MPS_STATUS_TABLE(MPS_STATUS_ENTRY)
#undef MPS_STATUS_ENTRY
      MPS_STATUS_FORCE_32BIT = 0x7fffffff
} mps_status;

/** One-line English text of a status code; never NULL. What was wrong in a call that has failed is
 *  in its record, mps_context_error or mps_last_error (mps/context.h). Thread safe. */
MPS_API const char *mps_status_text(mps_status status);

/** Name of an enumerator: that of `value` in the enumeration called `enumeration`, such as
 *  "MPS_BOUNDARY_HELD" of "mps_boundary_kind"; NULL where there is none. Thread safe. */
MPS_API const char *mps_enumerator_name(const char *enumeration, int32_t value);

/** Version of the library that is linked, "MAJOR.MINOR.PATCH", "-rc.N" behind it before a release.
 *  Thread safe. */
MPS_API const char *mps_version(void);
/** Version of the library as a number, to compare with MPS_VERSION_NUMBER. Thread safe. */
MPS_API int32_t mps_version_number(void);

/* The one table of optional parts: X(name, value, text). */
#define MPS_FEATURE_TABLE(X)                                                                       \
  X(OPENMP, 1, "OpenMP: MPS_CONTEXT_EXECUTOR_OPENMP")                                              \
  X(HDF5, 2, "HDF5: recorders, checkpoints, saving of solvers")                                    \
  X(CHOLMOD, 3, "CHOLMOD: implicit elasticity")                                                    \
  X(ARPACK, 4, "ARPACK: eigenmodes of implicit elasticity")                                        \
  X(EMBREE, 5, "Embree: rigid bodies from meshes of triangles")                                    \
  X(PETSC, 6, "PETSc: domains on several machines")

/** Optional parts of the library. Values are never renumbered. */
typedef enum mps_feature {
#define MPS_FEATURE_ENTRY(name, value, text) MPS_FEATURE_##name = value,
  MPS_FEATURE_TABLE(MPS_FEATURE_ENTRY)
#undef MPS_FEATURE_ENTRY
} mps_feature;

/** 1: this build has the part (MPS_FEATURE_...); 0: not, or the library does not know the number.
 *  Thread safe. */
MPS_API int32_t mps_library_has(int32_t feature);

/** Side of a box along an axis: 2 axis + upper. */
typedef enum mps_side {
  MPS_SIDE_ANY = -1, /* every side, where a function says so */
  MPS_SIDE_X_LOWER = 0,
  MPS_SIDE_X_UPPER = 1,
  MPS_SIDE_Y_LOWER = 2,
  MPS_SIDE_Y_UPPER = 3,
  MPS_SIDE_Z_LOWER = 4,
  MPS_SIDE_Z_UPPER = 5
} mps_side;

/** The side of `axis` (0 to 2); `upper` 0: the lower one. */
static inline int32_t mps_side_of(int32_t axis, int32_t upper) { return 2 * axis + (upper != 0); }

/* The one table of definitions: X(name, kind, struct). */
#define MPS_DEFINITION_TABLE(X)                                                                    \
  X(CONTEXT, 1, mps_context_def)                                                                   \
  X(PARTICLES, 2, mps_particles_def)                                                               \
  X(NEIGHBOURS, 3, mps_neighbours_def)                                                             \
  X(TABLE, 4, mps_table_def)                                                                       \
  X(SIGNAL_RECORD, 5, mps_signal_record_def)                                                       \
  X(RECORDER, 6, mps_recorder_def)                                                                 \
  X(CHECKPOINT, 7, mps_checkpoint)                                                                 \
  X(DOMAIN, 8, mps_domain_def)                                                                     \
  X(COUPLING, 9, mps_coupling_def)                                                                 \
  X(BODY, 10, mps_body_def)                                                                        \
  X(BODY_MOTION, 11, mps_body_motion)                                                              \
  X(CONTACT, 12, mps_contact_def)                                                                  \
  X(MATERIAL_VON_MISES, 13, mps_material_von_mises_def)                                            \
  X(MATERIAL_DRUCKER_PRAGER, 14, mps_material_drucker_prager_def)                                  \
  X(MATERIAL_MOHR_COULOMB, 15, mps_material_mohr_coulomb_def)                                      \
  X(MATERIAL_NEWTONIAN, 16, mps_material_newtonian_def)                                            \
  X(MATERIAL_CAM_CLAY, 17, mps_material_cam_clay_def)                                              \
  X(MATERIAL_SMALL_STRAIN, 18, mps_material_small_strain_def)                                      \
  X(MATERIAL_CYCLIC_SAND, 19, mps_material_cyclic_sand_def)                                        \
  X(MATERIAL_USER, 20, mps_material_user_def)                                                      \
  X(MATERIAL_UMAT, 21, mps_material_umat_def)                                                      \
  X(MATERIAL_BLOCK, 22, mps_material_block)                                                        \
  X(GEOSTATIC, 23, mps_geostatic_def)                                                              \
  X(CONSOLIDATION, 24, mps_consolidation_def)                                                      \
  X(WAVES, 25, mps_waves_def)                                                                      \
  X(ABSORBER, 26, mps_absorber_def)                                                                \
  X(SEPARATION, 27, mps_separation_def)                                                            \
  X(SAINFLOU, 28, mps_sainflou_def)                                                                \
  X(GODA, 29, mps_goda_def)                                                                        \
  X(EUROTOP, 30, mps_eurotop_def)                                                                  \
  X(OVERTOPPING, 31, mps_overtopping_def)                                                          \
  X(MPM, 32, mps_mpm_def)                                                                          \
  X(MPM_BOUNDARY, 33, mps_mpm_boundary_def)                                                        \
  X(MPM_LOAD, 34, mps_mpm_load_def)                                                                \
  X(MPM_SETTLE, 35, mps_mpm_settle_def)                                                            \
  X(PORE_WATER, 36, mps_pore_water_def)                                                            \
  X(PORE_FACE, 37, mps_pore_face_def)                                                              \
  X(DYNAMICS, 39, mps_dynamics_def)                                                                \
  X(DYNAMICS_BOUNDARY, 40, mps_dynamics_boundary_def)                                              \
  X(DYNAMICS_LOAD, 41, mps_dynamics_load_def)                                                      \
  X(DYNAMICS_PREDICT, 42, mps_dynamics_predict_def)                                                \
  X(ELASTIC, 43, mps_elastic_def)                                                                  \
  X(ELASTIC_BOUNDARY, 44, mps_elastic_boundary_def)                                                \
  X(ELASTIC_LOAD, 45, mps_elastic_load_def)                                                        \
  X(ELASTIC_MOTION, 46, mps_elastic_motion_def)                                                    \
  X(FLUID, 48, mps_fluid_def)                                                                      \
  X(FLUID_BOUNDARY, 49, mps_fluid_boundary_def)                                                    \
  X(FLUID_LOAD, 50, mps_fluid_load_def)                                                            \
  X(FLUID_CONTACT, 51, mps_fluid_contact_def)                                                      \
  X(FLUID_ROCK, 52, mps_fluid_rock_def)                                                            \
  X(LINEAR_SOLVER, 54, mps_linear_solver_def)

/** Kinds of definitions, MPS_DEF_<object> of the struct mps_<object>_def, those of experimental
 *  headers too. Values are never renumbered. */
typedef enum mps_def_kind {
  MPS_DEF_BOUNDARY = -1, /* of the functions of mps/solver.h: the solver's own kind of boundary */
  MPS_DEF_LOAD = -2,     /* and of load */
#define MPS_DEF_ENTRY(name, kind, type) MPS_DEF_##name = kind,
  MPS_DEFINITION_TABLE(MPS_DEF_ENTRY)
#undef MPS_DEF_ENTRY
} mps_def_kind;

/** Fills the definition `def` of a kind (MPS_DEF_...), of `size` bytes, with its defaults, for
 * bindings of other languages: in C each mps_<object>_defaults() returns such a struct. Members
 * that this library does not know are 0. MPS_ERROR_ARGUMENT: NULL, a kind or a size that this
 * library does not know. Thread safe. */
MPS_API mps_status mps_def_init(int32_t kind, void *def, size_t size);

/** Element type of a view, laid out as DLPack's DLDataType. Frozen layout: it never gets another
 *  member. */
typedef struct mps_dtype {
  uint8_t code;   /* 0 signed integer, 1 unsigned integer, 2 IEEE float */
  uint8_t bits;   /* 32 or 64 */
  uint16_t lanes; /* 1 */
} mps_dtype;

#define MPS_VIEW_READONLY 1u /* flag: read only */

/** A borrowed array, for reading: nothing is copied. Element (i, c) lies at
 *  data + (i * stride[0] + c * stride[1]) elements. Valid until the owner is destroyed or its
 *  epoch differs from `epoch` (particles inserted, removed or sorted). Frozen layout. */
typedef struct mps_view {
  const void *data;
  int64_t shape[3];  /* shape[0] particles, shape[1] components, shape[2] = 1 */
  int64_t stride[3]; /* in elements, not bytes */
  mps_dtype dtype;
  uint32_t flags; /* MPS_VIEW_... */
  uint64_t epoch;
  int32_t device_type; /* where `data` lies: 0 the processor's memory, which is all that this
                          library uses; any other value as DLPack's DLDeviceType */
  int32_t device_id;   /* 0 */
} mps_view;

/** A borrowed array that is open for writing (mps_particles_edit). Frozen layout. */
typedef struct mps_edit {
  void *data; /* NULL once the edit has ended */
  mps_view
      view; /* of the same elements, for reading; its flags lack MPS_VIEW_READONLY while open */
} mps_edit;

/** Address of element (i, c) of a float64 view; no range check. */
static inline const double *mps_view_f64(const mps_view *view, int64_t i, int64_t c) {
  return (const double *)view->data + i * view->stride[0] + c * view->stride[1];
}

/** Address of element (i, c) of an int64 view; no range check. */
static inline const int64_t *mps_view_i64(const mps_view *view, int64_t i, int64_t c) {
  return (const int64_t *)view->data + i * view->stride[0] + c * view->stride[1];
}

/** Address of element (i, c) of an open float64 field; no range check. */
static inline double *mps_edit_f64(const mps_edit *edit, int64_t i, int64_t c) {
  return (double *)edit->data + i * edit->view.stride[0] + c * edit->view.stride[1];
}

/** Address of element (i, c) of an open int64 field; no range check. */
static inline int64_t *mps_edit_i64(const mps_edit *edit, int64_t i, int64_t c) {
  return (int64_t *)edit->data + i * edit->view.stride[0] + c * edit->view.stride[1];
}

MPS_EXTERN_C_END
#endif
