# WebAssembly by Emscripten, with vectors of 128 bits: what bindings/wasm is made of (scripts/wasm). Without threads, or with
# WELKIN_STANDARD_THREADS on memory that threads share, which all objects of a module must be compiled for.
set(EMSCRIPTEN_ROOT /usr/share/emscripten CACHE PATH "Where Emscripten's folder `cmake` lies: where Debian has it")
set(EMSCRIPTEN_SYSTEM_PROCESSOR wasm32)
include(${EMSCRIPTEN_ROOT}/cmake/Modules/Platform/Emscripten.cmake)

# Exceptions as the engines have them built in: half the size of those by way of JavaScript, and free until one is
# thrown.
set(CMAKE_C_FLAGS_INIT "-fwasm-exceptions")
set(CMAKE_CXX_FLAGS_INIT "-fwasm-exceptions")
list(APPEND CMAKE_TRY_COMPILE_PLATFORM_VARIABLES WELKIN_STANDARD_THREADS)
if(WELKIN_STANDARD_THREADS)
  string(APPEND CMAKE_C_FLAGS_INIT " -pthread")
  string(APPEND CMAKE_CXX_FLAGS_INIT " -pthread")
endif()

# A page waits for a module before anything can begin, so all but the kernels, which choose for themselves, is compiled for
# its size. Functions are inlined where that makes the module smaller; by default Emscripten then inlines none. Only
# OpenEXR's headers need RTTI, whose names are long (module/files/CMakeLists.txt).
set(CMAKE_C_FLAGS_RELEASE "-Oz -sINLINING_LIMIT=0 -DNDEBUG" CACHE STRING "" FORCE)
set(CMAKE_CXX_FLAGS_RELEASE "-Oz -sINLINING_LIMIT=0 -fno-rtti -DNDEBUG" CACHE STRING "" FORCE)

# Precompiled headers name what libc++ lacks, and code for one program needs no freedom of place.
set(CMAKE_DISABLE_PRECOMPILE_HEADERS ON)
set(WELKIN_POSITION_INDEPENDENT_CODE OFF)

# Headers of Debian's packages are copied one library at a time: their folder also has those of the host's C library.
set(packages ${CMAKE_BINARY_DIR}/headers)
if(NOT EXISTS ${packages}/glm)
  file(MAKE_DIRECTORY ${packages})
  foreach(header IN ITEMS glm xsimd nlohmann xxhash.h)
    file(CREATE_LINK /usr/include/${header} ${packages}/${header} SYMBOLIC)
  endforeach()
endif()
foreach(package IN ITEMS glm xsimd nlohmann_json)
  set(${package}_DIR ${CMAKE_CURRENT_LIST_DIR}/wasm_headers CACHE PATH "" FORCE)
endforeach()
set(XXHASH_INCLUDE_DIR ${packages} CACHE PATH "" FORCE)

# Codecs' libraries are where scripts/wasm-codecs built them.
get_filename_component(welkin_wasm_codecs "${CMAKE_CURRENT_LIST_DIR}/../../build/wasm-codecs/install" ABSOLUTE)
list(APPEND CMAKE_FIND_ROOT_PATH ${welkin_wasm_codecs})
