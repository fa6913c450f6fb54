// Damage to files: truncation, changed bytes, fields of the header set to extremes.
#pragma once

#include "support/catch.h"

namespace welkin::test {

/// A small sound image of some format, and the extent of its header.
struct SoundFile {
  std::string name;  ///< with the format's extension
  std::vector<char> bytes;
  std::size_t header_bytes = 0;  ///< bytes and fields up to this offset are damaged; at most the whole file

  bool big_endian = false;  ///< byte order of its integers

  /// Corrects the checksums of damaged bytes, if the format has any, so that the damage gets past them.
  std::function<void(std::vector<char>&)> repair{};

  bool all_is_read = true;  ///< false: the end of a mip chain or of another part may be missing without an error

  /// How densely bytes and fields are damaged unless WELKIN_RANDOM_TRIALS is set, which damages each of them.
  struct Sample {
    std::size_t first = 0;
    std::size_t step = 1;
  };
  Sample bytes_changed{};
  Sample fields_changed{};
};

/// Returns one small file of every kind that is read. Uses `directory` for writers that need a path. A new format is
/// one line in the list of makers.
std::vector<SoundFile> sound_files(const std::filesystem::path& directory);

/// A kind of damage; each calls `use` repeatedly with the damaged bytes, in a fixed order.
using Use = std::function<void(const std::vector<char>& bytes)>;

/// The file truncated after every byte, from none to all but one.
void for_each_truncation(const SoundFile& file, const Use& use);

/// Every byte of the header, or of the file's sample, flipped and set to 0, 1 and 0xff.
void for_each_changed_byte(const SoundFile& file, const Use& use);

/// At every offset of the header, or of the file's sample: 0, 1, -1, the largest and smallest 32-bit integers and
/// 65536, in the format's byte order; and pairs of adjacent values, such as width and height, whose product exceeds 32
/// or 64 bits.
void for_each_extreme_field(const SoundFile& file, const Use& use);

/// Every decimal number of the header replaced by extreme numbers and by none, alone and together with the next one.
void for_each_extreme_number(const SoundFile& file, const Use& use);

/// All of the above.
void for_each_damage(const SoundFile& file, const Use& use);

}  // namespace welkin::test
