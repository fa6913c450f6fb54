// Times of small pieces of work, on a machine that may have other things to do.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "welkin/projection.h"

namespace welkin::planning {

/// Nanoseconds: a difference of two times may come out as nothing, and no work costs nothing.
inline constexpr double kLeast = 1e-3;

/// Time of the fastest of a few runs, of more if they are short.
[[nodiscard]] double fastest_nanoseconds(const std::function<void()>& work);

/// The same for work that records its passes, which are the same ones in each run: of each pass the fastest.
[[nodiscard]] std::vector<PassRecord> fastest_passes(const std::function<std::vector<PassRecord>()>& work);

/// Of all records of that name together.
[[nodiscard]] double nanoseconds_of(const std::vector<PassRecord>& passes, const std::string& name);

}  // namespace welkin::planning
