# welkin_precompile_headers(TARGET HEADER...): headers that cost more to read than the source that includes them.
#
# A precompiled header is a picture of the compiler's memory and no two are alike, so ccache would know none of a new
# clone's objects. With CCACHE_PCH_EXTSUM it takes the hash that is left beside the header instead: of the headers
# themselves, the compiler and its flags.
function(welkin_precompile_headers target)
  target_precompile_headers(${target} PRIVATE ${ARGN})
  set(content "${CMAKE_CXX_COMPILER_ID} ${CMAKE_CXX_COMPILER_VERSION} ${CMAKE_BUILD_TYPE} ${CMAKE_CXX_FLAGS}")
  foreach(header IN LISTS ARGN)
    string(REGEX REPLACE "^<(.*)>$" "\\1" name ${header})
    find_file(precompiled_header ${name} HINTS ${CMAKE_CURRENT_SOURCE_DIR} NO_CACHE REQUIRED)
    file(SHA256 ${precompiled_header} hash)
    string(APPEND content " ${hash}")
    unset(precompiled_header)
  endforeach()
  string(SHA256 sum "${content} ${CLI11_VERSION} ${nlohmann_json_VERSION} ${Catch2_VERSION}")
  file(WRITE ${CMAKE_CURRENT_BINARY_DIR}/CMakeFiles/${target}.dir/cmake_pch.hxx.gch.sum ${sum})
endfunction()
