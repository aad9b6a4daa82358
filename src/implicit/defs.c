/* defs.c - the definition structures of implicit elasticity, which every build has.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "defs.h"

#include "core/internal.h"

const mps_elastic_def mpsi_elastic_defaults = {
    .struct_size = sizeof(mps_elastic_def),
    .alpha = 1.0,
    .thickness = 1.0,
    .tolerance = 1e-10,
    .refinements = 1,
    .first_moment = -1,
};

const mps_newmark_def mpsi_newmark_defaults = {
    .struct_size = sizeof(mps_newmark_def), .beta = 0.25, .gamma = 0.5};

mps_status mps_elastic_def_init(mps_elastic_def *def, size_t size) {
  return MPSI_DEF_INIT(mps_elastic_def, def, size, &mpsi_elastic_defaults);
}

mps_status mps_newmark_def_init(mps_newmark_def *def, size_t size) {
  return MPSI_DEF_INIT(mps_newmark_def, def, size, &mpsi_newmark_defaults);
}
