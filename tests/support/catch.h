// Catch2 in either of the versions that are about, and the standard headers: precompiled, they cost a test nothing, and
// no test lists them again.
#pragma once

#if __has_include(<catch2/catch_all.hpp>)
#include <catch2/catch_all.hpp>
using Catch::Approx;  // version 2 has it in the global namespace
#else
#include <catch2/catch.hpp>
#endif

#include "standard_headers.h"
