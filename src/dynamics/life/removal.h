/* removal.h - particles that leave between two steps.
 * SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include <mps/dynamics.h>

mps_status mpsi_dynamics_remove(void *self, const char *function, int64_t count,
                                const int64_t *ids);
void mpsi_dynamics_renew(void *self);
