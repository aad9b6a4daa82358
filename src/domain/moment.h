/* moment.h - states that ranks go back to. SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include "domain/domain_internal.h"

/* Collective: status of all ranks, and MPS_ERROR_ARGUMENT where they are about to go back to states
 * of different steps or times; `to` NULL is an error too. Nothing has changed then. It is read
 * where `status` is MPS_OK. */
mps_status mpsi_domain_agree_moment(mps_domain *domain, const char *function, mps_status status,
                                    const mps_snapshot *to);
