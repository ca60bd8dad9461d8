#include "control/sensing/bias_estimator.h"

#include <algorithm>
#include <cmath>

#include "base/parameter_check.h"
#include "safety/limits.h"

namespace osteon::control {
namespace {

Wrench Difference(const Wrench& a, const Wrench& b) { return {.f = a.f - b.f, .t = a.t - b.t}; }

// Subtracts from a reading the tool's weight and the known bias, which HandWrench also removes.
Wrench RemoveKnownLoad(const ForceSensorParams& sensor, const Wrench& F_S, const Pose& X_WF) OSTEON_RT {
  return Difference(Difference(F_S, ToolWeight(sensor, X_WF)), sensor.bias_S);
}

}  // namespace

void Validate(const BiasParams& params) {
  const base::ParameterCheck require("sensor bias ");
  require("rest_s", params.rest_s, 0.01, 60.0);
  require("spread_N", params.spread_N, 0.01, 100.0);
  require("spread_Nm", params.spread_Nm, 0.001, 10.0);
  require("max_bias_N", params.max_bias_N, 0.0, 100.0);
  require("max_bias_Nm", params.max_bias_Nm, 0.0, 20.0);
  require("max_creep_m_per_s", params.max_creep_m_per_s, 1e-4, 1.0);
  require("max_creep_rad_per_s", params.max_creep_rad_per_s, 1e-4, 10.0);
  require("rest_motion_m", params.rest_motion_m, 1e-7, 0.01);
  require("rest_rotation_rad", params.rest_rotation_rad, 1e-7, 0.1);
}

BiasParams CreepBound(const BiasParams& params, const AdmittanceParams& law) {
  BiasParams bound = params;
  bound.max_bias_N = std::min(params.max_bias_N,
                              law.dead_zone_N + law.damping_Ns_per_m.minCoeff() * params.max_creep_m_per_s);
  bound.max_bias_Nm = std::min(
      params.max_bias_Nm, law.dead_zone_Nm + law.damping_Nms_per_rad.minCoeff() * params.max_creep_rad_per_s);
  return bound;
}

BiasEstimator::BiasEstimator(const BiasParams& params, const ForceSensorParams& sensor, double period_s)
    : params_(params), sensor_(sensor), period_s_(period_s) {
  Validate(params);
  Validate(sensor);
}

// Begins a new rest with its first reading.
void BiasEstimator::StartRest(const Wrench& F_S, const Pose& X_WF) OSTEON_RT {
  resting_ = true;
  rested_s_ = 0.0;
  X_WF_ = X_WF;
  mean_ = RemoveKnownLoad(sensor_, F_S, X_WF);
}

void BiasEstimator::AddReading(const Wrench& F_S, const Pose& X_WF) OSTEON_RT {
  if (!params_.acts) return;
  if (!safety::IsFinite(F_S) || !X_WF.matrix().allFinite()) {
    resting_ = false;
    return;
  }
  const bool still =
      resting_ && (X_WF.translation() - X_WF_.translation()).norm() <= params_.rest_motion_m &&
      LogRotation(X_WF_.linear().transpose() * X_WF.linear()).norm() <= params_.rest_rotation_rad;
  if (!still) {
    StartRest(F_S, X_WF);
    return;
  }
  const Wrench deviation = Difference(RemoveKnownLoad(sensor_, F_S, X_WF), mean_);
  // The tolerance is wider at first, because the mean of a few readings is uncertain.
  const double tolerance_factor = rested_s_ < 0.1 * params_.rest_s ? 2.0 : 1.0;
  if (deviation.f.norm() > tolerance_factor * params_.spread_N ||
      deviation.t.norm() > tolerance_factor * params_.spread_Nm) {
    StartRest(F_S, X_WF);
    return;
  }
  rested_s_ += period_s_;
  // an arithmetic mean during the first rest_s, then an exponential mean
  const double share = period_s_ / std::min(rested_s_ + period_s_, std::max(params_.rest_s, period_s_));
  mean_ = {.f = mean_.f + share * deviation.f, .t = mean_.t + share * deviation.t};
  if (rested_s_ < params_.rest_s) return;
  in_doubt_ = mean_.f.norm() > params_.max_bias_N || mean_.t.norm() > params_.max_bias_Nm;
  if (!in_doubt_) bias_ = mean_;
}

}  // namespace osteon::control
