/* members.h - checks of the numbers of a definition, as a table that says what is allowed.
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef MPSI_MEMBERS_H
#define MPSI_MEMBERS_H

#include "core/internal.h"

/* A member of a definition. */
typedef struct mpsi_member {
  const char *name, *allowed; /* "depth", "in (0, 1e12] m" */
  double value;
  bool good; /* whether the value is allowed */
} mpsi_member;

/* MPS_ERROR_ARGUMENT "<name> of <owner> is <value>, must be <allowed>" for the first member of the
 * table that is not good. */
mps_status mpsi_check_members(mps_context *context, const char *function, const char *owner,
                              size_t count, const mpsi_member *member);
#define MPSI_CHECK_MEMBERS(context, function, owner, table)                                        \
  mpsi_check_members(context, function, owner, sizeof(table) / sizeof *(table), table)

#endif
