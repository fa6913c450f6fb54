// Radiance .hdr: RGBE, run-length encoded.
#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "files/write_environment.h"
#include "image/pixels.h"

namespace welkin::files {
namespace {

constexpr int kNarrowestEncoded = 8;
constexpr int kWidestEncoded = 32767;
constexpr std::size_t kLongestRun = 127;
constexpr std::size_t kLongestDump = 128;
constexpr std::size_t kShortestRun = 4;  // shorter ones cost as much as they save

using Rgbe = std::array<std::uint8_t, 4>;

/// The largest value: mantissa 255 at the largest exponent.
constexpr float kLargest = 0xFFp119F;

/// Encodes mantissas of 8 bits with a common exponent, value = mantissa 2^(exponent - 136) (Ward, "Real Pixels",
/// Graphics Gems II). Radiance truncates mantissas and adds half a step back when it reads; most other readers do not,
/// so mantissas are rounded to nearest here, which is off by at most half a step for these readers.
Rgbe encode(const float* rgb, std::uint64_t& clamped) {
  std::array<float, 3> values{};
  for (std::size_t c = 0; c < 3; ++c) values[c] = image::bounded(rgb[c], kLargest, clamped);
  const float largest = *std::max_element(values.begin(), values.end());
  int exponent = 0;
  std::frexp(largest, &exponent);  // largest = f 2^exponent, f in [0.5, 1)
  // 255.5 and more would round to 256, which needs the next exponent.
  if (std::ldexp(largest, 8 - exponent) >= 255.5F && exponent < 127) ++exponent;
  if (largest <= 0.0F || exponent < -127) return {0, 0, 0, 0};
  Rgbe result{};
  for (std::size_t c = 0; c < 3; ++c) {
    result[c] = static_cast<std::uint8_t>(std::floor(std::ldexp(values[c], 8 - exponent) + 0.5F));
  }
  result[3] = static_cast<std::uint8_t>(exponent + 128);
  return result;
}

std::size_t run_length(const std::vector<std::uint8_t>& values, std::size_t first) {
  const std::size_t end = std::min(values.size(), first + kLongestRun);
  std::size_t last = first + 1;
  while (last < end && values[last] == values[first]) ++last;
  return last - first;
}

/// Appends runs as 128 + length and the value, other values after their count.
void append_runs(const std::vector<std::uint8_t>& values, std::vector<std::uint8_t>& bytes) {
  std::size_t dumped = 0;  // values before this one are written
  const auto dump_up_to = [&](std::size_t end) {
    while (dumped < end) {
      const std::size_t count = std::min(kLongestDump, end - dumped);
      bytes.push_back(static_cast<std::uint8_t>(count));
      bytes.insert(bytes.end(), values.begin() + static_cast<std::ptrdiff_t>(dumped),
                   values.begin() + static_cast<std::ptrdiff_t>(dumped + count));
      dumped += count;
    }
  };
  for (std::size_t at = 0; at < values.size();) {
    const std::size_t run = run_length(values, at);
    if (run >= kShortestRun) {
      dump_up_to(at);
      bytes.push_back(static_cast<std::uint8_t>(128 + run));
      bytes.push_back(values[at]);
      dumped = at + run;
    }
    at += run;
  }
  dump_up_to(values.size());
}

/// Appends 2, 2 and the width, then the four components one after the other.
void append_encoded(const std::vector<Rgbe>& row, std::vector<std::uint8_t>& bytes) {
  bytes.insert(bytes.end(),
               {2, 2, static_cast<std::uint8_t>(row.size() >> 8U), static_cast<std::uint8_t>(row.size() & 0xFFU)});
  std::vector<std::uint8_t> component(row.size());
  for (std::size_t c = 0; c < 4; ++c) {
    std::transform(row.begin(), row.end(), component.begin(), [c](const Rgbe& texel) { return texel[c]; });
    append_runs(component, bytes);
  }
}

/// A flat texel of mantissas 1, 1, 1 would read as the old run-length form's repetition: a minimal change avoids it.
void append_flat(const std::vector<Rgbe>& row, std::vector<std::uint8_t>& bytes) {
  for (Rgbe texel : row) {
    if (texel[0] == 1 && texel[1] == 1 && texel[2] == 1) texel[2] = 2;
    bytes.insert(bytes.end(), texel.begin(), texel.end());
  }
}

}  // namespace

std::uint64_t write_hdr(const OutputImage& image, const WriteJob& job) {
  const int width = image.width();
  const std::string header = "#?RADIANCE\nSOFTWARE=Welkin\nFORMAT=32-bit_rle_rgbe\n\n-Y " +
                             std::to_string(image.height()) + " +X " + std::to_string(width) + "\n";
  job.file.write(header.data(), header.size());
  const bool encoded = width >= kNarrowestEncoded && width <= kWidestEncoded;
  std::uint64_t clamped = 0;
  std::vector<float> rgb(std::size_t{3} * static_cast<std::size_t>(width));
  std::vector<Rgbe> texels(static_cast<std::size_t>(width));
  std::vector<std::uint8_t> bytes;
  for (int row = 0; row < image.height(); ++row) {
    report_rows(job, row, image.height());
    image.read_row(row, rgb.data());
    for (std::size_t i = 0; i < texels.size(); ++i) texels[i] = encode(rgb.data() + 3 * i, clamped);
    bytes.clear();
    if (encoded) {
      append_encoded(texels, bytes);
    } else {
      append_flat(texels, bytes);
    }
    job.file.write(bytes.data(), bytes.size());
  }
  return clamped;
}

}  // namespace welkin::files
