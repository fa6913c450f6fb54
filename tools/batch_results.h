// The folder of a batch's results: each is a folder of its own, named by what it was made of, whole or absent.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "platform/file.h"
#include "tools/bake_options.h"
#include "tools/batch_plan.h"
#include "welkin/core.h"
#include "welkin/result_cache.h"

namespace welkin::tool {

/// The file in a result that names all others with their hashes.
inline constexpr const char* kResultName = "result.json";

struct ResultFile {
  std::string name;
  std::uint64_t bytes = 0;
  ContentHash hash;

  friend bool operator==(const ResultFile&, const ResultFile&) = default;
};

/// Of a result's files; by their names in order.
using ResultFiles = std::vector<ResultFile>;

/// The hash over the names and hashes.
[[nodiscard]] ContentHash hash_of(const ResultFiles& files);

/// By what a result is known: the bytes of its input, how that was understood, the options (`words` as they were
/// written and what stood in the files that they name), and the version of results. Reads the input. Throws `Error` as
/// `inspect_environment`.
[[nodiscard]] ContentHash result_key_of(const BakeCommandOptions& options, const std::vector<std::string>& words);

/// Returns the key of a job's result. Throws the same, and invalid_argument for the job's options.
[[nodiscard]] ContentHash result_key_of(const BatchPlan& plan, const BatchJob& job);

/// What a result's folder says of its files. Nothing if there is none, or no sound result.json. Files are not looked
/// at.
[[nodiscard]] std::optional<ResultFiles> listed_in(const std::filesystem::path& result);

/// Whether files of these names and sizes are there. Their bytes are not read.
[[nodiscard]] bool has_files(const std::filesystem::path& result, const ResultFiles& files);

/// The names of files that are not there or whose bytes have another hash than is listed.
[[nodiscard]] std::vector<std::string> damaged_files(const std::filesystem::path& result, const ResultFiles& files);

/// Reads all files in the folder but result.json. Throws `Error` (file_access).
[[nodiscard]] ResultFiles hash_files_in(const std::filesystem::path& folder);

/// The folder takes no more results (file_access): it is full, or cannot be written to any more. The fault of no job.
class ResultStoreError : public Error {
 public:
  explicit ResultStoreError(const std::string& message) : Error(ErrorCode::file_access, message) {}
};

class ResultStore {
 public:
  /// Makes the folder and, in it, one for what this process has at work. Takes away what killed processes of this
  /// machine left of theirs. Throws `Error` (file_access).
  explicit ResultStore(std::filesystem::path folder);
  ~ResultStore();
  ResultStore(const ResultStore&) = delete;
  ResultStore& operator=(const ResultStore&) = delete;

  [[nodiscard]] std::filesystem::path place(const ContentHash& key) const { return folder_ / key.text(); }

  /// Its files are listed, and are there in their sizes.
  [[nodiscard]] bool is_whole(const ContentHash& key) const;

  /// Has `make` fill a folder, lists its files, and gives it its name. False if another process was first, whose result
  /// stays; a damaged one is replaced. Throws `Error` and what `make` throws, but `ResultStoreError` where that was
  /// file_access and the folder takes no other file either; then nothing is left. Thread-safe.
  bool add(const ContentHash& key, const std::function<void(const std::filesystem::path& folder)>& make);

  /// Makes the link by-name/NAME to the result's folder, for people, where the system has links and lets this process
  /// make them; a file that is no link stays. `remove_name` takes it away. Thread-safe for different keys and names.
  void add_name(const ContentHash& key, const std::string& name) const noexcept;
  void remove_name(const std::string& name) const noexcept;

  /// Has `make` fill a folder that goes again, and says what was in it. Throws likewise. Thread-safe.
  [[nodiscard]] ResultFiles trial(const ContentHash& key,
                                  const std::function<void(const std::filesystem::path& folder)>& make);

 private:
  void clean() const;
  void fill(const std::filesystem::path& folder, const std::function<void(const std::filesystem::path&)>& make) const;
  void check_that_it_takes_files(const Error& reason) const;
  void begin_own_folder();
  bool publish(const std::filesystem::path& made, const ContentHash& key);

  std::filesystem::path folder_;
  std::filesystem::path own_;  ///< of this process: results that are not whole yet
  std::optional<platform::FolderLock> lock_;
};

}  // namespace welkin::tool
