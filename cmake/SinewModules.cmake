# The helpers that every module uses: one adds a module, one a participant, one a test.
#
#   sinew_add_module(rls SOURCES rls.cc rls.h DEPENDS sinew::esn Eigen3::Eigen)
#     -> library target sinew_rls, alias sinew::rls. Includes start at the root of the project. FILE: it reads
#        and writes files; FRAME: it holds the frame of programs. Neither has hot loops: both are compiled with less
#        optimisation. PCH header.h: a precompiled header of its own. The target is exported and the headers among
#        SOURCES are installed; those among PRIVATE_HEADERS are not: no header of SOURCES may include them.
#        LOCAL: a part of our own programs; neither exported nor installed.
#   sinew_add_commands(sinew::reproduction_commands sinew::reproduction::AddCommands)
#     -> the program `sinew` links the library and calls the function, void(CLI::App&), at its start. The program
#        needs no header of the library. sinew_finish_commands(TARGET) writes the calls, after the last of these.
#   sinew_add_participant(rls SOURCES participant/main.cc DEPENDS sinew::rls)
#     -> program sinew_rls_participant, installed and built as bin/sinew-rls; links sinew::node.
#   sinew_add_test(rls_test SOURCES rls_test.cc DEPENDS sinew::rls [BYTES] [THREADS] [NIGHT] [LABEL dds] [SERIAL] [TIMEOUT s]
#                  [COMPUTES] [NIGHT_CASES Suite.Case...] [LONG Suite.Case...])
#     -> a GoogleTest program and one ctest; its cases are counted from GoogleTest's result file. Without LABEL it is a
#        unit test. A test that starts PROGRAMS names its LABEL: `programs`, or `dds`, `system`, or `soak` and `browser`
#        (not in tools/test). SERIAL: it runs in real time, so nothing runs beside it. One on whole recordings or many
#        runs of the surrogate has the label `acceptance`.
#        BYTES: it handles bytes or messages from outside; THREADS: its code starts threads. .ci/run runs a unit test in
#        one configuration: the first under the address sanitizer, the second (whatever its label) under the thread
#        sanitizer, all others with assertions. NIGHT: only tools/test and .ci/night run it, not .ci/run.
#        NIGHT_CASES: cases, or patterns of them, that do for further robots, roles and motions what others do once; .ci/run
#        leaves them out. LONG: those that repeat it for many seeds or recordings; sanitized builds leave them out.
#        COMPUTES: it spends its time in templates of its own, so it is optimised as modules are.
# A configuration defines only the tests that it is for: SINEW_TESTS (cmake/SinewOptions.cmake). The target chosen_tests
# builds them, soak_tests and browser_tests those of these labels.
foreach(list SINEW_MODULES SINEW_PUBLIC_HEADERS SINEW_OTHER_HEADERS)
  set_property(GLOBAL PROPERTY ${list} "")
endforeach()
set_property(GLOBAL PROPERTY SINEW_PROGRAMS "")

# Mains, commands and tests hold no hot loops (these live in modules): less optimisation halves their build. Clang's -O1
# takes as long as its -O2, its -O0 a third (docs/decisions/0007).
set(SINEW_LIGHT_OPTIMISATION $<$<NOT:$<CONFIG:Debug>>:$<IF:$<CXX_COMPILER_ID:Clang>,-O0,-O1>>)

# Precompiled headers: of modules, of modules that read files, of programs. Tests have theirs in tests/support. CLI11 is
# not among them: every unit that sees it compiles 200 of its inline functions.
set(frame_headers <Eigen/Core> <filesystem> <nlohmann/json.hpp> <spdlog/spdlog.h> <string> <vector>)
set(frame_libraries nlohmann_json::nlohmann_json spdlog::spdlog Eigen3::Eigen sinew_flags)
add_library(sinew_module_pch STATIC ${CMAKE_CURRENT_LIST_DIR}/pch/module.cc)
target_link_libraries(sinew_module_pch PRIVATE Eigen3::Eigen sinew_flags)
target_precompile_headers(sinew_module_pch PRIVATE <Eigen/Dense> <algorithm> <array> <cmath> <cstdint> <functional>
  <limits> <map> <memory> <numbers> <optional> <span> <stdexcept> <string> <string_view> <utility> <variant> <vector>)
add_library(sinew_file_pch STATIC ${CMAKE_CURRENT_LIST_DIR}/pch/module.cc)
target_compile_options(sinew_file_pch PRIVATE ${SINEW_LIGHT_OPTIMISATION})
target_link_libraries(sinew_file_pch PRIVATE Eigen3::Eigen nlohmann_json::nlohmann_json sinew_flags)
target_precompile_headers(sinew_file_pch PRIVATE <Eigen/Dense> <algorithm> <array> <cmath> <filesystem> <fstream>
  <functional> <map> <memory> <nlohmann/json.hpp> <optional> <sstream> <stdexcept> <string> <string_view> <vector>)
add_library(sinew_frame_pch STATIC ${CMAKE_CURRENT_LIST_DIR}/pch/module.cc)
target_compile_options(sinew_frame_pch PRIVATE ${SINEW_LIGHT_OPTIMISATION})
target_link_libraries(sinew_frame_pch PRIVATE ${frame_libraries})
target_precompile_headers(sinew_frame_pch PRIVATE ${frame_headers} ${CMAKE_CURRENT_LIST_DIR}/pch/fmt_once.h)

# sinew_list_headers(PROPERTY FILE...): adds the headers of the current folder, as they are included, to a global list.
function(sinew_list_headers property)
  foreach(file ${ARGN})
    if(file MATCHES "\\.h$" AND NOT IS_ABSOLUTE ${file})
      cmake_path(RELATIVE_PATH CMAKE_CURRENT_SOURCE_DIR BASE_DIRECTORY ${PROJECT_SOURCE_DIR} OUTPUT_VARIABLE folder)
      set_property(GLOBAL APPEND PROPERTY ${property} ${folder}/${file})
    endif()
  endforeach()
endfunction()

function(sinew_add_module name)
  cmake_parse_arguments(ARG "FILE;FRAME;LOCAL" "PCH" "SOURCES;PRIVATE_HEADERS;DEPENDS;PRIVATE_DEPENDS" ${ARGN})
  add_library(sinew_${name} STATIC ${ARG_SOURCES} ${ARG_PRIVATE_HEADERS})
  add_library(sinew::${name} ALIAS sinew_${name})
  set_target_properties(sinew_${name} PROPERTIES EXPORT_NAME ${name} OUTPUT_NAME sinew_${name})
  target_include_directories(sinew_${name} PUBLIC
    $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}> $<INSTALL_INTERFACE:include/sinew>)
  target_compile_features(sinew_${name} PUBLIC cxx_std_20)
  target_link_libraries(sinew_${name} PUBLIC ${ARG_DEPENDS}
    PRIVATE $<BUILD_INTERFACE:sinew_flags> ${ARG_PRIVATE_DEPENDS})
  set_target_properties(sinew_${name} PROPERTIES UNITY_BUILD ${SINEW_UNITY})
  if(ARG_FRAME)
    target_link_libraries(sinew_${name} PRIVATE
      $<BUILD_INTERFACE:CLI11::CLI11> $<BUILD_INTERFACE:nlohmann_json::nlohmann_json> spdlog::spdlog)
    target_compile_options(sinew_${name} PRIVATE ${SINEW_LIGHT_OPTIMISATION})
    target_precompile_headers(sinew_${name} REUSE_FROM sinew_frame_pch)
  elseif(ARG_FILE)
    target_link_libraries(sinew_${name} PRIVATE $<BUILD_INTERFACE:nlohmann_json::nlohmann_json>)
    target_compile_options(sinew_${name} PRIVATE ${SINEW_LIGHT_OPTIMISATION})
    target_precompile_headers(sinew_${name} REUSE_FROM sinew_file_pch)
  elseif(ARG_PCH)
    target_precompile_headers(sinew_${name} PRIVATE ${ARG_PCH})
  else()
    target_precompile_headers(sinew_${name} REUSE_FROM sinew_module_pch)
  endif()
  sinew_list_headers(SINEW_OTHER_HEADERS ${ARG_PRIVATE_HEADERS})
  if(ARG_LOCAL)
    sinew_list_headers(SINEW_OTHER_HEADERS ${ARG_SOURCES})
  else()
    sinew_list_headers(SINEW_PUBLIC_HEADERS ${ARG_SOURCES})
    set_property(GLOBAL APPEND PROPERTY SINEW_MODULES sinew_${name})
  endif()
endfunction()

function(sinew_add_commands library function)
  set_property(GLOBAL APPEND PROPERTY SINEW_COMMAND_LIBRARIES ${library})
  set_property(GLOBAL APPEND PROPERTY SINEW_COMMAND_FUNCTIONS ${function})
endfunction()

function(sinew_finish_commands target)
  get_property(libraries GLOBAL PROPERTY SINEW_COMMAND_LIBRARIES)
  get_property(functions GLOBAL PROPERTY SINEW_COMMAND_FUNCTIONS)
  set(declarations "")
  set(calls "")
  foreach(function ${functions})
    string(REGEX MATCH "^(.*)::([^:]+)$" matched ${function})
    string(APPEND declarations "namespace ${CMAKE_MATCH_1} {\nvoid ${CMAKE_MATCH_2}(CLI::App& app);\n}\n")
    string(APPEND calls "  ${function}(app);\n")
  endforeach()
  set(registry ${CMAKE_BINARY_DIR}/generated/command_registry.cc)
  file(CONFIGURE OUTPUT ${registry} CONTENT [[// Written by CMake from the calls of sinew_add_commands.
#include <CLI/CLI.hpp>

#include "tools/sinew/commands.h"

@declarations@
namespace sinew::tools {
void AddAllCommands(CLI::App& app) {
@calls@}
}  // namespace sinew::tools
]] @ONLY)
  target_sources(${target} PRIVATE ${registry})
  target_link_libraries(${target} PRIVATE ${libraries})
endfunction()

add_custom_target(programs)

function(sinew_add_program target binary)
  cmake_parse_arguments(ARG "" "" "SOURCES;DEPENDS" ${ARGN})
  add_executable(${target} ${ARG_SOURCES})
  set_target_properties(${target} PROPERTIES OUTPUT_NAME ${binary})
  target_compile_options(${target} PRIVATE ${SINEW_LIGHT_OPTIMISATION})
  target_link_libraries(${target} PRIVATE ${ARG_DEPENDS}
    CLI11::CLI11 nlohmann_json::nlohmann_json spdlog::spdlog sinew_flags)
  target_precompile_headers(${target} REUSE_FROM sinew_frame_pch)
  set_target_properties(${target} PROPERTIES UNITY_BUILD ${SINEW_UNITY})
  if(SINEW_UNITY_BATCH)
    set_target_properties(${target} PROPERTIES UNITY_BUILD_BATCH_SIZE 15)
  endif()
  install(TARGETS ${target} RUNTIME)
  sinew_list_headers(SINEW_OTHER_HEADERS ${ARG_SOURCES})
  set_property(GLOBAL APPEND PROPERTY SINEW_PROGRAMS ${target})
  set_property(GLOBAL APPEND PROPERTY SINEW_PROGRAMS_${CMAKE_INSTALL_DEFAULT_COMPONENT_NAME} ${target})
  add_dependencies(programs ${target})
endfunction()

function(sinew_add_participant name)
  cmake_parse_arguments(ARG "" "" "SOURCES;DEPENDS" ${ARGN})
  string(REPLACE "_" "-" binary "sinew-${name}")
  sinew_add_program(sinew_${name}_participant ${binary}
    SOURCES ${ARG_SOURCES} DEPENDS sinew::node ${ARG_DEPENDS})
endfunction()

foreach(target chosen_tests soak_tests browser_tests)
  add_custom_target(${target})
endforeach()
set(SINEW_TEST_RESULTS ${CMAKE_BINARY_DIR}/test_results)

function(sinew_add_test name)
  cmake_parse_arguments(ARG "BYTES;COMPUTES;NIGHT;SERIAL;THREADS" "LABEL;TIMEOUT" "SOURCES;DEPENDS;DEFINITIONS;PROGRAMS;LONG;NIGHT_CASES" ${ARGN})
  if(ARG_UNPARSED_ARGUMENTS)
    message(FATAL_ERROR "${name}: '${ARG_UNPARSED_ARGUMENTS}' belongs to no keyword; a test has one LABEL")
  endif()
  if(ARG_PROGRAMS AND NOT ARG_LABEL)
    message(FATAL_ERROR "${name} starts programs: LABEL programs, or LABEL dds SERIAL")
  endif()
  # Whether this configuration is for the test.
  set(by_day FALSE)
  if(SINEW_TESTS STREQUAL "day")
    set(by_day TRUE)
  endif()
  if(by_day AND ARG_NIGHT)
    return()
  elseif(SINEW_SANITIZE MATCHES thread)
    if(NOT ARG_THREADS)
      return()
    endif()
  elseif(SINEW_SANITIZE)
    if(ARG_LABEL OR (by_day AND NOT ARG_BYTES))
      return()
    endif()
  elseif(by_day AND ARG_BYTES AND NOT ARG_LABEL)
    return()
  endif()
  if(NOT ARG_LABEL)
    set(ARG_LABEL unit)
  endif()
  if(NOT ARG_TIMEOUT)
    set(ARG_TIMEOUT 300)
  endif()

  add_executable(${name} ${ARG_SOURCES})
  target_link_libraries(${name} PRIVATE ${ARG_DEPENDS} Eigen3::Eigen GTest::gtest GTest::gmock GTest::gtest_main sinew_flags)
  target_include_directories(${name} PRIVATE ${PROJECT_SOURCE_DIR})
  target_compile_options(${name} PRIVATE -Wno-missing-field-initializers)
  if(ARG_COMPUTES)
    target_precompile_headers(${name} REUSE_FROM sinew_module_pch)
  else()
    target_compile_options(${name} PRIVATE ${SINEW_LIGHT_OPTIMISATION})
    target_precompile_headers(${name} REUSE_FROM sinew_test_pch)
  endif()
  target_compile_definitions(${name} PRIVATE
    SINEW_SOURCE_DIR="${PROJECT_SOURCE_DIR}"
    SINEW_BIN_DIR="${CMAKE_RUNTIME_OUTPUT_DIRECTORY}"
    SINEW_SHARED_DIR="${PROJECT_SOURCE_DIR}/../shared"
    ${ARG_DEFINITIONS})
  set_target_properties(${name} PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/tests)
  set_target_properties(${name} PROPERTIES UNITY_BUILD ${SINEW_UNITY})
  if(ARG_LABEL MATCHES "soak|browser")
    add_dependencies(${ARG_LABEL}_tests ${name})
    set_target_properties(${name} PROPERTIES EXCLUDE_FROM_ALL TRUE)
  else()
    add_dependencies(chosen_tests ${name})
  endif()
  if(ARG_PROGRAMS)
    add_dependencies(${name} ${ARG_PROGRAMS})
  endif()
  set(left_out "")
  if(by_day)
    list(APPEND left_out ${ARG_NIGHT_CASES})
  endif()
  if(SINEW_SANITIZE)
    list(APPEND left_out ${ARG_LONG})
  endif()
  set(filter "")
  if(left_out)
    list(JOIN left_out ":" left_out)
    set(filter --gtest_filter=-${left_out})
  endif()
  # The longest ones begin first.
  add_test(NAME ${name} COMMAND ${name} --gtest_brief=1 --gtest_output=xml:${SINEW_TEST_RESULTS}/${name}.xml ${filter})
  set_tests_properties(${name} PROPERTIES LABELS ${ARG_LABEL} TIMEOUT ${ARG_TIMEOUT} COST ${ARG_TIMEOUT})
  if(ARG_SERIAL)
    set_tests_properties(${name} PROPERTIES RUN_SERIAL TRUE)
  endif()
endfunction()
