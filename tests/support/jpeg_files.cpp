#include "support/jpeg_files.h"

#include <cmath>
#include <cstdio>
#include <cstdlib>
// This header requires the ones above.
#include <jpeglib.h>

namespace welkin::test {
namespace {

using namespace std::string_literals;

std::string big_endian(std::uint32_t value, int bytes = 4) {
  std::string text;
  for (int k = bytes - 1; k >= 0; --k) text.push_back(static_cast<char>(value >> (8 * k)));
  return text;
}

std::string decimal(double value) {
  std::array<char, 40> text{};
  std::snprintf(text.data(), text.size(), "%.17g", value);
  return text.data();
}

std::string property(const char* name, const std::vector<double>& values) {
  if (values.size() == 1) return "<hdrgm:"s + name + ">" + decimal(values[0]) + "</hdrgm:" + name + ">\n";
  std::string items;
  for (const double value : values) items += "<rdf:li>" + decimal(value) + "</rdf:li>\n";
  return "<hdrgm:"s + name + "><rdf:Seq>\n" + items + "</rdf:Seq></hdrgm:" + name + ">\n";
}

std::string attribute(const char* name, const std::vector<double>& values) {
  return "\n  hdrgm:"s + name + "=\"" + decimal(values[0]) + "\"";
}

double of_channel(const std::vector<double>& values, std::size_t channel) {
  return values[values.size() == 1 ? 0 : channel];
}

}  // namespace

std::vector<char> jpeg_bytes(const JpegRecipe& recipe, const std::vector<std::uint8_t>& samples) {
  jpeg_compress_struct compress{};
  jpeg_error_mgr errors{};
  compress.err = jpeg_std_error(&errors);
  jpeg_create_compress(&compress);
  unsigned char* bytes = nullptr;
  unsigned long count = 0;
  jpeg_mem_dest(&compress, &bytes, &count);
  compress.image_width = static_cast<JDIMENSION>(recipe.width);
  compress.image_height = static_cast<JDIMENSION>(recipe.height);
  compress.input_components = recipe.components;
  compress.in_color_space = recipe.components == 1 ? JCS_GRAYSCALE : recipe.components == 3 ? JCS_RGB : JCS_CMYK;
  jpeg_set_defaults(&compress);
  jpeg_set_quality(&compress, 100, TRUE);
  compress.comp_info[0].h_samp_factor = compress.comp_info[0].v_samp_factor = 1;
  if (recipe.progressive) jpeg_simple_progression(&compress);
  jpeg_start_compress(&compress, TRUE);
  for (const auto& [number, segment] : recipe.segments) {
    jpeg_write_marker(&compress, JPEG_APP0 + number, reinterpret_cast<const JOCTET*>(segment.data()),
                      static_cast<unsigned>(segment.size()));
  }
  const auto row_bytes = static_cast<std::size_t>(recipe.width) * static_cast<std::size_t>(recipe.components);
  for (std::size_t row = 0; row < static_cast<std::size_t>(recipe.height); ++row) {
    auto* texels = const_cast<JSAMPLE*>(samples.data() + row * row_bytes);
    jpeg_write_scanlines(&compress, &texels, 1);
  }
  jpeg_finish_compress(&compress);
  jpeg_destroy_compress(&compress);
  std::vector<char> file(bytes, bytes + count);
  std::free(bytes);  // allocated by libjpeg with malloc
  return file;
}

std::vector<std::uint8_t> jpeg_samples(const std::vector<char>& file) {
  jpeg_decompress_struct decompress{};
  jpeg_error_mgr errors{};
  decompress.err = jpeg_std_error(&errors);
  jpeg_create_decompress(&decompress);
  jpeg_mem_src(&decompress, reinterpret_cast<const unsigned char*>(file.data()), file.size());
  jpeg_read_header(&decompress, TRUE);
  jpeg_start_decompress(&decompress);
  const std::size_t row_bytes =
      std::size_t{decompress.output_width} * static_cast<std::size_t>(decompress.output_components);
  std::vector<std::uint8_t> samples(row_bytes * decompress.output_height);
  while (decompress.output_scanline < decompress.output_height) {
    JSAMPROW row = samples.data() + row_bytes * decompress.output_scanline;
    jpeg_read_scanlines(&decompress, &row, 1);
  }
  jpeg_finish_decompress(&decompress);
  jpeg_destroy_decompress(&decompress);
  return samples;
}

std::string gain_xmp(const GainNumbers& numbers) {
  const std::pair<const char*, const std::vector<double>*> all[] = {{"GainMapMin", &numbers.minimum},
                                                                    {"GainMapMax", &numbers.maximum},
                                                                    {"Gamma", &numbers.gamma},
                                                                    {"OffsetSDR", &numbers.base_offset},
                                                                    {"OffsetHDR", &numbers.alternate_offset}};
  std::string attributes, elements;
  for (const auto& [name, values] : all)
    (values->size() == 1 ? attributes : elements) +=
        values->size() == 1 ? attribute(name, *values) : property(name, *values);
  return "http://ns.adobe.com/xap/1.0/\0"s +
         "<x:xmpmeta xmlns:x=\"adobe:ns:meta/\"><rdf:RDF xmlns:rdf=\"http://www.w3.org/1999/02/22-rdf-syntax-ns#\">"
         "<rdf:Description rdf:about=\"\" xmlns:hdrgm=\"http://ns.adobe.com/hdr-gain-map/1.0/\"\n  "
         "hdrgm:Version=\"1.0\""
         "\n  hdrgm:BaseRenditionIsHDR=\"" +
         (numbers.base_is_hdr ? "True" : "False") + "\"" + attributes +
         "\n  hdrgm:HDRCapacityMin=\"0\"\n  hdrgm:HDRCapacityMax=\"4\">" + elements +
         "</rdf:Description></rdf:RDF></x:xmpmeta>";
}

std::string gain_iso(const GainNumbers& numbers, bool common_denominator) {
  constexpr std::uint32_t kDenominator = 1U << 20U;
  const bool three = numbers.maximum.size() == 3;
  const auto fraction = [&](double value) {
    const auto numerator = static_cast<std::uint32_t>(static_cast<std::int64_t>(std::llround(value * kDenominator)));
    return big_endian(numerator) + (common_denominator ? std::string() : big_endian(kDenominator));
  };
  std::string segment = "urn:iso:std:iso:ts:21496:-1\0"s + big_endian(0, 2) + big_endian(0, 2);
  segment.push_back(static_cast<char>((three ? 0x80 : 0) | 0x40 | (common_denominator ? 0x08 : 0)));
  if (common_denominator) segment += big_endian(kDenominator);
  segment += fraction(numbers.base_is_hdr ? 4.0 : 0.0) + fraction(numbers.base_is_hdr ? 0.0 : 4.0);
  for (std::size_t channel = 0; channel < (three ? 3U : 1U); ++channel) {
    for (const std::vector<double>* values :
         {&numbers.minimum, &numbers.maximum, &numbers.gamma, &numbers.base_offset, &numbers.alternate_offset}) {
      segment += fraction(of_channel(*values, channel));
    }
  }
  return segment;
}

std::string profile_segment(const std::array<std::array<double, 3>, 3>& colours) {
  std::string tags = big_endian(3), data;
  const std::size_t begin = 128 + 4 + 3 * 12;
  for (std::size_t channel = 0; channel < 3; ++channel) {
    tags += std::string(1, "rgb"[channel]) + "XYZ" + big_endian(static_cast<std::uint32_t>(begin + data.size())) +
            big_endian(20);
    data += "XYZ "s + big_endian(0);
    for (const double value : colours[channel]) {
      data += big_endian(static_cast<std::uint32_t>(static_cast<std::int32_t>(std::lround(value * 65536))));
    }
  }
  return "ICC_PROFILE\0\1\1"s + std::string(128, '\0') + tags + data;
}

std::vector<char> gain_map_file(const std::vector<char>& base, const std::vector<char>& map) {
  std::vector<char> file = base;
  file.insert(file.end(), map.begin(), map.end());
  return file;
}

std::vector<std::uint8_t> smooth_samples(int width, int height, int components) {
  std::vector<std::uint8_t> samples;
  for (int row = 0; row < height; ++row) {
    for (int column = 0; column < width; ++column) {
      for (int component = 0; component < components; ++component) {
        const double wave = std::sin(0.05 * column + component) * std::cos(0.07 * row - component);
        samples.push_back(static_cast<std::uint8_t>(std::lround(127.5 + 127.5 * wave)));
      }
    }
  }
  return samples;
}

}  // namespace welkin::test
