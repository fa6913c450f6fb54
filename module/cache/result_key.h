// The name under which a result is kept.
#pragma once

#include <initializer_list>
#include <string>
#include <vector>

#include "cache/byte_writer.h"
#include "welkin/content_hash.h"
#include "welkin/version.h"

namespace welkin::cache {

/// The key of a result of this version. `what`: the call. Raise the number with every change of results' bits.
[[nodiscard]] inline ContentHash result_key(const std::string& what, std::initializer_list<ContentHash> parts) {
  const std::string call = what + " " WELKIN_VERSION_STRING " 1";
  std::vector<ContentHash> all{hash_bytes(call.data(), call.size())};
  all.insert(all.end(), parts);
  return combine(all);
}

/// Of values in their order.
template <class... Values>
[[nodiscard]] ContentHash hash_of(const Values&... values) {
  ByteWriter writer;
  (writer.put(values), ...);
  return hash_bytes(writer.bytes().data(), writer.bytes().size());
}

}  // namespace welkin::cache
