# kerf_add_plugin(FILE.cpp [LINK target...])
#
# In Kerf's own tree: compiles the file against the API headers alone and enters it in the table of built-in plugins.
# From an installed or built Kerf (find_package(Kerf)): makes a shared library that `kerf run --plugin` loads.
#   LINK    further targets the file needs, for example a partitioning library
# Where there is a folder of the same name beside the file, every FILE/*.cpp is compiled as well and becomes part of the
# plugin: for code that is better compiled in several pieces.

# The compile flags that change numbers or the layout of types: the manifest of a plugin tells them, and Kerf refuses a
# plugin of others. Instruction sets and the C++ library are told by what the compiler defines.
set(KERF_FLAGS_THAT_MATTER "^(-Ofast|-ffast-math|-ffp-contract=.*|-ffp-model=.*|-fexcess-precision=.*|-mfpmath=.*|\
-f(no-)?(unsafe-math-optimizations|associative-math|reciprocal-math|finite-math-only|signed-zeros|math-errno|\
trapping-math|rounding-math|signaling-nans|float-store|short-enums|short-wchar|exceptions|rtti)|-fpack-struct.*|\
-fabi-version=.*|-malign-double|-mlong-double-.*|-mtune-ctrl=.*)$")

# Sets `out` to the definition that tells the flags which CMake gives by itself, followed by those of a list, which may
# be a generator expression.
function(kerf_flags_definition out flags)
  separate_arguments(given NATIVE_COMMAND "${CMAKE_CXX_FLAGS}")
  foreach(config IN LISTS CMAKE_BUILD_TYPE CMAKE_CONFIGURATION_TYPES)
    string(TOUPPER "${config}" upper)
    separate_arguments(of_config NATIVE_COMMAND "${CMAKE_CXX_FLAGS_${upper}}")
    foreach(flag IN LISTS of_config)
      list(APPEND given "$<$<CONFIG:${config}>:${flag}>")
    endforeach()
  endforeach()
  list(APPEND given ${flags})
  set(${out} "KERF_COMPILE_FLAGS=\"$<JOIN:$<FILTER:${given},INCLUDE,${KERF_FLAGS_THAT_MATTER}>, >\"" PARENT_SCOPE)
endfunction()

define_property(GLOBAL PROPERTY KERF_PLUGIN_ENTRIES BRIEF_DOCS "registration functions of the built-in plugins")
define_property(GLOBAL PROPERTY KERF_PLUGIN_TARGETS BRIEF_DOCS "object libraries of the built-in plugins")
define_property(GLOBAL PROPERTY KERF_PLUGIN_LINKS BRIEF_DOCS "what the built-in plugins link with")

function(kerf_add_plugin file)
  cmake_parse_arguments(PARSE_ARGV 1 arg "" "" "LINK")
  if(arg_UNPARSED_ARGUMENTS)
    message(FATAL_ERROR "kerf_add_plugin(${file}): unknown arguments: ${arg_UNPARSED_ARGUMENTS}")
  endif()
  cmake_path(ABSOLUTE_PATH file NORMALIZE OUTPUT_VARIABLE path)
  if(NOT EXISTS "${path}")
    message(FATAL_ERROR "kerf_add_plugin: there is no file ${path}")
  endif()
  cmake_path(GET path STEM stem)
  cmake_path(GET path PARENT_PATH folder)
  file(GLOB pieces CONFIGURE_DEPENDS "${folder}/${stem}/*.cpp")
  list(SORT pieces)
  if(pieces)
    list(LENGTH pieces n_pieces)
    message(STATUS "Kerf: plugin ${stem} has ${n_pieces} more source files in ${folder}/${stem}/")
  endif()
  if(TARGET kerf_options)
    kerf_add_builtin_plugin("${path}" "${stem}" "${pieces}" "${arg_LINK}")
  else()
    kerf_add_shared_plugin("${path}" "${stem}" "${pieces}" "${arg_LINK}")
  endif()
endfunction()

# The folder is part of the name: a material and an erosion criterion may well share a file name.
function(kerf_add_builtin_plugin path stem pieces link)
  cmake_path(GET path PARENT_PATH folder)
  cmake_path(GET folder FILENAME folder)
  string(MAKE_C_IDENTIFIER "${folder}_${stem}" id)
  set(target kerf_plugin_${id})
  add_library(${target} OBJECT "${path}" ${pieces})
  target_link_libraries(${target} PRIVATE kerf_options kerf_api ${link})
  target_compile_definitions(${target} PRIVATE KERF_PLUGIN_ENTRY=kerf_register_${id})
  set_property(GLOBAL APPEND PROPERTY KERF_PLUGIN_ENTRIES kerf_register_${id})
  set_property(GLOBAL APPEND PROPERTY KERF_PLUGIN_TARGETS ${target})
  set_property(GLOBAL APPEND PROPERTY KERF_PLUGIN_LINKS ${link})
endfunction()

function(kerf_add_shared_plugin path stem pieces link)
  if(NOT TARGET ${stem})
    add_library(${stem} MODULE "${path}" ${pieces})
  else()
    message(FATAL_ERROR "kerf_add_plugin: a target named ${stem} exists already; rename ${path}")
  endif()
  set_target_properties(${stem} PROPERTIES PREFIX "" CXX_VISIBILITY_PRESET hidden CXX_STANDARD 20
                                           CXX_STANDARD_REQUIRED ON CXX_EXTENSIONS OFF)
  target_compile_definitions(${stem} PRIVATE KERF_PLUGIN_SHARED)
  target_compile_options(${stem} PRIVATE ${KERF_PLUGIN_COMPILE_OPTIONS})
  kerf_flags_definition(flags "$<TARGET_PROPERTY:${stem},COMPILE_OPTIONS>")
  target_compile_definitions(${stem} PRIVATE "${flags}")
  target_link_libraries(${stem} PRIVATE Kerf::api ${link})
  kerf_write_vectorisation("${path}" "${stem}")
endfunction()

# GCC tells which loops it has vectorised, function by function; what it says comes to lie in STEM.vec.txt beside the
# library, where `kerf test-plugin` reads it.
function(kerf_write_vectorisation path stem)
  if(NOT CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
    return()
  endif()
  set(dump "${CMAKE_CURRENT_BINARY_DIR}/${stem}.vect.dump")
  set_property(SOURCE "${path}" APPEND PROPERTY COMPILE_OPTIONS "-fdump-tree-vect-optimized-missed=${dump}")
  add_custom_command(TARGET ${stem} POST_BUILD VERBATIM
    COMMAND sh -c "test ! -f \"$1\" || grep -E '^;; Function|: (optimized|missed):' \"$1\" >\"$2\" || true"
            sh "${dump}" "$<TARGET_FILE_DIR:${stem}>/${stem}.vec.txt")
endfunction()

# Adds every file that matches, in a stable order.
function(kerf_add_plugins)
  cmake_parse_arguments(PARSE_ARGV 0 arg "" "" "FILES;LINK")
  set(files)
  if(arg_FILES)
    file(GLOB files CONFIGURE_DEPENDS ${arg_FILES})
    list(SORT files)
  endif()
  foreach(file IN LISTS files)
    kerf_add_plugin("${file}" LINK ${arg_LINK})
  endforeach()
endfunction()

# Writes the table that calls every built-in plugin by name, and collects all of them in one library, kerf_plugins.
function(kerf_make_plugin_table)
  get_property(entries GLOBAL PROPERTY KERF_PLUGIN_ENTRIES)
  get_property(targets GLOBAL PROPERTY KERF_PLUGIN_TARGETS)
  get_property(links GLOBAL PROPERTY KERF_PLUGIN_LINKS)
  list(REMOVE_DUPLICATES links)
  set(KERF_DECLARATIONS "")
  set(KERF_CALLS "")
  foreach(entry IN LISTS entries)
    string(APPEND KERF_DECLARATIONS "void ${entry}(kerf::Registrar& registrar);\n")
    string(APPEND KERF_CALLS "  ${entry}(registrar);\n")
  endforeach()
  configure_file("${PROJECT_SOURCE_DIR}/framework/cmake/kerf_plugin_table.cpp.in"
                 "${PROJECT_BINARY_DIR}/kerf_plugin_table.cpp" @ONLY)
  add_library(kerf_plugins STATIC "${PROJECT_BINARY_DIR}/kerf_plugin_table.cpp")
  foreach(target IN LISTS targets)
    target_sources(kerf_plugins PRIVATE $<TARGET_OBJECTS:${target}>)
  endforeach()
  target_link_libraries(kerf_plugins PRIVATE kerf_options PUBLIC kerf_api ${links} kerf_engine)
endfunction()
