# Compiles for 64-bit ARM Linux with Debian's cross compiler (g++-aarch64-linux-gnu) and runs what it compiled with
# qemu-user. The libraries come from a folder of unpacked arm64 packages, which scripts/test-arm fetches.
set(CMAKE_SYSTEM_NAME Linux)
set(CMAKE_SYSTEM_PROCESSOR aarch64)
set(CMAKE_C_COMPILER aarch64-linux-gnu-gcc)
set(CMAKE_CXX_COMPILER aarch64-linux-gnu-g++)

# The compiler brings headers of the C and C++ libraries to compile with. Programs run with those of the packages: the
# dynamic linker and the C library must be of one build, or threads never start.
get_filename_component(welkin_arm_packages "${CMAKE_CURRENT_LIST_DIR}/../../build/aarch64-packages" ABSOLUTE)
set(CMAKE_FIND_ROOT_PATH ${welkin_arm_packages})
set(CMAKE_FIND_ROOT_PATH_MODE_PROGRAM NEVER)
set(CMAKE_FIND_ROOT_PATH_MODE_LIBRARY ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_INCLUDE ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_PACKAGE ONLY)

# A header of libjpeg is of one processor, and lies where only a compiler of that processor looks.
set(CMAKE_CXX_STANDARD_INCLUDE_DIRECTORIES "${welkin_arm_packages}/usr/include/aarch64-linux-gnu")

# Libraries that libraries need.
set(CMAKE_EXE_LINKER_FLAGS_INIT "-Wl,-rpath-link,${welkin_arm_packages}/usr/lib/aarch64-linux-gnu")
set(CMAKE_SHARED_LINKER_FLAGS_INIT "${CMAKE_EXE_LINKER_FLAGS_INIT}")
set(CMAKE_CROSSCOMPILING_EMULATOR qemu-aarch64 -L ${welkin_arm_packages})
