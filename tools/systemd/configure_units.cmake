# Run by `cmake --install`: fills in what the units name.
file(READ ${SINEW_SYSTEMD_SOURCE}/sandbox.in SINEW_SANDBOX)
file(GLOB templates ${SINEW_SYSTEMD_SOURCE}/*.in)
list(REMOVE_ITEM templates ${SINEW_SYSTEMD_SOURCE}/sandbox.in)
foreach(template ${templates})
  get_filename_component(name ${template} NAME)
  string(REGEX REPLACE "\\.in$" "" name ${name})
  configure_file(${template} ${SINEW_SYSTEMD_BINARY}/${name} @ONLY)
endforeach()
