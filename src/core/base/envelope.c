/* envelope.c - see envelope.h. SPDX-License-Identifier: BSD-3-Clause */
#include "envelope.h"

#include <string.h>

#define LEAST_PIVOT 1e-8 /* of the diagonal */

bool mpsi_envelope_begin(mps_context *context, mpsi_envelope *e, int64_t rows) {
  if (!mpsi_room_ensure(context, &e->first_room, rows, sizeof *e->first) ||
      !mpsi_room_ensure(context, &e->start_room, rows, sizeof *e->start))
    return false;
  e->rows = rows;
  e->first = e->first_room.item, e->start = e->start_room.item;
  for (int64_t i = 0; i < rows; i++) e->first[i] = (int32_t)i;
  return true;
}

double mpsi_envelope_work(const mpsi_envelope *e) {
  double work = 0.0;
  for (int64_t i = 0; i < e->rows; i++) {
    const double length = (double)(i - e->first[i]);
    work += length * length;
  }
  return work;
}

bool mpsi_envelope_make(mps_context *context, mpsi_envelope *e) {
  e->entries = 0;
  for (int64_t i = 0; i < e->rows; i++) {
    e->start[i] = e->entries;
    e->entries += i - e->first[i];
  }
  const int64_t all = e->entries + e->rows;
  if (!mpsi_room_ensure(context, &e->value_room, all, sizeof *e->value)) return false;
  e->value = e->value_room.item;
  e->diagonal = e->value + e->entries;
  memset(e->value, 0, (size_t)all * sizeof *e->value);
  return true;
}

/* In four partial sums, independent of the compiler's choices. */
static double dot(int64_t count, const double *a, const double *b) {
  double sum[4] = {0.0, 0.0, 0.0, 0.0};
  int64_t k = 0;
  for (; k + 4 <= count; k += 4)
    for (int c = 0; c < 4; c++) sum[c] += a[k + c] * b[k + c];
  for (; k < count; k++) sum[0] += a[k] * b[k];
  return (sum[0] + sum[1]) + (sum[2] + sum[3]);
}

/* Row by row: first L D, which the row's own later entries need, then L. */
void mpsi_envelope_factor(mpsi_envelope *e) {
  for (int64_t i = 0; i < e->rows; i++) {
    double *row = e->value + e->start[i], own = e->diagonal[i];
    const int64_t first = e->first[i];
    for (int64_t j = first; j < i; j++) {
      const int64_t from = e->first[j] > first ? e->first[j] : first;
      row[j - first] -=
          dot(j - from, row + (from - first), e->value + e->start[j] + (from - e->first[j]));
    }
    for (int64_t j = first; j < i; j++) {
      const double l = row[j - first] * e->diagonal[j];
      own -= l * row[j - first];
      row[j - first] = l;
    }
    e->diagonal[i] = own > LEAST_PIVOT * e->diagonal[i] ? 1.0 / own : 0.0;
  }
}

void mpsi_envelope_solve(const mpsi_envelope *e, double *x) {
  for (int64_t i = 0; i < e->rows; i++)
    x[i] -= dot(i - e->first[i], e->value + e->start[i], x + e->first[i]);
  for (int64_t i = 0; i < e->rows; i++) x[i] *= e->diagonal[i];
  for (int64_t i = e->rows - 1; i >= 0; i--) {
    const double *row = e->value + e->start[i], here = x[i];
    double *to = x + e->first[i];
    for (int64_t k = 0; k < i - e->first[i]; k++) to[k] -= row[k] * here;
  }
}

void mpsi_envelope_drop(mps_context *context, mpsi_envelope *e) {
  MPSI_FREE(context, e->first_room.item, e->start_room.item, e->value_room.item);
  *e = (mpsi_envelope){0};
}
