// A step of a plan: what will be done, or why it will not.
#pragma once

#include <cstdint>
#include <string>

#include "welkin/export.h"
#include "welkin/projection.h"

namespace WELKIN_EXPORT welkin {

/// What becomes of one pass, and why.
struct PlannedPass {
  std::string name;                     ///< as the `PassRecord` that comes out of it
  PassAction action = PassAction::run;  ///< run, reused or left out
  std::string reason;                   ///< what is done, or why it is not; for a person

  /// Processor time of one thread; 0 for what is skipped. Passes overlap and share threads: `Plan::milliseconds`.
  double predicted_milliseconds = 0.0;
  std::uint64_t bytes = 0;  ///< what it holds at most beside the source: its result, and its working memory

  friend bool operator==(const PlannedPass&, const PlannedPass&) = default;
};

}  // namespace welkin
