/* same.c - comparison of the fields of two sets.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "kit/same.h"

/* Every field has 8 bytes a value. */
static const char *value_at(const mps_view *v, int64_t row, int64_t component) {
  return (const char *)v->data + 8 * (row * v->stride[0] + component * v->stride[1]);
}

static void compare(mps_particles *a, mps_particles *b, bool by_id, const char *what) {
  const int64_t count = mps_particles_count(a);
  mps_view id;
  assert_int_equal(mps_particles_count(b), count);
  assert_int_equal(mps_particles_field_count(b), mps_particles_field_count(a));
  OK(mps_particles_view(a, "id", &id));
  for (int32_t f = 0; f < mps_particles_field_count(a); f++) {
    mps_particles_field_info info;
    mps_view x, y;
    OK(mps_particles_get_field_info(a, f, &info));
    OK(mps_particles_view(a, info.name, &x));
    OK(mps_particles_view(b, info.name, &y));
    for (int64_t k = 0; k < count; k++) {
      const int64_t other = by_id ? mps_particles_index(b, *mps_view_i64(&id, k, 0)) : k;
      if (other < 0) fail_msg("%s: particle %lld is missing", what, (long long)k);
      for (int64_t c = 0; c < x.shape[1]; c++)
        if (memcmp(value_at(&x, k, c), value_at(&y, other, c), 8) != 0)
          fail_msg("%s: %s[%d] of the particle at index %lld", what, info.name, (int)c,
                   (long long)k);
    }
  }
}

void assert_same_rows(mps_particles *a, mps_particles *b, const char *what) {
  compare(a, b, false, what);
}

void assert_same_by_id(mps_particles *a, mps_particles *b, const char *what) {
  compare(a, b, true, what);
}
