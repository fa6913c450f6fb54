# cmake -D libraries=FILE... -D readelf=READELF -D calls=FILE -D without=FILE -P every_function.cmake
#
# Every function that the libraries show is called by the test, whose lines begin with names (see calls.h), or stands in
# the list of those that compute with no floating-point numbers. A name must tell one function from all others, and
# nothing in either list may be stale.
cmake_minimum_required(VERSION 3.22)

# ---- what the libraries show
set(shown)
foreach(library IN LISTS libraries)
  execute_process(COMMAND ${readelf} --symbols --wide --demangle ${library} OUTPUT_VARIABLE symbols
                  COMMAND_ERROR_IS_FATAL ANY ERROR_QUIET)
  string(REGEX REPLACE "[][;]" "_" symbols "${symbols}")
  string(REGEX MATCHALL "FUNC +GLOBAL +DEFAULT +[0-9]+ [^\n]+" symbols "${symbols}")
  list(APPEND shown ${symbols})
endforeach()
list(TRANSFORM shown REPLACE "^FUNC +GLOBAL +DEFAULT +[0-9]+ (.*)$" "\\1")
list(FILTER shown INCLUDE REGEX "^welkin(::|_)")
list(TRANSFORM shown REPLACE " *_abi:cxx11_" "")
list(TRANSFORM shown REPLACE "@.*$" "")
# As declarations write the types.
string(REPLACE "welkin::" "" shown "${shown}")
string(REPLACE "glm::vec<3, double, (glm::qualifier)0>" "dvec3" shown "${shown}")
string(REPLACE "glm::vec<3, float, (glm::qualifier)0>" "vec3" shown "${shown}")
string(REPLACE "std::filesystem::__cxx11::path" "path" shown "${shown}")
string(REPLACE "std::" "" shown "${shown}")
list(REMOVE_DUPLICATES shown)
list(SORT shown)
list(LENGTH shown count)
if(count LESS 100)
  message(FATAL_ERROR "only ${count} public functions were found in ${libraries}")
endif()

# ---- what the test calls
file(STRINGS ${calls} called)
list(TRANSFORM called REPLACE "\t.*$" "")
list(REMOVE_DUPLICATES called)
set(left ${shown})
foreach(name IN LISTS called)
  string(LENGTH "${name}" length)
  set(found)
  foreach(function IN LISTS shown)
    string(SUBSTRING "${function}" 0 ${length} begin)
    if(begin STREQUAL name AND (NOT name MATCHES "^welkin_" OR function STREQUAL name))
      list(APPEND found "${function}")
    endif()
  endforeach()
  list(LENGTH found matches)
  if(NOT matches EQUAL 1)
    message(SEND_ERROR "the test's call \"${name}\" names ${matches} public functions: ${found}")
  else()
    list(REMOVE_ITEM left ${found})
  endif()
endforeach()

# ---- what computes with no floating-point numbers
file(STRINGS ${without} patterns REGEX "^[^#]")
foreach(pattern IN LISTS patterns)
  set(matching ${left})
  list(FILTER matching INCLUDE REGEX "^${pattern}$")
  if(NOT matching)
    message(SEND_ERROR "no public function that the test does not call is like \"${pattern}\" of ${without}")
  endif()
  list(APPEND excused ${matching})
endforeach()
list(REMOVE_ITEM left ${excused})
foreach(function IN LISTS left)
  message(SEND_ERROR "no test calls ${function} in another floating-point environment than the default one: call it in "
                     "tests/float_environment, or say in ${without} why not")
endforeach()
list(LENGTH called called_count)
message(STATUS "${called_count} of ${count} public functions are called")
