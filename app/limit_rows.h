#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "control/servo_params.h"
#include "control/tick_record.h"
#include "safety/acting_limits.h"

namespace osteon::app {

/// A limit as it is in force: of several bounds of one quantity the tightest.
struct EffectiveLimit {
  std::string name;   ///< "force", "tool speed" …
  double value{0.0};  ///< infinite: none
  std::string unit;
  std::string from;  ///< whose bound it is, and which other ones there are
};

/// Every limit of a cell in force, trips and ages included. @param reduced the arm is in T1
[[nodiscard]] std::vector<EffectiveLimit> EffectiveLimits(const control::ServoParams& params,
                                                          bool reduced = false);

/// Those that there are, as "force 200 N (cell)", and where apex, flange and elbow may be.
[[nodiscard]] std::vector<std::string> LimitLines(const control::ServoParams& params);

/// What one limit did in a run.
struct ActedLimit {
  std::string name;  ///< safety::kLimitNames
  std::uint64_t ticks{0}, events{0};
  double first_s{0.0};    ///< since the first tick
  double longest_s{0.0};  ///< of one event
};

/// Which limits acted in a run, gathered tick by tick.
class ActedLimits {
 public:
  void Add(const control::TickRecord& tick);
  /// Those that acted, in the order of their numbers. @param period_s  of a tick
  [[nodiscard]] std::vector<ActedLimit> Rows(double period_s) const;

 private:
  safety::LimitCounts counts_;
  std::array<double, safety::kLimitCount> first_s_{};
  std::optional<rt::Nanoseconds> start_;  // the first tick's stamp
};

/// {effective: [{name, value, unit, from}], acted: [{name, ticks, events, first_s, longest_s}]}; a value that
/// is infinite is null.
[[nodiscard]] nlohmann::json ToJson(const std::vector<EffectiveLimit>& effective,
                                    const std::vector<ActedLimit>& acted);

/// On the terminal, before a run begins; above them, where it is so, that no PLC has to permit motion.
void PrintLimits(const control::ServoParams& params);

/// Who keeps a cell without a PLC from moving, for screen and summary.
inline constexpr const char* kWithoutPlc =
    "without a PLC (without_plc: accepted): only the arm's own safety controller and its enabling switch "
    "keep it from moving";

}  // namespace osteon::app
