/* options.h - command line options from a table: parsing, checks and --help.
 *
 * A program lists its options with variables that hold the defaults:
 *   option table[] = {
 *     OPTION_HEADING("Ground"),
 *     OPTION_NUMBER("radius", "m", OPTION_LENGTH, &radius, "particle radius R"),
 *     {0}};
 * --name VALUE and --name=VALUE both work. Numbers are read strictly, and always with a point.
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef EXAMPLES_OPTIONS_H
#define EXAMPLES_OPTIONS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

typedef struct option_range {
  double lower, upper;
  bool open; /* `lower` itself is not allowed */
} option_range;

/* Of physical quantities: wide enough for any model of soil, structures or water, and narrow enough
 * that no computation with them overflows. */
#define OPTION_LENGTH                                                                              \
  { 1e-6, 1e6, false } /* m */
#define OPTION_DURATION                                                                            \
  { 1e-9, 1e6, false } /* s */
#define OPTION_SPEED                                                                               \
  { 1e-6, 1e5, false } /* m/s */
#define OPTION_FREQUENCY                                                                           \
  { 1e-4, 1e6, false } /* Hz */
#define OPTION_ACCELERATION                                                                        \
  { -1e5, 1e5, false } /* m/s2 */
#define OPTION_GRAVITY                                                                             \
  { 0.0, 1e4, false } /* m/s2 */
#define OPTION_DENSITY                                                                             \
  { 1e-3, 1e5, false } /* kg/m3 */
#define OPTION_MODULUS                                                                             \
  { 1e-3, 1e10, false } /* kPa: 1 Pa to 10 TPa */
#define OPTION_STRENGTH                                                                            \
  { 0.0, 1e8, false } /* kPa */
#define OPTION_STIFFNESS                                                                           \
  { 1e-6, 1e13, false } /* kN/m */
#define OPTION_FROM_TO(lower, upper)                                                               \
  { (lower), (upper), false }
#define OPTION_ABOVE_TO(lower, upper)                                                              \
  { (lower), (upper), true }

/* One row; exactly one of the pointers is set, none for a heading. */
typedef struct option {
  const char *name; /* without the dashes */
  const char *unit; /* unit, or what the value is: FILE; of a choice: "S|P" */
  const char *help;
  option_range range; /* of numbers and integers */
  int count;          /* of numbers separated by commas; 0 and 1: one number */
  bool *flag;
  double *number; /* NaN: there is no default, or help tells it */
  int64_t *integer;
  const char **text;
  int *choice; /* index into `unit` */
  bool given;  /* written by options_parse */
} option;

/* Rows of the table. */
#define OPTION_HEADING(help_)                                                                      \
  { .help = (help_) }
#define OPTION_FLAG(name_, value, help_)                                                           \
  { .name = (name_), .flag = (value), .help = (help_) }
#define OPTION_NUMBER(name_, unit_, range_, value, help_)                                          \
  { .name = (name_), .unit = (unit_), .range = range_, .number = (value), .help = (help_) }
#define OPTION_INTEGER(name_, unit_, range_, value, help_)                                         \
  { .name = (name_), .unit = (unit_), .range = range_, .integer = (value), .help = (help_) }
#define OPTION_TEXT(name_, unit_, value, help_)                                                    \
  { .name = (name_), .unit = (unit_), .text = (value), .help = (help_) }
#define OPTION_CHOICE(name_, choices, value, help_)                                                \
  { .name = (name_), .unit = (choices), .choice = (value), .help = (help_) }
/* Rows that every program has. */
#define OPTION_THREADS(value)                                                                      \
  OPTION_INTEGER("threads", "N", OPTION_FROM_TO(0.0, 1024.0), value, "threads; 0: all processors")
#define OPTION_OUT(value) OPTION_TEXT("out", "DIR", value, "directory of the results")

typedef struct options_program {
  const char *name;    /* "mps-wave" */
  const char *purpose; /* one or two sentences, for --help */
  option *table;       /* ends with an empty row */
} options_program;

/* Parses the arguments. Returns -1 to go on, or the exit code: 0 after --help and --version, 2
 * after one error line to stderr, 1 when help could not be written. */
int options_parse(const options_program *program, int argc, char **argv);
/* True when the option was on the command line. */
bool options_given(const option *table, const char *name);
/* "name=value" lines of all options but those of `except` (ends with NULL; NULL: none), to be kept
 * with a checkpoint. False when `size` is too small. */
bool options_record(const option *table, const char *const *except, char *text, size_t size);
/* Compares with such lines. False, and in `why` the first option that differs: "--rest is 0.2 s,
 * was 0.3". */
bool options_agree(const option *table, const char *const *except, const char *record, char *why,
                   size_t size);

/* One error line about a combination of options, as the parser's own. Returns 2. */
int options_refuse(const options_program *program, const char *reason);

/* Reads a finite decimal number that takes up the whole text. */
bool options_number(const char *text, double *out);
/* Reads `count` lengths > 0 with an x between them, such as 5x2; false when `text` is not that. */
bool options_lengths(const char *text, int count, double *const *out);

#endif
