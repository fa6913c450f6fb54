# cmake -D part=PART -D compiler=CXX -D c_compiler=C -D include=FOLDER -D folders=FOLDER... -D xyzw_only=BOOL
#       -D work=FOLDER -P compile.cmake
#
# Looks at the public headers with a compiler, which makes no code. "with GLM's macros": all of them with GLM's common macros,
# in two sets, because XYZW_ONLY and SWIZZLE exclude each other; the former where xyzw_only is on. (GLM 0.9.9.8, Debian's,
# compiles with all of these by itself, with GCC 12 and clang 14; so none is left out.) "as C": welkin.h as C.
cmake_minimum_required(VERSION 3.22)

set(strict -fsyntax-only -Wall -Wextra -Wpedantic -Werror -I${include})
foreach(folder IN LISTS folders)
  list(APPEND strict -isystem ${folder})
endforeach()
set(cpp ${compiler} -std=c++20 -fno-exceptions -fno-rtti ${strict})
file(MAKE_DIRECTORY ${work})
set(count 0)

# check(FILE TEXT COMMAND...): what the compiler says of a source with that text must be nothing.
function(check file text)
  file(WRITE ${work}/${file} "${text}\n")
  execute_process(COMMAND ${ARGN} ${work}/${file} OUTPUT_VARIABLE said ERROR_VARIABLE said RESULT_VARIABLE result)
  if(NOT result EQUAL 0)
    string(REPLACE ";" " " command "${ARGN}")
    message(SEND_ERROR "${command} ${work}/${file}\n${said}")
  endif()
  math(EXPR count "${count} + 1")
  set(count ${count} PARENT_SCOPE)
endfunction()

if(part STREQUAL "with GLM's macros")
  set(all "#include <welkin/welkin.hpp>\n#include <welkin/welkin.h>")
  set(several)
  foreach(macro IN ITEMS DEFAULT_ALIGNED_GENTYPES INTRINSICS SWIZZLE QUAT_DATA_WXYZ SIZE_T_LENGTH EXPLICIT_CTOR
                         DEPTH_ZERO_TO_ONE)
    string(APPEND several "#define GLM_FORCE_${macro}\n")
  endforeach()
  check(several.cpp "${several}${all}" ${cpp})
  if(xyzw_only)
    check(xyzw_only.cpp "#define GLM_FORCE_XYZW_ONLY\n${all}" ${cpp})
  endif()
elseif(part STREQUAL "as C")
  foreach(standard IN ITEMS c99 c11)
    check(${standard}.c "#include <welkin/welkin.h>" ${c_compiler} -std=${standard} ${strict})
  endforeach()
else()
  message(FATAL_ERROR "there is no part \"${part}\"")
endif()
if(count EQUAL 0)
  message(FATAL_ERROR "no header was found in ${include}")
endif()
message(STATUS "${count} sources")
