# As windows-mingw, with static libraries throughout: a program of one file.
get_filename_component(WELKIN_WINDOWS_DEPENDENCIES "${CMAKE_CURRENT_LIST_DIR}/../../build/win32-x64-dependencies" ABSOLUTE)
include(${CMAKE_CURRENT_LIST_DIR}/windows-mingw.cmake)
