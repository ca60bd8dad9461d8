#include <cstdlib>

#include <gtest/gtest.h>

#include "gpu/devices.h"
#include "tests/gpu/contract_bench.h"

// A machine without a Vulkan driver. The loader reads its environment when an instance is made, so these
// tests run in a child process.

namespace osteon::gpu {
namespace {

int SayWhatIsWrong() {
  setenv("VK_DRIVER_FILES", "/nonexistent", 1);
  setenv("VK_ICD_FILENAMES", "/nonexistent", 1);  // the older name of the same
  simulation::Bone bone;
  const auto devices = ListDevices();
  const auto engine = VulkanEngine::Create(bone, DefaultReamer(), Pose::Identity(), {}, {});
  if (devices || engine) return 1;
  std::fprintf(stderr, "devices: %s\nengine: %s\n", devices.error().c_str(), engine.error().c_str());
  return 0;
}

TEST(NoDriverDeathTest, IsAnErrorThatSaysWhatToInstall) {
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  EXPECT_EXIT(std::exit(SayWhatIsWrong()), testing::ExitedWithCode(0),
              "devices: no Vulkan driver found; install one \\(mesa-vulkan-drivers.*\n"
              "engine: no Vulkan driver found; install one \\(mesa-vulkan-drivers");
}

}  // namespace
}  // namespace osteon::gpu
