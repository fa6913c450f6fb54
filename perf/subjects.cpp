#include "perf.h"
#include "platform/memory.h"

namespace welkin::perf {
namespace {

/// Pixels of the last request, as floats or half floats between 0.5 and 1: exponents fixed, mantissas noise. Aligned to
/// a cache line, as engines align their images; lines that every load straddles would cost both sides of a ratio.
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

/// Returns `count` cubemaps: `different` distinct ones, repeated.
std::vector<CubemapView> noise_cubemaps(PixelFormat format, int size, std::size_t count, std::size_t different) {
  const auto face_texels = static_cast<std::size_t>(size) * static_cast<std::size_t>(size);
  const std::byte* const pixels = noise_pixels(format, 6 * face_texels * different);
  std::vector<CubemapView> views(count, CubemapView{{}, size, 0, format});
  for (std::size_t k = 0; k < 6 * count; ++k) {
    const std::size_t at = 6 * (k / 6 % different) + k % 6;
    views[k / 6].faces[k % 6] = pixels + at * face_texels * bytes_per_texel(format);
  }
  return views;
}

}  // namespace

Arguments::Arguments(const Paths& words, const std::vector<std::string>& known) {
  for (const std::filesystem::path& path : words) {
    const std::string word = path.string();
    const std::string option = word.substr(0, word.find('='));
    if (!word.starts_with("--")) {
      files.push_back(path);
    } else if (std::find(known.begin(), known.end(), option) == known.end()) {
      throw Error(ErrorCode::invalid_argument, "\"" + word + "\" is no option here");
    } else {
      values_[option] = word.substr(std::min(word.size(), option.size() + 1));
    }
  }
}

std::string Arguments::text(const std::string& option, const std::string& otherwise) const {
  const auto found = values_.find(option);
  return found == values_.end() ? otherwise : found->second;
}

double Arguments::value(const std::string& option, double otherwise) const {
  if (!has(option)) return otherwise;
  try {
    return std::stod(text(option));
  } catch (const std::exception&) {
    throw Error(ErrorCode::invalid_argument, option + " takes a number, not \"" + text(option) + '"');
  }
}

int Arguments::count(const std::string& option, int otherwise) const {
  return static_cast<int>(value(option, otherwise));
}

std::vector<std::string> Arguments::list(const std::string& option, const std::string& otherwise) const {
  std::vector<std::string> all;
  std::istringstream words(text(option, otherwise));
  for (std::string word; std::getline(words, word, ',');) all.push_back(word);
  return all;
}

Table::Table(const std::vector<std::string>& heads) {
  add(heads);
  text_ += '|';
  for (std::size_t k = 0; k < heads.size(); ++k) text_ += "---|";
  text_ += '\n';
  rows_ = 0;
}

void Table::add(const std::vector<std::string>& cells) {
  text_ += '|';
  for (const std::string& cell : cells) text_ += ' ' + cell + " |";
  text_ += '\n';
  ++rows_;
}

ProbeTargets::ProbeTargets(std::size_t count, int size, int mips) {
  const UploadLayout layout{.size = size, .levels = mips};
  memory.resize(count * upload_bytes(layout));
  for (std::size_t k = 0; k < count; ++k) {
    const auto probe = std::span(memory).subspan(k * upload_bytes(layout), upload_bytes(layout));
    for (const CubemapTarget& target : upload_targets(layout, probe)) targets.push_back(target);
  }
}

CubemapView noise_cubemap(PixelFormat format, int size) { return noise_cubemaps(format, size, 1, 1).front(); }

LatLongView noise_lat_long(PixelFormat format, int width, int height) {
  const std::byte* const pixels =
      noise_pixels(format, static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
  return {.pixels = pixels, .width = width, .height = height, .row_stride_bytes = 0, .format = format};
}

std::vector<CubemapView> noise_probes(std::size_t count, std::size_t different) {
  return noise_cubemaps(PixelFormat::rgba16f, 64, count, different);
}

void add_benchmark(const std::string& subject, const std::string& variant, const std::string& size,
                   std::span<const int> threads, double texels, double bytes,
                   const std::function<std::function<void()>()>& prepare) {
  for (const int count : threads) {
    const std::string full_name = subject + "/" + variant + "/" + size + "/" + std::to_string(count);
    benchmark::RegisterBenchmark(full_name.c_str(), [=](benchmark::State& state) {
      const std::function<void()> body = prepare();
      run_with_threads(count, [&] {
        body();  // tables, pages and threads are warm
        for (auto _ : state) body();
      });
      const auto iterations = static_cast<double>(state.iterations());
      state.counters["bytes/s"] = benchmark::Counter(bytes * iterations, benchmark::Counter::kIsRate);
      state.counters["s/texel"] =
          benchmark::Counter(texels * iterations, benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
    })->UseRealTime();
  }
}

std::shared_ptr<const LatLongImage> sky_image(const SkyImageOptions& options) {
  static std::shared_ptr<const LatLongImage> kept;
  static SkyImageOptions kept_options;
  if (kept && kept_options == options) return kept;
  const int width = options.width;
  const int height = width / 2;
  auto drawn = std::make_shared<LatLongImage>(LatLongImage{width, height, {}});
  drawn->pixels.reserve(std::size_t{3} * static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
  std::uint32_t state = 1;
  for (int row = 0; row < height; ++row) {
    for (int column = 0; column < width; ++column) {
      const double x = 2.0 * std::numbers::pi * column / width;
      const double y = std::numbers::pi * row / height;
      state = state * 1664525U + 1013904223U;
      const double grain = options.grain * static_cast<double>(state >> 8U) / (1U << 24U);
      const double clouds = 0.3 * std::sin(5.0 * x) * std::sin(3.0 * y) + 0.15 * std::sin(23.0 * x + 11.0 * y) +
                            0.08 * std::sin(71.0 * x) * std::sin(67.0 * y);
      const double light = (row < height / 2 ? 1.0 : 0.3) + clouds * std::sin(y);
      const double away = 360.0 / width * std::hypot((column - 0.29326 * width) * std::sin(y), row - 0.1666 * width);
      const bool sun = options.sun > 0.0 && away < 0.53;
      const double tint = 0.5 + 0.4 * std::sin(2.0 * x + 3.0 * y);
      for (const double share : {1.0, tint, 1.0 - 0.5 * tint})
        drawn->pixels.push_back(static_cast<float>(sun ? options.sun * share : light * share + grain));
    }
  }
  kept_options = options;
  return kept = drawn;
}

std::shared_ptr<const SkyTables> earth_tables() {
  static const std::shared_ptr<const SkyTables> tables = [] {
    SkyTableOptions options;
    options.orders = 2;
    return std::make_shared<const SkyTables>(precompute_sky(earth_bruneton(), options));
  }();
  return tables;
}

std::filesystem::path scratch_file(const std::string& name,
                                   const std::function<void(const std::filesystem::path&)>& write) {
  static const report::TemporaryFolder folder;
  std::filesystem::path path = folder.path() / name;
  if (!std::filesystem::exists(path)) write(path);
  return path;
}

std::chrono::nanoseconds Samples::quantile(double share) const {
  std::vector<std::chrono::nanoseconds> sorted = times_;
  std::sort(sorted.begin(), sorted.end());
  const auto rank = static_cast<std::size_t>(std::ceil(share * static_cast<double>(sorted.size())));
  return sorted[std::clamp<std::size_t>(rank, 1, sorted.size()) - 1];
}

void Samples::report(benchmark::State& state) const {
  state.counters["median_us"] = microseconds(0.5);
  state.counters["p99_us"] = microseconds(0.99);
  state.counters["max_us"] = microseconds(1.0);
}

}  // namespace welkin::perf
