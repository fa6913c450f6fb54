// Promise: precomputing a sky can be stopped and watched, keeps its memory limit, allocates nothing inside tiles, names
// what is wrong with its arguments, and gives the same bits on any number of threads and any instruction set.
#include <xmmintrin.h>

#include <cmath>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "support/catch.h"
#include "support/heap.h"
#include "support/thrown_error.h"
#include "welkin/instruction_set.h"
#include "welkin/sky_tables.h"

namespace welkin::test {
namespace {

SkyTableOptions small_options() {
  return {.heights = 4,
          .view_zeniths = 6,
          .sun_zeniths = 7,
          .sun_angles = 3,
          .transmittance_heights = 7,
          .transmittance_zeniths = 9,
          .irradiance_heights = 3,
          .irradiance_sun_zeniths = 5,
          .orders = 3};
}

bool same_tables(const SkyTables& a, const SkyTables& b) {
  return a.transmittance == b.transmittance && a.scattering == b.scattering && a.single_mie == b.single_mie &&
         a.irradiance == b.irradiance && a.orders == b.orders && a.last_change == b.last_change;
}

/// FNV-1a of all bits.
std::uint64_t hash(const SkyTables& tables) {
  std::uint64_t value = 0xcbf29ce484222325U;
  for (const std::vector<float>* table :
       {&tables.transmittance, &tables.scattering, &tables.single_mie, &tables.irradiance}) {
    const auto* const bytes = reinterpret_cast<const unsigned char*>(table->data());
    for (std::size_t i = 0; i < table->size() * sizeof(float); ++i) value = (value ^ bytes[i]) * 0x100000001b3U;
  }
  return value;
}

}  // namespace

TEST_CASE("Sky tables are the same bits on any number of threads and instruction set", "[sky][tables][same_bits]") {
  for (const ScatteringLayout layout : {ScatteringLayout::full, ScatteringLayout::compact}) {
    SkyTableOptions options = small_options();
    options.layout = layout;
    const SkyTables wanted = precompute_sky(earth(), options);
    for (const int threads : {1, 2, 3, 7}) {
      SkyTables found;
      run_with_threads(threads, [&] { found = precompute_sky(earth(), options); });
      CHECK(same_tables(found, wanted));
    }
    const InstructionSet before = active_instruction_set();
    for (const InstructionSet set : available_instruction_sets()) {
      force_instruction_set(set);
      CAPTURE(name(set));
      CHECK(same_tables(precompute_sky(earth(), options), wanted));
    }
    force_instruction_set(before);
  }
}

TEST_CASE("A caller's own floating-point environment changes no bit of sky tables", "[sky][tables][same_bits]") {
  const SkyTables wanted = precompute_sky(earth(), small_options());
  const unsigned before = _mm_getcsr();
  _mm_setcsr(before | 0x8040U | 0x6000U);  // denormals are flushed, rounding is towards 0
  const SkyTables found = precompute_sky(earth(), small_options());
  _mm_setcsr(before);
  CHECK(same_tables(found, wanted));
}

TEST_CASE("Sky tables are the bits on record", "[sky][tables][same_bits]") {
  CHECK(hash(precompute_sky(earth(), small_options())) == 0x199a8baf7c97a704U);
  CHECK(hash(precompute_sky(mars(), small_options())) == 0x26667325f6818f5cU);
}

TEST_CASE("Precomputing a sky allocates nothing inside tiles", "[sky][tables]") {
  forget_allocations_in_tiles();
  static_cast<void>(precompute_sky(earth(), small_options()));
  CHECK(allocations_in_tiles() == 0);
}

TEST_CASE("Precomputing a sky tells its progress, and stops when asked to at any point of it", "[sky][tables]") {
  double last = 0.0;
  int calls = 0;
  bool rising = true;
  Control control;
  control.progress = [&](double done) {
    rising = rising && done >= last && done <= 1.0;
    last = done;
    ++calls;
  };
  static_cast<void>(precompute_sky(earth(), small_options(), control));
  CHECK(rising);
  CHECK(last == 1.0);
  CHECK(calls > 50);
  for (const double when : {0.0, 0.01, 0.04, 0.2, 0.5, 0.9}) {
    std::stop_source source;
    control.stop = source.get_token();
    control.progress = [&](double done) {
      if (done >= when) source.request_stop();
    };
    if (when == 0.0) source.request_stop();
    CHECK(thrown_by([&] { static_cast<void>(precompute_sky(earth(), small_options(), control)); }).code ==
          ErrorCode::cancelled);
  }
}

TEST_CASE("Orders stop when one changes too little", "[sky][tables]") {
  SkyTableOptions options = small_options();
  options.orders = 64;
  options.until_change = 0.02;
  const SkyTables tables = precompute_sky(earth(), options);
  CHECK(tables.orders > 2);
  CHECK(tables.orders < 10);
  CHECK(tables.last_change < 0.02);
  options.orders = tables.orders;
  options.until_change = 0.0;
  CHECK(precompute_sky(earth(), options).scattering == tables.scattering);
}

TEST_CASE("Sky tables keep their memory limit and predict what they take", "[sky][tables]") {
  SkyTableOptions options = small_options();
  options.memory_limit_bytes = 1000;
  const ThrownError error = thrown_by([&] { static_cast<void>(precompute_sky(earth(), options)); });
  CHECK(error.code == ErrorCode::limit_exceeded);
  CHECK(error.says("1000"));
  options = {.heights = 128, .view_zeniths = 1024, .sun_zeniths = 256, .sun_angles = 128};
  CHECK(sky_table_bytes(earth(), options) > std::uint64_t{128} * 1024 * 256 * 128 * 32);
  CHECK(thrown_by([&] { static_cast<void>(precompute_sky(earth(), options)); }).code == ErrorCode::limit_exceeded);
  for (const ScatteringLayout layout : {ScatteringLayout::full, ScatteringLayout::compact}) {
    SkyTableOptions usual;
    usual.layout = layout;
    usual.heights = 12;
    usual.orders = 2;
    const HeapWatch watch;
    const SkyTables tables = precompute_sky(earth(), usual);
    CHECK(watch.peak_bytes() <= static_cast<long>(sky_table_bytes(earth(), usual)));
    CHECK(tables.bytes() < sky_table_bytes(earth(), usual));
  }
}

TEST_CASE("Options that make no sense are named", "[sky][tables]") {
  const auto refused = [](const char* what, auto change) {
    SkyTableOptions options = small_options();
    change(options);
    const ThrownError error = thrown_by([&] { static_cast<void>(precompute_sky(earth(), options)); });
    CAPTURE(what, error.message);
    CHECK(error.code == ErrorCode::invalid_argument);
    CHECK(error.says(what));
  };
  refused("heights", [](SkyTableOptions& o) { o.heights = 1; });
  refused("heights", [](SkyTableOptions& o) { o.heights = 129; });
  refused("view_zeniths", [](SkyTableOptions& o) { o.view_zeniths = 7; });
  refused("view_zeniths", [](SkyTableOptions& o) { o.view_zeniths = 2; });
  refused("sun_zeniths", [](SkyTableOptions& o) { o.sun_zeniths = 3; });
  refused("sun_angles", [](SkyTableOptions& o) { o.sun_angles = -1; });
  refused("transmittance_heights", [](SkyTableOptions& o) { o.transmittance_heights = 1; });
  refused("transmittance_zeniths", [](SkyTableOptions& o) { o.transmittance_zeniths = 1 << 30; });
  refused("irradiance_heights", [](SkyTableOptions& o) { o.irradiance_heights = 0; });
  refused("irradiance_sun_zeniths", [](SkyTableOptions& o) { o.irradiance_sun_zeniths = 1; });
  refused("lowest_sun_degrees", [](SkyTableOptions& o) { o.lowest_sun_degrees = 1.0; });
  refused("lowest_sun_degrees", [](SkyTableOptions& o) { o.lowest_sun_degrees = std::nan(""); });
  refused("orders", [](SkyTableOptions& o) { o.orders = 0; });
  refused("orders", [](SkyTableOptions& o) { o.orders = 65; });
  refused("until_change", [](SkyTableOptions& o) { o.until_change = -1.0; });
  refused("until_change", [](SkyTableOptions& o) { o.until_change = std::numeric_limits<double>::infinity(); });
  const ThrownError error = thrown_by([] {
    static_cast<void>(precompute_sky(earth({400.0, 500.0, 600.0, 700.0}), small_options()));
  });
  CHECK(error.code == ErrorCode::invalid_argument);
  CHECK(error.says("linear_srgb"));
}

}  // namespace welkin::test
