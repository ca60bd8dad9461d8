#pragma once

#include <memory>
#include <string>
#include <vector>

#include <tl/expected.hpp>

#include "simulation/bone.h"
#include "simulation/cutting_engine.h"
#include "simulation/tool.h"

namespace osteon::gpu {

struct VulkanParams {
  std::string device;       ///< part of a device's name; empty: the best there is
  bool validation{false};   ///< run under the validation layers
  bool time_passes{false};  ///< timestamps between the passes; software drivers wait at each
};

/// Device time of one pass of the last frame.
struct PassTime {
  const char* pass;
  double seconds;
};

/// The cutting model as Vulkan compute. A frame is one submit, recorded once:
///
///     contact_live ─▶ place ─┬────────────────────────────────────────────────────┬─▶ planes ─▶ solve ─▶
///     slide, engage
///                            └─▶ reach ─▶ contact ─▶ place ─▶ near ─▶ pick lists ─┘        ─▶ advance ─▶
///                            remove, clear
///
/// Balls and points lie in clusters of 64 along a space-filling curve, each with the box that it had at the
/// start; reach and near list the clusters whose box a tool ball can meet, pick lists the balls and points
/// that it can, and the passes after them run over those lists alone. The lists serve until the tool has
/// moved by a margin that is built into them: the lower branch is dispatched indirectly, with no workgroups
/// where it is not needed. A box stays valid for ever because bone only shrinks inside itself. Sums are whole
/// numbers (fixed point): equal inputs give equal bits, whatever the order of execution. No pass over balls
/// or points has a barrier: software drivers pay microseconds a workgroup for one. What every pass computes
/// is told by simulation::ReferenceEngine, its oracle.
class VulkanEngine final : public simulation::CuttingEngine {
 public:
  /// An error text where the device is unknown, memory does not suffice, or bone and tool are beyond the
  /// engine's sizes.
  [[nodiscard]] static tl::expected<std::unique_ptr<VulkanEngine>, std::string> Create(
      const simulation::Bone& bone, const simulation::Tool& tool, const Pose& X_WG,
      const simulation::CuttingParams& params, const VulkanParams& vulkan);
  ~VulkanEngine() override;

  simulation::ContactModel Step(const simulation::FrameInput& input) override;
  [[nodiscard]] simulation::CarvedState Snapshot() const override;
  void Restore(const simulation::CarvedState& state) override;
  [[nodiscard]] std::string name() const override { return "vulkan"; }
  [[nodiscard]] std::string device() const override;

  /// Device time by pass of the last frame; empty where they were not asked for, or the device has none.
  [[nodiscard]] std::vector<PassTime> LastPassTimes() const;

  /// What the validation layers have said so far; 0 without them.
  [[nodiscard]] int validation_messages() const;

 private:
  struct Impl;
  explicit VulkanEngine(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace osteon::gpu
