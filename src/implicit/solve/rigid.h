/* rigid.h - rigid motions without support.
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef MPSI_ELASTIC_RIGID_H
#define MPSI_ELASTIC_RIGID_H

#include <mps/elastic.h>

/* MPS_ERROR_STATE, naming the rigid motions without support. */
mps_status mpsi_elastic_check_supported(mps_elastic *e, const char *function);

#endif
