# cmake -DBUILD=... -DSOURCE=... -DSCRATCH=... [-DGENERATOR=...] -P run.cmake
function(run what)
  execute_process(COMMAND ${ARGN} RESULT_VARIABLE code OUTPUT_VARIABLE output ERROR_VARIABLE output)
  if(NOT code EQUAL 0)
    message(FATAL_ERROR "${what} failed (${code}):\n${output}")
  endif()
  set(output "${output}" PARENT_SCOPE)
endfunction()

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
