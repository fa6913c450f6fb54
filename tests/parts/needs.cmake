# Whether what a program is linked with stays within bounds.
#
#   cmake -D program=PROGRAM -D archive=ARCHIVE -D readelf=READELF -D nm=NM -P needs.cmake
#
# `program`, linked with welkin::core, must need no library that files need, itself or by way of others; `archive`, core
# itself (none of a shared build), must leave no name undefined that files or one of those libraries would define.
cmake_minimum_required(VERSION 3.22)
set(libraries OpenEXR Imath Iex IlmThread spng webp libz zstd json welkin-files "libwelkin[.]")
set(names "welkin|Imf_|Imath_|Iex_|IlmThread_|nlohmann|^spng_|^WebP|^ZSTD_|^(deflate|inflate|crc32|compress|uncompress)")

execute_process(COMMAND ${readelf} -d ${program} OUTPUT_VARIABLE direct COMMAND_ERROR_IS_FATAL ANY)
execute_process(COMMAND ldd ${program} OUTPUT_VARIABLE all COMMAND_ERROR_IS_FATAL ANY)
if(NOT direct MATCHES "NEEDED[^\n]*(libtbb|libwelkin-core)")
  message(FATAL_ERROR "neither oneTBB nor core is needed: has anything been looked at?\n${direct}")
endif()
foreach(library IN LISTS libraries)
  foreach(list IN ITEMS "${direct}" "${all}")
    if(list MATCHES "[^\n]*${library}[^\n]*")
      message(FATAL_ERROR "a program that is linked with welkin::core needs another library: ${CMAKE_MATCH_0}")
    endif()
  endforeach()
endforeach()

if(archive)
  execute_process(COMMAND ${nm} --defined-only --extern-only --format=posix ${archive} OUTPUT_VARIABLE defined
                  COMMAND_ERROR_IS_FATAL ANY)
  execute_process(COMMAND ${nm} --undefined-only --format=posix ${archive} OUTPUT_VARIABLE undefined
                  COMMAND_ERROR_IS_FATAL ANY)
  foreach(list IN ITEMS defined undefined)
    string(REGEX REPLACE "[^\n]*:\n" "" ${list} "${${list}}")                # "archive[member]:"
    string(REGEX REPLACE "\n+" "\n" ${list} "${${list}}")
    string(REGEX REPLACE " [A-Za-z][^\n]*\n" ";" ${list} "${${list}}")  # "name T 0 1c", "name U"
    list(REMOVE_DUPLICATES ${list})
  endforeach()
  list(LENGTH defined count)
  if(count LESS 100)
    message(FATAL_ERROR "${archive} defines ${count} names: has anything been looked at?")
  endif()
  list(REMOVE_ITEM undefined ${defined})
  list(FILTER undefined INCLUDE REGEX "${names}")
  if(undefined)
    message(FATAL_ERROR "welkin::core is not whole without files; it leaves undefined: ${undefined}")
  endif()
endif()
