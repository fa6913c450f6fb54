# cmake -DROOT=<the repository> -P platform.cmake: what differs between systems and compilers stands in module/platform.
# Elsewhere no header of a system, no call of a system that needs no such header, no assembly and no attribute of one
# compiler may be named; intrinsics only in module/simd.
cmake_minimum_required(VERSION 3.22)

set(before "(^|[^A-Za-z0-9_])")
set(pattern_system_header
    "#include <((sys|linux|mach|arpa|net|netinet)/[a-z_/]+|aio|direct|dirent|dlfcn|fcntl|ftw|glob|io|poll|process|pthread|pwd|sched|semaphore|spawn|strings|termios|unistd|utime|wait|windows|Windows)\\.h>")
set(pattern_system_call
    "${before}(clock_gettime|gmtime_r|localtime_r|mkdtemp|mkstemp|nanosleep|pclose|popen|setenv|sigaction|unsetenv) *\\(")
set(pattern_intrinsics "#include <([a-z]*intrin|cpuid|arm_neon)\\.h>|${before}(_mm[0-9]*_|__m(128|256|512)|v[a-z0-9]+q_[fsu](16|32|64))")
set(pattern_assembly "${before}(__asm__|__asm|asm)[^A-Za-z0-9_]")
set(pattern_compiler "\\[\\[(gnu|clang|msvc)::|__attribute__|__builtin_|__declspec|#pragma (GCC|clang)|_Pragma")
set(kinds system_header system_call intrinsics assembly compiler)

# Files outside module/platform in which a kind is allowed: public headers say what they export, and each of the two
# programs has one file for each system.
set(allowed_system_header "^(tools/terminal|perf/report/process)_(posix|windows)\\.cpp$")
set(allowed_system_call "${allowed_system_header}")
set(allowed_intrinsics "^module/simd/[a-z_0-9]+\\.h$")
set(allowed_assembly "^$")
set(allowed_compiler "^include/welkin/(core|welkin)\\.h$")

file(GLOB_RECURSE sources RELATIVE ${ROOT} ${ROOT}/module/*.h ${ROOT}/module/*.cpp ${ROOT}/include/*.h
     ${ROOT}/include/*.hpp ${ROOT}/tools/*.h ${ROOT}/tools/*.cpp ${ROOT}/perf/*.h ${ROOT}/perf/*.cpp)
list(LENGTH sources count)
if(count LESS 100)
  message(FATAL_ERROR "only ${count} sources were found below ${ROOT}")
endif()
foreach(source IN LISTS sources)
  file(READ ${ROOT}/${source} text)
  foreach(kind IN LISTS kinds)
    if(NOT text MATCHES "${pattern_${kind}}")
      continue()
    endif()
    string(STRIP "${CMAKE_MATCH_0}" found)
    if(source MATCHES "^module/platform/")
      list(APPEND in_platform ${kind})
    elseif(NOT source MATCHES "${allowed_${kind}}")
      message(SEND_ERROR "${source}: \"${found}\" belongs in module/platform (${kind})")
    endif()
  endforeach()
endforeach()

# A pattern that no longer finds what stands in module/platform would find nothing elsewhere either.
foreach(kind IN ITEMS system_header intrinsics assembly compiler)
  if(NOT kind IN_LIST in_platform)
    message(SEND_ERROR "the pattern of ${kind} does not even find what stands in module/platform")
  endif()
endforeach()
message(STATUS "${count} sources leave systems and compilers to module/platform")
