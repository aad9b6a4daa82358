/* change.h - particles removed, or restored by a former state.
 * SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include <mps/elastic.h>

/* The holder's functions. */
mps_status mpsi_elastic_remove(void *self, const char *function, int64_t count, const int64_t *ids);
void mpsi_elastic_renew(void *self);
/* For a state to restore (core/state.h): prepares, then replaces the body by that of the state. */
mps_status mpsi_elastic_prepare_state(void *self, const char *function, const mps_snapshot *from,
                                      const char *source, mps_status disagreement);
void mpsi_elastic_bind(void *self);
void mpsi_elastic_drop_change(mps_elastic *e);
