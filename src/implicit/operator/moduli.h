/* moduli.h - Lame's constants of the particles. SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include <mps/elastic.h>

/* Moduli of particle i; MPS_ERROR_ARGUMENT naming one that is out of range. */
mps_status mpsi_elastic_set_moduli(mps_elastic *e, const char *function, int64_t i, double young,
                                   double poisson);
/* Those of all, from the fields; on an error nothing has changed. */
mps_status mpsi_elastic_read_material(mps_elastic *e, const char *function);
/* The same, with the data derived from them: joints, stiffnesses; the energy of a motion under way
 * is noted before. */
mps_status mpsi_elastic_renew_material(mps_elastic *e, const char *function);
void mpsi_elastic_warn_of_moduli(const mps_elastic *e);
