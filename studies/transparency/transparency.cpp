#include "studies/transparency/transparency.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "base/phase_progress.h"
#include "config/reading/apply_identified.h"
#include "config/reading/load.h"
#include "report/svg_plot.h"
#include "session/process/exit_code.h"
#include "session/summary/chart_files.h"
#include "session/summary/summary.h"

namespace osteon::studies {
namespace {

using Complex = std::complex<double>;

constexpr double kTau = 2.0 * std::numbers::pi;
constexpr std::array<const char*, 6> kAxes{"x", "y", "z", "about x", "about y", "about z"};
constexpr std::array<const char*, 3> kColors{"#0072b2", "#d55e00", "#009e73"};
constexpr const char* kAskedColor = "#777777";
// Largest travel, speed and wrench of the excitation: small compared with a joint's range, large compared
// with rounding.
constexpr double kTravel_m = 0.005, kSpeed_m_per_s = 0.05, kWrench_N = 20.0;
constexpr double kTravel_rad = 0.02, kSpeed_rad_per_s = 0.2, kWrench_Nm = 2.0;
// Bounds of the error relative to the requested impedance. Above kNoticed (stiffness in contact) or
// kNoticedFree (rms in free motion), a hand may notice the error. Above kSomethingElse, the error is as large
// as the request, so the hand feels something else than the request. Source: a hand notices differences of
// stiffness above about 23 % (L. A. Jones and I. W. Hunter, Exp. Brain Res. 79, 1990), and of damping above
// 19 % (Jones, Hunter, Lafontaine, Perception 26, 1997, by forced choice; 34 % when one arm is matched with
// the other, 1993).
constexpr double kNoticed = 0.23, kNoticedFree = 0.19, kSomethingElse = 1.0;
// Mean and amplitude of the hand's force in contact, as fractions of the cell's force limit.
constexpr double kPreload = 0.3, kSwing = 0.1;

// The measured frequencies [Hz], evenly spaced in the logarithm.
std::vector<double> Frequencies(int count) {
  std::vector<double> hz;
  const double ratio = kTransparencyMax_hz / kTransparencyMin_hz;
  for (int i = 0; i < count; ++i)
    hz.push_back(kTransparencyMin_hz * std::pow(ratio, static_cast<double>(i) / (count - 1)));
  return hz;
}

// Parameters of the test bench: the cell's own loop and simulated arm at the cell's start.
HandleBenchParams BenchOf(const config::CellConfig& cell, const TransparencyOptions& options) {
  HandleBenchParams bench;
  bench.servo = cell.servo;
  bench.arm = hil::BodyOf(cell.simulated);
  bench.X_WB = cell.X_WB;
  bench.X_FT = cell.tool.X_FT;
  bench.arm_angle_rad = cell.start.arm_angle_rad;
  bench.sensor_feels_inertia = cell.simulated.sensor_feels_inertia;
  bench.servo.admittance.locked = {};  // an axis that the cell locks is measured as if it were free
  bench.sensor_delay_ticks = options.sensor_delay_ticks;
  return bench;
}

double PhaseDegrees(const Complex& z) { return std::arg(z) * 360.0 / kTau; }

// The impedance that law and coupling together request while the tool touches the plane.
Complex AskedInContact(const TransparencyResult& result, const HandlePoint& point) {
  const TransparencyAxis& z = result.axes[2];
  const double w = kTau * point.frequency_hz;
  return {z.asked_drag + result.asked_damping_Ns_per_m,
          w * z.asked_mass - result.asked_stiffness_N_per_m / w};
}

// Unwraps the phase: removes jumps of a whole turn between neighbouring frequencies.
report::Series Unwrapped(report::Series series) {
  for (std::size_t i = 1; i < series.y.size(); ++i)
    series.y[i] -= 360.0 * std::round((series.y[i] - series.y[i - 1]) / 360.0);
  return series;
}

// A curve that shows one value of each point over the point's frequency.
report::Series Curve(const std::string& name, const std::string& color,
                     const std::vector<HandlePoint>& points,
                     const std::function<double(const HandlePoint&)>& value, double opacity = 1.0) {
  report::Series series{.name = name, .color = color, .opacity = opacity};
  for (const HandlePoint& point : points) {
    series.x.push_back(point.frequency_hz);
    series.y.push_back(value(point));
  }
  return series;
}

// Draws magnitude and phase of the measured and the requested impedance: first in free motion, then in
// contact.
std::string PlotSvg(const TransparencyResult& result) {
  std::array<report::LineChart, 4> panels{
      report::LineChart{.title = "Free motion, along the tool's axes", .y_label = "|F/v| [N s/m]"},
      report::LineChart{.y_label = "phase [deg]", .y_from_zero = false, .legend = false},
      report::LineChart{.title = fmt::format("In contact along z: {:g} N/mm, {:.0f} N ± {:.0f} N",
                                             1e-3 * result.asked_stiffness_N_per_m, result.preload_N,
                                             result.contact_amplitude_N),
                        .y_label = "|F/v| [N s/m]"},
      report::LineChart{
          .x_label = "frequency [Hz]", .y_label = "phase [deg]", .y_from_zero = false, .legend = false}};
  for (report::LineChart& panel : panels) {
    panel.log_x = true;
    panel.plot_height_px = 160.0;
  }
  panels[0].log_y = panels[2].log_y = true;
  // the three curves may coincide: z is drawn solid, y dashed and x dotted on top, so that each is visible
  constexpr std::array<const char*, 3> kDash{"0.1 14", "12 26", ""};
  constexpr std::array<double, 3> kWidth_px{4.4, 2.8, 1.8};
  for (const std::size_t i : {2u, 1u, 0u}) {
    const TransparencyAxis& axis = result.axes[i];
    report::Series magnitude =
        Curve(kAxes[i], kColors[i], axis.points, [](const auto& point) { return std::abs(point.impedance); });
    report::Series phase = Unwrapped(Curve(kAxes[i], kColors[i], axis.points,
                                           [](const auto& point) { return PhaseDegrees(point.impedance); }));
    magnitude.width_px = phase.width_px = kWidth_px[i];
    magnitude.dash = phase.dash = kDash[i];
    panels[0].series.push_back(std::move(magnitude));
    panels[1].series.push_back(std::move(phase));
  }
  const auto asked = [&](const HandlePoint& point) {
    return Complex(result.axes[2].asked_drag, kTau * point.frequency_hz * result.axes[2].asked_mass);
  };
  const auto contact = [&](const HandlePoint& point) { return AskedInContact(result, point); };
  panels[0].series.push_back(Curve("asked for (z)", kAskedColor, result.axes[2].points,
                                   [&](const auto& point) { return std::abs(asked(point)); }));
  panels[1].series.push_back(Unwrapped(Curve("asked for (z)", kAskedColor, result.axes[2].points,
                                             [&](const auto& point) { return PhaseDegrees(asked(point)); })));
  panels[2].series = {
      Curve("z", kColors[2], result.contact, [](const auto& point) { return std::abs(point.impedance); }),
      Curve("asked for", kAskedColor, result.contact,
            [&](const auto& point) { return std::abs(contact(point)); })};
  panels[3].series = {Unwrapped(Curve("z", kColors[2], result.contact,
                                      [](const auto& point) { return PhaseDegrees(point.impedance); })),
                      Unwrapped(Curve("asked for", kAskedColor, result.contact,
                                      [&](const auto& point) { return PhaseDegrees(contact(point)); }))};
  return report::Svg(panels);
}

// One point's measured and requested figures as JSON. @param mode  "free" or "contact"
nlohmann::ordered_json PointJson(const char* mode, const char* axis, const HandlePoint& point,
                                 const Complex& asked) {
  const double w = kTau * point.frequency_hz;
  return {{"mode", mode},
          {"axis", axis},
          {"frequency_hz", point.frequency_hz},
          {"magnitude", std::abs(point.impedance)},
          {"phase_deg", PhaseDegrees(point.impedance)},
          {"asked_magnitude", std::abs(asked)},
          {"asked_phase_deg", PhaseDegrees(asked)},
          {"drag", point.impedance.real()},
          {"reactance", point.impedance.imag()},
          {"stiffness", (point.impedance * Complex(0.0, w)).real()},
          {"travel", point.travel},
          {"harmonics", point.harmonics}};
}

nlohmann::ordered_json ToJson(const TransparencyResult& result, const TransparencyOptions& options) {
  nlohmann::ordered_json axes = nlohmann::ordered_json::array(), points = nlohmann::ordered_json::array();
  for (const TransparencyAxis& axis : result.axes) {
    const char* name = kAxes[static_cast<std::size_t>(axis.axis)];
    const bool turns = axis.axis >= 3;
    axes.push_back({{"axis", name},
                    {turns ? "asked_inertia_kg_m2" : "asked_mass_kg", axis.asked_mass},
                    {turns ? "apparent_inertia_kg_m2" : "apparent_mass_kg", axis.fit.mass},
                    {turns ? "asked_drag_Nms_per_rad" : "asked_drag_Ns_per_m", axis.asked_drag},
                    {turns ? "drag_Nms_per_rad" : "drag_Ns_per_m", axis.fit.drag},
                    {"residual", axis.residual}});
    for (const HandlePoint& point : axis.points)
      points.push_back(
          PointJson("free", name, point, {axis.asked_drag, kTau * point.frequency_hz * axis.asked_mass}));
  }
  for (const HandlePoint& point : result.contact)
    points.push_back(PointJson("contact", kAxes[2], point, AskedInContact(result, point)));
  return {{"schema", "osteon.transparency/1"},
          {"cell", result.cell},
          {"apparent_mass_kg", result.apparent_mass_kg()},
          {"drag_Ns_per_m", result.drag_Ns_per_m()},
          {"free_residual", result.free_residual()},
          {"fit_to_hz", kTransparencyFit_hz},
          {"stiffness_N_per_m", result.stiffness_N_per_m},
          {"asked_stiffness_N_per_m", result.asked_stiffness_N_per_m},
          {"sensor_delay_ticks", options.sensor_delay_ticks},
          {"fault", result.fault()},
          {"axes", axes},
          {"points", points},
          {"command", options.command_line}};
}

std::string ToCsv(const TransparencyResult& result) {
  std::string csv = "mode,axis,frequency_hz,impedance_real,impedance_imag,travel,harmonics\n";
  const auto add = [&](const char* mode, const char* axis, const HandlePoint& point) {
    csv += fmt::format("{},{},{:.6g},{:.9g},{:.9g},{:.6g},{:.3g}\n", mode, axis, point.frequency_hz,
                       point.impedance.real(), point.impedance.imag(), point.travel, point.harmonics);
  };
  for (const TransparencyAxis& axis : result.axes)
    for (const HandlePoint& point : axis.points)
      add("free", kAxes[static_cast<std::size_t>(axis.axis)], point);
  for (const HandlePoint& point : result.contact) add("contact", kAxes[2], point);
  return csv;
}

// Mass and drag of each axis, requested and measured, in free motion; the first row is the heading.
std::vector<std::vector<std::string>> FreeMotionTable(const TransparencyResult& result) {
  std::vector<std::vector<std::string>> rows{
      {"axis", "mass asked", "felt", "drag asked", "felt", "residual [%]"}};
  for (const TransparencyAxis& axis : result.axes) {
    const bool turns = axis.axis >= 3;
    const char* mass = turns ? "{:.3f} kg m²" : "{:.2f} kg";
    const char* drag = turns ? "{:.2f} N m s" : "{:.1f} N s/m";
    rows.push_back(
        {kAxes[static_cast<std::size_t>(axis.axis)], fmt::format(fmt::runtime(mass), axis.asked_mass),
         fmt::format(fmt::runtime(mass), axis.fit.mass), fmt::format(fmt::runtime(drag), axis.asked_drag),
         fmt::format(fmt::runtime(drag), axis.fit.drag), fmt::format("{:.1f}", 100.0 * axis.residual)});
  }
  return rows;
}

void PrintResult(const TransparencyResult& result) {
  fmt::print("Osteon transparency: {}\n", result.cell);
  session::PrintVerdict(Judge(result), 12);
  for (const std::vector<std::string>& row : FreeMotionTable(result))
    fmt::print("  {:<10} {:>13} {:>13} {:>13} {:>13} {:>13}\n", row[0], row[1], row[2], row[3], row[4],
               row[5]);
  fmt::print("  In contact   {:.2f} N/mm felt, {:.2f} N/mm asked for\n", 1e-3 * result.stiffness_N_per_m,
             1e-3 * result.asked_stiffness_N_per_m);
  fmt::print("  Residual     {:.1f} % of the impedance asked for, {:g} … {:g} Hz, worst of x y z\n",
             100.0 * result.free_residual(), kTransparencyMin_hz, kTransparencyFit_hz);
}

}  // namespace

double TransparencyResult::free_residual() const {
  return std::max({axes[0].residual, axes[1].residual, axes[2].residual});
}
double TransparencyResult::apparent_mass_kg() const {
  return std::max({axes[0].fit.mass, axes[1].fit.mass, axes[2].fit.mass});
}
double TransparencyResult::drag_Ns_per_m() const {
  return std::max({axes[0].fit.drag, axes[1].fit.drag, axes[2].fit.drag});
}
bool TransparencyResult::fault() const {
  const auto any = [](const std::vector<HandlePoint>& points) {
    return std::any_of(points.begin(), points.end(), [](const auto& point) { return point.fault; });
  };
  return any(contact) ||
         std::any_of(axes.begin(), axes.end(), [&](const auto& axis) { return any(axis.points); });
}

session::Verdict Judge(const TransparencyResult& result) {
  session::Verdict verdict;
  if (result.fault())
    verdict.Add(session::VerdictLevel::kBad, "the loop stopped with a fault: the figures are void");
  const double free = result.free_residual();
  if (!(free <= kNoticedFree))
    verdict.Add(
        free <= kSomethingElse ? session::VerdictLevel::kWarning : session::VerdictLevel::kBad,
        fmt::format(
            "in free motion the handle feels {:.0f} % off what the law asks for, a hand notices {:.0f} %: "
            "{:.2f} kg for {:.2f} kg, {:.1f} N s/m for {:.1f} N s/m at most",
            100.0 * free, 100.0 * kNoticedFree, result.apparent_mass_kg(), result.axes[2].asked_mass,
            result.drag_Ns_per_m(), result.axes[2].asked_drag));
  const double stiffness = std::abs(result.stiffness_N_per_m / result.asked_stiffness_N_per_m - 1.0);
  if (!(stiffness <= kNoticed))
    verdict.Add(stiffness <= kSomethingElse ? session::VerdictLevel::kWarning : session::VerdictLevel::kBad,
                fmt::format("in contact the hand feels {:.2f} N/mm for {:.2f} N/mm",
                            1e-3 * result.stiffness_N_per_m, 1e-3 * result.asked_stiffness_N_per_m));
  return verdict;
}

TransparencyResult MeasureTransparency(const config::CellConfig& cell, const TransparencyOptions& options) {
  const HandleBenchParams bench = BenchOf(cell, options);
  const control::AdmittanceParams& law = cell.servo.admittance;
  TransparencyResult result;
  result.cell = options.cell.stem().string();
  base::PhaseProgress progress("osteon transparency", 7);
  for (int i = 0; i < 6; ++i) {
    progress.BeginPhase(fmt::format("shaking the handle {} {}", i < 3 ? "along" : "turning",
                                    kAxes[static_cast<std::size_t>(i)]));
    HandleSweep sweep{.axis = i,
                      .frequencies_hz = Frequencies(options.points),
                      .max_travel = kTravel_m,
                      .max_speed = kSpeed_m_per_s,
                      .max_wrench = kWrench_N};
    if (i >= 3) {
      sweep.max_travel = kTravel_rad;
      sweep.max_speed = kSpeed_rad_per_s;
      sweep.max_wrench = kWrench_Nm;
    }
    TransparencyAxis axis{.axis = i, .points = SweepFree(bench, sweep), .fit = {}};
    axis.fit = FitMassAndDrag(axis.points, kTransparencyFit_hz);
    const Complex asked = AskedImpedance(law, i, 1.0);  // drag + j 2π mass: the requested impedance at 1 Hz
    axis.asked_drag = asked.real();
    axis.asked_mass = asked.imag() / kTau;
    double sum = 0.0;
    int count = 0;
    for (const HandlePoint& point : axis.points) {
      if (point.frequency_hz > kTransparencyFit_hz) continue;
      const Complex wanted = AskedImpedance(law, i, point.frequency_hz);
      sum += std::norm(point.impedance - wanted) / std::norm(wanted);
      ++count;
    }
    axis.residual = std::sqrt(sum / std::max(1, count));
    result.axes.push_back(std::move(axis));
  }
  progress.BeginPhase("pressing it against a plane");
  result.asked_stiffness_N_per_m = cell.servo.coupling.max_stiffness_N_per_m;
  result.asked_damping_Ns_per_m = cell.servo.coupling.damping_Ns_per_m;
  result.preload_N = kPreload * cell.servo.wrench.max_force_N;
  result.contact_amplitude_N = kSwing * cell.servo.wrench.max_force_N;
  for (const double hz : Frequencies(options.points))
    result.contact.push_back(Shake(
        bench,
        {.axis = 2, .frequency_hz = hz, .amplitude = result.contact_amplitude_N, .bias = result.preload_N},
        HandleWall{result.asked_stiffness_N_per_m}));
  // at the lowest frequency the impedance in contact is about K / (j w): K is the felt stiffness, w the
  // angular frequency
  const HandlePoint& slowest = result.contact.front();
  result.stiffness_N_per_m = (slowest.impedance * Complex(0.0, kTau * slowest.frequency_hz)).real();
  progress.Done();
  return result;
}

int RunTransparency(const TransparencyOptions& options) {
  if (const std::string wrong = session::ValidateOutputFolder("--out", options.out); !wrong.empty())
    return session::Fail("transparency", wrong);
  config::CellConfig cell = config::LoadCell(options.cell);
  config::RequireSimulation(cell, options.cell);
  if (!options.identified.empty()) config::ApplyIdentified(options.identified, cell);
  if (!cell.robot.lbr())
    return session::Fail(
        "transparency",
        fmt::format("{}: found a {}, accepted an LBR: the simulated arm of the others is not measured here",
                    options.cell.string(), cell.robot.name));
  if (cell.servo.law == control::Law::kImpedance)
    return session::Fail("transparency",
                         fmt::format("{}: found a cell with the impedance law, which asks for no mass and "
                                     "drag to compare with; accepted the admittance law",
                                     options.cell.string()));
  const TransparencyResult result = MeasureTransparency(cell, options);
  const session::Verdict verdict = Judge(result);
  const std::string json = session::ResultText(verdict, ToJson(result, options));
  const auto written = session::WriteChart(
      {.name = "transparency",
       .title = "Transparency of " + result.cell,
       .verdict = verdict.ForReport(),
       .svg = PlotSvg(result),
       .caption =
           "How hard the hand has to push for a speed of the tool (|F/v|), and how far the force is ahead "
           "of the speed (phase), one frequency after the other: as felt at the handle, and as the gains "
           "of the cell ask for. Where the lines lie on each other, the hand feels what was asked for. "
           "The arm's lag is felt as additional mass in free motion (drag times lag) and as damping in "
           "contact (stiffness times lag).",
       .csv = ToCsv(result),
       .json = json,
       .json_copy = options.json,
       .table = FreeMotionTable(result),
       .notes = {fmt::format(
                     "The table: mass and drag that the cell's gains ask for, and those that a hand feels "
                     "at the simulated arm, fitted up to {:g} Hz. The residual says by how much the felt "
                     "force differs from the one asked for at the same motion (root mean square over "
                     "these frequencies); the worst of x, y, z is {:.1f} %.",
                     kTransparencyFit_hz, 100.0 * result.free_residual()),
                 options.command_line}},
      options.out);
  if (!written) return session::Fail("transparency", written.error(), session::kFailed);
  PrintResult(result);
  return verdict.level == session::VerdictLevel::kBad ? session::kFailed : 0;
}

}  // namespace osteon::studies
