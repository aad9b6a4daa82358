# mps_first_use(<name> TARGET <library> HEADER <what declares its functions> CALLS <regular expression>
#               SOURCES <the files that call it> [ALSO <what macros of the header name>]
#               [PACKAGE <arguments of find_package>] [LIBRARIES <files>] [DEFINITIONS ...])
# A library that libmps.so loads when it is first needed, so that who only solves does not carry it and what it
# depends on: the module libmps-<name>.so, linked to it, holds a table of the functions that SOURCES call. They
# include <name>_calls.h, written here, after which each call goes through the pointer `mpsi_<name>`. libmps.a
# holds the table itself.
function(mps_first_use name)
  cmake_parse_arguments(PARSE_ARGV 1 use "" "TARGET;HEADER;CALLS" "SOURCES;ALSO;PACKAGE;LIBRARIES;DEFINITIONS")
  set(calls "")
  foreach(source ${use_SOURCES})
    set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/${source})
    file(READ ${source} text)
    string(REGEX MATCHALL "${use_CALLS}[A-Za-z0-9_]*\\(" found "${text}")
    list(APPEND calls ${found})
  endforeach()
  list(TRANSFORM calls REPLACE "\\($" "")
  list(REMOVE_DUPLICATES calls)
  list(SORT calls)
  set(members "")
  set(values "")
  set(macros "")
  foreach(call ${calls})
    if(call MATCHES "^H5.*auto1$") # of HDF5's form before 1.8, which it may be built without
      set(if "#ifndef H5_NO_DEPRECATED_SYMBOLS\n")
      set(endif "#endif\n")
    else()
      set(if "")
      set(endif "")
    endif()
    string(APPEND members "${if}  __typeof__(&${call}) call_${call};\n${endif}")
    string(APPEND values "${if}  .call_${call} = &${call},\n${endif}")
    string(APPEND macros "#undef ${call}\n#define ${call} (mpsi_${name}->call_${call})\n")
  endforeach()
  foreach(named ${use_ALSO})
    string(APPEND members "  __typeof__(&${named}) at_${named};\n")
    string(APPEND values "  .at_${named} = &${named},\n")
    string(APPEND macros "#undef ${named}\n#define ${named} (*mpsi_${name}->at_${named})\n")
  endforeach()
  set(made ${CMAKE_BINARY_DIR}/first-use)
  file(CONFIGURE OUTPUT ${made}/${name}_calls.h @ONLY CONTENT
"#pragma once
#include \"${use_HEADER}\"
typedef struct mpsi_${name}_calls {
${members}} mpsi_${name}_calls;
#ifdef MPSI_TABLE
__attribute__((visibility(\"default\"))) const mpsi_${name}_calls mps_${name}_table = {
${values}};
#else
extern const mpsi_${name}_calls *mpsi_${name}; /* NULL until it is found */
${macros}#endif
")
  file(CONFIGURE OUTPUT ${made}/${name}_table.c @ONLY CONTENT
"#define MPSI_TABLE
#include \"${name}_calls.h\"
#ifdef MPS_STATIC
#include \"core/context/first_use.h\"
const void *mpsi_${name}_find(char *why, size_t size) {
  (void)why, (void)size;
  return &mps_${name}_table;
}
#endif
")
  add_library(mps_${name} MODULE ${made}/${name}_table.c)
  set_target_properties(mps_${name} PROPERTIES C_VISIBILITY_PRESET hidden PREFIX lib OUTPUT_NAME mps-${name}
    LIBRARY_OUTPUT_DIRECTORY $<TARGET_FILE_DIR:mps>/libmps-${MPS_SERIES} INSTALL_RPATH "")
  target_link_libraries(mps_${name} PRIVATE ${use_TARGET} mps_flags mps_hardening)
  target_sources(mps_static PRIVATE ${made}/${name}_table.c)
  foreach(target mps_objects mps_${name} mps_static)
    target_include_directories(${target} PRIVATE ${made} ${PROJECT_SOURCE_DIR}/include ${PROJECT_SOURCE_DIR}/src)
    target_include_directories(${target} SYSTEM PRIVATE $<TARGET_PROPERTY:${use_TARGET},INTERFACE_INCLUDE_DIRECTORIES>)
    target_compile_definitions(${target} PRIVATE ${use_DEFINITIONS})
  endforeach()
  add_dependencies(mps mps_${name})
  mps_static_needs(${use_PACKAGE} TARGET ${use_TARGET} LIBRARIES ${use_LIBRARIES})
  set_property(GLOBAL APPEND PROPERTY MPS_MODULES mps_${name})
endfunction()
