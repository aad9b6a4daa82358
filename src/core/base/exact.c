/* exact.c - see exact.h.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "exact.h"

#include <string.h>

#define TOP (MPSI_EXACT_VALUE - 1) /* the limb that carries the sign */
#define LOW UINT64_C(0xffffffff)
#define MANTISSA 53
#define MOST_TERMS (INT64_C(1) << 29) /* each adds less than 2^33 to a limb */

enum { NOT_A_NUMBER = MPSI_EXACT_VALUE, PLUS, MINUS, TERMS };

void mpsi_exact_carry(mpsi_exact *sum) {
  int64_t carry = 0;
  for (int k = 0; k < TOP; k++) {
    const int64_t value = sum->limb[k] + carry, low = (int64_t)((uint64_t)value & LOW);
    sum->limb[k] = low;
    carry = (value - low) / (INT64_C(1) << 32); /* exact, towards minus infinity */
  }
  sum->limb[TOP] += carry;
  sum->limb[TERMS] = 0;
}

void mpsi_exact_add(mpsi_exact *sum, double term) {
  uint64_t bits;
  memcpy(&bits, &term, sizeof bits);
  uint64_t mantissa = bits & ((UINT64_C(1) << (MANTISSA - 1)) - 1);
  int exponent = (int)(bits >> (MANTISSA - 1) & 0x7ff);
  const bool negative = bits >> 63;
  if (exponent == 0x7ff) {
    sum->limb[mantissa ? NOT_A_NUMBER : negative ? MINUS : PLUS]++;
    return;
  }
  if (exponent > 0) mantissa |= UINT64_C(1) << (MANTISSA - 1), exponent--;
  if (mantissa == 0) return;
  const int k = exponent / 32, shift = exponent % 32;
  const uint64_t low = (mantissa & LOW) << shift, high = (mantissa >> 32) << shift;
  const int64_t part[3] = {(int64_t)(low & LOW), (int64_t)((low >> 32) + (high & LOW)),
                           (int64_t)(high >> 32)};
  for (int p = 0; p < 3; p++) sum->limb[k + p] += negative ? -part[p] : part[p];
  if (++sum->limb[TERMS] >= MOST_TERMS) mpsi_exact_carry(sum);
}

void mpsi_exact_merge(mpsi_exact *to, const mpsi_exact *from) {
  if (to->limb[TERMS] + from->limb[TERMS] >= MOST_TERMS) mpsi_exact_carry(to);
  for (int k = 0; k < MPSI_EXACT_LIMBS; k++) to->limb[k] += from->limb[k];
}

bool mpsi_exact_is_sum(const int64_t limb[MPSI_EXACT_LIMBS]) {
  const int64_t terms = limb[TERMS], most = INT64_C(1) << 53;
  if (terms < 0 || terms >= MOST_TERMS) return false;
  const int64_t largest = (terms << 33) + (INT64_C(1) << 60); /* merged sums have no terms */
  for (int k = 0; k < MPSI_EXACT_VALUE; k++)
    if (limb[k] > largest || limb[k] < -largest) return false;
  for (int k = NOT_A_NUMBER; k <= MINUS; k++)
    if (limb[k] < 0 || limb[k] > most) return false;
  return true;
}

/* 53 bits from bit `lowest` on, of limbs that have been carried. */
static uint64_t bits_from(const mpsi_exact *sum, int lowest) {
  const int k = lowest / 32, shift = lowest % 32;
  uint64_t bits = 0;
  for (int p = 0; p < 3 && k + p < MPSI_EXACT_VALUE; p++) {
    const uint64_t limb = (uint64_t)sum->limb[k + p];
    const int place = 32 * p - shift;
    if (place < 64) bits |= place < 0 ? limb >> -place : limb << place;
  }
  return bits & ((UINT64_C(1) << MANTISSA) - 1);
}

static bool any_below(const mpsi_exact *sum, int bit) {
  for (int k = 0; k < bit / 32; k++)
    if (sum->limb[k]) return true;
  return (uint64_t)sum->limb[bit / 32] & ((UINT64_C(1) << bit % 32) - 1);
}

double mpsi_exact_value(const mpsi_exact *from) {
  mpsi_exact sum = *from;
  if (sum.limb[NOT_A_NUMBER] || (sum.limb[PLUS] && sum.limb[MINUS])) return NAN;
  if (sum.limb[PLUS] || sum.limb[MINUS]) return sum.limb[PLUS] ? INFINITY : -INFINITY;
  mpsi_exact_carry(&sum);
  const bool negative = sum.limb[TOP] < 0;
  if (negative) {
    for (int k = 0; k < MPSI_EXACT_VALUE; k++) sum.limb[k] = -sum.limb[k];
    mpsi_exact_carry(&sum);
  }
  int top = TOP, highest = 31;
  while (top >= 0 && sum.limb[top] == 0) top--;
  if (top < 0) return 0.0;
  if (sum.limb[top] > (int64_t)LOW) return negative ? -INFINITY : INFINITY;
  while (!((uint64_t)sum.limb[top] >> highest & 1)) highest--;
  highest += 32 * top;
  const int lowest = highest >= MANTISSA ? highest - MANTISSA + 1 : 0;
  uint64_t mantissa = bits_from(&sum, lowest);
  if (lowest > 0) { /* to the nearest, halves to even */
    const bool half = (uint64_t)sum.limb[(lowest - 1) / 32] >> (lowest - 1) % 32 & 1;
    if (half && ((mantissa & 1) || any_below(&sum, lowest - 1))) mantissa++;
  }
  const double value = ldexp((double)mantissa, lowest - 1074);
  return negative ? -value : value;
}
