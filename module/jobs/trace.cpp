#include "jobs/trace.h"

#include <utility>

namespace welkin::jobs {
namespace {

thread_local TraceRecording* recording_here = nullptr;

}  // namespace

TraceRecording::TraceRecording() : inside_{&whole_}, stretch_began_(Clock::now()) { recording_here = this; }

TraceRecording::~TraceRecording() { recording_here = nullptr; }

TracedWork TraceRecording::finish() {
  end_stretch();
  return std::exchange(whole_, {});
}

void TraceRecording::end_stretch() {
  const Clock::time_point now = Clock::now();
  inside_.back()->stretches.push_back({std::chrono::duration<double>(now - stretch_began_).count(), {}});
  stretch_began_ = now;
}

TracedRegionScope::TracedRegionScope(const std::type_info* what, std::size_t parts) : recording_(recording_here) {
  if (recording_ == nullptr) return;
  recording_->end_stretch();
  TracedRegion region;
  region.what = what;
  region.parts.resize(parts);
  if (what == nullptr) region.after.resize(parts);
  auto& place = recording_->inside_.back()->stretches.back().region;
  place.push_back(std::move(region));
  recording_->regions_.push_back(place.data());
}

TracedRegionScope::~TracedRegionScope() {
  if (recording_ == nullptr) return;
  recording_->regions_.pop_back();
  recording_->stretch_began_ = TraceRecording::Clock::now();
}

void TracedRegionScope::set_waits(std::size_t part, std::size_t for_part) {
  if (recording_ != nullptr) recording_->regions_.back()->after[part].push_back(for_part);
}

TracedPartScope::TracedPartScope(std::size_t part) : recording_(recording_here) {
  if (recording_ == nullptr) return;
  recording_->inside_.push_back(&recording_->regions_.back()->parts[part]);
  recording_->stretch_began_ = TraceRecording::Clock::now();
}

TracedPartScope::~TracedPartScope() {
  if (recording_ == nullptr) return;
  recording_->end_stretch();
  recording_->inside_.pop_back();
}

}  // namespace welkin::jobs
