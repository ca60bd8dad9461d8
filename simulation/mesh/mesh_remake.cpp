#include "simulation/mesh/mesh_remake.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <fmt/format.h>
#include <Eigen/Geometry>

#include "simulation/mesh/mesh_bvh.h"
#include "simulation/mesh/shape_mesh.h"
#include "simulation/mesh/winding_number.h"

namespace osteon::simulation {
namespace {

constexpr double kInside = 0.5;        // winding number at the surface that is made
constexpr double kSurely = 0.1;        // distance from kInside from which a block has one winding number
constexpr double kSolidWinding = 0.8;  // inside a closed solid it is 1
// smallest share of the volume inside whose winding number is above kSolidWinding
constexpr double kMinSolidShare = 0.5;
constexpr double kMinStep_m = 0.1e-3;  // smallest step of the grid
constexpr int kBlock = 4;              // grid steps along the edge of a block
// number of a shell's triangles that are tested for lying in other shells
constexpr std::size_t kShellSamples = 9;
constexpr int kBisections = 10;  // number of bisections: the vertices are exact to a thousandth of the step

/// Groups of triangles that are joined by edges with exactly two triangles.
struct Shells {
  std::vector<std::uint32_t> of_triangle;             // shell of each triangle
  std::vector<std::vector<std::uint32_t>> triangles;  // of each shell
};

/// Finds the shells, and winds all triangles of a shell in one sense. Counts the defective edges and the
/// shells in `found`.
Shells OrientShells(TriangleMesh& mesh, MeshRemake& found) {
  const std::vector<MeshEdge> edges = SortedEdges(mesh);
  struct Neighbour {
    std::uint32_t triangle;
    bool contrary;
  };
  std::vector<std::vector<Neighbour>> neighbours(mesh.triangles.size());
  for (std::size_t i = 0; i < edges.size();) {
    std::size_t end = i;
    while (end < edges.size() && edges[end].low == edges[i].low && edges[end].high == edges[i].high) ++end;
    if (end - i == 1) ++found.open_edges;
    if (end - i > 2) ++found.crowded_edges;
    if (end - i == 2) {
      const MeshEdge &a = edges[i], &b = edges[i + 1];
      const bool contrary = a.rising == b.rising;
      found.contrary_edges += contrary ? 1 : 0;
      neighbours[a.triangle].push_back({b.triangle, contrary});
      neighbours[b.triangle].push_back({a.triangle, contrary});
    }
    i = end;
  }
  constexpr std::uint32_t kNone = ~0u;
  Shells shells{.of_triangle = std::vector<std::uint32_t>(mesh.triangles.size(), kNone), .triangles = {}};
  std::vector<bool> turned(mesh.triangles.size(), false);
  for (std::uint32_t first = 0; first < mesh.triangles.size(); ++first) {
    if (shells.of_triangle[first] != kNone) continue;
    const auto shell = static_cast<std::uint32_t>(shells.triangles.size());
    std::vector<std::uint32_t> members{first};
    shells.of_triangle[first] = shell;
    std::size_t turns = 0;
    for (std::size_t k = 0; k < members.size(); ++k)
      for (const auto& [other, contrary] : neighbours[members[k]]) {
        if (shells.of_triangle[other] != kNone) continue;
        shells.of_triangle[other] = shell;
        turned[other] = turned[members[k]] != contrary;
        turns += turned[other] ? 1 : 0;
        members.push_back(other);
      }
    // the shell gets the sense that most of its triangles had
    if (2 * turns > members.size())
      for (const std::uint32_t t : members) turned[t] = !turned[t];
    shells.triangles.push_back(std::move(members));
  }
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t)
    if (turned[t]) std::swap(mesh.triangles[t][1], mesh.triangles[t][2]);
  found.shells = shells.triangles.size();
  return shells;
}

/// Signed volume between the shell and its mean vertex; for a closed shell, the volume that it encloses.
double ShellVolume_m3(const TriangleMesh& mesh, const std::vector<std::uint32_t>& shell) {
  Vector3 center = Vector3::Zero();
  for (const std::uint32_t t : shell) center += mesh.vertices_m[mesh.triangles[t][0]];
  center /= static_cast<double>(shell.size());
  double sum = 0.0;
  for (const std::uint32_t t : shell) {
    const auto& [a, b, c] = mesh.triangles[t];
    sum +=
        (mesh.vertices_m[a] - center).dot((mesh.vertices_m[b] - center).cross(mesh.vertices_m[c] - center));
  }
  return sum / 6.0;
}

/// Reverses the winding of a shell's triangles.
void Turn(TriangleMesh& mesh, const std::vector<std::uint32_t>& shell) {
  for (const std::uint32_t t : shell) std::swap(mesh.triangles[t][1], mesh.triangles[t][2]);
}

/// Winds all shells outwards except cavities. A cavity is a shell that is wound inwards and lies mostly
/// within other shells.
void WindOutwards(TriangleMesh& mesh, const Shells& shells, MeshRemake& found) {
  std::vector<double> volumes_m3(shells.triangles.size());
  double total_m3 = 0.0;
  for (std::size_t s = 0; s < volumes_m3.size(); ++s)
    total_m3 += volumes_m3[s] = ShellVolume_m3(mesh, shells.triangles[s]);
  const double sense = total_m3 < 0.0 ? -1.0 : 1.0;  // the whole file may be inside out
  std::vector<std::size_t> inwards;
  for (std::size_t s = 0; s < volumes_m3.size(); ++s) {
    if (sense * volumes_m3[s] < 0.0) inwards.push_back(s);
    if (volumes_m3[s] < 0.0) Turn(mesh, shells.triangles[s]);
  }
  found.turned_shells = sense < 0.0 ? volumes_m3.size() - inwards.size() : 0;
  if (inwards.empty()) return;
  const WindingNumber winding(mesh);  // here all shells are wound outwards
  for (const std::size_t s : inwards) {
    const auto& own = shells.triangles[s];
    const std::size_t samples = std::min(kShellSamples, own.size());
    std::size_t within = 0;
    for (std::size_t k = 0; k < samples; ++k) {
      const auto& t = mesh.triangles[own[k * own.size() / samples]];
      const Vector3 p = (mesh.vertices_m[t[0]] + mesh.vertices_m[t[1]] + mesh.vertices_m[t[2]]) / 3.0;
      // becomes the winding number of the other shells: the loop subtracts this shell's
      double others = winding.At(p);
      for (const std::uint32_t i : own)
        others -=
            TriangleWinding(p, mesh.vertices_m[mesh.triangles[i][0]], mesh.vertices_m[mesh.triangles[i][1]],
                            mesh.vertices_m[mesh.triangles[i][2]]);
      within += others > kInside ? 1 : 0;
    }
    if (2 * within > samples)
      Turn(mesh, own);
    else if (sense > 0.0)
      ++found.turned_shells;
  }
}

/// The function 1/2 - winding number, which is negative inside the solid. A block of the grid gets a single
/// value if it has no triangles and its corners and centre lie clearly on one side of the surface: the
/// winding number changes slowly in such a block.
class WindingLevel {
 public:
  WindingLevel(const TriangleMesh& mesh, const Eigen::AlignedBox3d& box, double step_m)
      : winding_(mesh), low_(box.min()), block_m_(kBlock * step_m) {
    for (int axis = 0; axis < 3; ++axis)
      size_[axis] = static_cast<std::size_t>(std::ceil(box.sizes()[axis] / block_m_)) + 1;
    blocks_.assign(size_[0] * size_[1] * size_[2], kUnknown);
    for (const auto& t : mesh.triangles) {
      Eigen::AlignedBox3d around;
      for (const std::uint32_t v : t) around.extend(mesh.vertices_m[v]);
      const auto from = Cell(around.min()), to = Cell(around.max());
      for (std::size_t z = from[2]; z <= to[2]; ++z)
        for (std::size_t y = from[1]; y <= to[1]; ++y)
          for (std::size_t x = from[0]; x <= to[0]; ++x) blocks_[Index({x, y, z})] = kSurface;
    }
  }

  /// Value at p. The first call in a block decides whether the block has a single value (Decide).
  double operator()(const Vector3& p_m) {
    const std::array<std::size_t, 3> cell = Cell(p_m);
    float& block = blocks_[Index(cell)];
    if (block == kUnknown) block = Decide(cell);
    return block == kSurface ? kInside - winding_.At(p_m) : kInside - static_cast<double>(block);
  }

  /// Share of the blocks whose centres lie inside that have a winding number above kSolidWinding.
  [[nodiscard]] double SolidShare() const {
    std::size_t inside = 0, solid = 0;
    for (std::size_t z = 0; z < size_[2]; ++z)
      for (std::size_t y = 0; y < size_[1]; ++y)
        for (std::size_t x = 0; x < size_[0]; ++x) {
          const float block = blocks_[Index({x, y, z})];
          const double w = block == kSurface || block == kUnknown ? winding_.At(Center({x, y, z})) : block;
          inside += w > kInside ? 1 : 0;
          solid += w > kSolidWinding ? 1 : 0;
        }
    return inside == 0 ? 0.0 : static_cast<double>(solid) / static_cast<double>(inside);
  }

 private:
  // Entries of blocks_: not decided yet; the value must be computed at each point. Any other entry is the
  // block's winding number.
  static constexpr float kUnknown = 1e30f, kSurface = 2e30f;

  /// Indices along the axes of the block that contains p; for a point outside the grid, of the nearest block.
  [[nodiscard]] std::array<std::size_t, 3> Cell(const Vector3& p_m) const {
    std::array<std::size_t, 3> cell{};
    for (int axis = 0; axis < 3; ++axis)
      cell[axis] = static_cast<std::size_t>(
          std::clamp((p_m[axis] - low_[axis]) / block_m_, 0.0, static_cast<double>(size_[axis] - 1)));
    return cell;
  }
  [[nodiscard]] std::size_t Index(const std::array<std::size_t, 3>& cell) const {
    return (cell[2] * size_[1] + cell[1]) * size_[0] + cell[0];
  }
  [[nodiscard]] Vector3 Center(const std::array<std::size_t, 3>& cell) const {
    return low_ + block_m_ * Vector3(static_cast<double>(cell[0]) + 0.5, static_cast<double>(cell[1]) + 0.5,
                                     static_cast<double>(cell[2]) + 0.5);
  }
  /// The winding number of a block without triangles; kSurface if its corners and centre do not lie clearly
  /// on one side.
  [[nodiscard]] float Decide(const std::array<std::size_t, 3>& cell) const {
    const Vector3 center = Center(cell);
    const double w = winding_.At(center);
    double min = w, max = w;
    for (int corner = 0; corner < 8; ++corner) {
      const double at = winding_.At(
          center + 0.5 * block_m_ * Vector3(corner & 1 ? 1 : -1, corner & 2 ? 1 : -1, corner & 4 ? 1 : -1));
      min = std::min(min, at);
      max = std::max(max, at);
    }
    return min > kInside + kSurely || max < kInside - kSurely ? static_cast<float>(w) : kSurface;
  }

  WindingNumber winding_;
  Vector3 low_;
  double block_m_;
  std::array<std::size_t, 3> size_{};
  std::vector<float> blocks_;
};

}  // namespace

tl::expected<LoadedMesh, std::string> RemakeMesh(const PartedMesh& parted, const MeshReport& report,
                                                 double grid_points) {
  MeshRemake found;
  TriangleMesh mesh = parted.mesh;
  found.crossings = MeshBvh(mesh).CountCrossings(kCrossingTolerance_m);
  const Shells shells = OrientShells(mesh, found);
  WindOutwards(mesh, shells, found);

  Eigen::AlignedBox3d box;
  for (const auto& t : mesh.triangles)
    for (const std::uint32_t v : t) box.extend(mesh.vertices_m[v]);
  found.step_m = std::max(kMinStep_m, std::cbrt(box.volume() / grid_points));
  // the box must hold the surface with at least one step to spare (MeshOfLevel)
  const Vector3 room = Vector3::Constant(2.3 * found.step_m);
  box.extend(Vector3(box.min() - room));
  box.extend(Vector3(box.max() + room));
  WindingLevel level(mesh, box, found.step_m);
  const double share = level.SolidShare();
  if (share < kMinSolidShare)
    return tl::make_unexpected(fmt::format(
        "{}; found a winding number above {:g} in {:.0f} % of the volume where it is above {:g}, accepted "
        "{:.0f} % and more (holes that are small beside the solid)",
        DescribeDefects(found), kSolidWinding, 100.0 * share, kInside, 100.0 * kMinSolidShare));
  TriangleMesh surface;
  try {
    surface =
        MeshOfLevel([&level](const Vector3& p_m) { return level(p_m); }, box, found.step_m, kBisections);
  } catch (const std::invalid_argument& error) {
    return tl::make_unexpected(fmt::format("{}; {}", DescribeDefects(found), error.what()));
  }
  found.dropped_shells = KeepLargestShells(surface);
  found.volume_m3 = SignedVolume_m3(surface);
  MeshReport remade = report;
  remade.remake = found;
  auto accepted = AcceptMesh({.mesh = std::move(surface), .parts = {}, .part_of_triangle = {}}, remade,
                             "the remade surface");
  if (!accepted) return tl::make_unexpected(accepted.error().message);
  return std::move(*accepted);
}

std::string DescribeDefects(const MeshRemake& remake) {
  std::string text = fmt::format(
      "found {} open edges, {} edges of more than two triangles, {} edges between contrary "
      "senses, {} edges through triangles, {} shells",
      remake.open_edges, remake.crowded_edges, remake.contrary_edges, remake.crossings, remake.shells);
  if (remake.turned_shells > 0) text += fmt::format(" ({} of them inside out)", remake.turned_shells);
  return text;
}

std::string DescribeRemake(const MeshRemake& remake) {
  std::string text = fmt::format(
      "{}; accepted one closed surface: taken as solid where the winding number is above 0.5 (holes closed, "
      "overlaps merged), {:.4g} cm³, remade on a grid of {:.2g} mm, in which thinner features are lost",
      DescribeDefects(remake), remake.volume_m3 * 1e6, remake.step_m * 1e3);
  if (remake.dropped_shells > 0)
    text += fmt::format("; the {} smallest shells dropped", remake.dropped_shells);
  return text;
}

}  // namespace osteon::simulation
