#include "codec/png_stream.h"

#include <algorithm>
#include <cstring>
#include <string_view>
#include <vector>

namespace welkin::codec {
namespace {

constexpr std::uint64_t kChecksumBytes = 4;

std::uint64_t big_endian(const char* bytes) {
  std::uint64_t value = 0;
  for (int i = 0; i < 4; ++i) {
    value = value << 8U | static_cast<unsigned char>(bytes[i]);
  }
  return value;
}

// A type whose first letter is upper case is critical: to be understood or to be refused, by the decoder.
bool is_wanted(std::string_view type) {
  return (static_cast<unsigned char>(type[0]) & 0x20U) == 0 || type == "gAMA" || type == "sRGB" || type == "cHRM";
}

// Seeking costs a call to the system; over a few bytes it is cheaper to read.
void pass_over(ByteFile& file, std::uint64_t count) {
  std::array<char, 512> bytes{};
  if (count <= bytes.size() && count <= file.remaining()) {
    file.read(bytes.data(), count);
  } else {
    file.seek(file.position() + count);
  }
}

}  // namespace

void PngStream::next_chunk() {
  file_.read(start_.data(), start_.size());
  start_used_ = 0;
  if (!signature_is_out_) {
    signature_is_out_ = true;
    return;
  }
  const std::string_view type(start_.data() + 4, 4);
  const std::uint64_t length = big_endian(start_.data()) + kChecksumBytes;
  has_profile_ = has_profile_ || type == "iCCP";
  has_transparency_ = has_transparency_ || type == "tRNS";
  has_code_points_ = has_code_points_ || type == "cICP";
  if (is_wanted(type)) {
    body_left_ = length;
  } else {
    pass_over(file_, length);
    start_used_ = start_.size();
  }
}

void PngStream::read(void* bytes, std::size_t count) {
  auto* to = static_cast<char*>(bytes);
  while (count > 0) {
    std::size_t part = std::min(count, start_.size() - start_used_);
    if (part > 0) {
      std::memcpy(to, start_.data() + start_used_, part);
      start_used_ += part;
    } else if (body_left_ > 0) {
      part = static_cast<std::size_t>(std::min<std::uint64_t>(count, body_left_));
      file_.read(to, part);
      body_left_ -= part;
    } else {
      next_chunk();
      continue;
    }
    to += part;
    count -= part;
  }
}

}  // namespace welkin::codec
