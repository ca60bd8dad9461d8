#include "studies/identify/identify_result.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace osteon::app {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kMaxMassOff = 0.05, kMaxLagApart = 0.05, kMinGain = 0.98, kMaxDamping = 3.0;
constexpr double kOddOverEven = 3.0, kMinOdd = 0.01, kVeryOdd = 0.1, kMaxChi2 = 3.0, kMaxValidation = 2.0;
constexpr double kMaxLagInterval_s = 0.12e-3, kMinCoherence = 0.5, kMaxLost = 0.10;
constexpr double kSamePosture_rad = 0.02, kMinHand_N_per_m = 50.0;

config::IdentifiedInterval Interval(const Estimate& estimate) {
  return {.low = estimate.value - estimate.half_width, .high = estimate.value + estimate.half_width};
}

Json ToJson(const Estimate& estimate, double unit) {
  return Json::array(
      {(estimate.value - estimate.half_width) / unit, (estimate.value + estimate.half_width) / unit});
}

double LossOf(const ExcitedSamples& samples) {
  return samples.messages == 0
             ? 0.0
             : static_cast<double>(samples.lost_messages + samples.lost_answers) / samples.messages;
}

// The line nearest to a frequency.
const ResponseLine& LineAt(const MeasuredResponse& response, double hz) {
  return *std::ranges::min_element(response.lines, {},
                                   [hz](const ResponseLine& line) { return std::abs(line.hz - hz); });
}

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
  if (!(std::abs(mass_kg - result.tool_mass_kg) <= kMaxMassOff * result.tool_mass_kg))
    result.refused.push_back(
        {where,
         fmt::format("somebody holds the handle, or another tool: found {:.3f} kg on the sensor, accepted "
                     "{:.3f} kg ± {:g} %; let go of the handle, or run osteon calibrate",
                     mass_kg, result.tool_mass_kg, 100.0 * kMaxMassOff)});
}

void JudgeLinearity(AxisResult& axis, const std::string& where, IdentifyResult& result) {
  const MeasuredResponse& response = axis.by_encoders;
  const double gain = std::abs(response.lines.front().value);
  if (gain < kMinGain || axis.fit.damping_ratio.value > kMaxDamping)
    result.refused.push_back(
        {where,
         fmt::format("the joint sticks: found a gain of {:.3f} at {:g} Hz and a damping ratio of {:.2f}, "
                     "accepted {:g} or more and at most {:g}; raise the speed",
                     gain, response.lines.front().hz, axis.fit.damping_ratio.value, kMinGain, kMaxDamping)});
  if (!(response.odd_ratio > kOddOverEven * response.even_ratio && response.odd_ratio > kMinOdd)) return;
  const std::string found = fmt::format(
      "not linear at this speed: found {:.1f} % of the motion on odd lines that were not excited, {:.1f} % "
      "on even "
      "ones",
      100.0 * response.odd_ratio, 100.0 * response.even_ratio);
  if (response.odd_ratio > kVeryOdd)
    result.refused.push_back(
        {where, fmt::format("{}, accepted {:g} %; raise the speed", found, 100.0 * kVeryOdd)});
  else
    result.warnings.push_back({where, found + ": friction; the figures hold near this speed alone"});
}

Json LinesJson(const MeasuredResponse& response, const char* by) {
  Json lines = Json::array();
  for (const ResponseLine& line : response.lines)
    lines.push_back({{"hz", line.hz},
                     {"re", line.value.real()},
                     {"im", line.value.imag()},
                     {"sd", line.sd},
                     {"coherence", line.coherence},
                     {"draw_coherence", line.draw_coherence},
                     {"by", by}});
  return lines;
}

Json AxisJson(const AxisResult& axis) {
  const ServoFit& fit = axis.fit;
  Json json{{"axis", std::string(1, axis.request.axis)},
            {"held", axis.request.held},
            {"speed_mm_per_s", 1e3 * axis.rms_speed_m_per_s},
            {"peak_speed_mm_per_s", 1e3 * axis.request.peak_speed_m_per_s},
            {"hz", fit.bandwidth_hz.value},
            {"damping_ratio", fit.damping_ratio.value},
            {"dead_time_ms", 1e3 * fit.dead_time_s.value},
            {"lag_ms", 1e3 * fit.lag_s.value},
            {"gain", fit.gain.value},
            {"interval",
             {{"hz", ToJson(fit.bandwidth_hz, 1.0)},
              {"damping_ratio", ToJson(fit.damping_ratio, 1.0)},
              {"dead_time_ms", ToJson(fit.dead_time_s, 1e-3)},
              {"lag_ms", ToJson(fit.lag_s, 1e-3)}}},
            {"chi2", fit.chi2},
            {"residual", fit.residual},
            {"odd_ratio", axis.by_encoders.odd_ratio},
            {"even_ratio", axis.by_encoders.even_ratio},
            {"model_holds", axis.model_holds},
            {"recording", axis.recording.file},
            {"frf", LinesJson(axis.by_encoders, "encoders")}};
  if (axis.by_force)
    for (const Json& line : LinesJson(*axis.by_force, "force")) json["frf"].push_back(line);
  return json;
}

Json FindingsJson(const std::vector<Finding>& findings) {
  Json list = Json::array();
  for (const Finding& finding : findings) list.push_back({{"run", finding.where}, {"message", finding.what}});
  return list;
}

// Adds what an axis gives beside itself: sensor, structure, hand, link, validation.
void AddAxisJson(const AxisResult& axis, Json& json) {
  json["axes"].push_back(AxisJson(axis));
  if (axis.tool) {
    json["sensor"] = {{"delay_ms", 1e3 * axis.tool->delay_s.value},
                      {"delay_interval_ms", ToJson(axis.tool->delay_s, 1e-3)},
                      {"tool_mass_kg", axis.tool->mass_kg.value},
                      {"tool_mass_interval_kg", ToJson(axis.tool->mass_kg, 1.0)}};
    if (const auto& resonance = axis.tool->resonance)
      json["structure"].push_back({{"axis", std::string(1, axis.request.axis)},
                                   {"hz", resonance->hz.value},
                                   {"interval_hz", ToJson(resonance->hz, 1.0)},
                                   {"damping_ratio", resonance->damping_ratio.value}});
  }
  if (axis.hand)
    json["hands"].push_back({{"stiffness_N_per_m", axis.hand->stiffness_N_per_m.value},
                             {"stiffness_interval_N_per_m", ToJson(axis.hand->stiffness_N_per_m, 1.0)},
                             {"damping_Ns_per_m", axis.hand->damping_Ns_per_m.value},
                             {"mass_kg", axis.hand->mass_kg.value},
                             {"chi2", axis.hand->chi2}});
  json["link"] = {{"jitter_mean_ms", 1e3 * axis.samples.jitter_mean_s},
                  {"jitter_p99_ms", 1e3 * axis.samples.jitter_p99_s},
                  {"loss_ratio", LossOf(axis.samples)}};
  if (axis.validation_chi2)
    json["validation"].push_back(
        {{"axis", std::string(1, axis.request.axis)}, {"chi2", *axis.validation_chi2}});
}

Json NoiseJson(const ForceNoise& noise) {
  Json json{{"white_N", noise.white_N},
            {"drift_N", noise.drift_N},
            {"dead_zone_N", noise.dead_zone_N()},
            {"seconds", noise.seconds},
            {"lines", Json::array()}};
  for (const NoiseLine& line : noise.lines)
    json["lines"].push_back({{"hz", line.hz}, {"amplitude_N", line.amplitude}});
  return json;
}

Json PassiveJson(const PassiveLag& passive) {
  Json harmonics = Json::array();
  for (const SpindleHarmonic& harmonic : passive.harmonics)
    harmonics.push_back({{"order", harmonic.order},
                         {"hz", harmonic.order * passive.spindle_hz},
                         {"amplitude_N", harmonic.amplitude_N},
                         {"half_width_N", harmonic.half_width_N}});
  return Json({{"recording", passive.recording.file},
               {"lag_ms", 1e3 * passive.lag_s.value},
               {"lag_interval_ms", ToJson(passive.lag_s, 1e-3)},
               {"compliance_um_per_N", 1e6 * passive.compliance_m_per_N},
               {"seconds", passive.seconds},
               {"spindle", harmonics}});
}

// Adds what an axis says of sensor, hands and link.
void AddDevices(const AxisResult& axis, config::IdentifiedCell& cell) {
  if (axis.tool && (!cell.sensor || !cell.sensor->delay_s)) {
    if (!cell.sensor) cell.sensor.emplace();
    cell.sensor->delay_s = axis.tool->delay_s.value;
  }
  if (axis.hand)
    cell.hands.push_back({.name = fmt::format("hand {}", cell.hands.size() + 1),
                          .stiffness_N_per_m = axis.hand->stiffness_N_per_m.value,
                          .stiffness_interval_N_per_m = Interval(axis.hand->stiffness_N_per_m),
                          .damping_Ns_per_m = axis.hand->damping_Ns_per_m.value,
                          .mass_kg = axis.hand->mass_kg.value});
  config::IdentifiedLink& link = cell.link ? *cell.link : cell.link.emplace();
  link.jitter_mean_s = std::max(link.jitter_mean_s, axis.samples.jitter_mean_s);
  link.jitter_p99_s = std::max(link.jitter_p99_s, axis.samples.jitter_p99_s);
  link.loss_ratio = std::max(link.loss_ratio, std::min(1.0, LossOf(axis.samples)));
}

}  // namespace

std::string NameOf(const ExcitationRequest& request) {
  return fmt::format("{} run, {} at {:g} mm/s", request.held ? "held" : "free", request.axis,
                     1e3 * request.peak_speed_m_per_s);
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
  JudgeMass(axis, where, result);
  JudgeLinearity(axis, where, result);
  // the part of the interval that more data make smaller: a model that does not fit has its own finding
  const double lag_interval_s = axis.fit.lag_s.half_width / std::sqrt(std::max(1.0, axis.fit.chi2));
  if (lag_interval_s > kMaxLagInterval_s)
    result.refused.push_back(
        {where,
         fmt::format("too little: found {:g} s with a lag known to ± {:.3f} ms, accepted ± {:g} ms; measure "
                     "longer or faster",
                     control::Multisine::kPeriod_s * axis.by_encoders.periods, 1e3 * lag_interval_s,
                     1e3 * kMaxLagInterval_s)});
  if (const ResponseLine& line = LineAt(axis.by_encoders, axis.fit.bandwidth_hz.value);
      line.coherence < kMinCoherence)
    result.refused.push_back(
        {where, fmt::format("excite higher: found a coherence of {:.2f} at {:g} Hz, where the "
                            "arm's bandwidth lies, accepted {:g}",
                            line.coherence, line.hz, kMinCoherence)});
  const bool validated =
      !axis.validation_chi2 || *axis.validation_chi2 <= kMaxValidation * std::max(1.0, axis.fit.chi2);
  axis.model_holds = axis.fit.chi2 <= kMaxChi2 && validated;
  if (!axis.model_holds)
    result.warnings.push_back(
        {where,
         fmt::format(
             "structure that the model lacks: found chi² {:.1f}{}, accepted {:g}{}; margins by the "
             "measured response only",
             axis.fit.chi2,
             axis.validation_chi2 ? fmt::format(" and {:.1f} on other data", *axis.validation_chi2) : "",
             kMaxChi2, validated ? "" : " and twice as much on other data")});
}

void JudgeSpeeds(IdentifyResult& result) {
  for (const AxisResult& slow : result.axes)
    for (const AxisResult& fast : result.axes) {
      if (slow.request.axis != fast.request.axis || slow.request.held || fast.request.held) continue;
      if (!(slow.rms_speed_m_per_s < fast.rms_speed_m_per_s)) continue;
      const double slow_s = slow.fit.lag_s.value, fast_s = fast.fit.lag_s.value;
      if (std::abs(slow_s - fast_s) > kMaxLagApart * std::abs(slow_s))
        result.warnings.push_back(
            {NameOf(slow.request),
             fmt::format("friction: found a lag of {:.2f} ms here and {:.2f} ms at {:.1f} mm/s, "
                         "accepted 5 % apart; the slower one is written",
                         1e3 * slow_s, 1e3 * fast_s, 1e3 * fast.rms_speed_m_per_s)});
    }
}

Verdict Judge(const IdentifyResult& result) {
  Verdict verdict;
  for (const Finding& finding : result.refused)
    verdict.Add(VerdictLevel::kBad, finding.where + ": " + finding.what);
  for (const Finding& finding : result.warnings)
    verdict.Add(VerdictLevel::kWarning, finding.where + ": " + finding.what);
  if (result.axes.empty())
    verdict.Add(result.passive.empty() && !result.noise ? VerdictLevel::kBad : VerdictLevel::kWarning,
                "no arm was fitted: no recording with excitation");
  return verdict;
}

config::IdentifiedCell ToIdentified(const IdentifyResult& result) {
  config::IdentifiedCell cell{.valid_for = result.valid_for};
  for (const AxisResult& axis : result.axes) {
    cell.valid_for.recordings.push_back(axis.recording);
    const bool slower = std::ranges::any_of(result.axes, [&](const AxisResult& other) {
      return other.request.axis == axis.request.axis && !other.request.held &&
             other.rms_speed_m_per_s < axis.rms_speed_m_per_s &&
             std::abs(other.fit.lag_s.value - axis.fit.lag_s.value) >
                 kMaxLagApart * std::abs(other.fit.lag_s.value);
    });
    if (axis.request.held || slower) continue;
    const std::string name(1, axis.request.axis);
    const ServoFit& fit = axis.fit;
    if (axis.model_holds)
      cell.arm.push_back({.axis = name,
                          .speed_m_per_s = axis.rms_speed_m_per_s,
                          .bandwidth_hz = fit.bandwidth_hz.value,
                          .damping_ratio = fit.damping_ratio.value,
                          .dead_time_s = fit.dead_time_s.value,
                          .gain = fit.gain.value,
                          .lag_s = fit.lag_s.value,
                          .chi2 = fit.chi2,
                          .bandwidth_interval_hz = Interval(fit.bandwidth_hz),
                          .damping_interval = Interval(fit.damping_ratio),
                          .dead_time_interval_s = Interval(fit.dead_time_s),
                          .lag_interval_s = Interval(fit.lag_s)});
    const auto add = [&](const MeasuredResponse& response, bool by_force) {
      config::IdentifiedResponse& to = cell.response.emplace_back();
      to = {.axis = name, .speed_m_per_s = axis.rms_speed_m_per_s, .by_force = by_force};
      for (const ResponseLine& line : response.lines)
        to.lines.push_back({.hz = line.hz, .re = line.value.real(), .im = line.value.imag(), .sd = line.sd});
    };
    add(axis.by_encoders, false);
    if (axis.by_force) add(*axis.by_force, true);
    if (axis.tool && axis.tool->resonance)
      cell.structure.push_back(
          {.hz = axis.tool->resonance->hz.value, .damping_ratio = axis.tool->resonance->damping_ratio.value});
  }
  for (const AxisResult& axis : result.axes) AddDevices(axis, cell);
  if (result.noise) {
    if (!cell.sensor) cell.sensor.emplace();
    cell.sensor->noise_N = result.noise->white_N;
    cell.sensor->drift_N = result.noise->drift_N;
    cell.dead_zone_N = result.noise->dead_zone_N();
  }
  return cell;
}

std::string ToJson(const IdentifyResult& result, const std::string& command_line) {
  Json json{{"schema", "osteon.identify/1"},
            {"subcommand", "identify"},
            {"command_line", command_line},
            {"cell", result.cell},
            {"robot", result.valid_for.robot},
            {"tool", result.valid_for.tool},
            {"axes", Json::array()},
            {"sensor", nullptr},
            {"link", nullptr},
            {"structure", Json::array()},
            {"hands", Json::array()},
            {"validation", Json::array()},
            {"passive", Json::array()},
            {"warnings", FindingsJson(result.warnings)},
            {"refused", FindingsJson(result.refused)}};
  for (const AxisResult& axis : result.axes) AddAxisJson(axis, json);
  if (result.noise) json["noise"] = NoiseJson(*result.noise);
  for (const PassiveLag& passive : result.passive) json["passive"].push_back(PassiveJson(passive));
  return ResultText(Judge(result), json);
}

std::vector<SummaryRow> Rows(const IdentifyResult& result) {
  std::vector<SummaryRow> rows{
      {"Cell", fmt::format("{}: {}, {}, {:g} ms", result.cell, result.valid_for.robot, result.valid_for.tool,
                           1e3 * result.valid_for.period_s)}};
  for (const AxisResult& axis : result.axes) {
    const ServoFit& fit = axis.fit;
    rows.push_back(
        {fmt::format("Arm, {} at {:.1f} mm/s rms", axis.request.axis, 1e3 * axis.rms_speed_m_per_s),
         fmt::format("{:.2f} ± {:.2f} Hz, damping {:.3f} ± {:.3f}, dead time {:.3f} ± {:.3f} ms, lag "
                     "{:.3f} ± {:.3f} ms; chi² {:.2f}{}",
                     fit.bandwidth_hz.value, fit.bandwidth_hz.half_width, fit.damping_ratio.value,
                     fit.damping_ratio.half_width, 1e3 * fit.dead_time_s.value,
                     1e3 * fit.dead_time_s.half_width, 1e3 * fit.lag_s.value, 1e3 * fit.lag_s.half_width,
                     fit.chi2,
                     axis.validation_chi2 ? fmt::format(", {:.2f} on other data", *axis.validation_chi2)
                                          : std::string())});
    if (axis.tool)
      rows.push_back(
          {fmt::format("Sensor, {}", axis.request.axis),
           fmt::format(
               "delay {:.3f} ± {:.3f} ms; tool {:.4f} ± {:.4f} kg{}", 1e3 * axis.tool->delay_s.value,
               1e3 * axis.tool->delay_s.half_width, axis.tool->mass_kg.value, axis.tool->mass_kg.half_width,
               axis.tool->resonance
                   ? fmt::format("; resonance at {:.2f} Hz, damping {:.3f}", axis.tool->resonance->hz.value,
                                 axis.tool->resonance->damping_ratio.value)
                   : std::string())});
    if (axis.hand)
      rows.push_back({fmt::format("Hand, {}", axis.request.axis),
                      fmt::format("{:.0f} ± {:.0f} N/m, {:.1f} ± {:.1f} N s/m, {:.2f} ± {:.2f} kg",
                                  axis.hand->stiffness_N_per_m.value, axis.hand->stiffness_N_per_m.half_width,
                                  axis.hand->damping_Ns_per_m.value, axis.hand->damping_Ns_per_m.half_width,
                                  axis.hand->mass_kg.value, axis.hand->mass_kg.half_width)});
    rows.push_back({fmt::format("Link, {}", axis.request.axis),
                    fmt::format("{:.2f} % lost; jitter {:.3f} ms on average, 99th percentile {:.3f} ms",
                                100.0 * LossOf(axis.samples), 1e3 * axis.samples.jitter_mean_s,
                                1e3 * axis.samples.jitter_p99_s)});
  }
  if (result.noise) {
    rows.push_back(
        {"Force at rest", fmt::format("noise {:.3f} N, drift {:.3f} N in {:.0f} s; a dead zone of {:.2f} N",
                                      result.noise->white_N, result.noise->drift_N, result.noise->seconds,
                                      result.noise->dead_zone_N())});
    for (const NoiseLine& line : result.noise->lines)
      rows.push_back({"Line in the force", fmt::format("{:g} Hz, {:.3f} N", line.hz, line.amplitude)});
  }
  for (const PassiveLag& passive : result.passive) {
    rows.push_back(
        {"Total lag, " + passive.recording.file,
         fmt::format("{:.2f} ± {:.2f} ms from {:.0f} s of motion without excitation; nothing else can be "
                     "said",
                     1e3 * passive.lag_s.value, 1e3 * passive.lag_s.half_width, passive.seconds)});
    for (const SpindleHarmonic& harmonic : passive.harmonics)
      if (harmonic.amplitude_N > 2.0 * harmonic.half_width_N)
        rows.push_back({fmt::format("Spindle, order {}", harmonic.order),
                        fmt::format("{:.2f} ± {:.2f} N at {:.1f} Hz", harmonic.amplitude_N,
                                    harmonic.half_width_N, harmonic.order * passive.spindle_hz)});
  }
  return rows;
}

}  // namespace osteon::app
