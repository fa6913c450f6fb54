# What an installed Welkin is: headers, libraries, CMake and pkg-config files, the licence.
include(CMakePackageConfigHelpers)

set(package_folder ${CMAKE_INSTALL_LIBDIR}/cmake/welkin)
install(DIRECTORY include/welkin DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
install(TARGETS welkin_core welkin_files welkin EXPORT welkin-targets)
install(EXPORT welkin-targets NAMESPACE welkin:: DESTINATION ${package_folder})
configure_package_config_file(cmake/welkin-config.cmake.in welkin-config.cmake INSTALL_DESTINATION ${package_folder})
write_basic_package_version_file(welkin-config-version.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/welkin-config.cmake ${CMAKE_CURRENT_BINARY_DIR}/welkin-config-version.cmake
              cmake/FindSPNG.cmake cmake/FindWebP.cmake cmake/FindZSTD.cmake
        DESTINATION ${package_folder})

# pkg-config: welkin-core.pc, and welkin.pc for both parts. Who links a static library, perhaps from C, links all that it
# needs.
file(RELATIVE_PATH welkin_prefix_from_pkgconfig /${CMAKE_INSTALL_LIBDIR}/pkgconfig /)
if(BUILD_SHARED_LIBS)
  set(welkin_link "-lwelkin")
else()
  set(welkin_core_link " -lstdc++ -lm -pthread")
  set(welkin_core_modules "Requires: tbb")
  list(JOIN welkin_codec_modules " " modules)
  set(welkin_modules "Requires: welkin-core ${modules}")
  set(welkin_link "-lwelkin-files")
endif()
foreach(name IN ITEMS welkin welkin-core)
  configure_file(cmake/${name}.pc.in ${CMAKE_CURRENT_BINARY_DIR}/${name}.pc @ONLY)
  install(FILES ${CMAKE_CURRENT_BINARY_DIR}/${name}.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig)
endforeach()

install(FILES LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR})
