/* histories.h - the rows of a history (mps/history.h) as part of its solver's state, and its file.
 * SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include "solver_base.h"

enum { MPSI_HISTORY_NAME = 32, MPSI_HISTORY_TEXT = 64, MPSI_HISTORY_COLUMNS = 4096 };

typedef struct mpsi_history_column {
  char name[MPSI_HISTORY_TEXT], unit[MPSI_HISTORY_TEXT];
  mps_history_fn source; /* NULL: given by the caller */
  void *user;
  mps_release_fn release;
} mpsi_history_column;

/* A file that follows the rows, of rank 0. */
typedef struct mpsi_history_file {
  char *path; /* NULL: none, on all ranks */
  int fd;     /* -1: not made yet */
  int64_t every;
  int64_t rows; /* in the file that are those in memory; beyond them it may have others */
  int64_t *end; /* rows + 1 places in the file, of the ends of the header and of each row */
  int64_t ends; /* there is memory for */
} mpsi_history_file;

struct mps_history {
  mps_context *context;
  mps_domain *domain;
  mps_solver *solver; /* NULL: destroyed */
  mps_history *next;  /* of the solver */
  char name[MPSI_HISTORY_NAME];
  mpsi_history_column *column; /* the first is the time */
  int64_t width;
  double *row; /* [rows][width] */
  int64_t rows, capacity;
  uint64_t epoch;
  bool busy; /* a source is being asked */
  mpsi_history_file file;
  char *names; /* of all columns, a line each: what a state must agree with */
};

/* Lists the rows of all histories of the solver. */
void mpsi_histories_list_state(mpsi_state *state, void *solver);
/* The solver ends: its histories remain, with the rows that they have. */
void mpsi_histories_leave(mps_solver *solver);

/* history_file.c: of the rank that writes. */
mps_status mpsi_history_write_file(const mps_history *history, const char *function,
                                   const char *path);
mps_status mpsi_history_try_path(mps_context *context, const char *function, const char *path);
/* Appends the rows that the file lacks. */
mps_status mpsi_history_append(mps_history *history, const char *function);
void mpsi_history_close_file(mps_history *history);
