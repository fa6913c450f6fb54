# Read by a build of Welkin that has no tests (without_threads.cmake, the preset windows-core): the program of hashes, once
# the library is there.
set(welkin_hashes_folder ${CMAKE_CURRENT_LIST_DIR})  # when the calls are made, the former is another's
cmake_language(DEFER CALL add_executable core_hashes ${welkin_hashes_folder}/core_hashes.cpp)
cmake_language(DEFER CALL target_include_directories core_hashes PRIVATE ${welkin_hashes_folder}/..)
cmake_language(DEFER CALL target_link_libraries core_hashes PRIVATE welkin::core welkin_flags)
