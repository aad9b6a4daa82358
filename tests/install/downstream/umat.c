/* umat.c - a UMAT that calls XIT ends its call with an error; the next call of the same law
 * succeeds. SPDX-License-Identifier: BSD-3-Clause */
#define MPS_EXPERIMENTAL 1
#include <mps/material.h>
#include <mps/material_law.h>
#include <mps/experimental/material_point.h>

#include <math.h>
#include <stdio.h>
#include <string.h>

extern MPS_MATERIAL_UMAT(umat_with_xit);

static int strain(mps_context *context, mps_material *law, double rate, mps_status wanted) {
  mps_material_point point;
  const double gradient[9] = {rate};
  mps_status status = mps_material_point_init(context, law, &point);
  if (!status) status = mps_material_point_drive(context, law, &point, gradient, 1.0, 1);
  const char *message = status ? mps_context_error(context)->message : "";
  if (status != wanted || (status && !strstr(message, "XIT")) ||
      (!status && fabs(point.stress[0] - 2e6 * rate) > 1e-9 * 2e6 * fabs(rate))) {
    printf("rate %g: status %d, stress %g, %s\n", rate, (int)status, point.stress[0], message);
    return 1;
  }
  printf("rate %g: %s\n", rate, status ? message : "a stress");
  return 0;
}

int main(void) {
  mps_context *context = NULL;
  mps_material *law = NULL;
  const double props[1] = {2e6};
  mps_material_umat_def def = mps_material_umat_defaults();
  def.umat = umat_with_xit;
  def.props = props, def.props_count = 1;
  def.wave_modulus = 2e6;
  if (mps_context_create(NULL, &context, NULL, 0) || mps_material_create_umat(context, &def, &law))
    return 1;
  int bad = 0;
  for (int k = 0; k < 3; k++)
    bad += strain(context, law, 1e-3, MPS_OK) + strain(context, law, -1e-3, MPS_ERROR_NUMERIC);
  mps_material_destroy(&law);
  mps_context_destroy(&context);
  return bad != 0;
}
