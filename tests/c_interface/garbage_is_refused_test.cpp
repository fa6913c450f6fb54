// Structures full of noise: a status comes back, and nothing else happens.
#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <random>
#include <vector>

#include "c_interface/c_views.h"
#include "support/catch.h"
#include "support/test_environments.h"

namespace welkin::test {
namespace {

/// A structure in a buffer that is longer than any size that is believed, so that none is read past its end.
template <class Struct>
class Noisy {
 public:
  /// A sound one, up to two of whose first `words` words are overwritten by all kinds of numbers.
  Noisy(const Struct& sound, std::size_t words, std::mt19937& random) {
    std::memcpy(bytes_.data(), &sound, sizeof sound);
    std::uniform_int_distribution<std::size_t> place(0, words - 1);
    std::uniform_int_distribution<int> kind(0, 3);
    for (int changes = kind(random) - 1; changes > 0; --changes) {
      const std::array<std::uint32_t, 4> values{static_cast<std::uint32_t>(random()), 0xffffffffU, 0x80000000U,
                                                static_cast<std::uint32_t>(random() % 40)};
      std::memcpy(bytes_.data() + 4 * place(random), &values.at(static_cast<std::size_t>(kind(random))), 4);
    }
  }

  [[nodiscard]] Struct* get() { return reinterpret_cast<Struct*>(bytes_.data()); }

 private:
  alignas(Struct) std::array<std::byte, 2 * (sizeof(Struct) + 4096)> bytes_{};
};

}  // namespace

TEST_CASE("C: noise in structures is refused or harmless", "[c_interface]") {
  const unsigned seed = 20261121;
  INFO("seed " << seed);
  std::mt19937 random(seed);
  const auto picture = make_lat_long(Content::random, 8, 4, 1);
  // Dimensions stay: a larger picture than there is cannot be told from a good one.
  auto sound_view = c_view(picture.view());
  auto sound_options = c_struct<welkin_projection_options>();
  sound_options.bands = 2;
  constexpr std::size_t kOptionWords = sizeof(welkin_projection_options) / 4;
  constexpr std::size_t kViewWords = 2;  // struct_size, format
  constexpr std::size_t kPostWords = 2;  // struct_size, priority
  static std::atomic<long> released{0};
  auto sound_post = c_struct<welkin_post_options>();
  sound_post.release = [](void*) { released.fetch_add(1); };

  long owed = 0;
  int refused = 0;
  int done = 0;
  {
    const CWorker worker(1);
    for (int run = 0; run < 3000; ++run) {
      Noisy<welkin_projection_options> options(sound_options, kOptionWords, random);
      // Formats of more bytes would read past the picture: of its first half in f32, any other stays inside.
      sound_view.height = 2;
      Noisy<welkin_lat_long> view(sound_view, kViewWords, random);
      auto light = c_struct<welkin_projection>();
      light.struct_size = random() % 4 == 0 ? static_cast<std::uint32_t>(random() % sizeof light) : light.struct_size;
      const welkin_status status = welkin_project_lat_long(view.get(), options.get(), nullptr, &light);
      REQUIRE((status == WELKIN_OK || status == WELKIN_INVALID_ARGUMENT || status == WELKIN_REJECTED_PIXEL));
      (status == WELKIN_OK ? done : refused) += 1;

      Noisy<welkin_post_options> post(sound_post, kPostWords, random);
      const std::uint32_t size = post.get()->struct_size;
      const bool readable = size >= 8 && size % 8 == 0 && size <= sizeof(welkin_post_options) + 4096 &&
                            size >= offsetof(welkin_post_options, release_user);
      welkin_job* job = nullptr;
      const welkin_status posted =
          welkin_post_project_lat_long(worker.get(), view.get(), options.get(), post.get(), &job);
      REQUIRE((posted == WELKIN_OK || posted == WELKIN_INVALID_ARGUMENT));
      REQUIRE((job != nullptr) == (posted == WELKIN_OK));
      if (readable) ++owed;
      welkin_job_release(job);
    }
  }
  REQUIRE(refused > 500);
  REQUIRE(done > 500);
  REQUIRE(released.load() == owed);
}

}  // namespace welkin::test
