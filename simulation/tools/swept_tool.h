#pragma once

#include <span>
#include <vector>

#include "kinematics/spatial.h"
#include "simulation/tools/tool.h"

namespace osteon::simulation {

/// Signed distance to a swept volume, and the nearest point on the path of a ball's centre.
struct SweptDistance {
  double distance_m;  ///< to the volume's surface; negative inside
  Vector3 axis_G;  ///< centre of the nearest ball on its path; the query point itself where nothing was swept
};

/// A tool and the path of its poses in G. A session has one for each of its tools, which cut one after the
/// other.
struct ToolPath {
  const Tool* tool;
  std::span<const Pose> X_GP;
};

/// Volume that a tool's cutting balls sweep along a path of poses: the union of capsules between consecutive
/// poses, in G.
class SweptTool {
 public:
  /// Skips poses that are not finite. Leaves out poses if the remaining path stays within `tolerance_m` of
  /// each ball's centre.
  SweptTool(const Tool& tool, std::span<const Pose> X_GP, double tolerance_m = 1e-6);
  /// The union of the volumes that several tools sweep.
  explicit SweptTool(std::span<const ToolPath> paths, double tolerance_m = 1e-6);

  /// Signed distance [m] to the union: negative inside. Exact outside; inside, its absolute value is a lower
  /// bound of the distance to the union's surface. Infinity if nothing was swept.
  [[nodiscard]] double SignedDistance(const Vector3& p_G) const { return Nearest(p_G).distance_m; }

  [[nodiscard]] SweptDistance Nearest(const Vector3& p_G) const;
  /// A box around the swept volume; empty if nothing was swept.
  [[nodiscard]] Eigen::AlignedBox3d Bounds() const;
  [[nodiscard]] bool empty() const { return capsules_.empty(); }

 private:
  struct Capsule {
    Vector3 a, b;
    double radius_m;
  };
  /// Consecutive capsules of one ball, begin … end - 1, and a box around their axes: Nearest skips the chunk
  /// if the box is too far away.
  struct Chunk {
    Vector3 min, max;
    std::size_t begin, end;
    double radius_m;
  };
  // Adds the capsules of a tool's cutting balls, in chunks.
  void Add(const ToolPath& path, double tolerance_m);

  std::vector<Capsule> capsules_;
  std::vector<Chunk> chunks_;
};

}  // namespace osteon::simulation
