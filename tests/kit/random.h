/* random.h - pseudo-random numbers that are the same on every machine: Knuth's MMIX generator, the
 * upper 53 bits. SPDX-License-Identifier: BSD-3-Clause */
#ifndef MPS_TEST_KIT_RANDOM_H
#define MPS_TEST_KIT_RANDOM_H

#include <stdint.h>

static inline double random_part(uint64_t *seed) { /* in [0, 1) */
  *seed = *seed * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
  return (double)(*seed >> 11) * 0x1p-53;
}

static inline double noise(uint64_t *seed) { return 2.0 * random_part(seed) - 1.0; }

/* Of the program's own sequence. */
__attribute__((unused)) static uint64_t random_seed = 1;
static inline double uniform(double low, double high) {
  return low + (high - low) * random_part(&random_seed);
}

#endif
