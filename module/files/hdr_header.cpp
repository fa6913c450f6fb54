#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <string_view>

#include "files/hdr.h"
#include "files/row_source.h"
#include "platform/text.h"

namespace welkin::files {
namespace {

using namespace std::string_view_literals;

[[noreturn]] void fail(const platform::ByteFile& file, const std::string& message) {
  throw platform::file_error(ErrorCode::corrupt_file, file.path(), message);
}

std::string quoted(std::string_view text) { return "\"" + platform::printable(std::string(text)) + "\""; }

std::string_view without_leading_space(std::string_view text) {
  return text.substr(std::min(text.find_first_not_of(" \t"), text.size()));
}

// Reads the lines of the header's text, from the file's first byte on.
class HeaderLines {
 public:
  explicit HeaderLines(platform::ByteFile& file) : file_(file) {
    text_.resize(std::min<std::uint64_t>(file.remaining(), kLongestHdrHeader));
    file.read(text_.data(), text_.size());
  }

  // Returns the next line without its end, "\n" or "\r\n".
  std::string_view next() {
    const std::size_t end = text_.find('\n', place_);
    if (end == std::string::npos) {
      fail(file_, text_.size() < kLongestHdrHeader
                      ? "ends within its Radiance header; fetch or export it again"
                      : "its Radiance header has no end within " + std::to_string(kLongestHdrHeader) +
                            " bytes; is it a Radiance image?");
    }
    std::string_view line = std::string_view(text_).substr(place_, end - place_);
    place_ = end + 1;
    if (line.ends_with('\r')) {
      line.remove_suffix(1);
    }
    return line;
  }

  [[nodiscard]] std::uint64_t position() const { return place_; }

 private:
  const platform::ByteFile& file_;
  std::string text_;
  std::size_t place_ = 0;
};

// Parses exactly as many numbers as `numbers` holds, separated by white space, and nothing after them.
template <std::size_t Count>
std::array<double, Count> read_numbers(const platform::ByteFile& file, std::string_view line, std::string_view value) {
  std::array<double, Count> numbers{};
  for (double& number : numbers) {
    value = without_leading_space(value);
    value.remove_prefix(value.starts_with('+') ? 1 : 0);
    const auto [stop, failure] = platform::from_chars(value.data(), value.data() + value.size(), number);
    if (failure != std::errc{} || !std::isfinite(number)) {
      fail(file, "its Radiance header's line " + quoted(line) + " should have " + std::to_string(Count) + " number" +
                     (Count == 1 ? "" : "s") + "; correct or remove it");
    }
    value.remove_prefix(static_cast<std::size_t>(stop - value.data()));
  }
  if (!without_leading_space(value).empty()) {
    fail(file, "its Radiance header's line " + quoted(line) + " has more than " + std::to_string(Count) + " number" +
                   (Count == 1 ? "" : "s") + "; correct or remove it");
  }
  return numbers;
}

// Exposures are positive, and so must their product be: pixels are divided by it.
void multiply_divisor(const platform::ByteFile& file, HdrHeader& header, std::string_view line,
                      const glm::dvec3& factor) {
  header.divisor *= factor;
  for (int channel = 0; channel < 3; ++channel) {
    if (!(factor[channel] > 0.0 && header.divisor[channel] >= 1e-30 && header.divisor[channel] <= 1e30)) {
      fail(file, "its Radiance header's line " + quoted(line) +
                     " leaves no radiance to find: stored values are divided by it (with all others of its kind), and "
                     "that must lie from 1e-30 to 1e30; correct or remove it");
    }
  }
}

void read_format(const platform::ByteFile& file, HdrHeader& header, std::string_view value) {
  value = without_leading_space(value);
  value = value.substr(0, value.find_last_not_of(" \t") + 1);
  if (value != "32-bit_rle_rgbe" && value != "32-bit_rle_xyze") {
    throw platform::file_error(
        ErrorCode::unsupported_file, file.path(),
        "its Radiance format is " + quoted(value) +
            "; 32-bit_rle_rgbe and 32-bit_rle_xyze are read: convert it with Radiance's ra_xyze or pcomb");
  }
  header.xyz = value == "32-bit_rle_xyze";
}

void read_primaries(const platform::ByteFile& file, HdrHeader& header, std::string_view line, std::string_view value) {
  const auto numbers = read_numbers<8>(file, line, value);
  // Photoshop writes eight zeros, which have no meaning, into every file.
  if (std::any_of(numbers.begin(), numbers.end(), [](double number) { return number != 0.0; })) {
    const auto& [rx, ry, gx, gy, bx, by, wx, wy] = numbers;
    header.primaries = Chromaticities{{rx, ry}, {gx, gy}, {bx, by}, {wx, wy}};
  }
}

void read_line(const platform::ByteFile& file, HdrHeader& header, std::string_view line) {
  const auto value_of = [&](std::string_view name) -> std::optional<std::string_view> {
    return line.starts_with(name) ? std::optional(line.substr(name.size())) : std::nullopt;
  };
  if (const auto format = value_of("FORMAT="sv)) {
    read_format(file, header, *format);
  } else if (const auto exposure = value_of("EXPOSURE="sv)) {
    // Filament's cmgen writes EXPOSURE=0, in stops, into every file.
    const double factor = read_numbers<1>(file, line, *exposure)[0];
    if (factor != 0.0) multiply_divisor(file, header, line, glm::dvec3(factor));
  } else if (const auto correction = value_of("COLORCORR="sv)) {
    const auto numbers = read_numbers<3>(file, line, *correction);
    multiply_divisor(file, header, line, {numbers[0], numbers[1], numbers[2]});
  } else if (const auto primaries = value_of("PRIMARIES="sv)) {
    read_primaries(file, header, line, *primaries);
  } else if (const auto gamma = value_of("GAMMA="sv)) {
    // Photoshop writes GAMMA=1. No program that reads Radiance files applies another one.
    const std::string_view said = without_leading_space(*gamma);
    header.gamma = said == "1" || said == "1.0" ? "" : platform::printable(std::string(said));
  }
}

int read_extent(const platform::ByteFile& file, std::string_view line, const char* what, std::string_view& text,
                int maximum) {
  text = without_leading_space(text);
  long long value = 0;
  const auto [stop, failure] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (failure == std::errc::invalid_argument || (failure == std::errc{} && value < 1)) {
    fail(file,
         std::string("its Radiance ") + what + " is not a positive number, in the resolution line " + quoted(line));
  }
  if (failure != std::errc{} || value > maximum) {
    throw platform::file_error(ErrorCode::unsupported_file, file.path(),
                               std::string("its Radiance ") + what + " is above " + std::to_string(maximum) +
                                   ", in the resolution line " + quoted(line) + "; reduce the image first");
  }
  text.remove_prefix(static_cast<std::size_t>(stop - text.data()));
  return static_cast<int>(value);
}

// The first axis is the one that changes from scanline to scanline. Each axis is marked with its direction: +X to the
// right, +Y up.
void read_resolution(const platform::ByteFile& file, HdrHeader& header, std::string_view line) {
  std::string_view text = line;
  std::string axes;
  for (int axis = 0; axis < 2; ++axis) {
    text = without_leading_space(text);
    const char sign = text.size() > 1 ? text[0] : ' ';
    const char letter = text.size() > 1 ? text[1] : ' ';
    if ((sign != '+' && sign != '-') || (letter != 'X' && letter != 'Y') || axes == std::string(1, letter)) {
      fail(file, "its Radiance resolution line is " + quoted(line) +
                     "; it should be like \"-Y 512 +X 1024\", after an empty line");
    }
    axes += letter;
    text.remove_prefix(2);
    if (letter == 'X') {
      header.right_first = sign == '-';
      header.width = read_extent(file, line, "width", text, kMaximumWidth);
    } else {
      header.bottom_first = sign == '+';
      header.height = read_extent(file, line, "height", text, kMaximumHeight);
    }
  }
  if (!without_leading_space(text).empty()) {
    fail(file, "its Radiance resolution line is " + quoted(line) + ", with something behind the two numbers");
  }
  header.columns = axes.front() == 'X';
}

std::string divided_by(const glm::dvec3& divisor) {
  const std::string red = platform::number_text(divisor.r);
  const bool same = divisor.r == divisor.g && divisor.g == divisor.b;
  return same ? red : red + " " + platform::number_text(divisor.g) + " " + platform::number_text(divisor.b);
}

}  // namespace

HdrHeader read_hdr_header(platform::ByteFile& file) {
  HdrHeader header;
  HeaderLines lines(file);
  for (std::string_view line = lines.next(); !line.empty(); line = lines.next()) {
    read_line(file, header, line);
  }
  read_resolution(file, header, lines.next());
  header.first_byte = lines.position();
  if (!header.gamma.empty()) {
    header.notes.push_back("GAMMA=" + header.gamma + " is ignored: values are taken as linear");
  }
  if (header.divisor != glm::dvec3(1.0)) {
    header.notes.push_back("stored values were divided by " + divided_by(header.divisor) +
                           ", the product of the header's EXPOSURE and COLORCORR lines");
  }
  return header;
}

}  // namespace welkin::files
