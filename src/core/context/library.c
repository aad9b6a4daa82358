/* library.c - properties of this build: version, optional parts, instruction levels.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "levels.h"

#define STRINGIFY_(x) #x
#define STRINGIFY(x) STRINGIFY_(x)

const char *mps_version(void) {
  return STRINGIFY(MPS_VERSION_MAJOR) "." STRINGIFY(MPS_VERSION_MINOR) "." STRINGIFY(
      MPS_VERSION_PATCH);
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

const char *mps_library_feature_name(int32_t feature) {
  switch (feature) {
#define FEATURE_CASE(name, value, text)                                                            \
  case value:                                                                                      \
    return text;
    MPS_FEATURE_TABLE(FEATURE_CASE)
#undef FEATURE_CASE
  default:
    return NULL;
  }
}

int32_t mps_library_has_level(int32_t level) { return level > 0 && mpsi_level(level) == level; }
