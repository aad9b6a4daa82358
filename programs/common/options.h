/* options.h - command line options from a table: parsing, checks and --help.
 *
 * A program lists its options with variables and defaults:
 *   option table[] = {
 *     OPTION_HEADING("Ground"),
 *     OPTION_NUMBER("young", &young, "of the plate", 2e11),
 *     OPTION_NUMBER_IN("phi", OPTION_FROM_TO(0.1, 50.0), &phi, NULL, 30.0),
 *     {0}};
 * Kind, unit, range and meaning are those of the table of all options (vocabulary.c); a row may
 * have another range, and adds words of its own or NULL. --name VALUE and --name=VALUE both work;
 * an option given twice is an error. Numbers are read strictly, and always with a point; they are
 * in the unit that --help shows or have one of their own (units.h). SPDX-License-Identifier:
 * BSD-3-Clause */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

typedef struct option_range {
  double lower, upper;
  bool open; /* `lower` itself is not allowed */
} option_range;

#define OPTION_FROM_TO(lower, upper)                                                               \
  { (lower), (upper), false }
#define OPTION_ABOVE_TO(lower, upper)                                                              \
  { (lower), (upper), true }

/* One row; exactly one of the pointers is set, none for a heading. */
typedef struct option {
  const char *name;   /* without the dashes */
  const char *unit;   /* unit, or kind of the value: FILE; of a choice: "S|P" */
  const char *help;   /* of a heading; else written by options_parse */
  const char *note;   /* of the program, after the help; NULL: none */
  double standard;    /* default of a number, integer or choice; 0: what the variable holds */
  option_range range; /* of numbers and integers */
  int count;          /* of numbers separated by commas; 0 and 1: one number */
  bool *flag;
  double *number; /* NaN: there is no default, or it is in the help */
  int64_t *integer;
  const char **text;
  int *choice; /* index into `unit` */
  /* written by options_parse */
  bool given;
  const char *typed; /* on the command line; NULL: not there */
  bool bare;         /* a number without a unit */
  double usual;      /* the default of a number */
} option;

/* Rows of the table: name, variable, note or NULL, and a default other than 0. */
#define OPTION_HEADING(help_)                                                                      \
  { .help = (help_) }
#define OPTION_FLAG(name_, value, note_)                                                           \
  { .name = (name_), .flag = (value), .note = (note_) }
#define OPTION_NUMBER(name_, value, ...)                                                           \
  { .name = (name_), .number = (value), .note = __VA_ARGS__ }
#define OPTION_NUMBER_IN(name_, range_, value, ...)                                                \
  { .name = (name_), .range = range_, .number = (value), .note = __VA_ARGS__ }
#define OPTION_NUMBERS(name_, count_, value, ...)                                                  \
  { .name = (name_), .count = (count_), .number = (value), .note = __VA_ARGS__ }
#define OPTION_INTEGER(name_, value, ...)                                                          \
  { .name = (name_), .integer = (value), .note = __VA_ARGS__ }
#define OPTION_INTEGER_IN(name_, range_, value, ...)                                               \
  { .name = (name_), .range = range_, .integer = (value), .note = __VA_ARGS__ }
#define OPTION_TEXT(name_, value, note_)                                                           \
  { .name = (name_), .text = (value), .note = (note_) }
#define OPTION_CHOICE(name_, value, ...)                                                           \
  { .name = (name_), .choice = (value), .note = __VA_ARGS__ }
/* Where the table of all leaves it to the program, or of some of the words there: "S|P", "WxH". */
#define OPTION_TEXT_OF(name_, what_, value, note_)                                                 \
  { .name = (name_), .unit = (what_), .text = (value), .note = (note_) }
#define OPTION_CHOICE_OF(name_, words_, value, ...)                                                \
  { .name = (name_), .unit = (words_), .choice = (value), .note = __VA_ARGS__ }
/* Rows that every program has. */
#define OPTIONS_OF_ALL(s)                                                                          \
  OPTION_TEXT("out", &(s)->out, NULL), OPTION_INTEGER("threads", &(s)->threads, NULL)

typedef struct options_program {
  const char *name;    /* "mps-wave" */
  const char *purpose; /* one or two sentences, for --help */
  option *table;       /* ends with an empty row */
} options_program;

/* Parses the arguments. Returns -1 to continue, or the exit code: 0 after --help and --version, 2
 * after one error line to stderr, 1 when help could not be written. */
int options_parse(const options_program *program, int argc, char **argv);
/* One option from a file, `where` "flume.yaml, line 7": checked as on the command line, after
 * options_parse; `value` is kept by the caller. Then options_again reads the command line once
 * more, which counts where both give an option. Return as options_parse. */
int options_set(const options_program *program, const char *where, const char *name,
                const char *value);
int options_again(const options_program *program, int argc, char **argv);
/* Values of options that a flag such as --paper names, as on the command line. */
typedef struct option_preset {
  const char *name, *value; /* NULL: the end */
} option_preset;
/* Sets those that are not given; they stay so for options_given. Return as options_parse. */
int options_prefer(const options_program *program, const option_preset *presets);
/* True when the option was on the command line or in a file. */
bool options_given(const option *table, const char *name);
/* Options of the output and execution of a run, such as --out, which a restarted run may change. */
bool options_free(const char *name);
/* "name=value" lines of all other options, to be kept with a checkpoint. False when `size` is too
 * small. */
bool options_record(const option *table, char *text, size_t size);
/* Compares with such lines, but for `others`, "a|b" or NULL. False, and in `why` the first option
 * that differs: "--rest is 0.2 s, was 0.3". */
bool options_agree(const option *table, const char *record, const char *others, char *why,
                   size_t size);

/* "--young is 200 Pa: write 200kPa if that is meant": the k-th number of those read last that has
 * no unit and is far below what is usual, as one of another unit may be. False: there is none. */
bool options_doubt(int k, char *out, size_t size);

/* A warning that app_start prints and puts into summary.json: what was made of an option. */
void options_note(const char *format, ...);
/* The k-th of these; NULL: there are no more. */
const char *options_noted(int k);
/* Rounds *part to `whole` over the nearest whole number, or with `half` a half more than one, which
 * it returns; where that is another length, notes it: `of` "--side". */
double options_divide(const char *name, double *part, const char *of, double whole, bool half);

/* Rounds *length to the nearest whole multiple of `part`, `of` "--cell", and notes it. */
void options_whole(const char *name, double *length, const char *of, double part);

/* One error line about a combination of options, as the parser's own. Where `reason` names options
 * that were not given, the line ends with their defaults and the values of the others. Returns 2.
 */
int options_refuse(const options_program *program, const char *reason);
/* What an option needs, such as "--case float", and whether that is so. */
typedef struct options_need {
  const char *option, *needs;
  bool given;
} options_need;
/* Refuses the first of `count` options that was given and lacks what it needs. Returns -1, or the
 * exit code. */
int options_check_needs(const options_program *program, const options_need *need, size_t count);

/* The k-th word of the command line as a shell reads it; false: there are no more. */
bool options_word(int k, char *out, size_t size);

/* The value of an option as JSON, in the unit of the table: a number, text, true or false,
 * [numbers]; null where there is none. */
void options_json(const option *o, char *out, size_t size);
/* The rows that options_parse has read last, with their present values; NULL: none yet. */
const option *options_read(void);

/* Reads a finite decimal number that takes up the whole text. */
bool options_number(const char *text, double *out);
/* Reads `count` numbers > 0, in `unit` or with one of their own, with an x between them, such as
 * 5x2; false when `text` is not that. */
bool options_lengths(const char *text, const char *unit, int count, double *const *out);
