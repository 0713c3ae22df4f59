# The headers that nearly every file includes, parsed once: they are half of a build's time. Files still
# include what they use; tools/tidy compiles without this.
option(CALIBRATO_PRECOMPILE "Parse Eigen, the standard library and GoogleTest once" ON)

# Tests call what is optimised; themselves they need not be, and build a sixth faster.
set(CALIBRATO_TEST_OPTIONS $<$<CONFIG:Release>:-O1>)

set(CALIBRATO_PRECOMPILED_HEADERS
  <Eigen/Cholesky> <Eigen/Core> <Eigen/Eigenvalues> <Eigen/Geometry> <Eigen/LU> <Eigen/QR>
  <algorithm> <array> <cmath> <cstdint> <filesystem> <functional> <limits> <map> <memory>
  <optional> <random> <string> <string_view> <utility> <variant> <vector>)

function(calibrato_add_precompiled name)
  set(source ${CMAKE_BINARY_DIR}/${name}.cc)
  file(GENERATE OUTPUT ${source} CONTENT "// Carries a precompiled header.\n")
  add_library(${name} OBJECT ${source})
  target_link_libraries(${name} PUBLIC calibrato_options Eigen3::Eigen)
  target_precompile_headers(${name} PRIVATE ${ARGN})
endfunction()

if(CALIBRATO_PRECOMPILE)
  calibrato_add_precompiled(calibrato_precompiled ${CALIBRATO_PRECOMPILED_HEADERS})
  if(CALIBRATO_TESTS)
    calibrato_add_precompiled(calibrato_precompiled_for_tests
                              ${CALIBRATO_PRECOMPILED_HEADERS} <gtest/gtest.h>)
    target_link_libraries(calibrato_precompiled_for_tests PUBLIC GTest::gtest)
    target_compile_options(calibrato_precompiled_for_tests PRIVATE ${CALIBRATO_TEST_OPTIONS})
  endif()
endif()

function(calibrato_precompile target from)
  if(CALIBRATO_PRECOMPILE)
    target_precompile_headers(${target} REUSE_FROM ${from})
  endif()
endfunction()

# For an executable of tests.
function(calibrato_build_fast target)
  target_compile_options(${target} PRIVATE ${CALIBRATO_TEST_OPTIONS})
  calibrato_precompile(${target} calibrato_precompiled_for_tests)
endfunction()
