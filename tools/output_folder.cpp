#include "tools/output_folder.h"

#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <system_error>
#include <utility>

#include "tools/number_text.h"
#include "welkin/error.h"

namespace welkin::tool {
namespace {

[[noreturn]] void fail(const std::filesystem::path& path, const std::string& what, const std::string& reason) {
  throw Error(ErrorCode::file_access,
              path.string() + ": " + what + " (" + reason + "); pass -o a folder that this user may write to");
}

}  // namespace

void check_output_folder(const std::filesystem::path& path) {
  std::error_code trouble;
  if (path.empty()) fail("-o", "names no folder", "it is empty");
  std::filesystem::path there = std::filesystem::absolute(path, trouble);
  while (!std::filesystem::exists(std::filesystem::symlink_status(there, trouble)) && there.has_relative_path()) {
    there = there.parent_path();
  }
  if (!std::filesystem::is_directory(there, trouble)) {
    fail(path, "cannot be made or is not a folder", there.string() + " is something else");
  }
  if (access(there.c_str(), W_OK | X_OK) != 0) fail(path, "cannot be written to", std::strerror(errno));
}

OutputFolder::OutputFolder(std::filesystem::path path) : path_(std::move(path)) {
  std::error_code trouble;
  std::filesystem::create_directories(path_, trouble);
  if (trouble) fail(path_, "cannot be made", trouble.message());
  check_output_folder(path_);
  std::filesystem::remove(place(kManifestName), trouble);
  if (trouble) fail(place(kManifestName), "cannot be replaced", trouble.message());
}

void OutputFolder::add(WrittenFile file) {
  std::error_code unknown;
  const auto bytes = std::filesystem::file_size(place(file.name), unknown);
  file.bytes = unknown ? 0 : static_cast<std::uint64_t>(bytes);
  files_.push_back(std::move(file));
}

std::vector<std::string> OutputFolder::clamp_notes() const {
  std::vector<std::string> notes;
  for (const WrittenFile& file : files_) {
    if (file.values_clamped > 0) {
      notes.push_back(file.name + ": " + counted(file.values_clamped, "value") + ' ' + file.range);
    }
  }
  return notes;
}

}  // namespace welkin::tool
