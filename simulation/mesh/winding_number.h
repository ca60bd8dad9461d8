#pragma once

#include <cstdint>
#include <vector>

#include "simulation/mesh/triangle_mesh.h"

namespace osteon::simulation {

/// Generalised winding number of a mesh about a point: the solid angles of all triangles, over 4 pi.
///
/// 1 inside and 0 outside a closed surface that is wound outwards; near these values where the surface has
/// holes; 2 where two solids overlap. The triangles need not bound anything.
///
/// A tree answers in logarithmic time. A group of triangles that is at least twice its radius away counts by
/// its Taylor series to the first order: the dipole n at the group's centre c and the moments M = sum of n (x
/// - c)^T,
///
///     4 pi w = n·r / |r|^3 + (tr M - 3 r·M r / |r|^2) / |r|^3,   r = c - p
///
/// Nearer triangles count exactly. Error: below 0.1, and 0.01 on average (test
/// WindingNumber.IsThatOfAllTriangles); the jump of 1 at a triangle stays in its place.
///
/// Source: Barill, Dickson, Schmidt, Levin, Jacobson, Fast Winding Numbers for Soups and Clouds, ACM Trans.
/// Graph. 37 (4), 2018. Solid angle of a triangle: Van Oosterom, Strackee, IEEE Trans. Biomed. Eng. 30, 1983.
class WindingNumber {
 public:
  explicit WindingNumber(const TriangleMesh& mesh);

  /// Winding number about p.
  [[nodiscard]] double At(const Vector3& p_m) const;

 private:
  /// Triangles that count together at points far from them, and the sums of their series.
  struct Group {
    Vector3 center_m{Vector3::Zero()};
    Vector3 dipole_m2{Vector3::Zero()};  ///< sum of the triangles' normals, as long as their areas
    Matrix3 moments_m3{Matrix3::Zero()};
    double radius_m{0.0};            ///< largest distance of a vertex from center_m
    std::uint32_t first{0}, end{0};  ///< its triangles
    std::uint32_t second_half{0};    ///< index of its second half; the first follows it; 0: not divided
  };

  /// Makes the group of triangles_[first, end), and those of its halves. @returns its index.
  std::uint32_t Divide(std::uint32_t first, std::uint32_t end);

  std::vector<std::array<Vector3, 3>> triangles_;  ///< in the order of the groups
  std::vector<Group> groups_;
};

/// Winding number of one triangle about p: its solid angle over 4 pi, positive where p is behind it.
[[nodiscard]] double TriangleWinding(const Vector3& p_m, const Vector3& a_m, const Vector3& b_m,
                                     const Vector3& c_m);

}  // namespace osteon::simulation
