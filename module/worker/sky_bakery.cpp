#include "worker/sky_bakery.h"

#include <utility>

#include "welkin/core.h"

namespace welkin::worker {

/// Goes with a request: if the worker lets go of that without having run it, somebody must know.
class SkyBakery::Ticket {
 public:
  explicit Ticket(std::shared_ptr<SkyBakery> bakery) : bakery_(std::move(bakery)) {}
  ~Ticket() {
    if (!started_) bakery_->dropped();
  }
  Ticket(const Ticket&) = delete;
  Ticket& operator=(const Ticket&) = delete;

  void run(const Control& control) {
    started_ = true;
    bakery_->run(control);
  }

 private:
  std::shared_ptr<SkyBakery> bakery_;
  bool started_ = false;
};

struct SkyBakery::Request {
  std::unique_ptr<Ticket> ticket;

  void operator()(const Control& control) const { ticket->run(control); }
};

SkyBakery::SkyBakery(Worker& worker, SkyLightOptions options, std::shared_ptr<const SkyTables> tables)
    : worker_(worker), options_(std::move(options)), tables_(std::move(tables)) {}

SkyBakery::Step SkyBakery::next_step() const noexcept {
  if (closed_) return Step::none;
  if (done_.tables != wish_.versions.tables) return Step::tables;
  const bool curve = done_.curve != wish_.versions.curve;
  const bool specular = done_.specular != wish_.versions.specular;
  // In turns: an altitude that never rests must not keep reflections waiting for ever.
  if (curve && !(specular && last_ == Step::curve)) return Step::curve;
  return specular ? Step::specular : Step::none;
}

void SkyBakery::set(const SkyWish& wish, bool stop) {
  {
    const std::scoped_lock lock(mutex_);
    wish_ = wish;
    error_ = nullptr;
    if (stop) stop_.request_stop();
    if (running_ || next_step() == Step::none) return;
    running_ = true;
  }
  post();
}

void SkyBakery::retry() {
  {
    const std::unique_lock lock(mutex_, std::try_to_lock);
    if (!lock.owns_lock() || running_ || next_step() == Step::none) return;
    running_ = true;
  }
  post();
}

/// With `running_` set, and the mutex free: the worker may let go of the request at once.
void SkyBakery::post() {
  {
    const std::scoped_lock lock(mutex_);
    ++counts_.posts;
  }
  Request request{std::make_unique<Ticket>(shared_from_this())};
  worker_.post(std::move(request), {.priority = options_.priority});
}

void SkyBakery::dropped() noexcept {
  const std::scoped_lock lock(mutex_);
  running_ = false;
  ++counts_.given_up;
  tell_of_the_worker();
}

/// With the mutex held.
void SkyBakery::tell_of_the_worker() noexcept {
  if (closed_) return;
  try {
    error_ = std::make_exception_ptr(
        Error(ErrorCode::stopped, "the worker let go of a sky before it was made: it was terminated, or is full"));
  } catch (...) {
    error_ = std::current_exception();
  }
}

void SkyBakery::run(const Control& control) {
  SkyWish wish;
  Step step = Step::none;
  std::stop_source source;
  std::array<std::shared_ptr<const void>, 8> garbage;
  {
    const std::scoped_lock lock(mutex_);
    step = next_step();
    last_ = step;
    wish = wish_;
    stop_ = source;
    garbage.swap(retired_);
    if (step == Step::none) running_ = false;
  }
  garbage = {};
  if (step == Step::none) return;
  std::exception_ptr error;
  try {
    const std::stop_callback link(control.stop, [&source] { source.request_stop(); });
    make(step, wish, {.stop = source.get_token(), .progress = control.progress});
  } catch (...) {
    error = std::current_exception();
  }
  settle(step, wish, error);
  {
    const std::scoped_lock lock(mutex_);
    const bool due = next_step() != Step::none;
    const bool worker_stops = control.stop.stop_requested();
    running_ = due && !worker_stops;
    if (due && worker_stops) tell_of_the_worker();
    if (!running_) return;
  }
  try {
    post();
  } catch (...) {
    const std::scoped_lock lock(mutex_);
    error_ = std::current_exception();  // no memory for a request; the ticket has told the rest
  }
}

void SkyBakery::make(Step step, const SkyWish& wish, const Control& control) {
  std::shared_ptr<const SkyTables> tables;
  {
    const std::scoped_lock lock(mutex_);
    tables = tables_;
  }
  switch (step) {
    case Step::none: return;
    case Step::tables: {
      tables = PrecomputeSky{*wish.atmosphere, options_.tables}(control);
      const std::scoped_lock lock(mutex_);
      tables_.swap(tables);
      ++counts_.tables;
      return;
    }
    case Step::curve: {
      auto curve = std::make_shared<const SkyCurve>(BakeSkyCurve{tables, wish.altitude_m, options_.curve}(control));
      const std::scoped_lock lock(mutex_);
      arrivals_.curve.swap(curve);
      arrivals_.sun_radius_degrees = tables->atmosphere.sun_angular_radius_degrees;
      ++counts_.curves;
      return;
    }
    case Step::specular: {
      auto specular = SkySpecular{tables, wish.altitude_m, wish.sun, options_.specular}(control);
      const std::scoped_lock lock(mutex_);
      arrivals_.specular.swap(specular);
      arrivals_.specular_sun = wish.sun;
      ++counts_.speculars;
      return;
    }
  }
}

/// Marks a step as done, or as not to be tried again; one that was stopped stays due.
void SkyBakery::settle(Step step, const SkyWish& wish, std::exception_ptr error) {
  bool stopped = false;
  if (error) {
    try {
      std::rethrow_exception(error);
    } catch (const Error& thrown) {
      stopped = thrown.code() == ErrorCode::cancelled;
    } catch (...) {
      stopped = false;
    }
  }
  const std::scoped_lock lock(mutex_);
  if (stopped) {
    ++counts_.given_up;
    return;
  }
  if (step == Step::tables) done_.tables = wish.versions.tables;
  if (step == Step::curve || (error && step == Step::tables)) done_.curve = wish.versions.curve;
  if (step == Step::specular || (error && step == Step::tables)) done_.specular = wish.versions.specular;
  if (!error) return;
  ++counts_.failures;
  error_ = std::move(error);
}

void SkyBakery::close() noexcept {
  const std::scoped_lock lock(mutex_);
  closed_ = true;
  stop_.request_stop();
}

bool SkyBakery::try_take(bool curve, bool specular, News& news) noexcept {
  const std::unique_lock lock(mutex_, std::try_to_lock);
  if (!lock.owns_lock()) return false;
  if (curve) {
    news.arrivals.curve = std::move(arrivals_.curve);
    arrivals_.curve.reset();
    news.arrivals.sun_radius_degrees = arrivals_.sun_radius_degrees;
  }
  if (specular) {
    news.arrivals.specular = std::move(arrivals_.specular);
    arrivals_.specular.reset();
    news.arrivals.specular_sun = arrivals_.specular_sun;
  }
  news.busy = running_ || next_step() != Step::none || arrivals_.curve || arrivals_.specular;
  return true;
}

bool SkyBakery::retire(std::shared_ptr<const void>& old) noexcept {
  const std::unique_lock lock(mutex_, std::try_to_lock);
  if (!lock.owns_lock()) return false;
  for (std::shared_ptr<const void>& place : retired_) {
    if (place) continue;
    place = std::move(old);
    return true;
  }
  return false;
}

SkyBakeCounts SkyBakery::counts() const {
  const std::scoped_lock lock(mutex_);
  return counts_;
}

std::exception_ptr SkyBakery::error() const {
  const std::scoped_lock lock(mutex_);
  return error_;
}

}  // namespace welkin::worker
