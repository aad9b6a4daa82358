# Finds Embree 3 (3.8 or newer) and defines the target Embree::Embree.
# The CMake package of Debian's asks for the development files of its own dependencies; these are not
# needed. Embree 4 has another interface.
find_path(EMBREE_INCLUDE_DIR embree3/rtcore.h)
find_library(EMBREE_LIBRARY NAMES embree3)
if(EMBREE_INCLUDE_DIR AND EXISTS ${EMBREE_INCLUDE_DIR}/embree3/rtcore_config.h)
  file(STRINGS ${EMBREE_INCLUDE_DIR}/embree3/rtcore_config.h embree_version_line
       REGEX "#define RTC_VERSION_STRING ")
  string(REGEX REPLACE ".*\"([0-9.]+)\".*" "\\1" EMBREE_VERSION "${embree_version_line}")
endif()
include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(Embree REQUIRED_VARS EMBREE_LIBRARY EMBREE_INCLUDE_DIR
                                         VERSION_VAR EMBREE_VERSION)
if(EMBREE_FOUND AND NOT TARGET Embree::Embree)
  add_library(Embree::Embree UNKNOWN IMPORTED)
  set_target_properties(Embree::Embree PROPERTIES
    IMPORTED_LOCATION "${EMBREE_LIBRARY}" INTERFACE_INCLUDE_DIRECTORIES "${EMBREE_INCLUDE_DIR}")
endif()
mark_as_advanced(EMBREE_INCLUDE_DIR EMBREE_LIBRARY)
