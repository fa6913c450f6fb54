// The C interface to files.
#include "files/c_files.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <filesystem>
#include <iterator>
#include <limits>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "c/c_support.h"
#include "c/c_worker.h"
#include "platform/text.h"
#include "welkin/bake_file.h"
#include "welkin/environment_file.h"
#include "welkin/welkin.h"

namespace welkin::c_interface {
static_assert(WELKIN_LAYOUT_LAT_LONG == static_cast<int>(Layout::lat_long));
static_assert(WELKIN_LAYOUT_HORIZONTAL_CROSS == static_cast<int>(Layout::horizontal_cross));
static_assert(WELKIN_LAYOUT_SIX_FILES == static_cast<int>(Layout::six_files));
static_assert(WELKIN_TRANSFER_SRGB == static_cast<int>(Transfer::srgb));
static_assert(WELKIN_TRANSFER_LINEAR == static_cast<int>(Transfer::linear));

ReadOptions file_options(const welkin_read_options* options) {
  const auto given = read_options(options, "read_options");
  ReadOptions wanted;
  wanted.layout = enumerator("layout", given.layout, Layout::six_files);
  if (given.part != nullptr) wanted.part = given.part;
  if (given.layer != nullptr) wanted.layer = given.layer;
  wanted.transfer = enumerator("transfer", given.transfer, Transfer::linear);
  if (flag("primaries_as_stored", given.primaries_as_stored)) wanted.primaries = Primaries::as_stored;
  if (given.memory_limit_bytes != 0) wanted.memory_limit_bytes = given.memory_limit_bytes;
  if (given.level < 0 || given.level > std::numeric_limits<int>::max()) {
    refuse("level is " + std::to_string(given.level) + "; it must be 0 or a level that the file has");
  }
  wanted.level = static_cast<int>(given.level);
  if (given.element < 0 || given.element > std::numeric_limits<int>::max()) {
    refuse("element is " + std::to_string(given.element) + "; it must be 0 or one that the array has");
  }
  wanted.element = static_cast<int>(given.element);
  return wanted;
}

namespace {

/// Converts a path of the C interface, which is UTF-8.
std::filesystem::path file_path(const char* path) {
  require(path, "path");
  return platform::path_of(path);
}

}  // namespace
}  // namespace welkin::c_interface

// Functions of the C interface have no namespace.
using namespace welkin::c_interface;  // NOLINT(google-build-using-namespace,google-global-names-in-headers)

welkin_status welkin_project_file(const char* path, const welkin_read_options* read_options,
                                  const welkin_projection_options* options, const welkin_control* control,
                                  welkin_projection* projection) {
  return guarded([&] {
    const auto file = file_path(path);
    const auto wanted = projection_options(options);
    require_room(projection, wanted.bands);
    const auto light = welkin::project_file(file, file_options(read_options), wanted, control_of(control));
    write_projection(projection, light.radiance, light.diagnostics);
  });
}

welkin_status welkin_post_project_file(welkin_worker* worker, const char* path, const welkin_read_options* read_options,
                                       const welkin_projection_options* options, const welkin_post_options* post,
                                       welkin_job** job) {
  return guarded_post(worker, post, job, [&](Posting& /*posting*/) {
    return welkin::ProjectFile{file_path(path), file_options(read_options), projection_options(options)};
  });
}

welkin_status welkin_bake_file(const char* path, const welkin_read_options* read_options,
                               const welkin_bake_options* options, const welkin_control* control,
                               welkin_bake_result** result) {
  return guarded_making(result, "result", [&] {
    const welkin::BakeFile call{file_path(path), file_options(read_options), bake_options(options)};
    return new welkin_bake_result(call(control_of(control)));
  });
}

welkin_status welkin_post_bake_file(welkin_worker* worker, const char* path, const welkin_read_options* read_options,
                                    const welkin_bake_options* options, const welkin_post_options* post,
                                    welkin_job** job) {
  return guarded_post(worker, post, job, [&](Posting& /*posting*/) {
    return welkin::BakeFile{file_path(path), file_options(read_options), bake_options(options)};
  });
}

// Textures.

namespace welkin::c_interface {
static_assert(WELKIN_TEXEL_RGBA32F == static_cast<int>(TexelFormat::rgba32f));
static_assert(WELKIN_TEXEL_B10G11R11 == static_cast<int>(TexelFormat::b10g11r11));
static_assert(WELKIN_TEXEL_E5B9G9R9 == static_cast<int>(TexelFormat::e5b9g9r9));
static_assert(WELKIN_TEXEL_BC6H_UFLOAT == static_cast<int>(TexelFormat::bc6h_ufloat));
static_assert(WELKIN_TEXEL_BC6H_SFLOAT == static_cast<int>(TexelFormat::bc6h_sfloat));
static_assert(WELKIN_TEXEL_ASTC_4X4_HDR == static_cast<int>(TexelFormat::astc_4x4_hdr));
static_assert(WELKIN_TEXEL_ASTC_6X6_HDR == static_cast<int>(TexelFormat::astc_6x6_hdr));
static_assert(WELKIN_TEXEL_UASTC_HDR_4X4 == static_cast<int>(TexelFormat::uastc_hdr_4x4));
static_assert(WELKIN_SUPERCOMPRESSION_ZLIB == static_cast<int>(Supercompression::zlib));
static_assert(WELKIN_SUPERCOMPRESSION_ZSTD == static_cast<int>(Supercompression::zstd));

TextureOptions texture_options(const welkin_texture_options* options) {
  const auto given = read_options(options, "options");
  TextureOptions wanted;
  wanted.format = enumerator("format", given.format, TexelFormat::uastc_hdr_4x4);
  wanted.supercompression = enumerator("supercompression", given.supercompression, Supercompression::zstd);
  require_enumerator("effort", given.effort, WELKIN_EFFORT_SLOW);
  constexpr std::array bc6h{Bc6hEffort::normal, Bc6hEffort::fast, Bc6hEffort::fast, Bc6hEffort::normal,
                            Bc6hEffort::slow};
  constexpr std::array astc{AstcEffort::medium, AstcEffort::fastest, AstcEffort::fast, AstcEffort::medium,
                            AstcEffort::thorough};
  wanted.bc6h_effort = bc6h[static_cast<std::size_t>(given.effort)];
  wanted.astc_effort = astc[static_cast<std::size_t>(given.effort)];
  return wanted;
}

namespace {

/// Formats numbers as `inspect_stored_environment` reads them: separated by spaces, each read back as the same double.
std::string roughness_text(std::span<const MipRecord> mips) {
  std::string text;
  for (const MipRecord& mip : mips) {
    if (!text.empty()) text += ' ';
    text += platform::number_text(mip.roughness);
  }
  return text;
}

const float* packed_floats(const LatLongView& image) {
  const std::ptrdiff_t packed = std::ptrdiff_t{12} * image.width;
  const bool is_packed = image.row_stride_bytes == 0 || image.row_stride_bytes == packed;
  if (image.format != PixelFormat::rgb32f || !is_packed)
    refuse("mips is a flat image that is not packed RGB_F32; convert it");
  require(image.pixels, "mips->faces[0]");
  return static_cast<const float*>(image.pixels);
}

const welkin_chain& levels_of(const welkin_chain* chain, const char* name) {
  require(chain, name);
  return *chain;
}

/// Copies the chain to memory that can be rotated to another engine's axes.
Cubemap copy_of(const welkin_chain& chain) {
  Cubemap copy(chain.levels.front().size, static_cast<int>(chain.levels.size()), new_delete_resource());
  for (int level = 0; level < copy.levels(); ++level) {
    const CubemapView& from = chain.levels[static_cast<std::size_t>(level)];
    const auto edge = static_cast<std::size_t>(from.size);
    for (int face = 0; face < 6; ++face) {
      std::memcpy(copy.face(level, face), from.faces[static_cast<std::size_t>(face)], edge * edge * 3 * sizeof(float));
    }
  }
  return copy;
}

}  // namespace
}  // namespace welkin::c_interface

welkin_status welkin_write_texture(const char* path, const welkin_environment* mips, int32_t mip_count,
                                   const welkin_texture_options* options, const welkin_control* control,
                                   uint64_t* values_clamped) {
  return guarded([&] {
    const auto file = file_path(path);
    const auto wanted = texture_options(options);
    if (mips != nullptr && mip_count == 1) {
      const auto whole = environment_view(mips, "mips");
      if (whole.kind() == welkin::EnvironmentKind::lat_long) {
        const auto* const rgb = packed_floats(whole.lat_long());
        const auto report = welkin::write_texture_2d(file, whole.lat_long().width, whole.lat_long().height, rgb, wanted,
                                                     control_of(control));
        return tell(report.values_clamped, values_clamped);
      }
    }
    const auto views = cubemap_views(mips, mip_count);
    tell(welkin::write_texture(file, views, wanted, control_of(control)).values_clamped, values_clamped);
  });
}

welkin_status welkin_write_chain(const char* path, const welkin_chain* chain, const welkin_texture_options* options,
                                 const welkin_control* control, uint64_t* values_clamped) {
  return guarded([&] {
    const auto file = file_path(path);
    const auto& given = levels_of(chain, "chain");
    auto wanted = texture_options(options);
    if (!given.mips.empty()) wanted.metadata["welkin.roughness"] = roughness_text(given.mips);
    tell(welkin::write_texture(file, given.levels, wanted, control_of(control)).values_clamped, values_clamped);
  });
}

welkin_status welkin_write_babylon_environment(const char* path, const welkin_chain* specular, int32_t bands,
                                               const double* radiance, const welkin_control* control,
                                               uint64_t* values_clamped) {
  return guarded([&] {
    const auto file = file_path(path);
    const auto& chain = levels_of(specular, "specular");
    const auto light = read_harmonics(bands, radiance, "radiance");
    const auto report =
        welkin::write_babylon_environment(file, welkin::to_babylon(copy_of(chain), light), control_of(control));
    tell(report.values_clamped, values_clamped);
  });
}

// Tables of skies.

welkin_status welkin_sky_tables_save(const welkin_sky_tables* tables, const char* path) {
  return guarded([&] {
    const auto file = file_path(path);
    welkin::save_sky_tables(*tables_of(tables), file);
  });
}

welkin_status welkin_sky_tables_load(const char* path, uint64_t memory_limit_bytes, welkin_sky_tables** tables) {
  return guarded_making(tables, "tables", [&] {
    const auto file = file_path(path);
    auto loaded =
        memory_limit_bytes == 0 ? welkin::load_sky_tables(file) : welkin::load_sky_tables(file, memory_limit_bytes);
    return new welkin_sky_tables{std::make_shared<const welkin::SkyTables>(std::move(loaded))};
  });
}

welkin_status welkin_probes_write(const welkin_probes* probes, const char* path, const char* layouts) {
  return guarded([&] {
    require(probes, "probes");
    std::vector<welkin::ProbeLayout> wanted;
    for (std::string_view rest = layouts != nullptr ? layouts : ""; !rest.empty();) {
      const std::size_t comma = std::min(rest.find(','), rest.size());
      wanted.push_back(probe_layout(rest.substr(0, comma)));
      rest.remove_prefix(std::min(comma + 1, rest.size()));
    }
    welkin::write_probes(file_path(path), probes->probes, wanted);
  });
}

welkin_status welkin_probes_read(const char* path, welkin_probes** probes) {
  return guarded_making(probes, "probes", [&] { return new welkin_probes{welkin::read_probes(file_path(path))}; });
}
