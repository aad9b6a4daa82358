/* host.c - a host with a copy of libmps of its own opens a plug-in that has another: the calls of
 * each go to its own copy, and so do the records of errors. usage: host PLUGIN
 * SPDX-License-Identifier: BSD-3-Clause */
#include <mps/context.h>
#include <mps/particles.h>

#include "plugin.h"

#include <dlfcn.h>
#include <stdio.h>
#include <string.h>

/* The address of a function as a pointer to it: ISO C has no cast between them. */
#define FIND(library, name)                                                                        \
  do {                                                                                             \
    void *found = dlsym(library, #name);                                                           \
    if (!found) return fprintf(stderr, "%s\n", dlerror()), 1;                                      \
    memcpy(&name##_, &found, sizeof found);                                                        \
  } while (0)
#define EXPECT(condition)                                                                          \
  if (!(condition)) return fprintf(stderr, "line %d: not %s\n", __LINE__, #condition), 1

int main(int arguments, char **argument) {
  mps_status (*plugin_fill_)(double, int64_t *);
  const char *(*plugin_last_error_)(void);
  plugin_function (*plugin_address_)(void);
  int64_t added = 0;
  if (arguments != 2) return 2;
  void *plugin = dlopen(argument[1], RTLD_NOW | RTLD_LOCAL);
  if (!plugin) return fprintf(stderr, "%s\n", dlerror()), 1;
  FIND(plugin, plugin_fill);
  FIND(plugin, plugin_last_error);
  FIND(plugin, plugin_address);
  EXPECT(plugin_address_() != (plugin_function)mps_particles_create);

  /* each fails in its own way, and keeps its own record */
  EXPECT(mps_particles_fill_box(NULL, NULL, NULL, NULL) == MPS_ERROR_ARGUMENT);
  EXPECT(plugin_last_error_()[0] == '\0');
  EXPECT(plugin_fill_(-3.0, &added) == MPS_ERROR_ARGUMENT);
  EXPECT(strstr(plugin_last_error_(), "-3"));
  EXPECT(strcmp(mps_last_error()->message, "particles is NULL") == 0);
  EXPECT(plugin_fill_(0.25, &added) == MPS_OK && added == 16);
  dlclose(plugin);
  printf("two copies of libmps %s, apart from one another\n", mps_version());
  return 0;
}
