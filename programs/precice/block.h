/* block.h - an elastic block of soil on a held floor, and a rigid box above its right edge, a third
 * of which has no ground below. SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include "common/app.h"

#include <mps/mpm.h>

#define BLOCK_BOX_MASS 480.0                    /* kg */
#define BLOCK_BOX_INERTIA (480.0 * 0.13 / 12.0) /* kg m2: .3 x .2 m */
#define BLOCK_BOX_X 0.8                         /* m: its centre at the start */
#define BLOCK_BOX_Y 0.6

extern const double block_corner[8]; /* m: x, y of the corners of the box at the start */

typedef struct block {
  mps_particles *set;
  mps_material *law;
  mps_mpm *soil;
  mps_body *box;
} block;

/* Makes them at rest, with steps of `dt` (s) of the soil. `free`: the box has its mass and falls;
 * else it is driven. False, with an error line, on a failure; block_free it in any case. */
bool block_make(app *a, double dt, bool free, block *out);
void block_free(block *b);
