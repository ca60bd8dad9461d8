#include "studies/identify/identify_joints.h"

#include <algorithm>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace osteon::studies {

std::string SpeedText(const AxisResult& axis) {
  return axis.request.joint > 0 ? fmt::format("{:.1f} deg/s", Degrees(axis.rms_speed_m_per_s))
                                : fmt::format("{:.1f} mm/s", 1e3 * axis.rms_speed_m_per_s);
}

void JudgeJoints(IdentifyResult& result) {
  std::vector<const AxisResult*> well_modelled;
  for (AxisResult& joint : result.joints) {
    JudgeAxis(joint, result);
    if (joint.model_holds) well_modelled.push_back(&joint);
  }
  if (well_modelled.size() < 2) return;
  const auto lag = [](const AxisResult* joint) { return joint->fit.lag_s.value; };
  const auto [fast, slow] = std::ranges::minmax(well_modelled, {}, lag);
  if (fast->request.joint == slow->request.joint || lag(slow) - lag(fast) <= kMaxLagApart * lag(slow)) return;
  result.warnings.push_back(
      {"joints", fmt::format("their lags differ: found {:.2f} ms of A{} and {:.2f} ms of A{}, accepted 5 % "
                             "apart; the lag along an axis holds near this posture alone",
                             1e3 * lag(fast), fast->request.joint, 1e3 * lag(slow), slow->request.joint)});
}

nlohmann::ordered_json JointsJson(const IdentifyResult& result) {
  auto list = nlohmann::ordered_json::array();
  for (const AxisResult& joint : result.joints) {
    nlohmann::ordered_json json{{"joint", fmt::format("A{}", joint.request.joint)},
                                {"speed_deg_per_s", Degrees(joint.rms_speed_m_per_s)},
                                {"peak_speed_deg_per_s", Degrees(joint.request.peak_speed_m_per_s)}};
    json.update(FitJson(joint));
    json["validation_chi2"] =
        joint.validation_chi2 ? nlohmann::ordered_json(*joint.validation_chi2) : nlohmann::ordered_json();
    json["loss_ratio"] = LossOf(joint.samples);
    json["frf"] = LinesJson(joint.by_encoders, "encoders");
    list.push_back(std::move(json));
  }
  return list;
}

report::SummaryRow JointRow(const AxisResult& joint) {
  return {fmt::format("Joint A{} at {} rms", joint.request.joint, SpeedText(joint)), FitText(joint)};
}

}  // namespace osteon::studies
