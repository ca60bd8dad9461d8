#include "simulation/mesh/winding_number.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include <Eigen/Geometry>

namespace osteon::simulation {
namespace {

constexpr std::uint32_t kMaxLeaf = 6;  // largest number of triangles in a group that is not divided
// the series is used for a group that is farther away than this times its radius
constexpr double kFar = 2.0;
// each division halves the number of triangles: 2^32 triangles need 32 divisions
constexpr std::size_t kMaxDepth = 64;

}  // namespace

double TriangleWinding(const Vector3& p_m, const Vector3& a_m, const Vector3& b_m, const Vector3& c_m) {
  const Vector3 a = a_m - p_m, b = b_m - p_m, c = c_m - p_m;
  const double la = a.norm(), lb = b.norm(), lc = c.norm();
  return std::atan2(a.dot(b.cross(c)), la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb) /
         (2.0 * std::numbers::pi);
}

WindingNumber::WindingNumber(const TriangleMesh& mesh) {
  triangles_.reserve(mesh.triangles.size());
  for (const auto& t : mesh.triangles)
    triangles_.push_back({mesh.vertices_m[t[0]], mesh.vertices_m[t[1]], mesh.vertices_m[t[2]]});
  if (!triangles_.empty()) Divide(0, static_cast<std::uint32_t>(triangles_.size()));
}

std::uint32_t WindingNumber::Divide(std::uint32_t first, std::uint32_t end) {
  const auto center = [](const std::array<Vector3, 3>& t) -> Vector3 { return (t[0] + t[1] + t[2]) / 3.0; };
  const auto normal = [](const std::array<Vector3, 3>& t) -> Vector3 {
    return 0.5 * (t[1] - t[0]).cross(t[2] - t[0]);
  };
  Group group{.first = first, .end = end};
  double area_m2 = 0.0;
  Eigen::AlignedBox3d centers;
  for (std::uint32_t i = first; i < end; ++i) {
    const double area = normal(triangles_[i]).norm();
    area_m2 += area;
    group.center_m += area * center(triangles_[i]);
    centers.extend(center(triangles_[i]));
  }
  group.center_m = area_m2 > 0.0 ? Vector3(group.center_m / area_m2) : centers.center();
  for (std::uint32_t i = first; i < end; ++i) {
    const std::array<Vector3, 3>& t = triangles_[i];
    group.dipole_m2 += normal(t);
    group.moments_m3 += normal(t) * (center(t) - group.center_m).transpose();
    for (const Vector3& v : t) group.radius_m = std::max(group.radius_m, (v - group.center_m).norm());
  }
  const auto index = static_cast<std::uint32_t>(groups_.size());
  groups_.push_back(group);
  if (end - first <= kMaxLeaf) return index;
  int axis = 0;
  centers.sizes().maxCoeff(&axis);
  const std::uint32_t middle = first + (end - first) / 2;
  std::nth_element(triangles_.begin() + first, triangles_.begin() + middle, triangles_.begin() + end,
                   [axis](const auto& s, const auto& t) {
                     return s[0][axis] + s[1][axis] + s[2][axis] < t[0][axis] + t[1][axis] + t[2][axis];
                   });
  Divide(first, middle);
  const std::uint32_t second_half = Divide(middle, end);
  groups_[index].second_half = second_half;
  return index;
}

double WindingNumber::At(const Vector3& p_m) const {
  if (groups_.empty()) return 0.0;
  std::array<std::uint32_t, kMaxDepth> waiting{};
  std::size_t count = 0;
  waiting[count++] = 0;
  double exact = 0.0, far = 0.0;  // sums of the near triangles, and of the far groups times 4 pi
  while (count > 0) {
    const std::uint32_t index = waiting[--count];
    const Group& group = groups_[index];
    const Vector3 r = group.center_m - p_m;
    const double squared = r.squaredNorm();
    if (squared > kFar * kFar * group.radius_m * group.radius_m) {
      const double cubed = squared * std::sqrt(squared);
      far +=
          (group.dipole_m2.dot(r) + group.moments_m3.trace() - 3.0 * r.dot(group.moments_m3 * r) / squared) /
          cubed;
    } else if (group.second_half == 0) {
      for (std::uint32_t i = group.first; i < group.end; ++i)
        exact += TriangleWinding(p_m, triangles_[i][0], triangles_[i][1], triangles_[i][2]);
    } else {
      waiting[count++] = group.second_half;
      waiting[count++] = index + 1;
    }
  }
  return exact + far / (4.0 * std::numbers::pi);
}

}  // namespace osteon::simulation
