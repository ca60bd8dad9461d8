#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <string>

namespace osteon {

/// A path in this process's temporary folder, which is removed when the process ends. Tests of two processes,
/// or of two checkouts, therefore don't share files.
inline std::filesystem::path TemporaryPath(const std::string& name) {
  struct Folder {
    Folder() { std::filesystem::create_directories(path); }
    ~Folder() {
      std::error_code ignored;
      std::filesystem::remove_all(path, ignored);
    }
    std::filesystem::path path =
        std::filesystem::path(testing::TempDir()) / ("osteon_test_" + std::to_string(::getpid()));
  };
  static const Folder folder;
  return folder.path / name;
}

}  // namespace osteon
