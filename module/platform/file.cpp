#include "platform/file.h"

#include <algorithm>
#include <array>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>

#include "platform/text.h"

namespace welkin {

const char* name(ErrorCode code) noexcept {
  constexpr std::array names{"invalid_argument", "rejected_pixel", "file_access", "corrupt_file", "unsupported_file",
                             "limit_exceeded",   "cancelled",      "replaced",    "queue_full",   "stopped"};
  return platform::name_in<ErrorCode::stopped>(names, code, "unknown");
}

}  // namespace welkin

namespace welkin::platform {

ByteFile::ByteFile(std::filesystem::path path, std::optional<std::span<const std::byte>> memory)
    : path_(std::move(path)), memory_(memory) {
  if (memory_) {
    size_ = memory_->size();
  } else {
    disk_ = open_disk_file(path_);
    size_ = disk_->size();
  }
}

void ByteFile::read(void* bytes, std::size_t count) {
  if (count > remaining()) {
    throw file_error(ErrorCode::corrupt_file, path_,
                     "ends too early: " + std::to_string(count) + " bytes are needed at " + std::to_string(position_) +
                         ", the file has " + std::to_string(size_) + " in all; fetch or export it again");
  }
  if (!memory_) {
    disk_->read(position_, bytes, count);
  } else if (count > 0) {  // an empty range may be null, which memcpy may not be given
    std::memcpy(bytes, memory_->data() + position_, count);
  }
  position_ += count;
}

namespace {

/// Returns the length of the UTF-8 character that the text begins with; 0 if the bytes are invalid. (RFC 3629, section
/// 4: some first bytes restrict the second, which excludes overlong forms of other characters, halves of UTF-16
/// surrogate pairs and code points above U+10FFFF.)
std::size_t character_bytes(std::string_view text) {
  constexpr unsigned kContinuation = 0x80;
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  const unsigned first = byte(0);
  const std::size_t length = first < 0x80                    ? 1
                             : first >= 0xC2 && first < 0xE0 ? 2
                             : first >= 0xE0 && first < 0xF0 ? 3
                             : first >= 0xF0 && first < 0xF5 ? 4
                                                             : 0;
  if (length > text.size()) return 0;
  for (std::size_t i = 1; i < length; ++i) {
    if ((byte(i) & 0xC0U) != kContinuation) return 0;
  }
  const unsigned second = length > 1 ? byte(1) : 0;
  const bool is_another = (first == 0xE0 && second < 0xA0) || (first == 0xED && second >= 0xA0) ||
                          (first == 0xF0 && second < 0x90) || (first == 0xF4 && second >= 0x90);
  return is_another ? 0 : length;
}

/// Returns whether a character is a control. Controls of text direction (U+202A to U+202E and U+2066 to U+2069) count:
/// with one of them a name reads as another.
bool is_control(std::string_view character) {
  const auto first = static_cast<unsigned char>(character[0]);
  if (character.size() == 1) return first < 0x20 || first == 0x7F;
  if (character.size() == 2) return first == 0xC2 && static_cast<unsigned char>(character[1]) < 0xA0;
  return (character >= "\xE2\x80\xAA" && character <= "\xE2\x80\xAE") ||
         (character >= "\xE2\x81\xA6" && character <= "\xE2\x81\xA9");
}

}  // namespace

std::string without_controls(std::string_view text) {
  std::string result;
  while (!text.empty()) {
    const std::size_t length = character_bytes(text);
    const std::string_view character = text.substr(0, std::max<std::size_t>(length, 1));
    if (length == 0 || is_control(character)) {
      result += '?';
    } else {
      result += character;
    }
    text.remove_prefix(character.size());
  }
  return result;
}

std::filesystem::path path_of(std::string_view utf8) {
  try {
    return {std::u8string(utf8.begin(), utf8.end())};
  } catch (const std::system_error&) {
    throw Error(ErrorCode::invalid_argument, without_controls(utf8) + ": is not valid UTF-8, which file names must be");
  }
}

void require_between(std::string_view what, double value, double low, double high) {
  if (value >= low && value <= high) return;
  throw Error(ErrorCode::invalid_argument, std::string(what) + " is " + number_text(value) + "; it must be from " +
                                               number_text(low) + " to " + number_text(high));
}

Error file_error(ErrorCode code, const std::filesystem::path& path, const std::string& message) {
  const bool lacks_remedy = code == ErrorCode::corrupt_file && message.find("; ") == std::string::npos;
  return {code, without_controls(utf8(path)) + ": " + message + (lacks_remedy ? "; fetch or export it again" : "")};
}

std::string printable(const std::string& text) {
  constexpr std::size_t kLongest = 200;
  std::string result = text.substr(0, kLongest);
  std::replace_if(
      result.begin(), result.end(), [](char c) { return c < ' ' || c > '~'; }, '?');
  return text.size() > kLongest ? result + "..." : result;
}

}  // namespace welkin::platform
