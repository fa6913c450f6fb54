#include "synchronous_baker.h"

#include <utility>
#include <variant>

namespace engine_loop {

void SynchronousBaker::ask(Posting posting) {
  const Clock::time_point asked = Clock::now();
  const welkin::Projection light = arena_.execute(
      [&] { return std::visit([](const auto& request) { return request(welkin::Control{}); }, posting.request); });
  keep(posting.number, asked, light);
  kept_.push_back(std::move(posting));
}

}  // namespace engine_loop
