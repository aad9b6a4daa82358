/* mps/base.h - what every other header of libmps needs: version, status codes, the
 * description of an array (mps_view) and the macros of the ABI.
 *
 * Units: SI throughout (m, kg, s, N, Pa, rad) unless a docstring says otherwise.
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef LIBMPS_BASE_H
#define LIBMPS_BASE_H

#include <stddef.h>
#include <stdint.h>
#include <string.h>

#define MPS_VERSION_MAJOR 0
#define MPS_VERSION_MINOR 3
#define MPS_VERSION_PATCH 0

#if defined(__GNUC__) || defined(__clang__)
#define MPS_API __attribute__((visibility("default")))
#define MPS_NODISCARD __attribute__((warn_unused_result))
#else
#define MPS_API
#define MPS_NODISCARD
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

/** One-line English text of a status code; never NULL. Thread safe. */
MPS_API const char *mps_status_text(mps_status status);

/** Version of the headers as one number: 10000 major + 100 minor + patch. */
#define MPS_VERSION_NUMBER (MPS_VERSION_MAJOR * 10000 + MPS_VERSION_MINOR * 100 + MPS_VERSION_PATCH)

/** Version of the library that is linked, "MAJOR.MINOR.PATCH". Thread safe. */
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
enum {
#define MPS_FEATURE_ENTRY(name, value, text) MPS_FEATURE_##name = value,
  MPS_FEATURE_TABLE(MPS_FEATURE_ENTRY)
#undef MPS_FEATURE_ENTRY
};

/** 1: this build has the part (MPS_FEATURE_...); 0: not, or the library does not know the number.
 *  Thread safe. */
MPS_API int32_t mps_library_has(int32_t feature);
/** One line on the part, NULL for a number that the library does not know: the parts are those from
 *  1 to the first NULL. Thread safe. */
MPS_API const char *mps_library_feature_name(int32_t feature);
/** 1: processor and build have inner loops of this x86-64 level (1, 3 or 4; 1 is always there).
 *  Thread safe. */
MPS_API int32_t mps_library_has_level(int32_t level);

/** Element type of a view, laid out as DLPack's DLDataType. Frozen layout. */
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
