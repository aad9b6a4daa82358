/* plugin.c - a plug-in with a copy of libmps of its own: it fills a set, lets a record of an error
 * remain, and says where its copy lies. SPDX-License-Identifier: BSD-3-Clause */
#include <mps/context.h>
#include <mps/particles.h>

#include "plugin.h"

mps_status plugin_fill(double spacing, int64_t *added) {
  mps_context *context = NULL;
  mps_particles *set = NULL;
  mps_particles_def def = mps_particles_defaults();
  const double lower[2] = {0.0, 0.0}, upper[2] = {1.0, 1.0};
  def.spacing = spacing;
  mps_status status = mps_context_create(NULL, &context, NULL, 0);
  if (status == MPS_OK) status = mps_particles_create(context, &def, &set);
  if (status == MPS_OK) status = mps_particles_fill_box(set, lower, upper, added);
  mps_particles_destroy(&set);
  mps_context_destroy(&context);
  return status;
}

const char *plugin_last_error(void) { return mps_last_error()->message; }

plugin_function plugin_address(void) { return (plugin_function)mps_particles_create; }
