# welkin_precompile_headers(TARGET HEADER...): headers that cost more to read than the source that includes them;
# welkin_standard_headers is the set that nearly all sources share, welkin_kernel_headers that of kernels.
#
# A precompiled header is a dump of the compiler's memory and no two are alike, so ccache would find no object of a new
# clone. With CCACHE_PCH_EXTSUM it uses the hash in the .sum file next to the header instead: that of the headers' text,
# the compiler and its flags. Only headers that do not change between two builds may be precompiled: the system's, and
# lists of them.
set(welkin_standard_headers ${CMAKE_CURRENT_LIST_DIR}/standard_headers.h)
set(welkin_kernel_headers ${CMAKE_CURRENT_LIST_DIR}/kernel_headers.h)
function(welkin_precompile_headers target)
  target_precompile_headers(${target} PRIVATE ${ARGN})
  set(content "${CMAKE_CXX_COMPILER_ID} ${CMAKE_CXX_COMPILER_VERSION} ${CMAKE_BUILD_TYPE} ${CMAKE_CXX_FLAGS}")
  foreach(header IN LISTS ARGN)
    cmake_path(ABSOLUTE_PATH header)
    file(SHA256 ${header} hash)
    string(APPEND content " ${hash}")
  endforeach()
  string(SHA256 sum "${content} ${glm_VERSION} ${xsimd_VERSION} ${Catch2_VERSION}")
  set(suffix gch)
  if(CMAKE_CXX_COMPILER_ID MATCHES "Clang")
    set(suffix pch)
    target_compile_options(${target} PRIVATE "SHELL:-Xclang -fno-pch-timestamp")  # a new clone's headers are younger
  endif()
  file(WRITE ${CMAKE_CURRENT_BINARY_DIR}/CMakeFiles/${target}.dir/cmake_pch.hxx.${suffix}.sum ${sum})
  # Read through a precompiled header, libstdc++ is no system header for GCC 12, which then warns of it, wrongly, where
  # strings are joined and lists of strings made (PR105651).
  if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND CMAKE_CXX_COMPILER_VERSION VERSION_LESS 13)
    target_compile_options(${target} PRIVATE -Wno-array-bounds -Wno-stringop-overflow -Wno-stringop-overread)
  endif()
endfunction()
