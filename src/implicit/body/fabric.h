/* fabric.h - hashes by which a motion knows whether moduli or fixed directions have changed.
 * SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include <mps/elastic.h>

/* ---- fabric.c ---- */
enum { MPSI_FABRIC_MODULI, MPSI_FABRIC_SUPPORTS };
/* Hashes of moduli and fixed directions. */
void mpsi_elastic_find_fabric(mps_elastic *e, int64_t fabric[2]);
/* Strain energy at the end of the last step; `present`: with the present moduli, J. */
double mpsi_elastic_former_strain(mps_elastic *e, double present);
