# Installs `build` below `work`, moves the installed tree (nothing in it may point to where it was), builds the
# project `consumer` against it, and runs what comes out; the installed command too, if there is one.

function(run)
  execute_process(COMMAND ${ARGN} OUTPUT_VARIABLE output ERROR_VARIABLE output RESULT_VARIABLE result)
  if(NOT result EQUAL 0)
    string(REPLACE ";" " " command "${ARGN}")
    message(FATAL_ERROR "${command}\n${output}")
  endif()
  set(output "${output}" PARENT_SCOPE)
endfunction()

file(REMOVE_RECURSE ${work})
run(${CMAKE_COMMAND} --install ${build} --prefix ${work}/first_place)
file(RENAME ${work}/first_place ${work}/installed)
run(${CMAKE_COMMAND} -S ${consumer} -B ${work}/build -G ${generator} -DCMAKE_PREFIX_PATH=${work}/installed
    -DCMAKE_CXX_COMPILER=${compiler} -DCMAKE_BUILD_TYPE=${build_type} -DCMAKE_CXX_FLAGS=${flags})
run(${CMAKE_COMMAND} --build ${work}/build)
run(${work}/build/consumer)
message("${output}")
if(NOT output MATCHES "irradiance on the ground")
  message(FATAL_ERROR "the consumer printed something else")
endif()
if(with_command)
  run(${work}/installed/bin/welkin sh --json)
endif()
