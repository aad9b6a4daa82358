/* state_private.h - an item of the list of a solver's state, for the files that make and traverse
 * lists. SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include "state.h"

#define MPSI_STATE_DEPTH 3

/* Address and form of a value. */
typedef enum mpsi_state_width { /* WIDE: as in mpsi_value */
                                MPSI_STATE_WIDE,
                                MPSI_STATE_BOOL,
                                MPSI_STATE_BITS, /* WIDE, of any value */
                                MPSI_STATE_EXACT /* WIDE, sums of exact.h */
} mpsi_state_width;

typedef struct mpsi_state_item {
  char name[MPSI_STATE_NAME];
  mpsi_state_type type;
  mpsi_state_width width;
  bool agrees, text, optional;
  const char *enumeration; /* of an integer that is a choice, or NULL */
  int32_t columns;
  int64_t rows;
  void *data;                    /* NULL: in `own`, or behind `table` */
  const mpsi_state_table *table; /* or NULL */
  void *owner;                   /* of the table */
  mpsi_state_fits_fn fits;       /* optional */
  union {
    int64_t integer;
    double number;
    char text[MPSI_STATE_NAME];
  } own;
} mpsi_state_item;

struct mpsi_state {
  mps_context *context;
  void *solver;
  mpsi_state_item *item;
  int32_t count, capacity;
  bool refused; /* memory */
  char prefix[MPSI_STATE_NAME];
  size_t cut[MPSI_STATE_DEPTH]; /* length of the prefix outside */
  int depth;
};

/* state_list.c: copies the values of an item to memory, and back. */
void mpsi_state_read_item(const mpsi_state_item *from, void *to);
/* Whether the integers of a file can be those of the item. */
bool mpsi_state_bounded(const mpsi_state_item *of, const mpsi_value *from);
/* `from` NULL: an optional table without rows. */
void mpsi_state_write_item(const mpsi_state_item *to, const mpsi_value *from);
