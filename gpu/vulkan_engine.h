#pragma once

#include <memory>
#include <string>

#include <tl/expected.hpp>

#include "simulation/bone.h"
#include "simulation/cutting_engine.h"
#include "simulation/tool.h"

namespace osteon::gpu {

struct VulkanParams {
  std::string device;      ///< part of a device's name; empty: the best there is
  bool validation{false};  ///< run under the validation layers
};

/// The cutting model as Vulkan compute. A frame is one submit of six dispatches, recorded once:
///
///     contact ─▶ planes ─▶ solve ─▶ slide + engaged area ─▶ advance ─▶ remove
///
/// Balls and points lie in clusters of 64 along a space-filling curve, each with the box that it had at the start; a
/// workgroup whose box no tool ball reaches ends at once. The box stays valid because bone only shrinks inside itself.
/// Sums go in a fixed order or over whole numbers: equal inputs give equal bits on one device. What every pass does is told
/// by simulation::ReferenceEngine, its oracle.
class VulkanEngine final : public simulation::CuttingEngine {
 public:
  /// An error text where the device is unknown, memory does not suffice, or bone and tool are beyond the engine's sizes.
  [[nodiscard]] static tl::expected<std::unique_ptr<VulkanEngine>, std::string> Create(
      const simulation::Bone& bone, const simulation::Tool& tool, const Pose& X_WG,
      const simulation::CuttingParams& params, const VulkanParams& vulkan);
  ~VulkanEngine() override;

  simulation::ContactModel Step(const simulation::FrameInput& input) override;
  [[nodiscard]] simulation::CarvedState Snapshot() const override;
  void Restore(const simulation::CarvedState& state) override;
  [[nodiscard]] std::string name() const override { return "vulkan"; }
  [[nodiscard]] std::string device() const override;

  /// What the validation layers have said so far; 0 without them.
  [[nodiscard]] int validation_messages() const;

 private:
  struct Impl;
  explicit VulkanEngine(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace osteon::gpu
