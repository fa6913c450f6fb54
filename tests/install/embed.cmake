# Configures a project that holds Welkin as a folder (tests/install/subdirectory) and installs it: there must be its own
# file and no other. With WELKIN_INSTALL=ON there are rules for ours.
cmake_minimum_required(VERSION 3.22)
include(${CMAKE_CURRENT_LIST_DIR}/run.cmake)

file(REMOVE_RECURSE ${work})
function(configure)
  run(${CMAKE_COMMAND} -S ${CMAKE_CURRENT_LIST_DIR}/subdirectory -B ${work}/build -G ${generator}
      -DCMAKE_C_COMPILER=${c_compiler} -DCMAKE_CXX_COMPILER=${compiler} -DWELKIN_SOURCE=${source} ${ARGN})
endfunction()

configure()
run(${CMAKE_COMMAND} --install ${work}/build --prefix ${work}/installed)
file(GLOB_RECURSE installed RELATIVE ${work}/installed ${work}/installed/*)
if(NOT installed STREQUAL "share/embedding/CMakeLists.txt")
  message(FATAL_ERROR "installed with a project that holds Welkin: ${installed}")
endif()
file(STRINGS ${work}/build/CMakeCache.txt build_type REGEX "^CMAKE_BUILD_TYPE:")
if(NOT build_type MATCHES "=$")
  message(FATAL_ERROR "Welkin sets the build type of a project that holds it: ${build_type}")
endif()

configure(-DWELKIN_INSTALL=ON)
file(READ ${work}/build/welkin/cmake_install.cmake rules)
if(NOT rules MATCHES "welkin-config.cmake")
  message(FATAL_ERROR "WELKIN_INSTALL=ON brings no rules that install Welkin")
endif()
