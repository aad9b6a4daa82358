/* dispatch.c - chooses the laws' loops for the processor at run time.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "material_private.h"

#include "core/context/levels.h"

MPSI_DISPATCH(mpsi_law_table, mpsi_laws_select, mpsi_laws)
