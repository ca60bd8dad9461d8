#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/phase_progress.h"
#include "report/report.h"
#include "simulation/packing/mass_points.h"
#include "simulation/packing/packing_file.h"
#include "simulation/packing/packing_quality.h"
#include "simulation/solids/mass_properties.h"

namespace osteon::studies {

/// The result of `osteon pack` with its quality, as terminal, JSON and report show it.
struct PackResult {
  simulation::Bone bone{};
  std::string mode{};  ///< "overlap" or "disjoint"; for a packing file: as stored there
  /// True: the packing was read from a file, so nothing was packed and some figures are unknown.
  bool converted{false};
  simulation::PackingQuality quality{};
  simulation::PackingProvenance provenance{};
  std::size_t triangles{0};  ///< number of the mesh's triangles; 0: the source is a shape
  std::uint64_t seed{0};
  int threads{0};
  std::string zone{};  ///< description of the cut zone
  simulation::MassPointParams point_params{};
  simulation::MassProperties mass{};  ///< mass properties of the mass points, with their materials
  /// Mass properties of the same points if every material had 1000 kg/m³.
  std::optional<simulation::MassProperties> even_points{};
  /// Mass properties of the solid with 1000 kg/m³, in closed form.
  std::optional<simulation::MassProperties> even_solid{};
  double seconds{0.0};  ///< time of the packing itself
  std::vector<base::PhaseProgress::Phase> phases{};
  std::vector<std::filesystem::path> outputs{};
};

/// Tolerances of a packing: the largest distance by which a ball may reach out of the solid, or, in a
/// disjoint packing, into another ball.
inline constexpr double kMaxProtrusion_m = 0.05e-3, kMaxDisjointOverlap_m = 1e-6;
[[nodiscard]] bool KeepsTolerances(const PackResult& result);

/// Mass, centre and inertia of a homogeneous body: the points' values compared with the closed form's.
struct MassComparison {
  double volume_error{0.0};  ///< relative, signed
  double center_error_m{0.0};
  double inertia_error{0.0};  ///< greatest difference of an element, divided by the greatest element
};
/// @returns nothing if the points or the closed form are not known
[[nodiscard]] std::optional<MassComparison> CompareMass(const PackResult& result);

/// Rows for the terminal and the report.
[[nodiscard]] std::vector<report::SummaryRow> Rows(const PackResult& result);

/// One JSON object, schema osteon.pack/1.
[[nodiscard]] std::string ToJson(const PackResult& result);

/// Converts the known quality figures of a packing to parameters of its provenance, and back.
[[nodiscard]] std::vector<std::pair<std::string, std::string>> QualityParameters(
    const simulation::PackingQuality& quality);
void ReadQualityParameters(const simulation::PackingProvenance& provenance,
                           simulation::PackingQuality& quality);

}  // namespace osteon::studies
