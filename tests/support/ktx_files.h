// KTX textures of both versions, written by code independent of the library's writer.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace welkin::test {

template <class Value>
void append_value(std::vector<std::byte>& bytes, Value value) {
  const auto* const first = reinterpret_cast<const std::byte*>(&value);
  bytes.insert(bytes.end(), first, first + sizeof value);
}

inline void append_words(std::vector<std::byte>& bytes, const std::vector<std::uint32_t>& values) {
  for (const std::uint32_t value : values) append_value(bytes, value);
}

/// The contents of a texture's header.
struct KtxKind {
  std::uint32_t format;     ///< VkFormat, or glType for KTX1
  std::uint32_t type_size;  ///< glFormat for KTX1
  std::uint32_t width;
  std::uint32_t height;
  std::uint32_t elements;  ///< 0: no array
  std::uint32_t faces;
};

/// Returns a KTX2 file; level 0 comes first in `levels`.
inline std::vector<std::byte> ktx2_bytes(const KtxKind& kind, const std::vector<std::vector<std::byte>>& levels) {
  std::vector<std::byte> bytes;
  for (const int value : {0xAB, 0x4B, 0x54, 0x58, 0x20, 0x32, 0x30, 0xBB, 0x0D, 0x0A, 0x1A, 0x0A})
    bytes.push_back(static_cast<std::byte>(value));
  append_words(bytes, {kind.format, kind.type_size, kind.width, kind.height, 0, kind.elements, kind.faces,
                       static_cast<std::uint32_t>(levels.size()), 0, 0, 0, 0, 0, 0, 0, 0, 0});
  std::uint64_t index = 80 + 24 * levels.size();
  for (const std::vector<std::byte>& level : levels) {
    append_value(bytes, index);
    append_value(bytes, std::uint64_t{level.size()});
    append_value(bytes, std::uint64_t{level.size()});
    index += level.size();
  }
  for (const std::vector<std::byte>& level : levels) bytes.insert(bytes.end(), level.begin(), level.end());
  return bytes;
}

/// Returns a KTX file of the first version, little-endian.
inline std::vector<std::byte> ktx1_bytes(const KtxKind& kind, std::uint32_t internal,
                                         const std::vector<std::vector<std::byte>>& levels,
                                         const std::string& note = "") {
  std::vector<std::byte> bytes;
  for (const int value : {0xAB, 0x4B, 0x54, 0x58, 0x20, 0x31, 0x31, 0xBB, 0x0D, 0x0A, 0x1A, 0x0A})
    bytes.push_back(static_cast<std::byte>(value));
  const std::string entry = note.empty() ? "" : std::string("note\0", 5) + note + '\0';
  const std::size_t padded = (entry.size() + 3) / 4 * 4;
  append_words(bytes, {0x04030201, kind.format, 1, kind.type_size, internal, kind.type_size, kind.width, kind.height, 0,
                       kind.elements, kind.faces, static_cast<std::uint32_t>(levels.size()),
                       static_cast<std::uint32_t>(entry.empty() ? 0 : 4 + padded)});
  if (!entry.empty()) {
    append_value(bytes, static_cast<std::uint32_t>(entry.size()));
    for (std::size_t k = 0; k < padded; ++k) bytes.push_back(static_cast<std::byte>(k < entry.size() ? entry[k] : 0));
  }
  for (const std::vector<std::byte>& level : levels) {
    const bool counts_a_face = kind.elements == 0 && kind.faces == 6;
    append_value(bytes, static_cast<std::uint32_t>(level.size() / (counts_a_face ? 6 : 1)));
    bytes.insert(bytes.end(), level.begin(), level.end());
  }
  return bytes;
}

}  // namespace welkin::test
