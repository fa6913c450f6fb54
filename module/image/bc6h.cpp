#include "image/bc6h.h"

#include <algorithm>
#include <string_view>

#include "image/block_bits.h"

namespace welkin::image {
namespace {

constexpr std::array<Bc6hMode, kBc6hModes> kModes = {{
    {0x00, 2, 10, {5, 5, 5}, true, true},
    {0x01, 2, 7, {6, 6, 6}, true, true},
    {0x02, 5, 11, {5, 4, 4}, true, true},
    {0x06, 5, 11, {4, 5, 4}, true, true},
    {0x0A, 5, 11, {4, 4, 5}, true, true},
    {0x0E, 5, 9, {5, 5, 5}, true, true},
    {0x12, 5, 8, {6, 5, 5}, true, true},
    {0x16, 5, 8, {5, 6, 5}, true, true},
    {0x1A, 5, 8, {5, 5, 6}, true, true},
    {0x1E, 5, 6, {6, 6, 6}, false, true},
    {0x03, 5, 10, {10, 10, 10}, false, false},
    {0x07, 5, 11, {9, 9, 9}, true, false},
    {0x0B, 5, 12, {8, 8, 8}, true, false},
    {0x0F, 5, 16, {4, 4, 4}, true, false},
}};

/// Where the bits of the ends lie after a mode's prefix: runs of a channel (r, g, b) of an end (w, x, y, z), "rw0-9"
/// for its bits 0 to 9 from the lowest position on, "rw11-10" for bit 11 before bit 10.
constexpr std::array<std::string_view, kBc6hModes> kLayouts = {
    "gy4 by4 bz4 rw0-9 gw0-9 bw0-9 rx0-4 gz4 gy0-3 gx0-4 bz0 gz0-3 bx0-4 bz1 by0-3 ry0-4 bz2 rz0-4 bz3",
    "gy5 gz4-5 rw0-6 bz0-1 by4 gw0-6 by5 bz2 gy4 bw0-6 bz3 bz5 bz4 rx0-5 gy0-3 gx0-5 gz0-3 bx0-5 by0-3 ry0-5 rz0-5",
    "rw0-9 gw0-9 bw0-9 rx0-4 rw10 gy0-3 gx0-3 gw10 bz0 gz0-3 bx0-3 bw10 bz1 by0-3 ry0-4 bz2 rz0-4 bz3",
    "rw0-9 gw0-9 bw0-9 rx0-3 rw10 gz4 gy0-3 gx0-4 gw10 gz0-3 bx0-3 bw10 bz1 by0-3 ry0-3 bz0 bz2 rz0-3 gy4 bz3",
    "rw0-9 gw0-9 bw0-9 rx0-3 rw10 by4 gy0-3 gx0-3 gw10 bz0 gz0-3 bx0-4 bw10 by0-3 ry0-3 bz1-2 rz0-3 bz4 bz3",
    "rw0-8 by4 gw0-8 gy4 bw0-8 bz4 rx0-4 gz4 gy0-3 gx0-4 bz0 gz0-3 bx0-4 bz1 by0-3 ry0-4 bz2 rz0-4 bz3",
    "rw0-7 gz4 by4 gw0-7 bz2 gy4 bw0-7 bz3-4 rx0-5 gy0-3 gx0-4 bz0 gz0-3 bx0-4 bz1 by0-3 ry0-5 rz0-5",
    "rw0-7 bz0 by4 gw0-7 gy5 gy4 bw0-7 gz5 bz4 rx0-4 gz4 gy0-3 gx0-5 gz0-3 bx0-4 bz1 by0-3 ry0-4 bz2 rz0-4 bz3",
    "rw0-7 bz1 by4 gw0-7 by5 gy4 bw0-7 bz5 bz4 rx0-4 gz4 gy0-3 gx0-4 bz0 gz0-3 bx0-5 by0-3 ry0-4 bz2 rz0-4 bz3",
    "rw0-5 gz4 bz0-1 by4 gw0-5 gy5 by5 bz2 gy4 bw0-5 gz5 bz3 bz5 bz4 rx0-5 gy0-3 gx0-5 gz0-3 bx0-5 by0-3 ry0-5 rz0-5",
    "rw0-9 gw0-9 bw0-9 rx0-9 gx0-9 bx0-9",
    "rw0-9 gw0-9 bw0-9 rx0-8 rw10 gx0-8 gw10 bx0-8 bw10",
    "rw0-9 gw0-9 bw0-9 rx0-7 rw11-10 gx0-7 gw11-10 bx0-7 bw11-10",
    "rw0-9 gw0-9 bw0-9 rx0-3 rw15-10 gx0-3 gw15-10 bx0-3 bw15-10",
};

/// Bits of a field that follow each other in a block.
struct Run {
  std::uint8_t end, channel, first_bit, bits;
};

struct Layout {
  std::array<Run, 40> runs{};
  std::size_t count = 0;
};

constexpr Layout layout_of(std::string_view text) {
  Layout layout;
  std::size_t at = 0;
  const auto number = [&] {
    unsigned value = 0;
    for (; at < text.size() && text[at] >= '0' && text[at] <= '9'; ++at) {
      value = 10 * value + static_cast<unsigned>(text[at] - '0');
    }
    return static_cast<std::uint8_t>(value);
  };
  while (at < text.size()) {
    const auto channel = static_cast<std::uint8_t>(text[at] == 'r' ? 0 : text[at] == 'g' ? 1 : 2);
    const auto end = static_cast<std::uint8_t>(text[at + 1] - 'w');
    at += 2;
    const std::uint8_t first = number();
    std::uint8_t last = first;
    if (at < text.size() && text[at] == '-') {
      ++at;
      last = number();
    }
    if (last >= first) {
      layout.runs[layout.count++] = {end, channel, first, static_cast<std::uint8_t>(last - first + 1)};
    }
    for (int bit = first; bit >= last && last < first; --bit) {
      layout.runs[layout.count++] = {end, channel, static_cast<std::uint8_t>(bit), 1};
    }
    ++at;  // the space
  }
  return layout;
}

constexpr std::array<Layout, kBc6hModes> parsed_layouts() {
  std::array<Layout, kBc6hModes> layouts{};
  for (std::size_t mode = 0; mode < layouts.size(); ++mode) layouts[mode] = layout_of(kLayouts[mode]);
  return layouts;
}

constexpr std::array<Layout, kBc6hModes> kRuns = parsed_layouts();

/// Returns whether every bit that a mode's ends have lies somewhere, and once.
constexpr bool covers(const Bc6hMode& mode, const Layout& layout) {
  std::array<std::array<std::uint32_t, 3>, 4> found{};
  for (std::size_t k = 0; k < layout.count; ++k) {
    const Run& run = layout.runs[k];
    std::uint32_t& bits = found[run.end][run.channel];
    const std::uint32_t these = ((1U << run.bits) - 1U) << run.first_bit;
    if ((bits & these) != 0) return false;
    bits |= these;
  }
  for (std::size_t end = 0; end < 4; ++end) {
    for (std::size_t channel = 0; channel < 3; ++channel) {
      const int bits = end == 0 ? mode.end_bits : end > 1 && !mode.two_lines ? 0 : mode.other_bits[channel];
      if (found[end][channel] != (1U << bits) - 1U) return false;
    }
  }
  return true;
}

constexpr bool all_covered() {
  for (std::size_t mode = 0; mode < kModes.size(); ++mode) {
    if (!covers(kModes[mode], kRuns[mode])) return false;
  }
  return true;
}
static_assert(all_covered());

constexpr int kPartitionBits = 5;

/// Calls `visit(texel, bits)` for the indices as they follow each other: an anchor's has a bit less.
/// A line's ends can be exchanged if its indices are counted from the other end, with the same decoded texels. So a
/// block may always be written with the upper bit 0 in the index of one texel of each line, its anchor.
template <class Visit>
void for_each_index(const Bc6hMode& mode, int partition, const Visit& visit) {
  const int bits = mode.two_lines ? 3 : 4;
  const int anchor = mode.two_lines ? bc6h_anchor(partition) : 0;
  for (int texel = 0; texel < static_cast<int>(kBlockTexels); ++texel) {
    visit(static_cast<std::size_t>(texel), texel == 0 || texel == anchor ? bits - 1 : bits);
  }
}

std::int32_t sign_extended(std::uint32_t value, int bits) noexcept {
  // Two's complement: value ^ sign is value + sign or, if the sign's bit is set, value - sign.
  const std::uint32_t sign = 1U << (bits - 1);
  return static_cast<std::int32_t>((value ^ sign) - sign);
}

/// An end of `bits` bits as one of 16 (and a sign), as far as possible the middle of what it stands for.
/// (end + 1/2) 2^(16 - bits) is the middle of the 16-bit numbers whose upper bits are `end`; 0 and the largest number
/// are moved to the ends of the range, so that black and the largest half can be stored.
std::int32_t unquantised(std::int32_t end, int bits, Bc6hRange range) noexcept {
  if (range == Bc6hRange::positive) {
    if (bits >= 15 || end == 0) return end;
    if (end == (1 << bits) - 1) return 0xFFFF;
    return ((end << 16) + 0x8000) >> bits;
  }
  if (bits >= 16 || end == 0) return end;
  const std::int32_t magnitude = end < 0 ? -end : end;
  const std::int32_t result = magnitude >= (1 << (bits - 1)) - 1 ? 0x7FFF : ((magnitude << 15) + 0x4000) >> (bits - 1);
  return end < 0 ? -result : result;
}

/// Returns the bits of the half that a number between two ends stands for.
std::uint16_t half_of(std::int32_t value, Bc6hRange range) noexcept {
  // 0xFFFF 31 / 64 and 0x7FFF 31 / 32 are 31743, the bits of the largest finite half, 65504.
  if (range == Bc6hRange::positive) return static_cast<std::uint16_t>(value * 31 >> 6);
  const std::int32_t magnitude = (value < 0 ? -value : value) * 31 >> 5;
  return static_cast<std::uint16_t>(magnitude | (value < 0 && magnitude != 0 ? 0x8000 : 0));
}

/// Returns how far along its line an index is, in 64ths: 64 index / 15, or / 7, to the nearest whole number.
constexpr std::int32_t weight_of(std::int32_t index, bool two_lines) noexcept {
  return two_lines ? 37 * index >> 2 : (17 * index + 2) >> 2;
}

}  // namespace

const Bc6hMode& bc6h_mode(int mode) noexcept { return kModes[static_cast<std::size_t>(mode - 1)]; }

std::uint16_t bc6h_second_line(int partition) noexcept { return kBc6hSecondLines[static_cast<std::size_t>(partition)]; }

int bc6h_anchor(int partition) noexcept { return kBc6hAnchors[static_cast<std::size_t>(partition)]; }

Bc6hFields unpack_bc6h(const std::uint8_t* block) noexcept {
  Bc6hFields fields;
  const int prefix_bits = (block[0] & 2) == 0 ? 2 : 5;
  const int prefix = block[0] & ((1 << prefix_bits) - 1);
  for (int mode = 1; mode <= kBc6hModes; ++mode) {
    if (bc6h_mode(mode).prefix == prefix && bc6h_mode(mode).prefix_bits == prefix_bits) fields.mode = mode;
  }
  if (fields.mode == 0) return fields;
  const Bc6hMode& mode = bc6h_mode(fields.mode);
  const BlockBits bits(block);
  int offset = prefix_bits;
  const auto next = [&](int count) {
    offset += count;
    return static_cast<std::uint32_t>(bits.at(offset - count, count));
  };
  const Layout& layout = kRuns[static_cast<std::size_t>(fields.mode - 1)];
  for (std::size_t k = 0; k < layout.count; ++k) {
    const Run& run = layout.runs[k];
    fields.ends[run.end][run.channel] |= next(run.bits) << run.first_bit;
  }
  if (mode.two_lines) fields.partition = static_cast<int>(next(kPartitionBits));
  for_each_index(mode, fields.partition,
                 [&](std::size_t texel, int count) { fields.indices[texel] = static_cast<std::uint8_t>(next(count)); });
  return fields;
}

void pack_bc6h(const Bc6hFields& fields, std::uint8_t* block) noexcept {
  const Bc6hMode& mode = bc6h_mode(fields.mode);
  BlockBits bits;
  bits.append(static_cast<std::uint32_t>(mode.prefix), mode.prefix_bits);
  const Layout& layout = kRuns[static_cast<std::size_t>(fields.mode - 1)];
  for (std::size_t k = 0; k < layout.count; ++k) {
    const Run& run = layout.runs[k];
    bits.append(fields.ends[run.end][run.channel] >> run.first_bit, run.bits);
  }
  if (mode.two_lines) bits.append(static_cast<std::uint32_t>(fields.partition), kPartitionBits);
  for_each_index(mode, fields.partition,
                 [&](std::size_t texel, int count) { bits.append(fields.indices[texel], count); });
  bits.store(block);
}

void decode_bc6h(const std::uint8_t* block, Bc6hRange range, std::uint16_t* halves) noexcept {
  const Bc6hFields fields = unpack_bc6h(block);
  if (fields.mode == 0) {
    std::fill_n(halves, 3 * kBlockTexels, std::uint16_t{0});
    return;
  }
  const Bc6hNumbers numbers = bc6h_numbers(fields, range);
  std::array<std::uint16_t, kBlockTexels> of_channel{};
  for (std::size_t channel = 0; channel < 3; ++channel) {
    decode_bc6h_channel(fields, numbers, channel, range, of_channel.data());
    for (std::size_t texel = 0; texel < kBlockTexels; ++texel) halves[3 * texel + channel] = of_channel[texel];
  }
}

std::int32_t bc6h_end(std::int32_t number, int mode, Bc6hRange range) noexcept {
  return unquantised(number, bc6h_mode(mode).end_bits, range);
}

std::int32_t bc6h_weight(std::int32_t index, int mode) noexcept { return weight_of(index, bc6h_mode(mode).two_lines); }

Bc6hNumbers bc6h_numbers(const Bc6hFields& fields, Bc6hRange range) noexcept {
  const Bc6hMode& mode = bc6h_mode(fields.mode);
  Bc6hNumbers numbers{};
  const std::uint32_t mask = (1U << mode.end_bits) - 1U;
  for (std::size_t end = 0; end < 4; ++end) {
    for (std::size_t channel = 0; channel < 3; ++channel) {
      std::uint32_t value = fields.ends[end][channel];
      if (mode.differences && end > 0) {
        value = fields.ends[0][channel] + static_cast<std::uint32_t>(sign_extended(value, mode.other_bits[channel]));
      }
      value &= mask;
      numbers[end][channel] =
          range == Bc6hRange::positive ? static_cast<std::int32_t>(value) : sign_extended(value, mode.end_bits);
    }
  }
  return numbers;
}

bool store_bc6h_numbers(const Bc6hNumbers& numbers, std::size_t channel, Bc6hRange range, Bc6hFields& fields) noexcept {
  const Bc6hMode& mode = bc6h_mode(fields.mode);
  const std::size_t ends = mode.two_lines ? 4 : 2;
  const bool has_sign = range == Bc6hRange::signed_values;
  const std::int32_t largest = (1 << (has_sign ? mode.end_bits - 1 : mode.end_bits)) - 1;
  const std::int32_t reach = 1 << (mode.other_bits[channel] - 1);
  std::array<std::int32_t, 4> stored{};
  for (std::size_t end = 0; end < ends; ++end) {
    stored[end] = numbers[end][channel];
    if (stored[end] > largest || stored[end] < (has_sign ? -largest : 0)) return false;
    if (!mode.differences || end == 0) continue;
    stored[end] -= numbers[0][channel];
    if (stored[end] >= reach || stored[end] < -reach) return false;
  }
  for (std::size_t end = 0; end < ends; ++end) {
    const int bits = end == 0 ? mode.end_bits : mode.other_bits[channel];
    fields.ends[end][channel] = static_cast<std::uint32_t>(stored[end]) & ((1U << bits) - 1U);
  }
  return true;
}

void decode_bc6h_channel(const Bc6hFields& fields, const Bc6hNumbers& numbers, std::size_t channel, Bc6hRange range,
                         std::uint16_t* halves) noexcept {
  const Bc6hMode& mode = bc6h_mode(fields.mode);
  const unsigned second = mode.two_lines ? bc6h_second_line(fields.partition) : 0U;
  std::array<std::int32_t, 4> ends{};
  for (std::size_t end = 0; end < 4; ++end) ends[end] = unquantised(numbers[end][channel], mode.end_bits, range);
  for (std::size_t texel = 0; texel < kBlockTexels; ++texel) {
    const std::size_t low = (second >> texel & 1U) * 2;
    const std::int32_t weight = weight_of(fields.indices[texel], mode.two_lines);
    halves[texel] = half_of((ends[low] * (64 - weight) + ends[low + 1] * weight + 32) >> 6, range);
  }
}

void decode_bc6h_rows(const std::uint8_t* blocks, Bc6hRange range, int width, int first_row, int rows,
                      float* rgb) noexcept {
  decode_block_rows(blocks, width, first_row, rows, rgb,
                    [range](const std::uint8_t* block, std::uint16_t* halves) { decode_bc6h(block, range, halves); });
}

}  // namespace welkin::image
