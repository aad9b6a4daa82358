/* sand.h - the void ratios between which sand dilates, of the programs whose ground has an angle of
 * dilation. SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include "options.h"
#include "output.h"

#include <math.h>
#include <stdio.h>

typedef struct sand_voids {
  double e0, e_max; /* at the start; where dilation ends */
} sand_voids;

/* About the densest and the loosest state of clean sands, so that by default V/V0 ends at 1.3, and
 * no sand dilates further. */
#define SAND_E0 0.5
#define SAND_E_MAX 0.95
#define SAND_RANGE OPTION_FROM_TO(0.01, 20.0)
#define SAND_OPTIONS(voids)                                                                        \
  OPTION_NUMBER("e0", &(voids)->e0, NULL, SAND_E0),                                                \
      OPTION_NUMBER("emax", &(voids)->e_max, NULL, SAND_E_MAX)

/* A reason why they are not consistent; NULL: good. */
static inline const char *sand_check(const sand_voids *v) {
  return v->e_max >= v->e0 ? NULL : "--emax must be at least --e0";
}

/* Numbers of summary.json; null without dilation (psi, degrees). */
static inline void sand_write(output *f, const sand_voids *v, double psi) {
  json_number(f, "e0", psi > 0.0 ? v->e0 : NAN);
  json_number(f, "emax", psi > 0.0 ? v->e_max : NAN);
}

static inline void sand_print(const sand_voids *v, double psi) {
  if (psi > 0.0)
    printf("dilation ends at the void ratio %.4g, from %.4g at the start (V/V0 %.4g)\n", v->e_max,
           v->e0, (1.0 + v->e_max) / (1.0 + v->e0));
}
