# Every dependency, found in one place. Debian 12's packages are enough; scripts/install-dependencies
# installs them. Newer versions work too.

# Threads and task scheduling: tiles run as oneTBB tasks in the caller's arena. (libtbb-dev)
find_package(Threads REQUIRED)
find_package(TBB REQUIRED)

# The public interface's vectors. (libglm-dev)
find_package(glm REQUIRED)
if(NOT TARGET glm::glm)
  add_library(glm::glm INTERFACE IMPORTED)
  target_include_directories(glm::glm INTERFACE ${GLM_INCLUDE_DIRS})
endif()

# SIMD registers with operators, one source for every instruction set. Headers only. (libxsimd-dev)
# Debian's package names xtl as a dependency that it neither needs nor brings: an empty target satisfies it.
if(NOT TARGET xtl)
  add_library(xtl INTERFACE IMPORTED)
endif()
find_package(xsimd REQUIRED)

# Reading OpenEXR files; Imath comes with it. (libopenexr-dev)
find_package(OpenEXR REQUIRED)

# Reading PNG files. (libspng-dev) Debian's package brings no CMake configuration: cmake/FindSPNG.cmake finds it.
list(APPEND CMAKE_MODULE_PATH ${CMAKE_CURRENT_LIST_DIR}/cmake)
find_package(SPNG REQUIRED)

# Packed levels of KTX2 textures. (zlib1g-dev, libzstd-dev) cmake/FindZSTD.cmake: one target, whichever way it was built.
find_package(ZLIB REQUIRED)
find_package(ZSTD REQUIRED)

# Reading Babylon.js .env files whose pictures are WebP. (libwebp-dev) cmake/FindWebP.cmake finds it.
find_package(WebP REQUIRED)

# Hashes of contents, by which results are found again, and checksums of stored results. Header only, inlined.
# (libxxhash-dev) cmake/FindXXHASH.cmake finds it.
find_package(XXHASH REQUIRED)

# JSON: the manifest of .env files; the command's output, recorded test values, reports. Headers only, and in no header
# of ours. (nlohmann-json3-dev)
find_package(nlohmann_json REQUIRED)

if(WELKIN_TOOLS OR WELKIN_EXAMPLES)
  # The command line. Headers only. (libcli11-dev)
  find_package(CLI11 REQUIRED)
endif()

if(WELKIN_TESTS)
  # The test framework, version 2 (Debian 12) or 3. (catch2)
  find_package(Catch2 REQUIRED)
endif()

if(WELKIN_PERF)
  # The benchmark framework. (libbenchmark-dev)
  find_package(benchmark REQUIRED)
endif()
