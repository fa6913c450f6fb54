// The system's headers that kernels read, precompiled once for each instruction set: reading them takes half of most
// kernels' time. (standard_headers.h has those of all other sources, and says what may stand here.)
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <glm/vec3.hpp>
#include <limits>
#include <memory>
#include <span>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#if defined(__x86_64__) || defined(_M_X64)
#include <xsimd/xsimd.hpp>
#elif defined(__ARM_NEON)
#include <arm_neon.h>
#endif
