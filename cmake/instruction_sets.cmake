# welkin_isa_sources(SOURCE...): kernels. Each source is compiled once per instruction set into the same library, which
# chooses between them at run time. Kernels are optimized in every configuration: else they take minutes and their
# times mean nothing. (Under a sanitizer less so: there the compiler takes minutes, and the bits are the same.)
#
# The sets are those of the target processor. A build that is not shipped may omit some of x86's, each of which takes a
# ninth of a first build's time: sanitizers see as much in SSE2's kernels, which read and write the same texels, and a
# first bake needs those of one processor (scripts/welkin).
set(WELKIN_INSTRUCTION_SETS "" CACHE STRING "x86's instruction sets to build kernels for, of sse2, avx2 and avx512; empty: all")
if(CMAKE_SYSTEM_PROCESSOR MATCHES "^(aarch64|arm64|ARM64)$")
  set(welkin_instruction_sets neon)
elseif(CMAKE_SYSTEM_PROCESSOR MATCHES "^wasm")
  set(welkin_instruction_sets simd128)
else()
  set(welkin_instruction_sets sse2 avx2 avx512)
  if(WELKIN_INSTRUCTION_SETS)
    set(welkin_left_out_sets ${welkin_instruction_sets})
    list(REMOVE_ITEM welkin_left_out_sets ${WELKIN_INSTRUCTION_SETS})
    list(REMOVE_ITEM welkin_instruction_sets ${welkin_left_out_sets})
    if(NOT welkin_instruction_sets)
      message(FATAL_ERROR "WELKIN_INSTRUCTION_SETS has none of sse2, avx2 and avx512: ${WELKIN_INSTRUCTION_SETS}")
    endif()
  endif()
endif()
set(welkin_options_neon)  # part of the processor
set(welkin_options_simd128 -msimd128 -msse2)  # the intrinsics of SSE2, which stand for those of WebAssembly
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
    # GCC 12 takes the undefined operand inside its own AVX-512 intrinsics for an uninitialized variable (PR105593).
    list(APPEND welkin_options_avx512 -Wno-maybe-uninitialized -Wno-uninitialized)
  endif()
  set(welkin_kernel_optimisation -O3)
  if(CMAKE_CXX_FLAGS MATCHES "-fsanitize")
    set(welkin_kernel_optimisation -O1)
  endif()
endif()

# welkin_isa_library(PREFIX [SOURCE...]): object libraries PREFIX_sse2 and so on, each with one build of the sources.
function(welkin_isa_library prefix)
  foreach(isa IN LISTS welkin_instruction_sets)
    set(library ${prefix}_${isa})
    add_library(${library} OBJECT ${ARGN})
    target_include_directories(${library} PRIVATE ${PROJECT_SOURCE_DIR}/include ${PROJECT_SOURCE_DIR}/module)
    # xsimd's namespace is renamed for each instruction set, so that the linker keeps every build's inline functions.
    target_compile_definitions(${library} PRIVATE WELKIN_ISA=${isa} xsimd=xsimd_${isa})
    target_compile_options(${library} PRIVATE ${welkin_options_${isa}} ${welkin_kernel_optimisation})
    target_link_libraries(${library} PRIVATE welkin_flags)
    if(TARGET xsimd)
      target_link_libraries(${library} PRIVATE xsimd)
    endif()
    set_target_properties(${library} PROPERTIES POSITION_INDEPENDENT_CODE ${WELKIN_POSITION_INDEPENDENT_CODE})
  endforeach()
endfunction()

# To the library's own, welkin_kernels_sse2 and so on.
function(welkin_isa_sources)
  list(TRANSFORM ARGN PREPEND ${CMAKE_CURRENT_SOURCE_DIR}/ OUTPUT_VARIABLE sources)
  foreach(isa IN LISTS welkin_instruction_sets)
    target_sources(welkin_kernels_${isa} PRIVATE ${sources})
  endforeach()
endfunction()

# welkin_leave_out_kernels(TARGET HEADER...): gives TARGET empty tables for the sets that are left out, so that adding them
# later compiles nothing else again but the source that asks the processor.
function(welkin_leave_out_kernels target)
  foreach(isa IN LISTS welkin_left_out_sets)
    list(TRANSFORM ARGN REPLACE "(.+)" "#include \"\\1\"\n" OUTPUT_VARIABLE includes)
    string(JOIN "" text "#define WELKIN_KERNELS_LEFT_OUT ${isa}\n" ${includes})
    file(CONFIGURE OUTPUT left_out_${isa}.cpp CONTENT "${text}" @ONLY)
    target_sources(${target} PRIVATE ${CMAKE_CURRENT_BINARY_DIR}/left_out_${isa}.cpp)
  endforeach()
endfunction()
