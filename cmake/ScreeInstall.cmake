# Installs public headers, libraries, program, scenes and documents, and exports the targets for find_package(scree).

include(CMakePackageConfigHelpers)
set(package_dir "${CMAKE_INSTALL_LIBDIR}/cmake/scree")

get_property(libraries GLOBAL PROPERTY SCREE_LIBRARIES)
install(TARGETS ${libraries} EXPORT screeTargets ARCHIVE DESTINATION "${CMAKE_INSTALL_LIBDIR}")
if(TARGET scree)
  install(TARGETS scree RUNTIME DESTINATION "${CMAKE_INSTALL_BINDIR}")
endif()
install(DIRECTORY "${SCREE_PUBLIC_INCLUDE_DIR}/scree" DESTINATION "${CMAKE_INSTALL_INCLUDEDIR}")
install(DIRECTORY scenes DESTINATION "${CMAKE_INSTALL_DATADIR}/scree"
  PATTERN "CMakeLists.txt" EXCLUDE PATTERN "*.cpp" EXCLUDE PATTERN "*.h" EXCLUDE)
set(doc_dir "${CMAKE_INSTALL_DATADIR}/doc/scree")
install(FILES LICENSE README.md CHANGELOG.md DESTINATION "${doc_dir}")
install(DIRECTORY docs DESTINATION "${doc_dir}" PATTERN "*.py" EXCLUDE)

install(EXPORT screeTargets NAMESPACE scree:: DESTINATION "${package_dir}")
configure_package_config_file(cmake/screeConfig.cmake.in "${PROJECT_BINARY_DIR}/screeConfig.cmake"
  INSTALL_DESTINATION "${package_dir}")
write_basic_package_version_file("${PROJECT_BINARY_DIR}/screeConfigVersion.cmake"
  COMPATIBILITY SameMinorVersion)
install(FILES "${PROJECT_BINARY_DIR}/screeConfig.cmake" "${PROJECT_BINARY_DIR}/screeConfigVersion.cmake"
  DESTINATION "${package_dir}")
