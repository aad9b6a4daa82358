/* mps/experimental/neighbours.h - fixed-radius neighbour lists by a cell list, for arbitrary
 * positions. Thread rule: one thread at a time per context. SPDX-License-Identifier: BSD-3-Clause
 */
#ifndef LIBMPS_EXPERIMENTAL_NEIGHBOURS_H
#define LIBMPS_EXPERIMENTAL_NEIGHBOURS_H

#ifndef MPS_EXPERIMENTAL
#error                                                                                             \
    "experimental interface, which may change in any minor release: #define MPS_EXPERIMENTAL first"
#endif

#include "../context.h"

MPS_EXTERN_C_BEGIN

typedef struct mps_neighbours mps_neighbours;

typedef struct mps_neighbours_def {
  uint32_t struct_size;
  int32_t dim;   /* 2 (default) or 3 */
  double radius; /* m, 1e-150 to 1e150, no default: j is a neighbour of i when |x_j - x_i| < radius,
                    j != i */
  int32_t half;  /* 1: each pair once, at the smaller index; 0 (default): at both */
  int32_t reserved; /* 0 */
} mps_neighbours_def;

static inline mps_neighbours_def mps_neighbours_defaults(void) {
  mps_neighbours_def def;
  memset(&def, 0, sizeof def);
  if (mps_def_init(MPS_DEF_NEIGHBOURS, &def, sizeof def) != MPS_OK) def.struct_size = 0;
  return def;
}

/** Creates an object without lists, which keeps the context alive. MPS_ERROR_ARGUMENT: NULL, `dim`
 *  or `radius` out of range. */
MPS_API MPS_NODISCARD mps_status mps_neighbours_create(mps_context *context,
                                                       const mps_neighbours_def *def,
                                                       mps_neighbours **out);
/** Destroys and nulls; accepts NULL. Frees the lists. */
MPS_API void mps_neighbours_destroy(mps_neighbours **neighbours);

/** Builds the lists of all pairs closer than the radius. `position` is a float64 view of shape (n,
 *  dim), 0 <= n < 2^32, finite, any extent and order: memory is O(n + pairs), not that of the
 *  bounding box. Uses the context's threads; the result does not depend on their number. On an
 *  error the former lists stay: MPS_ERROR_FIELD: `position` has another type or shape;
 *  MPS_ERROR_ARGUMENT: a position is not finite; MPS_ERROR_MEMORY. Building again with about as
 *  many particles and pairs allocates nothing. */
MPS_API MPS_NODISCARD mps_status mps_neighbours_build(mps_neighbours *neighbours,
                                                      const mps_view *position);

/** The lists in compressed rows: neighbours of i are indices[offsets[i]] .. indices[offsets[i + 1]
 *  - 1], ascending. `offsets` has n + 1 entries. Borrowed until the next build or the destruction.
 *  Each output may be NULL. Before the first build `count` is 0. MPS_ERROR_ARGUMENT: `neighbours`
 *  NULL. */
MPS_API MPS_NODISCARD mps_status mps_neighbours_lists(const mps_neighbours *neighbours,
                                                      int64_t *count, const int64_t **offsets,
                                                      const int64_t **indices);

MPS_EXTERN_C_END
#endif
