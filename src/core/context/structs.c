/* structs.c - definitions (in) and results (out) of any size, of an older or a newer program.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "core/internal.h"

#include <string.h>

mps_status mpsi_def_init(void *def, size_t size, size_t minimum, const void *defaults,
                         size_t defaults_size) {
  if (!def || size < minimum || size > MPSI_STRUCT_MOST) return MPS_ERROR_ARGUMENT;
  memset(def, 0, size);
  memcpy(def, defaults, size < defaults_size ? size : defaults_size);
  const uint32_t stored = (uint32_t)size;
  memcpy(def, &stored, sizeof stored); /* struct_size is the first member of every definition */
  return MPS_OK;
}

mps_status mpsi_def_read(mps_context *context, const char *function, const void *def,
                         size_t minimum, void *known, size_t known_size) {
  if (!def) return mpsi_fail(context, function, MPS_ERROR_ARGUMENT, "def is NULL");
  uint32_t size;
  memcpy(&size, def, sizeof size);
  if (size < minimum || size > MPSI_STRUCT_MOST)
    return mpsi_fail(context, function, MPS_ERROR_ARGUMENT,
                     "def.struct_size is %u bytes, allowed are %zu to %d: start from the "
                     "_defaults() or _def_init function",
                     size, minimum, MPSI_STRUCT_MOST);
  for (size_t i = known_size; i < size; i++)
    if (((const unsigned char *)def)[i] != 0)
      return mpsi_fail(context, function, MPS_ERROR_UNSUPPORTED,
                       "def has a non-zero member at byte %zu that this library (version %s) does "
                       "not know",
                       i, mps_version());
  memcpy(known, def, size < known_size ? size : known_size);
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
  const mps_status status = mpsi_out_check(context, function, out, size);
  if (status != MPS_OK) return status;
  memcpy(out, known, size < known_size ? size : known_size);
  if (size > known_size) memset((char *)out + known_size, 0, size - known_size);
  return MPS_OK;
}

mps_status mpsi_def_write(mps_context *context, const char *function, void *out, size_t size,
                          const void *known, size_t known_size) {
  const uint32_t written = (uint32_t)(size < known_size ? size : known_size);
  const mps_status status = mpsi_out_write(context, function, out, size, known, known_size);
  if (status == MPS_OK && size >= sizeof written) memcpy(out, &written, sizeof written);
  return status;
}
