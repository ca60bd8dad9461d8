#include "config/reading/apply_identified.h"

#include <algorithm>
#include <cmath>
#include <string>

#include <fmt/format.h>

#include "config/reading/load_identified.h"
#include "config/reading/strict/config_error.h"

namespace osteon::config {
namespace {

constexpr double kMaxDampingRatio = 10.0;  // of the simulated arm

hil::ServoArmParams ArmFrom(const IdentifiedArm& arm, double period_s, const std::string& file) {
  const auto require = [&](const char* key, double found, double max, const char* unit) {
    if (!(found >= 0.0 && found <= max))
      throw ConfigError(file, 0,
                        fmt::format("arm, axis {} at {:g} mm/s: {}: found {:g}{}, accepted 0 … {:g}{}",
                                    arm.axis, 1e3 * arm.speed_m_per_s, key, found, unit, max, unit));
  };
  require("dead_time_ms", 1e3 * arm.dead_time_s, 1e3 * hil::ServoArm::kMaxDeadCycles * period_s, " ms");
  require("damping_ratio", arm.damping_ratio, kMaxDampingRatio, "");
  return {.bandwidth_hz = arm.bandwidth_hz,
          .damping_ratio = arm.damping_ratio,
          .dead_cycles = arm.dead_time_s / period_s};
}

}  // namespace

const IdentifiedArm* SlowestArm(const IdentifiedCell& identified) {
  if (identified.arm.empty()) return nullptr;
  return &*std::ranges::max_element(identified.arm, {}, &IdentifiedArm::lag_s);
}

void ApplyIdentified(const std::filesystem::path& file, CellConfig& cell) {
  cell.identified = ReadIdentifiedFor(file, cell);
  const IdentifiedArm* slowest = SlowestArm(*cell.identified);
  if (slowest == nullptr)
    throw ConfigError(file.string(), 0, "identified: arm: found no measurement, accepted one axis at least");
  const hil::ServoArmParams arm = ArmFrom(*slowest, cell.servo.period_s, file.string());
  cell.simulated.servo = arm;
  cell.simulated.dynamic.bandwidth_hz = arm.bandwidth_hz;
  cell.simulated.dynamic.damping_ratio = arm.damping_ratio;
  cell.simulated.dynamic.dead_cycles = static_cast<int>(std::lround(arm.dead_cycles));
  if (cell.simulated.kr) cell.simulated.kr->controller.servo = arm;
}

}  // namespace osteon::config
