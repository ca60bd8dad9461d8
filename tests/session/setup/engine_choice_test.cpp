// The choice of the simulation's engine: Vulkan on a GPU, or the CPU.

#include "session/setup/engine_choice.h"

#include <gtest/gtest.h>

namespace osteon::session {
namespace {

using Devices = tl::expected<std::vector<gpu::DeviceInfo>, std::string>;

Devices Found(std::vector<gpu::DeviceInfo> devices) { return devices; }

// @param refusal  why the device can't be used; empty: it can
gpu::DeviceInfo Device(const char* name, const char* kind, const char* refusal = "") {
  return {.name = name, .kind = kind, .api_version = "1.3", .driver = name, .refusal = refusal};
}

TEST(ChooseEngine, ChoosesVulkanOnAGpu) {
  for (const char* kind : {"discrete", "integrated"}) {
    const EngineChoice choice =
        ChooseEngine("auto", "", Found({Device("card", kind), Device("llvmpipe", "cpu")}));
    EXPECT_EQ(choice.engine, "vulkan") << kind;
    EXPECT_EQ(choice.device, "") << kind;
    EXPECT_FALSE(choice.reason.empty()) << kind;
  }
}

TEST(ChooseEngine, ChoosesTheCpuWithoutAUsableGpuAndSaysWhatItFound) {
  const EngineChoice software = ChooseEngine("auto", "", Found({Device("llvmpipe", "cpu")}));
  EXPECT_EQ(software.engine, "cpu");
  EXPECT_NE(software.reason.find("llvmpipe"), std::string::npos) << software.reason;
  const EngineChoice refused = ChooseEngine(
      "auto", "", Found({Device("card", "discrete", "no 64-bit floats"), Device("llvmpipe", "cpu")}));
  EXPECT_EQ(refused.engine, "cpu");
  EXPECT_NE(refused.reason.find("card"), std::string::npos) << refused.reason;
  EXPECT_NE(refused.reason.find("no 64-bit floats"), std::string::npos) << refused.reason;
  const EngineChoice none = ChooseEngine("auto", "", Devices(tl::make_unexpected(std::string("no loader"))));
  EXPECT_EQ(none.engine, "cpu");
  EXPECT_FALSE(none.reason.empty());
}

TEST(ChooseEngine, ChoosesVulkanIfTheUserNamesADevice) {
  const EngineChoice choice = ChooseEngine("auto", "llvmpipe");
  EXPECT_EQ(choice.engine, "vulkan");
  EXPECT_EQ(choice.device, "llvmpipe");
}

TEST(ChooseEngine, ChoosesTheEngineThatTheUserNames) {
  for (const std::string& engine : EngineNames()) {
    if (engine == "auto") continue;
    const EngineChoice choice = ChooseEngine(engine, "", Found({Device("card", "discrete")}));
    EXPECT_EQ(choice.engine, engine);
    EXPECT_EQ(choice.reason, "");
  }
}

TEST(ChooseEngine, EnginesOnTheCpuCanBeMadeAndAreDescribedInOneLine) {
  simulation::Bone pebble;
  pebble.balls = {{.center_m = {}, .radius_m = 1e-3}};
  pebble.materials = {{.name = "bone"}};
  simulation::Tool probe;
  probe.balls = {{.center_m = {}, .radius_m = 1e-3, .cutting = true}};
  for (const char* name : {"cpu", "reference"}) {
    const EngineChoice choice{.engine = name, .reason = "why"};
    const auto engine = MakeEngine(choice, pebble, probe, Pose::Identity(), {});
    ASSERT_TRUE(engine) << engine.error();
    EXPECT_EQ((*engine)->name(), name);
    const std::string text = EngineText(choice, (*engine)->device());
    EXPECT_EQ(text.rfind(name, 0), 0u) << text;
    EXPECT_NE(text.find("why"), std::string::npos) << text;
    EXPECT_EQ(text.find('\n'), std::string::npos) << text;
  }
}

}  // namespace
}  // namespace osteon::session
