#include <algorithm>
#include <array>
#include <string_view>
#include <system_error>

#include "platform/text.h"
#include "tools/arguments.h"
#include "tools/bake_manifest.h"
#include "tools/batch.h"
#include "tools/text.h"
#include "welkin/core.h"

namespace welkin::tool {
namespace {

namespace fs = std::filesystem;

bool is_hidden(const fs::path& path) { return platform::utf8(path.filename()).starts_with('.'); }

/// What is in a folder, in the order of names, but for what is hidden.
std::vector<fs::directory_entry> entries_of(const fs::path& folder) {
  std::vector<fs::directory_entry> entries;
  std::error_code trouble;
  for (fs::directory_iterator at(folder, trouble), end; !trouble && at != end; at.increment(trouble)) {
    entries.push_back(*at);
  }
  if (trouble) {
    throw Error(ErrorCode::file_access,
                platform::utf8(folder) + ": cannot be listed (" + trouble.message() + "); check its permissions");
  }
  std::ranges::sort(entries, {}, [](const fs::directory_entry& entry) { return entry.path(); });
  return entries;
}

/// Its pictures were made by Welkin.
bool is_baked(const fs::path& folder) { return begins_with(folder / kManifestName, "\"welkin\""); }

void add_pictures(const fs::path& folder, std::vector<fs::path>& found) {
  std::error_code unknown;
  for (const fs::directory_entry& entry : entries_of(folder)) {
    if (is_hidden(entry.path())) continue;
    // A link to a folder is not followed: it might lead back.
    if (entry.is_directory(unknown) && !entry.is_symlink(unknown)) {
      if (!is_baked(entry.path())) add_pictures(entry.path(), found);
    } else if (is_picture_name(entry.path()) && entry.is_regular_file(unknown)) {
      found.push_back(entry.path());
    }
  }
}

using Parts = std::vector<std::string>;

void add_fitting(const fs::path& folder, const Parts& parts, std::size_t at, std::vector<fs::path>& found) {
  std::error_code unknown;
  const bool is_last = at + 1 == parts.size();
  const std::string& part = parts[at];
  const auto go_on = [&](const fs::path& path) {
    if (!is_last) return add_fitting(path, parts, at + 1, found);
    if (fs::is_regular_file(path, unknown)) found.push_back(path);
  };
  if (!is_pattern(part)) return go_on(folder / platform::path_of(part));
  const fs::path listed = folder.empty() ? fs::path(".") : folder;
  if (!fs::is_directory(listed, unknown)) return;
  const bool any_depth = part == "**" && !is_last;
  if (any_depth) add_fitting(folder, parts, at + 1, found);
  for (const fs::directory_entry& entry : entries_of(listed)) {
    if (is_hidden(entry.path()) && !part.starts_with('.')) continue;
    const fs::path path = folder / entry.path().filename();
    if (any_depth) {
      const bool is_folder = entry.is_directory(unknown) && !entry.is_symlink(unknown);
      if (is_folder && !is_baked(entry.path())) add_fitting(path, parts, at, found);
    } else if (fits(platform::utf8(entry.path().filename()), part) && (!is_last || is_picture_name(path))) {
      go_on(path);
    }
  }
}

}  // namespace

bool is_picture_name(const fs::path& path) {
  constexpr std::array<const char*, 8> kEndings = {".exr", ".hdr", ".pfm", ".png", ".ktx2", ".ktx", ".dds", ".env"};
  const std::string ending = platform::utf8(path.extension());
  return std::ranges::any_of(kEndings, [&](const char* known) { return same_word(ending, known); });
}

std::vector<fs::path> pictures_below(const fs::path& folder) {
  std::vector<fs::path> found;
  add_pictures(folder, found);
  return found;
}

bool is_pattern(const std::string& text) noexcept { return text.find_first_of("*?") != std::string::npos; }

bool fits(const std::string& name, const std::string& pattern) noexcept {
  std::size_t at = 0;
  std::size_t wanted = 0;
  std::size_t star = std::string::npos;  // the last one in the pattern,
  std::size_t behind = 0;                // and what of the name follows what it stands for
  while (at < name.size()) {
    if (wanted < pattern.size() && pattern[wanted] == '*') {
      star = wanted++;
      behind = at;
    } else if (wanted < pattern.size() && (pattern[wanted] == '?' || pattern[wanted] == name[at])) {
      ++wanted;
      ++at;
    } else if (star != std::string::npos) {
      wanted = star + 1;
      at = ++behind;
    } else {
      return false;
    }
  }
  return pattern.find_first_not_of('*', wanted) == std::string::npos;
}

std::vector<fs::path> files_that_fit(const std::string& pattern) {
  const fs::path whole = platform::path_of(pattern);
  Parts parts;
  for (const fs::path& part : whole.relative_path()) {
    if (!part.empty()) parts.push_back(platform::utf8(part));
  }
  std::vector<fs::path> found;
  if (!parts.empty()) add_fitting(whole.root_path(), parts, 0, found);
  std::ranges::sort(found);
  found.erase(std::unique(found.begin(), found.end()), found.end());
  return found;
}

}  // namespace welkin::tool
