#pragma once

#include <complex>
#include <functional>
#include <span>
#include <vector>

#include <Eigen/Dense>

#include "hil/loops/admittance_loop.h"

// Judges the loop of hand, arm and law by Nyquist's criterion, from a measured frequency response of the arm
// instead of a model.

namespace osteon::studies {

/// One frequency of a measured response.
struct PlantLine {
  double hz{0.0};
  std::complex<double> value{1.0, 0.0};
  double sd{0.0};  ///< standard deviation of the real part, and of the imaginary part
};

/// A resonance between the encoders and the tool: w^2 / (s^2 + 2 z w s + w^2).
struct StructureResonance {
  double hz{0.0};
  double damping_ratio{0.0};
};

/// The fitted model of a response.
struct ResponseModel {
  hil::ServoArmParams arm;
  std::vector<StructureResonance> structure{};
  /// Delay in addition to the arm's dead time: that of the sensor, if the response was measured by the
  /// sensor.
  double delay_s{0.0};
  double period_s{0.001};
};

/// The measured pose of a ServoArm divided by the command that the tick sends in answer to this measurement.
/// Exact for a command that is held for a period T; the dead time is included. `hz` in (0, 1 / 2 T].
[[nodiscard]] std::complex<double> ModelResponse(const ResponseModel& model, double hz);

/// A response that was measured at lines, interpolated with a model. The ratio of the measured to the model's
/// response is smoothed over 0.35 octave with weights 1 / sd^2, and multiplied by the model's response. Below
/// and above the lines, the ratio at the nearest line is used.
class MeasuredPlant {
 public:
  /// @param lines  sorted by rising frequency, at least two
  /// @throws std::invalid_argument if there are fewer lines, or if they are not sorted
  MeasuredPlant(const std::vector<PlantLine>& lines, const ResponseModel& model);
  /// Makes the plant with any model: a function of the frequency [Hz], up to half of the sampling rate.
  MeasuredPlant(const std::vector<PlantLine>& lines, std::function<std::complex<double>(double)> model,
                double period_s);

  [[nodiscard]] std::complex<double> At(double hz) const;
  [[nodiscard]] double period_s() const { return period_s_; }
  [[nodiscard]] double lowest_hz() const { return lines_.front().hz; }

  struct Point {
    double hz{0.0};
    std::complex<double> z;      ///< e^(j w T)
    std::complex<double> value;  ///< the response
    /// Standard deviation of the response's real and of its imaginary part, divided by the response's size.
    double share{0.0};
  };
  /// Smoothed ratio of the measured to the model's response at a frequency. `share` is the standard deviation
  /// of the ratio's real and of its imaginary part, divided by the ratio's size.
  struct RatioAt {
    std::complex<double> value;
    double share{0.0};
  };
  [[nodiscard]] RatioAt RatioToModel(double hz) const;
  /// The response from 0.01 Hz to half of the sampling rate, evenly spaced in the logarithm.
  [[nodiscard]] const std::vector<Point>& grid() const { return grid_; }

 private:
  struct Ratio {
    double octave{0.0};  // binary logarithm of the frequency
    double hz{0.0};
    std::complex<double> value;
    double weight{0.0};
  };
  // Returns the ratio, smoothed over the lines near hz; its weight is 1 / variance.
  [[nodiscard]] Ratio Smoothed(double hz) const;

  std::vector<Ratio> lines_;
  std::function<std::complex<double>(double)> model_;
  double period_s_;
  std::vector<Point> grid_;
};

/// Transfer function of the law from force to command, in z: the shipped StepAdmittance with the wall of
/// `params`. The wall must act on commanded poses.
class LawResponse {
 public:
  explicit LawResponse(const hil::AdmittanceLoopParams& params);
  /// The command that a tick sends, divided by the force that the tick reads, at z [m/N].
  [[nodiscard]] std::complex<double> At(std::complex<double> z) const;
  /// Number of eigenvalues of law and wall that lie on or outside the unit circle, without the integrator's
  /// at 1.
  [[nodiscard]] int unstable() const { return unstable_; }

 private:
  // next state = state_ s + input_ F; command = output_ s + direct_ F
  Eigen::MatrixXd state_;
  Eigen::VectorXd input_, output_;
  double direct_{0.0};
  int unstable_{0};
};

/// Stability and margins of a loop, from its measured response. Each margin lies within its radius with a
/// probability of 95 %.
struct LoopMargins {
  bool stable{false};
  int unstable_poles{0};  ///< number of the closed loop's unstable poles, by the encirclements of -1
  /// Gain margin: factor on the loop's gain that makes it unstable; infinite: there is none.
  double gain{0.0};
  double gain_radius{0.0};
  double phase_deg{0.0};  ///< phase margin, at the crossings of |L| = 1; 180: there is none
  double phase_radius_deg{0.0};
  double modulus{0.0};  ///< least distance of the curve from -1: |1 + L|
  double modulus_radius{0.0};
  double modulus_hz{0.0};  ///< frequency of `modulus`
  bool robust{false};      ///< the loop is stable, and no 95 % disc of the curve contains -1
};

/// A point of the Nyquist curve.
struct NyquistPoint {
  double hz{0.0};
  std::complex<double> loop;  ///< value L of the open loop
  double radius{0.0};         ///< radius of the disc that contains L with a probability of 95 %
};

/// Fills in gain and phase margin, the least distance from -1, and `robust`. @pre margins.stable is set
void FindMargins(const std::vector<NyquistPoint>& curve, LoopMargins& margins);

/// The loop of a hand. Hand, virtual tool and wall are those of `loop`; its arm and felt mass are not used.
struct MeasuredLoopParams {
  hil::AdmittanceLoopParams loop;
  /// Delay from the measured pose to the force that the loop reads [s]; 0 if the response was measured by the
  /// force sensor.
  double sensor_delay_s{0.0};
};

/// L(f) = law × hand × response, from 0.01 Hz to half of the sampling rate, evenly spaced in the logarithm:
///
///     hand: (k + j w b - w^2 m) e^(-j w sensor delay)
///
/// with the hand's stiffness k, damping b and mass m.
[[nodiscard]] std::vector<NyquistPoint> NyquistCurve(const MeasuredPlant& response,
                                                     const MeasuredLoopParams& params);

/// Judges the loop: stability by the encirclements of -1, then the margins.
[[nodiscard]] LoopMargins JudgeMeasuredLoop(const MeasuredPlant& response, const MeasuredLoopParams& params);
/// Whether the loop is stable with each of these hands in place of the hand of `params`.
[[nodiscard]] bool AreAllStable(const MeasuredPlant& response, const MeasuredLoopParams& params,
                                std::span<const hil::GridHand> hands);

}  // namespace osteon::studies
