# The target `docs`: the site of documentation in build/site/html, by scripts/docs.
find_program(MPS_DOCS_PYTHON NAMES python3)
if(MPS_DOCS_PYTHON)
  add_custom_target(docs
    COMMAND ${MPS_DOCS_PYTHON} ${PROJECT_SOURCE_DIR}/scripts/docs
    WORKING_DIRECTORY ${PROJECT_SOURCE_DIR} VERBATIM USES_TERMINAL)
else()
  add_custom_target(docs
    COMMAND ${CMAKE_COMMAND} -E echo "The target docs needs python3: install it, then configure again."
    COMMAND ${CMAKE_COMMAND} -E false VERBATIM)
endif()
