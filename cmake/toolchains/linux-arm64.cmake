# Compiles for 64-bit ARM Linux what needs no library there: Debian's cross compiler, with its own C and C++ libraries and
# the static ones that scripts/dependencies-from-source builds.
set(CMAKE_SYSTEM_NAME Linux)
set(CMAKE_SYSTEM_PROCESSOR aarch64)
set(CMAKE_C_COMPILER aarch64-linux-gnu-gcc)
set(CMAKE_CXX_COMPILER aarch64-linux-gnu-g++)
set(CMAKE_CROSSCOMPILING_EMULATOR qemu-aarch64)

get_filename_component(welkin_dependencies "${CMAKE_CURRENT_LIST_DIR}/../../build/linux-arm64-dependencies" ABSOLUTE)
set(CMAKE_FIND_ROOT_PATH ${welkin_dependencies}/sysroot)
set(CMAKE_FIND_ROOT_PATH_MODE_PROGRAM NEVER)
set(CMAKE_FIND_ROOT_PATH_MODE_LIBRARY ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_INCLUDE ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_PACKAGE ONLY)
