# cmake -DBUILD=... -DSOURCE=... -DSCRATCH=... [-DGENERATOR=...] -P run.cmake
include(${CMAKE_CURRENT_LIST_DIR}/run_command.cmake)

file(REMOVE_RECURSE ${SCRATCH})
set(ENV{CYCLONEDDS_URI} file://${SOURCE}/cyclone/loopback.xml)

# Whether an outside program keeps the contract of a controller, by the installed command.
function(conform program)
  run("the contract of ${program}" ${SCRATCH}/prefix/bin/sinew conform control ${program} --domain 69)
  message("${output}")
endfunction()

run("installing" ${CMAKE_COMMAND} --install ${BUILD} --prefix ${SCRATCH}/prefix)
run("configuring the consumer" ${CMAKE_COMMAND} -S ${SOURCE}/consumer -B ${SCRATCH}/build -G ${GENERATOR}
  -DCMAKE_BUILD_TYPE=Release -DCMAKE_PREFIX_PATH=${SCRATCH}/prefix)
run("building the consumer" ${CMAKE_COMMAND} --build ${SCRATCH}/build)
run("running the consumer" ${SCRATCH}/build/hold-still --help)
if(NOT output MATCHES "--lockstep")
  message(FATAL_ERROR "the consumer's help lacks the common options:\n${output}")
endif()
conform(${SCRATCH}/build/pid-controller)

run("configuring the Cyclone DDS project" ${CMAKE_COMMAND} -S ${SOURCE}/cyclone -B ${SCRATCH}/cyclone -G ${GENERATOR}
  -DCMAKE_BUILD_TYPE=Release -DCMAKE_PREFIX_PATH=${SCRATCH}/prefix)
run("building the Cyclone DDS project" ${CMAKE_COMMAND} --build ${SCRATCH}/cyclone)
conform(${SCRATCH}/cyclone/cyclone-controller)
# Installed programs run from where they are.
run("running the installed command" ${SCRATCH}/prefix/bin/sinew effects --json)
if(NOT EXISTS ${SCRATCH}/prefix/share/sinew/robots/rig/model.yaml)
  message(FATAL_ERROR "robots/rig/model.yaml is not installed")
endif()
if(NOT EXISTS ${SCRATCH}/prefix/share/sinew/schemas/model-1.json)
  message(FATAL_ERROR "schemas/model-1.json is not installed")
endif()
file(REMOVE_RECURSE ${SCRATCH})
