// Fuzzes entries of the result cache. Their checksums are corrected first, as a fuzzer would never get past them.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <vector>

#include "cache/entry_store.h"
#include "cache/recipe.h"

namespace {

using namespace welkin::cache;

/// Aborts unless the encoding of a decoded value decodes, and encodes to the same bytes again.
template <class Decode, class Encode>
void round_trip(ByteSpan payload, const Decode& decode, const Encode& encode_again) {
  const auto result = decode(payload);
  if (!result) return;
  const Bytes again = encode_again(*result);
  const auto once_more = decode(again);
  if (!once_more || encode_again(*once_more) != again) std::abort();
}

/// Decodes a mip of the size that the payload states if it has that many bytes, and checks that the next size fails.
void decode_mips(ByteSpan payload) {
  std::uint64_t size = 0;
  ByteReader(payload).get(size);
  if (size < 1 || 72 * size * size > payload.size() || size > 4096) size = 1;
  std::vector<float> texels(18 * size * size);
  const auto mip = decode_mip(payload, static_cast<int>(size), texels.data());
  if (!mip) return;
  const Bytes again = encode_mip(*mip, texels.data());
  const auto once_more = decode_mip(again, mip->size, texels.data());
  if (!once_more || encode_mip(*once_more, texels.data()) != again) std::abort();
  std::vector<float> larger(18 * (size + 1) * (size + 1));
  if (decode_mip(payload, static_cast<int>(size) + 1, larger.data())) std::abort();
}

/// Decodes the payload as every kind, with the shape that its bytes state, if it is valid, and with another.
void decode_all(ByteSpan payload) {
  std::uint64_t first = 0;
  std::uint64_t second = 0;
  ByteReader reader(payload);
  reader.get(first);
  reader.get(second);
  const int bands = static_cast<int>(std::clamp<std::uint64_t>(first, 1, welkin::kMaximumBands));
  const int size = static_cast<int>(std::clamp<std::uint64_t>(first, 1, 4096));
  const int levels = static_cast<int>(
      std::clamp<std::uint64_t>(second, 1, static_cast<std::uint64_t>(welkin::full_chain_levels(size))));
  const int root = static_cast<int>(std::sqrt(static_cast<double>(std::min<std::uint64_t>(first, 1024))));
  const int functions_bands = std::clamp(root, 1, welkin::kMaximumBands);
  const auto plain = [](const auto& value) { return encode(value); };
  round_trip(
      payload, [=](ByteSpan bytes) { return decode_projection(bytes, bands); }, plain);
  round_trip(
      payload, [=](ByteSpan bytes) { return decode_cubemap(bytes, size, levels); }, plain);
  decode_mips(payload);
  for (const std::size_t tiles : {std::size_t{1}, static_cast<std::size_t>(std::min<std::uint64_t>(second, 4096))}) {
    round_trip(
        payload, [=](ByteSpan bytes) { return decode_face_sums(bytes, functions_bands, tiles); },
        [](const auto& sums) { return encode(*sums); });
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* first, std::size_t count) {
  const ByteSpan bytes(first, count);
  const auto stated = read_entry_header(bytes);
  if (stated && is_payload_of(*stated, bytes.subspan(kEntryHeaderBytes))) decode_all(bytes.subspan(kEntryHeaderBytes));
  if (count < kEntryHeaderBytes) return 0;
  const ByteSpan payload = bytes.subspan(kEntryHeaderBytes);
  const EntryHeader header = entry_header({EntryKind::projection, {1, 2}}, payload);
  const auto parsed = read_entry_header({reinterpret_cast<const std::uint8_t*>(&header), sizeof header});
  if (!parsed || !is_payload_of(*parsed, payload)) std::abort();
  decode_all(payload);
  return 0;
}
