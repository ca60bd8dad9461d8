#pragma once

#include <limits>
#include <optional>
#include <vector>

#include <Eigen/Geometry>

#include "simulation/solids/solid.h"

namespace osteon::simulation {

/// A point of a surface and its unit normal, pointing out of the solid.
struct OrientedPoint {
  Vector3 p_m{Vector3::Zero()};
  Vector3 normal{Vector3::UnitZ()};
};

/// Points of a solid's surface about `spacing_m` apart: for each cell of a grid that the surface may cross,
/// the surface's point nearest to the cell's centre. The result depends on the arguments alone, for any
/// number of threads.
/// @throws std::invalid_argument if the spacing is outside 0.05 … 20 mm, or less than 1/2000 of the
///   solid's box.
[[nodiscard]] std::vector<OrientedPoint> PointsOfSurface(const Solid& solid, double spacing_m);

/// The outward unit normal at a point of the surface, from the solid's distances just inside.
[[nodiscard]] Vector3 SurfaceNormal(const Solid& solid, const Vector3& p_m);

/// Spatial index for the nearest of many samples. The samples are sorted along a space-filling curve and
/// divided into chunks, each with a box.
class SampleIndex {
 public:
  explicit SampleIndex(std::vector<OrientedPoint> samples);

  /// Nearest sample to c within `limit_m`; nothing if there is none. Of equally near samples, the first.
  /// @param only_ahead  only samples whose surface faces away from c, as seen from within the solid: (p -
  ///   c)·normal > 0
  [[nodiscard]] std::optional<OrientedPoint> Nearest(const Vector3& c_m,
                                                     double limit_m = std::numeric_limits<double>::infinity(),
                                                     bool only_ahead = false) const;

  [[nodiscard]] std::size_t size() const { return samples_.size(); }
  [[nodiscard]] const std::vector<OrientedPoint>& samples() const { return samples_; }

 private:
  static constexpr std::size_t kChunk = 32;
  std::vector<OrientedPoint> samples_;
  std::vector<Eigen::AlignedBox3d> boxes_;  // box of each chunk
};

}  // namespace osteon::simulation
