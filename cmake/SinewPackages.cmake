# Debian packages by `cpack -G DEB`, a package for each component; tools/package builds them.
set(SINEW_COMPONENTS core sim view dev python)

# Manual pages and completion, from the programs themselves. Full installations do without.
get_property(programs GLOBAL PROPERTY SINEW_PROGRAMS)
set(pages ${CMAKE_BINARY_DIR}/pages)
set(page_commands "")
foreach(component core sim view)
  set(arguments "")
  get_property(component_programs GLOBAL PROPERTY SINEW_PROGRAMS_${component})
  foreach(program ${component_programs})
    # A participant is a daemon: sinew-estop(8), beside the page of `sinew estop`, sinew-estop(1).
    if(program MATCHES "_participant$")
      list(APPEND arguments 8 $<TARGET_FILE:${program}>)
    else()
      list(APPEND arguments 1 $<TARGET_FILE:${program}>)
    endif()
  endforeach()
  list(APPEND page_commands COMMAND ${Python3_EXECUTABLE} ${CMAKE_CURRENT_SOURCE_DIR}/tools/debian/man_pages.py
    ${pages}/${component} ${PROJECT_VERSION} ${arguments})
  install(DIRECTORY ${pages}/${component}/ DESTINATION share/man COMPONENT ${component} EXCLUDE_FROM_ALL)
endforeach()
add_custom_command(OUTPUT ${pages}/done
  COMMAND ${CMAKE_COMMAND} -E rm -rf ${pages}
  ${page_commands}
  COMMAND $<TARGET_FILE:sinew_command> completion bash > ${pages}/sinew
  COMMAND $<TARGET_FILE:sinew_command> completion zsh > ${pages}/_sinew
  COMMAND $<TARGET_FILE:sinew_command> completion fish > ${pages}/sinew.fish
  COMMAND ${CMAKE_COMMAND} -E touch ${pages}/done
  DEPENDS ${programs} tools/debian/man_pages.py VERBATIM)
install(FILES ${pages}/sinew DESTINATION share/bash-completion/completions COMPONENT core EXCLUDE_FROM_ALL)
install(FILES ${pages}/_sinew DESTINATION share/zsh/vendor-completions COMPONENT core EXCLUDE_FROM_ALL)
install(FILES ${pages}/sinew.fish DESTINATION share/fish/vendor_completions.d COMPONENT core EXCLUDE_FROM_ALL)
# All that the packages hold.
get_property(modules GLOBAL PROPERTY SINEW_MODULES)
add_custom_target(package_contents DEPENDS ${pages}/done ${programs} ${modules})

install(FILES tools/systemd/environment DESTINATION /etc/sinew COMPONENT core EXCLUDE_FROM_ALL)
install(FILES tools/python/sinew_recording.py DESTINATION lib/python3/dist-packages COMPONENT python EXCLUDE_FROM_ALL)
install(DIRECTORY tools/python/sinew DESTINATION lib/python3/dist-packages COMPONENT python EXCLUDE_FROM_ALL
  PATTERN "__pycache__" EXCLUDE)

file(STRINGS tools/run_packages.txt run_packages REGEX "^[a-z0-9]")
set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS tools/run_packages.txt)
# The user and its folders, also where systemd does not run.
list(APPEND run_packages "systemd-standalone-sysusers | systemd-sysusers" "systemd-standalone-tmpfiles | systemd-tmpfiles")
list(JOIN run_packages ", " CPACK_DEBIAN_CORE_PACKAGE_DEPENDS)
list(JOIN SINEW_DEV_PACKAGES ", " CPACK_DEBIAN_DEV_PACKAGE_DEPENDS)
set(CPACK_DEBIAN_PYTHON_PACKAGE_DEPENDS "python3, python3-numpy, python3-yaml, python3-zstandard")
set(CPACK_DEBIAN_PYTHON_PACKAGE_RECOMMENDS python3-lz4)
set(CPACK_DEBIAN_PYTHON_PACKAGE_SUGGESTS sinew-core)
set(CPACK_DEBIAN_PYTHON_PACKAGE_ARCHITECTURE all)
set(CPACK_DEBIAN_CORE_PACKAGE_SUGGESTS "sinew-sim, sinew-view, python3-sinew")

set(CPACK_COMPONENT_CORE_DESCRIPTION "components for robots with SEA-PEA actuators
The command sinew, the bridge to motor controllers behind CAN, pneumatics,
regime detector, networks and their adaptation, controller, reference, logger
and player: processes on typed DDS topics. Units are installed, not enabled.")
set(CPACK_COMPONENT_SIM_DESCRIPTION "simulated robots for Sinew
Rigid bodies from a URDF, an independent simulation of the rig, a virtual CAN
bus with motor controllers, and stand-ins for participants.")
set(CPACK_COMPONENT_VIEW_DESCRIPTION "live page of a robot that runs Sinew
The program behind `sinew view`: a page for browsers, and the topics for
Foxglove and Lichtblick.")
set(CPACK_COMPONENT_DEV_DESCRIPTION "participants of one's own for Sinew
Headers, static libraries and what CMake's find_package(sinew) reads; the
topics as IDL files.")
set(CPACK_COMPONENT_PYTHON_DESCRIPTION "Sinew from Python
Recordings as NumPy arrays and model files as objects, which needs no program of
Sinew; with sinew-core check-data and close-loop, their reports as objects.")
set(CPACK_DEBIAN_CORE_PACKAGE_NAME sinew-core)
set(CPACK_DEBIAN_SIM_PACKAGE_NAME sinew-sim)
set(CPACK_DEBIAN_VIEW_PACKAGE_NAME sinew-view)
set(CPACK_DEBIAN_DEV_PACKAGE_NAME libsinew-dev)
set(CPACK_DEBIAN_PYTHON_PACKAGE_NAME python3-sinew)
foreach(component CORE SIM VIEW)
  set(CPACK_DEBIAN_${component}_PACKAGE_SHLIBDEPS ON)
  set(CPACK_DEBIAN_${component}_PACKAGE_SECTION science)
endforeach()
set(CPACK_DEBIAN_DEV_PACKAGE_SECTION libdevel)
set(CPACK_DEBIAN_PYTHON_PACKAGE_SECTION python)
foreach(component ${SINEW_COMPONENTS})
  string(TOUPPER ${component} COMPONENT)
  install(FILES tools/debian/copyright DESTINATION share/doc/${CPACK_DEBIAN_${COMPONENT}_PACKAGE_NAME}
    COMPONENT ${component} EXCLUDE_FROM_ALL)
endforeach()
# Programs of two builds may not match: their topics carry a hash.
set(CPACK_COMPONENT_SIM_DEPENDS core)
set(CPACK_COMPONENT_VIEW_DEPENDS core)
set(CPACK_DEBIAN_ENABLE_COMPONENT_DEPENDS ON)

set(scripts ${CMAKE_CURRENT_SOURCE_DIR}/tools/debian)
set(CPACK_DEBIAN_CORE_PACKAGE_CONTROL_EXTRA
  "${scripts}/postinst;${scripts}/prerm;${scripts}/postrm;${scripts}/conffiles")
set(CPACK_DEBIAN_CORE_PACKAGE_CONTROL_STRICT_PERMISSION TRUE)
set(CPACK_DEBIAN_PYTHON_PACKAGE_CONTROL_EXTRA "${scripts}/python/prerm")
set(CPACK_DEBIAN_PYTHON_PACKAGE_CONTROL_STRICT_PERMISSION TRUE)
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "")  # each package has its own
set(CPACK_PACKAGE_NAME sinew)
set(CPACK_PACKAGE_CONTACT "Sinew maintainers <maintainers@users.noreply.h-seed-468a0e51.example>")
set(CPACK_PACKAGE_DIRECTORY ${CMAKE_BINARY_DIR}/packages)
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_COMPONENTS_ALL ${SINEW_COMPONENTS})
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_COMPONENTS_GROUPING IGNORE)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
include(CPack)
