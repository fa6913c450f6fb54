# welkin_compile_together(TARGET SOURCE...): sources of one folder that define no name twice become one translation unit.
# Half of a small source's compile time goes into the headers and templates that its neighbours need too. The library
# and the command are compiled so by preset release and the sanitizers' (WELKIN_LIBRARY_TOGETHER), and not where they
# are packaged: programs link those of the library's objects that they need. Names are looked for at the start of lines,
# when CMake runs: too many only make groups smaller.
# If a source clashes all the same (or was given such a name since), the compiler says so: configure again, or set its
# SKIP_UNITY_BUILD_INCLUSION.
set(WELKIN_TOGETHER 6 CACHE STRING "Sources in one translation unit at most, outside the library (1: after an edit less is compiled)")
function(welkin_compile_together target)
  if(MSVC OR WELKIN_TOGETHER LESS 2)  # Visual C++: never tried
    return()
  endif()
  # No main file has the types that a source keeps to itself.
  target_compile_options(${target} PRIVATE $<$<CXX_COMPILER_ID:GNU>:-Wno-subobject-linkage>)
  set_target_properties(${target} PROPERTIES UNITY_BUILD ON UNITY_BUILD_MODE GROUP)
  foreach(source IN LISTS ARGN)
    get_filename_component(folder ${source} DIRECTORY)
    string(MAKE_C_IDENTIFIER "${folder}" folder)
    file(READ ${source} text)
    string(REGEX REPLACE "[[][[](nodiscard|noreturn)[]][]] " "" text "${text}")
    string(REGEX REPLACE "[[][^]\n]*[]]" "" text "${text}")
    string(REGEX REPLACE "[][]" "" text "${text}")
    string(REPLACE ";" "=" text "${text}")
    string(REGEX MATCHALL "\n(#define [A-Za-z_]+|[A-Za-z][^\n=({]*[=({])" lines "${text}")
    set(names)
    foreach(line IN LISTS lines)
      if(NOT line MATCHES "^\n(namespace|extern|static_assert|TEST_CASE|using namespace|using [a-z0-9_:]+(, [a-z0-9_:]+)*=)" AND
         line MATCHES "(struct|class|enum|union|define) ([A-Za-z0-9_]+)[^<>]*$|([A-Za-z0-9_]+) ?[=({]$")
        list(APPEND names "${CMAKE_MATCH_2}${CMAKE_MATCH_3}")
      endif()
    endforeach()
    list(REMOVE_DUPLICATES names)
    # The first group of the folder that has room and none of the names; or one more.
    foreach(number RANGE 1 99)
      set(group ${target}_${folder}_${number})
      list(LENGTH ${group}_sources count)
      set(others ${names})
      list(REMOVE_ITEM others ${${group}_names} "")
      list(LENGTH others left)
      list(LENGTH names all)
      if(count LESS WELKIN_TOGETHER AND left EQUAL all)
        break()
      endif()
    endforeach()
    list(APPEND ${group}_sources ${source})
    list(APPEND ${group}_names ${names})
    set_source_files_properties(${source} PROPERTIES UNITY_GROUP ${group})
  endforeach()
endfunction()
