# What an installed Welkin is: headers, libraries, CMake and pkg-config files, the licence.
include(CMakePackageConfigHelpers)

# What the C++ compiler links that the C compiler does not: a static library in a program of C needs it.
set(welkin_runtime_libraries ${CMAKE_CXX_IMPLICIT_LINK_LIBRARIES})
list(REMOVE_ITEM welkin_runtime_libraries ${CMAKE_C_IMPLICIT_LINK_LIBRARIES})
list(REMOVE_DUPLICATES welkin_runtime_libraries)

set(package_folder ${CMAKE_INSTALL_LIBDIR}/cmake/welkin)
set(left_out)
if(NOT WELKIN_FILES)
  # Headers of the rooms files and cache, and the one that includes them all.
  foreach(header IN ITEMS babylon_environment.h bake_file.h content_hash.h environment_file.h environment_writer.h
                          file_requests.h result_cache.h sky_table_file.h stored_environment.h texture_file.h welkin.hpp)
    list(APPEND left_out PATTERN ${header} EXCLUDE)
  endforeach()
endif()
install(DIRECTORY include/welkin DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} ${left_out})
install(TARGETS ${welkin_libraries} EXPORT welkin-targets)
install(EXPORT welkin-targets NAMESPACE welkin:: DESTINATION ${package_folder})
configure_package_config_file(cmake/welkin-config.cmake.in welkin-config.cmake INSTALL_DESTINATION ${package_folder})
write_basic_package_version_file(welkin-config-version.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/welkin-config.cmake ${CMAKE_CURRENT_BINARY_DIR}/welkin-config-version.cmake
        DESTINATION ${package_folder})
if(NOT BUILD_SHARED_LIBS)
  foreach(package IN LISTS welkin_codec_packages)
    if(EXISTS ${CMAKE_CURRENT_SOURCE_DIR}/cmake/Find${package}.cmake)
      install(FILES cmake/Find${package}.cmake DESTINATION ${package_folder})
    endif()
  endforeach()
endif()

# pkg-config: welkin-core.pc, and welkin.pc for both parts. Who links a static library, perhaps from C, links all that it
# needs; who links a shared one needs nothing more.
file(RELATIVE_PATH welkin_prefix_from_pkgconfig /${CMAKE_INSTALL_LIBDIR}/pkgconfig /)
set(pkgconfig_files welkin-core)
if(WELKIN_FILES)
  list(APPEND pkgconfig_files welkin)
endif()
if(BUILD_SHARED_LIBS)
  set(welkin_link "-lwelkin")
else()
  list(TRANSFORM welkin_runtime_libraries PREPEND "-l" OUTPUT_VARIABLE runtime)
  list(JOIN runtime " " runtime)
  set(welkin_core_link " ${runtime} -pthread")
  set(welkin_core_modules "Requires: tbb")
  list(JOIN welkin_codec_modules " " modules)
  set(welkin_modules "Requires: welkin-core ${modules}")
  set(welkin_link "-lwelkin-files")
endif()
foreach(name IN LISTS pkgconfig_files)
  configure_file(cmake/${name}.pc.in ${CMAKE_CURRENT_BINARY_DIR}/${name}.pc @ONLY)
  install(FILES ${CMAKE_CURRENT_BINARY_DIR}/${name}.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig)
endforeach()

install(FILES LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR})
