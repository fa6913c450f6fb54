// Rows that are read one after the other, and projected while they are read.
#include "files/environment.h"
#include "files/row_source.h"
#include "support/catch.h"
#include "support/coefficients.h"
#include "support/exr_files.h"
#include "support/jobs.h"
#include "support/pfm_files.h"
#include "support/temporary_directory.h"
#include "support/thrown_error.h"
#include "welkin/core.h"
#include "welkin/environment_file.h"

namespace welkin::test {

// Promises: a sequential source is read in order, by one reader per section, each row once, whichever threads work on
// the rows meanwhile; and an error, a stop request or a failing task ends it without a further read.

namespace {

float value_at(int row, int column, int channel) { return static_cast<float>(row * 10 + column % 7 + channel); }

// The actions of a fake source's readers.
struct Log {
  std::atomic<int> readers_opened{0};
  std::atomic<int> readers_open{0};
  std::atomic<int> most_readers_open{0};
  std::atomic<bool> out_of_order{false};
  std::atomic<bool> two_at_once{false};
  std::atomic<bool> read_after_failure{false};
  std::atomic<int> rows_read{0};
};

struct Kind {
  int width = 512;
  int height = 512;
  int sections = 1;
  bool sequential = true;
  int failing_row = -1;
  int natural_rows = 4;
  std::function<void()> before_row_96;
};

// Long enough for the other threads to come to where they have to wait.
void let_others_come() { std::this_thread::sleep_for(std::chrono::milliseconds(5)); }

class FakeReader final : public files::RowReader {
 public:
  FakeReader(const Kind& kind, Log& log) : kind_(kind), log_(log) {
    ++log_.readers_opened;
    log_.most_readers_open = std::max(log_.most_readers_open.load(), ++log_.readers_open);
  }
  ~FakeReader() override { --log_.readers_open; }
  FakeReader(const FakeReader&) = delete;
  FakeReader& operator=(const FakeReader&) = delete;

  void read(int first_row, int row_count, float* rgb) override {
    if (busy_.exchange(true)) log_.two_at_once = true;
    const int section_rows = kind_.height / kind_.sections;
    if (next_row_ < 0 ? first_row % section_rows != 0 : first_row != next_row_) log_.out_of_order = true;
    if (failed_) log_.read_after_failure = true;
    if (kind_.failing_row >= first_row && kind_.failing_row < first_row + row_count) {
      failed_ = true;
      let_others_come();
      throw Error(ErrorCode::corrupt_file, "fake: row " + std::to_string(kind_.failing_row) + " is damaged");
    }
    if (first_row == 96 && kind_.before_row_96) kind_.before_row_96();
    for (int row = first_row; row < first_row + row_count; ++row) {
      for (int column = 0; column < kind_.width; ++column) {
        for (int channel = 0; channel < 3; ++channel) *rgb++ = value_at(row, column, channel);
      }
    }
    next_row_ = first_row + row_count;
    log_.rows_read += row_count;
    busy_ = false;
  }

 private:
  const Kind& kind_;
  Log& log_;
  std::atomic<bool> busy_{false};
  bool failed_ = false;
  int next_row_ = -1;
};

EnvironmentInfo describe(const Kind& kind, Layout layout) {
  EnvironmentInfo info;
  info.path = "fake";
  info.storage = "rows";
  info.compression = "none";
  info.layout = layout;
  info.width = kind.width;
  info.height = kind.height;
  return info;
}

class FakeSource final : public files::RowSource {
 public:
  explicit FakeSource(const Kind& kind, Layout layout = Layout::lat_long)
      : RowSource(describe(kind, layout),
                  {.natural_rows = kind.natural_rows,
                   .sections = kind.sections,
                   .sequential = kind.sequential,
                   .reader_bytes = 1000},
                  [this] { return std::make_unique<FakeReader>(kind_, log); }),
        kind_(kind) {}

  mutable Log log;

 private:
  Kind kind_;
};

constexpr std::uint64_t kPlenty = std::uint64_t{1} << 30U;

void check_order(const FakeSource& source) {
  CHECK(!source.log.out_of_order);
  CHECK(!source.log.two_at_once);
  CHECK(!source.log.read_after_failure);
  CHECK(source.log.readers_open == 0);
}

}  // namespace

TEST_CASE("rows of a sequential source come in order, once, from one reader a section", "[codec][streaming]") {
  for (const int sections : {1, 2, 4}) {
    for (const int rows : {1, 5, 16, 100, 1000}) {
      for (const int threads : {1, 2, 5}) {
        CAPTURE(sections, rows, threads);
        Kind kind;
        kind.sections = sections;
        const FakeSource source(kind);
        std::vector<int> seen(512, 0);
        std::atomic<bool> wrong{false};
        run_with_threads(threads, [&] {
          files::for_each_row_group(source, {rows, kPlenty}, {}, [&](const files::RowGroup& group) {
            for (int row = 0; row < group.row_count; ++row) {
              ++seen[static_cast<std::size_t>(group.first_row + row)];
              const float* texel = group.rgb + 3 * (row * 512 + 300);
              if (texel[2] != value_at(group.first_row + row, 300, 2)) wrong = true;
            }
          });
        });
        CHECK(!wrong);
        CHECK(std::all_of(seen.begin(), seen.end(), [](int count) { return count == 1; }));
        CHECK(source.log.readers_opened == sections);
        check_order(source);
      }
    }
  }
}

TEST_CASE("the next rows are decoded while others are worked on", "[codec][streaming]") {
  const FakeSource source(Kind{});
  std::atomic<int> at_work{0};
  std::atomic<bool> together{false};
  std::atomic<bool> given_up{false};
  run_with_threads(2, [&] {
    files::for_each_row_group(source, {64, kPlenty}, {}, [&](const files::RowGroup&) {
      ++at_work;
      // Until another group is at work too, or one has waited for that in vain.
      const auto met = [&] {
        if (at_work > 1) together = true;
        return together.load();
      };
      if (!given_up && !eventually(met)) given_up = true;
      --at_work;
    });
  });
  CHECK(together);
}

TEST_CASE("an error in a sequential reader comes out and nothing more is read", "[codec][streaming]") {
  for (const int sections : {1, 4}) {
    for (const int failing_row : {0, 77, 511}) {
      for (const int threads : {1, 2, 5}) {
        CAPTURE(sections, failing_row, threads);
        Kind kind;
        kind.sections = sections;
        kind.failing_row = failing_row;
        const FakeSource source(kind);
        run_with_threads(threads, [&] {
          const ThrownError error = thrown_by([&] {
            files::for_each_row_group(source, {8, kPlenty}, {}, [](const files::RowGroup&) {
              std::this_thread::sleep_for(std::chrono::microseconds(50));
            });
          });
          CHECK(error.code == ErrorCode::corrupt_file);
          CHECK(error.message == "fake: row " + std::to_string(failing_row) + " is damaged");
        });
        check_order(source);
      }
    }
  }
}

TEST_CASE("what a task throws ends the reading", "[codec][streaming]") {
  for (const bool sequential : {false, true}) {
    for (const int threads : {1, 2, 5}) {
      Kind kind;
      kind.sequential = sequential;
      const FakeSource source(kind);
      run_with_threads(threads, [&] {
        CHECK_THROWS_AS(files::for_each_row_group(source, {8, kPlenty}, {},
                                                  [](const files::RowGroup& group) {
                                                    if (group.first_row >= 96) throw std::range_error("enough");
                                                  }),
                        std::range_error);
      });
      CHECK(source.log.readers_open == 0);
      CHECK(source.log.rows_read < 512);
    }
  }
}

TEST_CASE("a sequential source is read whole, straight or scattered to faces", "[codec][streaming]") {
  Kind kind;
  kind.width = 384;
  kind.height = 288;
  for (const Layout layout : {Layout::lat_long, Layout::horizontal_cross}) {
    for (const int threads : {1, 3}) {
      const FakeSource source(kind, layout);
      run_with_threads(threads, [&] {
        const Environment environment = files::read_whole(source, {}, {});
        const bool cross = layout == Layout::horizontal_cross;
        const std::size_t index = cross ? std::size_t{4} * 96 * 96 * 3 : (std::size_t{96} * 384 + 96) * 3;
        CHECK(environment.pixels[index] == value_at(96, 96, 0));  // the first texel of +Z
      });
      check_order(source);
    }
  }
}

TEST_CASE("where memory for all threads lacks, one works alone, and less is refused", "[codec][streaming]") {
  for (const bool sequential : {false, true}) {
    Kind kind;
    kind.sequential = sequential;
    kind.sections = 4;
    run_with_threads(4, [&] {
      const std::uint64_t group = 8 * 512 * 12;
      const auto most_workers = [&](std::uint64_t limit) {
        const FakeSource source(kind);
        std::mutex mutex;
        std::size_t most = 0;
        files::for_each_row_group(source, {8, limit}, {}, [&](const files::RowGroup& rows) {
          std::this_thread::sleep_for(std::chrono::microseconds(200));
          const std::lock_guard lock(mutex);
          most = std::max(most, rows.worker + 1);
        });
        CHECK(source.log.readers_open == 0);
        if (most == 1) CHECK(source.log.most_readers_open == 1);
        return most;
      };
      CHECK(most_workers(4 * (group + 1000)) <= 4);
      CHECK(most_workers(4 * (group + 1000) - 1) == 1);
      CHECK(most_workers(group + 1000) == 1);
      const ThrownError error = thrown_by([&] { (void)most_workers(group + 999); });
      CHECK(error.code == ErrorCode::limit_exceeded);
      CHECK(error.message ==
            "fake: decoding 8 rows at once (rows, none) takes 50152 bytes, above the limit of 50151; raise the limit, "
            "or save it with smaller blocks");
    });
  }
}

// Promises: projecting a file while it is decoded gives the same bits as reading it whole and projecting that, on any
// number of threads and however the file is cut; what was done is on record; cancelling and progress work.

namespace {

ExrRecipe lat_long_recipe(int width, int height, Imf::Compression compression,
                          const std::optional<Imf::TileDescription>& tiles) {
  return {.width = width,
          .height = height,
          .compression = compression,
          .tiles = tiles,
          .channels = rgb_channels(Imf::FLOAT)};
}

}  // namespace

TEST_CASE("a streamed lat-long has the bits of one that is read whole", "[codec][slow]") {
  const TemporaryFile path("sky.exr");
  for (const auto& [width, height] : {std::pair{514, 257}, {30, 15}}) {
    const std::vector<float> pixels = some_pixels(width, height);
    for (const Imf::Compression compression : {Imf::NO_COMPRESSION, Imf::ZIP_COMPRESSION, Imf::DWAB_COMPRESSION}) {
      for (const auto& tiles : {std::optional<Imf::TileDescription>{}, std::optional{Imf::TileDescription(48, 40)},
                                std::optional{Imf::TileDescription(4096, 4096)}}) {
        CAPTURE(width, height, compression, tiles.has_value());
        write_exr(path, lat_long_recipe(width, height, compression, tiles), pixels);
        const Environment whole = read_environment(path);
        const Projection wanted = project(whole.lat_long());
        for (const int threads : {1, 5}) {
          run_with_threads(threads, [&] { CHECK(same_bits(project_file(path).radiance, wanted.radiance)); });
        }
      }
    }
  }
}

TEST_CASE("progress rises to 1, and a stop token ends the call", "[codec]") {
  const TemporaryDirectory directory;
  const std::filesystem::path sky = directory.file("sky.exr");
  const std::filesystem::path strip = directory.file("strip.pfm");
  write_exr(sky, lat_long_recipe(512, 256, Imf::ZIPS_COMPRESSION, std::nullopt), some_pixels(512, 256));
  write_bytes(strip, pfm_bytes(120, 720, false, "-1", some_pixels(120, 720)));
  for (const std::filesystem::path& path : {sky, strip}) {
    CAPTURE(path.string());
    std::vector<double> reports;
    Control control;
    control.progress = [&](double done) { reports.push_back(done); };
    (void)project_file(path, {}, {}, control);
    REQUIRE(!reports.empty());
    CHECK(std::is_sorted(reports.begin(), reports.end()));
    CHECK(reports.back() == 1.0);

    stop_source source;
    control.stop = source.get_token();
    control.progress = [&](double) { source.request_stop(); };
    CHECK(thrown_by([&] { (void)project_file(path, {}, {}, control); }).code == ErrorCode::cancelled);
    CHECK(thrown_by([&] { (void)read_environment(path, {}, control); }).code == ErrorCode::cancelled);
    CHECK(thrown_by([&] { (void)measure_environment(path, {}, control); }).code == ErrorCode::cancelled);
    CHECK(read_environment(path).pixels != nullptr);
  }
}

TEST_CASE("damage in the middle of a file is an error, not a half result", "[codec]") {
  const TemporaryFile path("damaged.exr");
  write_exr(path, lat_long_recipe(640, 320, Imf::ZIP_COMPRESSION, std::nullopt), some_pixels(640, 320));
  std::vector<char> bytes = read_bytes(path);
  std::fill_n(bytes.begin() + static_cast<std::ptrdiff_t>(bytes.size() / 2), 5000, '\x55');
  write_bytes(path, bytes);
  for (const int threads : {1, 2}) {
    run_with_threads(threads, [&] {
      check_thrown([&] { (void)project_file(path); }, ErrorCode::corrupt_file, {path.string() + ": "});
    });
  }
}

}  // namespace welkin::test
