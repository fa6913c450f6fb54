// A system without files (WebAssembly), where all bytes are in memory.
#include "platform/file.h"
#include "platform/pending_file.h"

namespace welkin::platform {
namespace {

constexpr const char* kNoFiles = "there are no files in WebAssembly; pass the bytes";

}  // namespace

std::int64_t process_number() noexcept { return 0; }

std::filesystem::path reachable(const std::filesystem::path& path) { return path; }

std::unique_ptr<DiskFile> open_disk_file(const std::filesystem::path& path) {
  throw file_error(ErrorCode::file_access, path, kNoFiles);
}

SharedFile::SharedFile(const std::filesystem::path& /*path*/) noexcept : file_(kNoFile) {}
SharedFile::~SharedFile() = default;
std::optional<std::uint64_t> SharedFile::size() const noexcept { return std::nullopt; }
bool SharedFile::read(void* /*bytes*/, std::size_t /*count*/) const noexcept { return false; }
void SharedFile::touch() const noexcept {}

FolderLock::FolderLock(const std::filesystem::path& /*folder*/) noexcept : file_(kNoFile) {}
FolderLock::~FolderLock() = default;
bool FolderLock::take() noexcept { return file_ == kNoFile; }

void remove_left_behind(const std::filesystem::path& /*folder*/) noexcept {}

PendingTarget target_of(const std::filesystem::path& path, WholeFile::Link /*link*/) {
  throw file_error(ErrorCode::file_access, path, kNoFiles);
}

// No object of it is ever made.
PendingFile::~PendingFile() = default;
bool PendingFile::make() { return false; }
bool PendingFile::open_stream() { return false; }
void PendingFile::set_permissions(std::filesystem::perms /*permissions*/) noexcept {}
bool PendingFile::write(const void* /*bytes*/, std::size_t /*count*/) { return false; }
bool PendingFile::seek(std::uint64_t /*position*/) { return false; }
bool PendingFile::close_stream() { return false; }
bool PendingFile::flush_to_disk() { return false; }
bool PendingFile::put_in_place() { return false; }

}  // namespace welkin::platform
