/* mock.h - a stand-in for preCICE with another code behind it: an implicit coupling whose time
 * windows are repeated, as preCICE repeats them until both codes agree. The force on the vertices
 * of the left side rises linearly in time; in repetitions that do not yet agree it is wrong.
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef TESTS_PRECICE_MOCK_H
#define TESTS_PRECICE_MOCK_H

typedef struct mock_def {
  double window;   /* s */
  int windows;     /* how many */
  int repetitions; /* of each; 1: explicit coupling */
  double rate;     /* of the datum on each vertex, per s */
  /* Another code in place of that: data of `size` vertices (x: 2 values each) at time t, `right` in
   * the repetition that is kept; and what it receives of the step that begins at t. NULL: none. */
  void (*give)(void *user, const char *data, double t, int right, int size, const double *x,
               double *values);
  void (*take)(void *user, const char *data, double t, int right, int size, const double *values);
  void *user;
} mock_def;

typedef struct mock_seen {
  int vertices, left;         /* all, and on the left side */
  int writes, reads, windows; /* calls of write and read, completed windows */
  int checkpoints, rollbacks; /* that were asked for */
  double displacement;        /* m: largest along x that was written in a repetition that agrees */
  const char *wrong;          /* the first call that preCICE would refuse; NULL: none */
} mock_seen;

extern mock_def mock;
extern mock_seen mock_was;

#endif
