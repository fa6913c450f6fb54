# Whether what a program is linked with stays within bounds.
#
#   cmake -D program=PROGRAM -D archive=ARCHIVE -D readelf=READELF -D nm=NM -P needs.cmake
#
# `program`, linked with welkin::core, must need no library that files need, itself or by way of others; `archive`, core
# itself (none of a shared build), must leave no name undefined that files or one of those libraries would define.
set(libraries OpenEXR Imath Iex IlmThread spng webp libz zstd json welkin-files "libwelkin[.]")
set(names "welkin_" "welkin::" "Imf_" "Imath_" "Iex_" "IlmThread_" "spng_" "WebP" "ZSTD_" "nlohmann::" "(deflate|inflate|crc32|uncompress|compress)")

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
  # The linker's own view: all members of the archive together, in one object.
  execute_process(COMMAND ${nm} --demangle --defined-only --extern-only --format=posix ${archive} OUTPUT_VARIABLE defined
                  COMMAND_ERROR_IS_FATAL ANY)
  execute_process(COMMAND ${nm} --demangle --undefined-only --format=posix ${archive} OUTPUT_VARIABLE undefined
                  COMMAND_ERROR_IS_FATAL ANY)
  # A line is "name U" or "name T 0 1", and names have spaces and brackets; a list of lines needs no ";" in them.
  foreach(list IN ITEMS defined undefined)
    string(REGEX REPLACE "[][;]" "_" ${list} "${${list}}")
    string(REGEX REPLACE " [A-Za-z]( [0-9a-f]+)*[ ]*\n" ";" ${list} "${${list}}")
    list(REMOVE_DUPLICATES ${list})
  endforeach()
  list(LENGTH defined count)
  if(count LESS 100)
    message(FATAL_ERROR "${archive} defines ${count} names: has anything been looked at?")
  endif()
  list(REMOVE_ITEM undefined ${defined})
  foreach(name IN LISTS names)
    set(found ${undefined})
    list(FILTER found INCLUDE REGEX "^${name}")
    if(found)
      message(FATAL_ERROR "welkin::core is not whole without files; it leaves undefined: ${found}")
    endif()
  endforeach()
endif()
