#include "files/row_source.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <memory>
#include <mutex>
#include <string_view>
#include <system_error>
#include <vector>

#include "files/codecs.h"
#include "files/env.h"
#include "files/hdr.h"
#include "files/layout.h"
#include "files/pfm.h"
#include "files/textures.h"
#include "jobs/tiles.h"
#include "platform/file.h"
#include "platform/text.h"

namespace welkin::files {
namespace {

using namespace std::string_view_literals;

struct Signature {
  std::string_view bytes;
  const char* kind;
};

// Formats that are often passed by mistake, so that the refusal can name them.
constexpr std::array kOtherKinds{
    Signature{"II*\0"sv, "a TIFF"},
    Signature{"MM\0*"sv, "a TIFF"},
    Signature{"RIFF"sv, "a WebP, or another RIFF file"},
};

[[noreturn]] void refuse(const std::filesystem::path& path, std::string_view start) {
  const auto* known = std::find_if(kOtherKinds.begin(), kOtherKinds.end(),
                                   [&](const Signature& other) { return start.starts_with(other.bytes); });
  const std::string found = start.empty()                ? "is empty"
                            : known != kOtherKinds.end() ? std::string("is ") + known->kind
                                                         : "is not an image or texture that Welkin reads";
  throw platform::file_error(
      ErrorCode::unsupported_file, path,
      found +
          "; OpenEXR (.exr), Radiance (.hdr), PFM (.pfm), PNG, JPEG with a gain map, KTX2, KTX, DDS and .env are read: "
          "convert it");
}

std::unique_ptr<RowSource> open_by_first_bytes(platform::ByteFile& file, const ReadOptions& options) {
  const std::string start = first_bytes(file);
  if (start.starts_with("\x76\x2f\x31\x01"sv)) {
    return open_exr(file, options);
  }
  if (start.starts_with("PF"sv) || start.starts_with("Pf"sv)) {
    return open_pfm(file, options);
  }
  if (start.starts_with("#?"sv)) {
    return open_hdr(file, options);
  }
  if (start.starts_with("\x89PNG"sv)) {
    return open_png(file, options);
  }
  if (start.starts_with("\xff\xd8\xff"sv)) {
    return open_jpeg(file, options);
  }
  if (is_texture(start)) {
    return open_texture(file, options);
  }
  if (is_env(file)) {
    return open_env(file, options);
  }
  refuse(file.path(), start);
}

/// Throws `Error` (unsupported_file) if a part, layer, level or element is requested and the format has only one. The
/// readers of formats that have several check the request themselves.
void refuse_other_selections(const EnvironmentInfo& info, const ReadOptions& options) {
  const FileFormat format = info.format;
  const bool is_texture = format == FileFormat::ktx2 || format == FileFormat::ktx1 || format == FileFormat::dds;
  if (!is_texture) require_element(info.path, 1, options.element);
  if (format == FileFormat::openexr) return;
  if (!is_texture && format != FileFormat::babylon) require_level(info, 1, options.level);
  const auto refuse_name = [&](const char* what, const std::string& asked_for, const char* option) {
    throw platform::file_error(ErrorCode::unsupported_file, info.path,
                               std::string("has no ") + what + " \"" + platform::printable(asked_for) +
                                   "\": only OpenEXR files have " + what + "s; leave " + option + " out");
  };
  if (!options.part.empty() && options.part != "0") refuse_name("part", options.part, "--part");
  if (!options.layer.empty()) refuse_name("layer", options.layer, "--layer");
}

}  // namespace

platform::ByteFile open_file(const FileInput& input) {
  if (!input.faces().empty()) {
    throw platform::file_error(ErrorCode::invalid_argument, input.path(),
                               "is one of six faces of a cubemap, and a single file is needed here; read "
                               "them with read_environment");
  }
  return platform::ByteFile(input.path(), input.bytes());
}

std::string first_bytes(platform::ByteFile& file) {
  std::string bytes(static_cast<std::size_t>(std::min<std::uint64_t>(8, file.size())), '\0');
  file.seek(0);
  file.read(bytes.data(), bytes.size());
  file.seek(0);
  return bytes;
}

FileInput input_of(const platform::ByteFile& file) {
  return file.memory() ? FileInput(*file.memory(), platform::utf8(file.path())) : FileInput(file.path());
}

std::unique_ptr<RowSource> open_image(const FileInput& input, const ReadOptions& options) {
  platform::ByteFile file = open_file(input);
  std::unique_ptr<RowSource> image = open_by_first_bytes(file, options);
  refuse_other_selections(image->info(), options);
  return image;
}

std::unique_ptr<RowSource> open_row_source(const FileInput& input, const ReadOptions& options) {
  if (!input.faces().empty()) {
    if (options.layout != Layout::automatic && options.layout != Layout::six_files) {
      throw platform::file_error(ErrorCode::invalid_argument, input.path(),
                                 std::string("is one of six faces of a cubemap, and was requested as a ") +
                                     name(options.layout) + "; leave the layout out");
    }
    return open_six_files(input, six_inputs(input), options, "six faces were given");
  }
  if (options.layout == Layout::six_files) {
    return open_six_files(input, six_inputs(input), options, "six-files was requested");
  }
  std::error_code ignored;
  if (options.layout == Layout::automatic && !input.bytes() && std::filesystem::is_directory(input.path(), ignored)) {
    return open_six_files(input, six_inputs(input), options, "the directory holds the six faces of one cube");
  }
  std::unique_ptr<RowSource> image = open_image(input, options);
  if (image->info().layout != Layout::six_files) {
    return image;
  }
  std::vector<FileInput> faces;
  try {
    faces = six_inputs(input);
  } catch (const Error& failure) {
    refuse_square(image->info(), failure.what());
  }
  return open_six_files(input, faces, options, image->info().layout_reason);
}

namespace {

using Clock = std::chrono::steady_clock;

// Texels from which a task is worth its start, and from which waking the pool is.
constexpr std::int64_t kTexelsPerTask = 32 * 1024;
constexpr std::int64_t kTexelsForPool = 64 * 1024;

// Sections one after the other, each cut into groups from its top.
struct Cut {
  Cut(const RowSource& source, int rows)
      : section_rows(source.section_rows()),
        group_rows(std::min(rows, section_rows)),
        sections(static_cast<std::size_t>(source.traits().sections)),
        groups_per_section(static_cast<std::size_t>((section_rows + group_rows - 1) / group_rows)) {}

  [[nodiscard]] RowGroup group(std::size_t section, std::size_t index) const {
    const int first = static_cast<int>(index) * group_rows;
    return {static_cast<int>(section) * section_rows + first, std::min(group_rows, section_rows - first), nullptr, 0};
  }

  int section_rows;
  int group_rows;
  std::size_t sections;
  std::size_t groups_per_section;
};

struct Worker {
  std::unique_ptr<RowReader> reader;
  std::vector<float> rows;
};

// A section of a sequential source: the thread that holds the lock reads the next group.
struct Turns {
  std::mutex mutex;
  std::unique_ptr<RowReader> reader;
  std::size_t next_group = 0;
  bool failed = false;
};

class Run {
 public:
  // `in_place`: receives the whole image, or nullptr if each worker has memory of its own for a group.
  Run(const RowSource& source, const RowGroups& groups, const Control& control, float* in_place)
      : source_(source),
        cut_(source, groups.rows),
        control_(control),
        in_place_(in_place),
        row_floats_(std::size_t{3} * static_cast<std::size_t>(source.info().width)),
        place_(placement(groups.memory_limit_bytes)),
        workers_(jobs::worker_count(place_)),
        turns_(source.traits().sequential ? cut_.sections : 0) {}

  std::chrono::nanoseconds operator()(const std::function<void(const RowGroup&)>& work) {
    const std::size_t count = cut_.sections * cut_.groups_per_section;
    jobs::run_tiles(count, place_, workers_.size(), control_, [&](std::size_t tile, std::size_t worker) {
      const std::size_t section = tile / cut_.groups_per_section;
      RowGroup group;
      if (source_.traits().sequential) {
        if (!read_in_turn(section, worker, group)) return;
      } else {
        group = cut_.group(section, tile % cut_.groups_per_section);
        read(workers_[worker].reader, worker, group);
      }
      work(group);
    });
    return Clock::duration(decoding_.load());
  }

 private:
  [[nodiscard]] std::uint64_t buffer_bytes() const {
    return in_place_ != nullptr ? 0 : rgb_bytes(source_.info().width, cut_.group_rows);
  }

  [[nodiscard]] jobs::Placement placement(std::uint64_t limit) const {
    const EnvironmentInfo& info = source_.info();
    const std::uint64_t reader = source_.traits().reader_bytes;
    const std::uint64_t buffer = buffer_bytes();
    const std::uint64_t alone = reader + buffer;
    if (alone > limit) {
      throw platform::file_error(ErrorCode::limit_exceeded, info.path,
                                 "decoding " + std::to_string(cut_.group_rows) + " rows at once (" + info.storage +
                                     ", " + info.compression + ") takes " + std::to_string(alone) + " bytes, above " +
                                     (in_place_ != nullptr ? "what the image leaves of the limit, " : "the limit of ") +
                                     std::to_string(limit) + "; raise the limit, or " +
                                     source_.traits().smaller_reader);
    }
    const bool small = std::int64_t{info.width} * info.height < kTexelsForPool;
    const bool nothing_to_share = source_.traits().sequential && cut_.sections == 1 && in_place_ != nullptr;
    const std::uint64_t threads = jobs::worker_count(jobs::Placement::arena);
    const std::uint64_t readers = source_.traits().sequential ? cut_.sections : threads;
    const std::uint64_t left = limit - alone;  // for all readers and buffers but the first
    const bool too_much = exceeds(readers - 1, reader, left) || exceeds(threads - 1, buffer, left) ||
                          (readers - 1) * reader > left - (threads - 1) * buffer;
    return small || nothing_to_share || too_much ? jobs::Placement::calling_thread : jobs::Placement::arena;
  }

  static bool exceeds(std::uint64_t count, std::uint64_t bytes, std::uint64_t limit) {
    return count > 0 && bytes > limit / count;
  }

  void read(std::unique_ptr<RowReader>& reader, std::size_t worker, RowGroup& group) {
    const Clock::time_point start = Clock::now();
    if (!reader) reader = source_.open_reader();
    float* rgb = nullptr;
    if (in_place_ != nullptr) {
      rgb = in_place_ + static_cast<std::size_t>(group.first_row) * row_floats_;
    } else {
      workers_[worker].rows.resize(row_floats_ * static_cast<std::size_t>(cut_.group_rows));
      rgb = workers_[worker].rows.data();
    }
    reader->read(group.first_row, group.row_count, rgb);
    group.rgb = rgb;
    group.worker = worker;
    decoding_ += (Clock::now() - start).count();
  }

  // A section has as many tiles as groups, so each tile finds one to read. Returns false after an error, which the
  // thread that met it is passing on to the caller.
  bool read_in_turn(std::size_t section, std::size_t worker, RowGroup& group) {
    Turns& turns = turns_[section];
    const std::lock_guard lock(turns.mutex);
    if (turns.failed) return false;
    jobs::throw_if_cancelled(control_);
    turns.failed = true;  // until it has been read
    group = cut_.group(section, turns.next_group);
    read(turns.reader, worker, group);
    turns.failed = false;
    if (++turns.next_group == cut_.groups_per_section) turns.reader.reset();
    return true;
  }

  const RowSource& source_;
  Cut cut_;
  const Control& control_;
  float* in_place_;
  std::size_t row_floats_;
  jobs::Placement place_;
  std::vector<Worker> workers_;
  std::vector<Turns> turns_;
  std::atomic<Clock::rep> decoding_{0};
};

}  // namespace

int comfortable_group_rows(const RowSource& source) {
  const std::int64_t natural = source.traits().natural_rows;
  const std::int64_t texels = natural * source.info().width;
  const std::int64_t rows = natural * ((kTexelsPerTask + texels - 1) / texels);
  return static_cast<int>(std::min<std::int64_t>(rows, source.section_rows()));
}

std::chrono::nanoseconds for_each_row_group(const RowSource& source, const RowGroups& groups, const Control& control,
                                            const std::function<void(const RowGroup&)>& work) {
  return Run(source, groups, control, nullptr)(work);
}

void read_all_rows(const RowSource& source, std::uint64_t memory_limit_bytes, const Control& control, float* rgb) {
  const RowGroups groups{comfortable_group_rows(source), memory_limit_bytes};
  static_cast<void>(Run(source, groups, control, rgb)([](const RowGroup&) {}));
}

}  // namespace welkin::files
