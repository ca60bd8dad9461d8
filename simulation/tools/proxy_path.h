#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "kinematics/spatial.h"
#include "simulation/frame_record.h"
#include "simulation/tool.h"

namespace osteon::simulation {

/// The proxy's path in G, frame by frame, for runs of any length: every pose as long as there are fewer than
/// kMaxPoses, then thinned so that each cutting ball's centre stays close to where it was (tolerance_m).
/// Memory does not grow with the run: where thinning keeps too much, the tolerance is doubled.
class ProxyPath {
 public:
  static constexpr std::size_t kMaxPoses = std::size_t{1} << 17;  ///< 131 s at 1000 frames/s; 16 MiB

  /// @param max_poses  at least 4
  ProxyPath(const Tool& tool, const Pose& X_WG, std::size_t max_poses = kMaxPoses);

  /// Frames in which the engine reported an error, or that are no frame (number 0), are left out.
  void Add(const FrameRecord& frame);

  [[nodiscard]] std::span<const Pose> X_GP() const { return X_GP_; }
  /// No cutting ball's centre was farther than this from the path of chords that is left [m]; 0: every pose
  /// is there.
  [[nodiscard]] double tolerance_m() const { return thinned_ == 0 ? 0.0 : 2.0 * step_m_ - kFirstStep_m; }

 private:
  static constexpr double kFirstStep_m = 0.125e-6;

  [[nodiscard]] double OffChord(const Pose& X, const Pose& A, const Pose& B) const;
  void Thin(std::size_t first);

  Pose X_GW_;
  std::vector<Vector3> corners_T_;  // of the box around the centres of the cutting balls
  std::size_t max_poses_;
  std::vector<Pose> X_GP_;
  std::size_t thinned_{0};       // so many poses at the beginning were thinned
  double step_m_{kFirstStep_m};  // by this
};

}  // namespace osteon::simulation
