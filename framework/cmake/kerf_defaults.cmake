# Language, build type and flags that every Kerf target shares.

set(CMAKE_CXX_STANDARD 20)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_POSITION_INDEPENDENT_CODE ON)
set(CMAKE_EXPORT_COMPILE_COMMANDS ON)
set(CMAKE_RUNTIME_OUTPUT_DIRECTORY "${CMAKE_BINARY_DIR}/bin")
set(CMAKE_ARCHIVE_OUTPUT_DIRECTORY "${CMAKE_BINARY_DIR}/lib")
set(CMAKE_LIBRARY_OUTPUT_DIRECTORY "${CMAKE_BINARY_DIR}/lib")

if(NOT CMAKE_BUILD_TYPE AND NOT CMAKE_CONFIGURATION_TYPES)
  set(CMAKE_BUILD_TYPE Release CACHE STRING "Debug, Release or RelWithDebInfo" FORCE)
endif()

# The same bits on every x86-64 machine and from every compiler: every operation rounds by itself, in the order that is
# written. -ffp-contract=off, because a product and a sum that are fused into one instruction round once instead of
# twice, and only machines from x86-64-v3 on can fuse; which of them a compiler fuses is its own choice, too.
# Elementary functions come from kerf/functions.hpp, not from the C library.
# Loops over lanes are annotated with `omp simd`. The other two floating-point flags give nearly all of what -ffast-math
# would, and keep NaN, infinity and the order of operations.
# -Wno-psabi: vectors wider than registers are handed over within one program only, all of it compiled alike.
set(KERF_COMPILE_OPTIONS -Wall -Wextra -Wno-psabi -fopenmp-simd -ffp-contract=off -fno-math-errno -fno-trapping-math)
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  # -Wno-restrict: GCC 12 warns about its own std::string (GCC bug 105651).
  # No lanes are peeled off a loop to reach an aligned address: rows are aligned, and peeled lanes would take as long.
  list(APPEND KERF_COMPILE_OPTIONS -Wno-restrict --param=vect-max-peeling-for-alignment=0)
endif()
if(KERF_ARCH)
  set(KERF_MACHINE_OPTIONS -march=${KERF_ARCH})
elseif(KERF_NATIVE)
  set(KERF_MACHINE_OPTIONS -march=native)
endif()
# GCC 12 stores wrong constants where it makes them by a broadcast from a general register: it compares only the words
# of a constant that it keeps, and leading zeros are not kept (framework/cmake/stored_constants.cpp). It does so only
# where such registers may be moved to vectors directly. Without these moves contact is 4 % slower, the elements not at
# all; -mmove-max=128 -mstore-max=128, which avoid the constants too, make the elements 17 % slower.
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND CMAKE_CXX_COMPILER_VERSION VERSION_LESS 13
   AND CMAKE_CXX_COMPILER_VERSION VERSION_GREATER_EQUAL 12 AND CMAKE_SYSTEM_PROCESSOR MATCHES "x86_64|AMD64")
  list(APPEND KERF_MACHINE_OPTIONS -mtune-ctrl=^inter_unit_moves_to_vec)
endif()
list(APPEND KERF_COMPILE_OPTIONS ${KERF_MACHINE_OPTIONS})
include("${CMAKE_CURRENT_LIST_DIR}/kerf_check_compiler.cmake")
if(KERF_WERROR)
  list(APPEND KERF_COMPILE_OPTIONS -Werror)
endif()
set(CMAKE_CXX_FLAGS_RELEASE "-O3 -DNDEBUG")

find_program(KERF_CCACHE ccache)
mark_as_advanced(KERF_CCACHE)
if(KERF_CCACHE AND NOT CMAKE_CXX_COMPILER_LAUNCHER)
  set(CMAKE_CXX_COMPILER_LAUNCHER "${KERF_CCACHE}")
endif()

# What every target of ours compiles with; linked privately, so it is not forced on outside plugins.
add_library(kerf_options INTERFACE)
target_compile_options(kerf_options INTERFACE $<$<COMPILE_LANGUAGE:CXX>:${KERF_COMPILE_OPTIONS}>)
