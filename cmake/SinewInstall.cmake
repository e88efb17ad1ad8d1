# `cmake --install` and the exported package: find_package(sinew) gives sinew::node and every module.
include(GNUInstallDirs)
set(CMAKE_INSTALL_DEFAULT_COMPONENT_NAME dev)
include(CMakePackageConfigHelpers)
get_property(modules GLOBAL PROPERTY SINEW_MODULES)
install(TARGETS ${modules} EXPORT sinewTargets
  ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR})
install(EXPORT sinewTargets NAMESPACE sinew:: DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/sinew)
set(SINEW_IDL_INSTALL_DIR share/sinew/idl)
set(SINEW_INCLUDE_INSTALL_DIR include/sinew)
configure_package_config_file(cmake/sinewConfig.cmake.in ${CMAKE_BINARY_DIR}/sinewConfig.cmake
  INSTALL_DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/sinew PATH_VARS SINEW_IDL_INSTALL_DIR SINEW_INCLUDE_INSTALL_DIR)
write_basic_package_version_file(${CMAKE_BINARY_DIR}/sinewConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_BINARY_DIR}/sinewConfig.cmake ${CMAKE_BINARY_DIR}/sinewConfigVersion.cmake
  DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/sinew)
# Headers are found below include/sinew as they are in the source. tests/install checks that the two lists name every
# header, and that what is installed compiles without the rest.
get_property(public_headers GLOBAL PROPERTY SINEW_PUBLIC_HEADERS)
get_property(other_headers GLOBAL PROPERTY SINEW_OTHER_HEADERS)
foreach(header ${public_headers})
  cmake_path(GET header PARENT_PATH folder)
  install(FILES ${header} DESTINATION include/sinew/${folder})
endforeach()
list(JOIN public_headers "\n" public_headers)
list(JOIN other_headers "\n" other_headers)
file(WRITE ${CMAKE_BINARY_DIR}/public_headers.txt "${public_headers}\n")
file(WRITE ${CMAKE_BINARY_DIR}/other_headers.txt "${other_headers}\n")
install(DIRECTORY ${CMAKE_BINARY_DIR}/generated/sinew_idl DESTINATION include/sinew
  FILES_MATCHING PATTERN "*.h")
install(DIRECTORY idl DESTINATION share/sinew FILES_MATCHING PATTERN "*.idl" PATTERN "README.md")
install(DIRECTORY robots schemas DESTINATION share/sinew COMPONENT core)
# Not in a package: that has them where Python looks.
install(FILES tools/python/sinew_recording.py DESTINATION share/sinew/python COMPONENT prefix)
install(DIRECTORY tools/python/sinew DESTINATION share/sinew/python COMPONENT prefix PATTERN "__pycache__" EXCLUDE)
