# One test program; its folders mirror module/. Each Catch2 test case is a ctest of its own.
include(Catch)

file(GLOB_RECURSE sources RELATIVE ${CMAKE_CURRENT_SOURCE_DIR} CONFIGURE_DEPENDS *.cpp)
list(FILTER sources EXCLUDE REGEX "^(exit|float_environment|headers|install|fuzz|parts|portability|reference|textures|probes/programs)/")
if(WELKIN_TEST_FOLDERS)
  list(JOIN WELKIN_TEST_FOLDERS "|" folders)
  list(FILTER sources INCLUDE REGEX "^(support|${folders})/")
endif()
if(NOT WELKIN_TOOLS)
  list(FILTER sources EXCLUDE REGEX "^tools/")
endif()
# A source for one kind of system says so in its name.
if(WIN32)
  list(FILTER sources EXCLUDE REGEX "_posix(_test)?\\.cpp$")
  # Limits on memory, processors and files that POSIX sets; forks; the scheduler's policies; a shell.
  list(FILTER sources EXCLUDE REGEX "^(files/hostile_files|worker/threads|tools/(batch_killed|report_command|terminal|unlucky))_test\\.cpp$")
else()
  list(FILTER sources EXCLUDE REGEX "_windows(_test)?\\.cpp$")
endif()
if(NOT welkin_all_codecs)
  # Most files that tests make or read are of one of the codecs. What a build without them does, tests/parts tells.
  message(STATUS "A codec is left out: so are the tests that read or write files")
  list(FILTER sources EXCLUDE REGEX "^(files|cache|tools)/|^same_as_before/(files|bakes)_|\
^(bake/bake_sources|c/c_interface|c/targets_in_c|harmonics/real_engines|image/pixels|image/resampling|projection/irradiance|\
projection/sun_detection|reflections/prefilter|worker/errors|worker/sources_and_handles)_test")
endif()
if(NOT WELKIN_ASTC)
  list(REMOVE_ITEM sources files/astc_test.cpp)
endif()
list(APPEND sources float_environment/modes.cpp)
list(REMOVE_ITEM sources simd/vector_kernels.cpp support/estimate_trials.cpp support/random_environments.cpp)
add_executable(welkin_tests ${sources})
target_include_directories(welkin_tests PRIVATE ${CMAKE_CURRENT_SOURCE_DIR} ${PROJECT_SOURCE_DIR}/module)
if("simd/vector_layer_test.cpp" IN_LIST sources)  # the vector layer's own functions, as kernels
  welkin_isa_library(welkin_vector_kernels simd/vector_kernels.cpp)
  foreach(isa IN LISTS welkin_instruction_sets)
    target_include_directories(welkin_vector_kernels_${isa} PRIVATE ${CMAKE_CURRENT_SOURCE_DIR})
    target_sources(welkin_tests PRIVATE $<TARGET_OBJECTS:welkin_vector_kernels_${isa}>)
  endforeach()
  welkin_leave_out_kernels(welkin_tests simd/vector_kernels.h)
endif()
if(TARGET Catch2::Catch2WithMain)
  target_link_libraries(welkin_tests PRIVATE Catch2::Catch2WithMain)
else()
  target_link_libraries(welkin_tests PRIVATE Catch2::Catch2)
endif()
target_link_libraries(welkin_tests PRIVATE welkin_internal welkin_reference welkin_test_map welkin_flags TBB::tbb
                                           OpenEXR::OpenEXR SPNG::SPNG WebP::WebP nlohmann_json::nlohmann_json)
if(sources MATCHES "(report|reflections|sky|stability)/")
  target_link_libraries(welkin_tests PRIVATE welkin_report)
else()
  target_include_directories(welkin_tests PRIVATE ${PROJECT_SOURCE_DIR}/cmake)  # standard_headers.h, else the report's
endif()
# Tests run the command through a shell, which cannot run programs for another processor: a script that can stands in.
set(command ${CMAKE_RUNTIME_OUTPUT_DIRECTORY}/welkin${CMAKE_EXECUTABLE_SUFFIX})
if(CMAKE_CROSSCOMPILING AND CMAKE_CROSSCOMPILING_EMULATOR AND NOT WIN32)  # the tests run in Wine themselves
  set(command ${CMAKE_CURRENT_BINARY_DIR}/emulated/welkin)
  list(JOIN CMAKE_CROSSCOMPILING_EMULATOR " " emulator)
  file(WRITE ${command} "#!/bin/sh\nexec ${emulator} ${CMAKE_RUNTIME_OUTPUT_DIRECTORY}/welkin \"$@\"\n")
  file(CHMOD ${command} PERMISSIONS OWNER_READ OWNER_WRITE OWNER_EXECUTE)
endif()
# Where things are on this machine: in a header of its own, so that all other objects are the same in every clone.
file(GENERATE OUTPUT ${CMAKE_CURRENT_BINARY_DIR}/places/places.h CONTENT
"#pragma once
#define WELKIN_TEST_DATA \"${CMAKE_CURRENT_SOURCE_DIR}/data\"
#define WELKIN_SHARED \"${PROJECT_SOURCE_DIR}/../shared\"
#define WELKIN_COMMAND \"${command}\"
")
target_include_directories(welkin_tests PRIVATE ${CMAKE_CURRENT_BINARY_DIR}/places)
# Tests are compiled once and run once, and most of the compiler's time would go into optimizing their checks. (The
# library is optimized as always, and ISO arithmetic gives the same bits at any level. Under a sanitizer tests are not
# optimized at all: it would take two thirds of the time.)
if(CMAKE_CXX_FLAGS MATCHES "-fsanitize")
  target_compile_options(welkin_tests PRIVATE -O0)
elseif(CMAKE_CXX_COMPILER_ID MATCHES "GNU|Clang")
  target_compile_options(welkin_tests PRIVATE $<$<CONFIG:Release,RelWithDebInfo>:-O1>)
endif()
# References that sum over millions of texels and rays are optimized.
file(GLOB long_sums stability/*_cases.cpp stability/measures.cpp probes/room.cpp)
if(CMAKE_CXX_COMPILER_ID MATCHES "GNU|Clang")
  set_source_files_properties(${long_sums} PROPERTIES COMPILE_OPTIONS $<$<CONFIG:Release>:-O2>
                                                              SKIP_PRECOMPILE_HEADERS ON)
endif()
welkin_compile_together(welkin_tests ${sources})
# A quarter of a test's compile time. (With Catch2 2, main.cpp defines what the header makes of itself.)
welkin_precompile_headers(welkin_tests support/catch.h ${welkin_standard_headers})
set_source_files_properties(support/main.cpp PROPERTIES SKIP_PRECOMPILE_HEADERS ON SKIP_UNITY_BUILD_INCLUSION ON)
# GCC 12 gives coroutines of two sources one name.
set_source_files_properties(worker/continuations_test.cpp PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)
# These put functions of theirs in the place of libraries' own, which must see them.
set_source_files_properties(jobs/races_are_reported_test.cpp support/exception_counts.cpp support/heap.cpp
                            PROPERTIES COMPILE_OPTIONS -fvisibility=default SKIP_PRECOMPILE_HEADERS ON)
if(WELKIN_TOOLS)
  # Tests of the command run the built programs.
  add_dependencies(welkin_tests welkin_command welkin_report_command)
endif()
catch_discover_tests(welkin_tests TEST_SPEC "~[slow]~[truth]~[.]" PROPERTIES TIMEOUT 600 LABELS quick)
catch_discover_tests(welkin_tests TEST_SPEC "[slow]~[truth]~[.]" PROPERTIES TIMEOUT 600 LABELS slow)
catch_discover_tests(welkin_tests TEST_SPEC "[truth]~[.]" PROPERTIES TIMEOUT 600 LABELS truth)

# No code may read scratch memory before writing it: the recorded results must be the same if it is filled with NaN.
if(welkin_all_codecs AND NOT WELKIN_TEST_FOLDERS AND NOT CMAKE_CROSSCOMPILING)
  add_test(NAME "results on record, in working memory filled with NaN" COMMAND welkin_tests "[same_as_before]")
  set_tests_properties("results on record, in working memory filled with NaN" PROPERTIES
                       ENVIRONMENT WELKIN_TEST_FILL_MEMORY=1 TIMEOUT 600 LABELS slow)
endif()
