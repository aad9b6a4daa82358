/* vocabulary.h - the one table of the options of all programs: name, kind of the value, unit, range
 * and meaning, which are the same in every program that has the option. A program lists its own
 * with their defaults, and where it must a narrower range and a few words; see options.h.
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef EXAMPLES_VOCABULARY_H
#define EXAMPLES_VOCABULARY_H

#include "options.h"

typedef enum option_kind {
  OPTION_IS_FLAG,
  OPTION_IS_NUMBER,
  OPTION_IS_INTEGER,
  OPTION_IS_TEXT,
  OPTION_IS_CHOICE
} option_kind;

option_kind vocabulary_kind(const option *o);
/* Completes a program's table. NULL, or what is wrong with the option *name of it: no program with
 * such a table starts. */
const char *vocabulary_complete(option *table, const char **name);
bool vocabulary_has(const char *name);

/* The unit in which a number of that option is likelier to be meant, where it is far below the
 * usual values of the quantity in SI units, and the program's default is not; NULL: none. */
const char *vocabulary_likelier_unit(const option *o, double value);

/* Another name of an option: a former one, or that of another program for nearly the same. */
typedef struct vocabulary_other {
  const char *name;  /* "nu" */
  const char *now;   /* "poisson" */
  const char *value; /* meaning of the value, where that differs: " N, ..."; NULL: the same */
} vocabulary_other;
/* The row of another name of an option of the program; NULL: none. */
const vocabulary_other *vocabulary_find_other(const option *table, const char *name);

#endif
