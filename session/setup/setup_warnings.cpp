#include "session/setup/setup_warnings.h"

#include <variant>

#include <fmt/format.h>

namespace osteon::session {

std::vector<std::string> SetupWarnings(const config::CellConfig& cell, bool real) {
  std::vector<std::string> warnings;
  const double limit_N = control::ForceLimit_N(cell.servo);
  const double push_N = std::visit([](const auto& script) { return script.push_force_N; }, cell.script);
  if (!real && push_N > limit_N)
    warnings.push_back(fmt::format(
        "the script pushes with {:g} N and the coupling's force limit is {:g} N (max_force_N, max_stored_J): "
        "beyond it {}",
        push_N, limit_N,
        cell.servo.on_force_limit.reaction == safety::OnForceLimit::kSlow ? "the tool is slowed down"
        : cell.servo.on_force_limit.reaction == safety::OnForceLimit::kStop
            ? "the cell stops"
            : "the tool sinks into bone against the law's drag alone"));
  return warnings;
}

}  // namespace osteon::session
