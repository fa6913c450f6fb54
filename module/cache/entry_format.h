// What an entry's file looks like. All little-endian, 64 bytes before the payload:
//
//   8 bytes "WLKNENT" and a line feed; uint32 version of this form; uint32 kind; 16 bytes key; uint64 bytes of payload;
//   16 bytes XXH3-128 of the payload; uint64 XXH3 (low half) of all that came before.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "welkin/content_hash.h"

namespace welkin::cache {

/// What a payload is. Numbers are on disks: they never change.
enum class EntryKind : std::uint32_t { projection = 1, specular_mip = 2, cubemap = 3, face_sums = 4, sky_tables = 5 };

struct EntryName {
  EntryKind kind{};
  ContentHash key;
  friend bool operator==(const EntryName&, const EntryName&) = default;
};

inline constexpr std::size_t kEntryHeaderBytes = 64;
using EntryHeader = std::array<std::uint8_t, kEntryHeaderBytes>;

[[nodiscard]] EntryHeader entry_header(const EntryName& name, std::span<const std::uint8_t> payload);

/// What a header states.
struct EntryStatement {
  EntryName name;
  std::uint64_t payload_bytes = 0;
  ContentHash checksum;
};

/// Nothing if these are not the 64 bytes of a header of this version.
[[nodiscard]] std::optional<EntryStatement> read_entry_header(std::span<const std::uint8_t> bytes);

/// Whether a payload is the one that is stated.
[[nodiscard]] bool is_payload_of(const EntryStatement& statement, std::span<const std::uint8_t> payload);

}  // namespace welkin::cache
