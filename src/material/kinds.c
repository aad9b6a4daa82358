/* kinds.c - the descriptors of the library's laws, from their rows in kinds.h.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "kinds.h"

const char *const mpsi_no_columns[] = {NULL};
const char *const mpsi_metal_columns[] = {"plastic_strain", NULL};
const char *const mpsi_sand_columns[] = {"plastic_strain", "opening", NULL};
const char *const mpsi_clay_columns[] = {"plastic_strain", "preconsolidation", "void_ratio",
                                         "opening", NULL};

const mpsi_law_type mpsi_law_types[] = {
#define ROW(kind, loop, name, columns, kept, traits, define, moduli)                               \
  {MPSI_LAW_##kind, name, columns, kept, traits, define, moduli},
    MPSI_LAW_KINDS(ROW)
#undef ROW
};
_Static_assert(sizeof mpsi_law_types / sizeof *mpsi_law_types == MPSI_LAW_COUNT,
               "one descriptor for each kind of law");
