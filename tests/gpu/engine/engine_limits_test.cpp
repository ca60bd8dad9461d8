#include <sched.h>

#include <filesystem>
#include <fstream>
#include <set>
#include <thread>

#include <gtest/gtest.h>

#include "gpu/context/context.h"
#include "gpu/context/devices.h"
#include "tests/gpu/engine/engine_twins.h"
#include "tests/gpu/engine/strip_bench.h"

// Tests the list of Vulkan devices and how they are opened, the engine's limits on tools and bones, results
// at special sizes (compared with the reference engine), and culling.

namespace osteon::gpu {
namespace {

using simulation::ContactModel;

// The reason why an engine does not open; empty if it opens.
std::string ErrorOf(const simulation::Bone& bone, const simulation::Tool& tool, const VulkanParams& vulkan) {
  const auto engine = VulkanEngine::Create(bone, tool, Pose::Identity(), {}, vulkan);
  return engine ? "" : engine.error();
}

TEST(Devices, ListHasOneThatIsUsable) {
  const auto devices = ListDevices();
  ASSERT_TRUE(devices.has_value()) << devices.error();
  int usable = 0;
  for (const DeviceInfo& device : *devices) {
    EXPECT_FALSE(device.name.empty());
    EXPECT_TRUE(
        (std::set<std::string>{"discrete", "integrated", "virtual", "cpu", "other"}.contains(device.kind)))
        << device.kind;
    EXPECT_GT(device.memory_bytes, 1e6);
    usable += device.refusal.empty() ? 1 : 0;
  }
  EXPECT_GE(usable, 1);
}

TEST(Devices, AreFoundByAPartOfTheirNameInAnyCase) {
  const auto devices = ListDevices();
  ASSERT_TRUE(devices.has_value());
  const auto upper = [](std::string text) {
    for (char& c : text) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
    return text;
  };
  int named = 0;
  for (const DeviceInfo& device : *devices) {
    if (!device.refusal.empty()) continue;
    const std::string part = upper(device.name.substr(1, 4));
    EXPECT_EQ(Open(Strip(1), Ball(3e-3), {.device = device.name})->device(), device.name);
    const std::string found = Open(Strip(1), Ball(3e-3), {.device = part})->device();
    EXPECT_NE(upper(found).find(part), std::string::npos) << found << " is not what " << part << " names";
    EXPECT_FALSE(VulkanEngine::Create(Strip(1), Ball(3e-3), Pose::Identity(), {}, {.device = part + "~"}))
        << "no device has such a name";
    ++named;
  }
  EXPECT_GE(named, 1);
}

// All devices share one Vulkan instance, because some drivers allow a process only a few dozen instances.
TEST(Devices, AreOpenedManyTimesOnOneInstance) {
  const auto first = OpenContext("", false);
  ASSERT_TRUE(first.has_value()) << first.error();
  for (int i = 0; i < 64; ++i) {
    const auto again = OpenContext("", false);
    ASSERT_TRUE(again.has_value()) << i << ": " << again.error();
    ASSERT_EQ((*again)->shared, (*first)->shared);
    ASSERT_NE(**(*again)->device, **(*first)->device) << "a device of its own";
    ASSERT_TRUE(ListDevices().has_value()) << i;
  }
  EXPECT_FALSE((*first)->validation);
  EXPECT_FALSE((*first)->shared->messenger.has_value()) << "the layers were not asked for";
}

// Linux may run two worker threads of the driver on one core for a whole run, which makes every frame nearly
// twice as long. Therefore each worker must be pinned to a core of its own.
TEST(Devices, EachDriverThreadIsPinnedToItsOwnCore) {
  const auto context = OpenContext("", false);
  ASSERT_TRUE(context.has_value()) << context.error();
  if ((*context)->info.kind != "cpu") GTEST_SKIP() << "the device is a GPU: " << (*context)->info.name;
  cpu_set_t allowed;
  ASSERT_EQ(sched_getaffinity(0, sizeof allowed, &allowed), 0);
  int rasterizers = 0;
  std::vector<int> cores;  // cores of the threads that are pinned to one core
  for (const auto& task : std::filesystem::directory_iterator("/proc/self/task")) {
    std::string name;
    std::getline(std::ifstream(task.path() / "comm"), name);
    if (name.starts_with("llvmpipe-")) ++rasterizers;
    cpu_set_t own;
    ASSERT_EQ(sched_getaffinity(std::stoi(task.path().filename()), sizeof own, &own), 0);
    if (CPU_COUNT(&own) != 1) continue;
    for (int core = 0; core < CPU_SETSIZE; ++core)
      if (CPU_ISSET(core, &own)) cores.push_back(core);
  }
  ASSERT_GT(rasterizers, 0);
  if (CPU_COUNT(&allowed) == 1 || CPU_COUNT(&allowed) < rasterizers)
    GTEST_SKIP() << rasterizers << " workers, " << CPU_COUNT(&allowed) << " cores";
  EXPECT_EQ(static_cast<int>(cores.size()), rasterizers);
  EXPECT_EQ(std::set<int>(cores.begin(), cores.end()).size(), cores.size());
}

TEST(Devices, AreOpenedByFourThreadsAtOnce) {
  std::array<std::shared_ptr<SharedInstance>, 4> instances;
  std::vector<std::thread> threads;
  for (auto& instance : instances)
    threads.emplace_back([&instance] {
      const auto context = OpenContext("", false);
      if (context) instance = (*context)->shared;
    });
  for (std::thread& thread : threads) thread.join();
  for (const auto& instance : instances) {
    ASSERT_NE(instance, nullptr);
    EXPECT_EQ(instance, instances.front());
  }
}

TEST(Devices, WithValidationLayersHaveTheirOwnInstance) {
  const auto plain = OpenContext("", false), layered = OpenContext("", true), again = OpenContext("", true);
  if (!layered && layered.error().find("vulkan-validationlayers") != std::string::npos)
    GTEST_SKIP() << layered.error();
  ASSERT_TRUE(plain && layered && again);
  EXPECT_NE((*plain)->shared, (*layered)->shared);
  EXPECT_EQ((*again)->shared, (*layered)->shared);
  EXPECT_TRUE((*layered)->shared->messenger.has_value());
}

TEST(VulkanEngine, AnUnknownDevicesErrorListsTheDevices) {
  const std::string error = ErrorOf(Strip(1), Ball(3e-3), {.device = "no such card"});
  EXPECT_NE(error.find("\"no such card\""), std::string::npos) << error;
  const auto devices = ListDevices();
  ASSERT_TRUE(devices.has_value());
  for (const DeviceInfo& device : *devices) EXPECT_NE(error.find(device.name), std::string::npos) << error;
}

TEST(VulkanEngine, RefusesToolsAndBonesBeyondItsLimits) {
  simulation::Tool tool = Ball(3e-3);
  tool.balls.resize(10001, tool.balls.front());
  EXPECT_EQ(ErrorOf(Strip(1), tool, {}), "tool: 10001 balls, accepted 1 … 10000");
  EXPECT_EQ(ErrorOf(Strip(1), {}, {}), "tool: 0 balls, accepted 1 … 10000");
  simulation::Bone bone = Strip(1);
  bone.materials.resize(9);
  EXPECT_EQ(ErrorOf(bone, Ball(3e-3), {}), "bone: 9 materials, accepted 1 … 8");
}

TEST(VulkanEngine, CutsLikeTheReferenceWithTheLargestNumberOfMaterials) {
  simulation::Tool tool;
  for (int i = 0; i < 64; ++i)  // balls in a line along x, as the teeth of a rake
    tool.balls.push_back(
        {.center_m = Vector3(0.4e-3 * (i - 31.5), 0, -2e-3), .radius_m = 2e-3, .cutting = i % 3 != 0});
  simulation::Bone bone = Strip(40);
  bone.materials.resize(8, bone.materials.front());
  for (std::size_t i = 0; i < bone.points.size(); ++i)
    bone.points[i].material = static_cast<simulation::MaterialIndex>(i % 8);
  simulation::ReferenceEngine reference(bone, tool, Pose::Identity(), {});
  const auto vulkan = Open(bone, tool);
  // moves beside the middle: at a symmetric place two balls would touch at the same time, and rounding would
  // decide which one counts
  for (int i = 0; i < 60; ++i) {
    const simulation::FrameInput input{.X_WT = Down({0.13e-3, 0.07e-3, 0.3e-3 - 0.05e-3 * i}),
                                       .spindle_rad_per_s = kSpindle_rad_per_s};
    const ContactModel a = reference.Step(input), b = vulkan->Step(input);
    ASSERT_TRUE(HaveSameContact(a, b)) << i;
  }
}

TEST(VulkanEngine, MovesFreelyInAnEmptyBone) {
  simulation::Bone bone;
  const auto engine = Open(bone, DefaultReamer());
  for (int i = 0; i < 10; ++i) {
    const ContactModel model =
        engine->Step({.X_WT = Down({0, 0, -0.01 * i}), .spindle_rad_per_s = kSpindle_rad_per_s});
    ASSERT_EQ(model.status, simulation::EngineStatus::kOk);
    ASSERT_EQ(model.contact_fraction, 1.0);
    ASSERT_EQ(model.contact_count, 0);
    ASSERT_NEAR(Vector3(model.X_WP.p).z(), -0.01 * i, 1e-8);
  }
  const simulation::CarvedState state = engine->Snapshot();
  EXPECT_TRUE(state.balls.empty());
  EXPECT_TRUE(state.cleared.empty());
  engine->Restore(state);
}

TEST(VulkanEngine, WorksWithoutPointsAndWithoutBalls) {
  simulation::Bone balls = Strip(10), points = Strip(10);
  balls.points.clear();
  points.balls.clear();
  const auto on_balls = Open(balls, Ball(5e-3)), on_points = Open(points, Ball(5e-3));
  ContactModel touched, free;
  for (int i = 0; i < 30; ++i) {
    const simulation::FrameInput input{.X_WT = Down({0, 0, 0.5e-3 - 0.05e-3 * i})};
    touched = on_balls->Step(input);
    free = on_points->Step(input);
  }
  EXPECT_GT(Vector3(touched.F_T_W.f).z(), 15.0);
  EXPECT_EQ(Vector3(free.F_T_W.f).norm(), 0.0);
}

class BoneSizes : public testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(, BoneSizes, testing::Values(1, 2, 63, 64, 65, 127, 129, 200));

// Workgroups and clusters hold 64 balls. The tested numbers of bone balls make the last cluster full, partly
// filled, short of one ball, or contain a single ball.
TEST_P(BoneSizes, AgreeWithTheReferenceBallByBall) {
  const simulation::Bone bone = Strip(GetParam());
  simulation::CuttingParams params;
  params.law = simulation::RemovalLaw::kImmediate;
  simulation::ReferenceEngine reference(bone, Ball(4e-3), Pose::Identity(), params);
  const auto vulkan = Open(bone, Ball(4e-3), {}, params);
  // the tool moves along the whole strip and beyond both ends, at a depth of 0.3 mm. It is 0.3 mm away from
  // the middle line, because there the sectors of contacts meet
  const double reach = 0.4e-3 * GetParam() + 2e-3;
  const int frames = static_cast<int>(2.0 * reach / 0.1e-3);  // per frame less than the proxy's largest slide
  for (int i = 0; i <= frames; ++i) {
    const simulation::FrameInput input{.X_WT = Down({reach * (2.0 * i / frames - 1.0), 0.3e-3, -0.3e-3}),
                                       .spindle_rad_per_s = kSpindle_rad_per_s};
    const ContactModel a = reference.Step(input), b = vulkan->Step(input);
    // the tolerance is that of sliding, because with single balls rounding decides which ball is met first
    ASSERT_EQ(b.status, simulation::EngineStatus::kOk);
    ASSERT_NEAR((Vector3(a.X_WP.p) - Vector3(b.X_WP.p)).norm(), 0.0, 2e-5) << i;
  }
  const simulation::CarvedState one = reference.Snapshot(), two = vulkan->Snapshot();
  ASSERT_EQ(one.balls.size(), two.balls.size());
  for (std::size_t i = 0; i < one.balls.size(); ++i) ASSERT_NEAR(one.balls[i], two.balls[i], 2e-2) << i;
  EXPECT_EQ(one.cleared, two.cleared);
  EXPECT_LT(two.balls[3], 1.0f);  // the first and the last ball must have been cut
  EXPECT_LT(two.balls.back(), 1.0f);
}

// Expects that culling changes no bit of the results: it may leave out only balls and points that the tool
// can't reach.
void ExpectCullingChangesNoBit(const simulation::Tool& tool, const simulation::CuttingParams& params = {}) {
  simulation::Bone bone = Strip(150);
  for (simulation::MassPoint& point : bone.points) point.p_m.z = -0.1e-3;
  VulkanParams every_pair;
  every_pair.brute_force = true;
  const auto culled = Open(bone, tool, {}, params), brute = Open(bone, tool, every_pair, params);
  const ContactModel last = ExpectSameBits(*culled, *brute, 150, [](int i, const ContactModel&) {
    return simulation::FrameInput{.X_WT = Stroke(i), .spindle_rad_per_s = kSpindle_rad_per_s};
  });
  EXPECT_GT(last.removed_volume_m3, 3e-9) << "something was cut";
  EXPECT_LT(culled->LastFrameStats().active_balls, brute->LastFrameStats().active_balls);
  EXPECT_EQ(brute->LastFrameStats().active_balls, 150u);
}

TEST(VulkanEngine, CullingGivesTheSameBitsAsBruteForce) {
  for (const int balls : {1, 300, 2000})  // with 2000 balls, a brute-force loop has more iterations than
                                          // llvmpipe allows in one invocation
    ExpectCullingChangesNoBit(balls == 1 ? Ball(6e-3) : Shell(balls));
}

TEST(VulkanEngine, CullingGivesTheSameBitsAsBruteForceWithTheContactSphere) {
  for (const int balls : {1, 300})
    ExpectCullingChangesNoBit(
        balls == 1 ? Ball(6e-3) : Shell(balls),
        {.law = simulation::RemovalLaw::kImmediate, .cutters = simulation::Cutters::kContactSphere});
}

TEST(VulkanEngine, CutsLikeTheReferenceWithAToolOfThousandsOfBalls) {
  const simulation::Tool tool = Shell(3000);
  simulation::ReferenceEngine reference(Strip(40), tool, Pose::Identity(), {});
  const auto vulkan = Open(Strip(40), tool);
  for (int i = 0; i < 120; ++i) {
    const simulation::FrameInput input{.X_WT = Stroke(i), .spindle_rad_per_s = kSpindle_rad_per_s};
    const ContactModel a = reference.Step(input), b = vulkan->Step(input);
    ASSERT_TRUE(HaveSameContact(a, b)) << i;
  }
  const simulation::CarvedState one = reference.Snapshot(), two = vulkan->Snapshot();
  for (std::size_t i = 0; i < one.balls.size(); ++i) ASSERT_NEAR(one.balls[i], two.balls[i], 1e-2) << i;
  EXPECT_EQ(one.cleared, two.cleared);
}

// The tool jumps by 1 m through the bone in one frame. The neighbour lists of the start must not hide the
// bone halfway.
TEST(VulkanEngine, AJumpOfAMetreMeetsTheBoneHalfway) {
  const auto engine = Open(Strip(40), Ball(4e-3));
  engine->Step({.X_WT = Down({0, 0, 0.5})});
  const ContactModel model = engine->Step({.X_WT = Down({0, 0, -0.5})});
  EXPECT_EQ(model.status, simulation::EngineStatus::kOk);
  EXPECT_NEAR(model.contact_fraction, 0.5, 1e-3);
  EXPECT_NEAR(Vector3(model.X_WP.p).z(), 0.0, 1e-4);
  EXPECT_NEAR(Vector3(model.F_T_W.f).norm(), 200.0, 1e-6) << "the limit";
}

TEST(VulkanEngine, MeasuresItsPassesOnRequest) {
  const auto timed = Open(Strip(10), Ball(4e-3), {.device = "", .time_passes = true}),
             plain = Open(Strip(10), Ball(4e-3));
  EXPECT_TRUE(timed->LastPassTimes().empty()) << "before the first frame";
  for (const auto& engine : {timed.get(), plain.get()}) engine->Step({.X_WT = Down({0, 0, 0.1e-3})});
  std::set<std::string> names;
  for (const PassTime& pass : timed->LastPassTimes()) {
    names.insert(pass.pass);
    EXPECT_GE(pass.seconds, 0.0);
  }
  for (const char* name :
       {"path_contact", "pick_balls", "pick_points", "near_field", "slide_engage", "remove_clear"})
    EXPECT_TRUE(names.contains(name)) << name;
  const std::vector<DeviceInfo> devices = ListDevices().value();
  const auto used = std::ranges::find(devices, timed->device(), &DeviceInfo::name);
  ASSERT_NE(used, devices.end());
  EXPECT_EQ(names.contains("solve"), used->kind == "cpu") << "a GPU's near field goes on with it";
  EXPECT_TRUE(plain->LastPassTimes().empty());
}

}  // namespace
}  // namespace osteon::gpu
