/* defs.c - the definition structures of implicit elasticity, which every build has.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "defs.h"

#include "core/internal.h"

const mps_elastic_def mpsi_elastic_defaults = {
    .struct_size = sizeof(mps_elastic_def),
    .radius_ratio = NAN,
    .alpha = 1.0,
    .measure = 1.0,
    .memory_limit = NAN,
    .tolerance = 1e-10,
    .refinements = 1,
    .bending = NAN,
};

const mps_elastic_boundary_def mpsi_elastic_boundary_defaults = {
    .struct_size = sizeof(mps_elastic_boundary_def),
    .lower = {NAN, NAN, NAN},
    .upper = {NAN, NAN, NAN},
    .factor = {1.0, 1.0, 1.0},
};

const mps_elastic_load_def mpsi_elastic_load_defaults = {
    .struct_size = sizeof(mps_elastic_load_def), .factor = {1.0, 1.0, 1.0}};

const mps_elastic_motion_def mpsi_elastic_motion_defaults = {
    .struct_size = sizeof(mps_elastic_motion_def),
    .rho_inf = 1.0,
    .beta = NAN,
    .gamma = NAN,
    .ratio = {NAN, NAN},
    .frequency = {NAN, NAN},
};

const mps_elastic_solver_def mpsi_elastic_solver_defaults = {
    .struct_size = sizeof(mps_elastic_solver_def), .parts = 1};

mps_status mps_elastic_def_init(mps_elastic_def *def, size_t size) {
  return MPSI_DEF_INIT(mps_elastic_def, def, size, &mpsi_elastic_defaults);
}

mps_status mps_elastic_boundary_def_init(mps_elastic_boundary_def *def, size_t size) {
  return MPSI_DEF_INIT(mps_elastic_boundary_def, def, size, &mpsi_elastic_boundary_defaults);
}

mps_status mps_elastic_load_def_init(mps_elastic_load_def *def, size_t size) {
  return MPSI_DEF_INIT(mps_elastic_load_def, def, size, &mpsi_elastic_load_defaults);
}

mps_status mps_elastic_motion_def_init(mps_elastic_motion_def *def, size_t size) {
  return MPSI_DEF_INIT(mps_elastic_motion_def, def, size, &mpsi_elastic_motion_defaults);
}

mps_status mps_elastic_solver_def_init(mps_elastic_solver_def *def, size_t size) {
  return MPSI_DEF_INIT(mps_elastic_solver_def, def, size, &mpsi_elastic_solver_defaults);
}
