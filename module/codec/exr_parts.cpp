#include "codec/exr_parts.h"

#include <ImfPartType.h>
#include <ImfStandardAttributes.h>
#include <ImfVersion.h>

#include <algorithm>
#include <array>
#include <charconv>

#include "codec/exr_attributes.h"
#include "codec/exr_channels.h"
#include "codec/exr_levels.h"
#include "codec/exr_stream.h"

namespace welkin::codec {
namespace {

// The library keeps some kilobytes for each; the largest productions have some dozens.
constexpr std::size_t kMostParts = 1024;

[[noreturn]] void refuse(const std::filesystem::path& path, const std::string& found_and_remedy) {
  throw file_error(ErrorCode::unsupported_file, path, found_and_remedy);
}

[[noreturn]] void reject(const std::filesystem::path& path, const std::string& what) {
  throw file_error(ErrorCode::corrupt_file, path,
                   "its OpenEXR header is damaged: " + what + "; fetch or export it again");
}

int read_version(ByteFile& file) {
  std::array<unsigned char, 8> start{};
  file.read(start.data(), start.size());
  const int version = start[4] | start[5] << 8 | start[6] << 16;  // the top byte is kept free by the format
  if (Imf::getVersion(version) != Imf::EXR_VERSION || start[7] != 0 || !Imf::supportsFlags(Imf::getFlags(version))) {
    refuse(file.path(), "is of an OpenEXR version or kind that is not known here (version " +
                            std::to_string(Imf::getVersion(version)) + ", flags " +
                            std::to_string(Imf::getFlags(version) >> 8) + "); save it as OpenEXR 2");
  }
  if (Imf::isMultiPart(version) && Imf::isTiled(version)) {
    reject(file.path(), "it claims to be single-part tiled and multi-part at once");
  }
  return version;
}

// Checks the attributes first, then lets the library read them.
Imf::Header read_header(ByteFile& file, ExrStream& stream, int version) {
  const std::uint64_t start = file.position();
  check_exr_attributes(file);
  file.seek(start);
  Imf::Header header;
  header.readFrom(stream, version);
  return header;
}

// Headers of a multi-part file end with an empty one: a single zero byte.
bool at_last_header(ByteFile& file) {
  char byte = 0;
  file.read(&byte, 1);
  if (byte != 0) {
    file.seek(file.position() - 1);
  }
  return byte == 0;
}

// What the library does with types: a single-part picture's flags decide, whatever its type attribute says.
ExrPart describe_part(Imf::Header header, int version, const std::filesystem::path& path, std::size_t index) {
  ExrPart part;
  part.name = header.hasName() ? printable(header.name()) : "";
  if (Imf::isMultiPart(version)) {
    if (!header.hasName() || !header.hasType()) {
      reject(path, "part " + std::to_string(index) + " lacks a " + (header.hasName() ? "type" : "name"));
    }
    part.tiled = header.type() == Imf::TILEDIMAGE;
    part.deep = !part.tiled && header.type() != Imf::SCANLINEIMAGE;
  } else {
    part.tiled = Imf::isTiled(version);
    part.deep = Imf::isNonImage(version) ||
                (header.hasType() && header.type() != Imf::TILEDIMAGE && header.type() != Imf::SCANLINEIMAGE);
  }
  part.header = std::move(header);
  return part;
}

// 0 "mask", 1 "beauty" (deep)
std::string part_list(const ExrParts& parts) {
  std::string list;
  for (std::size_t i = 0; i < parts.parts.size(); ++i) {
    list += (i == 0 ? "" : ", ") + std::to_string(i) + " \"" + parts.parts[i].name + "\"" +
            (parts.parts[i].deep ? " (deep)" : "");
  }
  return printable(list);
}

void require_flat(const ExrParts& parts, std::size_t index, const std::filesystem::path& path) {
  if (parts.parts[index].deep) {
    const std::string what = parts.multi_part ? "its part \"" + parts.parts[index].name + "\"" : "it";
    refuse(path, what + " is a deep OpenEXR picture; flatten it to a plain one (RGB, half or float)");
  }
}

std::size_t find_part(const ExrParts& parts, const std::filesystem::path& path, const std::string& asked_for) {
  for (std::size_t i = 0; i < parts.parts.size(); ++i) {
    const ExrPart& part = parts.parts[i];
    if (part.header.hasName() && (part.name == asked_for || part.header.name() == asked_for)) {
      return i;
    }
  }
  std::size_t number = 0;
  const char* end = asked_for.data() + asked_for.size();
  const auto [stop, failure] = std::from_chars(asked_for.data(), end, number);
  if (failure == std::errc() && stop == end && number < parts.parts.size()) {
    return number;
  }
  if (!parts.multi_part) {
    refuse(path, "has a single part, and part \"" + printable(asked_for) + "\" was asked for; leave --part out");
  }
  refuse(path, "has no part \"" + printable(asked_for) + "\"; its parts are " + part_list(parts) +
                   ": pass one's name or number with --part");
}

}  // namespace

ExrParts read_exr_parts(ByteFile& file) {
  const int version = read_version(file);
  ExrStream stream(file);
  ExrParts result;
  result.multi_part = Imf::isMultiPart(version);
  do {
    if (result.parts.size() == kMostParts) {
      refuse(file.path(), "has more than " + std::to_string(kMostParts) +
                              " parts; save the part that holds the environment as a file of its own "
                              "(exrmultipart -separate)");
    }
    result.parts.push_back(
        describe_part(read_header(file, stream, version), version, file.path(), result.parts.size()));
  } while (result.multi_part && !at_last_header(file));
  result.header_bytes = file.position();
  return result;
}

std::uint64_t check_exr_tables(const ExrParts& parts, const ByteFile& file) {
  double chunks = 0.0;
  for (const ExrPart& part : parts.parts) {
    const std::string type = part.header.hasType() ? part.header.type() : "";
    const bool known = type.empty() || Imf::isSupportedType(type);
    part.header.sanityCheck(part.tiled || type == Imf::DEEPTILE, parts.multi_part);
    if (known) {
      chunks += chunk_count(part.header, part.tiled || type == Imf::DEEPTILE);
    } else {
      chunks += part.header.hasChunkCount() ? std::max(part.header.chunkCount(), 0) : 0;
    }
  }
  if (chunks * sizeof(std::uint64_t) > static_cast<double>(file.remaining())) {
    throw file_error(ErrorCode::corrupt_file, file.path(),
                     "ends too early: its header tells of " + std::to_string(static_cast<std::uint64_t>(chunks)) +
                         " blocks or tiles, for whose table alone it is too short; fetch or export it again");
  }
  return static_cast<std::uint64_t>(chunks) * sizeof(std::uint64_t);
}

std::size_t choose_exr_part(const ExrParts& parts, const std::filesystem::path& path, const std::string& asked_for,
                            const std::string& layer) {
  if (!asked_for.empty()) {
    const std::size_t index = find_part(parts, path, asked_for);
    require_flat(parts, index, path);
    return index;
  }
  if (parts.parts.size() == 1) {
    require_flat(parts, 0, path);
    return 0;
  }
  for (const bool in_colour : {true, false}) {
    for (std::size_t i = 0; i < parts.parts.size(); ++i) {
      const ExrPart& part = parts.parts[i];
      if (!part.deep && holds_picture(part.header.channels(), layer, in_colour)) {
        return i;
      }
    }
  }
  refuse(path, "none of its parts (" + part_list(parts) + ") is a flat picture with R, G and B or Y" +
                   (layer.empty() ? "" : " in a layer \"" + printable(layer) + "\"") +
                   "; pass the part with --part and its layer with --layer, or convert it");
}

}  // namespace welkin::codec
