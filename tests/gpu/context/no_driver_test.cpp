#include <cstdlib>
#include <fstream>
#include <string>

#include <gtest/gtest.h>

#include "gpu/context/devices.h"
#include "tests/gpu/engine/contract_bench.h"
#include "tests/io/temporary_folder.h"

// Tests the errors on a machine without a working Vulkan driver. The Vulkan loader reads environment
// variables when an instance is made, so the tests set them in a child process.

namespace osteon::gpu {
namespace {

// Hides all drivers, then prints two errors: of listing the devices, and of opening an engine. @returns 0 if
// both fail
int PrintErrorsWithoutDriver() {
  setenv("VK_DRIVER_FILES", "/nonexistent", 1);
  setenv("VK_ICD_FILENAMES", "/nonexistent", 1);  // older name of the same variable
  simulation::Bone bone;
  const auto devices = ListDevices();
  const auto engine = VulkanEngine::Create(bone, DefaultReamer(), Pose::Identity(), {}, {});
  if (devices || engine) return 1;
  std::fprintf(stderr, "devices: %s\nengine: %s\n", devices.error().c_str(), engine.error().c_str());
  return 0;
}

TEST(NoDriverDeathTest, TheErrorSaysWhatToInstall) {
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  EXPECT_EXIT(std::exit(PrintErrorsWithoutDriver()), testing::ExitedWithCode(0),
              "devices: no Vulkan driver found; install one \\(mesa-vulkan-drivers.*\n"
              "engine: no Vulkan driver found; install one \\(mesa-vulkan-drivers");
}

// Installs a driver whose manifest names a library that does not exist, then prints the error of listing the
// devices.
// @returns 0 if the listing fails
int PrintErrorOfBrokenDriver() {
  const io::test::TemporaryFolder folder;
  const std::string manifest = (folder.path() / "broken_icd.json").string();
  std::ofstream(manifest) << R"({"file_format_version": "1.0.0",
      "ICD": {"library_path": "/nonexistent/libvulkan_broken.so", "api_version": "1.3.0"}})";
  setenv("VK_DRIVER_FILES", manifest.c_str(), 1);
  setenv("VK_ICD_FILENAMES", manifest.c_str(), 1);
  const auto devices = ListDevices();
  if (devices) return 1;
  std::fprintf(stderr, "devices: %s\n", devices.error().c_str());
  return 0;
}

TEST(NoDriverDeathTest, TheErrorNamesADriverThatCannotBeLoaded) {
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  EXPECT_EXIT(std::exit(PrintErrorOfBrokenDriver()), testing::ExitedWithCode(0),
              "no Vulkan driver found.*loader says: .*libvulkan_broken");
}

}  // namespace
}  // namespace osteon::gpu
