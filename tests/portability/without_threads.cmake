# Configures Welkin with WELKIN_THREADS=OFF where oneTBB is not to be found, builds core and the program of hashes, and
# compares what that prints with the record. The program must need no oneTBB. `work` lies as deep as the build that this
# is a test of, and has its flags, so that ccache knows most of the objects.
cmake_minimum_required(VERSION 3.22)
include(${CMAKE_CURRENT_LIST_DIR}/../install/run.cmake)

run(${CMAKE_COMMAND} -S ${source} -B ${work} -G ${generator} -DCMAKE_BUILD_TYPE=${type}
    -DCMAKE_C_COMPILER=${c_compiler} -DCMAKE_CXX_COMPILER=${compiler} -DCMAKE_CXX_FLAGS=${flags}
    -DCMAKE_C_COMPILER_LAUNCHER=${c_launcher} -DCMAKE_CXX_COMPILER_LAUNCHER=${launcher}
    -DCMAKE_PROJECT_welkin_INCLUDE=${CMAKE_CURRENT_LIST_DIR}/core_hashes_program.cmake
    -DCMAKE_DISABLE_FIND_PACKAGE_TBB=ON -DWELKIN_THREADS=OFF -DWELKIN_FILES=OFF -DWELKIN_TESTS=OFF -DWELKIN_PERF=OFF
    -DWELKIN_TOOLS=OFF -DWELKIN_EXAMPLES=OFF)
run(${CMAKE_COMMAND} --build ${work})
run(${readelf} -d ${work}/bin/core_hashes)
if(NOT output MATCHES "NEEDED" OR output MATCHES "libtbb")
  message(FATAL_ERROR "a program without threads needs oneTBB, or nothing was looked at: ${output}")
endif()
run(${CMAKE_COMMAND} -D program=${work}/bin/core_hashes -D record=${CMAKE_CURRENT_LIST_DIR}/core_hashes.txt
    -P ${CMAKE_CURRENT_LIST_DIR}/compare.cmake)
message("${output}")

# What is installed says the same: no header of the worker, and no look for oneTBB.
run(${CMAKE_COMMAND} --install ${work} --prefix ${work}/installed)
file(GLOB_RECURSE installed RELATIVE ${work}/installed ${work}/installed/*)
foreach(absent IN ITEMS worker.h job.h requests.h welkin.h welkin.hpp)
  if("include/welkin/${absent}" IN_LIST installed)
    message(FATAL_ERROR "a build without threads installs ${absent}")
  endif()
endforeach()
if(NOT "include/welkin/projection.h" IN_LIST installed OR NOT "include/welkin/detail/stop_token.h" IN_LIST installed)
  message(FATAL_ERROR "headers are missing: ${installed}")
endif()
