#include "safety/joint_torque_limit.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "base/number_text.h"

namespace osteon::safety {
namespace {

// Rounding of the quotient and of its product with a torque may each add half an ulp. This factor keeps the
// scaled torque within the limit in spite of that.
constexpr double kRoundDown = 1.0 - 1e-15;

}  // namespace

template <int N>
JointTorqueLimit<N>::JointTorqueLimit(const Joints& max_Nm) : max_Nm_(max_Nm) {
  for (int i = 0; i < N; ++i)
    if (!(max_Nm[i] > 0.0) || !std::isfinite(max_Nm[i]))
      throw std::invalid_argument("torque_Nm of joint " + std::to_string(i + 1) + ": found " +
                                  base::NumberText(max_Nm[i]) + ", accepted > 0: what the arm can hold");
}

template <int N>
double JointTorqueLimit<N>::MaxScale(const Joints& gravity_Nm, const Joints& tau_Nm) const OSTEON_RT {
  double scale = 1.0;
  for (int i = 0; i < N; ++i) {
    const double room_Nm = std::max(0.0, max_Nm_[i] - std::abs(gravity_Nm[i])), size_Nm = std::abs(tau_Nm[i]);
    if (!std::isfinite(size_Nm)) return 0.0;
    if (size_Nm > room_Nm) scale = std::min(scale, room_Nm / size_Nm * kRoundDown);
  }
  return scale;
}

template <int N>
bool JointTorqueLimit<N>::PredictOverload(const Joints& gravity_Nm, const Joints& tau_external_Nm) OSTEON_RT {
  if (!tau_external_Nm.allFinite()) {
    has_before_ = false;
    return false;
  }
  const Joints change_Nm = has_before_ ? Joints(tau_external_Nm - before_Nm_) : Joints(Joints::Zero());
  before_Nm_ = tau_external_Nm;
  has_before_ = true;
  return MaxScale(gravity_Nm, tau_external_Nm.cwiseAbs() + change_Nm.cwiseAbs()) < 1.0;
}

template class JointTorqueLimit<7>;

}  // namespace osteon::safety
