#include <algorithm>
#include <array>
#include <filesystem>
#include <fstream>
#include <memory>
#include <numeric>
#include <string>
#include <vector>

#include "benchmarks.h"
#include "files/row_source.h"
#include "subjects.h"
#include "welkin/environment_file.h"

namespace welkin::perf {
namespace {

constexpr int kWidth = 2048;
constexpr int kHeight = 1024;

struct Variant {
  const char* name;
  const char* extension;
  WriteOptions options;
};

constexpr std::array<Variant, 5> kVariants{{{"hdr", ".hdr", {}},
                                            {"exr-half-zip", ".exr", {Layout::automatic, SampleType::half}},
                                            {"exr-float-zip", ".exr", {Layout::automatic, SampleType::float32}},
                                            {"pfm", ".pfm", {}},
                                            {"png8", ".png", {}}}};

std::filesystem::path file_of(const Variant& variant) {
  return scratch_file(std::string(variant.name) + variant.extension, [&](const std::filesystem::path& path) {
    (void)write_environment(path, noise_lat_long(PixelFormat::rgb32f, kWidth, kHeight), variant.options);
  });
}

void read_bytes(const std::filesystem::path& path, std::vector<char>& block) {
  std::ifstream file(path, std::ios::binary);
  long sum = 0;
  while (file.read(block.data(), static_cast<std::streamsize>(block.size())) || file.gcount() > 0) {
    sum = std::accumulate(block.data(), block.data() + file.gcount(), sum);
  }
  benchmark::DoNotOptimize(sum);
}

/// The decoder alone: rows to floats in one thread, each block of them forgotten.
void decode(const std::filesystem::path& path, std::vector<float>& rgb) {
  const std::unique_ptr<files::RowSource> source = files::open_picture(path, ReadOptions{});
  const int rows = source->natural_rows() * std::max(1, 16 / source->natural_rows());
  rgb.resize(std::size_t{3} * kWidth * static_cast<std::size_t>(rows));
  const std::unique_ptr<files::RowReader> reader = source->open_reader();
  for (int row = 0; row < kHeight; row += rows) {
    reader->read(row, std::min(rows, kHeight - row), rgb.data());
    benchmark::DoNotOptimize(rgb.data());
  }
}

}  // namespace

void add_project_file(const std::vector<int>& thread_counts) {
  constexpr double texels = 1.0 * kWidth * kHeight;
  const std::string size = std::to_string(kWidth) + "x" + std::to_string(kHeight);
  for (const Variant& variant : kVariants) {
    for (const int threads : thread_counts) {
      add_benchmark("ProjectFile", variant.name, size, threads, texels, 12.0 * texels,
                    [&variant]() -> std::function<void()> {
                      const std::filesystem::path path = file_of(variant);
                      return [path] { benchmark::DoNotOptimize(project_file(path)); };
                    });
    }
    add_benchmark("DecodeFile", variant.name, size, 1, texels, 12.0 * texels, [&variant]() -> std::function<void()> {
      const std::filesystem::path path = file_of(variant);
      return [path, rgb = std::vector<float>()]() mutable { decode(path, rgb); };
    });
    add_benchmark("ReadFile", variant.name, size, 1, texels, 12.0 * texels, [&variant]() -> std::function<void()> {
      const std::filesystem::path path = file_of(variant);
      return [path, block = std::vector<char>(std::size_t{1} << 20U)]() mutable { read_bytes(path, block); };
    });
  }
}

}  // namespace welkin::perf
