#pragma once

#include <numbers>
#include <string>

#include <nlohmann/json_fwd.hpp>

#include "studies/identify/identify_result.h"

namespace osteon::studies {

/// Converts an angle or an angular speed to degrees, as users read them.
[[nodiscard]] inline double Degrees(double rad) { return rad * 180.0 / std::numbers::pi; }

/// RMS speed of an axis or of a joint: "20.5 mm/s", "3.5 deg/s".
[[nodiscard]] std::string SpeedText(const AxisResult& axis);

/// Judges each joint in the same way as an axis, and compares the joints. If their lags differ by more than 5
/// %, the lag along an axis holds only for the measured posture. Adds to `refused` and `warnings`, and sets
/// model_holds.
void JudgeJoints(IdentifyResult& result);

/// `joints[]` of osteon.identify/1: angles in degrees, times in ms.
[[nodiscard]] nlohmann::ordered_json JointsJson(const IdentifyResult& result);

/// The row of a joint for page and terminal.
[[nodiscard]] report::SummaryRow JointRow(const AxisResult& joint);

}  // namespace osteon::studies
