#pragma once

#include <memory>
#include <string>
#include <vector>

#include <tl/expected.hpp>

#include "simulation/bone.h"
#include "simulation/cutting_engine.h"
#include "simulation/tool.h"

namespace osteon::gpu {

/// How the end of a frame is noticed.
enum class FencePolicy : std::uint8_t {
  kAuto,    ///< the report where a GPU is (poll where balls are split), wait where the processor plays one
  kReport,  ///< look for the frame's report in memory, before the fence
  kPoll,    ///< ask for the fence
  kWait,    ///< be woken by it
};

/// For which kind of device the passes are built: see "On a GPU" in the README.
enum class PassVariant : std::uint8_t {
  kAuto,       ///< for the device's own kind
  kProcessor,  ///< few lanes and long chunks, the solution in a pass of its own, waits for the fence
  kGpu,        ///< many lanes, the last workgroup solves and reports, sums meet in shared memory
};

/// What the engine otherwise takes from the device and the bone. Tests run with it on one device what another
/// device or a larger bone would run.
struct VulkanOverrides {
  PassVariant variant{PassVariant::kAuto};
  std::uint32_t subgroup_size{0};   ///< 0: the device's own; others need VK_EXT_subgroup_size_control
  std::uint32_t max_workgroups{0};  ///< of a pass, along x; 0: as many as the device takes
  std::uint32_t bone_ball_bits{0};  ///< of a bone ball's index in keys, 24 … 28; 0: as many as the bone needs
};

struct VulkanParams {
  std::string device;       ///< part of a device's name; empty: the best there is
  bool validation{false};   ///< run under the validation layers, synchronisation included
  bool time_passes{false};  ///< timestamps between the passes; software drivers wait at each
  FencePolicy fence{FencePolicy::kAuto};
  bool brute_force{false};  ///< every pair in every pass: what culling is measured against
  /// Balls, or mass points, that may be within the tool's reach at once: beyond, a frame is kOverloaded.
  std::size_t list_capacity{4'000'000};
  /// A frame that takes longer counts as a lost device. The first one may take 120 s, since software drivers
  /// compile in it. The servo loop stops on the model's age long before.
  double frame_timeout_s{20.0};
  VulkanOverrides overrides{};
};

/// What the last frame looked at.
struct FrameStats {
  std::size_t active_balls{0};   ///< bone balls within reach of the tool
  std::size_t active_points{0};  ///< mass points within reach of its cutting balls
  bool lists_made{false};        ///< whether these lists were made anew
};

/// Device time of one pass of the last frame.
struct PassTime {
  const char* pass;
  double seconds;
};

/// The cutting model as Vulkan compute. A frame is one submit, recorded once:
///
///     contact ─▶ planes ─▶ solve ─▶ slide, engage ─▶ remove, clear     with lists of earlier frames
///     path contact ─▶ pick balls, points ─▶ planes ─▶ …                with lists made anew
///
/// Balls and points lie in clusters of 64 along a space-filling curve, each with the box that it had at the
/// start. The host finds the clusters that the tool's way can meet in a tree of those boxes; the device lists
/// the balls and points in them that the tool can touch, with the tool balls that can touch each, and the
/// passes run over those lists alone. They serve until the tool has moved by a margin that is built into
/// them. A box stays valid for ever because bone only shrinks inside itself. Sums are whole numbers (fixed
/// point): equal inputs give equal bits, whatever the order of execution. What every pass computes is told by
/// simulation::ReferenceEngine, its oracle.
class VulkanEngine final : public simulation::CuttingEngine {
 public:
  /// An error text where the device is unknown, memory does not suffice, or bone and tool are beyond the
  /// engine's sizes.
  [[nodiscard]] static tl::expected<std::unique_ptr<VulkanEngine>, std::string> Create(
      const simulation::Bone& bone, const simulation::Tool& tool, const Pose& X_WG,
      const simulation::CuttingParams& params, const VulkanParams& vulkan);
  ~VulkanEngine() override;

  simulation::ContactModel Step(const simulation::FrameInput& input) override;
  /// Of a lost device the books alone, without balls and points: they lay on it. Where the device is lost
  /// here, the next Step says so.
  [[nodiscard]] simulation::CarvedState Snapshot() const override;
  /// @throws std::invalid_argument where the state is not of this bone and tool; std::runtime_error where the
  ///   device is lost.
  void Restore(const simulation::CarvedState& state) override;
  [[nodiscard]] std::string name() const override { return "vulkan"; }
  [[nodiscard]] std::string device() const override;

  /// Device time by pass of the last frame; empty where they were not asked for, or the device has none.
  [[nodiscard]] std::vector<PassTime> LastPassTimes() const;

  [[nodiscard]] FrameStats LastFrameStats() const;

  /// What the validation layers have said so far of this process's engines; 0 without them.
  [[nodiscard]] int validation_messages() const;

 private:
  struct Impl;
  explicit VulkanEngine(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace osteon::gpu
