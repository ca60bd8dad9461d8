#include "control/compliance/compliance.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "base/number_text.h"

namespace osteon::control {
namespace {

// Joins force and torque into one vector.
Vector6 Joined(const Wrench& F) OSTEON_RT {
  Vector6 joined;
  joined << F.f, F.t;
  return joined;
}

const ComplianceParams& Validated(const ComplianceParams& params) {
  Validate(params);
  return params;
}

}  // namespace

void Validate(const ComplianceParams& params) {
  if (params.layer) Validate(*params.layer);
  if (params.tool) Validate(*params.tool);
  if (params.mount) Validate(*params.mount);
  if (!(params.noticed_m > 0.0))
    throw std::invalid_argument("compliance noticed_m: found " + base::NumberText(params.noticed_m) +
                                ", accepted > 0");
}

double SeriesCompliance(const ComplianceParams& params, double force_N) OSTEON_RT {
  double series = 0.0;
  if (params.layer && force_N > 0.0) {
    double kappa = 0.0;  // stiffness of the softest material that has a layer
    for (const double each : params.layer->kappa_N_per_m3)
      if (each > 0.0) kappa = kappa > 0.0 ? std::min(kappa, each) : each;
    series += LayerIndentation(*params.layer, {.kappa_N_per_m3 = kappa, .share = 1.0}, force_N) / force_N;
  }
  if (params.tool) series += params.tool->compliance_T.diagonal().head<3>().maxCoeff();
  if (params.mount) series += 1.0 / params.mount->stiffness_N_per_m.minCoeff();
  return series;
}

Compliance::Compliance(const ComplianceParams& params, double period_s)
    : params_(Validated(params)), period_s_(period_s) {}

void Compliance::Reset() OSTEON_RT {
  e_.setZero();
  e_per_s_.setZero();
  q_m_.setZero();
  q_m_per_s_.setZero();
  mount_ = {};
  beyond_limit_ = false;
}

void Compliance::SetTool(const std::optional<ToolLinkParams>& tool) OSTEON_RT {
  params_.tool = tool;
  e_.setZero();
  e_per_s_.setZero();
}

Pose Compliance::X_WM() const OSTEON_RT {
  Pose X_WM = params_.mount ? MountPose(*params_.mount, mount_) : Pose::Identity();
  X_WM.translation() += X_WM.linear() * q_m_;
  return X_WM;
}

Pose Compliance::X_ME(const Pose& X_WT) const OSTEON_RT { return X_WM().inverse() * X_WT * BentHead(e_); }

Twist Compliance::V_ME(const Pose& X_WT, const Twist& V_WT) const OSTEON_RT {
  const Vector3 lever_W = X_WT.linear() * e_.head<3>();
  Twist V_W{.v = V_WT.v + V_WT.w.cross(lever_W) + X_WT.linear() * e_per_s_.head<3>(),
            .w = V_WT.w + X_WT.linear() * e_per_s_.tail<3>()};
  const Matrix3 R_MW = X_WM().linear().transpose();
  if (params_.mount) {
    const Twist V_M = MountTwistAt(*params_.mount, mount_, X_WT.translation() + lever_W);
    V_W.v -= V_M.v;
    V_W.w -= V_M.w;
  }
  return {.v = R_MW * V_W.v - q_m_per_s_, .w = R_MW * V_W.w};
}

Wrench Compliance::OnTool(const Wrench& F_E_M, const Pose& X_WT) const OSTEON_RT {
  const Matrix3 R_WM = X_WM().linear();
  const Vector3 f_W = R_WM * F_E_M.f;
  return {.f = f_W, .t = R_WM * F_E_M.t + (X_WT.linear() * e_.head<3>()).cross(f_W)};
}

void Compliance::Step(const Wrench& F_E_M, const simulation::ContactModel& model,
                      const Pose& X_WT) OSTEON_RT {
  const Matrix3 R_WM = X_WM().linear();
  const Wrench F_E_W{.f = R_WM * F_E_M.f, .t = R_WM * F_E_M.t};
  const Vector3 p_WE = X_WT * Vector3(e_.head<3>());
  // The comparisons below are negated, so that NaN is beyond the limit.
  beyond_limit_ = false;
  if (params_.layer) {
    const Vector3 before_m = q_m_;
    q_m_ = StepLayer(*params_.layer, LayerOf(*params_.layer, model), F_E_M.f, period_s_, before_m);
    q_m_per_s_ = (q_m_ - before_m) / period_s_;
  }
  if (params_.tool) {
    const Matrix3 R_TW = X_WT.linear().transpose();
    const Wrench F_E_T{.f = R_TW * F_E_W.f, .t = R_TW * F_E_W.t};
    const Vector6 before = e_;
    e_ = StepMassless<6>(before, params_.tool->compliance_T * Joined(F_E_T), period_s_, params_.tool->tau_s);
    e_per_s_ = (e_ - before) / period_s_;
    beyond_limit_ |=
        !(e_.head<2>().norm() <= params_.tool->max_bend_m) || !(-F_E_T.f.z() <= params_.tool->max_thrust_N);
  }
  if (params_.mount) {
    const BoneMountParams& mount = *params_.mount;
    const Vector3 p_WMo = mount.p_WMo_m + mount_.d.head<3>() + mount_.creep_m;
    StepMount(mount, {.f = F_E_W.f, .t = F_E_W.t + (p_WE - p_WMo).cross(F_E_W.f)}, period_s_, mount_);
    beyond_limit_ |= !((mount_.d.head<3>() + mount_.creep_m).norm() <= mount.max_shift_m) ||
                     !(mount_.d.tail<3>().norm() <= mount.max_turn_rad);
  }
}

bool Compliance::noticed() const OSTEON_RT {
  return std::max({e_.head<3>().norm(), q_m_.norm(), (mount_.d.head<3>() + mount_.creep_m).norm()}) >
         params_.noticed_m;
}

void Compliance::FillRecord(const Pose& X_WT, ComplianceRecord& record) const OSTEON_RT {
  record.present = true;
  record.X_ME = X_ME(X_WT);
  record.X_WM = X_WM();
  record.bend_m = Vector3(e_.head<3>());
  record.bend_rad = Vector3(e_.tail<3>());
  record.layer_m = q_m_;
  record.mount_m = Vector3(mount_.d.head<3>() + mount_.creep_m);
  record.mount_rad = Vector3(mount_.d.tail<3>());
  record.mount_m_per_s = Vector3(mount_.v.head<3>());
  record.mount_rad_per_s = Vector3(mount_.v.tail<3>());
}

}  // namespace osteon::control
