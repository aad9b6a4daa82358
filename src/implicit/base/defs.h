/* defs.h - defaults of the definition structures of implicit elasticity.
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef MPSI_IMPLICIT_DEFS_H
#define MPSI_IMPLICIT_DEFS_H

#include <mps/elastic_solver.h>

extern const mps_elastic_def mpsi_elastic_defaults;
extern const mps_elastic_boundary_def mpsi_elastic_boundary_defaults;
extern const mps_elastic_load_def mpsi_elastic_load_defaults;
extern const mps_elastic_solver_def mpsi_elastic_solver_defaults;
extern const mps_elastic_motion_def mpsi_elastic_motion_defaults;

#endif
