/* mpm_method.h - variants of WLS-MPM that programs on the grid offer beside the default: those of
 * Nakamura, and the original material point method. SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include "options.h"

#include <mps/experimental/papers.h>

enum { MPM_VARIANT_WLS = 0, MPM_VARIANT_FLIP, MPM_VARIANT_PIC };

typedef struct mpm_method {
  int variant;  /* MPM_VARIANT_... */
  int edge;     /* mps_mpm_edge */
  int transfer; /* mps_experimental_transfer */
  int gradient; /* mps_experimental_strain */
} mpm_method;

/* Rows of a table of options. */
#define MPM_METHOD_OPTIONS(m)                                                                      \
  OPTION_CHOICE("variant", &(m)->variant, NULL), OPTION_CHOICE("edge", &(m)->edge, NULL),          \
      OPTION_CHOICE_OF("transfer", "shape|weight", &(m)->transfer, NULL),                          \
      OPTION_CHOICE("gradient", &(m)->gradient, NULL)

/* With --paper, `paper`, the choices of Nakamura and then `presets` (ends with a row without a
 * name) where an option is not given. Returns -1, or an exit code after an error line: also where
 * the choices do not fit one another or --flip-time, `flip_time` (s). */
int mpm_method_settle(const options_program *program, mpm_method *m, bool paper,
                      const option_preset *presets, double flip_time);
/* Before and after mpm_model_create. */
void mpm_method_define(const mpm_method *m, mps_mpm_def *def);
mps_status mpm_method_choose(const mpm_method *m, mps_mpm *mpm, mps_status status);
