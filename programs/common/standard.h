/* standard.h - the one table of the options that mean the same in several programs: name, unit,
 * range and help. A program lists its own, with its own default, and where it must its own range;
 * see COMMON_... in options.h.
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef EXAMPLES_STANDARD_H
#define EXAMPLES_STANDARD_H

#include "options.h"

/* Completes the rows of a program's table that are in the common one. False, and in *name which one
 * it is, where the common table does not have it. */
bool standard_complete(option *table, const char **name);

/* The unit in which a number of that option is likelier to be meant, where it is far below the
 * usual values of the quantity in SI units, and the program's default is not; NULL: none. */
const char *standard_likelier_unit(const option *o, double value);

/* Former name of an option. */
typedef struct standard_former {
  const char *name; /* "nu" */
  const char *now;  /* "poisson" */
  const char
      *value; /* present meaning of the value, where that has changed: " N, ..."; NULL: the same */
} standard_former;
/* The row of a former name of an option; NULL: none. */
const standard_former *standard_find_former(const option *table, const char *name);

#endif
