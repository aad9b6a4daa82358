/* hash.h - a hash of bytes (FNV-1a), to compare arguments; not cryptographic.
 * SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include <stddef.h>
#include <stdint.h>

#define MPSI_HASH UINT64_C(0xcbf29ce484222325) /* of nothing */

/* Continues a hash over more bytes. */
static inline uint64_t mpsi_hash(uint64_t hash, const void *data, size_t bytes) {
  const unsigned char *at = data;
  for (size_t k = 0; k < bytes; k++) hash = (hash ^ at[k]) * UINT64_C(0x100000001b3);
  return hash;
}
