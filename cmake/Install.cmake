# What `cmake --install` puts where. Debian has another libmps (MPSolve: <mps/mps.h>, libmps.so, libmps.a), so the
# headers live under include/libmps-1/mps/, link name and archive under lib/libmps-1/; the CMake package is `mps`,
# the pkg-config module `libmps-1`, and `libmps` that of the version installed last. Two major versions may share
# a prefix: programs, manual pages, documents and the Python package are then those of the version installed last.
include(CMakePackageConfigHelpers)
set(series libmps-${MPS_SERIES})
set(cmake_dir ${CMAKE_INSTALL_LIBDIR}/cmake/mps-${MPS_SERIES})
set(link_dir ${CMAKE_INSTALL_LIBDIR}/${series})

# As they lie here, so that the links between them hold.
install(FILES LICENSE README.md CHANGELOG.md CITATION.cff CONTRIBUTING.md DESTINATION ${CMAKE_INSTALL_DOCDIR})
install(FILES share/paraview_libmps.py DESTINATION ${CMAKE_INSTALL_DATADIR}/libmps)
install(DIRECTORY share/models share/plots share/umat DESTINATION ${CMAKE_INSTALL_DATADIR}/libmps)
install(FILES share/umat/ABA_PARAM.INC DESTINATION ${CMAKE_INSTALL_DATADIR}/libmps/umat RENAME aba_param.inc)
install(DIRECTORY docs DESTINATION ${CMAKE_INSTALL_DOCDIR} PATTERN docs/site EXCLUDE)
install(DIRECTORY examples DESTINATION ${CMAKE_INSTALL_DOCDIR})
install(FILES docs/site/README.md DESTINATION ${CMAKE_INSTALL_DOCDIR}/docs/site) # README.md links to it

if(NOT PETSc_FOUND)
  set(without_petsc PATTERN petsc.h EXCLUDE)
endif()
install(DIRECTORY include/mps DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/${series}
        FILES_MATCHING PATTERN "*.h" PATTERN "*.hpp" ${without_petsc})

# Two export sets: who links libmps.so is not asked to have what only libmps.a needs.
install(TARGETS mps EXPORT mps-shared LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR} NAMELINK_SKIP)
install(TARGETS mps_static EXPORT mps-static ARCHIVE DESTINATION ${link_dir})
get_property(modules GLOBAL PROPERTY MPS_MODULES) # what libmps.so loads when it is first needed
if(modules)
  install(TARGETS ${modules} LIBRARY DESTINATION ${link_dir})
endif()
set(link_names libmps)
if(PETSc_FOUND)
  list(APPEND link_names libmps-petsc)
  install(TARGETS mps_petsc EXPORT mps-petsc LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR} NAMELINK_SKIP)
  install(EXPORT mps-petsc NAMESPACE mps:: DESTINATION ${cmake_dir})
endif()
install(EXPORT mps-shared NAMESPACE mps:: DESTINATION ${cmake_dir})
install(EXPORT mps-static NAMESPACE mps:: DESTINATION ${cmake_dir})
foreach(name IN LISTS link_names)
  set(soname ${name}${CMAKE_SHARED_LIBRARY_SUFFIX}.${MPS_SERIES})
  # The link name, and the SONAME beside it: Meson takes the folder of the one for the run path of a program.
  file(MAKE_DIRECTORY ${PROJECT_BINARY_DIR}/${series})
  foreach(link ${name}${CMAKE_SHARED_LIBRARY_SUFFIX} ${soname})
    file(CREATE_LINK ../${soname} ${PROJECT_BINARY_DIR}/${series}/${link} SYMBOLIC)
    install(FILES ${PROJECT_BINARY_DIR}/${series}/${link} DESTINATION ${link_dir})
  endforeach()
endforeach()

# link_flags(<variable> <libraries>): libraries found as files become -L and -l flags.
function(link_flags variable)
  set(flags "")
  foreach(library ${ARGN})
    if(IS_ABSOLUTE "${library}")
      get_filename_component(dir ${library} DIRECTORY)
      get_filename_component(name ${library} NAME)
      if(NOT dir IN_LIST CMAKE_C_IMPLICIT_LINK_DIRECTORIES)
        list(APPEND flags -L${dir})
      endif()
      string(REGEX REPLACE "^lib(.+)\\.(a|so[.0-9]*)$" "-l\\1" name ${name})
      list(APPEND flags ${name})
    elseif(library MATCHES "^-")
      list(APPEND flags ${library})
    else()
      list(APPEND flags -l${library})
    endif()
  endforeach()
  list(REMOVE_DUPLICATES flags)
  set(${variable} "${flags}" PARENT_SCOPE)
endfunction()

# What an archive needs. Some find modules of CMake ask for a C compiler; a project in C++ alone gets
# the flags that pkg-config would give.
get_property(packages GLOBAL PROPERTY MPS_STATIC_PACKAGES)
set(MPS_STATIC_DEPENDENCIES "")
foreach(package ${packages})
  if(package MATCHES "COMPONENTS C$")
    get_property(target GLOBAL PROPERTY "MPS_TARGET_OF_${package}")
    get_property(libraries GLOBAL PROPERTY "MPS_LIBRARIES_OF_${package}")
    link_flags(flags ${libraries})
    string(APPEND MPS_STATIC_DEPENDENCIES
      "  if(CMAKE_C_COMPILER_LOADED)\n"
      "    find_dependency(${package})\n"
      "  elseif(NOT TARGET ${target})\n"
      "    add_library(${target} INTERFACE IMPORTED)\n"
      "    set_target_properties(${target} PROPERTIES INTERFACE_LINK_LIBRARIES \"${flags}\")\n"
      "  endif()\n")
  else()
    string(APPEND MPS_STATIC_DEPENDENCIES "  find_dependency(${package})\n")
  endif()
endforeach()
configure_package_config_file(cmake/mpsConfig.cmake.in ${PROJECT_BINARY_DIR}/mpsConfig.cmake
                              INSTALL_DESTINATION ${cmake_dir})
configure_file(cmake/mpsConfigVersion.cmake.in ${PROJECT_BINARY_DIR}/mpsConfigVersion.cmake @ONLY)
file(GLOB find_modules ${PROJECT_SOURCE_DIR}/cmake/Find*.cmake)
install(FILES ${PROJECT_BINARY_DIR}/mpsConfig.cmake ${PROJECT_BINARY_DIR}/mpsConfigVersion.cmake
              ${find_modules} DESTINATION ${cmake_dir})

# libmps.pc. The prefix is relative to the file's own place, so that an installed tree may be moved;
# pkg-config wants a space escaped.
get_property(libraries GLOBAL PROPERTY MPS_STATIC_LIBRARIES)
link_flags(flags ${libraries})
list(JOIN flags " " MPS_PC_LIBS_PRIVATE)
set(MPS_PC_PREFIX ${CMAKE_INSTALL_PREFIX})
if(NOT IS_ABSOLUTE "${CMAKE_INSTALL_LIBDIR}")
  file(RELATIVE_PATH up /prefix/${CMAKE_INSTALL_LIBDIR}/pkgconfig /prefix)
  string(REGEX REPLACE "/$" "" up ${up})
  set(MPS_PC_PREFIX "\${pcfiledir}/${up}")
endif()
foreach(kind LIB INCLUDE)
  set(MPS_PC_${kind}DIR ${CMAKE_INSTALL_${kind}DIR})
  if(NOT IS_ABSOLUTE "${CMAKE_INSTALL_${kind}DIR}")
    set(MPS_PC_${kind}DIR "\${prefix}/${CMAKE_INSTALL_${kind}DIR}")
  endif()
endforeach()
foreach(variable PREFIX LIBDIR INCLUDEDIR)
  string(REPLACE " " "\\ " MPS_PC_${variable} "${MPS_PC_${variable}}")
endforeach()
foreach(name IN LISTS link_names)
  configure_file(pkgconfig/${name}.pc.in ${PROJECT_BINARY_DIR}/${name}.pc @ONLY)
  foreach(module ${name} ${name}-${MPS_SERIES})
    install(FILES ${PROJECT_BINARY_DIR}/${name}.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig
            RENAME ${module}.pc)
  endforeach()
endforeach()
