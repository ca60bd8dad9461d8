#include "plugin/src/saved_files.h"

#include <unistd.h>

#include <atomic>
#include <system_error>

#include <fmt/format.h>

#include "plugin/src/result.h"

namespace osteon::plugin {

std::filesystem::path SweptFileOf(const std::string& file) { return file + ".swept"; }

void CheckSaveName(const std::filesystem::path& file) {
  if (file.empty())
    throw Failure(OSTEON_ERROR_ARGUMENT, "file: found an empty name, accepted that of a file");
  std::error_code ignored;
  const auto status = std::filesystem::status(file, ignored);
  if (!exists(status) || is_regular_file(status)) return;
  throw Failure(OSTEON_ERROR_FILE,
                fmt::format("{}: found {}, accepted a new name, or a regular file to replace", file.string(),
                            is_directory(status) ? "a folder" : "a device or a pipe"));
}

SweptPart::SweptPart(const std::string& saved) : swept_(SweptFileOf(saved)) {
  static std::atomic<unsigned> count{0};
  file_ = fmt::format("{}.swept.{}_{}.part", saved, getpid(), count++);
}

SweptPart::~SweptPart() {
  std::error_code ignored;
  std::filesystem::remove(file_, ignored);
}

void SweptPart::Commit() const {
  std::error_code error;
  std::filesystem::rename(file_, swept_, error);
  if (error)
    throw Failure(OSTEON_ERROR_FILE,
                  fmt::format("{}: cannot be written: found {}", swept_.string(), error.message()));
}

}  // namespace osteon::plugin
