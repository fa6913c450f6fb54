// A directory for a test's files, removed when the test ends.
#pragma once

#include <unistd.h>

#include <atomic>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>
#include <vector>

namespace welkin::test {

class TemporaryDirectory {
 public:
  TemporaryDirectory() {
    static std::atomic<int> count{0};
    path_ = std::filesystem::temp_directory_path() /
            ("welkin-test-" + std::to_string(getpid()) + "-" + std::to_string(count++));
    std::filesystem::create_directories(path_);
  }
  ~TemporaryDirectory() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  TemporaryDirectory(const TemporaryDirectory&) = delete;
  TemporaryDirectory& operator=(const TemporaryDirectory&) = delete;

  [[nodiscard]] std::filesystem::path file(const std::string& name) const { return path_ / name; }
  [[nodiscard]] const std::filesystem::path& path() const noexcept { return path_; }

 private:
  std::filesystem::path path_;
};

/// The path of a file that a test will write, in a separate directory.
class TemporaryFile : private TemporaryDirectory, public std::filesystem::path {
 public:
  explicit TemporaryFile(const std::string& name) : std::filesystem::path(file(name)) {}
};

/// Returns everything in a folder, in any order.
inline std::vector<std::filesystem::path> files_in(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) files.push_back(entry.path());
  return files;
}

inline std::vector<char> read_bytes(const std::filesystem::path& path) {
  std::ifstream stream(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
}

inline void write_bytes(const std::filesystem::path& path, const std::vector<char>& bytes) {
  std::ofstream stream(path, std::ios::binary);
  stream.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
}

/// Returns the number, in the processor's byte order, at `offset` in a file's bytes.
template <class Number = std::uint32_t, class Bytes>
Number number_at(const Bytes& bytes, std::size_t offset) {
  static_assert(sizeof(*bytes.data()) == 1);
  Number number{};
  if (offset + sizeof number > bytes.size()) throw std::out_of_range("the file ends before this number");
  std::memcpy(&number, bytes.data() + offset, sizeof number);
  return number;
}

/// Returns a file's text; empty if there is no such file.
inline std::string read_text(const std::filesystem::path& path) {
  const std::vector<char> bytes = read_bytes(path);
  return {bytes.begin(), bytes.end()};
}

inline void write_text(const std::filesystem::path& path, const std::string& text) {
  write_bytes(path, {text.begin(), text.end()});
}

}  // namespace welkin::test
