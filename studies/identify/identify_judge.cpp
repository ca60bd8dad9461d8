#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "control/excitation/multisine.h"
#include "studies/identify/identify_joints.h"
#include "studies/identify/identify_result.h"

// Decides which results are refused, and what the user is told. The limits are those of design and
// documentation.

namespace osteon::studies {
namespace {

// Measured mass, as a factor on the tool's mass, above which a hand holds the handle.
constexpr double kHeldFactor = 1.5;
// Accepted relative difference of the measured mass from the tool's mass.
constexpr double kMaxMassOff = 0.05;
// A joint sticks below this gain, or above this damping ratio.
constexpr double kMinGain = 0.98, kMaxDamping = 3.0;
// Friction is the cause if the odd lines' level exceeds the even lines' by this factor.
constexpr double kOddOverEven = 3.0;
constexpr double kVeryOdd = 0.1;        // share of the motion on odd lines above which a run is refused
constexpr double kMaxChi2 = 3.0;        // largest chi² of a model that fits
constexpr double kMaxValidation = 2.0;  // largest chi² of a validation, as a factor on the fit's chi²
// Smaller: no hand held the handle; larger: more than a tremor.
constexpr double kMinTremor_N = 0.005, kMaxTremor_N = 50.0;
// Largest relative half widths of an overlay's fit. That of the damping is wider, since friction hides a part
// of the damping.
constexpr double kMaxMassInterval = 0.1, kMaxSpringInterval = 0.15, kMaxDampingInterval = 0.25,
                 kMaxResidual = 0.02;
constexpr double kMaxLagInterval_s = 0.12e-3;  // largest half width of the lag
constexpr double kMinCoherence = 0.5;
constexpr double kMaxLost = 0.10;          // largest share of lost messages or answers
constexpr double kPassiveHand_N = 5.0;     // larger: a hand held the handle in a motion without excitation
constexpr double kSamePosture_rad = 0.02;  // largest joint difference from the cell's start
constexpr double kMinHand_N_per_m = 50.0;  // smaller stiffness: nobody holds the handle

// The line nearest to a frequency.
const ResponseLine& LineAt(const MeasuredResponse& response, double hz) {
  return *std::ranges::min_element(response.lines, {},
                                   [hz](const ResponseLine& line) { return std::abs(line.hz - hz); });
}

// Refuses a held run in which no hand holds the handle, and a free run in which a hand or another tool adds
// to the mass.
void JudgeMass(const AxisResult& axis, const std::string& where, IdentifyResult& result) {
  if (axis.request.held) {
    const double stiffness_N_per_m = axis.hand ? axis.hand->stiffness_N_per_m.value : 0.0;
    if (!(stiffness_N_per_m >= kMinHand_N_per_m))
      result.refused.push_back(
          {where, fmt::format("nobody holds the handle: found {:.0f} N/m, accepted {:g} N/m or "
                              "more; hold it at working push during the whole run",
                              stiffness_N_per_m, kMinHand_N_per_m)});
    return;
  }
  if (!axis.tool) {
    result.warnings.push_back({where, axis.no_tool + "; whether a hand holds the handle was not checked"});
    return;
  }
  const double mass_kg = axis.tool->mass_kg.value;
  // A force on the arm also turns the tool, so the sensor does not measure the tool's whole mass.
  if (axis.overlay && mass_kg < kHeldFactor * result.tool_mass_kg) return;
  if (!(std::abs(mass_kg - result.tool_mass_kg) <= kMaxMassOff * result.tool_mass_kg))
    result.refused.push_back(
        {where,
         fmt::format("somebody holds the handle, or another tool: found {:.3f} kg on the sensor, accepted "
                     "{:.3f} kg ± {:g} %; let go of the handle, or run osteon calibrate",
                     mass_kg, result.tool_mass_kg, 100.0 * kMaxMassOff)});
}

// Refuses a run in which a joint sticks. Warns of friction, and refuses a motion with too much friction.
void JudgeLinearity(AxisResult& axis, const std::string& where, IdentifyResult& result) {
  const MeasuredResponse& response = axis.by_encoders;
  // A held run's gain is not checked: if the hand moves the arm, the gain depends on the springs of arm and
  // hand.
  const double gain = std::abs(response.lines.front().value);
  // An overlay's gain is not checked: it follows from the arm's own spring, which is to be estimated.
  const double damping = axis.overlay ? axis.overlay->damping_ratio.value : axis.fit.damping_ratio.value;
  if (!axis.request.held && ((gain < kMinGain && !axis.overlay) || damping > kMaxDamping))
    result.refused.push_back(
        {where,
         fmt::format("the joint sticks: found a gain of {:.3f} at {:g} Hz and a damping ratio of {:.2f}, "
                     "accepted {:g} or more and at most {:g}; raise the speed",
                     gain, response.lines.front().hz, damping, kMinGain, kMaxDamping)});
  if (!(response.odd_ratio > kOddOverEven * response.even_ratio && response.odd_ratio > kNotLinear)) return;
  const std::string found = fmt::format(
      "not linear at this speed: found {:.1f} % of the motion on odd lines that were not excited, {:.1f} % "
      "on even ones",
      100.0 * response.odd_ratio, 100.0 * response.even_ratio);
  if (response.odd_ratio > kVeryOdd)
    result.refused.push_back(
        {where, fmt::format("{}, accepted {:g} %; raise the speed", found, 100.0 * kVeryOdd)});
  else
    result.warnings.push_back({where, found + ": friction; the figures hold near this speed alone"});
}

// Refuses a run that is too short: the interval of mass or lag is too wide. The factor by which a bad model
// widens the interval is removed before, since more data would not reduce it.
void JudgeAmount(const AxisResult& axis, const std::string& where, IdentifyResult& result) {
  const double misfit = std::sqrt(std::max(1.0, axis.overlay ? axis.overlay->chi2 : axis.fit.chi2));
  const double seconds = control::Multisine::kPeriod_s * axis.by_encoders.periods;
  if (axis.overlay) {
    const Estimate& mass = axis.overlay->mass_kg;
    const double relative = mass.half_width / misfit / std::abs(mass.value);
    if (!(relative <= kMaxMassInterval))
      result.refused.push_back(
          {where, fmt::format("too little: found {:g} s with a mass known to ± {:.1f} %, accepted ± {:g} %; "
                              "measure longer or faster",
                              seconds, 100.0 * relative, 100.0 * kMaxMassInterval)});
    return;
  }
  const double lag_interval_s = axis.fit.lag_s.half_width / misfit;
  if (lag_interval_s > kMaxLagInterval_s)
    result.refused.push_back(
        {where,
         fmt::format("too little: found {:g} s with a lag known to ± {:.3f} ms, accepted ± {:g} ms; measure "
                     "longer or faster",
                     seconds, 1e3 * lag_interval_s, 1e3 * kMaxLagInterval_s)});
}

// Warns if spring, damper and mass fit the hand badly. Its intervals are then wider.
void JudgeHand(const AxisResult& axis, const std::string& where, IdentifyResult& result) {
  if (!(axis.hand->chi2 > kMaxChi2)) return;
  result.warnings.push_back(
      {where, fmt::format("a hand unlike spring, damper and mass: found chi² {:.1f}, {:.1f} % off, accepted "
                          "{:g}; its intervals are wider by it; hold the handle evenly, and measure again",
                          axis.hand->chi2, 100.0 * axis.hand->residual, kMaxChi2)});
}

// Clears model_holds, with a warning, if an overlay's model fits badly, or its spring or damping is not known
// well. Then only the measured response is written.
void JudgeImpedance(AxisResult& axis, const std::string& where, IdentifyResult& result) {
  const ImpedanceFit& fit = *axis.overlay;
  const auto reject_model = [&](const std::string& found) {
    axis.model_holds = false;
    result.warnings.push_back({where, found + ": the measured response alone is written"});
  };
  if (fit.residual > kMaxResidual && fit.chi2 > kMaxChi2)
    reject_model(
        fmt::format("the arm's model lacks something: found it {:.1f} % off with chi² {:.1f}, accepted {:g} "
                    "% or {:g}",
                    100.0 * fit.residual, fit.chi2, 100.0 * kMaxResidual, kMaxChi2));
  else if (axis.validation_chi2 && *axis.validation_chi2 > kMaxValidation * std::max(1.0, fit.chi2))
    reject_model(
        fmt::format("the arm's model does not hold on other data: found chi² {:.1f}, accepted {:.1f}",
                    *axis.validation_chi2, kMaxValidation * std::max(1.0, fit.chi2)));
  else if (const double spring = fit.stiffness_N_per_m.half_width / fit.stiffness_N_per_m.value,
           damping = fit.damping_Ns_per_m.half_width / fit.damping_Ns_per_m.value;
           !(spring <= kMaxSpringInterval && damping <= kMaxDampingInterval))
    reject_model(fmt::format(
        "spring and damping are not known well: found ± {:.0f} % and ± {:.0f} %, accepted ± {:g} % "
        "and ± {:g} %",
        100.0 * spring, 100.0 * damping, 100.0 * kMaxSpringInterval, 100.0 * kMaxDampingInterval));
}

}  // namespace

std::string NameOf(const ExcitationRequest& request) {
  if (request.joint > 0)
    return fmt::format("free run, joint A{} at {:g} deg/s", request.joint,
                       Degrees(request.peak_speed_m_per_s));
  return fmt::format("{}{} run, {} at {:g} mm/s", request.held ? "held" : "free",
                     request.overlay ? " overlay" : "", request.axis, 1e3 * request.peak_speed_m_per_s);
}

void JudgeAxis(AxisResult& axis, IdentifyResult& result) {
  const std::string where = NameOf(axis.request);
  if (const double lost = LossOf(axis.samples); lost > kMaxLost)
    result.refused.push_back(
        {where, fmt::format("the link loses too much: found {:.1f} % of messages and answers "
                            "lost, accepted {:g} %; see osteon doctor",
                            100.0 * lost, 100.0 * kMaxLost)});
  if (axis.samples.start_error_rad > kSamePosture_rad)
    result.refused.push_back(
        {where, fmt::format("another posture: found a joint {:.3f} rad from the cell's start, "
                            "accepted {:g} rad",
                            axis.samples.start_error_rad, kSamePosture_rad)});
  if (axis.request.joint == 0) JudgeMass(axis, where, result);
  JudgeLinearity(axis, where, result);
  JudgeAmount(axis, where, result);
  if (const ResponseLine& line =
          LineAt(axis.by_encoders, axis.crossing_hz.value_or(axis.fit.bandwidth_hz.value));
      line.coherence < kMinCoherence)
    result.refused.push_back(
        {where,
         fmt::format("excite higher: found a coherence of {:.2f} at {:g} Hz, where {}, accepted {:g}",
                     line.coherence, line.hz,
                     axis.crossing_hz ? "the loop's gain is 1" : "the arm's bandwidth lies", kMinCoherence)});
  if (axis.hand) JudgeHand(axis, where, result);
  if (axis.overlay) return JudgeImpedance(axis, where, result);
  // with a hand the response is not the arm's alone; the free run has the arm's model
  if (axis.request.held) return;
  const bool validated =
      !axis.validation_chi2 || *axis.validation_chi2 <= kMaxValidation * std::max(1.0, axis.fit.chi2);
  axis.model_holds = axis.fit.chi2 <= kMaxChi2 && validated;
  if (!axis.model_holds)
    result.warnings.push_back(
        {where,
         fmt::format(
             "structure that the model lacks: found chi² {:.1f}{}, accepted {:g}{}; {}", axis.fit.chi2,
             axis.validation_chi2 ? fmt::format(" and {:.1f} on other data", *axis.validation_chi2) : "",
             kMaxChi2, validated ? "" : " and twice as much on other data",
             axis.request.joint > 0 ? "the joint's response counts, not its figures"
                                    : "margins by the measured response only")});
}

void JudgePassive(IdentifyResult& result) {
  for (const PassiveLag& passive : result.passive)
    if (passive.peak_hand_N > kPassiveHand_N)
      result.warnings.push_back(
          {passive.recording.file,
           fmt::format(
               "no hand is fitted: found a hand's force of {:.0f} N with the law on, where force over "
               "motion is the robot's impedance; accepted for a hand is a run with --do held",
               passive.peak_hand_N)});
}

bool GainsStand(const IdentifyResult& result) {
  return std::ranges::none_of(result.margins, [](const TuneMargin& margin) {
    return !margin.margins.stable && margin.contact != TuneContact::kPlanes;
  });
}

std::string NextStep(const IdentifyResult& result) {
  if (!result.refused.empty())
    return "mend what the first reason names, and measure again; nothing was written";
  if (!GainsStand(result))
    return "run no cell with these gains: osteon tune CELL --identified identified.yaml recommends others";
  if (!result.axes.empty())
    return "osteon tune CELL --identified identified.yaml recommends gains for what was measured";
  if (result.noise || result.tremor || !result.passive.empty() || !result.joints.empty())
    return "osteon identify CELL --do free,validate measures the arm, by which gains are judged";
  return "nothing was measured: osteon identify CELL with another run (--do), or with a recording";
}

void JudgeTremor(IdentifyResult& result) {
  if (!result.tremor) return;
  const HandTremor& tremor = *result.tremor;
  if (tremor.seconds <= 0.0 || tremor.tremor_N <= 0.0)
    result.refused.push_back(
        {"tremor run",
         fmt::format("too little: found {:.1f} s at rest, accepted 5 s or more", tremor.seconds)});
  else if (!(tremor.p999_N >= kMinTremor_N))
    result.refused.push_back(
        {"tremor run",
         fmt::format("nobody holds the handle: found {:.4f} N between 5 and 40 Hz, accepted {:g} N or more; "
                     "hold it at working push during the whole run",
                     tremor.p999_N, kMinTremor_N)});
  else if (tremor.tremor_N > kMaxTremor_N)
    result.refused.push_back(
        {"tremor run", fmt::format("more than a tremor: found {:.2f} N between 5 and 40 Hz, accepted at most "
                                   "{:g} N; the arm must stand, and the hand must rest",
                                   tremor.tremor_N, kMaxTremor_N)});
}

namespace {

// Warns of each axis or joint whose lags at two speeds differ by more than 5 %.
// @param runs  axes, or joints, at all their speeds
void JudgeSpeedsOf(const std::vector<AxisResult>& runs, IdentifyResult& result) {
  for (const AxisResult& slow : runs)
    for (const AxisResult& fast : runs) {
      if (slow.request.axis != fast.request.axis || slow.request.joint != fast.request.joint ||
          slow.request.held || fast.request.held)
        continue;
      if (!(slow.rms_speed_m_per_s < fast.rms_speed_m_per_s)) continue;
      const double slow_s = slow.fit.lag_s.value, fast_s = fast.fit.lag_s.value;
      if (std::abs(slow_s - fast_s) > kMaxLagApart * std::abs(slow_s))
        result.warnings.push_back(
            {NameOf(slow.request),
             fmt::format("friction: found a lag of {:.2f} ms here and {:.2f} ms at {}, accepted 5 % apart; "
                         "the slower one {}",
                         1e3 * slow_s, 1e3 * fast_s, SpeedText(fast),
                         slow.request.joint > 0 ? "counts" : "is written")});
    }
}

}  // namespace

void JudgeSpeeds(IdentifyResult& result) {
  JudgeSpeedsOf(result.axes, result);
  JudgeSpeedsOf(result.joints, result);
}

session::Verdict Judge(const IdentifyResult& result) {
  session::Verdict verdict;
  for (const Finding& finding : result.refused)
    verdict.Add(session::VerdictLevel::kBad, finding.where + ": " + finding.what);
  for (const Finding& finding : result.warnings)
    verdict.Add(session::VerdictLevel::kWarning, finding.where + ": " + finding.what);
  if (const TuneMargin* worst = WorstOf(result.margins, "own");
      worst != nullptr && !IsStableByMargins(result.margins, "own"))
    verdict.Add(GainsStand(result) ? session::VerdictLevel::kWarning : session::VerdictLevel::kBad,
                "by the measured response the cell's present gains are " + MarginText(*worst));
  if (result.axes.empty() && result.joints.empty() && result.refused.empty())
    verdict.Add(result.passive.empty() && !result.noise && !result.tremor ? session::VerdictLevel::kBad
                                                                          : session::VerdictLevel::kWarning,
                "no arm was fitted: no recording with excitation");
  return verdict;
}

}  // namespace osteon::studies
