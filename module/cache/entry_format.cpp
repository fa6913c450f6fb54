#include "cache/entry_format.h"

#include <algorithm>
#include <cstring>

#include "codec/little_endian.h"

namespace welkin::cache {
namespace {

constexpr std::array<std::uint8_t, 8> kMagic{'W', 'L', 'K', 'N', 'E', 'N', 'T', '\n'};
constexpr std::uint32_t kVersion = 1;
constexpr std::size_t kSummedBytes = kEntryHeaderBytes - sizeof(std::uint64_t);

void append(std::vector<std::uint8_t>& bytes, const ContentHash& hash) {
  codec::append_little_endian(bytes, hash.high);
  codec::append_little_endian(bytes, hash.low);
}

ContentHash hash_at(const std::uint8_t* bytes) {
  return {codec::read_little_endian<std::uint64_t>(bytes), codec::read_little_endian<std::uint64_t>(bytes + 8)};
}

}  // namespace

EntryHeader entry_header(const EntryName& name, std::span<const std::uint8_t> payload) {
  std::vector<std::uint8_t> bytes(kMagic.begin(), kMagic.end());
  codec::append_little_endian(bytes, kVersion);
  codec::append_little_endian(bytes, static_cast<std::uint32_t>(name.kind));
  append(bytes, name.key);
  codec::append_little_endian(bytes, static_cast<std::uint64_t>(payload.size()));
  append(bytes, hash_bytes(payload.data(), payload.size()));
  codec::append_little_endian(bytes, hash_bytes(bytes.data(), bytes.size()).low);
  EntryHeader header{};
  std::copy_n(bytes.begin(), header.size(), header.begin());
  return header;
}

std::optional<EntryStatement> read_entry_header(std::span<const std::uint8_t> bytes) {
  if (bytes.size() < kEntryHeaderBytes || !std::equal(kMagic.begin(), kMagic.end(), bytes.begin())) return std::nullopt;
  const std::uint8_t* const first = bytes.data();
  if (codec::read_little_endian<std::uint64_t>(first + kSummedBytes) != hash_bytes(first, kSummedBytes).low) {
    return std::nullopt;
  }
  if (codec::read_little_endian<std::uint32_t>(first + 8) != kVersion) return std::nullopt;
  return EntryStatement{
      {static_cast<EntryKind>(codec::read_little_endian<std::uint32_t>(first + 12)), hash_at(first + 16)},
      codec::read_little_endian<std::uint64_t>(first + 32),
      hash_at(first + 40)};
}

bool is_payload_of(const EntryStatement& statement, std::span<const std::uint8_t> payload) {
  return payload.size() == statement.payload_bytes && hash_bytes(payload.data(), payload.size()) == statement.checksum;
}

}  // namespace welkin::cache
