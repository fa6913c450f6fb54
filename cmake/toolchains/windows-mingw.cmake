# Toolchain: Windows on x86-64 by MinGW-w64 with POSIX threads. scripts/test-windows makes the folder of dependencies.
set(CMAKE_SYSTEM_NAME Windows)
set(CMAKE_SYSTEM_PROCESSOR x86_64)
set(triple x86_64-w64-mingw32)
set(CMAKE_C_COMPILER ${triple}-gcc-posix)
set(CMAKE_CXX_COMPILER ${triple}-g++-posix)
set(CMAKE_RC_COMPILER ${triple}-windres)

# Only the compiler's own files and the dependencies are found, and none of the host's.
get_filename_component(welkin_dependencies "${CMAKE_CURRENT_LIST_DIR}/../../build/windows-dependencies" ABSOLUTE)
set(WELKIN_WINDOWS_DEPENDENCIES ${welkin_dependencies} CACHE PATH
    "Folder with a folder sysroot of libraries and headers for Windows")
list(APPEND CMAKE_TRY_COMPILE_PLATFORM_VARIABLES WELKIN_WINDOWS_DEPENDENCIES)
set(sysroot ${WELKIN_WINDOWS_DEPENDENCIES}/sysroot)
set(CMAKE_FIND_ROOT_PATH ${sysroot} /usr/${triple})
set(CMAKE_FIND_ROOT_PATH_MODE_PROGRAM NEVER)
set(CMAKE_FIND_ROOT_PATH_MODE_LIBRARY ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_INCLUDE ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_PACKAGE ONLY)
file(GLOB xsimd_DIR ${sysroot}/lib/*/cmake/xsimd)  # Debian keeps it in a folder of the processor's name

# Tests run under Wine.
set(CMAKE_CROSSCOMPILING_EMULATOR ${CMAKE_CURRENT_LIST_DIR}/../../scripts/wine)
