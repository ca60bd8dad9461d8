#include "studies/identify/identify_page.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include <fmt/format.h>

#include "report/page.h"
#include "report/svg_plot.h"
#include "report/svg_text.h"
#include "studies/identify/identify_joints.h"

namespace osteon::studies {
namespace {

constexpr double kDegrees = 180.0 / std::numbers::pi;
constexpr double kModelStep = 1.03;  // ratio of frequencies along the fitted curve

// Removes jumps of a whole turn from phases at rising frequencies.
class PhaseUnwrapper {
 public:
  double Next(double phase_rad) {
    while (phase_rad - last_ > std::numbers::pi) phase_rad -= 2.0 * std::numbers::pi;
    while (phase_rad - last_ < -std::numbers::pi) phase_rad += 2.0 * std::numbers::pi;
    return last_ = phase_rad;
  }

 private:
  double last_{0.0};
};

// Gain and phase [deg] over frequency.
struct BodeCurves {
  report::Series gain, phase;
};

// Points of a measured response, with bars of two standard deviations.
BodeCurves Measured(const MeasuredResponse& response, const std::string& name, const std::string& color,
                    report::Marker marker) {
  BodeCurves curves{.gain = {.name = name, .color = color, .width_px = 0.0, .marker = marker},
                    .phase = {.name = name, .color = color, .width_px = 0.0, .marker = marker}};
  PhaseUnwrapper phase;
  for (const ResponseLine& line : response.lines) {
    const double size = std::abs(line.value), two_sd = 2.0 * line.sd;
    const double degrees = kDegrees * phase.Next(std::arg(line.value));
    const double two_sd_degrees = kDegrees * std::min(std::numbers::pi, two_sd / size);
    curves.gain.x.push_back(line.hz);
    curves.gain.y.push_back(size);
    curves.gain.y_low.push_back(std::max(1e-4, size - two_sd));
    curves.gain.y_high.push_back(size + two_sd);
    curves.phase.x.push_back(line.hz);
    curves.phase.y.push_back(degrees);
    curves.phase.y_low.push_back(degrees - two_sd_degrees);
    curves.phase.y_high.push_back(degrees + two_sd_degrees);
  }
  return curves;
}

// Curve of a model between two frequencies.
BodeCurves Fitted(const std::function<std::complex<double>(double hz)>& model, double from_hz, double to_hz) {
  BodeCurves curves{.gain = {.name = "fitted arm", .color = report::kTextColor},
                    .phase = {.name = "fitted arm", .color = report::kTextColor}};
  PhaseUnwrapper phase;
  for (double hz = from_hz; hz <= to_hz; hz *= kModelStep) {
    const std::complex<double> H = model(hz);
    curves.gain.x.push_back(hz);
    curves.gain.y.push_back(std::abs(H));
    curves.phase.x.push_back(hz);
    curves.phase.y.push_back(kDegrees * phase.Next(std::arg(H)));
  }
  return curves;
}

// The fitted arm in the units of the plot: motion divided by command, or by (force / nominal stiffness).
std::function<std::complex<double>(double hz)> FittedModel(const AxisResult& axis, double period_s) {
  if (!axis.overlay)
    return [model = axis.fit.model, period_s](double hz) { return SampledResponse(model, period_s, hz); };
  return [response = FittedResponse(*axis.overlay, *axis.overlaid, period_s),
          nominal_N_per_m = axis.overlaid->nominal_N_per_m](double hz) {
    return nominal_N_per_m * response(hz);
  };
}

// A figure with the gain in its upper panel and the phase in its lower one.
class BodeFigure {
 public:
  explicit BodeFigure(const std::string& title) { gain_.title = title; }
  void Add(BodeCurves curves) {
    gain_.series.push_back(std::move(curves.gain));
    phase_.series.push_back(std::move(curves.phase));
  }
  [[nodiscard]] std::size_t size() const { return gain_.series.size(); }
  [[nodiscard]] std::string Svg() const {
    const std::vector<report::LineChart> panels{gain_, phase_};
    return report::Svg(panels);
  }

 private:
  report::LineChart gain_{
      .x_label = "frequency [Hz]", .y_label = "gain", .y_from_zero = false, .log_x = true, .log_y = true};
  report::LineChart phase_{
      .x_label = "frequency [Hz]", .y_label = "phase [deg]", .log_x = true, .legend = false};
};

std::string BodeSvg(const AxisResult& axis, double period_s) {
  BodeFigure figure(
      fmt::format("The arm along {}, at {:.1f} mm/s RMS", axis.request.axis, 1e3 * axis.rms_speed_m_per_s));
  const auto& lines = axis.by_encoders.lines;
  if (axis.model_holds) figure.Add(Fitted(FittedModel(axis, period_s), lines.front().hz, lines.back().hz));
  figure.Add(Measured(axis.by_encoders, "by the encoders", report::kPalette[0], report::Marker::kCircle));
  if (axis.by_force)
    figure.Add(Measured(*axis.by_force, "by the force sensor", report::kPalette[1], report::Marker::kSquare));
  return figure.Svg();
}

// Draws all joints in one figure, at each speed.
std::string JointsSvg(const IdentifyResult& result) {
  BodeFigure figure("The joints, each moved alone");
  for (const AxisResult& joint : result.joints) {
    const std::size_t drawn = figure.size();
    figure.Add(Measured(joint.by_encoders, fmt::format("A{} at {}", joint.request.joint, SpeedText(joint)),
                        report::kPalette[drawn % report::kPalette.size()],
                        drawn < report::kPalette.size() ? report::Marker::kCircle : report::Marker::kSquare));
  }
  return figure.size() == 0 ? "" : figure.Svg();
}

// Draws the lag of the free runs over their RMS speed, a curve per axis; empty if there are no free runs.
std::string LagSvg(const IdentifyResult& result) {
  report::LineChart chart{.title = "Total lag over speed",
                          .x_label = "RMS speed of the tool [mm/s]",
                          .y_label = "lag [ms]",
                          .y_from_zero = false};
  for (std::size_t k = 0; k < 3; ++k) {
    const char axis_name = static_cast<char>('x' + k);
    report::Series series{.name = std::string("along ") + axis_name,
                          .color = report::kPalette[k],
                          .marker = report::Marker::kCircle};
    std::vector<const AxisResult*> axes;
    for (const AxisResult& axis : result.axes)
      if (axis.request.axis == axis_name && !axis.request.held) axes.push_back(&axis);
    std::ranges::sort(axes, {}, &AxisResult::rms_speed_m_per_s);
    for (const AxisResult* axis : axes) {
      const Estimate& lag = axis->fit.lag_s;
      series.x.push_back(1e3 * axis->rms_speed_m_per_s);
      series.y.push_back(1e3 * lag.value);
      series.y_low.push_back(1e3 * (lag.value - lag.half_width));
      series.y_high.push_back(1e3 * (lag.value + lag.half_width));
    }
    if (!series.x.empty()) chart.series.push_back(std::move(series));
  }
  return chart.series.empty() ? "" : report::Svg(chart);
}

// Draws the hand's stiffness in each counted period, a curve per held run; empty if there are no held runs.
std::string HandSvg(const IdentifyResult& result) {
  report::LineChart chart{
      .title = "The hand's stiffness over time", .x_label = "counted time [s]", .y_label = "stiffness [N/m]"};
  for (const AxisResult& axis : result.axes) {
    if (axis.hand_windows.empty()) continue;
    report::Series series{.name = NameOf(axis.request),
                          .color = report::kPalette[chart.series.size() % report::kPalette.size()],
                          .marker = report::Marker::kCircle};
    for (const HandWindow& window : axis.hand_windows) {
      const Estimate& stiffness = window.stiffness_N_per_m;
      series.x.push_back(window.from_s);
      series.y.push_back(stiffness.value);
      series.y_low.push_back(stiffness.value - stiffness.half_width);
      series.y_high.push_back(stiffness.value + stiffness.half_width);
    }
    chart.series.push_back(std::move(series));
  }
  return chart.series.empty() ? "" : report::Svg(chart);
}

}  // namespace

std::string IdentifyPage(const IdentifyResult& result, const std::string& command_line) {
  report::ReportVerdict verdict = Judge(result).ForReport();
  verdict.text = !result.refused.empty()   ? "refused: nothing was written"
                 : !GainsStand(result)     ? "measured: the present gains are unstable"
                 : verdict.level == "good" ? "measured"
                 : verdict.level == "look" ? "measured, with remarks"
                                           : "nothing was measured";
  std::string html = report::PageBegin(
      {.title = "Osteon identify",
       .subtitle = result.cell + ": " + result.valid_for.robot + ", " + result.valid_for.tool,
       .verdict = verdict,
       .summary = Rows(result)});
  if (const std::string lag = LagSvg(result); !lag.empty())
    html +=
        report::Figure(lag, "A gain that stands the longest lag stands the others. Bars: 95 % intervals.");
  for (const AxisResult& axis : result.axes)
    html += report::Figure(BodeSvg(axis, result.valid_for.period_s),
                           "Bars: two standard deviations, from period to period and from draw to draw.");
  if (const std::string joints = JointsSvg(result); !joints.empty())
    html += report::Figure(
        joints, "Angle by its command, by each joint's own encoder. Bars: two standard deviations.");
  if (!result.nyquist_svg.empty())
    html +=
        report::Figure(result.nyquist_svg,
                       "The loop of hand, present gains and measured arm, for the hand that is nearest to "
                       "instability. A curve around -1 is an oscillation that grows.");
  if (const std::string hands = HandSvg(result); !hands.empty())
    html += report::Figure(hands, "Each point is 4 s of a held run. Bars: 95 % intervals.");
  html += fmt::format("<footer><code>{}</code></footer>\n", report::Escape(command_line));
  return html + report::PageEnd();
}

}  // namespace osteon::studies
