# Fails where the page lacks a parameter or a state variable of the type: each has to stand in it as `name`.
#   cmake -D KERF=... -D LIBRARY=... -D KIND=... -D NAME=... -D PAGE=... -P check_page.cmake
cmake_minimum_required(VERSION 3.25)

execute_process(COMMAND "${KERF}" describe "${KIND}" "${NAME}" --plugin "${LIBRARY}" OUTPUT_VARIABLE described
                RESULT_VARIABLE status)
if(NOT status EQUAL 0)
  message(FATAL_ERROR "kerf describe ${KIND} ${NAME} failed with exit code ${status}")
endif()
file(READ "${PAGE}" page)

# Names stand in lines of their own, "  name: ...", deeper where a block is nested; rules are sentences.
string(REGEX MATCHALL "\n +[A-Za-z_][A-Za-z_0-9]*: " lines "\n${described}")
set(absent "")
foreach(line IN LISTS lines)
  string(REGEX REPLACE "[\n :]" "" name "${line}")
  string(FIND "${page}" "`${name}`" place)
  if(place EQUAL -1)
    list(APPEND absent "${name}")
  endif()
endforeach()
list(LENGTH lines n_names)
if(absent)
  list(JOIN absent ", " absent)
  message(FATAL_ERROR "${PAGE}: error: not explained: ${absent}; expected each name in backquotes, with its meaning")
endif()
message(STATUS "${PAGE}: all ${n_names} names of ${KIND} ${NAME} are explained")
