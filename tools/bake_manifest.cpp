#include "tools/bake_manifest.h"

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <system_error>
#include <thread>
#include <utility>

#include "jobs/control.h"
#include "platform/text.h"
#include "tools/terminal.h"
#include "tools/text.h"
#include "welkin/core.h"

namespace welkin::tool {
namespace {

[[noreturn]] void fail_folder(const std::filesystem::path& path, const std::string& what, const std::string& reason) {
  throw Error(ErrorCode::file_access,
              platform::utf8(path) + ": " + what + " (" + reason + "); pass a folder to -o that you may write to");
}

/// Returns a remark with files and the cache named without their folders, by `portable_path`, and the input by the name
/// that it is to have.
std::string portable_note(std::string note, const BakeCommandOptions& options) {
  const std::string input = options.input.value_or("");
  if (!options.called.empty() && !input.empty()) note = replaced(note, input, options.called);
  for (const std::string& path : {input, options.common.cache, options.directory}) {
    if (platform::path_of(path).is_absolute()) note = replaced(note, path, portable_path(path));
  }
  return note;
}

Json notes_json(const std::vector<std::string>& notes, const BakeCommandOptions& options) {
  return json_list(notes, [&](const std::string& note) { return portable_note(note, options); });
}

Json source_json(const Source& source, const BakeCommandOptions& options) {
  return {{"path", options.called.empty() ? portable_path(source.path) : options.called},
          {"layout", source.layout},
          {"width", source.width},
          {"height", source.height},
          {"format", source.format},
          {"notes", notes_json(source.notes, options)}};
}

Json axes_json(const BakeCommandOptions& options) {
  const Convention& engine = convention(options.orientation.to);
  return {{"engine", engine.name},
          {"words", engine.axes},
          {"faces", "+X -X +Y -Y +Z -Z, row 0 on top, frames as OpenGL, Vulkan and Direct3D have them"}};
}

Json options_json(const Baked& baked, const BakeCommandOptions& options) {
  const PrefilterOptions& specular = *baked.whole.specular;
  const PixelPolicy& pixels = baked.whole.pixels;
  Json json = {{"size", specular.size},
               {"mips", specular.mips.value()},
               {"roughness", roughness_words(options)},
               {"fit_lookups", !specular.lobe_roughness.empty()},
               {"method", welkin::name(specular.method)},
               {"rms_error", specular.rms_error},
               {"maximum_error", specular.texel_bound()},
               {"background_size", options.background_size},
               {"irradiance_size", options.irradiance_size},
               {"irradiance_method", kIrradianceMethods.at(static_cast<std::size_t>(options.irradiance_method))},
               {"bands", options.bake.bands},
               {"from", convention(options.orientation.from).name},
               {"yaw_degrees", options.orientation.yaw_degrees},
               {"mirror", options.orientation.mirror},
               {"rotation",
                {options.orientation.rotation.x, options.orientation.rotation.y, options.orientation.rotation.z,
                 options.orientation.rotation.w}},
               {"clamp", nullptr},
               {"gamma", pixels.gamma}};
  if (pixels.clamp) {
    json["clamp"] = pixels.clamp->maximum;
    json["preserve_clamped"] = pixels.clamp->preserve_colour;
  }
  return json;
}

Json file_json(const WrittenFile& file) {
  Json json = {{"name", file.name},
               {"what", file.what},
               {"format", file.format},
               {"bytes", file.bytes},
               {"values_clamped", file.values_clamped}};
  if (file.share_clamped > 0.0) json["share_clamped"] = file.share_clamped;
  if (file.details.is_null()) return json;
  for (const auto& [key, value] : file.details.members()) json[key] = value;
  return json;
}

Json made_json(const MipRecord& mip) {
  return {{"size", mip.size},
          {"method", name(mip.method)},
          {"bands", mip.bands},
          {"bright_texels", mip.bright_texels},
          {"error_estimate", mip.error_estimate},
          {"mean", json_triple(mip.mean)}};
}

Json mip_json(const MipRecord& mip, std::size_t number) {
  Json json = {{"mip", number},
               {"roughness", mip.roughness},
               {"alpha", mip.roughness * mip.roughness},
               {"lobe_roughness", mip.lobe_roughness},
               {"error_between", mip.error_between}};
  const Json made = made_json(mip);
  for (const auto& [key, value] : made.members()) json[key] = value;
  return json;
}

Json mips_json(const std::vector<MipRecord>& mips) {
  Json list = Json::array();
  for (const MipRecord& mip : mips) list.push_back(mip_json(mip, list.size()));
  return list;
}

Json sun_json(const Baked& baked, const BakeCommandOptions& options) {
  if (!baked.sun) return nullptr;
  OrientationOptions to_engine;
  to_engine.to = options.orientation.to;
  return {{"direction", json_triple(light_rotation(to_engine, false) * baked.sun->direction)},
          {"irradiance", json_triple(baked.sun->irradiance)},
          {"solid_angle", baked.sun->solid_angle},
          {"angular_radius_degrees", baked.sun->angular_radius_degrees}};
}

Json diagnostics_json(const Baked& baked) {
  const ProjectionDiagnostics& diagnostics = baked.light.diagnostics;
  return {{"texels", diagnostics.texels},
          {"nans_replaced", diagnostics.nans_replaced},
          {"infinities_replaced", diagnostics.infinities_replaced},
          {"negatives_replaced", diagnostics.negatives_replaced},
          {"clamped", diagnostics.texels_clamped},
          {"total_radiance_before_clamp", json_triple(diagnostics.total_radiance_before_clamp)},
          {"total_radiance", json_triple(diagnostics.total_radiance)},
          {"harmonics_error_estimate", diagnostics.error_estimate}};
}

/// Returns everything that differs from run to run.
Json times_json(const Baked& baked) {
  Json list = Json::array();
  for (const auto* passes : {&baked.light.diagnostics.passes, &baked.passes}) {
    for (const PassRecord& pass : *passes) {
      list.push_back(
          {{"name", pass.name}, {"action", name(pass.action)}, {"reason", pass.reason}, {"ms", pass.milliseconds}});
    }
  }
  const std::vector<PassRecord>& passes = baked.light.diagnostics.passes;
  const bool reused = std::any_of(passes.begin(), passes.end(), [](const PassRecord& pass) {
    return pass.name == "specular" && pass.action == PassAction::reuse;
  });
  const std::vector<MipRecord> mips = baked.light.specular ? baked.light.specular->mips : std::vector<MipRecord>();
  for (std::size_t mip = 0; mip < mips.size(); ++mip) {
    const MipRecord& record = mips[mip];
    const bool taken = reused || record.milliseconds == 0.0;  // a single mip too: a cache found it
    list.push_back({{"name", "specular mip " + std::to_string(mip)},
                    {"action", name(taken ? PassAction::reuse : PassAction::run)},
                    {"reason", name(record.method)},
                    {"ms", taken ? 0.0 : record.milliseconds}});
  }
  return list;
}

// The files of a folder that an earlier run wrote.

constexpr const char* kRemedy = "; move it away, or pass another folder to -o";

[[noreturn]] void refuse(const std::filesystem::path& path, const std::string& what) {
  throw Error(ErrorCode::file_access, platform::utf8(path) + ": " + what + kRemedy);
}

/// Checks the target of a link, because that would be replaced.
void require_replaceable(const std::filesystem::path& path) {
  std::error_code unknown;
  const std::filesystem::file_status status = std::filesystem::status(path, unknown);
  if (std::filesystem::is_directory(status)) refuse(path, "is a folder where a file must be written");
  if (std::filesystem::exists(status) && !std::filesystem::is_regular_file(status)) {
    refuse(path, "is not a regular file where one must be written");
  }
}

/// Returns whether the name exists, also as a link whose target is missing.
bool is_there(const std::filesystem::path& path) {
  std::error_code unknown;
  return std::filesystem::exists(std::filesystem::symlink_status(path, unknown));
}

const Json* member(const Json& object, std::string_view name) {
  if (!object.is_object()) return nullptr;
  const auto found = std::ranges::find(object.members(), name, &std::pair<std::string, Json>::first);
  return found == object.members().end() ? nullptr : &found->second;
}

/// Returns the list of files in a list of the command; nothing if the file is not one.
std::optional<Json> files_listed_in(const std::filesystem::path& path) {
  try {
    const Json list = read_json_file(path, "");
    const Json* const version = member(list, "welkin");
    const Json* const files = member(list, "files");
    if (version == nullptr || !version->is_text() || files == nullptr || !files->is_array()) return std::nullopt;
    return *files;
  } catch (const Flaw&) {
    return std::nullopt;
  } catch (const Error& error) {
    if (error.code() == ErrorCode::limit_exceeded) return std::nullopt;
    if (!is_there(path)) return Json::array();  // another run has removed it
    throw;
  }
}

}  // namespace

OwnFiles::OwnFiles(std::filesystem::path folder, const FileSet& set) : folder_(std::move(folder)), set_(set) {
  // Another run may begin or end meanwhile; at any time one of these exists.
  for (const std::filesystem::path& list : {folder_ / set_.index, unfinished(), folder_ / set_.index}) add_listed(list);
}

std::filesystem::path OwnFiles::unfinished() const { return folder_ / (std::string("unfinished_") + set_.index); }

/// Adds the names of a list. It may be forged: names that the command does not use, or in other folders, are ignored.
void OwnFiles::add_listed(const std::filesystem::path& list) {
  if (!is_there(list)) return;
  require_replaceable(list);
  const std::optional<Json> files = files_listed_in(list);
  if (!files)
    refuse(list,
           std::string("is there and was not written by 'welkin ") + set_.command + "', which would overwrite it");
  for (const Json& file : files->elements()) {
    const Json* const name = member(file, "name");
    const Json* const bytes = member(file, "bytes");
    if (name == nullptr || !name->is_text() || !set_.has_name(name->text())) continue;
    std::optional<std::uint64_t>& length = listed_[name->text()];
    if (bytes != nullptr && bytes->is_whole_number() && bytes->number() >= 0.0)
      length = static_cast<std::uint64_t>(bytes->number());
  }
}

void OwnFiles::require(const std::vector<std::string>& names) const {
  for (const std::string& name : names) {
    const std::filesystem::path path = folder_ / name;
    require_replaceable(path);
    if (name == set_.index || listed_.contains(name) || !is_there(path)) continue;
    refuse(path, std::string("is there and was not written by 'welkin ") + set_.command + "' (" + set_.index +
                     " does not list it), which would overwrite it");
  }
}

void OwnFiles::begin(const std::vector<std::string>& names) const {
  require(names);
  Json files = Json::array();
  for (const auto& [name, bytes] : listed_) files.push_back({{"name", name}, {"bytes", bytes}});
  for (const std::string& name : names) {
    if (!listed_.contains(name)) files.push_back({{"name", name}, {"bytes", nullptr}});
  }
  write_text_file(unfinished(),
                  json_text({{"welkin", WELKIN_VERSION_STRING},
                             {"what", "a set of files that is being written, or whose writer was stopped"},
                             {"files", files}}));
  std::error_code trouble;
  std::filesystem::remove(folder_ / set_.index, trouble);
  if (trouble) refuse(folder_ / set_.index, "cannot be replaced (" + trouble.message() + ')');
}

std::vector<std::string> OwnFiles::finish(const std::string& index, const std::vector<std::string>& written,
                                          const std::vector<std::filesystem::path>& read) const {
  write_text_file(folder_ / set_.index, index);
  std::vector<std::string> removed;
  std::vector<std::string> left;
  std::error_code trouble;
  for (const auto& [name, bytes] : listed_) {
    const std::filesystem::path path = folder_ / name;
    if (std::ranges::find(written, name) != written.end()) continue;
    const auto type = std::filesystem::symlink_status(path, trouble).type();
    if (type == std::filesystem::file_type::not_found) continue;
    const bool is_read = std::ranges::any_of(read, [&](const auto& file) { return is_same_file(file, path); });
    const bool is_as_written =
        type == std::filesystem::file_type::regular && bytes == std::filesystem::file_size(path, trouble);
    const bool is_gone = !is_read && is_as_written && std::filesystem::remove(path, trouble);
    (is_gone ? removed : left).push_back(name);
  }
  std::filesystem::remove(unfinished(), trouble);
  std::vector<std::string> remarks;
  const std::string earlier = std::string("an earlier '") + set_.command + "'";
  if (!removed.empty())
    remarks.push_back("removed, because " + earlier + " wrote it and this one does not: " + joined(removed));
  if (!left.empty())
    remarks.push_back("kept next to the new files, because it is read or has changed since " + earlier +
                      " wrote it: " + joined(left));
  return remarks;
}

void check_output_folder(const std::filesystem::path& path) {
  std::error_code trouble;
  if (path.empty()) fail_folder("-o", "names no folder", "it is empty");
  std::filesystem::path there = std::filesystem::absolute(path, trouble);
  while (!std::filesystem::exists(std::filesystem::symlink_status(there, trouble)) && there.has_relative_path()) {
    there = there.parent_path();
  }
  if (!std::filesystem::is_directory(there, trouble)) {
    fail_folder(path, "cannot be created", platform::utf8(there) + " is not a folder");
  }
  const std::string reason = reason_not_to_write_in(there);
  if (!reason.empty()) fail_folder(path, "cannot be written to", reason);
}

OutputFolder::OutputFolder(std::filesystem::path path, const std::vector<std::string>& names, const Control& control,
                           const FileSet& set)
    : path_(std::move(path)) {
  std::error_code trouble;
  std::filesystem::create_directories(path_, trouble);
  if (trouble) fail_folder(path_, "cannot be created", trouble.message());
  check_output_folder(path_);
  wait_for_others(control);
  own_.emplace(path_, set);
  own_->begin(names);
}

std::vector<std::string> OutputFolder::finish(const std::string& manifest,
                                              const std::vector<std::filesystem::path>& read) const {
  std::vector<std::string> written;
  for (const WrittenFile& file : files_) written.push_back(file.name);
  return own_->finish(manifest, written, read);
}

void OutputFolder::wait_for_others(const Control& control) {
  constexpr std::chrono::milliseconds kPause{10};
  lock_.emplace(path_);
  if (lock_->take()) return;
  begin_stage("wait for another bake");
  do {
    jobs::throw_if_cancelled(control.stop);
    if (control.progress) control.progress(0.0);
    std::this_thread::sleep_for(kPause);
  } while (!lock_->take());
  begin_stage("");
}

void OutputFolder::add(WrittenFile file) {
  std::error_code unknown;
  const auto bytes = std::filesystem::file_size(place(file.name), unknown);
  file.bytes = unknown ? 0 : static_cast<std::uint64_t>(bytes);
  files_.push_back(std::move(file));
}

void OutputFolder::write(WrittenFile file, const std::string& text) {
  write_text_file(place(file.name), text);
  add(std::move(file));
}

void OutputFolder::add_in_front(std::vector<WrittenFile> files) {
  const auto count = static_cast<std::ptrdiff_t>(files_.size());
  for (WrittenFile& file : files) add(std::move(file));
  std::rotate(files_.begin(), files_.begin() + count, files_.end());
}

std::vector<std::string> OutputFolder::format_notes() const {
  std::vector<std::string> notes;
  for (const WrittenFile& file : files_) {
    if (file.values_clamped > 0) {
      std::string note = file.name + ": " + counted(file.values_clamped, "value") + ' ' + file.range;
      if (file.share_clamped > 0.0) {
        constexpr double kNearlyAll = 0.99;  // two digits of a value above would be "1e+02"
        const bool nearly_all = file.share_clamped > kNearlyAll;
        note += ", which removes " + (nearly_all ? "over 99" : significant(100.0 * file.share_clamped, 2)) +
                " % of the light";
        if (!file.remedy.empty()) note += "; " + file.remedy;
      }
      notes.push_back(note);
    }
    if (!file.caution.empty()) notes.push_back(file.name + ": " + file.caution);
  }
  return notes;
}

std::vector<std::string> bake_notes(const Baked& baked, const BakeCommandOptions& options, const OutputFolder& folder) {
  std::vector<std::string> notes = baked.source.notes;
  const ProjectionDiagnostics& diagnostics = baked.light.diagnostics;
  const std::string replaced = counted({{diagnostics.nans_replaced, "NaN"},
                                        {diagnostics.infinities_replaced, "infinite value"},
                                        {diagnostics.negatives_replaced, "negative value"}});
  if (!replaced.empty()) notes.push_back("the input: " + replaced + " replaced");
  if (diagnostics.texels_clamped > 0) {
    notes.push_back("the input: " + counted(diagnostics.texels_clamped, "texel") + " clamped at " +
                    significant(baked.options.pixels.clamp ? baked.options.pixels.clamp->maximum : 0.0));
  }
  for (const std::string& note : folder.format_notes()) notes.push_back(note);
  for (const std::string& note : baked.notes) notes.push_back(note);
  for (const std::string& note : option_notes(options)) notes.push_back(note);
  if (baked.env_left_out) {
    notes.push_back("no environment." + baked.env_container +
                    ": the scene has no material that reads a prefiltered cubemap");
  }
  return notes;
}

std::string bake_manifest(const Baked& baked, const BakeCommandOptions& options, const OutputFolder& folder,
                          const ToneMap& tone_map) {
  Json json = {{"welkin", WELKIN_VERSION_STRING},
               {"source", source_json(baked.source, options)},
               {"axes", axes_json(options)},
               {"options", options_json(baked, options)},
               {"files", json_list(folder.files(), file_json)},
               {"specular", baked.light.specular ? mips_json(baked.light.specular->mips) : Json::array()}};
  if (const auto& irradiance = baked.light.irradiance_record) json["irradiance"] = made_json(*irradiance);
  if (!baked.env_mips.empty()) json["environment_" + baked.env_container] = mips_json(baked.env_mips);
  if (baked.light.brdf) {
    const BrdfTableOptions& brdf = baked.light.brdf->options;
    json["brdf"] = {{"width", brdf.width},
                    {"height", brdf.height},
                    {"model", brdf.model == BrdfModel::split_sum ? "split-sum" : "multiple-scattering"},
                    {"channels", brdf_channels(brdf)}};
  }
  if (options.previews) {
    json["previews"] = {{"exposure", tone_map.exposure},
                        {"exposure_ev", tone_map.stops()},
                        {"curve", "x (2.51 x + 0.03) / (x (2.43 x + 0.59) + 0.14)"}};
  }
  if (baked.sky) json["sky"] = sky_json(*baked.sky);
  if (baked.sun_wanted) json["sun"] = sun_json(baked, options);
  if (options.scene.any()) json["needs"] = needs_json(options.scene.needs());
  if (options.scene.explains()) json["plan"] = plan_json(baked.plan);
  json["diagnostics"] = diagnostics_json(baked);
  json["notes"] = notes_json(bake_notes(baked, options, folder), options);
  if (options.called.empty()) json["times"] = times_json(baked);
  return json_text(json);
}

}  // namespace welkin::tool
