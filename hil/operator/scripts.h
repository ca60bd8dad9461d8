#pragma once

#include <variant>

#include "hil/operator/drilling_script.h"
#include "hil/operator/hand_script.h"
#include "hil/operator/opening_script.h"
#include "hil/operator/procedure_script.h"

namespace osteon::hil {

/// The scripts of an operator. All of them have the fields X_WC, head_radius_m, tool_yaw_rad, seconds,
/// start_height_m, retract_height_m, push_force_N, approach_force_N, hand_stiffness_N_per_m and
/// max_target_m_per_s in common.
using ScriptParams =
    std::variant<ReamingScriptParams, DrillingScriptParams, OpeningScriptParams, ProcedureScriptParams>;

/// @throws std::invalid_argument, naming the parameter and what is accepted.
[[nodiscard]] inline HandScript MakeScript(const ScriptParams& params) {
  struct Make {
    HandScript operator()(const ReamingScriptParams& p) const { return MakeReamingScript(p); }
    HandScript operator()(const DrillingScriptParams& p) const { return MakeDrillingScript(p); }
    HandScript operator()(const ProcedureScriptParams& p) const { return MakeProcedureScript(p); }
    HandScript operator()(const OpeningScriptParams& p) const { return MakeOpeningScript(p); }
  };
  return std::visit(Make{}, params);
}

}  // namespace osteon::hil
