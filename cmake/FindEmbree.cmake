# Finds Embree 4 or 3 (3.8 or newer), the newest there is, and defines the target Embree::Embree. EMBREE_MAJOR is
# what its headers' folder and its interface are named after.
# The CMake package of Debian's asks for the development files of its own dependencies; these are not
# needed.
find_library(EMBREE_LIBRARY NAMES embree4 embree3)
get_filename_component(EMBREE_MAJOR "${EMBREE_LIBRARY}" NAME)
string(REGEX REPLACE "^(lib)?embree([34]).*" "\\2" EMBREE_MAJOR "${EMBREE_MAJOR}")
find_path(EMBREE_INCLUDE_DIR embree${EMBREE_MAJOR}/rtcore.h)
set(embree_config ${EMBREE_INCLUDE_DIR}/embree${EMBREE_MAJOR}/rtcore_config.h)
if(EXISTS ${embree_config})
  file(STRINGS ${embree_config} embree_version_line REGEX "#define RTC_VERSION_STRING ")
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
