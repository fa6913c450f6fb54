// Numbers, directions and file names for people, independent of the locale; small text files.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <glm/vec3.hpp>
#include <initializer_list>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace welkin::tool {

/// Returns the number with that many significant digits, without trailing zeros: "0.25", "1.3e-08".
[[nodiscard]] std::string significant(double value, int digits = 6);

/// Returns three significant digits, or all before the point: "0.25", "1023".
[[nodiscard]] std::string rough(double value);

/// Returns three numbers: "0.2  0.25  0.4".
[[nodiscard]] std::string significant(const glm::dvec3& rgb, int digits = 6);

/// Returns the shortest text that reads back as the same number.
[[nodiscard]] std::string all_digits(double value);

/// Returns digits in groups of three: "2,097,152".
[[nodiscard]] std::string grouped(std::uint64_t count);

/// Returns a count with its noun, in the plural if needed: "1 texel", "2,097,152 texels".
[[nodiscard]] std::string counted(std::uint64_t count, std::string_view noun);

struct Count {
  std::uint64_t number;
  std::string_view noun;
};

/// Returns the counts that are not zero, with their nouns: "2 NaNs, 1 negative value".
[[nodiscard]] std::string counted(std::initializer_list<Count> counts);

/// Returns the results of `words` for each value, with `between` between them: "a, b".
template <class Values, class Words>
[[nodiscard]] std::string listed(const Values& values, const Words& words, std::string_view between = ", ") {
  std::string text;
  bool is_first = true;
  for (const auto& value : values) {
    if (!std::exchange(is_first, false)) text += between;
    text += words(value);
  }
  return text;
}
[[nodiscard]] inline std::string joined(const std::vector<std::string>& words, std::string_view between = ", ") {
  return listed(
      words, [](const std::string& word) { return word; }, between);
}

/// Returns the text with each `what` replaced by `with`.
[[nodiscard]] std::string replaced(std::string text, std::string_view what, std::string_view with);

/// Returns a duration with its unit: "0.21 ms", "3.4 s".
[[nodiscard]] std::string duration(double milliseconds);

/// Returns "41 s", "3 min 5 s", "2 h 10 min".
[[nodiscard]] std::string long_duration(double seconds);

[[nodiscard]] std::string pad_left(std::string_view text, std::size_t width);
[[nodiscard]] std::string pad_right(std::string_view text, std::size_t width);

/// A column of numbers with aligned decimal points: fixed point, with decimals for six significant digits of the
/// largest number, or scientific where that would be mostly zeros.
class NumberColumn {
 public:
  explicit NumberColumn(double largest_magnitude);

  /// Returns the number right-aligned in `width` characters.
  [[nodiscard]] std::string cell(double value, std::size_t width = 11) const;
  [[nodiscard]] std::string cells(const glm::dvec3& rgb, std::size_t width = 11) const;

 private:
  int decimals_ = 0;
  bool scientific_ = false;
};

/// Returns the largest absolute value of the three.
[[nodiscard]] double largest_magnitude(const glm::dvec3& rgb);

/// Returns "(0.287, 0.643, 0.710): 40.0 degrees up, 22.0 degrees from +z towards +x" if y is up; if z is up (Unreal,
/// Blender) the azimuth is counted from +x towards +y.
[[nodiscard]] std::string direction_text(const glm::dvec3& unit, bool z_is_up = false);

/// Returns "+X", "-X", ... for 0 to 5.
[[nodiscard]] const char* face_name(int face) noexcept;

/// Replaces every control character and invalid UTF-8 by '?': names of files and channels must not control the reader's
/// terminal.
[[nodiscard]] std::string printable(const std::string& text);
/// Returns the text as `printable` does, with its line feeds.
[[nodiscard]] std::string printable_lines(const std::string& text);

/// Returns the path for a file that others will read: unchanged if it is relative; of an absolute one its last name,
/// because folders of one machine mean nothing on another and reveal who works there.
[[nodiscard]] std::string portable_path(const std::string& path);

/// Returns whether both name one file, or would if it existed.
[[nodiscard]] bool is_same_file(const std::filesystem::path& one, const std::filesystem::path& other);

/// Throws `Error` (file_access) if both are one file: `writer` ("this bake") would overwrite its input. `remedy`: an
/// alternative.
void require_kept(const std::filesystem::path& read, const std::filesystem::path& written, const std::string& writer,
                  const std::string& remedy);

/// Returns whether the file has this sign of its writer within its first 256 bytes.
[[nodiscard]] bool begins_with(const std::filesystem::path& file, std::string_view sign);

/// Throws `Error` (file_access) if there is a file without the sign, which `writer` ("batch plan") would overwrite.
/// `remedy`: an alternative.
void require_own(const std::filesystem::path& file, std::string_view sign, const std::string& writer,
                 const std::string& remedy = "name another file, or remove it");

/// Write files as the library does: each is complete, or stays as it was. Throw `Error` (file_access).
void write_text_file(const std::filesystem::path& path, const std::string& text);
void write_bytes(const std::filesystem::path& path, std::span<const std::byte> bytes);

/// Calls `use` with each line, without its line feed, and with its number from 1. The file is a regular one or a pipe.
/// Throws `Error`: file_access for anything else, and if it cannot be read to its end; limit_exceeded for a line of
/// more than a megabyte, and for more than a gigabyte, both as soon as they are read; and the errors of `use`.
void for_each_line(const std::filesystem::path& file,
                   const std::function<void(std::size_t number, const std::string& line)>& use);

}  // namespace welkin::tool
