/* members.c - checks of the numbers of a definition.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "members.h"

#include "digits.h"

#include <math.h>

mps_status mpsi_check_members(mps_context *context, const char *function, const char *owner,
                              size_t count, const mpsi_member *member) {
  for (size_t k = 0; k < count; k++)
    if (!member[k].good)
      return mpsi_fail(context, function, MPS_ERROR_ARGUMENT, "%s of %s is %s, must be %s",
                       member[k].name, owner,
                       mpsi_outside(member[k].value, -INFINITY, INFINITY).text, member[k].allowed);
  return MPS_OK;
}
