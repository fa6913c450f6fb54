# Installs `build` below `work`, moves the installed tree (nothing in it may point to where it was), and builds and runs
# programs against it: with CMake examples/consumer and, with welkin::core alone, tests/install/core_only; as projects of
# C alone examples/sky_in_c with core and tests/install/c_alone with files; the installed examples; with pkg-config, where
# it is, a program in C++ and one in C. The installed command too, if there is one, with its completions and its manual
# page.
cmake_minimum_required(VERSION 3.22)
include(${CMAKE_CURRENT_LIST_DIR}/run.cmake)

file(REMOVE_RECURSE ${work})
run(${CMAKE_COMMAND} --install ${build} --prefix ${work}/first_place)
file(RENAME ${work}/first_place ${work}/installed)
file(GLOB_RECURSE licence ${work}/installed/*/LICENSE)
if(NOT licence)
  message(FATAL_ERROR "the licence is not installed")
endif()

function(build_project project folder)
  run(${CMAKE_COMMAND} -S ${project} -B ${folder} -G ${generator} -DCMAKE_PREFIX_PATH=${work}/installed
      -DCMAKE_C_COMPILER=${c_compiler} -DCMAKE_CXX_COMPILER=${compiler} -DCMAKE_BUILD_TYPE=${build_type}
      -DCMAKE_C_FLAGS=${flags} -DCMAKE_CXX_FLAGS=${flags} --no-warn-unused-cli ${ARGN})
  run(${CMAKE_COMMAND} --build ${folder})
endfunction()

function(run_consumer)
  run(${ARGN})
  message("${output}")
  if(NOT output MATCHES "irradiance on the ground")
    message(FATAL_ERROR "the consumer printed something else")
  endif()
endfunction()

build_project(${source}/examples/consumer ${work}/consumer)
run_consumer(${work}/consumer/consumer)

# Core alone: what files need is as if it were not installed.
set(absent)
foreach(package IN ITEMS OpenEXR Imath SPNG ZLIB ZSTD WebP nlohmann_json XXHASH)
  list(APPEND absent -DCMAKE_DISABLE_FIND_PACKAGE_${package}=ON)
endforeach()
build_project(${CMAKE_CURRENT_LIST_DIR}/core_only ${work}/core_only ${absent} -DCOMPONENT=core
              -DPROGRAM=${source}/tests/parts/core_program.cpp)
run(${work}/core_only/core_only)

# No components are named, and a codec's library is missing. A program that links only core builds; one that needs files
# gets an error that names what is missing.
if(NOT shared)
  set(without_webp -DCMAKE_DISABLE_FIND_PACKAGE_WebP=ON)
  build_project(${CMAKE_CURRENT_LIST_DIR}/core_only ${work}/no_components ${without_webp} -DCOMPONENT=
                -DPROGRAM=${source}/tests/parts/core_program.cpp)
  run(${work}/no_components/core_only)
  expect_failure("WebP, which CMake does not find" ${CMAKE_COMMAND} -S ${CMAKE_CURRENT_LIST_DIR}/core_only -B ${work}/files -G ${generator}
                 -DCMAKE_PREFIX_PATH=${work}/installed -DCMAKE_CXX_COMPILER=${compiler} ${without_webp}
                 -DCOMPONENT=files -DPROGRAM=${source}/tests/parts/core_program.cpp)
endif()

# Projects of C alone: they link a static library, which needs the run-time library of C++, with the linker of C.
set(program_in_c ${CMAKE_CURRENT_LIST_DIR}/program_in_c.c)
build_project(${source}/examples/sky_in_c ${work}/sky_in_c ${absent})
run(${work}/sky_in_c/sky_in_c --quick)
file(GLOB examples ${work}/installed/share/doc/*/examples)
build_project(${examples} ${work}/examples ${absent})
run(${work}/examples/frame_probes/frame_probes 24)
build_project(${CMAKE_CURRENT_LIST_DIR}/c_alone ${work}/c_alone -DPROGRAM=${program_in_c})
run(${work}/c_alone/c_alone)
file(STRINGS ${work}/c_alone/CMakeCache.txt cxx_compiler REGEX "^CMAKE_CXX_COMPILER_AR:")
if(cxx_compiler)
  message(FATAL_ERROR "tests/install/c_alone is no project of C alone any more: ${cxx_compiler}")
endif()

if(shared)
  file(GLOB_RECURSE library ${work}/installed/*/libwelkin.so.${version} ${work}/installed/*/libwelkin-core.so.${version})
  list(LENGTH library count)
  if(NOT count EQUAL 2)
    message(FATAL_ERROR "shared libraries of version ${version} are not installed: ${library}")
  endif()
endif()

if(pkg_config)
  file(GLOB_RECURSE description ${work}/installed/*/welkin.pc)
  cmake_path(GET description PARENT_PATH folder)
  cmake_path(GET folder PARENT_PATH libraries)
  set(ENV{PKG_CONFIG_PATH} "${folder}:$ENV{PKG_CONFIG_PATH}")
  set(ENV{LD_LIBRARY_PATH} "${libraries}:$ENV{LD_LIBRARY_PATH}")
  separate_arguments(flags NATIVE_COMMAND "${flags}")
  # build_with_pkg_config(PROGRAM MODULE COMPILER SOURCE FLAG...)
  function(build_with_pkg_config program module program_compiler program_source)
    run(${pkg_config} --cflags --libs ${pkg_config_flags} ${module})
    separate_arguments(given NATIVE_COMMAND "${output}")
    run(${program_compiler} ${flags} ${ARGN} ${program_source} -o ${work}/${program} ${given})
  endfunction()
  build_with_pkg_config(consumer_by_pkg_config welkin ${compiler} ${source}/examples/consumer/main.cpp -std=c++20)
  run_consumer(${work}/consumer_by_pkg_config)
  build_with_pkg_config(c_by_pkg_config welkin ${c_compiler} ${program_in_c} -std=c99 -DWITH_FILES)
  run(${work}/c_by_pkg_config)
  build_with_pkg_config(c_of_core_by_pkg_config welkin-core ${c_compiler} ${program_in_c} -std=c99)
  run(${work}/c_of_core_by_pkg_config)
  if(NOT shared)  # as people who link statically ask
    set(pkg_config_flags --static)
    build_with_pkg_config(c_by_static_pkg_config welkin ${c_compiler} ${program_in_c} -std=c11 -DWITH_FILES)
    run(${work}/c_by_static_pkg_config)
  endif()
endif()

# After `scripts/welkin` has built the command and its libraries, they can be installed: files of no other target are
# needed. (This works on a copy of the build's rules, next to copies of the command and its libraries.)
if(with_command AND NOT shared AND EXISTS ${build}/build.ninja)
  set(partial ${work}/partial)
  set(rules cmake_install.cmake)
  while(rules)
    list(POP_FRONT rules file)
    file(READ ${build}/${file} text)
    string(REGEX MATCHALL "include\\(\"[^\"]+" included "${text}")
    list(TRANSFORM included REPLACE "include\\(\"${build}/" "")
    list(APPEND rules ${included})
    string(REPLACE "${build}" "${partial}" text "${text}")
    file(WRITE ${partial}/${file} "${text}")
  endwhile()
  file(STRINGS ${build}/build.ninja link REGEX "^build bin/welkin[ :]")
  string(REGEX REPLACE "^build ([^:]*):.*" "\\1" made "${link}")
  string(REGEX MATCHALL "[^ |]*libwelkin[^ |]*\\.a" libraries "${link}")
  string(REPLACE "\${cmake_ninja_workdir}" "" made "${made}")
  string(REGEX MATCHALL "[^ |]+" made "${made}")
  foreach(file IN LISTS made libraries)
    cmake_path(GET file PARENT_PATH folder)
    file(COPY ${build}/${file} DESTINATION ${partial}/${folder})
  endforeach()
  file(COPY ${build}/CMakeFiles/Export DESTINATION ${partial}/CMakeFiles)
  file(GLOB described ${build}/welkin-config*.cmake ${build}/*.pc)
  file(COPY ${described} DESTINATION ${partial})
  run(${CMAKE_COMMAND} -DCMAKE_INSTALL_PREFIX=${work}/partly -P ${partial}/cmake_install.cmake)
  run(${work}/partly/bin/welkin --version)
endif()

if(with_command)
  run(${work}/installed/bin/welkin sh --sky --json)
  foreach(file IN ITEMS bash-completion/completions/welkin zsh/site-functions/_welkin man/man1/welkin.1)
    file(GLOB installed ${work}/installed/share/${file})
    if(NOT installed)
      message(FATAL_ERROR "${file} is not installed")
    endif()
  endforeach()
endif()
