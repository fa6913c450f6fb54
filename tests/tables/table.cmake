# cmake -D command=WELKIN -D perf=WELKIN_PERF -D folder=FOLDER -D recorded=FILE -D arguments=LIST -P table.cmake: prints a
# table of errors and compares it with the one on record. WELKIN_RECORD_GOLDEN in the environment records it again.
cmake_minimum_required(VERSION 3.22)
cmake_path(GET recorded STEM name)
set(map ${folder}/${name}/map.exr)
file(MAKE_DIRECTORY ${folder}/${name})
execute_process(COMMAND ${command} testmap --output ${map} --layout lat-long --size 256 --quiet OUTPUT_QUIET
                COMMAND_ERROR_IS_FATAL ANY)
execute_process(COMMAND ${perf} ${arguments} ${map} OUTPUT_VARIABLE table ERROR_QUIET COMMAND_ERROR_IS_FATAL ANY)
# Times differ, and another version of astcenc may choose other blocks.
string(REGEX REPLACE "\n\\| map \\| ASTC[^\n]*" "" table "${table}")
if(table MATCHES "\\| ms \\|")
  string(REGEX REPLACE "[^|\n]*\\|\n" "\n" table "${table}")
endif()
string(REPLACE "-nan" "nan" table "${table}")
message("${table}")
if(DEFINED ENV{WELKIN_RECORD_GOLDEN})
  file(WRITE ${recorded} "${table}")
endif()
file(READ ${recorded} wanted)
if(NOT table STREQUAL wanted)
  message(SEND_ERROR "${recorded} has another table:\n${wanted}")
endif()
