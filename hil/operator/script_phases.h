#pragma once

#include <string_view>
#include <utility>
#include <vector>

#include "hil/operator/hand_script.h"

// Helpers that build the operators' scripts (scripts.h).

namespace osteon::hil {

/// @throws std::invalid_argument "operator's script: NAME: found …, accepted RANGE" unless `accepted`.
void RequireInScript(bool accepted, std::string_view name, double found, std::string_view range);

/// Checks that a loop of this radius and period is not faster than `max_m_per_s`. @throws
/// std::invalid_argument as RequireInScript does.
void RequireLoopPeriod(double period_s, double radius_m, double max_m_per_s);

/// Checks the parameters that all scripts share. @throws std::invalid_argument as RequireInScript does.
template <typename Params>
void RequireCommon(const Params& p) {
  RequireInScript(p.seconds >= 0.1 && p.seconds <= 36000.0, "seconds", p.seconds, "0.1 … 36000");
  RequireInScript(p.push_force_N > 0.0 && p.push_force_N <= 1000.0, "push_force_N", p.push_force_N,
                  "0 … 1000, not 0");
  RequireInScript(p.approach_force_N > 0.0 && p.approach_force_N <= p.push_force_N, "approach_force_N",
                  p.approach_force_N, "0 … push_force_N, not 0");
  RequireInScript(p.hand_stiffness_N_per_m > 0.0, "hand_stiffness_N_per_m", p.hand_stiffness_N_per_m, "> 0");
  RequireInScript(p.max_target_m_per_s > 0.0, "max_target_m_per_s", p.max_target_m_per_s, "> 0");
}

/// Length of a script, and bounds on the speed of its targets.
struct ScriptBounds {
  double seconds{10.0};            ///< of the whole script
  double max_target_m_per_s{0.2};  ///< largest speed along the axis, and of the swing's radius
  double max_tilt_rad_per_s{0.5};
};

/// Builds a script's phases one after the other. Each phase approaches its wanted key only as far as the
/// bounds on the targets' speed allow. In a script that is too short, the motions are therefore shorter, not
/// faster.
class ScriptPhases {
 public:
  ScriptPhases(const ScriptBounds& bounds, const HandKey& start);

  /// Largest travel of a target in a phase that takes `share` of the script.
  [[nodiscard]] static double Reach(const ScriptBounds& bounds, double share);

  /// Adds a phase that takes `share` of the script, with full grip.
  void Add(std::string_view name, double share, const HandKey& wanted);

  /// State at the end of the last phase.
  [[nodiscard]] const HandKey& key() const { return key_; }
  [[nodiscard]] const HandKey& start() const { return start_; }
  /// Returns the phases. Must be the last call.
  [[nodiscard]] std::vector<HandPhase> ReleasePhases() { return std::move(phases_); }

 private:
  ScriptBounds bounds_;
  HandKey start_, key_;
  std::vector<HandPhase> phases_;
};

}  // namespace osteon::hil
