# Options of the build and the flags every target shares.
option(SINEW_BUILD_TESTS "Build the tests" ON)
set(SINEW_TESTS all CACHE STRING "Which tests: all, or what .ci/run runs in this configuration (day)")
set_property(CACHE SINEW_TESTS PROPERTY STRINGS all day)
option(SINEW_ORACLES "Tests against DART, MuJoCo and SDFormat (tools/oracle_packages.txt)" OFF)
option(SINEW_ASSERTIONS "Keep assert, eigen_assert and the assertions of the standard library in Release" OFF)
option(SINEW_BUILD_REPRODUCTION "Build what regenerates the published tables: sinew compare, search, train --net, control-test, paper" ON)
option(SINEW_BUILD_BENCH "Build the speed measurements (Google Benchmark)" OFF)
option(SINEW_WARNINGS_AS_ERRORS "Treat warnings as errors" ON)
option(SINEW_ROS2_NAMES "Name topics and types as ROS 2 does (rt/..., dds_::..._)" OFF)
option(SINEW_UNITY "Compile several files of a module or program at once: a third less time, but needs names unique in it" OFF)
set(SINEW_UNITY_BATCH 12 CACHE STRING "How many files SINEW_UNITY compiles at once; 0: a whole module")
option(SINEW_FUZZ "Build the libFuzzer targets of tests/fuzz (clang; preset fuzz)" OFF)
set(SINEW_SANITIZE "" CACHE STRING "Sanitizers, e.g. address,undefined or thread")

set(CMAKE_CXX_STANDARD 20)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS OFF)
add_compile_options(-fPIC)  # of libraries and programs alike, so that they share precompiled headers
set(CMAKE_RUNTIME_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/bin)
set(CMAKE_LIBRARY_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/lib)
set(CMAKE_ARCHIVE_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/lib)
if(NOT CMAKE_BUILD_TYPE)
  set(CMAKE_BUILD_TYPE Release)
endif()

set(CMAKE_UNITY_BUILD_BATCH_SIZE ${SINEW_UNITY_BATCH})
find_program(SINEW_CCACHE ccache)
if(SINEW_CCACHE)
  set(CMAKE_CXX_COMPILER_LAUNCHER ${SINEW_CCACHE})
endif()
# Every program and test is linked statically: mold is faster than ld.
find_program(SINEW_MOLD mold)
if(SINEW_MOLD)
  add_link_options(-fuse-ld=mold)
endif()

add_library(sinew_flags INTERFACE)
target_compile_options(sinew_flags INTERFACE
  $<BUILD_INTERFACE:-Wall;-Wextra;-Wpedantic;-Wshadow;-Wnon-virtual-dtor>
  # GCC 12 warns of std::string + with these where nothing is wrong (GCC bug 105329).
  $<BUILD_INTERFACE:$<$<CXX_COMPILER_ID:GNU>:-Wno-restrict;-Wno-array-bounds;-Wno-stringop-overflow>>
  # Clang warns of every aggregate whose last members have their default. SHELL: it must come after -Wextra, also where
  # a target has the flag as well.
  $<BUILD_INTERFACE:$<$<CXX_COMPILER_ID:Clang>:SHELL:-Wno-missing-field-initializers>>
  # GCC's -Wshadow includes it.
  $<BUILD_INTERFACE:$<$<CXX_COMPILER_ID:Clang>:-Wshadow-uncaptured-local>>
  $<BUILD_INTERFACE:$<$<BOOL:${SINEW_WARNINGS_AS_ERRORS}>:-Werror>>)
# GCC collects its own garbage less often: a tenth less time for up to a gigabyte a compiler.
add_compile_options($<$<COMPILE_LANG_AND_ID:CXX,GNU>:--param=ggc-min-heapsize=1000000>)
# CMake's -O3 takes 7 % longer to build; surrogate, close-loop and messages are as fast with -O2, with the same results.
add_compile_options($<$<CONFIG:Release>:-O2>)
if(SINEW_ASSERTIONS)
  add_compile_options($<$<CONFIG:Release>:-UNDEBUG>)
  add_compile_definitions(_GLIBCXX_ASSERTIONS)
endif()
if(SINEW_SANITIZE)
  # GCC's analysis of uninitialized values does not see through the instrumented code: it warns inside std::regex.
  add_compile_options($<$<COMPILE_LANG_AND_ID:CXX,GNU>:-Wno-maybe-uninitialized>)
  add_compile_options(-fsanitize=${SINEW_SANITIZE} -fno-omit-frame-pointer -fno-sanitize-recover=all)
  # A third of the time to compile; of these the address sanitizer reports what matters here. Fuzzing has them all.
  if(SINEW_SANITIZE MATCHES "undefined" AND NOT SINEW_FUZZ)
    add_compile_options(-fno-sanitize=null,alignment,vptr,object-size)
  endif()
  add_link_options(-fsanitize=${SINEW_SANITIZE})
endif()
if(SINEW_FUZZ AND NOT (CMAKE_CXX_COMPILER_ID STREQUAL "Clang" AND SINEW_SANITIZE MATCHES "fuzzer-no-link"))
  message(FATAL_ERROR "SINEW_FUZZ needs clang (apt-get install clang) and instrumented libraries: cmake --preset fuzz")
endif()
