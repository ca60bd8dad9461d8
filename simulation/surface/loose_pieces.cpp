#include "simulation/surface/loose_pieces.h"

#include <algorithm>
#include <limits>
#include <numeric>
#include <vector>

namespace osteon::surface {
namespace {

/// Union-find over the vertices: vertices that quads connect are in the same set, which is a shell.
class Joined {
 public:
  explicit Joined(std::size_t vertices) : towards_(vertices) {
    std::iota(towards_.begin(), towards_.end(), std::uint32_t{0});
  }
  /// The vertex that stands for v's set.
  std::uint32_t Root(std::uint32_t v) {
    while (towards_[v] != v) v = towards_[v] = towards_[towards_[v]];
    return v;
  }
  void Join(std::uint32_t a, std::uint32_t b) { towards_[Root(a)] = Root(b); }

 private:
  std::vector<std::uint32_t> towards_;
};

/// A closed part of the mesh: the outside of a piece of bone, or a hollow within it (volume below 0).
struct Shell {
  double volume_mm3{0.0};
  Vec3 min_mm{}, max_mm{};
  bool dropped{false};
};

constexpr float kFar_mm = std::numeric_limits<float>::max();

/// True if the box of `inner` lies in the box of `outer`.
bool Within(const Shell& inner, const Shell& outer) {
  return inner.min_mm.x >= outer.min_mm.x && inner.min_mm.y >= outer.min_mm.y &&
         inner.min_mm.z >= outer.min_mm.z && inner.max_mm.x <= outer.max_mm.x &&
         inner.max_mm.y <= outer.max_mm.y && inner.max_mm.z <= outer.max_mm.z;
}

/// Finds the mesh's closed parts. @param[out] shell_of  for each quad, the index of its shell
std::vector<Shell> ShellsOf(const WeldedSurface& mesh, std::vector<std::uint32_t>& shell_of) {
  Joined joined(mesh.vertices_mm.size());
  for (const auto& quad : mesh.quads)
    for (std::size_t i = 1; i < 4; ++i) joined.Join(quad[0], quad[i]);
  constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();
  std::vector<std::uint32_t> number(mesh.vertices_mm.size(), kNone);
  std::vector<Shell> shells;
  shell_of.clear();
  for (const auto& quad : mesh.quads) {
    std::uint32_t& shell = number[joined.Root(quad[0])];
    if (shell == kNone) {
      shell = static_cast<std::uint32_t>(shells.size());
      shells.push_back({.min_mm = {kFar_mm, kFar_mm, kFar_mm}, .max_mm = {-kFar_mm, -kFar_mm, -kFar_mm}});
    }
    shell_of.push_back(shell);
    Shell& grown = shells[shell];
    for (const std::uint32_t v : quad) {
      const Vec3 p = mesh.vertices_mm[v];
      grown.min_mm = {std::min(grown.min_mm.x, p.x), std::min(grown.min_mm.y, p.y),
                      std::min(grown.min_mm.z, p.z)};
      grown.max_mm = {std::max(grown.max_mm.x, p.x), std::max(grown.max_mm.y, p.y),
                      std::max(grown.max_mm.z, p.z)};
    }
    grown.volume_mm3 += VolumeUnder(mesh, quad);
  }
  return shells;
}

/// Removes all quads that are not kept, and the vertices that no kept quad uses.
void KeepOnly(const std::vector<bool>& kept_quad, WeldedSurface& mesh) {
  std::vector<std::array<std::uint32_t, 4>> quads;
  for (std::size_t i = 0; i < mesh.quads.size(); ++i)
    if (kept_quad[i]) quads.push_back(mesh.quads[i]);
  mesh.quads = std::move(quads);
  RemoveUnusedVertices(mesh);
}

}  // namespace

PieceFigures DropPiecesBelow(double min_mm3, WeldedSurface& mesh) {
  std::vector<std::uint32_t> shell_of;  // the shell of each quad
  std::vector<Shell> shells = ShellsOf(mesh, shell_of);
  PieceFigures figures;
  const auto largest = std::max_element(shells.begin(), shells.end(), [](const Shell& a, const Shell& b) {
    return a.volume_mm3 < b.volume_mm3;
  });
  for (auto shell = shells.begin(); shell != shells.end(); ++shell) {
    if (shell->volume_mm3 <= 0.0) continue;
    ++figures.pieces;
    if (shell == largest || shell->volume_mm3 >= min_mm3) continue;
    shell->dropped = true;
    ++figures.dropped;
    figures.dropped_mm3 += shell->volume_mm3;
  }
  if (figures.dropped == 0) return figures;
  // drop a hollow if the piece around it is dropped
  for (Shell& hollow : shells) {
    if (hollow.volume_mm3 > 0.0) continue;
    const bool in_dropped = std::any_of(shells.begin(), shells.end(), [&](const Shell& piece) {
      return piece.dropped && piece.volume_mm3 > -hollow.volume_mm3 && Within(hollow, piece);
    });
    if (!in_dropped) continue;
    hollow.dropped = true;
    figures.dropped_mm3 += hollow.volume_mm3;
  }
  std::vector<bool> kept(mesh.quads.size());
  for (std::size_t i = 0; i < kept.size(); ++i) kept[i] = !shells[shell_of[i]].dropped;
  KeepOnly(kept, mesh);
  return figures;
}

}  // namespace osteon::surface
