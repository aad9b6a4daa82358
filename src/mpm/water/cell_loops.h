/* cell_loops.h - what the loops of the water over particles (cell_loops.c, compiled once for each
 * instruction set) share with its cells. SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include "water.h"

/* Values of a cell in the worker's two tiles as sums over its particles: of V, `rest`, V p at the
 * cell's centre, V n; of V k and V g. */
enum { MPSI_PORE_VOLUME, MPSI_PORE_CHANGE, MPSI_PORE_PRESSURE, MPSI_PORE_POROSITY };
enum { MPSI_PORE_PERMEABILITY, MPSI_PORE_SLOPE };

/* flow.c, of particles [begin, end): permeabilities, before their porosities change; seepage. */
void mpsi_pore_change_permeability(const mpsi_columns *p, const mpsi_water *water,
                                   const double *former, int64_t begin, int64_t end);
void mpsi_pore_give_flow(const mpsi_transfer *work, int64_t begin, int64_t end);
