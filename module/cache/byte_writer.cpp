#include "cache/byte_writer.h"

namespace welkin::cache {

void ByteWriter::raw(const void* bytes, std::size_t count) {
  if (count == 0) return;
  const auto* const first = static_cast<const std::uint8_t*>(bytes);
  bytes_.insert(bytes_.end(), first, first + count);
}

}  // namespace welkin::cache
