#include "studies/identify/measured_response.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <utility>

#include <fmt/format.h>
#include <Eigen/Cholesky>
#include <Eigen/Core>

#include "control/excitation/multisine.h"

namespace osteon::studies {
namespace {

using control::Multisine;
using Complex = std::complex<double>;

constexpr double kTurn = 2.0 * std::numbers::pi;
// Least number of draws; least number of counted periods of each draw.
constexpr int kMinDraws = 2, kMinPeriods = 2;
constexpr double kMinSeen = 0.5;  // least share of a period's samples that must be seen
// Least standard deviation relative to a response of 1: smaller ones are rounding.
constexpr double kMinSd = 1e-9;
constexpr int kMaxDetection = 80;  // number of the harmonic at 20 Hz

// The signal's value in a sample [m or N].
double ValueOf(const ExcitedSample& sample, Signal signal) {
  return signal == Signal::kCommand ? sample.u_m : signal == Signal::kPosition ? sample.y_m : sample.f_N;
}

// A counted period: its samples, and the fitted amplitudes of input and output.
struct Period {
  std::size_t first{0};
  int draw{0};
  Eigen::VectorXcd input{}, output{};  // at the excited lines
  double mean{0.0};                    // mean of the output
  double odd{0.0}, even{0.0};          // levels of the output at the empty lines
};

// Finds the complete counted periods: `ticks` samples in a row of one draw and period.
std::vector<Period> FindPeriods(const ExcitedRun& run, std::size_t ticks) {
  std::vector<Period> periods;
  for (std::size_t i = 0; i + ticks <= run.samples.size();) {
    const ExcitedSample& first = run.samples[i];
    std::size_t length = 0, seen = 0;
    for (; first.counted && length < ticks; ++length) {
      const ExcitedSample& sample = run.samples[i + length];
      if (!sample.counted || sample.draw != first.draw || sample.period != first.period) break;
      seen += sample.seen;
    }
    if (length == ticks && static_cast<double>(seen) >= kMinSeen * static_cast<double>(ticks))
      periods.push_back({.first = i, .draw = first.draw});
    i += std::max<std::size_t>(1, length);
  }
  return periods;
}

// The functions fitted to a period, a row per sample. Columns: 1, then cosine and sine of each harmonic.
Eigen::MatrixXd Basis(std::size_t ticks, double period_s, std::span<const int> harmonics) {
  Eigen::MatrixXd basis(static_cast<Eigen::Index>(ticks),
                        1 + 2 * static_cast<Eigen::Index>(harmonics.size()));
  basis.col(0).setOnes();
  for (Eigen::Index k = 0; k < basis.rows(); ++k)
    for (std::size_t i = 0; i < harmonics.size(); ++i) {
      const double angle = kTurn * Multisine::Frequency(harmonics[i]) * period_s * static_cast<double>(k);
      basis(k, 1 + 2 * static_cast<Eigen::Index>(i)) = std::cos(angle);
      basis(k, 2 + 2 * static_cast<Eigen::Index>(i)) = std::sin(angle);
    }
  return basis;
}

// Converts the fitted coefficients of Basis to complex amplitudes: a cos(w t) + b sin(w t) = Re[(a - i b)
// exp(i w t)].
Eigen::VectorXcd Amplitudes(const Eigen::VectorXd& fitted) {
  Eigen::VectorXcd amplitudes((fitted.size() - 1) / 2);
  for (Eigen::Index i = 0; i < amplitudes.size(); ++i)
    amplitudes[i] = Complex(fitted[1 + 2 * i], -fitted[2 + 2 * i]);
  return amplitudes;
}

// Harmonics up to 20 Hz at which nonlinearity is measured: the odd harmonics that are not excited, and the
// even harmonics next to them.
struct Detection {
  std::vector<int> odd, even;
};
Detection DetectionLines() {
  Detection lines;
  for (int h = 7; h < kMaxDetection; h += 8) {  // the odd harmonics that the multisine leaves empty
    lines.odd.push_back(h);
    lines.even.push_back(h + 1);
  }
  return lines;
}

// RMS amplitude of `signal` at some harmonics, each relative to the amplitude at the nearest excited line.
double LevelAt(const Eigen::VectorXd& signal, const Eigen::VectorXcd& excited, std::span<const int> harmonics,
               double period_s) {
  const auto lines = Multisine::Harmonics();
  double squares = 0.0;
  for (const int harmonic : harmonics) {
    Complex sum = 0.0;
    for (Eigen::Index k = 0; k < signal.size(); ++k)
      sum += signal[k] *
             std::polar(1.0, -kTurn * Multisine::Frequency(harmonic) * period_s * static_cast<double>(k));
    const double amplitude = 2.0 * std::abs(sum) / static_cast<double>(signal.size());
    std::size_t nearest = 0;
    for (std::size_t i = 0; i < lines.size(); ++i)
      if (std::abs(lines[i] - harmonic) < std::abs(lines[nearest] - harmonic)) nearest = i;
    const double beside = std::abs(excited[static_cast<Eigen::Index>(nearest)]);
    squares += beside > 0.0 ? (amplitude / beside) * (amplitude / beside) : 0.0;
  }
  return std::sqrt(squares / static_cast<double>(harmonics.size()));
}

// Slope of the output [1/sample]: that of a straight line through the means of whole periods; 0 with one
// period.
double DriftOf(const std::vector<Period>& periods, int draw) {
  double n = 0.0, sum_t = 0.0, sum_y = 0.0;
  for (const Period& period : periods)
    if (period.draw == draw) {
      n += 1.0;
      sum_t += static_cast<double>(period.first);
      sum_y += period.mean;
    }
  double sum_ty = 0.0, sum_tt = 0.0;
  for (const Period& period : periods)
    if (period.draw == draw) {
      const double t = static_cast<double>(period.first) - sum_t / n;
      sum_ty += t * (period.mean - sum_y / n);
      sum_tt += t * t;
    }
  return sum_tt > 0.0 ? sum_ty / sum_tt : 0.0;
}

// Fits the amplitudes of input and output to each period by least squares, over the samples that were seen.
class PeriodFit {
 public:
  PeriodFit(const ExcitedRun& run, std::size_t ticks, Signal input, Signal output)
      : run_(run),
        ticks_(ticks),
        input_(input),
        output_(output),
        harmonics_(Multisine::Harmonics()),
        basis_(Basis(ticks, run.period_s, harmonics_)),
        normal_(basis_.transpose() * basis_) {}

  // Fills in the period's amplitudes, mean and levels. @param drift  slope of the output that is removed
  // [1/sample]
  void Fit(Period& period, double drift) const {
    const auto ticks = static_cast<Eigen::Index>(ticks_);
    const bool is_whole = AllSeen(period);
    Eigen::VectorXd u(ticks), y(ticks);
    Eigen::MatrixXd masked;
    if (!is_whole) masked = basis_;
    for (Eigen::Index k = 0; k < ticks; ++k) {
      const ExcitedSample& sample = run_.samples[period.first + static_cast<std::size_t>(k)];
      const double t = static_cast<double>(k) - 0.5 * static_cast<double>(ticks - 1);
      u[k] = ValueOf(sample, input_);
      y[k] = sample.seen ? ValueOf(sample, output_) - drift * t : 0.0;
      if (sample.seen) continue;
      // of a message that did not come only the command is known; set the other signals to zero
      if (input_ != Signal::kCommand) u[k] = 0.0;
      masked.row(k).setZero();
    }
    const Eigen::MatrixXd& of_output = is_whole ? basis_ : masked;
    const Eigen::LDLT<Eigen::MatrixXd> solver(is_whole ? normal_
                                                       : Eigen::MatrixXd(masked.transpose() * masked));
    const Eigen::VectorXd fitted = solver.solve(of_output.transpose() * y);
    period.mean = fitted[0];
    period.output = Amplitudes(fitted);
    period.input =
        Amplitudes(input_ == Signal::kCommand ? Eigen::VectorXd(normal_.ldlt().solve(basis_.transpose() * u))
                                              : Eigen::VectorXd(solver.solve(of_output.transpose() * u)));
    Eigen::VectorXd residual = y - of_output * fitted;
    if (!is_whole)
      for (Eigen::Index k = 0; k < ticks; ++k)
        if (!run_.samples[period.first + static_cast<std::size_t>(k)].seen) residual[k] = 0.0;
    const Detection lines = DetectionLines();
    period.odd = LevelAt(residual, period.output, lines.odd, run_.period_s);
    period.even = LevelAt(residual, period.output, lines.even, run_.period_s);
  }

 private:
  [[nodiscard]] bool AllSeen(const Period& period) const {
    return std::all_of(run_.samples.begin() + static_cast<std::ptrdiff_t>(period.first),
                       run_.samples.begin() + static_cast<std::ptrdiff_t>(period.first + ticks_),
                       [](const ExcitedSample& sample) { return sample.seen; });
  }

  const ExcitedRun& run_;
  std::size_t ticks_;
  Signal input_, output_;
  std::array<int, Multisine::kLines> harmonics_;
  Eigen::MatrixXd basis_, normal_;  // normal_: basis^T basis
};

// The result of one draw at one line.
struct DrawLine {
  Complex H;
  double output_variance{0.0};  // variance of a period's output: of its real or imaginary part
  double input_power{0.0};      // sum of |U|^2 over the draw's periods
};

// The response H of one draw at one line, by least squares over the draw's periods: H = sum Y U* / sum |U|^2,
// with the amplitudes U of the input and Y of the output.
DrawLine LineOf(const std::vector<const Period*>& periods, Eigen::Index line) {
  DrawLine result;
  Complex cross_power = 0.0;
  for (const Period* period : periods) {
    cross_power += period->output[line] * std::conj(period->input[line]);
    result.input_power += std::norm(period->input[line]);
  }
  result.H = cross_power / result.input_power;
  for (const Period* period : periods)
    result.output_variance += std::norm(period->output[line] - result.H * period->input[line]);
  result.output_variance /= 2.0 * static_cast<double>(periods.size() - 1);
  return result;
}

// Moving mean over up to five lines around each line.
std::vector<double> Smoothed(const std::vector<double>& values) {
  std::vector<double> smooth(values.size());
  for (std::size_t i = 0; i < values.size(); ++i) {
    const std::size_t begin = i < 2 ? 0 : i - 2, end = std::min(values.size(), i + 3);
    for (std::size_t k = begin; k < end; ++k) smooth[i] += values[k] / static_cast<double>(end - begin);
  }
  return smooth;
}

// The counted periods by their draw.
using Draws = std::map<int, std::vector<const Period*>>;

// Fills in the response's lines: the mean over the draws, its deviations by noise and by the draws'
// differences, and the coherences.
void FillLines(const Draws& draws, MeasuredResponse& response) {
  constexpr auto kLines = static_cast<std::size_t>(Multisine::kLines);
  const auto count = static_cast<double>(draws.size());
  std::vector<double> noise(kLines), draw_differences(kLines), power(kLines);
  response.lines.resize(kLines);
  for (std::size_t i = 0; i < kLines; ++i) {
    std::vector<DrawLine> each;
    for (const auto& [draw, periods] : draws) each.push_back(LineOf(periods, static_cast<Eigen::Index>(i)));
    ResponseLine& line = response.lines[i];
    line.hz = Multisine::Frequency(Multisine::Harmonics()[i]);
    for (const DrawLine& draw : each) {
      line.value += draw.H / count;
      noise[i] += draw.output_variance / count;
      power[i] += draw.input_power;
    }
    // Convert to a variance of the output's amplitude, which does not depend on the line's power.
    for (const DrawLine& draw : each)
      draw_differences[i] += std::norm(draw.H - line.value) / (2.0 * (count - 1.0)) * power[i] / count;
  }
  noise = Smoothed(noise);
  draw_differences = Smoothed(draw_differences);
  for (std::size_t i = 0; i < kLines; ++i) {
    ResponseLine& line = response.lines[i];
    const double size = std::norm(line.value), min_sd = kMinSd * std::sqrt(size);
    const double noise_variance = noise[i] / power[i], draw_variance = draw_differences[i] / power[i];
    line.noise_sd = std::max(min_sd, std::sqrt(noise_variance));
    line.sd = std::max(line.noise_sd, std::sqrt(draw_variance));
    line.coherence = size / (size + 2.0 * response.periods * line.noise_sd * line.noise_sd);
    line.draw_coherence = size / (size + 2.0 * count * line.sd * line.sd);
  }
}

}  // namespace

tl::expected<MeasuredResponse, std::string> MeasureResponse(const ExcitedRun& run, Signal input,
                                                            Signal output) {
  const auto ticks = static_cast<std::size_t>(std::lround(Multisine::kPeriod_s / run.period_s));
  std::vector<Period> periods = FindPeriods(run, ticks);
  Draws draws;
  for (const Period& period : periods) draws[period.draw].push_back(&period);
  std::erase_if(draws, [](const auto& draw) { return draw.second.size() < kMinPeriods; });
  if (draws.size() < kMinDraws)
    return tl::unexpected(fmt::format(
        "too little: found {} s in {} draws of 2 or more counted periods, accepted {} s in 2 or more draws",
        Multisine::kPeriod_s * static_cast<double>(periods.size()), draws.size(),
        Multisine::kPeriod_s * kMinDraws * kMinPeriods));

  const PeriodFit fit(run, ticks, input, output);
  for (Period& period : periods) fit.Fit(period, 0.0);
  std::map<int, double> drifts;
  for (const auto& [draw, unused] : draws) drifts[draw] = DriftOf(periods, draw);
  MeasuredResponse response{.lines = {}, .draws = static_cast<int>(draws.size())};
  for (Period& period : periods) {
    if (!draws.contains(period.draw)) continue;
    fit.Fit(period, drifts.at(period.draw));
    ++response.periods;
    response.odd_ratio += period.odd;
    response.even_ratio += period.even;
  }
  response.odd_ratio /= response.periods;
  response.even_ratio /= response.periods;
  FillLines(draws, response);
  return response;
}

std::vector<std::vector<ResponseLine>> MeasurePeriods(const ExcitedRun& run, Signal input, Signal output,
                                                      const MeasuredResponse& whole) {
  const auto ticks = static_cast<std::size_t>(std::lround(Multisine::kPeriod_s / run.period_s));
  const PeriodFit fit(run, ticks, input, output);
  std::vector<std::vector<ResponseLine>> list;
  std::vector<Period> periods = FindPeriods(run, ticks);
  for (Period& period : periods) {
    fit.Fit(period, 0.0);
    std::vector<ResponseLine>& lines = list.emplace_back(whole.lines);
    for (std::size_t i = 0; i < lines.size(); ++i) {
      const auto line = static_cast<Eigen::Index>(i);
      lines[i].value = period.output[line] / period.input[line];
      lines[i].sd = lines[i].noise_sd =
          std::sqrt(static_cast<double>(whole.periods)) * whole.lines[i].noise_sd;
    }
  }
  return list;
}

}  // namespace osteon::studies
