#include "c_interface/options.h"

#include <limits>
#include <string>

#include "c_interface/enumeration.h"
#include "c_interface/error_status.h"
#include "c_interface/versioned_struct.h"

namespace welkin::c_interface {
namespace {

static_assert(WELKIN_MAXIMUM_BANDS == kMaximumBands);
static_assert(WELKIN_QUADRATURE_MIDPOINT == static_cast<int>(Quadrature::midpoint));
static_assert(WELKIN_NON_FINITE_REJECT == static_cast<int>(NonFinitePolicy::reject));
static_assert(WELKIN_NEGATIVE_REPLACE == static_cast<int>(NegativePolicy::replace));
static_assert(WELKIN_NEGATIVE_REJECT == static_cast<int>(NegativePolicy::reject));
static_assert(WELKIN_LAYOUT_LAT_LONG == static_cast<int>(Layout::lat_long));
static_assert(WELKIN_LAYOUT_HORIZONTAL_CROSS == static_cast<int>(Layout::horizontal_cross));
static_assert(WELKIN_LAYOUT_SIX_FILES == static_cast<int>(Layout::six_files));
static_assert(WELKIN_TRANSFER_SRGB == static_cast<int>(Transfer::srgb));
static_assert(WELKIN_TRANSFER_LINEAR == static_cast<int>(Transfer::linear));
static_assert(WELKIN_PRIMARIES_AS_STORED == static_cast<int>(Primaries::as_stored));

}  // namespace

ProjectionOptions projection_options(const welkin_projection_options* options) {
  const auto given = read_options(options, "options");
  ProjectionOptions wanted;
  if (given.bands != 0) wanted.bands = given.bands;
  wanted.quadrature = enumerator("quadrature", given.quadrature, Quadrature::midpoint);
  wanted.target_size = given.target_size;
  const bool preserve_colour = flag("clamp_preserve_colour", given.clamp_preserve_colour);
  if (given.clamp_maximum != 0.0F) wanted.clamp = RadianceClamp{given.clamp_maximum, preserve_colour};
  wanted.gamma = flag("gamma", given.gamma);
  wanted.nan = enumerator("nan", given.nan, NonFinitePolicy::reject);
  wanted.infinity = enumerator("infinity", given.infinity, NonFinitePolicy::reject);
  wanted.negative = enumerator("negative", given.negative, NegativePolicy::reject);
  return wanted;
}

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

}  // namespace welkin::c_interface
