#include "codec/exr_luminance_chroma.h"

#include <ImfChromaticities.h>
#include <ImfInputPart.h>
#include <ImfRgbaYca.h>
#include <ImfStandardAttributes.h>

#include <algorithm>
#include <array>
#include <utility>
#include <vector>

#include "codec/exr_file.h"

namespace welkin::codec {
namespace {

namespace yca = Imf::RgbaYca;

constexpr int kBlockRows = 32;
constexpr int kMargin = yca::N2 + 1;  // the filter's half width, and one row for the saturation of its neighbours
constexpr int kHeldRows = kBlockRows + 2 * kMargin;
constexpr int kNaturalRows = 128;

const Imf::Rgba kBlack(0.0F, 0.0F, 0.0F, 0.0F);

// Positions are rows of the file's coordinates, of which even ones have chroma. They may lie outside of the data window
// by the margin; the nearest row with chroma stands in there.
class LuminanceChromaReader final : public RowReader {
 public:
  explicit LuminanceChromaReader(const ExrPicture& picture)
      : picture_(picture),
        width_(static_cast<std::size_t>(picture.data_width)),
        file_(picture),
        input_(file_.file, picture.part),
        weights_(luminance_weights(input_.header())),
        line_(width_ + yca::N - 1, kBlack),
        held_(width_ * kHeldRows, kBlack),
        rgb_(width_ * 3, kBlack),
        saturated_(width_, kBlack) {
    set_frame_buffer();
  }

  void read(int first_row, int row_count, float* rgb) override {
    call_openexr(picture_.info.path, [&] {
      for (int row = 0; row < row_count; row += kBlockRows) {
        read_block(picture_.first_row + first_row + row, std::min(kBlockRows, row_count - row),
                   rgb + 3 * width_ * static_cast<std::size_t>(row));
      }
    });
  }

 private:
  static Imath::V3f luminance_weights(const Imf::Header& header) {
    return yca::computeYw(Imf::hasChromaticities(header) ? Imf::chromaticities(header) : Imf::Chromaticities());
  }

  // One line, wherever it is in the picture, with half a filter's width free at both ends.
  void set_frame_buffer() {
    Imf::Rgba* first = line_.data() + yca::N2;
    const auto slice = [&](half* component, int sampling) {
      return exr_slice(Imf::HALF, component, picture_.first_column, 0,
                       static_cast<std::size_t>(sampling) * sizeof(Imf::Rgba), 0, sampling);
    };
    Imf::FrameBuffer buffer;
    buffer.insert(picture_.channels.names[0], slice(&first->r, 2));
    buffer.insert(picture_.channels.names[1], slice(&first->g, 1));
    buffer.insert(picture_.channels.names[2], slice(&first->b, 2));
    input_.setFrameBuffer(buffer);
  }

  [[nodiscard]] Imf::Rgba* held(int position) {
    return held_.data() + width_ * static_cast<std::size_t>(position - held_first_);
  }

  // The row's luminance, and chroma at every texel if its row has any.
  void decode(int position, Imf::Rgba* row) {
    const int top = picture_.first_row;
    const int bottom = top + picture_.data_height - 1;
    const int nearest = position < top ? top : position > bottom ? bottom - 1 : position;
    input_.readPixels(nearest);
    if (nearest % 2 != 0) {
      std::copy_n(line_.begin() + yca::N2, width_, row);
      return;
    }
    std::fill_n(line_.begin(), yca::N2, line_[yca::N2]);
    std::fill_n(line_.end() - yca::N2, yca::N2, line_[width_ + yca::N2 - 2]);
    yca::reconstructChromaHoriz(picture_.data_width, line_.data(), row);
  }

  // Holds the positions [first, end): those that are here already are moved, the others decoded.
  void hold(int first, int end) {
    const int kept_first = std::max(first, held_first_);
    const int kept_end = std::min(end, held_end_);
    const bool keeps = kept_first == first && kept_first < kept_end;
    if (keeps) {
      std::copy(held(kept_first), held(kept_first) + width_ * static_cast<std::size_t>(kept_end - kept_first),
                held_.data());
    }
    held_first_ = first;
    held_end_ = first;  // should decoding throw
    for (int position = keeps ? kept_end : first; position < end; ++position) {
      decode(position, held(position));
    }
    held_end_ = end;
  }

  void reconstruct(int position, Imf::Rgba* rgb) {
    if (position % 2 == 0) {
      yca::YCAtoRGBA(weights_, picture_.data_width, held(position), rgb);
      return;
    }
    std::array<const Imf::Rgba*, yca::N> rows{};
    for (int i = 0; i < yca::N; ++i) {
      rows[static_cast<std::size_t>(i)] = held(position - yca::N2 + i);
    }
    yca::reconstructChromaVert(picture_.data_width, rows.data(), rgb);
    yca::YCAtoRGBA(weights_, picture_.data_width, rgb, rgb);
  }

  void read_block(int first, int count, float* rgb) {
    hold(first - kMargin, first + count + kMargin);
    std::array<Imf::Rgba*, 3> rows{rgb_.data(), rgb_.data() + width_, rgb_.data() + 2 * width_};
    reconstruct(first - 1, rows[1]);
    reconstruct(first, rows[2]);
    for (int row = first; row < first + count; ++row) {
      std::rotate(rows.begin(), rows.begin() + 1, rows.end());
      reconstruct(row + 1, rows[2]);
      yca::fixSaturation(weights_, picture_.data_width, rows.data(), saturated_.data());
      for (const Imf::Rgba& texel : saturated_) {
        *rgb++ = texel.r;
        *rgb++ = texel.g;
        *rgb++ = texel.b;
      }
    }
  }

  const ExrPicture& picture_;
  std::size_t width_;
  ExrFile file_;
  Imf::InputPart input_;
  Imath::V3f weights_;
  std::vector<Imf::Rgba> line_;  // as stored: r = RY, g = Y, b = BY
  std::vector<Imf::Rgba> held_;  // decoded rows, kHeldRows of them
  std::vector<Imf::Rgba> rgb_;   // three rows
  std::vector<Imf::Rgba> saturated_;
  int held_first_ = 0;
  int held_end_ = 0;
};

}  // namespace

std::unique_ptr<RowReader> open_luminance_chroma(const ExrPicture& picture) {
  return std::make_unique<LuminanceChromaReader>(picture);
}

std::uint64_t luminance_chroma_bytes(int width) noexcept {
  return sizeof(Imf::Rgba) * (static_cast<std::uint64_t>(width) * (kHeldRows + 5) + yca::N);
}

int luminance_chroma_rows(int unit_rows) noexcept { return (kNaturalRows + unit_rows - 1) / unit_rows * unit_rows; }

}  // namespace welkin::codec
