# cmake -D program=PROGRAM -D mode=MODE -D folder=FOLDER -P compare.cmake: runs the program in a caller's floating-point
# environment; every line must be as in the default one, which the test of that mode left in the folder.
cmake_minimum_required(VERSION 3.22)
execute_process(COMMAND ${program} ${mode} ${folder}/${mode}.txt COMMAND_ERROR_IS_FATAL ANY)
file(STRINGS ${folder}/default.txt wanted)
file(STRINGS ${folder}/${mode}.txt given)
list(LENGTH wanted count)
list(LENGTH given given_count)
if(count LESS 100 OR NOT count EQUAL given_count)
  message(FATAL_ERROR "${given_count} results in mode ${mode}, ${count} in the default mode")
endif()
foreach(want give IN ZIP_LISTS wanted given)
  # At the first call and at the second: both stand in the line.
  if(NOT want STREQUAL give)
    message(SEND_ERROR "other bits where the caller's mode is ${mode}:\n  ${give}\n  ${want} (default)")
  endif()
endforeach()
message(STATUS "${count} results are the same")
