#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <tl/expected.hpp>

#include "gpu/context/devices.h"
#include "simulation/bone/bone.h"
#include "simulation/engine/cutting_engine.h"
#include "simulation/tools/tool.h"

namespace osteon::gpu {

/// How the host detects the end of a frame.
enum class FencePolicy : std::uint8_t {
  kAuto,    ///< on a GPU kReport, on a processor kWait
  kReport,  ///< poll the frame's readback in memory; a frame that splits balls also waits for the fence
  kPoll,    ///< poll the fence
  kWait,    ///< wait for the fence
};

/// The kind of device that the passes are built for: see "On a GPU" in the README.
enum class PassVariant : std::uint8_t {
  kAuto,       ///< chosen by the device's own kind
  kProcessor,  ///< few lanes and long chunks, the solution in a separate pass, waits for the fence
  kGpu,        ///< many lanes, the last workgroup solves and reports, sums are combined in shared memory
};

/// Values that otherwise follow from the device and the bone. With them, tests run on one device what another
/// device or a larger bone would run.
struct VulkanOverrides {
  PassVariant variant{PassVariant::kAuto};
  FencePolicy fence{FencePolicy::kAuto};
  std::uint32_t subgroup_size{0};   ///< 0: the device's own; other sizes need VK_EXT_subgroup_size_control
  std::uint32_t max_workgroups{0};  ///< largest number in a pass, along x; 0: the device's limit
  std::uint32_t bone_ball_bits{0};  ///< bits for a bone ball's index in keys, 24 … 28; 0: as the bone needs
  Arithmetic arithmetic{Arithmetic::kAuto};  ///< the device must have the features for it
  std::optional<bool> fused_fma{};           ///< replaces the result of HasFusedFma; only without doubles
};

struct VulkanParams {
  std::string device;       ///< part of a device's name; empty: the default device
  bool validation{false};   ///< run under the validation layers, synchronisation included
  bool time_passes{false};  ///< timestamps between the passes; software drivers wait at each one
  bool brute_force{false};  ///< tests every pair in every pass: the baseline for culling
  /// Largest number of balls, or of mass points, within the tool's reach at once. Beyond it a frame is
  /// kOverloaded.
  std::size_t list_capacity{4'000'000};
  /// A frame that takes longer counts as a lost device. The first frame may take 120 s, since software
  /// drivers compile in it. The servo loop stops on the model's age long before.
  double frame_timeout_s{20.0};
  VulkanOverrides overrides{};
};

/// Amount of work in the last frame.
struct FrameStats {
  std::size_t active_balls{0};  ///< bone balls within reach of the tool
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
/// Balls and points are in clusters of 64 along a space-filling curve, each with its box at the start. The
/// host finds the clusters that the tool can meet on its path, in a tree of those boxes. The device lists the
/// balls and points in them that the tool can touch, each with the tool balls that can touch it, and the
/// passes run over these lists alone. Lists have a margin and serve until the tool has moved by it. Boxes
/// stay valid because bone only shrinks inside itself. Sums are integers (fixed point): equal inputs give
/// equal bits, whatever the order of execution. simulation::ReferenceEngine, the oracle, documents what every
/// pass computes.
class VulkanEngine final : public simulation::CuttingEngine {
 public:
  /// Creates the engine. Returns an error text if the device is unknown, memory does not suffice, or bone and
  /// tool exceed the engine's sizes.
  [[nodiscard]] static tl::expected<std::unique_ptr<VulkanEngine>, std::string> Create(
      const simulation::Bone& bone, const simulation::Tool& tool, const Pose& X_WG,
      const simulation::CuttingParams& params, const VulkanParams& vulkan);
  ~VulkanEngine() override;

  simulation::ContactModel Step(const simulation::FrameInput& input) override;
  /// Returns the state of the cut bone. If the device is lost, the state has only the frame memory: balls and
  /// points are lost with the device. If the device is lost during this call, the next Step reports it.
  [[nodiscard]] simulation::CarvedState Snapshot() const override;
  /// @throws std::invalid_argument where the state belongs to another bone or tool; std::runtime_error where
  ///   the device is lost.
  void Restore(const simulation::CarvedState& state) override;
  [[nodiscard]] std::string name() const override { return "vulkan"; }
  [[nodiscard]] std::string device() const override;

  /// Device time by pass of the last frame; empty where time_passes is off, or the device has no timestamps.
  [[nodiscard]] std::vector<PassTime> LastPassTimes() const;

  [[nodiscard]] FrameStats LastFrameStats() const;

  /// Number of validation messages so far about this process's engines; 0 without the layers.
  [[nodiscard]] int validation_messages() const;

 private:
  struct Impl;
  explicit VulkanEngine(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace osteon::gpu
