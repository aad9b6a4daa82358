/* test_core_parts.c - small parts that all layers use: principal values of symmetric tensors,
 * identifiers. SPDX-License-Identifier: BSD-3-Clause */
#include "kit/random.h"
#include "test_common.h"

#include "core/internal.h"
#include "core/base/symmetric.h"

/* A v = value v, directions orthonormal, also where values coincide or scales differ. */
TEST(principal_values_and_directions) {
  uint64_t seed = 1;
  for (int n = 0; n < 2000; n++) {
    double a[3][3], value[3], axis[3][3], size = 0.0;
    const double scale = pow(10.0, n % 21 - 10.0), small = pow(10.0, -(n % 7) * 3.0);
    for (int i = 0; i < 3; i++)
      for (int j = 0; j <= i; j++)
        a[i][j] = a[j][i] = scale * (i == j ? 1.0 + (n % 2) * noise(&seed) : small * noise(&seed));
    for (int k = 0; k < 9; k++) size = fmax(size, fabs(a[k / 3][k % 3]));
    mpsi_symmetric_principal((const double(*)[3])a, value, axis);
    for (int k = 0; k < 3; k++)
      for (int i = 0; i < 3; i++) {
        double product = 0.0, cosine = 0.0;
        for (int j = 0; j < 3; j++) product += a[i][j] * axis[j][k];
        for (int j = 0; j < 3; j++) cosine += axis[j][i] * axis[j][k];
        NEAR(product, value[k] * axis[i][k], 1e-14 * size);
        NEAR(cosine, i == k, 1e-14);
      }
    double alone[3];
    mpsi_symmetric_principal((const double(*)[3])a, alone, NULL);
    assert_memory_equal(alone, value, sizeof alone);
  }
  const double nothing[3][3] = {{NAN, 1.0, 1.0}, {1.0, 1.0, 1.0}, {1.0, 1.0, 1.0}};
  double value[3];
  mpsi_symmetric_principal(nothing, value, NULL); /* ends */
  assert_true(isnan(value[0]));
}

TEST(the_order_of_components) {
  static const char names[6][3] = {"xx", "yy", "zz", "xy", "zx", "yz"};
  for (int k = 0; k < 6; k++) {
    const char row = "xyz"[mpsi_symmetric_row[k]], column = "xyz"[mpsi_symmetric_column[k]];
    assert_true((names[k][0] == row && names[k][1] == column) ||
                (names[k][0] == column && names[k][1] == row));
  }
}

TEST(identifiers) {
  assert_int_equal(mpsi_identifier("density", 48), 7);
  assert_int_equal(mpsi_identifier("_1", 48), 2);
  assert_int_equal(mpsi_identifier("sand.strain", 48), 4);
  assert_int_equal(mpsi_identifier("", 48), 0);
  assert_int_equal(mpsi_identifier("1st", 48), 0);
  assert_int_equal(mpsi_identifier("a b", 48), 1);
  assert_int_equal(mpsi_identifier("abc", 4), 3);
  assert_int_equal(mpsi_identifier("abcd", 4), 0);
}
