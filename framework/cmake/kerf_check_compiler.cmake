# Runs small programs with the flags that Kerf is compiled with, and refuses a compiler that gets them wrong.

function(kerf_check_compiler program what)
  # The answer holds for one compiler and its flags: a change of either asks again.
  string(SHA256 key "${CMAKE_CXX_COMPILER} ${CMAKE_CXX_COMPILER_VERSION} ${KERF_MACHINE_OPTIONS}")
  if(KERF_CHECKED_${program} STREQUAL key)
    return()
  endif()
  try_run(run_result compiled "${CMAKE_BINARY_DIR}/compiler_checks" "${CMAKE_CURRENT_FUNCTION_LIST_DIR}/${program}.cpp"
          COMPILE_DEFINITIONS -O2 ${KERF_MACHINE_OPTIONS} COMPILE_OUTPUT_VARIABLE messages
          RUN_OUTPUT_VARIABLE said)
  if(NOT compiled)
    message(FATAL_ERROR "Kerf: ${program}.cpp does not compile with ${KERF_MACHINE_OPTIONS}:\n${messages}")
  elseif(run_result STREQUAL "FAILED_TO_RUN")
    message(WARNING "Kerf: this machine cannot run programs made with ${KERF_MACHINE_OPTIONS}, so whether the compiler "
                    "${what} was not checked")
  elseif(NOT run_result EQUAL 0)
    message(FATAL_ERROR "Kerf: ${CMAKE_CXX_COMPILER_ID} ${CMAKE_CXX_COMPILER_VERSION} with ${KERF_MACHINE_OPTIONS} "
                        "does not do what the language says: ${said}expected: that it ${what}. Results could be wrong "
                        "without a word. Use another compiler, or -DKERF_ARCH=x86-64-v3, which leaves out AVX-512.")
  endif()
  set(KERF_CHECKED_${program} "${key}" CACHE INTERNAL "compiler and flags that passed ${program}.cpp")
endfunction()

kerf_check_compiler(stored_constants "stores constants as they are written")
