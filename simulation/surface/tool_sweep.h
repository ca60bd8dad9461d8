#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "base/clock.h"
#include "kinematics/spatial.h"
#include "simulation/contact/contact_model.h"
#include "simulation/surface/capsule.h"
#include "simulation/tools/tool.h"

namespace osteon::surface {

/// The tool's path in one frame, in W. It is plain data, so that it can pass through a ring between threads.
struct ToolFrame {
  PlainPose X_WP;                 ///< the proxy's pose at the frame's end
  PlainVector3 p_WS_m;            ///< T's origin after the slide, before the bone yielded
  bool cuts{false};               ///< the spindle turned
  std::uint64_t frame{0};         ///< number of the frame; 0: no path
  bool touches{false};            ///< the tool touched or cut bone
  rt::Nanoseconds pose_stamp{0};  ///< when the frame's pose was commanded
};

/// Makes a frame's path from the frame's contact model. A frame with an error has no path.
[[nodiscard]] ToolFrame MakeToolFrame(const simulation::ContactModel& model, double spindle_rad_per_s);

/// Converts the tool's path into the capsules that its cutting balls sweep, in G:
///
///     old proxy ─▶ slid ─▶ new proxy        in every frame in which the spindle turns
///
/// The path from the old proxy to the first contact is free of bone, so the corner at the contact is left
/// out. If a frame turns the tool much, interpolated poses are added, as in the engine. Batches of sixteen
/// frames are thinned to 5 um. Skipped frames are replaced by a straight path. Frames in which the tool moves
/// by less than a micrometre are skipped.
class ToolSweep {
 public:
  ToolSweep(const simulation::Tool& tool, const Pose& X_WG);

  static constexpr int kBatchFrames = 16;
  static constexpr double kTolerance_m = 5e-6;

  /// Adds a frame. A batch ends after a fixed number of frames, independent of time, so that carving a run
  /// again gives the same capsules.
  /// @returns whether a batch is complete: TakeCapsules then returns its capsules, possibly none
  bool Add(const ToolFrame& frame);

  /// Returns all capsules since the last call, including those of an incomplete batch.
  [[nodiscard]] std::vector<Capsule> TakeCapsules();

  /// Number of the last frame that was added.
  [[nodiscard]] std::uint64_t frame() const { return frame_; }

 private:
  // Appends a frame's poses: interpolated poses up to the pose after the slide, then the new proxy.
  void AddPath(const Pose& slid, const Pose& X_GP);
  // Thins the collected path and appends its capsules. A new path then starts.
  void EndPath();

  Pose X_GW_;
  std::vector<simulation::ToolBall> cutters_;
  double lever_m_{0.0};       // largest distance of a ball's centre from T's origin
  std::optional<Pose> X_GP_;  // end of the last frame that moved the tool
  std::vector<Pose> way_;     // poses of consecutive cutting frames
  std::vector<Capsule> capsules_;
  int frames_{0};  // cutting frames since the last batch ended
  std::uint64_t frame_{0};
};

/// Edge of a voxel that suits a tool [mm]: a quarter of its head's radius, at least 0.1 and at most 0.5 mm.
[[nodiscard]] float VoxelFor(const simulation::Tool& tool);

}  // namespace osteon::surface
