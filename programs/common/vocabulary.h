/* vocabulary.h - the one table of the options of all programs: name, kind of the value, unit, range
 * and meaning, which are the same in every program that has the option. A program lists its own
 * with their defaults, and where it must a narrower range and a few words; see options.h.
 * SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include "options.h"

typedef enum option_kind {
  OPTION_IS_FLAG,
  OPTION_IS_NUMBER,
  OPTION_IS_INTEGER,
  OPTION_IS_TEXT,
  OPTION_IS_CHOICE
} option_kind;

/* Completes a program's table. NULL, or what is wrong with the option *name of it: no program with
 * such a table starts. */
const char *vocabulary_complete(option *table, const char **name);
bool vocabulary_has(const char *name);

/* The unit in which a number of that option is likelier to be meant, where it is far below the
 * usual values of the quantity in SI units, and the program's default is not; NULL: none. */
const char *vocabulary_likelier_unit(const option *o, double value);

/* Of another name of an option of the program, a former one or that of another program for nearly
 * the same: "poisson", or "frames N: how many of them, ..." where the value has another meaning. */
bool vocabulary_find_other(const option *table, const char *name, char *out, size_t size);
