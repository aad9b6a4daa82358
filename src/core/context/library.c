/* library.c - what a copy of the library has once: version, optional parts, instruction levels, the
 * last error of each thread. Compiled once for libmps.so and once for libmps.a
 * (src/CMakeLists.txt). SPDX-License-Identifier: BSD-3-Clause */
#include "context_private.h"
#include "levels.h"

#ifdef MPS_STATIC
/* The table lies in a section that the linker leaves out: assemblers drop names that nothing uses.
 */
#define MPSI_HIDE(name)                                                                            \
  __asm__(".pushsection .mps_hidden,\"e\",%progbits\n.weak " #name "\n.hidden " #name              \
          "\n.long " #name "\n.popsection");
#include "hidden_names.h"
#endif

_Thread_local mps_error mpsi_thread_error = {.step = -1, .particle = -1};

#define STRINGIFY_(x) #x
#define STRINGIFY(x) STRINGIFY_(x)

const char *mps_version(void) {
  return STRINGIFY(MPS_VERSION_MAJOR) "." STRINGIFY(MPS_VERSION_MINOR) "." STRINGIFY(
      MPS_VERSION_PATCH) MPS_VERSION_SUFFIX;
}

int32_t mps_version_number(void) { return MPS_VERSION_NUMBER; }

int32_t mps_library_has(int32_t feature) {
  switch (feature) {
  default:
    return 0;
#ifdef MPSI_OPENMP
  case MPS_FEATURE_OPENMP:
#endif
#ifdef MPSI_HAS_HDF5
  case MPS_FEATURE_HDF5:
#endif
#ifdef MPSI_HAS_CHOLMOD
  case MPS_FEATURE_CHOLMOD:
#endif
#ifdef MPSI_HAS_ARPACK
  case MPS_FEATURE_ARPACK:
#endif
#ifdef MPSI_HAS_EMBREE
  case MPS_FEATURE_EMBREE:
#endif
    return 1;
  }
}

