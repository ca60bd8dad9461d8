#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/format.h>
#include <Eigen/Geometry>

#include "simulation/mesh/mesh_steps.h"

namespace osteon::simulation {
namespace {

constexpr std::size_t kMaxShells = 64;
// number of triangles that LiesIn tests; odd, so that there is always a majority
constexpr std::size_t kSamples = 15;
constexpr double kMinFullness = 1e-12;  // smallest accepted volume, divided by the cube of the box's diagonal

/// Triangles that are joined by common vertices.
struct Shell {
  std::vector<std::uint32_t> triangles;
  Eigen::AlignedBox3d box;
  double volume_m3{0.0};            // signed
  std::vector<std::size_t> around;  // indices of the shells that contain this one
};

/// Centroid of triangle t.
Vector3 Center(const TriangleMesh& mesh, std::uint32_t t) {
  const auto& [a, b, c] = mesh.triangles[t];
  return (mesh.vertices_m[a] + mesh.vertices_m[b] + mesh.vertices_m[c]) / 3.0;
}

/// Finds the shells of a mesh, each with its box and signed volume, in the order of their first triangles.
std::vector<Shell> SplitShells(const TriangleMesh& mesh) {
  DisjointSets sets(mesh.vertices_m.size());
  for (const auto& t : mesh.triangles) {
    sets.Join(t[0], t[1]);
    sets.Join(t[1], t[2]);
  }
  std::vector<std::int64_t> shell_of(mesh.vertices_m.size(), -1);
  std::vector<Shell> shells;
  for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) {
    std::int64_t& shell = shell_of[sets.Find(mesh.triangles[i][0])];
    if (shell < 0) {
      shell = static_cast<std::int64_t>(shells.size());
      shells.emplace_back();
    }
    shells[shell].triangles.push_back(i);
  }
  for (Shell& shell : shells) {
    const Vector3 o = mesh.vertices_m[mesh.triangles[shell.triangles.front()][0]];
    for (const std::uint32_t i : shell.triangles) {
      const auto& t = mesh.triangles[i];
      for (const std::uint32_t v : t) shell.box.extend(mesh.vertices_m[v]);
      shell.volume_m3 +=
          (mesh.vertices_m[t[0]] - o).dot((mesh.vertices_m[t[1]] - o).cross(mesh.vertices_m[t[2]] - o)) / 6.0;
    }
  }
  return shells;
}

/// Winding number of a shell about p: 0 outside, +1 inside (-1 if the shell is wound inwards). Solid angles:
/// Van Oosterom, Strackee, IEEE Trans. Biomed. Eng. 30, 1983.
double WindingNumber(const TriangleMesh& mesh, const Shell& shell, const Vector3& p) {
  double sum = 0.0;
  for (const std::uint32_t i : shell.triangles) {
    const auto& t = mesh.triangles[i];
    const Vector3 a = mesh.vertices_m[t[0]] - p, b = mesh.vertices_m[t[1]] - p, c = mesh.vertices_m[t[2]] - p;
    const double la = a.norm(), lb = b.norm(), lc = c.norm();
    sum += std::atan2(a.dot(b.cross(c)), la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb);
  }
  return sum / (2.0 * std::numbers::pi);
}

/// True if most sampled triangles of `inner` lie in `outer`. One point would not be enough, because shells
/// may touch or cross within kCrossingTolerance_m.
bool LiesIn(const TriangleMesh& mesh, const Shell& inner, const Shell& outer) {
  const std::size_t samples = std::min(kSamples, inner.triangles.size());
  std::size_t inside = 0;
  for (std::size_t s = 0; s < samples; ++s) {
    const Vector3 p = Center(mesh, inner.triangles[s * inner.triangles.size() / samples]);
    if (outer.box.contains(p) && std::abs(WindingNumber(mesh, outer, p)) > 0.5) ++inside;
  }
  return 2 * inside > samples;
}

/// Extracts the wanted shells as a mesh of their own.
TriangleMesh Extract(const TriangleMesh& mesh, const std::vector<Shell>& shells,
                     const std::vector<bool>& wanted) {
  std::vector<std::uint32_t> triangles;
  for (std::size_t s = 0; s < shells.size(); ++s)
    if (wanted[s]) triangles.insert(triangles.end(), shells[s].triangles.begin(), shells[s].triangles.end());
  std::sort(triangles.begin(), triangles.end());  // restores the order of the file
  constexpr std::uint32_t kNone = ~0u;
  std::vector<std::uint32_t> place(mesh.vertices_m.size(), kNone);
  TriangleMesh extract;
  for (const std::uint32_t i : triangles) {
    std::array<std::uint32_t, 3> t = mesh.triangles[i];
    for (std::uint32_t& v : t) {
      if (place[v] == kNone) {
        place[v] = static_cast<std::uint32_t>(extract.vertices_m.size());
        extract.vertices_m.push_back(mesh.vertices_m[v]);
      }
      v = place[v];
    }
    extract.triangles.push_back(t);
  }
  return extract;
}

}  // namespace

std::size_t KeepLargestShells(TriangleMesh& mesh) {
  const std::vector<Shell> shells = SplitShells(mesh);
  if (shells.size() <= kMaxShells) return 0;
  std::vector<std::size_t> order(shells.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&shells](std::size_t i, std::size_t k) {
    return std::abs(shells[i].volume_m3) > std::abs(shells[k].volume_m3);
  });
  std::vector<bool> kept(shells.size(), false);
  for (std::size_t i = 0; i < kMaxShells; ++i) kept[order[i]] = true;
  mesh = Extract(mesh, shells, kept);
  return shells.size() - kMaxShells;
}

tl::expected<LoadedMesh, MeshError> SortShells(PartedMesh parted, MeshReport report,
                                               const std::string& name) {
  const TriangleMesh& mesh = parted.mesh;
  std::vector<Shell> shells = SplitShells(mesh);
  const auto refuse = [](MeshErrorKind kind, std::string message) {
    return tl::make_unexpected(MeshError{.kind = kind, .message = std::move(message)});
  };
  if (shells.size() > kMaxShells)
    return refuse(MeshErrorKind::kContradictory,
                  fmt::format("{}: found {} separate shells, accepted 1 … {} (remove the islands)", name,
                              shells.size(), kMaxShells));
  std::vector<MeshShell>& found = report.shells;
  for (const Shell& shell : shells) {
    const std::uint32_t first = shell.triangles.front();
    const std::uint32_t part = parted.part_of_triangle.empty() ? 0 : parted.part_of_triangle[first];
    found.push_back({.name = part < parted.parts.size() ? parted.parts[part] : "",
                     .triangles = shell.triangles.size(),
                     .volume_m3 = std::abs(shell.volume_m3),
                     .parent = {}});
    if (!(std::abs(shell.volume_m3) > kMinFullness * std::pow(shell.box.diagonal().norm(), 3)))
      return refuse(MeshErrorKind::kNoVolume,
                    fmt::format("{}: shell {} '{}' at {}, triangle {}: found nothing enclosed, accepted a "
                                "shell with a volume",
                                name, found.size() - 1, found.back().name, InMm(Center(mesh, first)), first));
  }
  // shell k contains shell i
  for (std::size_t i = 0; i < shells.size(); ++i)
    for (std::size_t k = 0; k < shells.size(); ++k)
      if (i != k && std::abs(shells[k].volume_m3) > std::abs(shells[i].volume_m3) &&
          shells[i].box.intersects(shells[k].box) && LiesIn(mesh, shells[i], shells[k]))
        shells[i].around.push_back(k);

  // visit the shells from outside inwards, so that a shell's parent is known before the shell
  std::vector<std::size_t> order(shells.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](std::size_t i, std::size_t k) {
    return shells[i].around.size() < shells[k].around.size();
  });
  LoadedMesh loaded;
  std::vector<bool> bounds(shells.size(), false);  // shells that bound the solid
  std::vector<std::vector<bool>> region_bounds;    // for each region, the shells that bound it
  std::vector<std::optional<std::size_t>> region_of(shells.size());  // index of a shell's region
  for (const std::size_t i : order) {
    const Shell& shell = shells[i];
    if (!shell.around.empty())
      found[i].parent = *std::min_element(shell.around.begin(), shell.around.end(), [&](auto a, auto b) {
        return found[a].volume_m3 < found[b].volume_m3;
      });
    const std::optional<std::size_t> parent = found[i].parent;
    const bool in_void = !parent || found[*parent].kind == ShellKind::kCavity;
    const bool outwards = shell.volume_m3 > 0.0;
    if (in_void && !outwards)
      return refuse(
          MeshErrorKind::kContradictory,
          fmt::format("{}: shell {} '{}' at {}, triangle {}: found it wound inwards {}, accepted "
                      "outwards there (inwards is a cavity in a solid)",
                      name, i, found[i].name, InMm(Center(mesh, shell.triangles.front())),
                      shell.triangles.front(), parent ? "inside a cavity" : "with nothing around it"));
    if (in_void) {
      found[i].kind = ShellKind::kSolid;
      bounds[i] = true;
      continue;
    }
    // region around the shell; empty: the solid itself
    const std::optional<std::size_t> around = region_of[*parent];
    if (outwards) {
      found[i].kind = ShellKind::kRegion;
      region_of[i] = loaded.regions.size();
      loaded.regions.push_back({.name = found[i].name, .mesh = {}, .parent = around});
      region_bounds.emplace_back(shells.size(), false).at(i) = true;
      continue;
    }
    found[i].kind = ShellKind::kCavity;
    bounds[i] = true;
    for (auto region = around; region; region = loaded.regions[*region].parent)
      region_bounds[*region][i] = true;
  }
  for (std::size_t r = 0; r < loaded.regions.size(); ++r)
    loaded.regions[r].mesh = Extract(mesh, shells, region_bounds[r]);
  loaded.mesh = loaded.regions.empty() ? std::move(parted.mesh) : Extract(mesh, shells, bounds);
  loaded.report = std::move(report);
  return loaded;
}

}  // namespace osteon::simulation
