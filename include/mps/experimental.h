/* mps/experimental.h - all headers of mps/experimental/ but petsc.h (a library of its own).
 *
 * Their functions, types and constants may change or be removed in any minor release; mps/mps.h
 * does not include them, and a source says that it uses them by MPS_EXPERIMENTAL. The shared
 * library exports the functions under a version node of the minor release: a program that calls one
 * loads with that release, or fails at its start and names it. SPDX-License-Identifier:
 * BSD-3-Clause */
#ifndef LIBMPS_EXPERIMENTAL_H
#define LIBMPS_EXPERIMENTAL_H

#ifndef MPS_EXPERIMENTAL
#error                                                                                             \
    "experimental interface, which may change in any minor release: #define MPS_EXPERIMENTAL first"
#endif

#include "experimental/coupling.h"
#include "experimental/domain.h"
#include "experimental/dynamics_predict.h"
#include "experimental/fluid_parts.h"
#include "experimental/linear_solver.h"
#include "experimental/mpm_energy.h"
#include "experimental/material_point.h"
#include "experimental/neighbours.h"
#include "experimental/papers.h"
#include "experimental/pore_water.h"
#include "experimental/fluid_rock.h"
#include "experimental/settle.h"
#include "experimental/soil.h"
#include "experimental/wave_loads.h"
#include "experimental/waves.h"

#endif
