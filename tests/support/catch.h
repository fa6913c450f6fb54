// Catch2 in either of the supported versions, and the standard headers: both are precompiled, so that tests need not
// list them.
#pragma once

#if __has_include(<catch2/catch_all.hpp>)
#include <catch2/catch_all.hpp>
using Catch::Approx;  // version 2 has it in the global namespace
#else
#include <catch2/catch.hpp>
#endif

#include "standard_headers.h"
