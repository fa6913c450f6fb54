# The headers that ../wasm.cmake has linked to.
if(NOT TARGET glm::glm)
  add_library(glm::glm INTERFACE IMPORTED)
  target_include_directories(glm::glm SYSTEM INTERFACE ${CMAKE_BINARY_DIR}/headers)
endif()
