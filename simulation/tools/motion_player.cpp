#include "simulation/tools/motion_player.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <fmt/format.h>

namespace osteon::simulation {

MotionCurve::MotionCurve(std::span<const MotionSample> samples) {
  knots_.reserve(samples.size());
  for (const MotionSample& s : samples) {
    Knot knot{.time_s = s.time_s, .spindle_rad_per_s = s.spindle_rad_per_s, .value = {}, .second = {}};
    knot.value << s.p_GT_m, s.R_GT.w(), s.R_GT.x(), s.R_GT.y(), s.R_GT.z();
    // q and -q are the same rotation: take the one nearer to the previous quaternion, so that the curve makes
    // no detour
    if (!knots_.empty() && knots_.back().value.tail<4>().dot(knot.value.tail<4>()) < 0.0)
      knot.value.tail<4>() *= -1.0;
    knot.second.setZero();
    knots_.push_back(knot);
  }
  // Compute the second derivatives m of the natural spline at the knots. For consecutive intervals of lengths
  // h0 and h1, they satisfy h0 m0 + 2 (h0 + h1) m1 + h1 m2 = 6 (slope1 - slope0). This tridiagonal system is
  // solved by forward elimination and back substitution.
  const std::size_t n = knots_.size();
  std::vector<double> diagonal(n, 1.0);
  const auto step = [&](std::size_t i) { return knots_[i + 1].time_s - knots_[i].time_s; };
  const auto slope = [&](std::size_t i) {
    return Channels((knots_[i + 1].value - knots_[i].value) / step(i));
  };
  for (std::size_t i = 1; i + 1 < n; ++i) {
    const double below = i == 1 ? 0.0 : step(i - 1) / diagonal[i - 1];
    diagonal[i] = 2.0 * (step(i - 1) + step(i)) - below * step(i - 1);
    knots_[i].second = 6.0 * (slope(i) - slope(i - 1)) - below * knots_[i - 1].second;
  }
  for (std::size_t i = n - 1; i-- > 1;)
    knots_[i].second = (knots_[i].second - step(i) * knots_[i + 1].second) / diagonal[i];
}

std::size_t MotionCurve::IndexBefore(double time_s) const {
  const auto after = std::upper_bound(knots_.begin() + 1, knots_.end() - 1, time_s,
                                      [](double t, const Knot& knot) { return t < knot.time_s; });
  return static_cast<std::size_t>(after - knots_.begin()) - 1;
}

Pose MotionCurve::X_GT(double time_s) const {
  const double t = std::clamp(time_s, knots_.front().time_s, knots_.back().time_s);
  const std::size_t i = IndexBefore(t);
  const Knot &a = knots_[i], &b = knots_[i + 1];
  // Evaluate the cubic between the knots a and b from its values and second derivatives at both; u and v are
  // the weights of a and b.
  const double h = b.time_s - a.time_s, u = (b.time_s - t) / h, v = (t - a.time_s) / h;
  const Channels value =
      u * a.value + v * b.value + h * h / 6.0 * ((u * u * u - u) * a.second + (v * v * v - v) * b.second);
  Pose X_GT = Pose::Identity();
  X_GT.translation() = value.head<3>();
  X_GT.linear() = Eigen::Quaterniond(value[3], value[4], value[5], value[6]).normalized().toRotationMatrix();
  return X_GT;
}

double MotionCurve::SpindleAt(double time_s) const {
  if (time_s >= knots_.back().time_s) return knots_.back().spindle_rad_per_s;
  return knots_[IndexBefore(time_s)].spindle_rad_per_s;
}

FittedMotion FitMotion(std::span<const MotionSample> recorded, const FitParams& params) {
  const std::size_t count = recorded.size();
  // Start with the first and the last sample, one sample every longest_step_s, and each change of the
  // spindle's speed.
  std::vector<bool> kept(count, false);
  kept.front() = kept.back() = true;
  double last_s = recorded.front().time_s;
  for (std::size_t i = 1; i < count; ++i) {
    if (recorded[i].spindle_rad_per_s != recorded[i - 1].spindle_rad_per_s) kept[i] = true;
    const bool too_far = i + 1 < count && recorded[i + 1].time_s - last_s > params.longest_step_s;
    if (kept[i] || too_far) {
      kept[i] = true;
      last_s = recorded[i].time_s;
    }
  }

  // Add the sample with the largest error of each stretch, until the curve has no error above the tolerance.
  FittedMotion fitted;
  for (bool done = false; !done;) {
    fitted = {};
    for (std::size_t i = 0; i < count; ++i)
      if (kept[i]) fitted.samples.push_back(Rounded(recorded[i]));
    const MotionCurve curve(fitted.samples);
    done = true;
    double worst = 1.0;  // largest error in the present stretch, in units of the tolerance
    std::size_t worst_at = count;
    for (std::size_t i = 0; i < count; ++i) {
      const Pose X_GT = curve.X_GT(recorded[i].time_s);
      const double position_m = (X_GT.translation() - recorded[i].p_GT_m).norm();
      const double rotation_rad =
          Eigen::Quaterniond(X_GT.linear()).angularDistance(recorded[i].R_GT.normalized());
      fitted.position_error_m = std::max(fitted.position_error_m, position_m);
      fitted.rotation_error_rad = std::max(fitted.rotation_error_rad, rotation_rad);
      if (kept[i]) {  // end of a stretch: keep its sample with the largest error
        if (worst_at < count) {
          kept[worst_at] = true;
          done = false;
        }
        worst = 1.0;
        worst_at = count;
        continue;
      }
      const double error = std::max(position_m / params.tolerance_m, rotation_rad / params.tolerance_rad);
      if (error > worst) {
        worst = error;
        worst_at = i;
      }
    }
  }
  return fitted;
}

MotionPlayer::MotionPlayer(const ToolMotion& motion, double rate_hz, const Pose& X_WG)
    : curve_(motion.samples), rate_hz_(rate_hz), X_WG_(X_WG) {
  if (!(rate_hz >= 1.0 && rate_hz <= 1e5))
    throw std::invalid_argument(fmt::format("motion: rate: found {} Hz, accepted 1 … 100000 Hz", rate_hz));
  // 1e-9: if the duration is a whole number of periods, rounding must not lose the last frame.
  frame_count_ = static_cast<std::size_t>(curve_.duration_s() * rate_hz + 1e-9) + 1;
}

FrameInput MotionPlayer::Frame(std::size_t index) const {
  const double time_s = static_cast<double>(index) / rate_hz_;
  return {.X_WT = X_WG_ * curve_.X_GT(time_s),
          .spindle_rad_per_s = curve_.SpindleAt(time_s),
          .dt_s = 1.0 / rate_hz_,
          .stamp = static_cast<rt::Nanoseconds>(std::llround(time_s * 1e9))};
}

}  // namespace osteon::simulation
