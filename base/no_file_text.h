#pragma once

#include <filesystem>
#include <string>
#include <system_error>

namespace osteon::base {

/// Says why a path cannot be read as a file: it does not exist, or it is a folder, a pipe or a device.
/// Returns an empty text if the path is a file.
[[nodiscard]] inline std::string NoFileText(const std::filesystem::path& path) {
  std::error_code error;
  const std::filesystem::file_status status = std::filesystem::status(path, error);
  if (std::filesystem::is_regular_file(status)) return {};
  if (std::filesystem::is_directory(status)) return "found a folder, accepted a file";
  if (std::filesystem::exists(status)) return "found a pipe, a socket or a device, accepted a file";
  return "no such file";
}

}  // namespace osteon::base
