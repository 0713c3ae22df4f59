# What `cmake --install` writes: the program, and the library as a CMake package with one target a
# room, `find_package(calibrato COMPONENTS calibration ..)`; and the Debian packages of both, by
# `cpack`. docs/library.md has the commands.
include(CMakePackageConfigHelpers)

set(package_folder ${CMAKE_INSTALL_LIBDIR}/cmake/calibrato)
set(room_targets calibrato_options)
foreach(room IN LISTS CALIBRATO_ROOMS)
  if(room STREQUAL "cli")
    install(TARGETS calibrato calibrato-learner RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT program)
    continue()
  endif()
  list(APPEND room_targets calibrato_${room})
  set_target_properties(calibrato_${room} PROPERTIES EXPORT_NAME ${room})
endforeach()
set_target_properties(calibrato_options PROPERTIES EXPORT_NAME options)

install(TARGETS ${room_targets} EXPORT calibrato
        ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT development)
install(EXPORT calibrato NAMESPACE calibrato:: FILE calibratoTargets.cmake
        DESTINATION ${package_folder} COMPONENT development)
install(DIRECTORY ${PROJECT_SOURCE_DIR}/calibrato DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}
        COMPONENT development FILES_MATCHING PATTERN "*.h"
        PATTERN "cli" EXCLUDE PATTERN "*_for_test.h" EXCLUDE PATTERN "*_testing.h" EXCLUDE)

# The package finds only what the rooms that are asked for are linked with.
set(CALIBRATO_INSTALLED_ROOMS ${CALIBRATO_ROOMS})
list(REMOVE_ITEM CALIBRATO_INSTALLED_ROOMS cli)
configure_package_config_file(cmake/calibratoConfig.cmake.in
  ${PROJECT_BINARY_DIR}/package/calibratoConfig.cmake INSTALL_DESTINATION ${package_folder})
write_basic_package_version_file(${PROJECT_BINARY_DIR}/package/calibratoConfigVersion.cmake
  COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/package/calibratoConfig.cmake
              ${PROJECT_BINARY_DIR}/package/calibratoConfigVersion.cmake
        DESTINATION ${package_folder} COMPONENT development)

install(FILES ${PROJECT_SOURCE_DIR}/LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR}
        RENAME copyright COMPONENT program)
install(FILES ${PROJECT_SOURCE_DIR}/examples/rig.yaml ${PROJECT_SOURCE_DIR}/examples/rig_real.yaml
        DESTINATION ${CMAKE_INSTALL_DOCDIR}/examples COMPONENT program)
install(DIRECTORY ${PROJECT_SOURCE_DIR}/examples/arms
        DESTINATION ${CMAKE_INSTALL_DOCDIR}/examples COMPONENT program)

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME calibrato)
set(CPACK_PACKAGE_CONTACT "The calibrato authors <calibrato@example.org>")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "Calibrates cameras and IMUs, and learns how to move them")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_COMPONENTS_ALL program development)
if(CALIBRATO_PYTHON)
  list(APPEND CPACK_COMPONENTS_ALL python)
endif()
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_STRIP_FILES ON)
# What the program is linked with tells its dependencies; what it opens when it runs is added.
find_program(CALIBRATO_DPKG_SHLIBDEPS dpkg-shlibdeps)
if(NOT CALIBRATO_DPKG_SHLIBDEPS)
  message(STATUS "cpack needs dpkg-shlibdeps: apt-get install dpkg-dev file")
endif()
set(CPACK_DEBIAN_PROGRAM_PACKAGE_NAME calibrato)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_RECOMMENDS "libegl1, libgl1-mesa-dri")
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_NAME libcalibrato-dev)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_SECTION libdevel)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_DEPENDS
  "libeigen3-dev, libtbb-dev, libyaml-cpp-dev, nlohmann-json3-dev, libopencv-dev, zlib1g-dev, libbz2-dev, liblz4-dev, libzstd-dev, libsqlite3-dev, pkg-config, libcairo2-dev, liborocos-kdl-dev, liburdfdom-dev, libmujoco-dev, libnlopt-dev")
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_SUGGESTS "libtorch-dev, libopenmpi-dev")
set(CPACK_DEBIAN_PYTHON_PACKAGE_NAME python3-calibrato)
set(CPACK_DEBIAN_PYTHON_PACKAGE_SECTION python)
set(CPACK_DEBIAN_PYTHON_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PYTHON_PACKAGE_DEPENDS "python3 (>= 3.11), python3 (<< 3.12), python3-numpy")
include(CPack)
