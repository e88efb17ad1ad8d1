# cmake -DBUILD=... -DPROJECT=... -DSOURCE=... -DSCRATCH=... -DGENERATOR=... -P headers.cmake
# What is installed are the public headers and nothing else, and they compile without the source.
cmake_minimum_required(VERSION 3.25)
include(${CMAKE_CURRENT_LIST_DIR}/run_command.cmake)

file(STRINGS ${BUILD}/public_headers.txt public)
file(STRINGS ${BUILD}/other_headers.txt other)

# What tools/docs has pages of.
run("listing the documented headers" python3 ${PROJECT}/tools/site/build.py --headers)
string(REGEX MATCHALL "[^\n]+" documented "${output}")
set(listed ${public})
list(SORT documented)
list(SORT listed)
if(NOT documented STREQUAL listed)
  message(SEND_ERROR "tools/docs documents other headers than the public ones:\n${documented}\nexpected:\n${listed}")
endif()

# A header of a module that no list names would be missing from the package without a word.
file(GLOB_RECURSE headers RELATIVE ${PROJECT} ${PROJECT}/components/*.h ${PROJECT}/bridge/*.h ${PROJECT}/sim/*.h
  ${PROJECT}/tools/*.h)
foreach(header ${headers})
  if(NOT header IN_LIST public AND NOT header IN_LIST other)
    message(SEND_ERROR "${header} is in no SOURCES or PRIVATE_HEADERS of a module or program")
  endif()
  if(header IN_LIST public AND header IN_LIST other)
    message(SEND_ERROR "${header} is public and private at once")
  endif()
endforeach()

file(REMOVE_RECURSE ${SCRATCH})
run("installing" ${CMAKE_COMMAND} --install ${BUILD} --prefix ${SCRATCH}/prefix)
file(GLOB_RECURSE installed RELATIVE ${SCRATCH}/prefix/include/sinew ${SCRATCH}/prefix/include/sinew/*.h)
foreach(header ${installed})
  if(NOT header IN_LIST public AND NOT header MATCHES "^sinew_idl/" AND NOT header MATCHES "^components/topics/node/(version|topic_list)\\.h$")
    message(SEND_ERROR "${header} is installed and not public")
  endif()
endforeach()
foreach(header ${public})
  if(NOT header IN_LIST installed)
    message(SEND_ERROR "${header} is public and not installed")
  endif()
endforeach()

list(JOIN installed "\n" lines)
file(WRITE ${SCRATCH}/headers.txt "${lines}\n")
run("configuring" ${CMAKE_COMMAND} -S ${SOURCE}/headers -B ${SCRATCH}/build -G ${GENERATOR}
  -DCMAKE_BUILD_TYPE=Debug -DCMAKE_PREFIX_PATH=${SCRATCH}/prefix -DHEADERS=${SCRATCH}/headers.txt)
run("compiling every installed header" ${CMAKE_COMMAND} --build ${SCRATCH}/build)
file(REMOVE_RECURSE ${SCRATCH})
