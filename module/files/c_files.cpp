// The C interface to files.
#include <limits>
#include <string>

#include "c/c_projection.h"
#include "c/c_support.h"
#include "c/c_worker.h"
#include "welkin/environment_file.h"
#include "welkin/file_requests.h"
#include "welkin/welkin.h"

namespace welkin::c_interface {
namespace {

static_assert(WELKIN_LAYOUT_LAT_LONG == static_cast<int>(Layout::lat_long));
static_assert(WELKIN_LAYOUT_HORIZONTAL_CROSS == static_cast<int>(Layout::horizontal_cross));
static_assert(WELKIN_LAYOUT_SIX_FILES == static_cast<int>(Layout::six_files));
static_assert(WELKIN_TRANSFER_SRGB == static_cast<int>(Transfer::srgb));
static_assert(WELKIN_TRANSFER_LINEAR == static_cast<int>(Transfer::linear));
static_assert(WELKIN_PRIMARIES_AS_STORED == static_cast<int>(Primaries::as_stored));

ReadOptions file_options(const welkin_read_options* options) {
  const auto given = read_options(options, "read_options");
  ReadOptions wanted;
  wanted.layout = enumerator("layout", given.layout, Layout::six_files);
  if (given.part != nullptr) wanted.part = given.part;
  if (given.layer != nullptr) wanted.layer = given.layer;
  wanted.transfer = enumerator("transfer", given.transfer, Transfer::linear);
  wanted.primaries = enumerator("primaries", given.primaries, Primaries::as_stored);
  if (given.memory_limit_bytes != 0) wanted.memory_limit_bytes = given.memory_limit_bytes;
  if (given.level < 0 || given.level > std::numeric_limits<int>::max()) {
    refuse("level is " + std::to_string(given.level) + "; it must be 0 or a level that the file has");
  }
  wanted.level = static_cast<int>(given.level);
  return wanted;
}

}  // namespace
}  // namespace welkin::c_interface

// Entries of C have no namespace to be in.
using namespace welkin::c_interface;  // NOLINT(google-build-using-namespace,google-global-names-in-headers)

welkin_status welkin_project_file(const char* path, const welkin_read_options* read_options,
                                  const welkin_projection_options* options, const welkin_control* control,
                                  welkin_projection* projection) {
  return guarded([&] {
    require(path, "path");
    const auto wanted = projection_options(options);
    require_room(projection, wanted.bands);
    write_projection(projection, welkin::project_file(path, file_options(read_options), wanted, control_of(control)));
    return WELKIN_OK;
  });
}

welkin_status welkin_post_project_file(welkin_worker* worker, const char* path, const welkin_read_options* read_options,
                                       const welkin_projection_options* options, const welkin_post_options* post,
                                       welkin_job** job) {
  return guarded_post(worker, post, job, [&](Posting& posting) {
    require(path, "path");
    welkin::ProjectFile request{path, file_options(read_options), projection_options(options)};
    welkin::c_interface::post(worker, std::move(request), posting, job);
  });
}
