#include "simulation/mesh/shape_mesh.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

#include <fmt/format.h>
#include <Eigen/Geometry>

namespace osteon::simulation {
namespace {

/// Kuhn's division of the cube into six tetrahedra: one for each path along edges from corner 0 to corner 7.
/// The three bits of a corner's number are its coordinates x, y, z. A path follows the three axes in some
/// order; kEven is true if this order is an even permutation of x, y, z. It determines the tetrahedron's
/// orientation.
constexpr int kTetrahedra[6][4] = {{0, 1, 3, 7}, {0, 2, 6, 7}, {0, 4, 5, 7},
                                   {0, 1, 5, 7}, {0, 2, 3, 7}, {0, 4, 6, 7}};
constexpr bool kEven[6] = {true, true, true, false, false, false};

/// Marching tetrahedra on one grid (MeshOfLevel).
class Marching {
 public:
  Marching(const LevelFunction& level, const Eigen::AlignedBox3d& box, double step_m, int rounds)
      : level_(level), low_(box.min()), step_m_(step_m), rounds_(rounds) {
    if (!(step_m > 0.0) || !(box.sizes().minCoeff() > 0.0))
      throw std::invalid_argument("mesh of a shape: the step and the box must be positive");
    double count = 1.0;
    for (int axis = 0; axis < 3; ++axis) {
      const double along = std::ceil(box.sizes()[axis] / step_m) + 1.0;
      count *= along;
      if (!(count <= kMaxVertices))
        throw std::invalid_argument(fmt::format(
            "mesh of a shape: found a step of {:g} mm, accepted one that makes at most {:g} grid points",
            step_m * 1e3, kMaxVertices));
      size_[axis] = static_cast<std::size_t>(along);
    }
    values_.resize(size_[0] * size_[1] * size_[2]);
    for (std::size_t i = 0; i < values_.size(); ++i) values_[i] = level_(At(i));
  }

  /// @returns the mesh. @throws std::invalid_argument if the shape reaches the grid's border or is empty.
  TriangleMesh Run() {
    cuts_.assign(7 * values_.size(), kNone);
    for (std::size_t z = 0; z < size_[2]; ++z)
      for (std::size_t y = 0; y < size_[1]; ++y)
        for (std::size_t x = 0; x < size_[0]; ++x) {
          const bool border =
              x == 0 || y == 0 || z == 0 || x + 1 == size_[0] || y + 1 == size_[1] || z + 1 == size_[2];
          if (border && Inside(Index(x, y, z)))
            throw std::invalid_argument("mesh of a shape: it reaches the border of its box");
          if (x + 1 < size_[0] && y + 1 < size_[1] && z + 1 < size_[2]) Cube(Index(x, y, z));
        }
    if (mesh_.triangles.empty())
      throw std::invalid_argument("mesh of a shape: found no inside, accepted a shape wider than the step");
    return std::move(mesh_);
  }

 private:
  static constexpr double kMaxVertices = 50e6;
  static constexpr std::uint32_t kNone = 0xffffffffu;

  [[nodiscard]] std::size_t Index(std::size_t x, std::size_t y, std::size_t z) const {
    return (z * size_[1] + y) * size_[0] + x;
  }
  /// Index of the grid's vertex at a corner of a cube. A cube has the index of its corner 0.
  [[nodiscard]] std::size_t Corner(std::size_t cube, int corner) const {
    return cube + (corner & 1) + ((corner >> 1) & 1) * size_[0] + (corner >> 2) * size_[0] * size_[1];
  }
  /// Place of vertex i of the grid.
  [[nodiscard]] Vector3 At(std::size_t i) const {
    return low_ + step_m_ * Vector3(static_cast<double>(i % size_[0]),
                                    static_cast<double>(i / size_[0] % size_[1]),
                                    static_cast<double>(i / (size_[0] * size_[1])));
  }
  /// Whether vertex i is inside. A value of zero counts as outside, so every vertex is on one side.
  [[nodiscard]] bool Inside(std::size_t i) const { return values_[i] < 0.0; }

  /// Adds the triangles of the surface within a cube: one or two for each tetrahedron that the surface
  /// passes.
  void Cube(std::size_t cube) {
    int inside = 0;
    for (int corner = 0; corner < 8; ++corner) inside += Inside(Corner(cube, corner)) ? 1 : 0;
    if (inside == 0 || inside == 8) return;
    for (int t = 0; t < 6; ++t) {
      std::array<int, 4> in{}, out{};
      int ins = 0, outs = 0;
      // positions 0 … 3 in the tetrahedron of its inside and its outside corners, both ascending
      for (int k = 0; k < 4; ++k)
        if (Inside(Corner(cube, kTetrahedra[t][k])))
          in[ins++] = k;
        else
          out[outs++] = k;
      const auto cut = [&](int a, int b) { return Cut(cube, kTetrahedra[t][a], kTetrahedra[t][b]); };
      // An odd permutation reverses the triangles' winding: the parity of the tetrahedron, times that of the
      // order (inside corners, outside corners).
      bool even = kEven[t];
      std::array<int, 4> order{};
      for (int k = 0; k < ins; ++k) order[k] = in[k];
      for (int k = 0; k < outs; ++k) order[ins + k] = out[k];
      for (int a = 0; a < 4; ++a)
        for (int b = a + 1; b < 4; ++b)
          if (order[a] > order[b]) even = !even;
      if (ins == 1) {
        Add(cut(in[0], out[0]), cut(in[0], out[1]), cut(in[0], out[2]), even);
      } else if (ins == 3) {
        Add(cut(in[0], out[0]), cut(in[1], out[0]), cut(in[2], out[0]), even);
      } else if (ins == 2) {
        const std::uint32_t a = cut(in[0], out[0]), b = cut(in[0], out[1]), c = cut(in[1], out[1]),
                            d = cut(in[1], out[0]);
        Add(a, b, c, even);
        Add(a, c, d, even);
      }
    }
  }

  /// Adds a triangle. Unless `even`, its winding is reversed.
  void Add(std::uint32_t a, std::uint32_t b, std::uint32_t c, bool even) {
    if (!even) std::swap(b, c);
    mesh_.triangles.push_back({a, b, c});
  }

  /// Index of the vertex on the edge between two corners of a cube; created at the first call. An edge is
  /// identified by its lower corner and the set of axes along which its corners differ.
  std::uint32_t Cut(std::size_t cube, int a, int b) {
    const int low = a & b, along = a ^ b;
    std::uint32_t& vertex = cuts_[7 * Corner(cube, low) + along - 1];
    if (vertex != kNone) return vertex;
    const std::size_t from = Corner(cube, a), to = Corner(cube, b);
    const Vector3 p_in = At(Inside(from) ? from : to), p_out = At(Inside(from) ? to : from);
    double in = 0.0, out = 1.0;
    for (int round = 0; round < rounds_; ++round) {
      const double middle = 0.5 * (in + out);
      (level_(p_in + middle * (p_out - p_in)) < 0.0 ? in : out) = middle;
    }
    // smallest distance of a vertex from the edge's ends, divided by the edge's length
    constexpr double kFromEnds = 0.05;
    const double s = std::clamp(0.5 * (in + out), kFromEnds, 1.0 - kFromEnds);
    vertex = static_cast<std::uint32_t>(mesh_.vertices_m.size());
    mesh_.vertices_m.push_back(p_in + s * (p_out - p_in));
    return vertex;
  }

  const LevelFunction& level_;
  Vector3 low_;
  double step_m_;
  int rounds_;
  std::array<std::size_t, 3> size_{};
  std::vector<double> values_;       // level function at each vertex of the grid
  std::vector<std::uint32_t> cuts_;  // vertices of the mesh on the seven edges from each vertex of the grid
  TriangleMesh mesh_;
};

}  // namespace

TriangleMesh MeshOfLevel(const LevelFunction& level, const Eigen::AlignedBox3d& box, double step_m,
                         int rounds) {
  return Marching(level, box, step_m, rounds).Run();
}

TriangleMesh MeshOfRings(const std::vector<Ring>& rings) {
  const std::size_t n = rings.empty() ? 0 : rings.front().size();
  bool same = rings.size() >= 2 && n >= 3;
  for (const Ring& ring : rings) same = same && ring.size() == n;
  if (!same)
    throw std::invalid_argument(
        "mesh of rings: accepted two rings and more, of the same three points and more");
  TriangleMesh mesh;
  for (const Ring& ring : rings) mesh.vertices_m.insert(mesh.vertices_m.end(), ring.begin(), ring.end());
  const auto at = [n](std::size_t ring, std::size_t i) {
    return static_cast<std::uint32_t>(ring * n + i % n);
  };
  for (std::size_t k = 0; k + 1 < rings.size(); ++k)
    for (std::size_t i = 0; i < n; ++i) {
      mesh.triangles.push_back({at(k, i), at(k, i + 1), at(k + 1, i + 1)});
      mesh.triangles.push_back({at(k, i), at(k + 1, i + 1), at(k + 1, i)});
    }
  // closes an end of the tube by a fan around the mean of its ring's points
  const auto cap = [&](std::size_t ring, bool last) {
    Vector3 middle = Vector3::Zero();
    for (const Vector3& p : rings[ring]) middle += p;
    const auto center = static_cast<std::uint32_t>(mesh.vertices_m.size());
    mesh.vertices_m.push_back(middle / static_cast<double>(n));
    for (std::size_t i = 0; i < n; ++i)
      mesh.triangles.push_back(last ? std::array{center, at(ring, i), at(ring, i + 1)}
                                    : std::array{center, at(ring, i + 1), at(ring, i)});
  };
  cap(0, false);
  cap(rings.size() - 1, true);
  return mesh;
}

}  // namespace osteon::simulation
