# Builds welkin::files with every codec switched off, as packages that are not there (a look at one of them is an error),
# links `refusing.cpp` with that and with `core`, built elsewhere, and runs it. What the last run built stays.

cmake_minimum_required(VERSION 3.22)
include(${CMAKE_CURRENT_LIST_DIR}/../install/run.cmake)

set(absent)
foreach(package IN ITEMS OpenEXR Imath SPNG ZLIB ZSTD WebP ASTCENC JPEG)
  list(APPEND absent -DCMAKE_DISABLE_FIND_PACKAGE_${package}=ON)
endforeach()
run(${CMAKE_COMMAND} -S ${CMAKE_CURRENT_LIST_DIR}/without_codecs -B ${work} -G ${generator} -DCMAKE_BUILD_TYPE=Debug
    -DCMAKE_C_COMPILER=${c_compiler} -DCMAKE_CXX_COMPILER=${compiler} -DCMAKE_CXX_FLAGS=${flags}
    -DCMAKE_CXX_FLAGS_DEBUG=-O0 -DCMAKE_C_COMPILER_LAUNCHER=${c_launcher} -DCMAKE_CXX_COMPILER_LAUNCHER=${launcher}
    -DWELKIN_SOURCE=${source} -DWELKIN_CORE=${core} -DWELKIN_LIBRARY_TOGETHER=ON ${absent}
    -DWELKIN_EXR=OFF -DWELKIN_PNG=OFF -DWELKIN_WEBP=OFF -DWELKIN_ZLIB=OFF -DWELKIN_ZSTD=OFF -DWELKIN_ASTC=OFF
    -DWELKIN_JPEG=OFF)
run(${CMAKE_COMMAND} --build ${work} --target refusing)
file(REMOVE_RECURSE ${work}/files)
run(${work}/bin/refusing ${work})
message("${output}")
