#include <array>
#include <cmath>
#include <limits>
#include <stdexcept>

#include <gtest/gtest.h>

#include "gpu/context/context.h"
#include "tests/gpu/engine/engine_twins.h"
#include "tests/gpu/engine/strip_bench.h"

// Tests frames and devices that fail: overload, a lost device, full memory, and Vulkan that can't be opened.

namespace osteon::gpu {
namespace {

using simulation::ContactModel;
using simulation::EngineStatus;
using simulation::FrameInput;

// Parameters of an engine whose lists hold this many balls.
VulkanParams WithListCapacity(std::size_t list_capacity) {
  VulkanParams params;
  params.list_capacity = list_capacity;
  return params;
}

// In contact, a ball of 6 mm has about 16 balls of the strip in its reach, more than the lists hold; at its
// start height it has none.
TEST(VulkanEngine, ReportsOverloadIfMoreBallsAreInReachThanItsListsHold) {
  const auto engine = Open(Strip(150), Ball(6e-3), WithListCapacity(4));
  const auto input = [](double z_m) {
    return FrameInput{.X_WT = Down({0, 0, z_m}), .spindle_rad_per_s = kSpindle_rad_per_s};
  };
  EXPECT_EQ(engine->Step(input(10e-3)).status, EngineStatus::kOk);
  const simulation::CarvedState before = engine->Snapshot();
  for (int i = 0; i < 3; ++i) {
    const ContactModel model = engine->Step(input(-0.5e-3));
    ASSERT_EQ(model.status, EngineStatus::kOverloaded);
    ASSERT_EQ(model.contact_count, 0);
    ASSERT_EQ(model.frame, 0u);
  }
  const simulation::CarvedState after = engine->Snapshot();
  EXPECT_EQ(simulation::HashState(after), simulation::HashState(before)) << "the frame changed nothing";
  EXPECT_EQ(after.frame, before.frame);
  EXPECT_EQ(Vector3(after.X_GP.p).z(), Vector3(before.X_GP.p).z());
  // at a place with less bone the engine must continue
  const ContactModel free = engine->Step(input(9e-3));
  EXPECT_EQ(free.status, EngineStatus::kOk);
  EXPECT_EQ(free.frame, 2u);
}

// A bar turns so far within a frame that the engine divides the frame into parts. The first parts cut one
// ball; a later part reaches more balls than the lists hold. The frame then ends early, but it counts,
// because it has changed the bone.
TEST(VulkanEngine, AFrameThatHasCutBeforeAnOverloadCounts) {
  simulation::Tool bar;
  for (int i = 0; i < 12; ++i)
    bar.balls.push_back({.center_m = Vector3(5e-3 + 1e-3 * i, 0, 0), .radius_m = 0.5e-3});
  simulation::Bone bone;
  bone.materials = {{.name = "soft", .specific_cutting_energy_J_per_m3 = 1e6}};
  // places one ball at the angle 0.3 rad, and many balls near the end of the rotation
  const auto add = [&](double angle, double from_m) {
    const Vector3 c(from_m * std::cos(angle), from_m * std::sin(angle), 0);
    bone.balls.push_back({.center_m = c, .radius_m = 0.3e-3});
    bone.points.push_back({.p_m = c, .volume_m3 = 1e-10, .material = 0});
  };
  add(0.3, 10e-3);
  for (int i = 0; i < 60; ++i) add(1.5, 5e-3 + 0.2e-3 * i);
  const auto engine = Open(bone, bar, WithListCapacity(16), {.law = simulation::RemovalLaw::kImmediate});
  const auto turned = [](double angle) {
    Pose X_WT = Pose::Identity();
    X_WT.linear() = ExpRotation({0, 0, angle});
    return FrameInput{.X_WT = X_WT, .spindle_rad_per_s = kSpindle_rad_per_s};
  };
  ASSERT_EQ(engine->Step(turned(0.0)).status, EngineStatus::kOk);
  ASSERT_EQ(engine->Snapshot().removed_volume_m3, 0.0);
  const ContactModel whole = engine->Step(turned(1.6));
  EXPECT_EQ(whole.status, EngineStatus::kOk);
  EXPECT_GT(whole.removed_volume_m3, 0.0) << "the part that cut";
  EXPECT_EQ(whole.frame, 2u);
  // the next frame has too many balls in reach from its beginning, so it must change nothing
  const std::uint64_t hash = simulation::HashState(engine->Snapshot());
  EXPECT_EQ(engine->Step(turned(1.6)).status, EngineStatus::kOverloaded);
  EXPECT_EQ(simulation::HashState(engine->Snapshot()), hash);
}

// Parameters of an engine whose device appears to hang: its timeout is zero, so it expires in every frame.
VulkanParams WithHangingDevice() {
  VulkanParams params;
  params.overrides.fence = FencePolicy::kWait;
  params.frame_timeout_s = 0.0;
  return params;
}

TEST(VulkanEngine, ReportsDeviceLostAfterAFrameThatTimesOut) {
  const auto engine = Open(DefaultBone(), DefaultReamer(), WithHangingDevice());
  Hand hand;
  EXPECT_EQ(engine->Step(hand.Next(Vector3::Zero())).status, EngineStatus::kOk)
      << "the first has its own time";
  for (int i = 0; i < 3; ++i) {
    const ContactModel model = engine->Step(hand.Next(Vector3::Zero()));
    ASSERT_EQ(model.status, EngineStatus::kDeviceLost);
    ASSERT_EQ(model.contact_count, 0);
    ASSERT_EQ(Vector3(model.F_T_W.f).norm(), 0.0);
  }
  const simulation::CarvedState snapshot = engine->Snapshot();
  EXPECT_EQ(snapshot.frame, 1u);
  EXPECT_TRUE(snapshot.balls.empty()) << "what lay on the device";
  EXPECT_THROW(engine->Restore(snapshot), std::runtime_error);
}

// A snapshot must read the balls back from the device. If that takes too long, the snapshot has no balls and
// the device counts as lost.
TEST(VulkanEngine, ASnapshotThatTimesOutLosesTheDevice) {
  const auto engine = Open(DefaultBone(), DefaultReamer(), WithHangingDevice());
  Hand hand;
  ASSERT_EQ(engine->Step(hand.Next(Vector3::Zero())).status, EngineStatus::kOk);
  const simulation::CarvedState state = engine->Snapshot();
  EXPECT_TRUE(state.balls.empty());
  EXPECT_EQ(state.frame, 1u);
  EXPECT_EQ(engine->Step(hand.Next(Vector3::Zero())).status, EngineStatus::kDeviceLost);
}

// ---- memory

// Memory types of a graphics card: 8 GB on the device (type 0), 16 GB on the host (types 1 and 2, type 2
// cached), and a window of 256 MB into the device's memory that the host can access (type 3).
vk::PhysicalDeviceMemoryProperties CardMemory() {
  using Property = vk::MemoryPropertyFlagBits;
  const vk::MemoryPropertyFlags host = Property::eHostVisible | Property::eHostCoherent;
  vk::PhysicalDeviceMemoryProperties memory;
  memory.memoryHeapCount = 3;
  memory.memoryHeaps[0] = vk::MemoryHeap(8ull << 30, vk::MemoryHeapFlagBits::eDeviceLocal);
  memory.memoryHeaps[1] = vk::MemoryHeap(16ull << 30, {});
  memory.memoryHeaps[2] = vk::MemoryHeap(256ull << 20, vk::MemoryHeapFlagBits::eDeviceLocal);
  memory.memoryTypeCount = 4;
  memory.memoryTypes[0] = vk::MemoryType(Property::eDeviceLocal, 0);
  memory.memoryTypes[1] = vk::MemoryType(host, 1);
  memory.memoryTypes[2] = vk::MemoryType(host | Property::eHostCached, 1);
  memory.memoryTypes[3] = vk::MemoryType(host | Property::eDeviceLocal, 2);
  return memory;
}

using Types = std::vector<std::uint32_t>;

TEST(MemoryTypes, AreSortedByTheirUseForThePlacement) {
  const vk::MemoryRequirements small(1 << 20, 256, 0xf);
  EXPECT_EQ(MemoryTypes(CardMemory(), small, Placement::kDevice), (Types{0, 3, 1, 2}));
  EXPECT_EQ(MemoryTypes(CardMemory(), small, Placement::kShared), (Types{3, 1, 2}));
  EXPECT_EQ(MemoryTypes(CardMemory(), small, Placement::kReadBack), (Types{2, 1, 3}));
  EXPECT_EQ(MemoryTypes(CardMemory(), {1 << 20, 256, 0x2}, Placement::kShared), (Types{1}))
      << "what the buffer allows";
}

TEST(MemoryTypes, ExcludeAHeapThatIsSmallerThanTheBuffer) {
  EXPECT_EQ(MemoryTypes(CardMemory(), {300ull << 20, 256, 0xf}, Placement::kShared), (Types{1, 2}));
  EXPECT_EQ(MemoryTypes(CardMemory(), {9ull << 30, 256, 0xf}, Placement::kDevice), (Types{1, 2}));
}

TEST(MemoryTypes, AreTriedInOrderWhenOneIsFull) {
  Types tried;
  EXPECT_EQ(AllocateFromFirst({3, 1, 2},
                              [&](std::uint32_t type) {
                                tried.push_back(type);
                                if (type == 3) throw vk::OutOfDeviceMemoryError("full");
                              }),
            1u);
  EXPECT_EQ(tried, (Types{3, 1}));
  EXPECT_THROW(AllocateFromFirst({3, 1}, [](std::uint32_t) { throw vk::OutOfHostMemoryError("full"); }),
               vk::OutOfDeviceMemoryError);
  EXPECT_THROW(AllocateFromFirst({3, 1}, [](std::uint32_t) { throw vk::DeviceLostError("gone"); }),
               vk::DeviceLostError);
}

// ---- opening

TEST(OpeningFailure, KeepsItsCause) {
  EXPECT_NE(OpeningFailure(vk::IncompatibleDriverError("")).find("no Vulkan driver found"),
            std::string::npos);
  EXPECT_NE(
      OpeningFailure(std::runtime_error("Failed to load vulkan library!")).find("no Vulkan driver found"),
      std::string::npos);
  EXPECT_NE(OpeningFailure(vk::LayerNotPresentError("")).find("vulkan-validationlayers"), std::string::npos);
  for (const std::string& text : {OpeningFailure(vk::OutOfHostMemoryError("vkCreateInstance")),
                                  OpeningFailure(vk::InitializationFailedError("vkCreateInstance")),
                                  OpeningFailure(std::runtime_error("vkCreateInstance"))}) {
    EXPECT_EQ(text.find("no Vulkan driver found"), std::string::npos) << text;
    EXPECT_NE(text.find("vkCreateInstance"), std::string::npos) << text;
  }
}

}  // namespace
}  // namespace osteon::gpu
