#include "base/mapped_file.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>
#include <zlib.h>

#include <cerrno>
#include <system_error>

namespace osteon::simulation {
namespace {

// Closes a file descriptor at the end of its scope.
class Descriptor {
 public:
  explicit Descriptor(int fd) : fd_(fd) {}
  ~Descriptor() {
    if (fd_ >= 0) close(fd_);
  }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  [[nodiscard]] int get() const { return fd_; }

 private:
  int fd_;
};

// Makes the error of a file that is refused as a whole.
tl::unexpected<FileError> Refuse(const std::filesystem::path& path, const std::string& found,
                                 const std::string& accepted) {
  return tl::make_unexpected(FileError{
      .file = path.string(), .byte = std::nullopt, .where = "", .found = found, .accepted = accepted});
}

// Names the kind of a file that is not regular.
std::string KindOf(mode_t mode) {
  if (S_ISDIR(mode)) return "a folder";
  if (S_ISFIFO(mode)) return "a pipe";
  if (S_ISSOCK(mode)) return "a socket";
  return "a device";
}

}  // namespace

tl::expected<MappedFile, FileError> MappedFile::Open(const std::filesystem::path& path) {
  const std::string accepted = "a regular file that may be read";
  const Descriptor file(open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK));
  if (file.get() < 0) {
    const int error = errno;
    return Refuse(path, error == ENOENT ? "no such file" : std::generic_category().message(error), accepted);
  }
  struct stat status {};
  if (fstat(file.get(), &status) != 0) return Refuse(path, std::generic_category().message(errno), accepted);
  if (!S_ISREG(status.st_mode)) return Refuse(path, KindOf(status.st_mode), accepted);

  MappedFile mapped;
  const auto size = static_cast<std::size_t>(status.st_size);
  if (size == 0) return mapped;
  void* start = mmap(nullptr, size, PROT_READ, MAP_PRIVATE, file.get(), 0);
  if (start == MAP_FAILED)
    return Refuse(path, "that it cannot be mapped: " + std::generic_category().message(errno), "");
  madvise(start, size, MADV_WILLNEED);  // a hint to read ahead, which affects only the speed
  mapped.bytes_ = {static_cast<const std::byte*>(start), size};
  return mapped;
}

MappedFile::~MappedFile() {
  if (!bytes_.empty()) munmap(const_cast<std::byte*>(bytes_.data()), bytes_.size());
}

tl::expected<std::uint32_t, FileError> FileChecksum(const std::filesystem::path& path) {
  const auto file = MappedFile::Open(path);
  if (!file) return tl::make_unexpected(file.error());
  return static_cast<std::uint32_t>(
      crc32_z(0, reinterpret_cast<const Bytef*>(file->bytes().data()), file->bytes().size()));
}

}  // namespace osteon::simulation
