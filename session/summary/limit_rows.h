#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "control/setup/servo_params.h"
#include "control/tick_record.h"
#include "safety/acting_limits.h"

namespace osteon::session {

/// A limit in force: the tightest of several bounds on one quantity.
struct EffectiveLimit {
  std::string name;   ///< "force", "tool speed" …
  double value{0.0};  ///< infinite: there is no limit
  std::string unit;
  std::string from;  ///< the bound that gives the value, and the others
};

/// Collects every limit in force, including limits on ages and the limits whose violation stops the cell.
/// @param reduced  the arm is in T1, with reduced speed
[[nodiscard]] std::vector<EffectiveLimit> EffectiveLimits(const control::ServoParams& params,
                                                          bool reduced = false);

/// Lists the finite limits, as "force 200 N (cell)", and where apex, flange and elbow may be.
[[nodiscard]] std::vector<std::string> LimitLines(const control::ServoParams& params);

/// How often and for how long one limit acted in a run.
struct ActedLimit {
  std::string name;         ///< name of the limit in safety::kLimitNames
  std::string text;         ///< the limit in words
  std::uint64_t ticks{0};   ///< ticks in which the limit acted
  std::uint64_t events{0};  ///< number of events: uninterrupted series of such ticks
  double first_s{0.0};      ///< time of the first action, since the first tick
  double longest_s{0.0};    ///< duration of the longest event
  double total_s{0.0};      ///< duration of all events together
};

/// Collects, tick by tick, which limits acted in a run.
class ActedLimits {
 public:
  void Add(const control::TickRecord& tick);
  /// Returns the limits that acted, in the order of safety::kLimitNames. @param period_s  time of a tick
  [[nodiscard]] std::vector<ActedLimit> Rows(double period_s) const;

 private:
  safety::LimitCounts counts_;
  std::array<double, safety::kLimitCount> first_s_{};
  std::optional<rt::Nanoseconds> start_;  // the first tick's stamp
};

/// {effective: [{name, value, unit, from}], acted: [{name, ticks, events, first_s, longest_s}]}; an infinite
/// value is null.
[[nodiscard]] nlohmann::json ToJson(const std::vector<EffectiveLimit>& effective,
                                    const std::vector<ActedLimit>& acted);

/// Prints the limits before a run begins; above them, for a cell without a PLC, a line that says so.
void PrintLimits(const control::ServoParams& params);

/// Text for screen and summary of a cell without a PLC: it says that no PLC permits the motion.
inline constexpr const char* kWithoutPlc =
    "without a PLC (without_plc: accepted): only the arm's own safety controller and its enabling switch "
    "keep it from moving";

}  // namespace osteon::session
