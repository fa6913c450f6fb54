# Checks the names that a shared Welkin exports.
#
#   cmake -D library=LIBRARY -D nm=NM -D wanted=NAME... -P exports.cmake
#
# Fails on every exported name that is neither of the C interface nor a public one in namespace welkin: rooms of the
# library are namespaces in it, and none of theirs is for users. `wanted` are names that must be there.
cmake_minimum_required(VERSION 3.22)
execute_process(COMMAND ${nm} --dynamic --demangle --defined-only ${library} OUTPUT_VARIABLE listed
                COMMAND_ERROR_IS_FATAL ANY)
string(REGEX REPLACE "[][;]" "_" listed "${listed}")
string(REGEX REPLACE "[0-9a-f]* [A-Za-z] ([^\n]*)\n" "\\1;" names "${listed}")
list(FILTER names EXCLUDE REGEX "^$")
set(kind "(typeinfo for |typeinfo name for |vtable for |VTT for |non-virtual thunk to |guard variable for )?")
set(strange)
foreach(name IN LISTS names)
  if(name MATCHES "^welkin_[a-z_]+$")
    continue()  # C
  endif()
  # A word in lower case before :: is a namespace. Templates in public headers call functions of `detail`, but not its
  # scheduler.
  string(REPLACE "welkin::detail::Scheduler::" "welkin::scheduler::" name "${name}")
  string(REPLACE "welkin::detail::" "welkin::" public "${name}")
  if(NOT public MATCHES "^${kind}welkin::" OR public MATCHES "welkin::[a-z_0-9]+::")
    list(APPEND strange "${name}")
  endif()
endforeach()
if(strange)
  list(JOIN strange "\n  " strange)
  message(FATAL_ERROR "${library} shows what is not for users:\n  ${strange}")
endif()
foreach(name IN LISTS wanted)
  set(found ${names})
  list(FILTER found INCLUDE REGEX "^${name}")
  if(NOT found)
    message(FATAL_ERROR "${library} does not show ${name}")
  endif()
endforeach()
list(LENGTH names count)
message("${count} names")
