#include "tools/own_files.h"

#include <algorithm>
#include <system_error>
#include <utility>

#include "platform/text.h"
#include "tools/json.h"
#include "tools/text.h"
#include "welkin/core.h"

namespace welkin::tool {
namespace {

constexpr const char* kRemedy = "; move it away, or pass another folder to -o";

[[noreturn]] void refuse(const std::filesystem::path& path, const std::string& what) {
  throw Error(ErrorCode::file_access, platform::utf8(path) + ": " + what + kRemedy);
}

/// The target of a link counts, as it would be replaced.
void require_replaceable(const std::filesystem::path& path) {
  std::error_code unknown;
  const std::filesystem::file_status status = std::filesystem::status(path, unknown);
  if (std::filesystem::is_directory(status)) refuse(path, "is a folder where a file must be written");
  if (std::filesystem::exists(status) && !std::filesystem::is_regular_file(status)) {
    refuse(path, "is not a regular file where one must be written");
  }
}

bool is_there(const std::filesystem::path& path) {
  std::error_code unknown;
  return std::filesystem::exists(std::filesystem::status(path, unknown));
}

const Json* member(const Json& object, std::string_view name) {
  if (!object.is_object()) return nullptr;
  const auto found = std::ranges::find(object.members(), name, &std::pair<std::string, Json>::first);
  return found == object.members().end() ? nullptr : &found->second;
}

/// Returns its list of files; none if the file is not a list of the command.
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
  // Another run may begin or end meanwhile; one of these is there at any time.
  for (const std::filesystem::path& list : {folder_ / set_.index, unfinished(), folder_ / set_.index}) add_listed(list);
}

std::filesystem::path OwnFiles::unfinished() const { return folder_ / (std::string("unfinished_") + set_.index); }

/// A list may be forged: names that the command does not give, or in other folders, are ignored.
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

}  // namespace welkin::tool
