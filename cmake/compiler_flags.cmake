# welkin_flags: what every target of ours is compiled with.
#
# No contraction: a fused multiply-add rounds once where the other instruction sets round twice, and the same input must
# give the same bits on all of them. Only what users call is visible outside a shared library.
add_library(welkin_flags INTERFACE)
if(MSVC)
  # /w14242 to /w14826: what -Wconversion says of numbers that lose digits or signs. /Zc: what C++20 says.
  target_compile_options(welkin_flags INTERFACE /W4 /w14242 /w14254 /w14287 /w14826 /permissive- /fp:precise /utf-8 /EHsc
                                                $<$<COMPILE_LANGUAGE:CXX>:/Zc:__cplusplus> $<$<COMPILE_LANGUAGE:CXX>:/Zc:preprocessor>
                                                $<$<BOOL:${WELKIN_WARNINGS_AS_ERRORS}>:/WX>)
  if(CMAKE_CXX_COMPILER_ID MATCHES "Clang")  # clang-cl; Visual C++ contracts only where /fp:contract asks it to
    target_compile_options(welkin_flags INTERFACE /clang:-ffp-contract=off)
  endif()
  target_compile_definitions(welkin_flags INTERFACE NOMINMAX _CRT_SECURE_NO_WARNINGS)
else()
  target_compile_options(welkin_flags INTERFACE -Wall -Wextra -Wpedantic -Wconversion -Wshadow -ffp-contract=off
                                                -fvisibility=hidden $<$<COMPILE_LANGUAGE:CXX>:-fvisibility-inlines-hidden>
                                                $<$<BOOL:${WELKIN_WARNINGS_AS_ERRORS}>:-Werror>)
  if(CMAKE_SYSTEM_PROCESSOR MATCHES "^wasm")
    # Sizes are counted in 64 bits and bounded by memory limits (bindings/wasm/source/), which 32 bits hold.
    target_compile_options(welkin_flags INTERFACE -Wno-shorten-64-to-32)
  endif()
  if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND CMAKE_CXX_COMPILER_VERSION VERSION_LESS 13)
    # GCC 12 sees overlapping copies in its own std::string operator+ (PR105651).
    target_compile_options(welkin_flags INTERFACE -Wno-restrict)
  endif()
endif()

if(NOT DEFINED WELKIN_POSITION_INDEPENDENT_CODE)  # a toolchain may say otherwise
  set(WELKIN_POSITION_INDEPENDENT_CODE ON)
endif()
