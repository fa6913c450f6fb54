# Configures Welkin with WELKIN_THREADS=OFF where oneTBB is not to be found, and reads what would be built and installed: no
# file of oneTBB's backend, no header of the worker.
cmake_minimum_required(VERSION 3.22)
include(${CMAKE_CURRENT_LIST_DIR}/../install/run.cmake)

run(${CMAKE_COMMAND} -S ${source} -B ${work} -G ${generator} -DCMAKE_C_COMPILER=${c_compiler} -DCMAKE_CXX_COMPILER=${compiler}
    -DCMAKE_EXPORT_COMPILE_COMMANDS=ON -DCMAKE_DISABLE_FIND_PACKAGE_TBB=ON -DWELKIN_THREADS=OFF -DWELKIN_FILES=OFF
    -DWELKIN_TESTS=OFF -DWELKIN_PERF=OFF -DWELKIN_TOOLS=OFF -DWELKIN_EXAMPLES=OFF)
file(READ ${work}/compile_commands.json sources)
if(NOT sources MATCHES "module/jobs/serial.cpp" OR sources MATCHES "one_tbb.cpp|module/worker/|module/c/")
  message(FATAL_ERROR "a build without threads compiles others' sources, or nothing was looked at")
endif()
file(READ ${work}/cmake_install.cmake installed)
foreach(absent IN ITEMS worker.h requests.h welkin.h welkin.hpp)
  string(REPLACE "." "\\\\." pattern ${absent})
  string(FIND "${installed}" "/${pattern}$\" EXCLUDE" found)
  if(found EQUAL -1)
    message(FATAL_ERROR "a build without threads installs ${absent}")
  endif()
endforeach()
