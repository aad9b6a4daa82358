/* rows.c - see rows.h. SPDX-License-Identifier: BSD-3-Clause */
#include "rows.h"

#include <stdio.h>

enum { MOST = 128, NAME = 48 }; /* columns, bytes */

mps_status rows_begin(result_rows *r, mps_solver *solver, const rows_column *columns) {
  char text[MOST][NAME];
  const char *name[MOST], *unit[MOST];
  int32_t count = 0;
  for (const rows_column *c = columns; c->name; c++)
    for (int k = 0; k < (c->count > 0 ? c->count : 1); k++) {
      if (count == MOST) return MPS_ERROR_INTERNAL;
      if (c->count > 0)
        snprintf(text[count], NAME, "%s_%d", c->name, k + 1);
      else
        snprintf(text[count], NAME, "%s", c->name);
      name[count] = text[count], unit[count++] = c->unit;
    }
  return mps_history_create(solver, "rows", name, unit, count, &r->history);
}

mps_status rows_follow(result_rows *r, const char *directory, const char *name, int64_t every) {
  char path[1300];
  snprintf(path, sizeof path, "%s/%s", directory, name);
  return mps_history_open(r->history, path, every);
}

void rows_look(result_rows *r) {
  mps_view view;
  r->row = NULL, r->count = mps_history_count(r->history);
  if (mps_history_view(r->history, "t", &view) == MPS_OK)
    r->row = view.data; /* the columns of a row follow one another */
}

mps_status rows_add(result_rows *r, const void *row) {
  mps_view view;
  mps_status status = mps_history_view(r->history, "t", &view);
  const double *number = row;
  if (status == MPS_OK)
    status = mps_history_record(r->history, number[0], number + 1, (int32_t)view.stride[0] - 1);
  rows_look(r);
  return status;
}

void rows_end(result_rows *r) {
  mps_history_destroy(&r->history);
  *r = (result_rows){0};
}
