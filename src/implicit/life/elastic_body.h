/* elastic_body.h - material, cuts and derived data of the present body.
 * SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include <mps/elastic.h>

#include <stdbool.h>

/* The arrays of e->n particles; their values from ids, positions, cuts and material; and the
 * release of both. */
mps_status mpsi_elastic_allocate(mps_elastic *e, const char *function);
mps_status mpsi_elastic_make_body(mps_elastic *e, const char *function, bool moduli_known);
void mpsi_elastic_free_body(mps_elastic *e);
/* The definition's material to the fields, at creation. */
mps_status mpsi_elastic_add_material(mps_elastic *e, const char *function);
