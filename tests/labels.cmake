# ctest labels: `quick` (less than half a second), `truth` (long comparisons with an independent integral), `slow`
# (anything else that takes longer), `live` (other people's engines and tools), `table` (tables of errors, compared with
# those on record). Each test has exactly one.
#
# welkin_label_tests(), called at the end of a folder: its tests that have no label are quick.
function(welkin_label_tests)
  get_property(tests DIRECTORY PROPERTY TESTS)
  foreach(test IN LISTS tests)
    get_property(labels TEST ${test} PROPERTY LABELS)
    if(NOT labels)
      set_property(TEST ${test} PROPERTY LABELS quick)
    endif()
  endforeach()
endfunction()
