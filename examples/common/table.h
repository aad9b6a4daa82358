/* table.h - a file of rows of numbers, such as soil layers or the points of a line.
 *
 * One row a line, numbers separated by commas, semicolons or blanks, '#' begins a comment, and one
 * header line may come first. SPDX-License-Identifier: BSD-3-Clause */
#ifndef EXAMPLES_TABLE_H
#define EXAMPLES_TABLE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum { TABLE_COLUMNS = 8 };

typedef struct table_def {
  const char *row;                         /* what a row is: "layer" */
  const char *columns;                     /* their names, for errors: "thickness_m, vs_m_s" */
  int count;                               /* of columns, at most TABLE_COLUMNS */
  int64_t most;                            /* rows */
  const char *(*fault)(const double *row); /* why a row is wrong: "thickness_m must be > 0"; NULL */
} table_def;

/* Reads the file: `count` values a row, room for `most` rows. False: `why` has "path:line: reason".
 */
bool table_read(const char *path, const table_def *def, double *values, int64_t *rows, char *why,
                size_t size);

#endif
