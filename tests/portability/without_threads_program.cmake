# Read by a build of Welkin that has no tests (see without_threads.cmake): the program of hashes, once the library is there.
cmake_language(DEFER CALL add_executable core_hashes ${CMAKE_CURRENT_LIST_DIR}/core_hashes.cpp)
cmake_language(DEFER CALL target_include_directories core_hashes PRIVATE ${CMAKE_CURRENT_LIST_DIR}/..)
cmake_language(DEFER CALL target_link_libraries core_hashes PRIVATE welkin::core welkin_flags)
