/* symmetric.c - see symmetric.h. SPDX-License-Identifier: BSD-3-Clause */
#include "symmetric.h"

#include <math.h>
#include <string.h>

const int mpsi_symmetric_row[6] = {0, 1, 2, 0, 2, 1}, mpsi_symmetric_column[6] = {0, 1, 2, 1, 0, 2};

/* One rotation in the plane (i, j): a[i][j] becomes zero. */
static void rotate(double a[3][3], double (*axis)[3], int i, int j) {
  const int k = 3 - i - j;
  if (fabs(a[i][j]) < 1e-150) return; /* its square would vanish */
  const double gap = a[j][j] - a[i][i], twice = 2.0 * a[i][j];
  const double root = sqrt(gap * gap + twice * twice);
  const double t = twice / (gap < 0.0 ? gap - root : gap + root);
  const double c = 1.0 / sqrt(1.0 + t * t), s = t * c, move = t * a[i][j];
  const double ki = a[k][i], kj = a[k][j];
  a[i][i] -= move;
  a[j][j] += move;
  a[i][j] = a[j][i] = 0.0;
  a[k][i] = a[i][k] = c * ki - s * kj;
  a[k][j] = a[j][k] = s * ki + c * kj;
  for (int r = 0; axis && r < 3; r++) {
    const double vi = axis[r][i], vj = axis[r][j];
    axis[r][i] = c * vi - s * vj;
    axis[r][j] = s * vi + c * vj;
  }
}

/* It converges quadratically; 12 sweeps are far more than it ever needs, and end the iteration for
 * a NaN. */
void mpsi_symmetric_principal(const double (*matrix)[3], double *value, double (*axis)[3]) {
  double a[3][3];
  memcpy(a, matrix, sizeof a);
  for (int k = 0; axis && k < 9; k++) axis[k / 3][k % 3] = k % 4 == 0 ? 1.0 : 0.0;
  for (int sweep = 0; sweep < 12; sweep++) {
    const double off = fabs(a[0][1]) + fabs(a[1][2]) + fabs(a[2][0]);
    const double size = fabs(a[0][0]) + fabs(a[1][1]) + fabs(a[2][2]);
    if (off <= 1e-16 * size) break;
    rotate(a, axis, 0, 1);
    rotate(a, axis, 1, 2);
    rotate(a, axis, 0, 2);
  }
  for (int k = 0; k < 3; k++) value[k] = a[k][k];
}
