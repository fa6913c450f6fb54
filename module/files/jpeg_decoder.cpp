#include <cstdio>  // needed by jpeglib.h, which does not include it
// jpeglib.h must follow it.
#include <jpeglib.h>

#include <algorithm>
#include <csetjmp>
#include <exception>
#include <new>
#include <string>

#include "files/jpeg.h"
#include "files/row_source.h"
#include "platform/file.h"

namespace welkin::files {

// libjpeg ends a failed call by a jump, which must not pass over anything with a destructor: so each call stands in a
// separate function, `attempt`, and errors of our reading are kept until it has returned.
struct JpegDecoder::State {
  State(const FileInput& input, const JpegSegments& from) : image(from), file(open_file(input)) {
    file.seek(image.begin);
    decompress.err = jpeg_std_error(&errors);
    errors.error_exit = [](j_common_ptr common) { of(common).jump_out(); };
    // Its warnings are about damage: an image is either whole or refused.
    errors.emit_message = [](j_common_ptr common, int level) {
      if (level < 0) of(common).jump_out();
    };
    errors.output_message = [](j_common_ptr) {};
    decompress.client_data = this;
    attempt([](State& self) { jpeg_create_decompress(&self.decompress); });
    reader.init_source = [](j_decompress_ptr) {};
    reader.term_source = [](j_decompress_ptr) {};
    reader.resync_to_restart = jpeg_resync_to_restart;
    reader.fill_input_buffer = [](j_decompress_ptr of_reader) -> boolean {
      State& self = of(reinterpret_cast<j_common_ptr>(of_reader));
      if (!self.fill()) self.jump_out();
      return TRUE;
    };
    reader.skip_input_data = [](j_decompress_ptr of_reader, long count) {
      State& self = of(reinterpret_cast<j_common_ptr>(of_reader));
      if (!self.skip(count)) self.jump_out();
    };
    decompress.src = &reader;
  }

  ~State() { jpeg_destroy_decompress(&decompress); }
  State(const State&) = delete;
  State& operator=(const State&) = delete;

  static State& of(j_common_ptr common) { return *static_cast<State*>(common->client_data); }

  [[noreturn]] void jump_out() {
    errors.format_message(reinterpret_cast<j_common_ptr>(&decompress), message.data());
    std::longjmp(target, 1);  // NOLINT(cert-err52-cpp): libjpeg offers no other way out
  }

  /// Calls a function of libjpeg. Throws `Error`: corrupt_file, file_access.
  void attempt(void (*call)(State&)) {
    if (!returns(call)) {
      if (failure) std::rethrow_exception(failure);
      if (errors.msg_code == out_of_memory_code()) throw std::bad_alloc();
      throw platform::file_error(
          ErrorCode::corrupt_file, file.path(),
          "is a damaged JPEG: " +
              (decompress.output_scanline > 0 ? "near row " + std::to_string(decompress.output_scanline) + ", "
                                              : std::string()) +
              "libjpeg says \"" + platform::printable(message.data()) + "\"; fetch or export it again");
    }
  }

  bool returns(void (*call)(State&)) {
    if (setjmp(target) != 0) return false;  // NOLINT(cert-err52-cpp)
    call(*this);
    return true;
  }

  static int out_of_memory_code();

  bool fill() noexcept {
    const std::uint64_t left = file.position() < image.end ? image.end - file.position() : 0;
    const std::size_t count = std::min<std::uint64_t>(buffer.size(), left);
    try {
      if (count == 0) {
        throw platform::file_error(ErrorCode::corrupt_file, file.path(), "is a damaged JPEG: an image ends too early");
      }
      file.read(buffer.data(), count);
    } catch (...) {
      failure = std::current_exception();
      return false;
    }
    reader.next_input_byte = buffer.data();
    reader.bytes_in_buffer = count;
    return true;
  }

  bool skip(long count) noexcept {
    auto left = static_cast<std::size_t>(std::max(count, 0L));
    while (left > reader.bytes_in_buffer) {
      left -= reader.bytes_in_buffer;
      if (!fill()) return false;
    }
    reader.next_input_byte += left;
    reader.bytes_in_buffer -= left;
    return true;
  }

  JpegSegments image;
  platform::ByteFile file;
  jpeg_decompress_struct decompress{};
  jpeg_error_mgr errors{};
  jpeg_source_mgr reader{};
  std::jmp_buf target{};
  std::exception_ptr failure;
  std::uint8_t* row = nullptr;  // receives the next row
  std::array<char, JMSG_LENGTH_MAX> message{};
  std::array<JOCTET, 16384> buffer{};
};

// The number of libjpeg's message about memory is in a separate header, to be included as an enumeration.
namespace {
enum LibjpegMessage {
#define JMESSAGE(code, string) code,
#include <jerror.h>
};
}  // namespace

int JpegDecoder::State::out_of_memory_code() { return JERR_OUT_OF_MEMORY; }

JpegDecoder::JpegDecoder(const FileInput& input, const JpegSegments& image)
    : state_(std::make_unique<State>(input, image)) {
  state_->attempt([](State& self) {
    jpeg_read_header(&self.decompress, TRUE);
    self.decompress.out_color_space = self.image.components == 1 ? JCS_GRAYSCALE : JCS_RGB;
    self.decompress.dct_method = JDCT_ISLOW;
    jpeg_start_decompress(&self.decompress);
  });
  const jpeg_decompress_struct& now = state_->decompress;
  if (static_cast<int>(now.output_width) != image.width || static_cast<int>(now.output_height) != image.height ||
      now.output_components != image.components) {
    throw platform::file_error(ErrorCode::file_access, input.path(), "has changed while it was read; read it again");
  }
}

JpegDecoder::~JpegDecoder() = default;

std::size_t JpegDecoder::row_bytes() const noexcept {
  return static_cast<std::size_t>(state_->image.width) * static_cast<std::size_t>(state_->image.components);
}

void JpegDecoder::decode_row(std::uint8_t* row) {
  state_->row = row;
  state_->attempt([](State& self) {
    JSAMPROW rows = self.row;
    jpeg_read_scanlines(&self.decompress, &rows, 1);
    if (self.decompress.output_scanline == self.decompress.output_height) jpeg_finish_decompress(&self.decompress);
  });
}

std::uint64_t JpegDecoder::memory_bytes(const JpegSegments& image) noexcept {
  // Blocks of at most 32 x 32 texels, whose coefficients are kept, two bytes each, where an image has several scans;
  // else a few rows of them.
  constexpr std::uint64_t kBlock = 32, kOfLibrary = std::uint64_t{256} << 10U;
  const auto rounded = [](int texels) { return (static_cast<std::uint64_t>(texels) + kBlock - 1) / kBlock * kBlock; };
  const std::uint64_t rows = image.buffered ? rounded(image.height) : 4 * kBlock;
  return rounded(image.width) * rows * static_cast<std::uint64_t>(image.components) * 2 + kOfLibrary;
}

}  // namespace welkin::files
