# Finds the packages Kerf stands on and wraps each as one imported-style target, so that a target which does not
# need a package never sees its headers.

set(MPI_CXX_SKIP_MPICXX TRUE)  # the C interface is enough; the C++ bindings left the standard
find_package(MPI REQUIRED COMPONENTS CXX)

# Trilinos' package file sets compiler variables of its own; a function keeps them from leaking out.
function(kerf_find_trilinos)
  find_package(Trilinos REQUIRED COMPONENTS Tpetra Zoltan)
  add_library(kerf_tpetra INTERFACE)
  target_include_directories(kerf_tpetra SYSTEM INTERFACE ${Trilinos_INCLUDE_DIRS})
  target_link_libraries(kerf_tpetra INTERFACE ${Trilinos_LIBRARIES} MPI::MPI_CXX)
  find_package(Zoltan REQUIRED)
  add_library(kerf_zoltan INTERFACE)
  target_include_directories(kerf_zoltan SYSTEM INTERFACE ${Zoltan_INCLUDE_DIRS})
  target_link_libraries(kerf_zoltan INTERFACE ${Zoltan_LIBRARIES} MPI::MPI_CXX)
endfunction()
kerf_find_trilinos()

# Zoltan calls PT-Scotch; Kerf itself only resets its random numbers.
find_path(PTSCOTCH_INCLUDE_DIR ptscotch.h PATH_SUFFIXES scotch REQUIRED)
find_library(PTSCOTCH_LIBRARY ptscotch REQUIRED)
mark_as_advanced(PTSCOTCH_INCLUDE_DIR PTSCOTCH_LIBRARY)
add_library(kerf_ptscotch INTERFACE)
target_include_directories(kerf_ptscotch SYSTEM INTERFACE ${PTSCOTCH_INCLUDE_DIR})
target_link_libraries(kerf_ptscotch INTERFACE ${PTSCOTCH_LIBRARY} MPI::MPI_CXX)

find_path(UDUNITS2_INCLUDE_DIR udunits2.h PATH_SUFFIXES udunits2 REQUIRED)
find_library(UDUNITS2_LIBRARY udunits2 REQUIRED)
mark_as_advanced(UDUNITS2_INCLUDE_DIR UDUNITS2_LIBRARY)
add_library(kerf_udunits2 INTERFACE)
target_include_directories(kerf_udunits2 SYSTEM INTERFACE ${UDUNITS2_INCLUDE_DIR})
target_link_libraries(kerf_udunits2 INTERFACE ${UDUNITS2_LIBRARY})

find_package(yaml-cpp REQUIRED)
add_library(kerf_yaml INTERFACE)
target_link_libraries(kerf_yaml INTERFACE yaml-cpp)

find_package(CLI11 REQUIRED)
find_package(fmt REQUIRED)
find_package(nlohmann_json REQUIRED)
# A run writes HDF5 by itself (framework/output/hdf5_image.hpp). With HDF5's library partitions are read and written,
# and tests read. Debian installs one HDF5 per MPI flavour side by side; take the one that is there with Open MPI.
set(HDF5_PREFER_PARALLEL ON)
find_program(HDF5_C_COMPILER_EXECUTABLE NAMES h5pcc.openmpi h5pcc)
find_package(HDF5 REQUIRED COMPONENTS C)
add_library(kerf_hdf5 INTERFACE)
target_include_directories(kerf_hdf5 SYSTEM INTERFACE ${HDF5_C_INCLUDE_DIRS})
target_link_libraries(kerf_hdf5 INTERFACE ${HDF5_C_LIBRARIES} MPI::MPI_CXX)
if(KERF_TESTS)
  find_package(GTest REQUIRED)
  find_package(benchmark REQUIRED)
endif()
