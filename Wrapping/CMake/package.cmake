# find_package(MultiLabelInterfaceMesher), from the build tree as well as from an install prefix.
include(CMakePackageConfigHelpers)
if (BUILD_SHARED_LIBS)
  set(mlim_find_cgal)
else ()
  # A static library passes on what it is linked with; a shared one keeps CGAL to itself.
  set(mlim_find_cgal "find_dependency(CGAL)")
endif ()
set(mlim_package_folder "${CMAKE_BINARY_DIR}/${mlim_cmake_destination}")
configure_package_config_file(
  "${CMAKE_CURRENT_LIST_DIR}/MultiLabelInterfaceMesherConfig.cmake.in"
  "${mlim_package_folder}/${PROJECT_NAME}Config.cmake"
  INSTALL_DESTINATION "${mlim_cmake_destination}"
  NO_SET_AND_CHECK_MACRO)
write_basic_package_version_file(
  "${mlim_package_folder}/${PROJECT_NAME}ConfigVersion.cmake"
  COMPATIBILITY SameMinorVersion)
install(FILES
    "${mlim_package_folder}/${PROJECT_NAME}Config.cmake"
    "${mlim_package_folder}/${PROJECT_NAME}ConfigVersion.cmake"
  DESTINATION "${mlim_cmake_destination}"
  COMPONENT development)
install(FILES LICENSE
  DESTINATION "${CMAKE_INSTALL_DOCDIR}"
  COMPONENT runtime)
