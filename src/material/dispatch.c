/* dispatch.c - chooses the laws' loops for the processor at run time.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "material_private.h"

#include "core/context/levels.h"

const mpsi_law_table *mpsi_laws_select(int32_t isa) {
  const int32_t level = mpsi_level(isa);
#ifdef MPSI_X86_LEVELS
  if (level == 4) return &mpsi_laws_v4;
  if (level == 3) return &mpsi_laws_v3;
#endif
  return level == 1 ? &mpsi_laws_v1 : NULL;
}
