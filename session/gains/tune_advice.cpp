#include "session/gains/tune_advice.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "base/json_value.h"
#include "base/read_text.h"

namespace osteon::session {
namespace {

using base::NumberAt;
using base::TextAt;
using base::ValueAt;

// Relative difference up to which two figures count as equal. The file has all digits, so only rounding is
// tolerated.
constexpr double kSameWithin = 1e-6;

bool IsSame(double a, double b) {
  return std::abs(a - b) <= kSameWithin * std::max(std::abs(a), std::abs(b));
}

// A figure that must be the same in tune's result and in the cell.
struct SharedFigure {
  const char *name, *unit;
  double in_result, in_cell;
};

// Lists the figures that must be the same, with their values in tune.json and in the cell.
std::vector<SharedFigure> SharedFigures(const nlohmann::json& json, const config::CellConfig& cell) {
  const nlohmann::json &own = ValueAt(json, "own"), &stands = ValueAt(json, "stands");
  std::vector<SharedFigure> figures{
      {"period", "ms", NumberAt(ValueAt(json, "arm"), "period_ms"), 1e3 * cell.servo.period_s},
      {"coupling's stiffness", "N/m", NumberAt(stands, "wall_N_per_m"),
       cell.servo.coupling.max_stiffness_N_per_m}};
  const double damping_Ns_per_m = NumberAt(own, "damping_Ns_per_m");
  if (cell.servo.law == control::Law::kImpedance) {
    figures.push_back({"damping", "N s/m", damping_Ns_per_m, cell.servo.impedance.damping_Ns_per_m.z()});
    return figures;
  }
  figures.push_back({"mass", "kg", NumberAt(own, "mass_kg"), cell.servo.admittance.mass_kg.z()});
  figures.push_back({"drag", "N s/m", damping_Ns_per_m, cell.servo.admittance.damping_Ns_per_m.z()});
  return figures;
}

// Returns the number at a key; nothing if the value is not a number, e.g. null.
std::optional<double> OptionalAt(const nlohmann::json& json, const char* key) {
  const nlohmann::json& value = ValueAt(json, key);
  return value.is_number() ? std::optional(value.get<double>()) : std::nullopt;
}

}  // namespace

std::optional<double> TuneAdvice::WallAt(double drag_Ns_per_m) const {
  const auto above =
      std::ranges::find_if(boundary, [&](const auto& b) { return b.first >= drag_Ns_per_m * (1.0 - 1e-9); });
  if (above == boundary.end()) return std::nullopt;
  if (IsSame(above->first, drag_Ns_per_m)) return above->second;
  if (above == boundary.begin()) return std::nullopt;
  return std::min(above->second, (above - 1)->second);
}

tl::expected<TuneAdvice, std::string> ReadTuneAdvice(const std::filesystem::path& file,
                                                     const config::CellConfig& cell,
                                                     const std::string& name) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(file, error))
    return tl::make_unexpected(
        fmt::format("{}: found no file, accepted a result of `osteon tune {}`", file.string(), name));
  const auto json = nlohmann::json::parse(base::ReadText(file), nullptr, false);
  if (!json.is_object() || TextAt(json, "schema") != "osteon.tune/1")
    return tl::make_unexpected(
        fmt::format("{}: found another file, accepted a tune.json of `osteon tune {}`", file.string(), name));
  if (TextAt(json, "cell") != name)
    return tl::make_unexpected(
        fmt::format("{}: found a result of the cell {}, accepted one of `osteon tune {}`", file.string(),
                    TextAt(json, "cell"), name));
  const char* law = cell.servo.law == control::Law::kImpedance ? "impedance" : "admittance";
  if (TextAt(json, "law") != law)
    return tl::make_unexpected(
        fmt::format("{}: found the {} law, accepted the cell's, {}: run `osteon tune {}` again",
                    file.string(), TextAt(json, "law"), law, name));
  for (const SharedFigure& shared : SharedFigures(json, cell))
    if (!IsSame(shared.in_result, shared.in_cell))
      return tl::make_unexpected(
          fmt::format("{}: found a {} of {:g} {}, accepted the cell's, {:g}: run `osteon tune {}` again",
                      file.string(), shared.name, shared.in_result, shared.unit, shared.in_cell, name));
  const nlohmann::json& own = ValueAt(json, "own");
  TuneAdvice advice{.file = file.string(),
                    .asked_margin = NumberAt(json, "margin"),
                    .own_margin = NumberAt(own, "margin"),
                    .worst_age_s = 1e-3 * NumberAt(ValueAt(json, "stands"), "worst_age_ms")};
  const nlohmann::json& recommended = ValueAt(json, "recommended");
  if (!recommended.is_object()) return advice;
  advice.recommended =
      TuneAdvice::Recommended{.mass_kg = OptionalAt(recommended, "mass_kg"),
                              .stiffness_N_per_m = OptionalAt(recommended, "stiffness_N_per_m"),
                              .drag_Ns_per_m = NumberAt(recommended, "damping_Ns_per_m"),
                              .margin = NumberAt(recommended, "margin")};
  // the map of stable walls was computed for the recommended mass, so it is valid only if the cell has this
  // mass
  const nlohmann::json& boundary = ValueAt(json, "boundary");
  if (!advice.recommended->mass_kg || !boundary.is_array() ||
      !IsSame(*advice.recommended->mass_kg, NumberAt(own, "mass_kg")))
    return advice;
  for (const nlohmann::json& at : boundary)
    advice.boundary.emplace_back(NumberAt(at, "damping"), NumberAt(at, "stiffness_predicted"));
  std::ranges::sort(advice.boundary);
  return advice;
}

}  // namespace osteon::session
