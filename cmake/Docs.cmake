# The target `docs`: HTML pages of the public headers in <build>/docs/html, by doxygen.
find_program(DOXYGEN doxygen)
if(DOXYGEN)
  add_custom_target(docs
    COMMAND ${CMAKE_COMMAND} -E env "MPS_VERSION=${PROJECT_VERSION}"
            "MPS_DOCS_DIR=${PROJECT_BINARY_DIR}/docs" ${DOXYGEN} docs/Doxyfile
    WORKING_DIRECTORY ${PROJECT_SOURCE_DIR} VERBATIM
    COMMENT "Documentation of the public headers: ${PROJECT_BINARY_DIR}/docs/html/index.html")
else()
  add_custom_target(docs
    COMMAND ${CMAKE_COMMAND} -E echo "The target docs needs doxygen: install it, then configure again."
    COMMAND ${CMAKE_COMMAND} -E false VERBATIM)
endif()
