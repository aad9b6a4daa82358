/* rows.h - rows of results of a run, kept by a history of its solver (mps/history.h): they are in
 * its checkpoints, and a restart brings them back. A row is a struct of doubles, whose first is the
 * time (s). SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include "app.h"

#include <mps/history.h>

/* Members of the struct behind the time, in their order. */
typedef struct rows_column {
  const char *name, *unit;
  int count; /* of an array: "name_1", "name_2", ...; 0: a number */
} rows_column;

typedef struct result_rows {
  mps_history *history;
  const void *row; /* `count` structs; moves with rows_add and rows_look */
  int64_t count;
} result_rows;

/* An empty history of the solver; `columns` end with a name NULL. */
mps_status rows_begin(result_rows *r, mps_solver *solver, const rows_column *columns);
/* Shows them in DIRECTORY/NAME during the run, in blocks of `every`. */
mps_status rows_follow(result_rows *r, const char *directory, const char *name, int64_t every);
mps_status rows_add(result_rows *r, const void *row);
/* After a restart. */
void rows_look(result_rows *r);
void rows_end(result_rows *r);
