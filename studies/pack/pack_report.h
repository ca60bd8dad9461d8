#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <tl/expected.hpp>

#include "report/report.h"
#include "simulation/packing/mass_points.h"
#include "simulation/packing/packing_file.h"
#include "simulation/packing/packing_quality.h"
#include "simulation/solids/cut_zone.h"
#include "simulation/solids/mass_properties.h"

namespace osteon::studies {

/// The contents of a packing's report. Its views must stay valid during the call.
struct PackReportInput {
  std::string verdict{};  ///< in a few words
  bool good{true};        ///< whether the verdict is good
  std::vector<report::SummaryRow> summary{};
  const simulation::Bone& bone;
  const simulation::PackingQuality& quality;
  const simulation::Solid& solid;
  const simulation::CutZone& zone;
  simulation::MassPointParams point_params{};
  simulation::MassProperties mass{};  ///< of the mass points
  /// Mass properties of the mass points, if every material had 1000 kg/m³.
  std::optional<simulation::MassProperties> even_points{};
  std::optional<simulation::MassProperties> even_solid{};  ///< of the solid with 1000 kg/m³, in closed form
  simulation::PackingProvenance provenance{};
  std::vector<report::SummaryRow> times{};
  std::string command_line{};
  std::string version{};
  int threads{0};
};

/// Makes the report as one HTML page: figures, pictures of the whole packing and of a half, a section, radii,
/// gaps, the mass points' spectrum, mass and inertia compared with the solid's, materials with their sources
/// and assumptions.
[[nodiscard]] tl::expected<std::string, std::string> MakePackReport(const PackReportInput& input);

/// Writes MakePackReport's page to a file, complete or not at all; creates its folder. The error names the
/// file.
[[nodiscard]] tl::expected<void, std::string> WritePackReport(const PackReportInput& input,
                                                              const std::filesystem::path& path);

}  // namespace osteon::studies
