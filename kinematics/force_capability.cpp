#include "kinematics/force_capability.h"

#include <algorithm>
#include <cmath>

namespace osteon::kinematics {
namespace {

// Finds the joint that limits a load, by the smallest of all quotients room / load of the half-spaces that
// were added, and of a cap.
class TightestLimit {
 public:
  explicit TightestLimit(double cap) : limit_{.value = cap, .joint = -1} {}

  // @param room  torque that the drive still has available [N·m]
  // @param load  torque that the drive needs per unit of the result
  void Add(double room, double load, int joint) {
    if (load <= 0.0) return;
    // an infinite load, or a NaN from inf - inf, gives 0
    const double value = load < HUGE_VAL ? room / load : 0.0;
    if (value >= limit_.value) return;
    limit_ = {.value = value, .joint = joint};
  }

  [[nodiscard]] CapabilityLimit Result() const {
    // a negative value means that the load that acts in addition is too large by itself
    if (!(limit_.value > 0.0)) return {.value = 0.0, .joint = limit_.joint};
    return limit_;
  }

 private:
  CapabilityLimit limit_;
};

// Length of v's component perpendicular to a unit axis. Computing it from |v|^2 - (v·a)^2 would lose half of
// the digits.
double LengthAcross(const Vector3& v, const Vector3& axis) { return (v - v.dot(axis) * axis).norm(); }

// The largest factor whose force and torque stay within the caps.
double CappedFactor(double force_N, double torque_Nm) {
  return std::min(force_N > 0.0 ? kForceCap_N / force_N : HUGE_VAL,
                  torque_Nm > 0.0 ? kTorqueCap_Nm / torque_Nm : HUGE_VAL);
}

}  // namespace

template <int N>
ForceCapability<N>::ForceCapability(const JacobianN<N>& J, const JointVectorN<N>& gravity_Nm,
                                    const JointVectorN<N>& torque_limit_Nm, GravityHelp help) OSTEON_RT
    : J_(J),
      room_up_(torque_limit_Nm - gravity_Nm),
      room_down_(torque_limit_Nm + gravity_Nm) {
  if (help == GravityHelp::kNotCounted) {
    room_up_ = torque_limit_Nm - gravity_Nm.cwiseAbs();
    room_down_ = room_up_;
  }
  holds_itself_ = J.allFinite() && room_up_.allFinite() && room_down_.allFinite() &&
                  room_up_.minCoeff() >= 0.0 && room_down_.minCoeff() >= 0.0;
}

template <int N>
CapabilityLimit ForceCapability<N>::Force(const Vector3& u, double torque_Nm) const OSTEON_RT {
  if (!holds_itself_ || !u.allFinite() || !std::isfinite(torque_Nm)) return {};
  TightestLimit tightest(kForceCap_N);
  for (int i = 0; i < N; ++i) {
    const double load = J_.template block<3, 1>(0, i).dot(u);
    // torque of joint i for torque_Nm in its worst direction
    const double taken = torque_Nm * J_.template block<3, 1>(3, i).norm();
    // torque_Nm may act in either direction, so room is needed on both sides, even if the force does not load
    // joint i
    if (std::min(room_up_[i], room_down_[i]) < taken) return {.value = 0.0, .joint = i};
    tightest.Add((load > 0.0 ? room_up_[i] : room_down_[i]) - taken, std::abs(load), i);
  }
  return tightest.Result();
}

template <int N>
CapabilityLimit ForceCapability<N>::Factor(const Wrench& F) const OSTEON_RT {
  if (!holds_itself_ || !F.f.allFinite() || !F.t.allFinite()) return {};
  const double force_N = F.f.stableNorm(), torque_Nm = F.t.stableNorm();
  if (!(force_N > 0.0) && !(torque_Nm > 0.0)) return {};
  TightestLimit tightest(CappedFactor(force_N, torque_Nm));
  for (int i = 0; i < N; ++i) {
    const double load = J_.template block<3, 1>(0, i).dot(F.f) + J_.template block<3, 1>(3, i).dot(F.t);
    tightest.Add(load > 0.0 ? room_up_[i] : room_down_[i], std::abs(load), i);
  }
  return tightest.Result();
}

template <int N>
CapabilityLimit ForceCapability<N>::LateralForce(const Vector3& axis, double axial_N,
                                                 double torque_Nm) const OSTEON_RT {
  if (!holds_itself_ || !axis.allFinite() || !std::isfinite(axial_N) || !std::isfinite(torque_Nm)) return {};
  TightestLimit tightest(kForceCap_N);
  for (int i = 0; i < N; ++i) {
    const Vector3 Jv = J_.template block<3, 1>(0, i);
    const double axial = axial_N * Jv.dot(axis);
    const double taken = torque_Nm * J_.template block<3, 1>(3, i).norm();
    const double room = std::min(room_up_[i] - axial, room_down_[i] + axial) - taken;
    if (room < 0.0) return {.value = 0.0, .joint = i};
    tightest.Add(room, LengthAcross(Jv, axis), i);
  }
  return tightest.Result();
}

template <int N>
CapabilityLimit ForceCapability<N>::Factor(const Vector3& axis, const ToolLoad& load) const OSTEON_RT {
  const double force_N = std::hypot(load.axial_N, load.lateral_N);
  if (!holds_itself_ || !axis.allFinite() || !std::isfinite(force_N) || !std::isfinite(load.torque_Nm))
    return {};
  if (!(force_N > 0.0) && !(load.torque_Nm > 0.0)) return {};
  TightestLimit tightest(CappedFactor(force_N, load.torque_Nm));
  for (int i = 0; i < N; ++i) {
    const Vector3 Jv = J_.template block<3, 1>(0, i);
    const double axial = load.axial_N * Jv.dot(axis);
    const double rest =
        load.lateral_N * LengthAcross(Jv, axis) + load.torque_Nm * J_.template block<3, 1>(3, i).norm();
    tightest.Add(room_up_[i], std::max(0.0, axial) + rest, i);
    tightest.Add(room_down_[i], std::max(0.0, -axial) + rest, i);
  }
  return tightest.Result();
}

template <int N>
double ForceCapability<N>::HoldableShare(const Wrench& F) const OSTEON_RT {
  if (F.f.isZero(0.0) && F.t.isZero(0.0)) return 1.0;
  return std::min(1.0, Factor(F).value);
}

template class ForceCapability<6>;
template class ForceCapability<7>;

}  // namespace osteon::kinematics
