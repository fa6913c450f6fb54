// What light is asked for in which frame. The same for every run, so that none can win by doing less.
#pragma once

#include <welkin/requests.h>

#include <cstddef>
#include <filesystem>
#include <string>
#include <variant>
#include <vector>

#include "turning_sky.h"
#include "welkin/bake_file.h"

namespace engine_loop {

/// A file that is streamed in, the changing sky, or pixels that are in memory and are moved in.
using Request = std::variant<welkin::ProjectFile, TurningSky, welkin::Project>;

struct Posting {
  std::size_t number = 0;  ///< from 0, in the order of posting
  std::string key;         ///< of requests of which only the newest counts; else empty
  Request request;
};

struct ScheduleOptions {
  int frames = 600;
  int sky_size = 256;     ///< edge of the changing cubemap, texels
  int level_size = 1024;  ///< edge of a level's cubemaps, texels
  std::vector<std::filesystem::path> files;
};

/// A new sun every third frame, a file every twelfth, and three times in a run a level that brings three large
/// cubemaps at once: about 0.3 s of one processor's time a second, level loads apart.
class Schedule {
 public:
  /// Makes the levels' pixels, too: nine cubemaps, 680 MB with 1024 texels per edge.
  explicit Schedule(const ScheduleOptions& options);

  /// Gives the postings of a frame away.
  [[nodiscard]] std::vector<Posting> take(int frame);

  /// Of all postings, by number.
  [[nodiscard]] const std::vector<std::string>& keys() const noexcept { return keys_; }

 private:
  void add(int frame, Request request, std::string key = {});

  std::vector<std::vector<Posting>> frames_;
  std::vector<std::string> keys_;
};

}  // namespace engine_loop
