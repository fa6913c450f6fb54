// Images and textures in files.
#include "files.h"

#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <filesystem>
#include <map>
#include <string>
#include <utility>

#include "arrays.h"
#include "bindings.h"
#include "call.h"
#include "harmonics.h"
#include "octahedral.h"
#include "results.h"
#include "source.h"
#include "welkin/bake_file.h"

namespace welkin::python {
namespace {

constexpr Named<Layout> kLayouts[] = {{"automatic", Layout::automatic},
                                      {"lat-long", Layout::lat_long},
                                      {"vertical-strip", Layout::vertical_strip},
                                      {"horizontal-strip", Layout::horizontal_strip},
                                      {"horizontal-cross", Layout::horizontal_cross},
                                      {"vertical-cross", Layout::vertical_cross},
                                      {"six-files", Layout::six_files}};
constexpr Named<Transfer> kTransfers[] = {
    {"automatic", Transfer::automatic}, {"srgb", Transfer::srgb}, {"linear", Transfer::linear}};
constexpr Named<Primaries> kPrimaries[] = {{"rec709", Primaries::rec709}, {"as-stored", Primaries::as_stored}};
constexpr Named<SampleType> kTypes[] = {{"automatic", SampleType::automatic},
                                        {"half", SampleType::half},
                                        {"float", SampleType::float32},
                                        {"uint8", SampleType::uint8},
                                        {"uint16", SampleType::uint16}};
constexpr Named<TexelFormat> kFormats[] = {{"rgba16f", TexelFormat::rgba16f},
                                           {"rgba32f", TexelFormat::rgba32f},
                                           {"b10g11r11", TexelFormat::b10g11r11},
                                           {"e5b9g9r9", TexelFormat::e5b9g9r9},
                                           {"bc6h_ufloat", TexelFormat::bc6h_ufloat},
                                           {"bc6h_sfloat", TexelFormat::bc6h_sfloat},
                                           {"astc_4x4_hdr", TexelFormat::astc_4x4_hdr},
                                           {"astc_6x6_hdr", TexelFormat::astc_6x6_hdr},
                                           {"uastc_hdr_4x4", TexelFormat::uastc_hdr_4x4}};
constexpr Named<Supercompression> kSupercompression[] = {
    {"none", Supercompression::none}, {"zlib", Supercompression::zlib}, {"zstd", Supercompression::zstd}};

constexpr Named<Bc6hEffort> kBc6hEfforts[] = {
    {"fast", Bc6hEffort::fast}, {"normal", Bc6hEffort::normal}, {"slow", Bc6hEffort::slow}};
constexpr Named<AstcEffort> kAstcEfforts[] = {{"fastest", AstcEffort::fastest},
                                              {"fast", AstcEffort::fast},
                                              {"medium", AstcEffort::medium},
                                              {"thorough", AstcEffort::thorough}};

/// An image that was read, with its pixels as an array.
struct ReadImage {
  EnvironmentInfo info;
  py::array pixels;
};

ReadImage image_of(Environment made) {
  const int face = made.face_size();
  std::vector<py::ssize_t> shape{made.info.height, made.info.width, 3};
  if (face > 0) shape = {6, face, face, 3};
  auto kept = std::make_shared<std::unique_ptr<float[]>>(std::move(made.pixels));
  const float* const first = kept->get();
  return {std::move(made.info), shown(std::move(shape), first, keeper(kept), true)};
}

py::dict info_of(const EnvironmentInfo& info) {
  py::list channels;
  for (const ChannelInfo& channel : info.channels) channels.append(py::make_tuple(channel.name, name(channel.type)));
  py::list levels;
  for (const LevelInfo& level : info.levels) levels.append(py::make_tuple(level.width, level.height));
  py::dict all;
  all["path"] = py::cast(info.path);
  all["format"] = info.format_description();
  all["layout"] = name(info.layout);
  all["layout_reason"] = info.layout_reason;
  all["width"] = info.width;
  all["height"] = info.height;
  all["compression"] = info.compression;
  all["storage"] = info.storage;
  all["channels"] = channels;
  all["levels"] = levels;
  all["parts"] = info.parts;
  all["layers"] = info.layers;
  all["notes"] = info.notes;
  return all;
}

ReadImage read_file(const py::object& file, const py::kwargs& given) {
  Options options("read", given);
  const FileInput input = input_of(file);
  const ReadOptions how = read_options(options);
  Call call("read", options);
  options.finish();
  return image_of(call.run([&](const Control& control) { return read_environment(input, how, control); }));
}

py::dict inspect_file(const py::object& file, const py::kwargs& given) {
  Options options("inspect", given);
  const FileInput input = input_of(file);
  const ReadOptions how = read_options(options);
  options.finish();
  return info_of([&] {
    const py::gil_scoped_release released;
    return inspect_environment(input, how);
  }());
}

py::dict measure_file(const py::object& file, const py::kwargs& given) {
  Options options("measure", given);
  const FileInput input = input_of(file);
  const ReadOptions how = read_options(options);
  Call call("measure", options);
  options.finish();
  const EnvironmentStatistics found =
      call.run([&](const Control& control) { return measure_environment(input, how, control); });
  py::dict all;
  all["texels"] = found.texels;
  all["minimum"] = array_of(found.minimum);
  all["maximum"] = array_of(found.maximum);
  all["mean"] = array_of(found.mean);
  all["total_radiance"] = array_of(found.total_radiance);
  all["nans"] = found.nans;
  all["infinities"] = found.infinities;
  all["negatives"] = found.negatives;
  all["brightest"] = array_of(found.brightest);
  all["brightest_direction"] = array_of(found.brightest_direction);
  return all;
}

WriteOptions write_options(const std::string& layout, const std::string& type) {
  return {value_of<Layout>("layout", layout, kLayouts), value_of<SampleType>("type", type, kTypes)};
}

py::dict report_of(const WriteReport& report) {
  py::dict all;
  all["files"] = py::cast(report.files);
  all["values_clamped"] = report.values_clamped;
  return all;
}

/// `layout` is that of the file; the pixels' own is a lat-long or faces.
py::dict write_file(const std::filesystem::path& path, const py::object& pixels, const std::string& layout,
                    const std::string& type, const py::kwargs& given) {
  Options options("write", given);
  const Source source = source_of(pixels, options);
  Call call("write", options);
  options.finish();
  const WriteOptions how = write_options(layout, type);
  return report_of(
      call.run([&](const Control& control) { return write_environment(path, source.view, how, control); }));
}

py::bytes encode(const std::string& name, const py::object& pixels, const std::string& layout, const std::string& type,
                 const py::kwargs& given) {
  Options options("encode", given);
  const Source source = source_of(pixels, options);
  Call call("encode", options);
  options.finish();
  const WriteOptions how = write_options(layout, type);
  std::vector<std::byte> bytes;
  call.run([&](const Control& control) { return write_environment({bytes, name}, source.view, how, control); });
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

struct Texture : Chain {
  std::string format;
  std::map<std::string, std::string> metadata;
};

Texture read_texture_file(const py::object& file, const py::kwargs& given) {
  Options options("read_texture", given);
  const FileInput input = input_of(file);
  std::uint64_t limit = std::uint64_t{8} << 30U;
  options.read("memory_limit", limit);
  Call call("read_texture", options);
  options.finish();
  CubemapTexture made = call.run([&](const Control& control) { return read_texture(input, limit, control); });
  return {Chain(std::move(made.cubemap)), std::move(made.format), std::move(made.metadata)};
}

TextureOptions texture_options(Options& options) {
  TextureOptions how;
  options.read("format", how.format, kFormats);
  options.read("supercompression", how.supercompression, kSupercompression);
  options.read("bc6h_effort", how.bc6h_effort, kBc6hEfforts);
  options.read("astc_effort", how.astc_effort, kAstcEfforts);
  options.read("metadata", how.metadata);
  return how;
}

/// A `Chain`, a list of levels, one cubemap, or a BRDF table or another image of one level.
py::dict write_texture_file(const std::filesystem::path& path, const py::object& texture, const py::kwargs& given) {
  Options options("write_texture", given);
  const TextureOptions how = texture_options(options);
  Call call("write_texture", options);
  if (py::isinstance<SharedOctahedral>(texture)) {
    options.finish();
    const std::shared_ptr<const OctahedralMap> map = texture.cast<const SharedOctahedral&>().map;
    return report_of(call.run([&](const Control& control) { return write_octahedral(path, *map, how, control); }));
  }
  const py::object table = py::isinstance<SharedBrdf>(texture) ? texture.attr("values") : texture;
  std::vector<Source> levels;
  if (py::isinstance<Chain>(texture) || py::isinstance<py::list>(texture)) {
    const py::object list = py::isinstance<Chain>(texture) ? texture.attr("levels") : texture;
    for (const py::handle level : list) levels.push_back(source_of(py::reinterpret_borrow<py::object>(level)));
  } else {
    levels.push_back(source_of(table, options));
  }
  options.finish();
  if (levels.size() == 1 && !levels[0].is_cubemap()) {
    const auto image = levels[0].view.lat_long();
    if (image.format != PixelFormat::rgb32f || image.row_stride_bytes != std::ptrdiff_t{12} * image.width) {
      throw Error(ErrorCode::invalid_argument,
                  "write_texture: a texture of two dimensions is packed, (height, width, 3) float32");
    }
    return report_of(call.run([&](const Control& control) {
      return write_texture_2d(path, image.width, image.height, static_cast<const float*>(image.pixels), how, control);
    }));
  }
  std::vector<CubemapView> views;
  for (const Source& level : levels) {
    if (!level.is_cubemap())
      throw Error(ErrorCode::invalid_argument, "write_texture: levels are cubemaps, (6, n, n, channels)");
    views.push_back(level.view.cubemap());
  }
  return report_of(call.run([&](const Control& control) { return write_texture(path, views, how, control); }));
}

py::dict write_env(const std::filesystem::path& path, const Chain& specular, const py::object& radiance) {
  const SphericalHarmonics harmonics = harmonics_of(radiance);
  return report_of([&] {
    const py::gil_scoped_release released;
    return write_babylon_environment(path, to_babylon(*specular.cubemap, harmonics));
  }());
}

}  // namespace

bool is_file(py::handle value) {
  return !py::isinstance<py::array>(value) && (py::isinstance<py::bytes>(value) || is_path(value));
}

FileInput input_of(const py::object& file) {
  if (py::isinstance<py::bytes>(file)) {
    const auto bytes = static_cast<std::string_view>(file.cast<py::bytes>());
    return {std::as_bytes(std::span(bytes)), {}};
  }
  if (!is_path(file)) {
    throw py::type_error("a file is a path or bytes; found " +
                         py::str(py::type::handle_of(file).attr("__name__")).cast<std::string>());
  }
  return file.cast<std::filesystem::path>();
}

ReadOptions read_options(Options& options) {
  ReadOptions how;
  options.read("layout", how.layout, kLayouts);
  options.read("part", how.part);
  options.read("layer", how.layer);
  options.read("level", how.level);
  options.read("element", how.element);
  options.read("transfer", how.transfer, kTransfers);
  options.read("primaries", how.primaries, kPrimaries);
  options.read("memory_limit", how.memory_limit_bytes);
  return how;
}

ReadOptions read_group(Options& options) {
  const py::dict given = options.group("read", false).value_or(py::dict());
  Options inner("read", given);
  ReadOptions how = read_options(inner);
  inner.finish();
  return how;
}

void bind_files(py::module_& module) {
  py::class_<ReadImage>(module, "Environment", "An image that was read: a lat-long, or six faces.")
      .def_readonly("pixels", &ReadImage::pixels, "(height, width, 3) or (6, n, n, 3), float32, not copied.")
      .def_property_readonly(
          "info", [](const ReadImage& self) { return info_of(self.info); },
          "What the file says of itself: a dictionary.")
      .def("__array__", [](const ReadImage& self, const py::args& words,
                           const py::kwargs& named) { return as_asked(self.pixels, words, named); })
      .def("__repr__", [](const ReadImage& self) {
        const bool cube = self.info.layout != Layout::lat_long;
        const std::string size =
            cube ? "cubemap of " + std::to_string(self.pixels.shape(1))
                 : "lat-long " + std::to_string(self.info.width) + " x " + std::to_string(self.info.height);
        return "<welkin.Environment: " + size + ", " + self.info.format_description() + ">";
      });
  py::class_<Texture, Chain>(module, "Texture", "A cubemap with its mips that was read.")
      .def_readonly("format", &Texture::format, "\"KTX2 rgba16f zstd\": for a person.")
      .def_readonly("metadata", &Texture::metadata, "KTX2's key/value data.")
      .def("__repr__", [](const Texture& self) {
        return "<welkin.Texture: " + self.format + ", cubemap of " + std::to_string(self.cubemap->size()) + ", " +
               counted(static_cast<std::size_t>(self.cubemap->levels()), "level") + ">";
      });
  module.def("read", &read_file, py::arg("file"),
             "read(file, *, layout='automatic', part='', layer='', level=0, element=0, transfer='automatic',\n"
             "     primaries='rec709', memory_limit=8589934592, progress=None, threads=None)\n"
             "--\n\n"
             "Reads an OpenEXR, Radiance .hdr, PFM, PNG, KTX2, KTX, DDS or .env file, given as a path or bytes.\n"
             "Returns an `Environment`.");
  module.def("inspect", &inspect_file, py::arg("file"),
             "inspect(file, *, layout='automatic', part='', layer='', level=0, element=0, transfer='automatic',\n"
             "        primaries='rec709', memory_limit=8589934592)\n"
             "--\n\n"
             "Reads the header only. Returns a dictionary.");
  module.def("measure", &measure_file, py::arg("file"),
             "measure(file, *, layout='automatic', part='', layer='', level=0, element=0, transfer='automatic',\n"
             "        primaries='rec709', memory_limit=8589934592, progress=None, threads=None)\n"
             "--\n\n"
             "Returns range, mean by solid angle, number of NaN and the brightest texel of a file as a\n"
             "dictionary. Streams the file.");
  module.def("write", &write_file, py::arg("path"), py::arg("pixels"), py::arg("layout") = "automatic",
             py::arg("type") = "automatic",
             "write(path, pixels, layout='automatic', type='automatic', *, encoding=None, read=None, progress=None, "
             "threads=None)\n"
             "--\n\n"
             "Writes .exr, .hdr, .pfm or .png, by the extension: complete or not at all. `layout`: that of the\n"
             "file. `type`: \"half\", \"float\", \"uint8\", \"uint16\". Returns {\"files\", \"values_clamped\"}.");
  module.def("encode", &encode, py::arg("name"), py::arg("pixels"), py::arg("layout") = "automatic",
             py::arg("type") = "automatic",
             "encode(name, pixels, layout='automatic', type='automatic', *, encoding=None, read=None, progress=None, "
             "threads=None)\n"
             "--\n\n"
             "Returns the bytes that `write` would write. The extension of `name` selects the format.");
  module.def("read_texture", &read_texture_file, py::arg("file"),
             "read_texture(file, *, memory_limit=8589934592, progress=None, threads=None)\n"
             "--\n\n"
             "Reads a .ktx2, .ktx or .dds cubemap with all its mips, identified by its first bytes. Returns a\n"
             "`Texture`.");
  module.def("write_texture", &write_texture_file, py::arg("path"), py::arg("texture"),
             "write_texture(path, texture, *, format='rgba16f', supercompression='none', bc6h_effort='normal',\n"
             "              astc_effort='medium', metadata=None, layout=None, encoding=None, read=None, progress=None, "
             "threads=None)\n"
             "--\n\n"
             "Writes a `Chain`, one cubemap, a list of levels (6, n, n, 3), a `BrdfTable` or an `OctahedralMap`\n"
             "to .ktx2, .ktx, .dds or .exr. `format`: \"rgba16f\", \"rgba32f\", \"b10g11r11\", \"e5b9g9r9\",\n"
             "\"bc6h_ufloat\", \"bc6h_sfloat\", \"astc_4x4_hdr\", \"astc_6x6_hdr\",\n"
             "\"uastc_hdr_4x4\". `supercompression` (.ktx2): \"none\",\n"
             "\"zlib\", \"zstd\". Returns {\"files\", \"values_clamped\"}.");
  module.def("write_env", &write_env, py::arg("path"), py::arg("specular"), py::arg("radiance"),
             "write_env(path, specular, radiance)\n"
             "--\n\n"
             "Writes a complete chain (size a power of two, down to 1 texel) and coefficients of radiance as\n"
             "Babylon.js's .env.");
}

}  // namespace welkin::python
