# Finds ARPACK-NG and defines the target ARPACK::ARPACK. Its C interface (dsaupd_c) is in
# libarpack; Debian's package has a pkg-config file but no CMake package.
find_path(ARPACK_INCLUDE_DIR arpack.h PATH_SUFFIXES arpack arpack-ng)
find_library(ARPACK_LIBRARY NAMES arpack)
include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(ARPACK REQUIRED_VARS ARPACK_LIBRARY ARPACK_INCLUDE_DIR)
if(ARPACK_FOUND AND NOT TARGET ARPACK::ARPACK)
  add_library(ARPACK::ARPACK UNKNOWN IMPORTED)
  set_target_properties(ARPACK::ARPACK PROPERTIES
    IMPORTED_LOCATION "${ARPACK_LIBRARY}" INTERFACE_INCLUDE_DIRECTORIES "${ARPACK_INCLUDE_DIR}")
endif()
mark_as_advanced(ARPACK_INCLUDE_DIR ARPACK_LIBRARY)
