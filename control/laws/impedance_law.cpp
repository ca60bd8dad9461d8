#include "control/laws/impedance_law.h"

#include "base/parameter_check.h"
#include "control/laws/twist_parts.h"

namespace osteon::control {

void Validate(const ImpedanceParams& params) {
  const base::ParameterCheck require("impedance ");
  for (int i = 0; i < 3; ++i) {
    require("damping_Ns_per_m", params.damping_Ns_per_m[i], 0.0, 1000.0);
    require("damping_Nms_per_rad", params.damping_Nms_per_rad[i], 0.0, 100.0);
  }
  require("brake_Ns_per_m", params.brake_Ns_per_m, 0.0, 2000.0);
  require("brake_Nms_per_rad", params.brake_Nms_per_rad, 0.0, 100.0);
  require("twist_filter_s", params.twist_filter_s, 0.0, 0.1);
  require("follow_s", params.follow_s, 1e-3, 10.0);
}

ImpedanceParams ScaleLaw(const ImpedanceParams& params, double damping_factor) OSTEON_RT {
  ImpedanceParams scaled = params;
  scaled.damping_Ns_per_m *= damping_factor;
  scaled.damping_Nms_per_rad *= damping_factor;
  return scaled;
}

void MeasuredTwist::Reset(const Pose& X_WT) OSTEON_RT {
  X_before_ = X_WT;
  V_ = {};
}

const Twist& MeasuredTwist::Step(const Pose& X_WT, double dt_s) OSTEON_RT {
  const double share = dt_s / (dt_s + filter_s_);
  const Twist V = TwistBetween(X_before_, X_WT, dt_s);
  V_.v += share * (V.v - V_.v);
  V_.w += share * (V.w - V_.w);
  X_before_ = X_WT;
  return V_;
}

Wrench DampingWrench(const ImpedanceParams& params, const Matrix3& R_WT, const Twist& V_WT,
                     const Twist& V_allowed_WT) OSTEON_RT {
  const Vector3 f_T = -params.damping_Ns_per_m.cwiseProduct(R_WT.transpose() * V_WT.v);
  const Vector3 t_T = -params.damping_Nms_per_rad.cwiseProduct(R_WT.transpose() * V_WT.w);
  return {.f = R_WT * f_T + params.brake_Ns_per_m * (V_allowed_WT.v - V_WT.v),
          .t = R_WT * t_T + params.brake_Nms_per_rad * (V_allowed_WT.w - V_WT.w)};
}

}  // namespace osteon::control
