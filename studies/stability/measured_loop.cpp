#include "studies/stability/measured_loop.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include "control/laws/admittance_law.h"

namespace osteon::studies {
namespace {

using Complex = std::complex<double>;

constexpr double kSmooth_octave = 0.35;  // width of the smoothing bell at half of its height
constexpr double kLowest_hz = 0.01;      // lowest frequency of the grid on which the curve is computed
constexpr int kPoints = 1500;            // number of frequencies of the grid
// Radius of the disc that contains 95 % of a plane's normal distribution with standard deviation 1.
constexpr double k95 = 2.4477468306808161;
// Least standard deviation of a line, so that weights stay finite without noise.
constexpr double kMinSd = 1e-9;
constexpr double kTwoPi = 2.0 * std::numbers::pi;

// The measured position divided by the commanded one, at one frequency: the sampled arm, the delay and the
// resonances.
Complex ResponseOf(const hil::LoopArm& arm, const ResponseModel& model, double hz) {
  const Complex z = std::polar(1.0, kTwoPi * hz * model.period_s);
  const Eigen::Matrix2cd from_state =
      z * Eigen::Matrix2cd::Identity() - arm.step.leftCols<2>().cast<Complex>();
  const Eigen::Vector2cd from_command = arm.step.col(3).cast<Complex>() + arm.step.col(2).cast<Complex>() / z;
  const Eigen::Vector2cd motion = from_state.inverse() * from_command;
  Complex response = motion[0] * std::pow(z, -arm.whole) * std::polar(1.0, -kTwoPi * hz * model.delay_s);
  for (const StructureResonance& resonance : model.structure) {
    const double ratio = hz / resonance.hz;
    response /= Complex(1.0 - ratio * ratio, 2.0 * resonance.damping_ratio * ratio);
  }
  return response;
}

// A linear step of law and wall by a tick, with an external force. The state is: x_c now and earlier, v.
// @returns infinite values if the law refuses its input.
Eigen::VectorXd StepLaw(const hil::AdmittanceLoopParams& params, const Eigen::VectorXd& s, double force_N) {
  const int poses = static_cast<int>(s.size()) - 1, age = params.wall.age_ticks;
  const double wall_N =
      -params.wall.stiffness_N_per_m * s[age] -
      params.wall.damping_Ns_per_m * (age == 0 ? s[poses] : (s[age] - s[age + 1]) / params.period_s);
  control::AdmittanceParams law;
  law.mass_kg.z() = params.mass_kg;
  law.damping_Ns_per_m.z() = params.damping_Ns_per_m;
  control::AdmittanceState tool;
  tool.X_WT.translation().z() = s[0];
  tool.V_WT.v.z() = s[poses];
  const Wrench F{.f = {0.0, 0.0, force_N + wall_N}, .t = Vector3::Zero()};
  Eigen::VectorXd next = Eigen::VectorXd::Constant(s.size(), std::numeric_limits<double>::infinity());
  if (!control::StepAdmittance(law, F, params.period_s, tool)) return next;
  next[0] = tool.X_WT.translation().z();
  for (int i = 1; i < poses; ++i) next[i] = s[i - 1];
  next[poses] = tool.V_WT.v.z();
  return next;
}

// Dynamic stiffness of a hand [N/m]: its force divided by the displacement, positive for a spring.
Complex HandAt(const hil::GridHand& hand, double hz) {
  const double w = kTwoPi * hz;
  return {hand.stiffness_N_per_m - w * w * hand.mass_kg, w * hand.damping_Ns_per_m};
}

// The loop without the hand: law × sensor's delay × response. The radius is relative to the size of the
// curve.
std::vector<NyquistPoint> WithoutHand(const MeasuredPlant& response, const MeasuredLoopParams& params,
                                      const LawResponse& law) {
  std::vector<NyquistPoint> curve;
  curve.reserve(response.grid().size());
  for (const MeasuredPlant::Point& at : response.grid())
    curve.push_back(
        {.hz = at.hz,
         .loop = law.At(at.z) * std::polar(1.0, -kTwoPi * at.hz * params.sensor_delay_s) * at.value,
         .radius = k95 * at.share});
  return curve;
}

// Number of unstable poles of the closed loop by Nyquist's criterion: the number of the law's unstable poles,
// less the number of times that 1 + L encircles 0 over the whole unit circle. `curve` is the upper half of
// the circle. Near z = 1 the contour passes outside the integrator's pole, so the angle starts at its
// principal value.
int UnstablePoles(const std::vector<NyquistPoint>& curve, int unstable_law) {
  double angle = std::arg(1.0 + curve.front().loop);
  for (std::size_t i = 1; i < curve.size(); ++i)
    angle += std::arg((1.0 + curve[i].loop) / (1.0 + curve[i - 1].loop));
  return unstable_law - static_cast<int>(std::lround(angle / std::numbers::pi));
}

}  // namespace

void FindMargins(const std::vector<NyquistPoint>& curve, LoopMargins& margins) {
  margins.gain = std::numeric_limits<double>::infinity();
  margins.phase_deg = 180.0;
  margins.modulus = std::numeric_limits<double>::infinity();
  margins.robust = margins.stable;
  for (std::size_t i = 0; i < curve.size(); ++i) {
    const NyquistPoint& at = curve[i];
    const double distance = std::abs(1.0 + at.loop);
    if (distance <= at.radius) margins.robust = false;
    if (distance < margins.modulus) {
      margins.modulus = distance;
      margins.modulus_radius = at.radius;
      margins.modulus_hz = at.hz;
    }
    if (i == 0) continue;
    const NyquistPoint& before = curve[i - 1];
    const double im0 = before.loop.imag(), im1 = at.loop.imag();
    if ((im0 < 0.0) != (im1 < 0.0)) {  // the curve crosses the real axis
      const double share = im0 / (im0 - im1);
      const double real = std::lerp(before.loop.real(), at.loop.real(), share);
      if (real < 0.0 && real > -1.0 && -1.0 / real < margins.gain) {
        margins.gain = -1.0 / real;
        margins.gain_radius = margins.gain * at.radius / std::abs(real);
      }
    }
    const double size0 = std::abs(before.loop) - 1.0, size1 = std::abs(at.loop) - 1.0;
    if ((size0 < 0.0) != (size1 < 0.0)) {  // the curve crosses the circle |L| = 1
      const double share = size0 / (size0 - size1);
      const Complex cross = before.loop + share * (at.loop - before.loop);
      const double phase_deg = std::abs(std::arg(-cross)) * 180.0 / std::numbers::pi;
      if (phase_deg < margins.phase_deg) {
        margins.phase_deg = phase_deg;
        margins.phase_radius_deg = std::asin(std::min(1.0, at.radius)) * 180.0 / std::numbers::pi;
      }
    }
  }
}

Complex ModelResponse(const ResponseModel& model, double hz) {
  return ResponseOf(hil::LinearArm(model.arm, model.period_s), model, hz);
}

MeasuredPlant::MeasuredPlant(const std::vector<PlantLine>& lines, const ResponseModel& model)
    : MeasuredPlant(
          lines,
          [model, arm = hil::LinearArm(model.arm, model.period_s)](double hz) {
            return ResponseOf(arm, model, hz);
          },
          model.period_s) {}

MeasuredPlant::MeasuredPlant(const std::vector<PlantLine>& lines, std::function<Complex(double)> model,
                             double period_s)
    : model_(std::move(model)), period_s_(period_s) {
  const double half_rate_hz = 0.5 / period_s;
  if (lines.size() < 2)
    throw std::invalid_argument(
        fmt::format("measured response: found {} lines, accepted 2 and more", lines.size()));
  for (const PlantLine& line : lines) {
    if (!(line.hz > 0.0 && line.hz < half_rate_hz) || (!lines_.empty() && line.hz <= lines_.back().hz))
      throw std::invalid_argument(
          fmt::format("measured response: found a line at {:g} Hz, accepted rising frequencies below {:g} Hz",
                      line.hz, half_rate_hz));
    const Complex expected = model_(line.hz);
    const double share = std::max(line.sd, kMinSd) / std::abs(expected);
    lines_.push_back({.octave = std::log2(line.hz),
                      .hz = line.hz,
                      .value = line.value / expected,
                      .weight = 1.0 / (share * share)});
  }
  for (int i = 0; i < kPoints; ++i) {
    const double hz =
        kLowest_hz * std::pow(half_rate_hz / kLowest_hz, static_cast<double>(i) / (kPoints - 1));
    const RatioAt ratio = RatioToModel(hz);
    grid_.push_back({.hz = hz,
                     .z = std::polar(1.0, kTwoPi * hz * period_s),
                     .value = ratio.value * model_(hz),
                     .share = ratio.share});
  }
}

MeasuredPlant::RatioAt MeasuredPlant::RatioToModel(double hz) const {
  const Ratio ratio = Smoothed(hz);
  return {.value = ratio.value, .share = 1.0 / (std::sqrt(ratio.weight) * std::abs(ratio.value))};
}

MeasuredPlant::Ratio MeasuredPlant::Smoothed(double hz) const {
  const double octave = std::log2(std::clamp(hz, lines_.front().hz, lines_.back().hz));
  // standard deviation of the Gaussian bell whose width at half of its height is kSmooth_octave
  const double spread = kSmooth_octave / (2.0 * std::sqrt(2.0 * std::log(2.0)));
  Complex weighted_sum(0.0, 0.0);
  double weights = 0.0, variance_sum = 0.0, nearest = std::numeric_limits<double>::infinity();
  for (const Ratio& line : lines_) nearest = std::min(nearest, std::abs(line.octave - octave));
  for (const Ratio& line : lines_) {
    // If the lines are sparse, distances are reduced by that of the nearest line, so that one line always has
    // weight.
    const double away = (std::abs(line.octave - octave) - std::max(0.0, nearest - spread)) / spread;
    const double bell = std::exp(-0.5 * away * away), weight = bell * line.weight;
    weighted_sum += weight * line.value;
    weights += weight;
    variance_sum += bell * weight;
  }
  // weight = 1 / variance of the weighted mean, as each line has the variance 1 / line.weight
  return {.octave = octave,
          .hz = hz,
          .value = weighted_sum / weights,
          .weight = weights * weights / variance_sum};
}

Complex MeasuredPlant::At(double hz) const { return Smoothed(hz).value * model_(hz); }

LawResponse::LawResponse(const hil::AdmittanceLoopParams& params) {
  Validate(params);
  if (params.wall.stiffness_N_per_m > 0.0 && params.wall.on != hil::WallOn::kCommanded)
    throw std::invalid_argument("measured loop: wall: found one on measured poses, accepted commanded ones");
  const int size = params.wall.age_ticks + 3;
  const auto step = [&](const Eigen::VectorXd& s) { return StepLaw(params, s, 0.0); };
  state_ = hil::LoopMatrix(step, size);
  input_ = StepLaw(params, Eigen::VectorXd::Zero(size), 1.0);
  // A tick sends the new x_c, the first element of the next state.
  output_ = state_.row(0).transpose();
  direct_ = input_[0];
  // Without a wall the law integrates. This pole at 1 does not count as unstable.
  const bool integrates = !(params.wall.stiffness_N_per_m > 0.0);
  const Eigen::VectorXcd poles = Eigen::EigenSolver<Eigen::MatrixXd>(state_, false).eigenvalues();
  for (const Complex& pole : poles)
    if (std::abs(pole) >= 1.0 && !(integrates && std::abs(pole - 1.0) < 1e-9)) ++unstable_;
}

Complex LawResponse::At(Complex z) const {
  const Eigen::MatrixXcd from_state =
      z * Eigen::MatrixXcd::Identity(state_.rows(), state_.cols()) - state_.cast<Complex>();
  const Eigen::VectorXcd state = from_state.partialPivLu().solve(input_.cast<Complex>());
  return (output_.cast<Complex>().transpose() * state)(0) + direct_;
}

std::vector<NyquistPoint> NyquistCurve(const MeasuredPlant& response, const MeasuredLoopParams& params) {
  std::vector<NyquistPoint> curve = WithoutHand(response, params, LawResponse(params.loop));
  for (NyquistPoint& at : curve) {
    at.loop *= HandAt(params.loop.hand, at.hz);
    at.radius *= std::abs(at.loop);
  }
  return curve;
}

LoopMargins JudgeMeasuredLoop(const MeasuredPlant& response, const MeasuredLoopParams& params) {
  const std::vector<NyquistPoint> curve = NyquistCurve(response, params);
  LoopMargins margins;
  margins.unstable_poles = UnstablePoles(curve, LawResponse(params.loop).unstable());
  margins.stable = margins.unstable_poles == 0;
  FindMargins(curve, margins);
  return margins;
}

bool AreAllStable(const MeasuredPlant& response, const MeasuredLoopParams& params,
                  std::span<const hil::GridHand> hands) {
  const LawResponse law(params.loop);
  const std::vector<NyquistPoint> without = WithoutHand(response, params, law);
  std::vector<NyquistPoint> curve = without;
  for (const hil::GridHand& hand : hands) {
    for (std::size_t i = 0; i < curve.size(); ++i)
      curve[i].loop = without[i].loop * HandAt(hand, without[i].hz);
    if (UnstablePoles(curve, law.unstable()) != 0) return false;
  }
  return true;
}

}  // namespace osteon::studies
