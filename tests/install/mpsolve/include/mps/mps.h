/* mps.h - in the place of MPSolve's header of that name. SPDX-License-Identifier: BSD-3-Clause */
#ifndef MPS_CORE_H
#define MPS_CORE_H

#include <mps/context.h>

#endif
