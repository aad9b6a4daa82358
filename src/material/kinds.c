/* kinds.c - the descriptors of the library's laws, from their rows in kinds.h.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "kinds.h"

const mpsi_law_type mpsi_law_types[] = {
#define ROW(kind, loop, name, columns, kept, traits, define, moduli)                               \
  {MPSI_LAW_##kind, name, columns, kept, traits, define, moduli},
    MPSI_LAW_KINDS(ROW)
#undef ROW
};
_Static_assert(sizeof mpsi_law_types / sizeof *mpsi_law_types == MPSI_LAW_COUNT,
               "one descriptor for each kind of law");
