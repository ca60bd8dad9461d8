#pragma once

#include <cstdint>
#include <vector>

#include "simulation/mesh/triangle_mesh.h"

namespace osteon::simulation {

/// Generalised winding number of a mesh about a point: the sum of the signed solid angles of all triangles,
/// divided by 4 pi.
///
/// It is 1 inside and 0 outside a closed surface that is wound outwards. It is near these values if the
/// surface has holes, and 2 where two solids overlap. The triangles need not bound a volume.
///
/// A tree answers in logarithmic time. A group of triangles that is at least twice its radius away from the
/// point p is replaced by a Taylor series of first order about the group's centre c. Its coefficients are the
/// dipole n, the sum of the triangles' area vectors, and the moments M, the sum of the area vectors times (x
/// - c)^T, x being a triangle's centroid:
///
///     4 pi w = n·r / |r|^3 + (tr M - 3 r·M r / |r|^2) / |r|^3,   r = c - p
///
/// Nearer triangles are summed exactly. Error: below 0.1, and 0.01 on average (test
/// WindingNumber.IsThatOfAllTriangles); the jump by 1 across a triangle stays exactly at the triangle.
///
/// Source: Barill, Dickson, Schmidt, Levin, Jacobson, Fast Winding Numbers for Soups and Clouds, ACM Trans.
/// Graph. 37 (4), 2018. Solid angle of a triangle: Van Oosterom, Strackee, IEEE Trans. Biomed. Eng. 30, 1983.
class WindingNumber {
 public:
  explicit WindingNumber(const TriangleMesh& mesh);

  /// Winding number about p.
  [[nodiscard]] double At(const Vector3& p_m) const;

 private:
  /// A group of triangles, with the coefficients of its series for points far away.
  struct Group {
    Vector3 center_m{Vector3::Zero()};
    Vector3 dipole_m2{Vector3::Zero()};  ///< sum of the triangles' area vectors (normal times area)
    Matrix3 moments_m3{Matrix3::Zero()};
    double radius_m{0.0};            ///< largest distance of a vertex from center_m
    std::uint32_t first{0}, end{0};  ///< range in triangles_
    /// Index of the group's second half; the first half follows this group; 0: not divided
    std::uint32_t second_half{0};
  };

  /// Makes the group of triangles_[first, end), and the groups of its halves. @returns the group's index.
  std::uint32_t Divide(std::uint32_t first, std::uint32_t end);

  std::vector<std::array<Vector3, 3>> triangles_;  ///< sorted, so that each group is a range
  std::vector<Group> groups_;
};

/// Winding number of one triangle about p: its solid angle over 4 pi, positive where p is behind it.
[[nodiscard]] double TriangleWinding(const Vector3& p_m, const Vector3& a_m, const Vector3& b_m,
                                     const Vector3& c_m);

}  // namespace osteon::simulation
