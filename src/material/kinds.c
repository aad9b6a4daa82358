/* kinds.c - the descriptors of the library's laws, from their rows in kinds.h.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "kinds.h"

const char *const mpsi_no_columns[] = {NULL};
const char *const mpsi_metal_columns[] = {"plastic_strain", NULL};
const char *const mpsi_sand_columns[] = {"plastic_strain", "opening", NULL};
const char *const mpsi_clay_columns[] = {"plastic_strain", "preconsolidation", "void_ratio",
                                         "opening", NULL};

#define LAYER(i)                                                                                   \
  "layer_" #i "_xx", "layer_" #i "_yy", "layer_" #i "_xy", "layer_" #i "_zx", "layer_" #i "_yz"
const char *const mpsi_small_columns[] = {
    "plastic_strain", "dissipated", LAYER(1), LAYER(2), LAYER(3),  LAYER(4), LAYER(5),
    LAYER(6),         LAYER(7),     LAYER(8), LAYER(9), LAYER(10), NULL};
_Static_assert(sizeof mpsi_small_columns / sizeof *mpsi_small_columns == MPSI_SMALL_COLUMNS + 1,
               "a name for each column of the small-strain law");

const char *const mpsi_cyclic_columns[] = {
    "plastic_strain", "opening",  "contraction", "contraction_before",
    "half_cycles",    "since_xx", "since_yy",    "since_xy",
    "since_zx",       "since_yz", "far_xx",      "far_yy",
    "far_xy",         "far_zx",   "far_yz",      NULL};
_Static_assert(sizeof mpsi_cyclic_columns / sizeof *mpsi_cyclic_columns == MPSI_CYCLIC_COLUMNS + 1,
               "a name for each column of cyclic sand");

const mpsi_law_type mpsi_law_types[] = {
#define ROW(kind, loop, name, columns, kept, traits, define, moduli)                               \
  {MPSI_LAW_##kind, name, columns, kept, traits, define, moduli},
    MPSI_LAW_KINDS(ROW)
#undef ROW
};
_Static_assert(sizeof mpsi_law_types / sizeof *mpsi_law_types == MPSI_LAW_COUNT,
               "one descriptor for each kind of law");
