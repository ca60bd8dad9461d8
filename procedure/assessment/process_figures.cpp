#include "procedure/assessment/process_figures.h"

#include <algorithm>
#include <cmath>

namespace osteon::procedure {

CorridorExcess ExcessOf(const SurgicalPlan& plan, const PlannedTool& tool, const Vector3& head_m,
                        const Vector3& feed) {
  const GuidanceGains& gains = plan.guidance;
  const Vector3& a = plan.axis_G;
  // the symbols of CorridorExcess's formulas
  const Vector3 off_m = head_m - plan.CentreOf(tool);
  const double h_m = off_m.dot(a), rho_m = (off_m - h_m * a).norm(), psi = gains.lateral.widening_rad;
  return {.tilt_rad = std::acos(std::clamp(-feed.dot(a), -1.0, 1.0)) - gains.cone.free_rad,
          .lateral_m = (rho_m - tool.around_m - gains.lateral.free_m - h_m * std::tan(psi)) * std::cos(psi),
          .depth_m = gains.depth.soft_m - h_m};
}

CorridorWidth WidthAt(const SurgicalPlan& plan, const PlannedTool& tool, const Vector3& head_m) {
  const GuidanceGains::Lateral& lateral = plan.guidance.lateral;
  const double h_m = (head_m - plan.CentreOf(tool)).dot(plan.axis_G), psi = lateral.widening_rad;
  const double free_m = tool.around_m + lateral.free_m + h_m * std::tan(psi);
  return {.free_m = std::max(0.0, free_m),
          .stop_m = std::max(0.0, free_m + (lateral.stop_m - lateral.free_m) / std::cos(psi))};
}

void ProcessSums::Add(const ProcessSample& sample, const PlannedTool& tool) {
  const bool near = (sample.head_m - plan_->centre_m).norm() <= kNearCup_m;
  if (!begun_) first_s_ = sample.t_s;
  if (begun_ && near && was_near_) path_m_ += (sample.head_m - head_m_).norm();
  begun_ = true;
  was_near_ = near;
  head_m_ = sample.head_m;
  last_s_ = sample.t_s;
  tremor_.Add(sample.F_hand_N, sample.spindle_rad_per_s);
  if (sample.guidance_E_J && guidance_E_J_)
    guidance_J_ += std::max(0.0, *guidance_E_J_ - *sample.guidance_E_J);
  guidance_E_J_ = sample.guidance_E_J;
  if (!sample.cutting) return;
  cutting_s_ += period_s_;
  const double force_N = sample.F_hand_N.norm();
  const double across_N = (sample.F_hand_N - sample.F_hand_N.dot(plan_->axis_G) * plan_->axis_G).norm();
  impulse_Ns_ += force_N * period_s_;
  across_Ns_ += across_N * period_s_;
  peak_N_ = std::max(peak_N_, force_N);
  const bool has_corridor = plan_->guidance.lateral.stop_m > 0.0;
  if (has_corridor && ExcessOf(*plan_, tool, sample.cut_head_m, sample.cut_feed).outside())
    outside_s_ += period_s_;
}

ProcessFigures ProcessSums::Figures() const {
  return {.time_s = begun_ ? last_s_ - first_s_ : 0.0,
          .cutting_s = cutting_s_,
          .path_m = path_m_,
          .force_mean_N = cutting_s_ > 0.0 ? impulse_Ns_ / cutting_s_ : 0.0,
          .force_peak_N = peak_N_,
          .wrong_way = impulse_Ns_ > 0.0 ? across_Ns_ / impulse_Ns_ : 0.0,
          .outside_s = outside_s_,
          .tremor_N = tremor_.value_N(),
          .guidance_J = guidance_J_};
}

}  // namespace osteon::procedure
