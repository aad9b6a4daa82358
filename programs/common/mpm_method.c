/* mpm_method.c - see mpm_method.h.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "mpm_method.h"

int mpm_method_settle(const options_program *program, mpm_method *m, bool paper,
                      const option_preset *presets, double flip_time) {
  static const option_preset nakamura[] = {{"edge", "fit"}, {0}};
  static const option_preset least_squares[] = {{"transfer", "weight"}, {"gradient", "fit"}, {0}};
  int code = paper ? options_prefer(program, nakamura) : -1;
  if (code < 0 && paper && m->variant == MPM_VARIANT_WLS)
    code = options_prefer(program, least_squares);
  if (code < 0 && paper && presets) code = options_prefer(program, presets);
  if (code >= 0) return code;
  if (m->variant != MPM_VARIANT_WLS && (m->transfer != 0 || m->gradient != 0))
    return options_refuse(program, "--transfer weight and --gradient fit need --variant wls");
  if (flip_time > 0.0 && (m->variant != MPM_VARIANT_WLS || m->transfer != 0))
    return options_refuse(program, "--flip-time needs --variant wls and --transfer shape");
  return -1;
}

void mpm_method_define(const mpm_method *m, mps_mpm_def *def) { def->edge = m->edge; }

mps_status mpm_method_choose(const mpm_method *m, mps_mpm *mpm, mps_status status) {
  if (status == MPS_OK && m->variant != MPM_VARIANT_WLS)
    return mps_experimental_mpm_standard(mpm, m->variant == MPM_VARIANT_FLIP ? 1.0 : 0.0);
  if (status == MPS_OK && m->transfer != 0)
    status = mps_experimental_mpm_transfer(mpm, m->transfer);
  if (status == MPS_OK && m->gradient != 0) status = mps_experimental_mpm_strain(mpm, m->gradient);
  return status;
}
