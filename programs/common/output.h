/* output.h - result files: the directory, CSV and JSON. A file is written under a temporary name
 * and takes its own only when it is complete, so that a full disk never spoils an older result.
 * SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include "app.h"

#include <stdio.h>

/* Makes the directory `path` with its parents, and locks it until this process ends: an error where
 * another one has it. */
bool output_directory(app *a, const char *path);

typedef struct output {
  app *a;
  FILE *stream;
  char *path, *temporary;
  int error;     /* errno of the first failed write, 0: none */
  bool first;    /* JSON: no member yet */
  char *columns; /* CSV: as given to csv_header */
  int64_t rows;  /* CSV: written so far */
  char bad[160]; /* the first cell that should have had a number, "": none */
} output;

/* A new file, in place of one that a killed program has left; it follows no link. Its descriptor,
 * or -1 and errno: EEXIST where the name is a link or anything else but a file. */
int output_exclusive(const char *path);

/* Opens DIR/NAME for writing. False, with an error line, when that fails: `file` is then closed. */
bool output_open(output *file, app *a, const char *directory, const char *name);
/* Ends the file. False, with an error line, when anything could not be written: then DIR/NAME is
 * unchanged. Does nothing (false) for a file that is not open. */
bool output_close(output *file);

/* Leaves out the file: DIR/NAME is unchanged. */
void output_discard(output *file);

/* Ends the file as output_close does, but leaves it under its temporary name: for results that are
 * written where Ctrl-C ends the program at once, see app_leave_at_once. */
bool output_reserve(output *file);

/* The writers keep the first error for output_close. No result file holds a NaN or an infinity: a
 * number that does not exist is an empty cell, or null. */
void output_text(output *file, const char *format, ...) APP_PRINTF(2, 3);
void output_list(output *file, const char *format, va_list args);

/* The line with the names of the columns, "t_s,x_m,theory_m?": those with a question mark may lack
 * numbers in some rows. An empty cell of the others is a warning, which names the column. */
void csv_header(output *file, const char *columns);
/* output_open and csv_header. */
bool csv_open(output *file, app *a, const char *directory, const char *name, const char *columns);
/* One line of `count` numbers. */
void csv_row(output *file, int64_t count, const double *values);
#define CSV_LINE(file, ...)                                                                        \
  csv_row((file), (int64_t)(sizeof((double[]){__VA_ARGS__}) / sizeof(double)),                     \
          (const double[]){__VA_ARGS__})
/* Writes the same after `text`, one or more columns separated by commas. */
void csv_named_row(output *file, const char *text, int64_t count, const double *values);

/* A JSON object, a member a line. */
void json_begin(output *file);
/* null where the number does not exist: NaN, or an infinity. */
void json_number(output *file, const char *key, double value);
/* Several: JSON_NUMBERS(file, {"x", x}, {"y", y}). */
typedef struct json_pair {
  const char *key;
  double value;
} json_pair;
void json_numbers(output *file, int64_t count, const json_pair *pairs);
#define JSON_NUMBERS(file, ...)                                                                    \
  json_numbers((file), (int64_t)(sizeof((json_pair[]){__VA_ARGS__}) / sizeof(json_pair)),          \
               (const json_pair[]){__VA_ARGS__})
void json_integer(output *file, const char *key, int64_t value);
void json_text(output *file, const char *key, const char *text);
void json_end(output *file);
/* `known`: json_number, json_integer; else null. */
void json_number_if(output *file, bool known, const char *key, double value);
void json_integer_if(output *file, bool known, const char *key, int64_t value);

/* Opens DIR/summary.json and writes what every summary begins with: program, version, outcome,
 * options (in the units of --help; but those of where and how it runs, such as --out), warnings. */
bool summary_open(output *file, app *a, const char *directory);
/* A summary.json with nothing else, of a run that ended without results. */
bool summary_bare(app *a, const char *directory);
/* The same by output_reserve, for a run that Ctrl-C may end at once. */
bool summary_reserve(app *a, const char *directory);

/* Shortest decimal text that reads back as `value`. */
const char *output_number(char text[32], double value);
