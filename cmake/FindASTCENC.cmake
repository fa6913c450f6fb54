# astcenc. Defines the target ASTCENC::ASTCENC, whether or not the library came with a CMake configuration of its own.
# Installed with welkin-config.cmake: a program that links a static Welkin needs it too.
find_path(ASTCENC_INCLUDE_DIR astcenc.h)
find_library(ASTCENC_LIBRARY astcenc)
mark_as_advanced(ASTCENC_INCLUDE_DIR ASTCENC_LIBRARY)

include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(ASTCENC REQUIRED_VARS ASTCENC_LIBRARY ASTCENC_INCLUDE_DIR)

if(ASTCENC_FOUND AND NOT TARGET ASTCENC::ASTCENC)
  add_library(ASTCENC::ASTCENC UNKNOWN IMPORTED)
  set_target_properties(ASTCENC::ASTCENC PROPERTIES IMPORTED_LOCATION "${ASTCENC_LIBRARY}"
                                                    INTERFACE_INCLUDE_DIRECTORIES "${ASTCENC_INCLUDE_DIR}")
  # The names in a shared library are C's, those in a static one C++'s.
  if(NOT ASTCENC_LIBRARY MATCHES "\\.(a|lib)$")
    set_property(TARGET ASTCENC::ASTCENC PROPERTY INTERFACE_COMPILE_DEFINITIONS ASTCENC_DYNAMIC_LIBRARY)
  endif()
endif()
