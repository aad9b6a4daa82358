/* point.c - one particle with its state: a law along a strain path, without a solver.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "material_private.h"

mps_status mps_material_point_init(mps_context *context, const mps_material *material,
                                   mps_material_point *point) {
  if (!context) return MPS_ERROR_ARGUMENT;
  if (!material || !point)
    return mpsi_fail(context, __func__, MPS_ERROR_ARGUMENT, "%s is NULL",
                     material ? "point" : "material");
  *point = (mps_material_point){.deformation = {1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0},
                                .volume_ratio = 1.0};
  for (int32_t c = 0; c < material->history_count; c++)
    point->history[c] = material->history_initial[c];
  return MPS_OK;
}

static mps_status check_drive(mps_context *context, const char *function,
                              const mps_material *material, const mps_material_point *point,
                              const double *gradient, double duration, int64_t steps) {
  if (!material || !point || !gradient)
    return mpsi_fail(context, function, MPS_ERROR_ARGUMENT, "%s is NULL",
                     !material ? "material"
                     : !point  ? "point"
                               : "gradient");
  for (int c = 0; c < 9; c++)
    if (!isfinite(gradient[c]))
      return mpsi_fail(context, function, MPS_ERROR_ARGUMENT, "gradient[%d] is %g, must be finite",
                       c, gradient[c]);
  if (!isfinite(duration) || duration <= 0.0)
    return mpsi_fail(context, function, MPS_ERROR_ARGUMENT,
                     "duration is %g s, must be finite and > 0", duration);
  if (steps < 1)
    return mpsi_fail(context, function, MPS_ERROR_ARGUMENT, "steps is %lld, must be >= 1",
                     (long long)steps);
  return MPS_OK;
}

mps_status mps_material_point_drive(mps_context *context, const mps_material *material,
                                    mps_material_point *point, const double gradient[9],
                                    double duration, int64_t steps) {
  if (!context) return MPS_ERROR_ARGUMENT;
  const mps_status status =
      check_drive(context, __func__, material, point, gradient, duration, steps);
  if (status != MPS_OK) return status;
  mps_material_point now = *point; /* the caller's point changes only when every step succeeds */
  double *history[MPS_MATERIAL_POINT_HISTORY];
  char message[MPSI_MATERIAL_MESSAGE] = "";
  int64_t refused = -1;
  mps_material_block block = {.struct_size = sizeof block,
                              .dim = 3,
                              .count = 1,
                              .dt = duration / (double)steps,
                              .history = history,
                              .history_count = material->history_count,
                              .message = message,
                              .message_size = sizeof message,
                              .refused = &refused,
                              .volume_ratio = &now.volume_ratio,
                              .flags = &now.flags};
  for (int c = 0; c < 9; c++) {
    block.gradient[c] = &gradient[c];
    block.deformation[c] = &now.deformation[c];
  }
  for (int c = 0; c < 6; c++) block.stress[c] = &now.stress[c];
  for (int32_t c = 0; c < material->history_count; c++) history[c] = &now.history[c];
  for (int64_t step = 0; step < steps; step++) {
    block.time = point->time + duration * (double)(step + 1) / (double)steps;
    mps_status answer = mpsi_material_apply(material, &block);
    if (answer == MPS_OK) answer = mpsi_check_results(&block, material->history_count);
    if (answer != MPS_OK)
      return mpsi_material_refused(context, __func__, material, answer, message, -1, step);
  }
  now.time = point->time + duration;
  *point = now;
  return MPS_OK;
}
