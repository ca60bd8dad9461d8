#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "kinematics/spatial.h"
#include "simulation/engine/frame_record.h"
#include "simulation/tools/tool.h"

namespace osteon::simulation {

/// The proxy's path in G, frame by frame, for runs of any length. All poses are stored as long as there are
/// fewer than kMaxPoses. Then the path is thinned, so that the centre of each cutting ball stays within
/// tolerance_m of its true path. If too many poses are left, the tolerance is doubled, so that memory does
/// not grow with the length of the run.
class ProxyPath {
 public:
  static constexpr std::size_t kMaxPoses = std::size_t{1} << 17;  ///< 131 s at 1000 frames/s; 16 MiB

  /// @param max_poses  at least 4
  ProxyPath(const Tool& tool, const Pose& X_WG, std::size_t max_poses = kMaxPoses);

  /// Adds a frame. Frames in which the engine reported an error, or whose number is 0, are left out.
  void Add(const FrameRecord& frame);

  [[nodiscard]] std::span<const Pose> X_GP() const { return X_GP_; }
  /// Largest distance of a cutting ball's centre from the stored path of chords [m]; 0: every pose is stored.
  [[nodiscard]] double tolerance_m() const { return thinned_ == 0 ? 0.0 : 2.0 * step_m_ - kFirstStep_m; }

 private:
  static constexpr double kFirstStep_m = 0.125e-6;  // tolerance of the first thinning

  // Upper bound [m] of the distance of a cutting ball's centre at pose X from its chord between the poses A
  // and B.
  [[nodiscard]] double DistanceFromChord(const Pose& X, const Pose& A, const Pose& B) const;
  // Thins the poses from index `first` to the end to within step_m_.
  void Thin(std::size_t first);

  Pose X_GW_;
  std::vector<Vector3> corners_T_;  // corners of the box around the centres of the cutting balls
  std::size_t max_poses_;
  std::vector<Pose> X_GP_;
  std::size_t thinned_{0};       // number of poses at the beginning that were thinned
  double step_m_{kFirstStep_m};  // tolerance of the present thinning
};

}  // namespace osteon::simulation
