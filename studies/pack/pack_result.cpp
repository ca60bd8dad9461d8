#include "studies/pack/pack_result.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include "base/json_text.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

namespace osteon::studies {
namespace {

using simulation::FigureSource;
using simulation::MassProperties;
using simulation::Material;
using simulation::PackingQuality;

/// The key of a quality figure in JSON and in a packing file's provenance.
struct QualityKey {
  const char* key;
  double PackingQuality::*value;
  double unit;  ///< SI units per unit of the key
};
constexpr std::array<QualityKey, 7> kQualityKeys{{
    {"coverage", &PackingQuality::coverage, 1.0},
    {"coverage_standard_error", &PackingQuality::coverage_standard_error, 1.0},
    {"surface_gap_mean_mm", &PackingQuality::surface_gap_mean_m, 1e-3},
    {"surface_gap_p95_mm", &PackingQuality::surface_gap_p95_m, 1e-3},
    {"surface_gap_max_mm", &PackingQuality::surface_gap_max_m, 1e-3},
    {"protrusion_max_mm", &PackingQuality::protrusion_max_m, 1e-3},
    {"overlap_max_mm", &PackingQuality::overlap_max_m, 1e-3},
}};

nlohmann::json InMm(const Vector3& p) { return {p.x() * 1e3, p.y() * 1e3, p.z() * 1e3}; }

// Inertia in g mm²; 1 kg m² = 1e9 g mm².
nlohmann::json ToJsonObject(const MassProperties& mass) {
  nlohmann::json inertia = nlohmann::json::array();
  for (int i = 0; i < 3; ++i)
    inertia.push_back(
        {mass.inertia_kg_m2(i, 0) * 1e9, mass.inertia_kg_m2(i, 1) * 1e9, mass.inertia_kg_m2(i, 2) * 1e9});
  return {{"volume_mm3", mass.volume_m3 * 1e9},
          {"mass_g", mass.mass_kg * 1e3},
          {"center_of_mass_mm", InMm(mass.center_of_mass_m)},
          {"inertia_g_mm2", inertia}};
}

// Each figure with its source, and whether it is assumed.
nlohmann::json ToJsonObject(const Material& material) {
  const auto figure = [](double value, const FigureSource& source) {
    return nlohmann::json{{"value", value}, {"source", source.text}, {"assumed", source.assumed}};
  };
  nlohmann::json json = {
      {"name", material.name},
      {"density_g_per_cm3", figure(material.density_kg_per_m3 * 1e-3, material.density_source)},
      {"cutting_energy_J_per_mm3",
       figure(material.specific_cutting_energy_J_per_m3 * 1e-9, material.cutting_energy_source)},
      {"cutting_force_ratio", figure(material.cutting_force_ratio, material.cutting_force_source)},
      {"friction", figure(material.friction, material.friction_source)}};
  if (material.edge_force_N_per_m > 0.0) {
    json["edge_force_N_per_mm"] = figure(1e-3 * material.edge_force_N_per_m, material.edge_force_source);
    json["measured_chip_um"] = 1e6 * material.measured_chip_m;
  }
  return json;
}

// A share as a signed percentage.
std::string Percent(double share) { return fmt::format("{:+.3f} %", share * 100); }

}  // namespace

bool KeepsTolerances(const PackResult& result) {
  return result.quality.protrusion_max_m <= kMaxProtrusion_m &&
         (result.mode != "disjoint" || result.quality.overlap_max_m <= kMaxDisjointOverlap_m);
}

std::optional<MassComparison> CompareMass(const PackResult& result) {
  if (!result.even_points || !result.even_solid) return std::nullopt;
  const MassProperties &a = *result.even_points, &b = *result.even_solid;
  return MassComparison{.volume_error = a.volume_m3 / b.volume_m3 - 1.0,
                        .center_error_m = (a.center_of_mass_m - b.center_of_mass_m).norm(),
                        .inertia_error = (a.inertia_kg_m2 - b.inertia_kg_m2).cwiseAbs().maxCoeff() /
                                         b.inertia_kg_m2.cwiseAbs().maxCoeff()};
}

std::vector<report::SummaryRow> Rows(const PackResult& result) {
  const PackingQuality& q = result.quality;
  std::vector<report::SummaryRow> rows;
  const auto row = [&rows](const std::string& key, const std::string& value) {
    rows.push_back({key, value});
  };
  row("Spheres", fmt::format("{}, {}", q.spheres, result.mode));
  row("Radii", fmt::format("{:.3f} … {:.3f} mm", q.r_min_m * 1e3, q.r_max_m * 1e3));
  row("Coverage", fmt::format("{:.4f} ± {:.4f} of the volume", q.coverage, q.coverage_standard_error));
  row("Surface gap, mean", fmt::format("{:.4f} mm", q.surface_gap_mean_m * 1e3));
  row("Surface gap, 95 % below", fmt::format("{:.4f} mm", q.surface_gap_p95_m * 1e3));
  row("Surface gap, greatest", fmt::format("{:.4f} mm", q.surface_gap_max_m * 1e3));
  row("Protrusion, greatest", fmt::format("{:.5f} mm", std::max(0.0, q.protrusion_max_m * 1e3)));
  row("Overlap, greatest", fmt::format("{:.5f} mm", q.overlap_max_m * 1e3));
  if (!result.zone.empty()) row("Cut", result.zone);
  if (!result.bone.points.empty()) {
    row("Mass points", fmt::format("{}", result.bone.points.size()));
    row("Volume, mass",
        fmt::format("{:.1f} mm³, {:.3f} g", result.mass.volume_m3 * 1e9, result.mass.mass_kg * 1e3));
  }
  if (const auto compared = CompareMass(result)) {
    row("Volume against the solid's", Percent(compared->volume_error));
    row("Centre against the solid's", fmt::format("{:.4f} mm", compared->center_error_m * 1e3));
    row("Inertia against the solid's", fmt::format("{:.3f} %", compared->inertia_error * 100));
  }
  const auto assumed = simulation::Assumptions(result.bone.materials).size();
  row("Materials", fmt::format("{}; {} of {} figures assumed", result.bone.materials.size(), assumed,
                               4 * result.bone.materials.size()));
  if (!result.converted) row("Time of the packing", fmt::format("{:.2f} s", result.seconds));
  for (const auto& output : result.outputs) row("Written", output.string());
  return rows;
}

std::string ToJson(const PackResult& result) {
  const PackingQuality& q = result.quality;
  nlohmann::json json{{"schema", "osteon.pack/1"},
                      {"name", result.bone.name},
                      {"mode", result.mode},
                      {"converted", result.converted},
                      {"spheres", q.spheres},
                      {"r_min_mm", q.r_min_m * 1e3},
                      {"r_max_mm", q.r_max_m * 1e3},
                      {"seconds", result.seconds},
                      {"zone", result.zone},
                      {"seed", result.seed},
                      {"threads", result.threads},
                      {"tolerances_kept", KeepsTolerances(result)},
                      {"points", result.bone.points.size()},
                      {"assumptions", simulation::Assumptions(result.bone.materials)},
                      {"source", result.provenance.source},
                      {"program", result.provenance.program}};
  for (const QualityKey& key : kQualityKeys) json[key.key] = q.*key.value / key.unit;
  nlohmann::json& bins = json["radius_histogram"] = nlohmann::json::array();
  for (const simulation::RadiusBin& bin : q.radius_histogram)
    bins.push_back({{"from_mm", bin.from_m * 1e3}, {"to_mm", bin.to_m * 1e3}, {"spheres", bin.spheres}});
  json["materials"] = nlohmann::json::array();
  for (const Material& material : result.bone.materials) json["materials"].push_back(ToJsonObject(material));
  if (!result.bone.points.empty()) json["mass"] = ToJsonObject(result.mass);
  if (result.triangles > 0) json["triangles"] = result.triangles;
  if (const auto compared = CompareMass(result))
    json["against_solid"] = {{"solid", ToJsonObject(*result.even_solid)},
                             {"points", ToJsonObject(*result.even_points)},
                             {"density_g_per_cm3", 1.0},
                             {"volume_error", compared->volume_error},
                             {"center_error_mm", compared->center_error_m * 1e3},
                             {"inertia_error", compared->inertia_error}};
  if (result.bone.site.radius_m > 0.0)
    json["site"] = {{"center_mm", InMm(result.bone.site.center_m)},
                    {"axis", {result.bone.site.axis.x, result.bone.site.axis.y, result.bone.site.axis.z}},
                    {"radius_mm", result.bone.site.radius_m * 1e3}};
  json["seconds_by_phase"] = nlohmann::json::object();
  for (const auto& phase : result.phases) json["seconds_by_phase"][phase.name] = phase.seconds;
  json["parameters"] = nlohmann::json::object();
  for (const auto& [key, value] : result.provenance.parameters) json["parameters"][key] = value;
  json["output"] = nlohmann::json::array();
  for (const auto& output : result.outputs) json["output"].push_back(output.string());
  return base::JsonText(json);
}

std::vector<std::pair<std::string, std::string>> QualityParameters(const PackingQuality& quality) {
  std::vector<std::pair<std::string, std::string>> parameters;
  for (const QualityKey& key : kQualityKeys)
    parameters.emplace_back(key.key, fmt::format("{}", quality.*key.value / key.unit));
  return parameters;
}

void ReadQualityParameters(const simulation::PackingProvenance& provenance, PackingQuality& quality) {
  for (const auto& [name, text] : provenance.parameters)
    for (const QualityKey& key : kQualityKeys) {
      double value = 0.0;
      if (name == key.key &&
          std::from_chars(text.data(), text.data() + text.size(), value).ec == std::errc{} &&
          std::isfinite(value))
        quality.*key.value = value * key.unit;
    }
}

}  // namespace osteon::studies
