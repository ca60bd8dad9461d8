#include "simulation/mesh/triangle_mesh.h"

#include <fmt/format.h>

#include "base/check_range.h"
#include "simulation/mesh/mesh_file.h"
#include "simulation/mesh/mesh_remake.h"
#include "simulation/mesh/mesh_steps.h"

namespace osteon::simulation {
namespace {

/// True if the refused mesh can be remade: its coordinates and size are accepted, and only the way its
/// triangles join was refused.
bool MayBeRemade(MeshErrorKind kind) {
  return kind == MeshErrorKind::kOpen || kind == MeshErrorKind::kNonManifold ||
         kind == MeshErrorKind::kOrientation || kind == MeshErrorKind::kContradictory ||
         kind == MeshErrorKind::kSelfIntersecting || kind == MeshErrorKind::kNoVolume;
}

}  // namespace

tl::expected<LoadedMesh, MeshError> LoadMesh(const std::filesystem::path& path, const MeshParams& params) {
  if (!(params.scale >= 1e-6 && params.scale <= 1e6))
    throw std::invalid_argument(fmt::format("mesh: scale: found {:g}, accepted 1e-6 … 1e6", params.scale));
  CheckRangeMm("mesh: weld tolerance", params.weld_tolerance_m, 0.0, 1e-4);
  const std::string name = path.string();
  const auto raw = ReadMeshFile(path);
  if (!raw) return tl::make_unexpected(raw.error());

  MeshReport report;
  PartedMesh parted = WeldParts(*raw, 1e-3 * params.scale, report);
  WeldOpenEdges(parted, 0.0, report);  // joins the groups of a surface that is spread over several groups
  auto accepted = AcceptMesh(parted, report, name);
  if (accepted) return accepted;
  if (accepted.error().kind == MeshErrorKind::kOpen && params.weld_tolerance_m > 0.0) {
    report.welded_vertices = WeldOpenEdges(parted, params.weld_tolerance_m, report);
    if (report.welded_vertices > 0) {
      auto repaired = AcceptMesh(parted, report, name);
      if (repaired) return repaired;
    }
    accepted.error().message +=
        fmt::format("; welding within {:g} mm does not close them", params.weld_tolerance_m * 1e3);
  }
  if (!params.remake || !MayBeRemade(accepted.error().kind)) return accepted;
  auto remade = RemakeMesh(parted, report, params.remake_grid_points);
  if (remade) return std::move(*remade);
  accepted.error().message += "; no solid can be made of it: " + remade.error();
  return accepted;
}

}  // namespace osteon::simulation
