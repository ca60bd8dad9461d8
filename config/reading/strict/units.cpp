#include "config/reading/strict/units.h"

#include <numbers>

#include "base/units.h"

namespace osteon::config {
namespace {

struct Unit {
  std::string_view ending;
  double to_si;
};

// The known units, by the ending of a key.
constexpr Unit kUnits[] = {
    // length, volume, angle, time
    {"m", 1.0},
    {"mm", 1e-3},
    {"um", 1e-6},
    {"mm3", 1e-9},
    {"rad", 1.0},
    {"deg", kDegree},
    {"s", 1.0},
    {"ms", 1e-3},
    {"us", 1e-6},
    {"hz", 1.0},
    {"rpm", kRpm},
    // motion
    {"m_per_s", 1.0},
    {"mm_per_s", 1e-3},
    {"rad_per_s", 1.0},
    {"deg_per_s", kDegree},
    {"m_per_s2", 1.0},
    {"mm_per_s2", 1e-3},
    {"rad_per_s2", 1.0},
    {"deg_per_s2", kDegree},
    // mass, force, torque, energy
    {"kg", 1.0},
    {"g", 1e-3},
    {"kg_m2", 1.0},
    {"kg_per_m3", 1.0},
    {"g_per_cm3", 1e3},
    {"N", 1.0},
    {"Nm", 1.0},
    {"J", 1.0},
    {"W", 1.0},
    {"N_per_s", 1.0},
    {"Nm_per_s", 1.0},
    {"J_per_m3", 1.0},
    {"J_per_mm3", 1e9},
    {"N_per_mm3", 1e9},
    {"GPa", 1e9},
    // stiffness and damping
    {"N_per_m", 1.0},
    {"N_per_mm", 1e3},
    {"Nm_per_rad", 1.0},
    {"Ns_per_m", 1.0},
    {"Nms_per_rad", 1.0},
    // pure numbers
    {"ratio", 1.0},
    {"percent", 1e-2},
    {"count", 1.0},
    {"points", 1.0},
    {"axis", 1.0},
    {"lateral", 1.0},  // directions of the body
    {"anterior", 1.0},
    {"superior", 1.0},
    {"port", 1.0},
    {"seed", 1.0},
};

// The longest known unit that is the whole key, or that ends it after an underscore; null: none.
const Unit* FindUnit(std::string_view key) {
  const Unit* best = nullptr;
  for (const Unit& unit : kUnits) {
    if (!key.ends_with(unit.ending)) continue;
    const std::size_t before = key.size() - unit.ending.size();
    if (before > 0 && key[before - 1] != '_') continue;
    if (best == nullptr || unit.ending.size() > best->ending.size()) best = &unit;
  }
  return best;
}

}  // namespace

std::optional<double> UnitOf(std::string_view key) {
  const Unit* unit = FindUnit(key);
  return unit ? std::optional(unit->to_si) : std::nullopt;
}

std::string_view UnitEnding(std::string_view key) {
  const Unit* unit = FindUnit(key);
  return unit ? unit->ending : std::string_view();
}

}  // namespace osteon::config
