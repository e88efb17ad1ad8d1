# `cmake --install` and the exported package: find_package(sinew) gives sinew::node and every module.
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)
get_property(modules GLOBAL PROPERTY SINEW_MODULES)
install(TARGETS ${modules} EXPORT sinewTargets
  ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR})
install(EXPORT sinewTargets NAMESPACE sinew:: DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/sinew)
configure_package_config_file(cmake/sinewConfig.cmake.in ${CMAKE_BINARY_DIR}/sinewConfig.cmake
  INSTALL_DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/sinew)
write_basic_package_version_file(${CMAKE_BINARY_DIR}/sinewConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_BINARY_DIR}/sinewConfig.cmake ${CMAKE_BINARY_DIR}/sinewConfigVersion.cmake
  DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/sinew)
install(DIRECTORY components bridge sim DESTINATION include/sinew FILES_MATCHING PATTERN "*.h"
  PATTERN "participant" EXCLUDE)
install(DIRECTORY ${CMAKE_BINARY_DIR}/generated/sinew_idl DESTINATION include/sinew
  FILES_MATCHING PATTERN "*.h")
install(DIRECTORY idl DESTINATION share/sinew FILES_MATCHING PATTERN "*.idl" PATTERN "README.md")
install(DIRECTORY robots DESTINATION share/sinew)
