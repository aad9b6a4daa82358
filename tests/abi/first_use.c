/* first_use.c - HDF5 and Embree come into a process with the first series and the first mesh; where
 * their modules are not beside libmps.so, both calls say so. usage: first-use FILE present|missing
 * SPDX-License-Identifier: BSD-3-Clause */
#include <mps/mps.h>

#include <stdio.h>
#include <string.h>

static int is_mapped(const char *name) {
  char line[4096];
  int found = 0;
  FILE *maps = fopen("/proc/self/maps", "r");
  while (maps && fgets(line, sizeof line, maps)) found |= strstr(line, name) != NULL;
  if (maps) fclose(maps);
  return found;
}

/* The library is mapped after the call and not before; or the call fails with a message that names
 * the module. */
static int judge(mps_context *context, int before, mps_status status, int present,
                 const char *name) {
  char module[64];
  const char *message = mps_context_error(context)->message;
  snprintf(module, sizeof module, "libmps-%s.so", name);
  const int good = present ? !before && status == MPS_OK && is_mapped(name)
                           : status == MPS_ERROR_UNSUPPORTED && strstr(message, module) != NULL;
  printf("%s, mapped %d before, %d after: status %d%s%s: %s\n", name, before, is_mapped(name),
         status, status ? ": " : "", status ? message : "", good ? "good" : "WRONG");
  return good;
}

int main(int arguments, char **argument) {
  const double xyz[12] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1};
  const int32_t corner[12] = {0, 2, 1, 0, 1, 3, 1, 2, 3, 0, 3, 2};
  mps_context *context = NULL;
  mps_particles *set = NULL;
  mps_particles_def points = mps_particles_defaults();
  mps_body *body = NULL;
  mps_recorder *recorder = NULL;
  mps_recorder_def def = mps_recorder_defaults();
  if (arguments != 3 || mps_context_create(NULL, &context, NULL, 0)) return 2;
  const int present = strcmp(argument[2], "present") == 0;
  int good = 1, before = 0;
  if (mps_library_has(MPS_FEATURE_EMBREE)) {
    before = is_mapped("embree");
    const mps_status made = mps_body_create_mesh(context, NULL, 4, xyz, 4, corner, &body);
    good &= judge(context, before, made, present, "embree");
  }
  if (mps_library_has(MPS_FEATURE_HDF5)) {
    before = is_mapped("hdf5");
    def.path = argument[1];
    points.spacing = 1.0;
    if (mps_particles_create(context, &points, &set)) return 2;
    good &=
        judge(context, before, mps_recorder_create(context, set, &def, &recorder), present, "hdf5");
  }
  mps_recorder_destroy(&recorder);
  mps_body_destroy(&body);
  mps_particles_destroy(&set);
  mps_context_destroy(&context);
  return good ? 0 : 1;
}
