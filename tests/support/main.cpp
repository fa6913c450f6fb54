// Catch2 v2 has no ready-made main; v3 links its own (see CMakeLists.txt) and skips this one.
#if !__has_include(<catch2/catch_all.hpp>)
#define CATCH_CONFIG_MAIN
#include <catch2/catch.hpp>
#endif
