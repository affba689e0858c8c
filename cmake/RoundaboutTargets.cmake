# Compile options shared by everything, and the four functions that declare targets.

add_library(roundabout_options INTERFACE)
target_include_directories(roundabout_options INTERFACE ${CMAKE_SOURCE_DIR})
target_compile_options(roundabout_options INTERFACE
  -Wall -Wextra -Wpedantic -Wshadow -Wnon-virtual-dtor -Wold-style-cast -Wcast-align
  -Woverloaded-virtual -Wformat=2
  # Results must not depend on whether the compiler fuses a multiply and an add.
  -ffp-contract=off)
if(ROUNDABOUT_WERROR)
  target_compile_options(roundabout_options INTERFACE -Werror)
endif()
if(ROUNDABOUT_SANITIZE)
  # GCC warns of values and lengths in its own headers that instrumentation makes it lose track of. The dev and
  # release presets keep these warnings.
  target_compile_options(roundabout_options INTERFACE
    -fsanitize=${ROUNDABOUT_SANITIZE} -fno-omit-frame-pointer -fno-sanitize-recover=all
    "$<$<CXX_COMPILER_ID:GNU>:-Wno-maybe-uninitialized;-Wno-array-bounds;-Wno-stringop-overflow>")
  target_link_options(roundabout_options INTERFACE -fsanitize=${ROUNDABOUT_SANITIZE})
elseif(ROUNDABOUT_NATIVE)
  target_compile_options(roundabout_options INTERFACE -march=native)
endif()

# Headers of other people that most files read are compiled once for programs and once for tests (GCC wants the options
# of both sides to be the same). Every file still includes what it uses: the dev preset builds without.
find_package(Threads REQUIRED)
target_compile_options(roundabout_options INTERFACE -pthread)
set(ROUNDABOUT_COMMON_HEADERS
  <algorithm> <array> <chrono> <cmath> <cstdint> <filesystem> <fstream> <functional> <limits> <map> <memory> <numbers>
  <optional> <random> <span> <sstream> <stdexcept> <string> <string_view> <utility> <variant> <vector>
  <Eigen/Core> <Eigen/Geometry> <spdlog/fmt/fmt.h>)
# Who reads a precompiled header has to mean the same by it.
target_compile_definitions(roundabout_options INTERFACE
  $<TARGET_PROPERTY:spdlog::spdlog,INTERFACE_COMPILE_DEFINITIONS>)
function(roundabout_precompiled name)
  if(NOT ROUNDABOUT_PRECOMPILE)
    return()
  endif()
  cmake_parse_arguments(ARG "" "" "HEADERS;LINK;OPTIONS" ${ARGN})
  file(CONFIGURE OUTPUT ${CMAKE_BINARY_DIR}/precompiled/${name}.cpp CONTENT "")
  add_library(${name} OBJECT ${CMAKE_BINARY_DIR}/precompiled/${name}.cpp)
  target_link_libraries(${name} PRIVATE roundabout_options Eigen3::Eigen ${ARG_LINK})
  target_compile_options(${name} PRIVATE ${ARG_OPTIONS})
  target_precompile_headers(${name} PRIVATE ${ROUNDABOUT_COMMON_HEADERS} ${ARG_HEADERS})
endfunction()
set(ROUNDABOUT_TEST_OPTIONS $<$<CONFIG:Release>:-O0>)
roundabout_precompiled(roundabout_precompiled)
roundabout_precompiled(roundabout_command_precompiled HEADERS <CLI/CLI.hpp> LINK CLI11::CLI11)
roundabout_precompiled(roundabout_test_precompiled HEADERS <gmock/gmock.h> <gtest/gtest.h>
  LINK GTest::gmock GTest::gtest OPTIONS ${ROUNDABOUT_TEST_OPTIONS})
function(roundabout_use_precompiled name from)
  if(ROUNDABOUT_PRECOMPILE)
    target_precompile_headers(${name} REUSE_FROM ${from})
  endif()
endfunction()

# roundabout_library(NAME [COMMANDS] SOURCES… LINK …): a static library with the house's options. COMMANDS: of command
# lines, whose header takes seconds to read.
function(roundabout_library name)
  cmake_parse_arguments(ARG "COMMANDS" "" "SOURCES;LINK" ${ARGN})
  add_library(${name} STATIC ${ARG_SOURCES})
  target_link_libraries(${name} PUBLIC roundabout_options ${ARG_LINK})
  if(ARG_COMMANDS)
    roundabout_use_precompiled(${name} roundabout_command_precompiled)
  else()
    roundabout_use_precompiled(${name} roundabout_precompiled)
  endif()
endfunction()

# roundabout_hot_path(NAME): a library whose speed is measured and that gains from -O3.
function(roundabout_hot_path name)
  target_compile_options(${name} PRIVATE $<$<CONFIG:Release>:-O3>)
endfunction()

# roundabout_executable(NAME [MEASUREMENT] SOURCES … LINK …): a program in <build>/bin. MEASUREMENT: nobody needs it to
# fly or to test, so it is built only on demand and by the target `measurements`.
add_custom_target(measurements)
function(roundabout_executable name)
  cmake_parse_arguments(ARG "MEASUREMENT" "" "SOURCES;LINK" ${ARGN})
  add_executable(${name} ${ARG_SOURCES})
  target_link_libraries(${name} PRIVATE roundabout_options ${ARG_LINK})
  roundabout_use_precompiled(${name} roundabout_command_precompiled)
  if(ARG_MEASUREMENT)
    set_target_properties(${name} PROPERTIES EXCLUDE_FROM_ALL TRUE)
    add_dependencies(measurements ${name})
  endif()
endfunction()

# roundabout_test(NAME SOURCES … LINK … [LABEL unit|contract|system|bench] [TIMEOUT s] [OPTIMIZE]): one GoogleTest
# program; each of its tests is a test of CTest's own. System tests have an LCM port each, so they may run side by side.
function(roundabout_test name)
  cmake_parse_arguments(ARG "LONG;OPTIMIZE" "LABEL;TIMEOUT" "SOURCES;LINK" ${ARGN})
  if(NOT ARG_LABEL)
    set(ARG_LABEL unit)
  endif()
  if(NOT ARG_TIMEOUT)
    set(ARG_TIMEOUT 60)
  endif()
  if(ROUNDABOUT_SANITIZE)
    math(EXPR ARG_TIMEOUT "5 * ${ARG_TIMEOUT}")
  endif()
  add_executable(${name} ${ARG_SOURCES})
  set_target_properties(${name} PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/tests)
  target_link_libraries(${name} PRIVATE roundabout_options ${ARG_LINK} GTest::gmock GTest::gtest_main)
  # Most tests are compiled for longer than they run.
  if(NOT ARG_OPTIMIZE)
    target_compile_options(${name} PRIVATE ${ROUNDABOUT_TEST_OPTIONS})
    roundabout_use_precompiled(${name} roundabout_test_precompiled)
  endif()
  target_compile_definitions(${name} PRIVATE
    ROUNDABOUT_SOURCE_DIR="${CMAKE_SOURCE_DIR}" ROUNDABOUT_BIN_DIR="${CMAKE_RUNTIME_OUTPUT_DIRECTORY}")
  # One label, since gtest_discover_tests loses all but the first of a list; ctest -L and -LE match a part of it.
  set(label ${ARG_LABEL})
  if(ARG_LONG)
    string(APPEND label _long)
  endif()
  gtest_discover_tests(${name} DISCOVERY_TIMEOUT 60
    PROPERTIES LABELS ${label} TIMEOUT ${ARG_TIMEOUT}
      ENVIRONMENT TSAN_OPTIONS=suppressions=${CMAKE_SOURCE_DIR}/cmake/tsan.supp)
endfunction()
include(GoogleTest)

# roundabout_benchmark(NAME SOURCES … LINK …): one Google Benchmark program.
function(roundabout_benchmark name)
  cmake_parse_arguments(ARG "" "" "SOURCES;LINK" ${ARGN})
  roundabout_executable(${name} MEASUREMENT SOURCES ${ARG_SOURCES} LINK ${ARG_LINK} benchmark::benchmark)
endfunction()
