/* access.h - guard of the public functions, agreement of ranks, ids, fields of the set as vectors.
 * SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include "domain/domain_internal.h"

#include <mps/elastic.h>

#include <stdbool.h>

/* MPS_ERROR_STATE within a callback of the solver; until `leave` it is busy. */
mps_status mpsi_elastic_enter(mps_elastic *e, const char *function);
mps_status mpsi_elastic_leave(mps_elastic *e, mps_status status);
/* MPS_ERROR_STATE on all ranks while a field is edited on one. */
mps_status mpsi_elastic_ready(void *elastic, const char *function);
/* On several ranks: an error of one is that of all. All ranks make the same calls, up to the first
 * that returns an error; `leave` is the last. */
mps_status mpsi_elastic_agree(void *elastic, const char *function, mps_status status);
/* The same, and MPS_ERROR_ARGUMENT where ranks have different values of `name`. */
mps_status mpsi_elastic_agree_given(mps_elastic *e, const char *function, mps_status status,
                                    const mpsi_given *list);
mps_status mpsi_elastic_agree_same(mps_elastic *e, const char *function, mps_status status,
                                   const char *name, double value);
/* For collective queries, also within a callback: e->agreed is restored afterwards. */
bool mpsi_elastic_begin_reading(mps_elastic *e);
/* For queries that use the scratch arrays: MPS_ERROR_STATE within a step. */
mps_status mpsi_elastic_check_between(const mps_elastic *e, const char *function);
/* The rank of an id, or -1; and ids in their order. */
int64_t mpsi_elastic_find(const mps_elastic *e, int64_t id);
void mpsi_elastic_sort_ids(int64_t count, int64_t *ids);
/* Writes components [0, components) of field `name` from values[i * components + c]. */
mps_status mpsi_elastic_write(mps_elastic *e, const char *function, const char *name,
                              const double *values, int32_t components);
mps_status mpsi_elastic_read(mps_elastic *e, const char *function, const char *name, double *values,
                             int32_t components);
/* Reads `density` into mass, *former: the masses before (after an error too, and nothing has
 * changed). mpsi_elastic_finish_mass ends this. */
mps_status mpsi_elastic_read_mass(mps_elastic *e, const char *function, double **former);
/* Frees the former masses, or on an error the new ones, and restores the former ones. */
void mpsi_elastic_finish_mass(mps_elastic *e, double *former, bool renewed);
/* MPS_ERROR_ARGUMENT that names the field, the particle and what is allowed. */
mps_status mpsi_elastic_bad_value(mps_elastic *e, const char *function, const char *name, int64_t i,
                                  double value, const char *allowed);
