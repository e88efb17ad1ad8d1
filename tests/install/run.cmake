# cmake -DBUILD=... -DSOURCE=... -DSCRATCH=... [-DGENERATOR=...] -P run.cmake
include(${CMAKE_CURRENT_LIST_DIR}/run_command.cmake)

file(REMOVE_RECURSE ${SCRATCH})
run("installing" ${CMAKE_COMMAND} --install ${BUILD} --prefix ${SCRATCH}/prefix)
run("configuring the consumer" ${CMAKE_COMMAND} -S ${SOURCE}/consumer -B ${SCRATCH}/build -G ${GENERATOR}
  -DCMAKE_BUILD_TYPE=Release -DCMAKE_PREFIX_PATH=${SCRATCH}/prefix)
run("building the consumer" ${CMAKE_COMMAND} --build ${SCRATCH}/build)
run("running the consumer" ${SCRATCH}/build/hold-still --help)
if(NOT output MATCHES "--lockstep")
  message(FATAL_ERROR "the consumer's help lacks the common options:\n${output}")
endif()
# Installed programs run from where they are.
run("running the installed command" ${SCRATCH}/prefix/bin/sinew effects --json)
if(NOT EXISTS ${SCRATCH}/prefix/share/sinew/robots/rig/model.yaml)
  message(FATAL_ERROR "robots/rig/model.yaml is not installed")
endif()
file(REMOVE_RECURSE ${SCRATCH})
