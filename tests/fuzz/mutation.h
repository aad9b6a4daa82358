/* mutation.h - damage to a file in memory, the same on every machine.
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef TESTS_FUZZ_MUTATION_H
#define TESTS_FUZZ_MUTATION_H

#include <stdint.h>
#include <string.h>

/* xorshift */
static uint32_t random_state;
static uint32_t random_below(uint32_t n) {
  random_state ^= random_state << 13;
  random_state ^= random_state >> 17;
  random_state ^= random_state << 5;
  return random_state % n;
}

enum { ROOM = 16384 }; /* bytes of a damaged file at most */

/* Puts `length` (at most 64) bytes in the place of `cut` ones; returns the new size. */
static size_t replace(char *data, size_t size, size_t at, size_t cut, const char *by,
                      size_t length) {
  char copy[64];
  if (cut > size - at) cut = size - at;
  if (length > sizeof copy || size - cut + length > ROOM) return size;
  memcpy(copy, by, length);
  memmove(data + at + length, data + at + cut, size - at - cut);
  memcpy(data + at, copy, length);
  return size - cut + length;
}

#endif
