/* rigid.h - rigid motions without support.
 * SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include <mps/elastic.h>

/* MPS_ERROR_STATE, naming the rigid motions without support. */
mps_status mpsi_elastic_check_supported(mps_elastic *e, const char *function);
