#include "simulation/mesh/triangle_mesh.h"

#include <fmt/format.h>

#include "simulation/files/check_range.h"
#include "simulation/mesh/mesh_file.h"
#include "simulation/mesh/mesh_steps.h"

namespace osteon::simulation {

tl::expected<LoadedMesh, MeshError> LoadMesh(const std::filesystem::path& path, const MeshParams& params) {
  if (!(params.scale >= 1e-6 && params.scale <= 1e6))
    throw std::invalid_argument(fmt::format("mesh: scale: found {:g}, accepted 1e-6 … 1e6", params.scale));
  CheckRangeMm("mesh: weld tolerance", params.weld_tolerance_m, 0.0, 1e-4);
  const std::string name = path.string();
  const auto raw = ReadMeshFile(path);
  if (!raw) return tl::make_unexpected(raw.error());

  MeshReport report;
  PartedMesh parted = WeldParts(*raw, 1e-3 * params.scale, report);
  WeldOpenEdges(parted, 0.0, report);  // joins a surface spread over several groups
  auto accepted = AcceptMesh(parted, report, name);
  if (accepted || accepted.error().kind != MeshErrorKind::kOpen || params.weld_tolerance_m == 0.0)
    return accepted;

  report.welded_vertices = WeldOpenEdges(parted, params.weld_tolerance_m, report);
  if (report.welded_vertices > 0) {
    auto repaired = AcceptMesh(std::move(parted), report, name);
    if (repaired) return repaired;
  }
  MeshError error = accepted.error();
  error.message += fmt::format("; welding within {:g} mm does not close them", params.weld_tolerance_m * 1e3);
  return tl::make_unexpected(error);
}

}  // namespace osteon::simulation
