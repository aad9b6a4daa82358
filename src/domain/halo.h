/* halo.h - copies of particles that other ranks own, behind a rank's own ones in the same columns.
 * SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include "domain_internal.h"

typedef struct mpsi_halo mpsi_halo;

typedef struct mpsi_halo_def {
  int64_t guests;       /* copies here, in order of their owners */
  const int32_t *rank;  /* owner of each */
  const int64_t *index; /* its index there */
  int64_t first;        /* index of the first guest here; the others follow */
  int32_t columns;      /* at most so many in one copy */
} mpsi_halo_def;

/* Of a domain of several ranks; collective. The domain outlives it. */
mps_status mpsi_halo_create(mps_domain *domain, const char *function, const mpsi_halo_def *def,
                            mpsi_halo **out);
void mpsi_halo_destroy(mps_context *context, mpsi_halo **halo); /* accepts that *halo is NULL */
/* Copies columns of all items to their guests, while the caller continues: the data to send have
 * been read when `begin` returns. Fails with the transport only. */
mps_status mpsi_halo_begin(mpsi_halo *halo, const char *function, int32_t columns,
                           double *const *column);
mps_status mpsi_halo_end(mpsi_halo *halo, const char *function, double *const *column);

/* Number of items with copies on other ranks, and their local indices, ascending. */
int64_t mpsi_halo_items(const mpsi_halo *halo, const int64_t **index);
/* The same with items of the caller's own form, item_bytes each, one behind the other: `own` of
 * mpsi_halo_items, `guests` in order of their owners. Neither is to be used before the end. */
mps_status mpsi_halo_begin_bytes(mpsi_halo *halo, const char *function, int32_t item_bytes,
                                 const void *own, void *guests);
mps_status mpsi_halo_end_bytes(mpsi_halo *halo, const char *function);
