// PFM: little-endian floats, rows from bottom to top. Values are not changed.
#include "files/pfm.h"

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstring>
#include <string>
#include <utility>
#include <vector>

#include "files/layout.h"
#include "files/write_environment.h"
#include "platform/text.h"

namespace welkin::files {
namespace {

// Longer than any number in a valid header; a file without white space is not searched to its end.
constexpr std::size_t kLongestToken = 32;
constexpr int kLongestGap = 256;

struct PfmImage {
  bool grey = false;
  bool swapped = false;  // the file's byte order differs from the machine's
  std::uint64_t first_byte = 0;

  [[nodiscard]] int channels() const { return grey ? 1 : 3; }
};

bool is_space(char c) { return c == ' ' || c == '\t' || c == '\n' || c == '\r'; }

[[noreturn]] void damaged(const platform::ByteFile& file, const std::string& what) {
  throw platform::file_error(ErrorCode::corrupt_file, file.path(), what);
}

// Reads the next token, and the one white space that ends it: the pixels may follow directly.
std::string read_token(platform::ByteFile& file, const char* what) {
  std::string token;
  char c = ' ';
  for (int gap = 0; is_space(c); ++gap) {
    if (gap > kLongestGap) {
      damaged(file, std::string("its PFM header has no ") + what);
    }
    file.read(&c, 1);
  }
  for (; !is_space(c); file.read(&c, 1)) {
    token += c;
    if (token.size() > kLongestToken) {
      damaged(file,
              std::string("its PFM header's ") + what + " is not a number: \"" + platform::printable(token) + "...\"");
    }
  }
  return token;
}

template <typename Number>
Number read_number(platform::ByteFile& file, const char* what) {
  const std::string token = read_token(file, what);
  const char* begin = token.data() + (token.front() == '+' ? 1 : 0);
  const char* end = token.data() + token.size();
  Number value{};
  const auto [stop, failure] = platform::from_chars(begin, end, value);
  if (failure != std::errc{} || stop != end) {
    damaged(file, std::string("its PFM header's ") + what + " is not a number: \"" + platform::printable(token) + "\"");
  }
  return value;
}

int read_extent(platform::ByteFile& file, const char* what, int maximum) {
  const auto value = read_number<long long>(file, what);
  if (value < 1) {
    damaged(file, std::string("its PFM header's ") + what + " is " + std::to_string(value));
  }
  if (value > maximum) {
    throw platform::file_error(ErrorCode::unsupported_file, file.path(),
                               std::string("its ") + what + " of " + std::to_string(value) + " is above " +
                                   std::to_string(maximum) + "; reduce the image first");
  }
  return static_cast<int>(value);
}

bool read_is_little_endian(platform::ByteFile& file) {
  const auto scale = read_number<double>(file, "scale");
  if (scale == 0.0 || !std::isfinite(scale)) {
    damaged(file, "its PFM header's scale is 0 or not finite, so the byte order is unknown; -1 means little-endian");
  }
  return scale < 0.0;
}

// Skips a '\n' after a header whose lines end with "\r\n": it would be taken for the first byte of the pixels, all of
// which would then be read a byte off. If the file's length allows exactly that byte, it is the header's.
void pass_second_line_end(platform::ByteFile& file, std::uint64_t pixel_bytes) {
  if (file.remaining() != pixel_bytes + 1) return;
  const std::uint64_t first_byte = file.position();
  std::array<char, 2> ends{};
  file.seek(first_byte - 1);
  file.read(ends.data(), ends.size());
  file.seek(ends == std::array{'\r', '\n'} ? first_byte + 1 : first_byte);
}

void swap_bytes(float* values, std::size_t count) {
  for (std::size_t i = 0; i < count; ++i) {
    std::array<char, 4> bytes{};
    std::memcpy(bytes.data(), values + i, 4);
    std::reverse(bytes.begin(), bytes.end());
    std::memcpy(values + i, bytes.data(), 4);
  }
}

class PfmReader final : public RowReader {
 public:
  PfmReader(const FileInput& input, const PfmImage& image, int width, int height)
      : image_(image), width_(static_cast<std::size_t>(width)), height_(height), file_(open_file(input)) {}

  // Rows lie in the file from bottom to top: the last requested row comes first.
  void read(int first_row, int row_count, float* rgb) override {
    const std::size_t stored = width_ * static_cast<std::size_t>(image_.channels());
    const auto rows_before = static_cast<std::uint64_t>(height_ - first_row - row_count);
    file_.seek(image_.first_byte + rows_before * stored * sizeof(float));
    for (int row = row_count - 1; row >= 0; --row) {
      float* texels = rgb + static_cast<std::size_t>(row) * width_ * 3;
      // A grey row is read into the last third of its memory and spread from the left: no value is overwritten before
      // it was used.
      float* values = image_.grey ? texels + 2 * width_ : texels;
      file_.read(values, stored * sizeof(float));
      if (image_.swapped) {
        swap_bytes(values, stored);
      }
      if (image_.grey) {
        for (std::size_t column = 0; column < width_; ++column) {
          const float grey = values[column];
          std::fill_n(texels + 3 * column, 3, grey);
        }
      }
    }
  }

 private:
  PfmImage image_;
  std::size_t width_;
  int height_;
  platform::ByteFile file_;
};

}  // namespace

std::unique_ptr<RowSource> open_pfm(platform::ByteFile& file, const ReadOptions& options) {
  PfmImage image;
  const std::string kind = read_token(file, "kind");
  if (kind != "PF" && kind != "Pf") {
    throw platform::file_error(
        ErrorCode::unsupported_file, file.path(),
        "starts with \"" + platform::printable(kind) + "\"; PFM files start with PF (colour) or Pf (grey)");
  }
  image.grey = kind == "Pf";

  EnvironmentInfo info;
  info.path = file.path();
  info.format = FileFormat::pfm;
  info.compression = "none";
  info.storage = "scanline";
  info.width = read_extent(file, "width", kMaximumWidth);
  info.height = read_extent(file, "height", kMaximumHeight);
  image.swapped = read_is_little_endian(file) != (std::endian::native == std::endian::little);
  const std::uint64_t wanted = rgb_bytes(info.width, info.height) / 3 * static_cast<std::uint64_t>(image.channels());
  pass_second_line_end(file, wanted);
  image.first_byte = file.position();
  add_channels(info, image.grey ? "Y" : "RGB", ChannelType::float32);

  if (wanted > file.remaining()) {
    damaged(file, "ends too early: " + std::to_string(info.width) + " x " + std::to_string(info.height) +
                      " texels take " + std::to_string(wanted) + " bytes, " + std::to_string(file.remaining()) +
                      " follow the header; fetch or export it again");
  }
  decide_layout(info, options.layout, std::nullopt);
  const auto open = [input = input_of(file), image, width = info.width, height = info.height] {
    return std::make_unique<PfmReader>(input, image, width, height);
  };
  return std::make_unique<RowSource>(std::move(info), RowTraits{.reader_bytes = std::uint64_t{64} << 10U}, open);
}

static_assert(std::endian::native == std::endian::little, "rows are written as they lie in memory");

std::uint64_t write_pfm(const OutputImage& image, const WriteJob& job) {
  const std::string header = "PF\n" + std::to_string(image.width()) + " " + std::to_string(image.height()) + "\n-1.0\n";
  job.file.write(header.data(), header.size());
  std::vector<float> row(std::size_t{3} * static_cast<std::size_t>(image.width()));
  for (int done = 0; done < image.height(); ++done) {
    report_rows(job, done, image.height());
    image.read_row(image.height() - 1 - done, row.data());
    job.file.write(row.data(), row.size() * sizeof(float));
  }
  return 0;
}

}  // namespace welkin::files
