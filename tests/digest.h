/* digest.h - a number that shows whether two runs ended in the same bits.
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef MPS_TEST_DIGEST_H
#define MPS_TEST_DIGEST_H

#include "test_common.h"

#define DIGEST_START 14695981039346656037u /* FNV-1a */

/* Adds the bits of one value to a digest. */
static inline uint64_t digest_add(uint64_t hash, const void *value) {
  uint64_t bits;
  memcpy(&bits, value, sizeof bits);
  return (hash ^ bits) * 1099511628211u;
}

/* Of the fields `names`, NULL at the end. */
static inline uint64_t digest_fields(mps_particles *particles, const char *const *names) {
  uint64_t hash = DIGEST_START;
  for (; *names; names++) {
    mps_view view = view_field(particles, *names);
    for (int64_t c = 0; c < view.shape[1]; c++)
      for (int64_t k = 0; k < view.shape[0]; k++)
        hash = digest_add(hash,
                          (const char *)view.data + 8 * (k * view.stride[0] + c * view.stride[1]));
  }
  return hash;
}

#endif
