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

# Loops over lanes are annotated with `omp simd`. These two floating-point flags give nearly all of what
# -ffast-math would, and keep NaN, infinity and the order of operations, on which equal bits depend.
# No lanes are peeled off a loop to reach an aligned address: a lane that is computed alone takes another log or exp,
# or contracts otherwise, than its neighbours, and what an element gets would depend on where it stands.
# -Wno-restrict: GCC 12 warns about its own std::string (GCC bug 105651).
# -Wno-psabi: vectors wider than registers are handed over within one program only, all of it compiled alike.
set(KERF_COMPILE_OPTIONS -Wall -Wextra -Wno-restrict -Wno-psabi -fopenmp-simd -fno-math-errno -fno-trapping-math
                         --param=vect-max-peeling-for-alignment=0)
if(KERF_NATIVE)
  list(APPEND KERF_COMPILE_OPTIONS -march=native)
endif()
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
