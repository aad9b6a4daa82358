# MPS_ARCHER: LLVM's archer, which tells the thread sanitizer how OpenMP's threads wait for one another.
# Without it the sanitizer sees races where there are none, so OpenMP is left out of the build then.
if(CMAKE_C_COMPILER_ID STREQUAL "Clang")
  execute_process(COMMAND ${CMAKE_C_COMPILER} -print-resource-dir OUTPUT_VARIABLE clang_resources
                  OUTPUT_STRIP_TRAILING_WHITESPACE)
  find_library(MPS_ARCHER archer HINTS ${clang_resources}/../.. ${clang_resources}/../../..)
endif()
mark_as_advanced(MPS_ARCHER)
if(NOT MPS_ARCHER)
  message(STATUS "OpenMP is left out, without archer (clang, libomp) the thread sanitizer cannot judge it")
  set(MPS_OPENMP OFF)
endif()
