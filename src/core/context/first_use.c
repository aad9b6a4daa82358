/* first_use.c - the modules beside libmps.so; in libmps.a their tables stand in for this file.
 * SPDX-License-Identifier: BSD-3-Clause */
#define _GNU_SOURCE /* dladdr */
#include "first_use.h"

#include <mps/base.h>

#include <dlfcn.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define STRINGIFY_(x) #x
#define STRINGIFY(x) STRINGIFY_(x)
#define FOLDER "libmps-" STRINGIFY(MPS_VERSION_MAJOR)

static const char here; /* an address inside libmps.so */

/* The folder libmps-N beside this library's file, wherever both have been moved to. */
static int find_module(char *path, size_t size, const char *name) {
  Dl_info info;
  char *real = dladdr(&here, &info) != 0 ? realpath(info.dli_fname, NULL) : NULL;
  char *slash = real ? strrchr(real, '/') : NULL;
  if (slash) *slash = '\0';
  const int length = slash ? snprintf(path, size, "%s/" FOLDER "/%s", real, name) : -1;
  free(real);
  return length > 0 && (size_t)length < size;
}

static const void *load(const char *name, const char *table, char *why, size_t size) {
  char path[PATH_MAX];
  if (!find_module(path, sizeof path, name)) {
    snprintf(why, size, "the folder of libmps.so is unknown, where %s lies", name);
    return NULL;
  }
  void *module = dlopen(path, RTLD_NOW | RTLD_LOCAL | RTLD_NODELETE);
  const void *found = module ? dlsym(module, table) : NULL;
  const char *error = found ? NULL : dlerror();
  if (!found) snprintf(why, size, "%s", error ? error : path);
  return found;
}

const void *mpsi_hdf5_find(char *why, size_t size) {
  return load("libmps-hdf5.so", "mps_hdf5_table", why, size);
}

const void *mpsi_embree_find(char *why, size_t size) {
  return load("libmps-embree.so", "mps_embree_table", why, size);
}
