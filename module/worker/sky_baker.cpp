#include "worker/sky_baker.h"

#include <algorithm>
#include <utility>

#include "welkin/core.h"
#include "worker/scheduler.h"

namespace welkin::worker {

/// A request that tells the baker if the worker lets go of it without having run it.
class SkyBaker::Request {
 public:
  explicit Request(std::shared_ptr<SkyBaker> baker) : baker_(std::move(baker)) {}
  ~Request() {
    if (baker_) baker_->dropped();
  }
  Request(Request&&) noexcept = default;
  Request& operator=(Request&&) = delete;

  void operator()(const Control& control) { std::exchange(baker_, nullptr)->run(control); }

 private:
  std::shared_ptr<SkyBaker> baker_;  ///< null once it runs, and of what was moved from
};

SkyBaker::SkyBaker(Worker& worker, SkyLightOptions options, std::shared_ptr<const SkyTables> tables)
    : worker_(worker), options_(std::move(options)), tables_(std::move(tables)) {}

bool SkyBaker::curve_is_due() const noexcept {
  return done_.curve != target_.versions.curve || curve_tables_ != done_.tables;
}

bool SkyBaker::specular_is_due() const noexcept {
  return target_.versions.specular > 0 &&
         (done_.specular != target_.versions.specular || specular_tables_ != done_.tables);
}

SkyBaker::Step SkyBaker::next_step() const noexcept {
  if (closed_) return Step::none;
  const bool curve = curve_is_due();
  const bool specular = specular_is_due();
  // Curves and reflections of the last tables come before the next tables: an atmosphere that never rests must not
  // keep light waiting for ever.
  const bool unused = (curve && curve_tables_ != done_.tables) || (specular && specular_tables_ != done_.tables);
  if (done_.tables != target_.versions.tables && !unused) return Step::tables;
  // In turns: an altitude that never rests must not keep reflections waiting for ever.
  if (curve && !(specular && last_ == Step::curve)) return Step::curve;
  return specular ? Step::specular : Step::none;
}

/// Called with the mutex held. Returns true if this thread is to post a request.
bool SkyBaker::claim() noexcept {
  if (running_ || next_step() == Step::none) return false;
  running_ = true;
  ++counts_.posts;
  return true;
}

void SkyBaker::set(const SkyTarget& target, bool stop) {
  {
    const std::scoped_lock lock(mutex_);
    target_ = target;
    error_ = nullptr;
    if (stop && !spared_ && last_ == Step::tables) stop_.request_stop();
    if (!claim()) return;
  }
  post();
}

void SkyBaker::retry() {
  {
    const std::unique_lock lock(mutex_, std::try_to_lock);
    if (!lock.owns_lock() || !claim()) return;
  }
  post();
}

/// Called after `claim`, with the mutex free: the worker may let go of the request at once.
void SkyBaker::post() { worker_.post(Request(shared_from_this()), {.priority = options_.priority}); }

void SkyBaker::dropped() noexcept {
  const std::scoped_lock lock(mutex_);
  running_ = false;
  ++counts_.cancelled;
  tell_of_the_worker();
}

/// With the mutex held.
void SkyBaker::tell_of_the_worker() noexcept {
  if (closed_) return;
  try {
    error_ = std::make_exception_ptr(
        Error(ErrorCode::stopped, "the worker let go of a sky before it was made: it was terminated, or is full"));
  } catch (...) {
    error_ = std::current_exception();
  }
}

void SkyBaker::run(const Control& control) {
  SkyTarget target;
  Step step = Step::none;
  stop_source source;
  std::array<std::shared_ptr<const void>, 8> garbage;
  {
    const std::scoped_lock lock(mutex_);
    step = next_step();
    last_ = step;
    target = target_;
    stop_ = source;
    garbage.swap(retired_);
    if (step == Step::none) running_ = false;
  }
  garbage = {};
  if (step == Step::none) return;
  std::exception_ptr error;
  bool stopped = false;
  try {
    const stop_callback link(control.stop, [&source] { source.request_stop(); });
    make(step, target, {.stop = source.get_token(), .progress = control.progress});
  } catch (const Error& thrown) {
    stopped = thrown.code() == ErrorCode::cancelled;
    error = std::current_exception();
  } catch (...) {
    error = std::current_exception();
  }
  {
    const std::scoped_lock lock(mutex_);
    if (stopped) {
      ++counts_.cancelled;  // the step stays due
      spared_ = true;
    } else {
      settle(step, target.versions, std::move(error));
    }
    running_ = false;
    if (next_step() != Step::none && control.stop.stop_requested()) return tell_of_the_worker();
    if (!claim()) return;
  }
  try {
    post();
  } catch (...) {
    const std::scoped_lock lock(mutex_);
    error_ = std::current_exception();  // no memory for a request, whose end called `dropped`
  }
}

void SkyBaker::make(Step step, const SkyTarget& target, const Control& control) {
  std::shared_ptr<const SkyTables> tables;
  {
    const std::scoped_lock lock(mutex_);
    tables = tables_;
  }
  switch (step) {
    case Step::none: return;
    case Step::tables: {
      // It takes seconds; a first environment, perhaps on the worker's only thread, must not wait for it.
      const auto piece_done = [this, &control](double done) {
        control.progress(done);
        detail::let_another_pass(options_.priority);
      };
      tables = PrecomputeSky{*target.atmosphere, options_.tables}({.stop = control.stop, .progress = piece_done});
      const std::scoped_lock lock(mutex_);
      tables_.swap(tables);
      ++counts_.tables;
      return;
    }
    case Step::curve: {
      auto curve = std::make_shared<const SkyCurve>(BakeSkyCurve{tables, target.altitude_m, options_.curve}(control));
      const std::scoped_lock lock(mutex_);
      updates_.curve.curve.swap(curve);
      updates_.curve.sun_radius_degrees = tables->atmosphere.sun_angular_radius_degrees;
      ++counts_.curves;
      return;
    }
    case Step::specular: {
      auto specular = SkySpecular{tables, target.altitude_m, target.sun, options_.specular}(control);
      const std::scoped_lock lock(mutex_);
      updates_.reflections.specular.swap(specular);
      updates_.reflections.sun = target.sun;
      ++counts_.speculars;
      return;
    }
  }
}

/// Called with the mutex held. Marks a step as done or not to be tried again; without tables that goes for all steps.
void SkyBaker::settle(Step step, const SkyVersions& wanted, std::exception_ptr error) {
  const bool no_tables = error && step == Step::tables;
  if (step == Step::tables) {
    done_.tables = wanted.tables;
    spared_ = false;
  }
  if (step == Step::curve || no_tables) {
    done_.curve = wanted.curve;
    curve_tables_ = done_.tables;
  }
  if (step == Step::specular || no_tables) {
    done_.specular = wanted.specular;
    specular_tables_ = done_.tables;
  }
  if (!error) return;
  ++counts_.failures;
  error_ = std::move(error);
}

void SkyBaker::close() noexcept {
  const std::scoped_lock lock(mutex_);
  closed_ = true;
  stop_.request_stop();
}

std::optional<SkyUpdates> SkyBaker::try_take(bool curve, bool reflections,
                                             std::span<std::shared_ptr<const void>> garbage) noexcept {
  const std::unique_lock lock(mutex_, std::try_to_lock);
  if (!lock.owns_lock()) return std::nullopt;
  for (std::shared_ptr<const void>& old : garbage) {
    const auto slot = std::find(retired_.begin(), retired_.end(), nullptr);
    if (slot != retired_.end()) slot->swap(old);
  }
  SkyUpdates taken;
  if (curve) taken.curve = std::exchange(updates_.curve, {});
  if (reflections) taken.reflections = std::exchange(updates_.reflections, {});
  taken.more_to_come = running_ || next_step() != Step::none || updates_.curve.curve || updates_.reflections.specular;
  return taken;
}

SkyBakeCounts SkyBaker::counts() const {
  const std::scoped_lock lock(mutex_);
  return counts_;
}

std::exception_ptr SkyBaker::error() const {
  const std::scoped_lock lock(mutex_);
  return error_;
}

}  // namespace welkin::worker
