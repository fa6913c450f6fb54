// Files that a command writes as a set into a folder, and which of those present an earlier run wrote.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace welkin::tool {

/// A command's sets of files.
struct FileSet {
  const char* command;  ///< "bake", for messages
  const char* index;    ///< the JSON file that lists the others: "welkin", and "files" with name and bytes of each
  bool (*has_name)(std::string_view name);  ///< whether one of its files can be called so
};

/// The files of a set in one folder. Those that the index lists are the command's own and may be replaced; any other
/// file with a name that is to be written is refused.
///
/// While a set is written there is no index, but `unfinished_NAME`, which lists what the earlier index listed and what
/// is being written. So a run that was killed leaves a list for the next one.
class OwnFiles {
 public:
  /// Reads the lists of an earlier run. Throws `Error` (file_access) if the index is there and is not the command's.
  OwnFiles(std::filesystem::path folder, const FileSet& set);

  /// Throws `Error` (file_access), naming the file, if one of these names belongs to something that cannot be replaced
  /// (a folder, a pipe, a device) or to a file that is on no list.
  void require(const std::vector<std::string>& names) const;

  /// Lists these names as unfinished, and removes the index. Throws as `require`.
  void begin(const std::vector<std::string>& names) const;

  /// Writes the index, and removes the files of the earlier run that are not among `written`: regular files of this
  /// folder that are as long as they were, and not among those that this run `read`. Returns a remark about what was
  /// removed and about what stays.
  [[nodiscard]] std::vector<std::string> finish(const std::string& index, const std::vector<std::string>& written,
                                                const std::vector<std::filesystem::path>& read) const;

 private:
  [[nodiscard]] std::filesystem::path unfinished() const;
  void add_listed(const std::filesystem::path& list);

  std::filesystem::path folder_;
  FileSet set_;
  std::map<std::string, std::optional<std::uint64_t>> listed_;  ///< with its length, if the run recorded it
};

}  // namespace welkin::tool
