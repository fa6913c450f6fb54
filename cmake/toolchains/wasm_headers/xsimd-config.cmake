# The headers that ../wasm.cmake has linked to.
if(NOT TARGET xsimd)
  add_library(xsimd INTERFACE IMPORTED)
  target_include_directories(xsimd SYSTEM INTERFACE ${CMAKE_BINARY_DIR}/headers)
endif()
