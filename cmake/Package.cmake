# `cmake --install` undone (target uninstall), and packages by cpack: `cpack --config build/release/CPackConfig.cmake`
# makes a .tar.gz, a .deb where there is dpkg and an .rpm where there is rpmbuild, all of one piece. The packages
# that a distribution would make, library, -dev, -tools and -doc apart, are those of debian/.
if(NOT TARGET uninstall)
  add_custom_target(uninstall VERBATIM
    COMMAND ${CMAKE_COMMAND} -DBUILD=${PROJECT_BINARY_DIR} -P ${PROJECT_SOURCE_DIR}/cmake/Uninstall.cmake)
endif()

set(CPACK_PACKAGE_NAME libmps-meshfree) # Debian's libmps3 and libmps-dev are MPSolve
set(CPACK_PACKAGE_VENDOR "the libmps authors")
set(CPACK_PACKAGE_CONTACT "the libmps authors <maintainers@libmps.invalid>")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "${PROJECT_DESCRIPTION}")
set(CPACK_PACKAGE_DESCRIPTION "Explicit MPS dynamics, WLS-MPM with frictional contact, implicit particle elasticity and
free-surface flow: library, headers, programs, pages and the Python package.")
set(CPACK_RESOURCE_FILE_LICENSE ${PROJECT_SOURCE_DIR}/LICENSE)
set(CPACK_PACKAGE_DIRECTORY ${PROJECT_BINARY_DIR}/packages)
set(CPACK_STRIP_FILES ON)
set(CPACK_GENERATOR TGZ)
find_program(MPS_DPKG dpkg-shlibdeps)
if(MPS_DPKG)
  list(APPEND CPACK_GENERATOR DEB)
endif()
find_program(MPS_RPMBUILD rpmbuild)
if(MPS_RPMBUILD)
  list(APPEND CPACK_GENERATOR RPM)
endif()
mark_as_advanced(MPS_DPKG MPS_RPMBUILD)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION math)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_GENERATE_SHLIBS ON) # and with it the call of ldconfig
set(CPACK_DEBIAN_PACKAGE_CONFLICTS "libmps-meshfree-dev, libmps-meshfree-tools, libmps-meshfree-doc, python3-libmps")
set(CPACK_DEBIAN_PACKAGE_RECOMMENDS "gnuplot-nox, fonts-dejavu-core, python3-cffi, python3-numpy")
set(CPACK_RPM_FILE_NAME RPM-DEFAULT)
# Directories of the system: those that cpack does not know to be such.
set(share ${CMAKE_INSTALL_DATADIR})
foreach(directory ${CMAKE_INSTALL_LIBDIR} ${CMAKE_INSTALL_LIBDIR}/cmake ${CMAKE_INSTALL_LIBDIR}/pkgconfig
        ${CMAKE_INSTALL_LIBDIR}/python3 ${CMAKE_INSTALL_LIBDIR}/python3/dist-packages ${share}/man ${share}/man/man1
        ${share}/bash-completion ${share}/bash-completion/completions ${share}/zsh ${share}/zsh/site-functions
        ${share}/zsh/vendor-completions)
  list(APPEND CPACK_RPM_EXCLUDE_FROM_AUTO_FILELIST_ADDITION /usr/${directory})
endforeach()
set(CPACK_RPM_SPEC_MORE_DEFINE "%define _build_id_links none") # no package of debugging symbols
set(CPACK_RPM_PACKAGE_LICENSE BSD-3-Clause)
include(CPack)
