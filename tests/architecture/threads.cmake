# cmake -DROOT=<the repository> -P threads.cmake: what runs at the same time is the business of two rooms. Only jobs and
# worker make threads (platform asks the system about them), only jobs/one_tbb.cpp and worker include oneTBB, and only
# jobs/control.cpp says that a call was cancelled, so that all calls say it in the same words.
cmake_minimum_required(VERSION 3.22)

set(pattern_tbb "#include [<\"](tbb|oneapi)/[a-z_/]+\\.h[>\"]|tbb::")
set(pattern_thread "std::j?thread[^:a-z_]")
set(pattern_cancelled "[^:]Error\\(ErrorCode::cancelled, (kCancelled|[^\"\n]*\"cancelled)|cancelled by the caller")
set(allowed_tbb "^module/(jobs/one_tbb\\.cpp$|worker/)")
set(allowed_thread "^module/(jobs|worker|platform)/|^include/welkin/detail/standard_library\\.h$")
set(allowed_cancelled "^module/jobs/control\\.(h|cpp)$")
set(kinds tbb thread cancelled)

file(GLOB_RECURSE sources RELATIVE ${ROOT} ${ROOT}/module/*.h ${ROOT}/module/*.cpp ${ROOT}/include/*.h
     ${ROOT}/include/*.hpp)
list(LENGTH sources count)
if(count LESS 100)
  message(FATAL_ERROR "only ${count} sources were found below ${ROOT}")
endif()
set(found_kinds)
foreach(source IN LISTS sources)
  file(READ ${ROOT}/${source} text)
  string(REGEX REPLACE "//[^\n]*" "" text "${text}")  # comments may name what they like
  foreach(kind IN LISTS kinds)
    if(NOT text MATCHES "${pattern_${kind}}")
      continue()
    endif()
    string(STRIP "${CMAKE_MATCH_0}" found)
    if(source MATCHES "${allowed_${kind}}")
      list(APPEND found_kinds ${kind})
    else()
      message(SEND_ERROR "${source}: \"${found}\" is for ${allowed_${kind}} alone (${kind})")
    endif()
  endforeach()
endforeach()

# A pattern that no longer finds what is allowed would find nothing elsewhere either.
foreach(kind IN LISTS kinds)
  if(NOT kind IN_LIST found_kinds)
    message(SEND_ERROR "the pattern of ${kind} does not even find what is allowed")
  endif()
endforeach()
message(STATUS "${count} sources leave threads to the rooms of jobs and of the worker")
