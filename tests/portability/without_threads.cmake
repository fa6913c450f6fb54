# Configures Welkin with WELKIN_THREADS=OFF where oneTBB is not to be found, builds core and the program of hashes, and
# compares what that prints with the record. The program must need no oneTBB.
cmake_minimum_required(VERSION 3.22)
include(${CMAKE_CURRENT_LIST_DIR}/../install/run.cmake)

run(${CMAKE_COMMAND} -S ${CMAKE_CURRENT_LIST_DIR}/without_threads -B ${work} -G ${generator} -DCMAKE_BUILD_TYPE=Debug -DCMAKE_CXX_FLAGS_DEBUG=-O1
    -DCMAKE_C_COMPILER=${c_compiler} -DCMAKE_CXX_COMPILER=${compiler} -DCMAKE_CXX_FLAGS=${flags}
    -DCMAKE_C_COMPILER_LAUNCHER=${c_launcher} -DCMAKE_CXX_COMPILER_LAUNCHER=${launcher} -DWELKIN_SOURCE=${source}
    -DCMAKE_DISABLE_FIND_PACKAGE_TBB=ON -DWELKIN_THREADS=OFF -DWELKIN_FILES=OFF -DWELKIN_INSTALL=ON)
run(${CMAKE_COMMAND} --build ${work} --target core_hashes)
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
  if(installed MATCHES "include/welkin/${absent}")
    message(FATAL_ERROR "a build without threads installs ${absent}")
  endif()
endforeach()
if(NOT installed MATCHES "include/welkin/projection.h")
  message(FATAL_ERROR "nothing was installed: ${installed}")
endif()
