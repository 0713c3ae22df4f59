# calibrato_add_room(NAME SOURCES a.cc .. TESTS a_test.cc .. DEPENDS room .. HEAVY target ..)
#
# One static library a room. DEPENDS are the rooms of its row in ARCHITECTURE.md; HEAVY libraries are
# private: their headers do not reach whoever includes the room's.
function(calibrato_add_room name)
  cmake_parse_arguments(ROOM "" "" "SOURCES;TESTS;DEPENDS;HEAVY" ${ARGN})
  add_library(calibrato_${name} STATIC ${ROOM_SOURCES})
  target_link_libraries(calibrato_${name} PUBLIC calibrato_options)
  if(NOT name STREQUAL "base")
    target_link_libraries(calibrato_${name} PUBLIC Eigen3::Eigen)
  endif()
  foreach(room IN LISTS ROOM_DEPENDS)
    target_link_libraries(calibrato_${name} PUBLIC calibrato_${room})
  endforeach()
  target_link_libraries(calibrato_${name} PRIVATE ${ROOM_HEAVY})
  # libtorch's flags differ from everyone else's.
  if(NOT torch IN_LIST ROOM_HEAVY)
    calibrato_precompile(calibrato_${name} calibrato_precompiled)
  endif()
  if(CALIBRATO_TESTS AND ROOM_TESTS)
    add_executable(${name}_test ${ROOM_TESTS})
    target_link_libraries(${name}_test PRIVATE calibrato_${name} GTest::gmock GTest::gtest_main)
    calibrato_build_fast(${name}_test)
    gtest_discover_tests(${name}_test DISCOVERY_MODE PRE_TEST
                         WORKING_DIRECTORY ${PROJECT_SOURCE_DIR}
                         PROPERTIES LABELS "${name}" TIMEOUT 1200)
  endif()
endfunction()

# calibrato_add_statistical_test(ROOM FILTER): the same tests with their full sample, under the label
# `statistical`; ./test runs the small sample, `ctest --preset statistical` this one.
function(calibrato_add_statistical_test name filter)
  if(CALIBRATO_TESTS)
    add_test(NAME statistical.${name}.${filter}
             COMMAND ${name}_test --gtest_filter=${filter}
             WORKING_DIRECTORY ${PROJECT_SOURCE_DIR})
    set_tests_properties(statistical.${name}.${filter} PROPERTIES
                         LABELS statistical ENVIRONMENT "CALIBRATO_FULL_SAMPLE=1" TIMEOUT 7200)
  endif()
endfunction()
