// The loop without any baking: what the others are held against.
#pragma once

#include <utility>
#include <vector>

#include "baker.h"

namespace engine_loop {

class NoBaker final : public Baker {
 public:
  void collect() override {}
  void ask(Posting posting) override { kept_.push_back(std::move(posting)); }
  void finish() override {}

 private:
  // To give 75 MB back to the system takes milliseconds; that is not to happen in the frame.
  std::vector<Posting> kept_;
};

}  // namespace engine_loop
