// What can become of a file on its way: cut off, bytes changed, fields of its header set to extremes.
#pragma once

#include "support/catch.h"

namespace welkin::test {

/// A small sound image of some format, and how far its header goes.
struct SoundFile {
  std::string name;  ///< with the extension that belongs to the format
  std::vector<char> bytes;
  std::size_t header_bytes = 0;  ///< bytes and fields up to here are damaged; at most the whole file

  bool big_endian = false;  ///< its integers

  /// Makes the checksums of damaged bytes right, if the format has any, so that the damage gets past them.
  std::function<void(std::vector<char>&)> repair{};

  bool all_is_read = true;  ///< false: a mip chain's or another part's end may be missing and nobody notices

  /// How densely bytes and fields are damaged, unless WELKIN_RANDOM_TRIALS asks for each one of them.
  struct Sample {
    std::size_t first = 0;
    std::size_t step = 1;
  };
  Sample bytes_changed{};
  Sample fields_changed{};
};

/// One small file of every kind that is read. Uses `directory` for writers that need a path. A new format is one line
/// in the list of makers.
std::vector<SoundFile> sound_files(const std::filesystem::path& directory);

/// A kind of damage; each calls `use` with the damaged bytes, over and over, in a fixed order.
using Use = std::function<void(const std::vector<char>& bytes)>;

/// The file cut off after every byte, from none to all but one.
void for_each_truncation(const SoundFile& file, const Use& use);

/// Every byte of the header, or the file's sample of them, flipped, and set to 0, 1 and 0xff.
void for_each_changed_byte(const SoundFile& file, const Use& use);

/// At every place of the header, or the file's sample of them, 0, 1, -1, the largest and smallest 32-bit integers and
/// 65536, in the format's byte order; and pairs of them, neighbours as width and height are, whose product passes 32 or
/// 64 bits.
void for_each_extreme_field(const SoundFile& file, const Use& use);

/// Every decimal number of the header replaced by extreme numbers and by none, alone and together with the next one.
void for_each_extreme_number(const SoundFile& file, const Use& use);

/// All of the above.
void for_each_damage(const SoundFile& file, const Use& use);

}  // namespace welkin::test
