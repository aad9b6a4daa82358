/* structs.c - defaults of definitions (in), and results (out) of any size, of an older or a newer
 * program. SPDX-License-Identifier: BSD-3-Clause */
#include "core/internal.h"

#include <string.h>

mps_status mps_def_init(int32_t kind, void *def, size_t size) {
  const mpsi_definition *d = mpsi_definition_of(kind);
  if (!d)
    return mpsi_fail(NULL, __func__, MPS_ERROR_ARGUMENT, "kind is %d, must be one of MPS_DEF_...",
                     kind);
  if (!def) return mpsi_null(__func__, "def");
  if (size < d->released || size > MPSI_STRUCT_MOST)
    return mpsi_fail(NULL, __func__, MPS_ERROR_ARGUMENT,
                     "size is %zu bytes, allowed are %zu to %d: sizeof of the struct that def "
                     "points to",
                     size, d->released, MPSI_STRUCT_MOST);
  mpsi_definition_fill(d, def, size);
  return MPS_OK;
}

mps_status mpsi_out_check(mps_context *context, const char *function, const void *out,
                          size_t size) {
  if (!out) return mpsi_fail(context, function, MPS_ERROR_ARGUMENT, "out is NULL");
  if (size == 0 || size > MPSI_STRUCT_MOST)
    return mpsi_fail(context, function, MPS_ERROR_ARGUMENT,
                     "size is %zu bytes, allowed are 1 to %d: sizeof of the struct that out points "
                     "to",
                     size, MPSI_STRUCT_MOST);
  return MPS_OK;
}

mps_status mpsi_out_write(mps_context *context, const char *function, void *out, size_t size,
                          const void *known, size_t known_size) {
  MPSI_TRY(mpsi_out_check(context, function, out, size));
  memcpy(out, known, size < known_size ? size : known_size);
  if (size > known_size) memset((char *)out + known_size, 0xFF, size - known_size);
  return MPS_OK;
}

mps_status mpsi_def_write(mps_context *context, const char *function, void *out, size_t size,
                          const void *known, size_t known_size) {
  const uint32_t written = (uint32_t)(size < known_size ? size : known_size);
  const mps_status status = mpsi_out_write(context, function, out, size, known, known_size);
  if (status == MPS_OK && size >= sizeof written) memcpy(out, &written, sizeof written);
  return status;
}
