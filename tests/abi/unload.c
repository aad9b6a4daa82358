/* unload.c - a host that opens libmps.so, lets it make threads and a body of triangles, and closes
 * it: threads of libraries inside (Embree's) run on, so their code must stay (-z nodelete). usage:
 * unload LIBRARY SPDX-License-Identifier: BSD-3-Clause */
#define _POSIX_C_SOURCE 200809L /* nanosleep */
#include <mps/mps.h>

#include <dlfcn.h>
#include <stdio.h>
#include <string.h>
#include <time.h>

/* The address of a function as a pointer to it: ISO C has no cast between them. */
#define FIND(library, name)                                                                        \
  do {                                                                                             \
    void *found = dlsym(library, #name);                                                           \
    memcpy(&name##_, &found, sizeof found);                                                        \
  } while (0)

int main(int arguments, char **argument) {
  mps_status (*mps_context_create_)(const mps_context_def *, mps_context **, char *, size_t) = NULL;
  mps_status (*mps_body_create_mesh_)(mps_context *, const mps_body_def *, int64_t, const double *,
                                      int64_t, const int32_t *, mps_body **) = NULL;
  void (*mps_body_destroy_)(mps_body **) = NULL;
  void (*mps_context_destroy_)(mps_context **) = NULL;
  const double xyz[12] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1};
  const int32_t corner[12] = {0, 2, 1, 0, 1, 3, 1, 2, 3, 0, 3, 2};
  char why[256] = "";
  if (arguments != 2) return 2;
  for (int turn = 0; turn < 3; turn++) {
    void *library = dlopen(argument[1], RTLD_NOW | RTLD_LOCAL);
    if (!library) return fprintf(stderr, "%s\n", dlerror()), 2;
    FIND(library, mps_context_create);
    FIND(library, mps_body_create_mesh);
    FIND(library, mps_body_destroy);
    FIND(library, mps_context_destroy);
    mps_context *context = NULL;
    mps_body *body = NULL;
    if (mps_context_create_(NULL, &context, why, sizeof why))
      return fprintf(stderr, "%s\n", why), 1;
    const mps_status made = mps_body_create_mesh_(context, NULL, 4, xyz, 4, corner, &body);
    if (made != MPS_OK && made != MPS_ERROR_UNSUPPORTED)
      return fprintf(stderr, "%d\n", (int)made), 1;
    mps_body_destroy_(&body);
    mps_context_destroy_(&context);
    dlclose(library);
    nanosleep(&(struct timespec){0, 50000000}, NULL);
  }
  return 0;
}
