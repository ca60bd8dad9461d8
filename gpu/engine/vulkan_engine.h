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
  kAuto,       ///< chosen by the kind of the device
  kProcessor,  ///< small workgroups and long chunks; a separate pass computes the solution; the host waits
               ///< for the fence
  kGpu,  ///< large workgroups; the last workgroup computes the solution and the readback; sums are combined
         ///< in shared memory
};

/// Values that replace those derived from the device and the bone. With them, tests run the code paths of
/// another device or of a larger bone on the device at hand.
struct VulkanOverrides {
  PassVariant variant{PassVariant::kAuto};
  FencePolicy fence{FencePolicy::kAuto};
  std::uint32_t subgroup_size{0};  ///< 0: the device's default; other sizes need VK_EXT_subgroup_size_control
  std::uint32_t max_workgroups{0};  ///< largest number of workgroups in a pass along x; 0: the device's limit
  std::uint32_t bone_ball_bits{0};  ///< bits for a bone ball's index in keys, 24 … 28; 0: as the bone needs
  Arithmetic arithmetic{Arithmetic::kAuto};  ///< the device must have the features for it
  std::optional<bool> fused_fma{};           ///< replaces the result of HasFusedFma; only without doubles
};

struct VulkanParams {
  std::string device;       ///< part of a device's name; empty: the default device
  bool validation{false};   ///< run with the validation layers, including synchronisation validation
  bool time_passes{false};  ///< take timestamps between the passes; software drivers wait at each timestamp
  bool brute_force{false};  ///< test every pair in every pass: the baseline for measuring the culling
  /// Largest number of balls, or of mass points, within the tool's reach at once. If there are more, the
  /// frame's status is kOverloaded.
  std::size_t list_capacity{4'000'000};
  /// If a frame takes longer, the device counts as lost. The first frame may take 120 s, because software
  /// drivers compile the passes in it. The servo loop stops because of the model's age long before this
  /// timeout.
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
///     path contact ─▶ pick balls, points ─▶ planes ─▶ …                with new lists
///
/// Balls and points are grouped in clusters of 64 along a space-filling curve. Each cluster has a bounding
/// box, computed at the start; it stays valid because balls only shrink within their former volume. In a tree
/// of these boxes the host finds the clusters that the tool can meet on its path. The device lists the balls
/// and points in these clusters that the tool can touch, each with the tool balls that can touch it. The
/// passes run over these lists only. The lists include a margin (skin) and are used until the tool has moved
/// by more than it. Sums are integers (fixed point), so equal inputs give equal bits in any order of
/// execution. simulation::ReferenceEngine, the oracle, documents what every pass computes.
class VulkanEngine final : public simulation::CuttingEngine {
 public:
  /// Creates the engine. Returns an error text if there is no such device, memory does not suffice, or bone
  /// and tool exceed the engine's limits of size.
  [[nodiscard]] static tl::expected<std::unique_ptr<VulkanEngine>, std::string> Create(
      const simulation::Bone& bone, const simulation::Tool& tool, const Pose& X_WG,
      const simulation::CuttingParams& params, const VulkanParams& vulkan);
  ~VulkanEngine() override;

  simulation::ContactModel Step(const simulation::FrameInput& input) override;
  /// Returns the state of the cut bone. If the device is lost, the state contains only the frame memory,
  /// because balls and points are lost with the device. If the device is lost during this call, the next Step
  /// reports it.
  [[nodiscard]] simulation::CarvedState Snapshot() const override;
  /// @throws std::invalid_argument if the state belongs to another bone or tool; std::runtime_error if the
  /// device is lost.
  void Restore(const simulation::CarvedState& state) override;
  [[nodiscard]] std::string name() const override { return "vulkan"; }
  [[nodiscard]] std::string device() const override;

  /// Device time by pass of the last frame; empty if time_passes is off or the device has no timestamps.
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
