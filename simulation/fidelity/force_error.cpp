#include "simulation/fidelity/force_error.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include <fmt/format.h>

namespace osteon::simulation {
namespace {

constexpr double kMinShare = 1e-3;  // share of the largest exact force; smaller forces have no normal
constexpr double kDegrees = 180.0 / std::numbers::pi;

double Angle_deg(const Vector3& a, const Vector3& b) {
  return kDegrees * std::atan2(a.cross(b).norm(), a.dot(b));
}

void CheckEqual(std::size_t a, std::size_t b, const char* what) {
  if (a != b)
    throw std::invalid_argument(fmt::format("{}: found {} and {}, accepted equal numbers", what, a, b));
}

}  // namespace

ForceErrors CompareForces(std::span<const FeltForce> measured, std::span<const FeltForce> exact,
                          double rate_hz) {
  CheckEqual(measured.size(), exact.size(), "forces to compare");
  if (!(rate_hz > 0.0))
    throw std::invalid_argument(fmt::format("frame rate: found {:g} Hz, accepted more than 0", rate_hz));
  ForceErrors errors;
  const std::size_t count = exact.size();
  if (count == 0) return errors;
  double max_N = 0.0, exact_sum = 0.0, force_sum = 0.0, torque_sum = 0.0, angle_sum = 0.0;
  for (const FeltForce& force : exact) max_N = std::max(max_N, force.f_N.norm());
  const double min_N = kMinShare * max_N;
  const auto has_normal = [&](std::size_t k) {
    return exact[k].f_N.norm() > min_N && measured[k].f_N.norm() > min_N;
  };

  std::size_t normals = 0;
  for (std::size_t k = 0; k < count; ++k) {
    exact_sum += exact[k].f_N.squaredNorm();
    force_sum += (measured[k].f_N - exact[k].f_N).squaredNorm();
    torque_sum += (measured[k].t_Nm - exact[k].t_Nm).squaredNorm();
    if (!has_normal(k)) continue;
    const double angle = Angle_deg(measured[k].f_N, exact[k].f_N);
    angle_sum += angle * angle;
    errors.normal_max_deg = std::max(errors.normal_max_deg, angle);
    ++normals;
  }
  errors.force_rms_N = std::sqrt(force_sum / static_cast<double>(count));
  errors.torque_rms_Nm = std::sqrt(torque_sum / static_cast<double>(count));
  errors.force_relative = exact_sum > 0.0 ? std::sqrt(force_sum / exact_sum) : 0.0;
  if (normals > 0) errors.normal_rms_deg = std::sqrt(angle_sum / static_cast<double>(normals));
  errors.touched = normals > 0 || !(max_N > 0.0);

  const double per_ms = rate_hz * 1e-3;
  for (std::size_t k = 0; k + 1 < count; ++k) {
    // change of the error from this frame to the next, per millisecond
    const auto jump = [&](const auto& of) {
      return ((of(measured[k + 1]) - of(measured[k])) - (of(exact[k + 1]) - of(exact[k]))).norm() * per_ms;
    };
    errors.force_jump_N_per_ms = std::max(errors.force_jump_N_per_ms,
                                          jump([](const FeltForce& x) -> const Vector3& { return x.f_N; }));
    errors.torque_jump_Nm_per_ms = std::max(
        errors.torque_jump_Nm_per_ms, jump([](const FeltForce& x) -> const Vector3& { return x.t_Nm; }));
    if (!has_normal(k) || !has_normal(k + 1)) continue;
    const double turned =
        Angle_deg(measured[k].f_N, measured[k + 1].f_N) - Angle_deg(exact[k].f_N, exact[k + 1].f_N);
    errors.normal_jump_deg_per_ms = std::max(errors.normal_jump_deg_per_ms, turned * per_ms);
  }
  return errors;
}

}  // namespace osteon::simulation
