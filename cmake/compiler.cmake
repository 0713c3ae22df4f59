# Warnings, sanitizers and floating point, the same for every target of the project.

if(NOT CMAKE_BUILD_TYPE)
  set(CMAKE_BUILD_TYPE Release)
endif()

add_library(calibrato_options INTERFACE)
target_include_directories(calibrato_options INTERFACE
  $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}> $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
# Whoever uses the installed library compiles with the warnings of their own choice.
target_compile_options(calibrato_options INTERFACE $<BUILD_INTERFACE:-Wall;-Wextra;-Werror>)
# GCC 12 sees overlapping and endless copies in std::string that are not there (GCC bugs 105651, 105329);
# under the sanitizers such accesses are looked for in earnest.
target_compile_options(calibrato_options INTERFACE
  $<BUILD_INTERFACE:$<$<CXX_COMPILER_ID:GNU>:-Wno-restrict;-Wno-stringop-overflow;-Wno-array-bounds>>)
# No fast-math and no fused multiply-add: the same seed gives the same bytes on every x86-64.
target_compile_options(calibrato_options INTERFACE $<BUILD_INTERFACE:-ffp-contract=off>)
target_compile_features(calibrato_options INTERFACE $<INSTALL_INTERFACE:cxx_std_20>)

if(CALIBRATO_PYTHON)
  # For programs as well as for rooms: precompiled headers serve both only if they are compiled alike.
  # Nobody replaces our functions at run time, so they may be inlined as ever.
  add_compile_options(-fPIC -fno-semantic-interposition)
endif()

if(CALIBRATO_SANITIZE)
  add_compile_options(-fsanitize=address,undefined -fno-sanitize-recover=all -fno-omit-frame-pointer)
  # The address sanitizer stops at null pointers and outside of objects by itself, Eigen asserts alignment:
  # looking for them a second time is a third of the build.
  add_compile_options(
    -fno-sanitize=null,alignment,object-size,nonnull-attribute,returns-nonnull-attribute,vptr)
  add_link_options(-fsanitize=address,undefined)
  add_compile_definitions(EIGEN_INITIALIZE_MATRICES_BY_NAN)
  # The checks that are compiled in hide from GCC that a std::function is initialised.
  target_compile_options(calibrato_options INTERFACE
    $<BUILD_INTERFACE:$<$<CXX_COMPILER_ID:GNU>:-Wno-maybe-uninitialized>>)
endif()

if(CALIBRATO_FUZZ)
  add_compile_options(-fsanitize=fuzzer-no-link,address,undefined -fno-sanitize-recover=all
                      -fno-omit-frame-pointer)
  add_link_options(-fsanitize=address,undefined)
endif()
