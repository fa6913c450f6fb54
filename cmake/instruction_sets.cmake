# welkin_isa_sources(SOURCE...): kernels. Each source is compiled once per instruction set into the same library; which
# build runs is decided at run time. Kernels are optimised in every configuration: an unoptimised one tells nothing and
# takes minutes. (Under a sanitizer less: there it is the compiler that takes minutes, and the bits are the same.)
set(welkin_instruction_sets sse2 avx2 avx512)
if(MSVC)
  set(welkin_options_sse2)
  set(welkin_options_avx2 /arch:AVX2)
  set(welkin_options_avx512 /arch:AVX512)
  if(CMAKE_CXX_COMPILER_ID MATCHES "Clang")  # clang-cl's AVX2 has not what converts halves
    list(APPEND welkin_options_avx2 /clang:-mf16c /clang:-mno-fma)
  endif()
  set(welkin_kernel_optimisation /O2)
else()
  set(welkin_options_sse2 -msse2 -mno-avx)
  set(welkin_options_avx2 -mavx2 -mf16c -mno-fma -mno-avx512f)
  set(welkin_options_avx512 -mavx512f -mavx512bw -mavx512dq -mavx512vl)
  if(MINGW)
    # GCC aligns the stack of Windows to 16 bytes and moves registers of 32 and 64 as if it were to as many (PR54412):
    # the assembler makes unaligned moves of them, which cost nothing where they are aligned.
    list(APPEND welkin_options_avx2 -Wa,-muse-unaligned-vector-move)
    list(APPEND welkin_options_avx512 -Wa,-muse-unaligned-vector-move)
  endif()
  if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
    # GCC 12 takes the undefined operand inside its own AVX-512 intrinsics for an uninitialised variable (PR105593).
    list(APPEND welkin_options_avx512 -Wno-maybe-uninitialized -Wno-uninitialized)
  endif()
  set(welkin_kernel_optimisation -O3)
  if(CMAKE_CXX_FLAGS MATCHES "-fsanitize")
    set(welkin_kernel_optimisation -O1)
  endif()
endif()

foreach(isa IN LISTS welkin_instruction_sets)
  add_library(welkin_kernels_${isa} OBJECT)
  target_include_directories(welkin_kernels_${isa} PRIVATE ${PROJECT_SOURCE_DIR}/include ${PROJECT_SOURCE_DIR}/module)
  # xsimd's namespace is renamed for each instruction set, so that the linker keeps every build's inline functions.
  target_compile_definitions(welkin_kernels_${isa} PRIVATE WELKIN_ISA=${isa} xsimd=xsimd_${isa})
  target_compile_options(welkin_kernels_${isa} PRIVATE ${welkin_options_${isa}} ${welkin_kernel_optimisation})
  target_link_libraries(welkin_kernels_${isa} PRIVATE welkin_flags xsimd)
  set_target_properties(welkin_kernels_${isa} PROPERTIES POSITION_INDEPENDENT_CODE ON)
endforeach()

function(welkin_isa_sources)
  list(TRANSFORM ARGN PREPEND ${CMAKE_CURRENT_SOURCE_DIR}/ OUTPUT_VARIABLE sources)
  foreach(isa IN LISTS welkin_instruction_sets)
    target_sources(welkin_kernels_${isa} PRIVATE ${sources})
  endforeach()
endfunction()
