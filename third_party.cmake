# Every dependency, found in one place. Debian 12's packages are enough; scripts/install-dependencies
# installs them. Newer versions work too.

# Threads and task scheduling: tiles run as oneTBB tasks in the caller's arena. (libtbb-dev) Without threads there is
# neither: all work is done by the calling thread, and the worker is left out.
set(welkin_thread_libraries)
if(WELKIN_THREADS)
  find_package(Threads REQUIRED)
  find_package(TBB REQUIRED)
  set(welkin_thread_libraries Threads::Threads TBB::tbb)
endif()

# The public interface's vectors. (libglm-dev)
find_package(glm REQUIRED)
if(NOT TARGET glm::glm)
  add_library(glm::glm INTERFACE IMPORTED)
  target_include_directories(glm::glm INTERFACE ${GLM_INCLUDE_DIRS})
endif()

# SIMD registers with operators, one source for every instruction set. Headers only. (libxsimd-dev) For ARM we have our own
# (module/simd/neon_registers.h says why).
# Debian's package names xtl as a dependency that it neither needs nor brings: an empty target satisfies it.
if(NOT CMAKE_SYSTEM_PROCESSOR MATCHES "^(aarch64|arm64|ARM64)$")
  if(NOT TARGET xtl)
    add_library(xtl INTERFACE IMPORTED)
  endif()
  find_package(xsimd REQUIRED)
endif()

# Codecs of welkin::files. A codec that is off is not looked for; its files are then refused with an error that names
# the codec that is missing.
option(WELKIN_EXR "Read and write OpenEXR files" ON)
option(WELKIN_PNG "Read and write PNG files, and .env files, whose images are PNG" ON)
option(WELKIN_WEBP "Read .env files whose images are WebP" ON)
option(WELKIN_JPEG "Read JPEG files that have a gain map (Ultra HDR, ISO 21496-1)" ON)
option(WELKIN_ZLIB "Pack and unpack levels of KTX2 textures with zlib" ON)
option(WELKIN_ZSTD "Pack and unpack levels of KTX2 textures with Zstandard" ON)
set(welkin_codec_packages)   # that find_package knows
set(welkin_codec_libraries)  # that CMake links
set(welkin_codec_modules)    # that pkg-config knows, or "-lname"
set(welkin_all_codecs ON)    # whether none is switched off
list(APPEND CMAKE_MODULE_PATH ${CMAKE_CURRENT_LIST_DIR}/cmake)

# welkin_codec(OPTION PACKAGE TARGET MODULE): looks for what a codec is built with, unless it is switched off. Tests,
# benchmarks and fuzzers make such files themselves and look for it in any case.
macro(welkin_codec option package target module)
  if(WELKIN_FILES AND ${option})
    find_package(${package} REQUIRED)
    list(APPEND welkin_codec_packages ${package})
    list(APPEND welkin_codec_libraries ${target})
    list(APPEND welkin_codec_modules ${module})
  else()
    set(welkin_all_codecs OFF)
    if(WELKIN_TESTS OR WELKIN_PERF OR WELKIN_FUZZ)
      find_package(${package} REQUIRED)
    endif()
  endif()
endmacro()

# Reading and writing OpenEXR files; Imath comes with it. (libopenexr-dev)
welkin_codec(WELKIN_EXR OpenEXR OpenEXR::OpenEXR OpenEXR)

# Reading and writing PNG files. (libspng-dev) Debian's package brings no CMake configuration: cmake/FindSPNG.cmake.
# libspng itself needs a zlib, with or without WELKIN_ZLIB.
welkin_codec(WELKIN_PNG SPNG SPNG::SPNG spng)

# Packed levels of KTX2 textures. (zlib1g-dev, libzstd-dev) cmake/FindZSTD.cmake: one target, however it was built.
welkin_codec(WELKIN_ZLIB ZLIB ZLIB::ZLIB zlib)
welkin_codec(WELKIN_ZSTD ZSTD ZSTD::ZSTD libzstd)

# Reading Babylon.js .env files whose images are WebP. (libwebp-dev) cmake/FindWebP.cmake finds it.
welkin_codec(WELKIN_WEBP WebP WebP::WebP libwebp)

# Reading JPEG files with a gain map: photographs of phones. (libjpeg62-turbo-dev)
welkin_codec(WELKIN_JPEG JPEG JPEG::JPEG libjpeg)

# Blocks of ASTC in KTX2 textures. (libastcenc-dev) cmake/FindASTCENC.cmake finds it. Many systems do not package it: unless
# told otherwise Welkin is built without it where it is not found. It has no pkg-config file: the linker's word stands for
# it.
if(WELKIN_FILES)
  if(NOT DEFINED WELKIN_ASTC)
    find_package(ASTCENC QUIET)
  endif()
  option(WELKIN_ASTC "Pack and unpack blocks of ASTC in KTX2 textures with astcenc" ${ASTCENC_FOUND})
  if(WELKIN_ASTC)
    find_package(ASTCENC REQUIRED)
    list(APPEND welkin_codec_packages ASTCENC)
    list(APPEND welkin_codec_libraries ASTCENC::ASTCENC)
    list(APPEND welkin_codec_modules -lastcenc)
  endif()
endif()

if(WELKIN_FILES)
  # Hashes of contents, by which results are found again, and checksums of stored results. Header only, inlined.
  # (libxxhash-dev) cmake/FindXXHASH.cmake finds it.
  find_package(XXHASH REQUIRED)

  # JSON: the manifest of .env files; the command's output, recorded test values, reports. Headers only, and in no
  # header of ours. (nlohmann-json3-dev)
  find_package(nlohmann_json REQUIRED)
endif()

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

if(WELKIN_PYTHON)
  # The Python extension, by pybind11 2.10 or later. (python3-dev, pybind11-dev)
  set(PYBIND11_FINDPYTHON ON)
  find_package(Python 3.9 REQUIRED COMPONENTS Interpreter Development.Module)
  find_package(pybind11 2.10 REQUIRED)
endif()
