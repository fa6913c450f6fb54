# cmake -DROOT=<the repository> -P additions.cmake: "Where to add things" in docs/notes/architecture.md against the tree.
#
# A row of its table reads
#   | a thing | `marker` ... | number | `file` ... |
# The markers are words that name one such thing that exists already. The files are all those that have one of the
# markers outside comments: an engineer who adds another one looks into these.
cmake_minimum_required(VERSION 3.22)

set(kinds include/*.h include/*.hpp module/*.h module/*.cpp tools/*.h tools/*.cpp tools/help/*.txt
    bindings/python/source/*.h bindings/python/source/*.cpp bindings/python/welkin/*.py bindings/python/welkin/*.pyi
    bindings/wasm/source/*.h bindings/wasm/source/*.cpp bindings/wasm/package/*.js bindings/wasm/package/*.ts)
list(TRANSFORM kinds PREPEND ${ROOT}/)
file(GLOB_RECURSE sources RELATIVE ${ROOT} ${kinds})
list(LENGTH sources count)
if(count LESS 400)
  message(FATAL_ERROR "only ${count} sources were found below ${ROOT}")
endif()

file(STRINGS ${ROOT}/docs/notes/architecture.md rows REGEX "^\\| an? [^|]+\\| `[^|]+\\| [0-9]+ \\|")
list(LENGTH rows count)
if(count LESS 5)
  message(FATAL_ERROR "docs/notes/architecture.md has ${count} rows of things to add; there were five")
endif()

set(things)
foreach(row IN LISTS rows)
  string(REPLACE "|" ";" cells "${row}")
  list(GET cells 1 thing)
  string(STRIP "${thing}" thing)
  list(APPEND things "${thing}")
  list(GET cells 2 markers)
  string(REGEX MATCHALL "[A-Za-z0-9_]+" markers "${markers}")
  list(JOIN markers "|" "markers_of_${thing}")
  list(GET cells 3 "number_of_${thing}")
  list(GET cells 4 files)
  string(REGEX MATCHALL "[A-Za-z0-9_./]+" "files_of_${thing}" "${files}")
  set("found_of_${thing}")
endforeach()

foreach(source IN LISTS sources)
  file(READ ${ROOT}/${source} text)
  string(REGEX REPLACE "//[^\n]*" "" text "${text}")
  foreach(thing IN LISTS things)
    if(text MATCHES "${markers_of_${thing}}")
      list(APPEND "found_of_${thing}" ${source})
    endif()
  endforeach()
endforeach()

foreach(thing IN LISTS things)
  list(SORT "files_of_${thing}")
  list(SORT "found_of_${thing}")
  list(LENGTH "found_of_${thing}" count)
  if(NOT "${files_of_${thing}}" STREQUAL "${found_of_${thing}}" OR NOT count EQUAL "${number_of_${thing}}")
    list(JOIN "found_of_${thing}" "` `" found)
    message(SEND_ERROR "docs/notes/architecture.md, Where to add things: ${thing} is named in ${count} files, which are\n"
                       "`${found}`")
  endif()
  message(STATUS "${thing}: ${count} files")
endforeach()
