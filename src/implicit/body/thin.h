/* thin.h - warning about slender parts with few cells.
 * SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include <mps/elastic.h>

/* Warns once, before the first solution. */
mps_status mpsi_elastic_warn_of_thin_parts(mps_elastic *e, const char *function);
