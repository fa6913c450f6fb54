#include "scratch_files.h"

#include <system_error>

#include "perf/report/process.h"

namespace welkin::perf {
namespace {

class Folder {
 public:
  Folder() : path_(report::make_temporary_folder()) {}
  ~Folder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;

  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

}  // namespace

std::filesystem::path scratch_file(const std::string& name,
                                   const std::function<void(const std::filesystem::path&)>& write) {
  static const Folder folder;
  std::filesystem::path path = folder.path() / name;
  if (!std::filesystem::exists(path)) write(path);
  return path;
}

}  // namespace welkin::perf
