// JPEG with a gain map (Ultra HDR, ISO 21496-1) as rows of linear light.
#include "files/jpeg.h"

#include <algorithm>
#include <cmath>
#include <glm/mat3x3.hpp>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "files/codecs.h"
#include "files/layout.h"
#include "files/primaries.h"
#include "files/row_source.h"
#include "image/pixels.h"
#include "math/elementary.h"
#include "platform/file.h"
#include "platform/text.h"

namespace welkin::files {
namespace {

/// The factors 2^gain of samples of 8 bits, and of values between them.
class GainCurve {
 public:
  explicit GainCurve(const GainMap& map) {
    constexpr double kLogarithmOf2 = 0.69314718055994530942;
    for (std::size_t channel = 0; channel < 3; ++channel) {
      minimum_[channel] = map.minimum[channel] * kLogarithmOf2;
      range_[channel] = (map.maximum[channel] - map.minimum[channel]) * kLogarithmOf2;
      exponent_[channel] = 1.0 / map.gamma[channel];
    }
  }

  /// Returns the factor of a channel's sample, 0 to 255: the same bits on every machine.
  [[nodiscard]] double factor(std::size_t channel, double sample) const noexcept {
    double share = sample / 255.0;
    if (exponent_[channel] != 1.0 && share > 0.0) {
      share = math::exponential(exponent_[channel] * math::logarithm(share));
    }
    return math::exponential(minimum_[channel] + range_[channel] * share);
  }

 private:
  std::array<double, 3> minimum_{}, range_{}, exponent_{};  // in natural logarithms
};

/// The two images of a file, and the conversion of the base's samples to light.
struct Pair {
  JpegSegments base, map;
  std::array<float, 256> light{};  ///< of the base's samples
  std::optional<glm::dmat3> matrix;
};

/// Rows of a gain map, stretched over the base image. Texels are areas of both. Between the centres of the map's texels
/// its samples are interpolated linearly, as graphics hardware does; beyond the outer centres they are constant.
class GainRows {
 public:
  GainRows(const FileInput& input, const Pair& pair)
      : pair_(pair),
        decoder_(input, pair.map),
        curve_(*pair.map.gain_map),
        upper_(decoder_.row_bytes()),
        lower_(upper_) {
    decoder_.decode_row(lower_.data());
    upper_ = lower_;
  }

  /// Writes the factors for a row of the base image, three per texel. Rows are requested from the top.
  void factors(int row, float* rgb) {
    const TwoSamples vertical = samples_around(row, pair_.base.height, pair_.map.height);
    while (next_ <= vertical.second) {
      std::swap(upper_, lower_);
      decoder_.decode_row(lower_.data());
      ++next_;
    }
    // `lower_` is row next_ - 1: the second one, or in the last rows the first one too.
    const std::vector<std::uint8_t>& first = vertical.first == next_ - 1 ? lower_ : upper_;
    const auto channels = static_cast<std::size_t>(pair_.map.components);
    for (int column = 0; column < pair_.base.width; ++column, rgb += 3) {
      const TwoSamples across = samples_around(column, pair_.base.width, pair_.map.width);
      const std::size_t left = channels * static_cast<std::size_t>(across.first);
      const std::size_t right = channels * static_cast<std::size_t>(across.second);
      for (std::size_t channel = 0; channel < 3; ++channel) {
        const std::size_t of = channel < channels ? channel : 0;
        const double above = mixed(first[left + of], first[right + of], across.share);
        const double below = mixed(lower_[left + of], lower_[right + of], across.share);
        rgb[channel] = static_cast<float>(curve_.factor(channel, above + (below - above) * vertical.share));
      }
    }
  }

 private:
  struct TwoSamples {
    int first, second;
    double share;  ///< of the second
  };

  static TwoSamples samples_around(int texel, int texels, int samples) {
    const double at = (texel + 0.5) * samples / texels - 0.5;
    const double within = std::clamp(at, 0.0, samples - 1.0);
    const int first = std::min(static_cast<int>(within), samples - 1);
    return {first, std::min(first + 1, samples - 1), within - first};
  }

  static double mixed(double a, double b, double share) { return a + (b - a) * share; }

  const Pair& pair_;
  JpegDecoder decoder_;
  GainCurve curve_;
  std::vector<std::uint8_t> upper_, lower_;
  int next_ = 1;  // row of the map that is decoded next
};

class JpegReader final : public SequentialReader {
 public:
  JpegReader(const FileInput& input, const Pair& pair) : SequentialReader(pair.base.width), input_(input), pair_(pair) {
    open();
  }

 private:
  void restart() override { open(); }

  void open() {
    base_ = std::make_unique<JpegDecoder>(input_, pair_.base);
    gains_ = std::make_unique<GainRows>(input_, pair_);
    coded_.resize(base_->row_bytes());
  }

  void next(int row, float* rgb) override {
    base_->decode_row(coded_.data());
    if (rgb == nullptr) return;
    gains_->factors(row, rgb);
    apply(rgb);
  }

  // From factors to light.
  void apply(float* rgb) const {
    const GainMap& map = *pair_.map.gain_map;
    const auto channels = static_cast<std::size_t>(pair_.base.components);
    for (int column = 0; column < pair_.base.width; ++column, rgb += 3) {
      for (std::size_t channel = 0; channel < 3; ++channel) {
        const std::uint8_t code =
            coded_[channels * static_cast<std::size_t>(column) + (channel < channels ? channel : 0)];
        const double light =
            (pair_.light[code] + map.base_offset[channel]) * rgb[channel] - map.alternate_offset[channel];
        rgb[channel] = static_cast<float>(light);
      }
    }
    if (pair_.matrix)
      files::apply(*pair_.matrix, rgb - 3 * pair_.base.width, static_cast<std::size_t>(pair_.base.width));
  }

  const FileInput& input_;  // of the source
  const Pair& pair_;
  std::unique_ptr<JpegDecoder> base_;
  std::unique_ptr<GainRows> gains_;
  std::vector<std::uint8_t> coded_;
};

RowTraits jpeg_traits(const Pair& pair) {
  RowTraits traits{.sequential = true};
  traits.reader_bytes = JpegDecoder::memory_bytes(pair.base) + JpegDecoder::memory_bytes(pair.map) +
                        2 * rgb_bytes(pair.map.width, 1) + rgb_bytes(pair.base.width, 1);
  if (pair.base.buffered || pair.map.buffered) {
    traits.smaller_reader = "save it as a baseline JPEG: as it is, it must be decoded whole";
  }
  return traits;
}

[[noreturn]] void refuse(const std::filesystem::path& path, const std::string& reason) {
  throw platform::file_error(ErrorCode::unsupported_file, path, reason);
}

/// Returns the base image and the first gain map after it. Throws `Error` (unsupported_file) if there is none, or if
/// the base is already the HDR image.
Pair pair_of(platform::ByteFile& file) {
  const std::vector<JpegSegments> images = jpeg_images(file);
  const auto map = std::find_if(images.begin() + 1, images.end(), [](const JpegSegments& one) { return one.gain_map; });
  if (map == images.end()) {
    refuse(file.path(),
           images.size() > 1
               ? "is a JPEG without a gain map that is known: its second image has no metadata of Ultra HDR "
                 "or ISO 21496-1; export it as Ultra HDR, OpenEXR or Radiance .hdr"
               : "is a JPEG without a gain map: 8 bits hold no light brighter than white, so a bake of it "
                 "would be dim; use the HDR original, as Ultra HDR, OpenEXR or Radiance .hdr");
  }
  if (!map->gain_map->from_base) {
    refuse(file.path(),
           "is a JPEG whose gain map leads down to an ordinary image; export it as Ultra HDR, OpenEXR or "
           "Radiance .hdr");
  }
  return {images[0], *map, {}, {}};
}

void tell_gains(EnvironmentInfo& info, const JpegSegments& map) {
  const GainMap& gains = *map.gain_map;
  const auto [minimum, maximum] = std::pair(*std::min_element(gains.minimum.begin(), gains.minimum.end()),
                                            *std::max_element(gains.maximum.begin(), gains.maximum.end()));
  const auto text = [](double stops) { return platform::number_text(stops, std::chars_format::general, 4); };
  info.notes.push_back("its gain map of " + std::to_string(map.width) + " x " + std::to_string(map.height) +
                       " texels, " + (map.components == 1 ? "grey, " : "in colour, ") + text(minimum) + " to " +
                       text(maximum) + " stops, is applied in full, as " +
                       (gains.by_iso ? "ISO 21496-1 states" : "Ultra HDR's XMP states"));
}

std::optional<glm::dmat3> matrix_of(const JpegSegments& base, Primaries wanted, EnvironmentInfo& info) {
  if (base.has_other_profile) info.notes.emplace_back("its ICC profile is not applied: it has no three primaries");
  if (!base.primaries) return std::nullopt;
  return rec709_from_stated(*base.primaries, "its ICC profile", wanted, info);
}

}  // namespace

std::unique_ptr<RowSource> open_jpeg(platform::ByteFile& file, const ReadOptions& options) {
  Pair pair = pair_of(file);
  EnvironmentInfo info;
  info.path = file.path();
  info.format = FileFormat::jpeg;
  info.compression = "discrete cosine transform";
  info.storage = pair.base.buffered ? "progressive" : "scanline";
  info.width = pair.base.width;
  info.height = pair.base.height;
  add_channels(info, pair.base.components == 1 ? "Y" : "RGB", ChannelType::uint8);
  tell_gains(info, pair.map);
  const bool linear = options.transfer == Transfer::linear;
  if (linear) info.notes.emplace_back("samples are read as linear, as requested");
  for (std::size_t code = 0; code < pair.light.size(); ++code) {
    const double encoded = static_cast<double>(code) / 255.0;
    pair.light[code] = static_cast<float>(linear ? encoded : image::linear_from_srgb(encoded));
  }
  pair.matrix = matrix_of(pair.base, options.primaries, info);
  decide_layout(info, options.layout, std::nullopt);
  const auto open = [input = input_of(file), pair] { return std::make_unique<JpegReader>(input, pair); };
  return std::make_unique<RowSource>(std::move(info), jpeg_traits(pair), open);
}

}  // namespace welkin::files
