#include "subjects.h"

#include <cstdint>
#include <cstring>

#include "platform/memory.h"
#include "welkin/core.h"

namespace welkin::perf {
namespace {

/// Pixels of the last request, as floats or halves between 0.5 and 1: exponents fixed, mantissas noise.
/// On a cache line, as engines align their images; a line that every load straddles would cost both sides
/// of a ratio.
const std::byte* noise_pixels(PixelFormat format, std::size_t texels) {
  static platform::AlignedBuffer<std::byte> pixels;
  static PixelFormat pixels_format{};
  const std::size_t bytes = texels * bytes_per_texel(format);
  if (pixels.size() == bytes && pixels_format == format) return pixels.data();
  pixels = {};  // freed before the next one is allocated
  pixels = platform::AlignedBuffer<std::byte>(bytes);
  pixels_format = format;
  const bool half = format == PixelFormat::rgb16f || format == PixelFormat::rgba16f;
  const bool single = format == PixelFormat::rgb32f || format == PixelFormat::rgba32f;
  std::uint32_t state = 1;
  for (std::size_t at = 0; at + 4 <= bytes; at += 4) {
    state = state * 1664525U + 1013904223U;
    std::uint32_t value = state;
    if (single) value = 0x3F000000U | (state >> 9U);
    if (half) value = 0x38003800U | (state & 0x03FF03FFU);
    std::memcpy(pixels.data() + at, &value, 4);
  }
  return pixels.data();
}

}  // namespace

CubemapView noise_cubemap(PixelFormat format, int size) {
  const auto face_texels = static_cast<std::size_t>(size) * static_cast<std::size_t>(size);
  const std::byte* const pixels = noise_pixels(format, 6 * face_texels);
  CubemapView view{.faces = {}, .size = size, .row_stride_bytes = 0, .format = format};
  for (std::size_t face = 0; face < 6; ++face) view.faces[face] = pixels + face * face_texels * bytes_per_texel(format);
  return view;
}

LatLongView noise_lat_long(PixelFormat format, int width, int height) {
  const std::byte* const pixels =
      noise_pixels(format, static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
  return {.pixels = pixels, .width = width, .height = height, .row_stride_bytes = 0, .format = format};
}

void add_benchmark(const std::string& subject, const std::string& variant, const std::string& size, int threads,
                   double texels, double bytes, const std::function<std::function<void()>()>& prepare) {
  const std::string full_name = subject + "/" + variant + "/" + size + "/" + std::to_string(threads);
  benchmark::RegisterBenchmark(full_name.c_str(), [=](benchmark::State& state) {
    const std::function<void()> body = prepare();
    run_with_threads(threads, [&] {
      body();  // tables, pages and threads are warm
      for (auto _ : state) body();
    });
    const auto iterations = static_cast<double>(state.iterations());
    state.counters["bytes/s"] = benchmark::Counter(bytes * iterations, benchmark::Counter::kIsRate);
    state.counters["s/texel"] =
        benchmark::Counter(texels * iterations, benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
  })->UseRealTime();
}

}  // namespace welkin::perf
