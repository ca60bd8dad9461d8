#include "base/output_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <string>
#include <system_error>
#include <utility>

namespace osteon::simulation {
namespace {

// Makes the error of a failed write. @param byte  offset in the file, if known; @param error  errno
FileError Failure(const std::filesystem::path& path, std::optional<std::uint64_t> byte, int error) {
  return {.file = path.string(),
          .byte = byte,
          .where = "cannot be written",
          .found = std::generic_category().message(error),
          .accepted = ""};
}

// Follows symbolic links and returns the path that the last link names, whether a file exists there or not.
std::filesystem::path EndOfLinks(std::filesystem::path path) {
  constexpr int kMaxLinks = 40;  // the system's own limit
  std::error_code error;
  for (int links = 0; links < kMaxLinks && std::filesystem::is_symlink(path, error); ++links) {
    const std::filesystem::path to = std::filesystem::read_symlink(path, error);
    if (error) break;
    path = to.is_absolute() ? to : path.parent_path() / to;
  }
  return path;
}

// Opens a new temporary file beside `target`, with the permissions of `target`.
// @returns the file descriptor; negative if that failed, see errno
int OpenBeside(const std::filesystem::path& target, std::filesystem::path& temporary) {
  static std::atomic<unsigned> count{0};
  int fd = -1;
  do {
    temporary = target;
    temporary += "." + std::to_string(getpid()) + "_" + std::to_string(count++) + ".part";
    fd = open(temporary.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
  } while (fd < 0 && errno == EEXIST);
  struct stat status;  // NOLINT: filled by the call
  if (fd >= 0 && stat(target.c_str(), &status) == 0) static_cast<void>(fchmod(fd, status.st_mode & 07777));
  return fd;
}

}  // namespace

tl::expected<OutputFile, FileError> OutputFile::Create(const std::filesystem::path& path) {
  std::error_code ignored;
  const auto status = std::filesystem::status(path, ignored);
  const bool exists = std::filesystem::exists(status);
  if (std::filesystem::is_directory(status)) return tl::make_unexpected(Failure(path, {}, EISDIR));

  if (exists && !std::filesystem::is_regular_file(status)) {  // a device or a pipe: written in place
    const int fd = open(path.c_str(), O_WRONLY | O_CLOEXEC);
    if (fd < 0) return tl::make_unexpected(Failure(path, {}, errno));
    return OutputFile(path, {}, fd);
  }
  const std::filesystem::path target = EndOfLinks(path);
  std::filesystem::path temporary;
  const int fd = OpenBeside(target, temporary);
  if (fd < 0) return tl::make_unexpected(Failure(path, {}, errno));
  return OutputFile(target, temporary, fd);
}

OutputFile::OutputFile(OutputFile&& other) noexcept
    : path_(std::move(other.path_)),
      temporary_(std::exchange(other.temporary_, {})),
      fd_(std::exchange(other.fd_, -1)),
      error_(other.error_),
      written_(other.written_) {}

OutputFile::~OutputFile() {
  Close();
  if (!temporary_.empty()) unlink(temporary_.c_str());
}

void OutputFile::Close() {
  if (fd_ < 0) return;
  if (close(fd_) != 0 && error_ == 0) error_ = errno;
  fd_ = -1;
}

void OutputFile::Write(std::span<const std::byte> bytes) {
  constexpr std::size_t kMaxAtOnce = std::size_t{1} << 30;  // write(2) takes no more than 2 GiB
  while (error_ == 0 && !bytes.empty()) {
    const ssize_t count = write(fd_, bytes.data(), std::min(bytes.size(), kMaxAtOnce));
    if (count < 0) {
      if (errno != EINTR) error_ = errno;
      continue;
    }
    written_ += static_cast<std::uint64_t>(count);
    bytes = bytes.subspan(static_cast<std::size_t>(count));
  }
}

tl::expected<void, FileError> OutputFile::Commit() {
  // a pipe or a device does not support fsync: its error is no failure
  if (error_ == 0 && fsync(fd_) != 0 && errno != EINVAL && errno != EROFS) error_ = errno;
  Close();
  if (error_ == 0 && !temporary_.empty()) {
    if (rename(temporary_.c_str(), path_.c_str()) == 0)
      temporary_.clear();
    else
      error_ = errno;
  }
  if (error_ != 0) return tl::make_unexpected(Failure(path_, written_, error_));
  return {};
}

}  // namespace osteon::simulation
