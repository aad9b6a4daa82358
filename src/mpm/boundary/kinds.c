/* kinds.c - see kinds.h. SPDX-License-Identifier: BSD-3-Clause */
#include "mpm/boundary/mirror.h"
#include "kinds.h"

#include "core/base/boundary_kind.h"

const mpsi_boundary_kind mpsi_boundary_kinds[] = {
    /* HELD */ {MPSI_TURN_SIDES, MPSI_PRESCRIBES_ALL, MPSI_MIRROR_WALLS, 0, 0, 0, 0},
    /* DRIVEN: boxes and lists */ {.turn = MPSI_TURN_BOXES, .prescribes = MPSI_PRESCRIBES_ALL},
    /* ROLLER */ {MPSI_TURN_ACROSS, MPSI_PRESCRIBES_ACROSS, MPSI_MIRROR_WALLS, 0, 0, 0, 0},
    /* FRICTIONAL */ {.turn = MPSI_TURN_FRICTION, .friction = true},
    /* ABSORBING */ {.turn = MPSI_TURN_DASHPOTS, .absorbs = true},
    /* FREE_FIELD */ {.turn = MPSI_TURN_COLUMN, .mirror = MPSI_MIRROR_ALWAYS, .column = true},
    /* FREE */ {.turn = MPSI_TURN_NEVER},
    /* OPEN */ {.turn = MPSI_TURN_NEVER, .open = true},
};
_Static_assert(sizeof mpsi_boundary_kinds / sizeof *mpsi_boundary_kinds == MPSI_BOUNDARY_KINDS,
               "a row of each kind");
