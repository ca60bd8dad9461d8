#include "studies/identify/identify_result.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "studies/identify/identify_joints.h"

namespace osteon::studies {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kMaxNotch_hz = 20.0;  // largest width of the notch that a cell's file accepts

// The 95 % interval of an estimate, in the form of the cell's file.
config::IdentifiedInterval Interval(const Estimate& estimate) {
  return {.low = estimate.value - estimate.half_width, .high = estimate.value + estimate.half_width};
}

// The 95 % interval [low, high], divided by the unit.
Json ToJson(const Estimate& estimate, double unit) {
  return Json::array(
      {(estimate.value - estimate.half_width) / unit, (estimate.value + estimate.half_width) / unit});
}

Json OverlayJson(const ImpedanceFit& overlay) {
  const auto value_or_null = [](const Estimate& estimate) {
    return estimate.value != 0.0 ? Json{{"value", estimate.value}, {"interval", ToJson(estimate, 1.0)}}
                                 : Json();
  };
  return {{"stiffness_N_per_m", overlay.stiffness_N_per_m.value},
          {"damping_Ns_per_m", overlay.damping_Ns_per_m.value},
          {"mass_kg", overlay.mass_kg.value},
          {"dead_time_ms", 1e3 * overlay.dead_time_s.value},
          {"interval",
           {{"stiffness_N_per_m", ToJson(overlay.stiffness_N_per_m, 1.0)},
            {"damping_Ns_per_m", ToJson(overlay.damping_Ns_per_m, 1.0)},
            {"mass_kg", ToJson(overlay.mass_kg, 1.0)},
            {"dead_time_ms", ToJson(overlay.dead_time_s, 1e-3)}}},
          {"chi2", overlay.chi2},
          {"residual", overlay.residual},
          {"translation_N_per_m", value_or_null(overlay.translation_N_per_m)},
          {"rotation_Nm_per_rad", value_or_null(overlay.rotation_Nm_per_rad)},
          {"joint_Nm_per_rad", value_or_null(overlay.joint_Nm_per_rad)},
          {"own_damping_ratio", value_or_null(overlay.own_damping_ratio)},
          {"mass_ratio", value_or_null(overlay.mass_ratio)},
          {"friction_ratio", value_or_null(overlay.friction_ratio)},
          {"on_mount", overlay.on_mount}};
}

Json AxisJson(const AxisResult& axis) {
  Json json{{"axis", std::string(1, axis.request.axis)},
            {"held", axis.request.held},
            {"speed_mm_per_s", 1e3 * axis.rms_speed_m_per_s},
            {"peak_speed_mm_per_s", 1e3 * axis.request.peak_speed_m_per_s}};
  json.update(FitJson(axis));
  json["overlay"] = axis.overlay ? OverlayJson(*axis.overlay) : Json();
  json["frf"] = LinesJson(axis.by_encoders, "encoders");
  if (axis.by_force)
    for (const Json& line : LinesJson(*axis.by_force, "force")) json["frf"].push_back(line);
  return json;
}

Json FindingsJson(const std::vector<Finding>& findings) {
  Json list = Json::array();
  for (const Finding& finding : findings) list.push_back({{"run", finding.where}, {"message", finding.what}});
  return list;
}

// The name of a hand, in the file and in JSON.
std::string HandName(std::size_t hands_before) { return fmt::format("hand {}", hands_before + 1); }

Json WindowsJson(const std::vector<HandWindow>& windows) {
  Json list = Json::array();
  for (const HandWindow& window : windows)
    list.push_back({{"from_s", window.from_s},
                    {"stiffness_N_per_m", window.stiffness_N_per_m.value},
                    {"stiffness_interval_N_per_m", ToJson(window.stiffness_N_per_m, 1.0)}});
  return list;
}

// Adds the responses of an axis: the arm's by the encoders and by the force sensor; for a held run also the
// hand's, force over position in N/m.
void AddFrf(const AxisResult& axis, Json& frf) {
  const auto add = [&](const MeasuredResponse& response, const char* by) {
    for (Json& line : LinesJson(response, by)) {
      line["axis"] = std::string(1, axis.request.axis);
      line["held"] = axis.request.held;
      line["speed_mm_per_s"] = 1e3 * axis.rms_speed_m_per_s;
      frf.push_back(std::move(line));
    }
  };
  add(axis.by_encoders, "encoders");
  if (axis.by_force) add(*axis.by_force, "force");
  if (axis.hand && axis.force_over_position) add(*axis.force_over_position, "hand");
}

// Adds an axis and the results from its recording: sensor, structure, hand, link, validation.
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
    json["hands"].push_back(
        {{"name", HandName(json["hands"].size())},
         {"axis", std::string(1, axis.request.axis)},
         {"stiffness_N_per_m", axis.hand->stiffness_N_per_m.value},
         {"stiffness_interval_N_per_m", ToJson(axis.hand->stiffness_N_per_m, 1.0)},
         {"damping_Ns_per_m", axis.hand->damping_Ns_per_m.value},
         {"mass_kg", axis.hand->mass_kg.value},
         {"interval",
          {{"damping_Ns_per_m", ToJson(axis.hand->damping_Ns_per_m, 1.0)},
           {"mass_kg", ToJson(axis.hand->mass_kg, 1.0)}}},
         {"grip_time_ms", 1e3 * axis.hand->grip_time_s.value},
         {"residual", axis.hand->residual},
         {"windows", WindowsJson(axis.hand_windows)},
         {"felt_mass_kg", axis.felt_mass_kg ? Json(axis.felt_mass_kg->value) : Json()},
         {"felt_mass_interval_kg", axis.felt_mass_kg ? ToJson(*axis.felt_mass_kg, 1.0) : Json()},
         {"chi2", axis.hand->chi2}});
  json["link"] = {{"jitter_mean_ms", 1e3 * axis.samples.jitter_mean_s},
                  {"jitter_p99_ms", 1e3 * axis.samples.jitter_p99_s},
                  {"loss_ratio", LossOf(axis.samples)}};
  AddFrf(axis, json["frf"]);
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
               {"notch_hz", passive.notch_hz > 0.0 ? Json(passive.notch_hz) : Json()},
               {"compliance_um_per_N", 1e6 * passive.compliance_m_per_N},
               {"seconds", passive.seconds},
               {"spindle", harmonics}});
}

// The effective mass along an axis, from the held run with the narrowest interval.
std::optional<double> FeltMassOf(char axis, const IdentifyResult& result) {
  std::optional<Estimate> best;
  for (const AxisResult& held : result.axes)
    if (held.request.axis == axis && held.felt_mass_kg &&
        (!best || held.felt_mass_kg->half_width < best->half_width))
      best = held.felt_mass_kg;
  return best ? std::optional(best->value) : std::nullopt;
}

// Parameters of the vibration index, from the hand's tremor and the spindle's own forces.
std::optional<config::IdentifiedVibration> VibrationOf(const IdentifyResult& result) {
  config::IdentifiedVibration vibration;
  if (result.tremor) vibration.tremor_N = result.tremor->tremor_N;
  double notch_hz = 0.0;
  for (const PassiveLag& passive : result.passive) notch_hz = std::max(notch_hz, passive.notch_hz);
  if (notch_hz > 0.0) vibration.notch_hz = {std::min(kMaxNotch_hz, notch_hz)};
  if (!result.tremor && notch_hz == 0.0) return {};
  return vibration;
}

// A response x / f multiplied by the fitted stiffness. It is about 1 at low frequencies, like the response of
// an arm to its command.
MeasuredResponse PerSpring(const MeasuredResponse& response, double stiffness_N_per_m) {
  return PerForce(response, 1.0 / stiffness_N_per_m);
}

// The fit of an impedance, as the parameters of an arm that follows its command.
ServoFit AsArm(const ImpedanceFit& overlay, ServoFit fit) {
  fit.bandwidth_hz = overlay.bandwidth_hz;
  fit.damping_ratio = overlay.damping_ratio;
  fit.dead_time_s = overlay.dead_time_s;
  fit.lag_s = overlay.lag_s;
  fit.gain = {.value = 1.0};
  fit.chi2 = overlay.chi2;
  return fit;
}

// Returns an estimate's value if its 95 % interval is at most ± 25 %. A less exact value is not written.
std::optional<double> IfKnown(const Estimate& estimate) {
  constexpr double kMaxInterval = 0.25;
  if (!(estimate.value > 0.0 && estimate.half_width <= kMaxInterval * estimate.value)) return {};
  return estimate.value;
}

// The arm's own springs, from a run with an overlay; none for any other run.
std::optional<config::IdentifiedImpedance> ImpedanceOf(const AxisResult& axis) {
  if (!axis.overlay) return {};
  const ImpedanceFit& fit = *axis.overlay;
  return config::IdentifiedImpedance{.translation_N_per_m = IfKnown(fit.translation_N_per_m),
                                     .rotation_Nm_per_rad = IfKnown(fit.rotation_Nm_per_rad),
                                     .joint_Nm_per_rad = IfKnown(fit.joint_Nm_per_rad),
                                     .damping_ratio = IfKnown(fit.own_damping_ratio),
                                     .on_mount = fit.on_mount};
}

// The response from command to motion that the loop of a hand contains: F / q_cmd divided by the hand's
// impedance (force over motion).
config::IdentifiedResponse ResponseWithHand(const AxisResult& axis, const config::IdentifiedHand& hand) {
  config::IdentifiedResponse response{
      .axis = std::string(1, axis.request.axis), .speed_m_per_s = axis.rms_speed_m_per_s, .hand = hand.name};
  for (const ResponseLine& line : axis.force_over_command->lines) {
    const double w = 2.0 * std::numbers::pi * line.hz;
    const std::complex<double> per_m(hand.stiffness_N_per_m - w * w * hand.mass_kg,
                                     w * hand.damping_Ns_per_m);
    const std::complex<double> value = -line.value / per_m;
    response.lines.push_back(
        {.hz = line.hz, .re = value.real(), .im = value.imag(), .sd = line.sd / std::abs(per_m)});
  }
  return response;
}

// Adds an axis' results for sensor, hands and link. The link gets the worst figures of all axes.
void AddDevices(const AxisResult& axis, config::IdentifiedCell& cell) {
  if (axis.tool && (!cell.sensor || !cell.sensor->delay_s)) {
    if (!cell.sensor) cell.sensor.emplace();
    cell.sensor->delay_s = axis.tool->delay_s.value;
  }
  if (axis.hand)
    cell.hands.push_back({.name = HandName(cell.hands.size()),
                          .stiffness_N_per_m = axis.hand->stiffness_N_per_m.value,
                          .stiffness_interval_N_per_m = Interval(axis.hand->stiffness_N_per_m),
                          .damping_Ns_per_m = axis.hand->damping_Ns_per_m.value,
                          .mass_kg = axis.hand->mass_kg.value});
  if (axis.hand && axis.force_over_command)
    cell.response.push_back(ResponseWithHand(axis, cell.hands.back()));
  config::IdentifiedLink& link = cell.link ? *cell.link : cell.link.emplace();
  link.jitter_mean_s = std::max(link.jitter_mean_s, axis.samples.jitter_mean_s);
  link.jitter_p99_s = std::max(link.jitter_p99_s, axis.samples.jitter_p99_s);
  link.loss_ratio = std::max(link.loss_ratio, std::min(1.0, LossOf(axis.samples)));
}

}  // namespace

double LossOf(const ExcitedSamples& samples) {
  return samples.messages == 0
             ? 0.0
             : static_cast<double>(samples.lost_messages + samples.lost_answers) / samples.messages;
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

Json FitJson(const AxisResult& axis) {
  const ServoFit& fit = axis.fit;
  return {{"hz", fit.bandwidth_hz.value},
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
          {"recording", axis.recording.file}};
}

config::IdentifiedCell ToIdentified(const IdentifyResult& result) {
  config::IdentifiedCell cell{.valid_for = result.valid_for};
  for (const AxisResult& axis : result.axes) {
    cell.valid_for.recordings.push_back(axis.recording);
    const bool slower_run_counts = std::ranges::any_of(result.axes, [&](const AxisResult& other) {
      return other.request.axis == axis.request.axis && !other.request.held &&
             other.rms_speed_m_per_s < axis.rms_speed_m_per_s &&
             std::abs(other.fit.lag_s.value - axis.fit.lag_s.value) >
                 kMaxLagApart * std::abs(other.fit.lag_s.value);
    });
    if (axis.request.held || slower_run_counts) continue;
    const std::string name(1, axis.request.axis);
    const ServoFit fit = axis.overlay ? AsArm(*axis.overlay, axis.fit) : axis.fit;
    if (axis.model_holds)
      cell.arm.push_back({.axis = name,
                          .speed_m_per_s = axis.rms_speed_m_per_s,
                          .bandwidth_hz = fit.bandwidth_hz.value,
                          .damping_ratio = fit.damping_ratio.value,
                          .dead_time_s = fit.dead_time_s.value,
                          .gain = fit.gain.value,
                          .lag_s = fit.lag_s.value,
                          .felt_mass_kg = axis.overlay ? std::optional(axis.overlay->mass_kg.value)
                                                       : FeltMassOf(axis.request.axis, result),
                          .impedance = ImpedanceOf(axis),
                          .chi2 = fit.chi2,
                          .bandwidth_interval_hz = Interval(fit.bandwidth_hz),
                          .damping_interval = Interval(fit.damping_ratio),
                          .dead_time_interval_s = Interval(fit.dead_time_s),
                          .lag_interval_s = Interval(fit.lag_s)});
    const auto add = [&](const MeasuredResponse& response, bool by_force) {
      config::IdentifiedResponse& to = cell.response.emplace_back();
      to = {.axis = name, .speed_m_per_s = axis.rms_speed_m_per_s, .by_force = by_force};
      if (axis.overlay) to.spring_N_per_m = axis.overlay->stiffness_N_per_m.value;
      for (const ResponseLine& line : response.lines)
        to.lines.push_back({.hz = line.hz, .re = line.value.real(), .im = line.value.imag(), .sd = line.sd});
    };
    add(axis.overlay ? PerSpring(*axis.over_force, axis.overlay->stiffness_N_per_m.value) : axis.by_encoders,
        false);
    if (axis.by_force && !axis.overlay) add(*axis.by_force, true);
    if (axis.tool && axis.tool->resonance)
      cell.structure.push_back(
          {.hz = axis.tool->resonance->hz.value, .damping_ratio = axis.tool->resonance->damping_ratio.value});
  }
  for (const AxisResult& axis : result.axes) AddDevices(axis, cell);
  for (const config::IdentifiedRecording& recording : result.at_rest)
    cell.valid_for.recordings.push_back(recording);
  for (const PassiveLag& passive : result.passive) cell.valid_for.recordings.push_back(passive.recording);
  if (result.noise) {
    if (!cell.sensor) cell.sensor.emplace();
    cell.sensor->noise_N = result.noise->white_N;
    cell.sensor->drift_N = result.noise->drift_N;
    if (result.noise->dead_zone_N() >= kMinDeadZone_N) cell.dead_zone_N = result.noise->dead_zone_N();
  }
  cell.vibration = VibrationOf(result);
  return cell;
}

std::string ToJson(const IdentifyResult& result, const std::string& command_line) {
  Json json{{"schema", "osteon.identify/1"},
            {"subcommand", "identify"},
            {"command_line", command_line},
            {"cell", result.cell},
            {"estimation", {{"data_s", result.data_s}, {"wall_s", result.estimated_s}}},
            {"robot", result.valid_for.robot},
            {"tool", result.valid_for.tool},
            {"axes", Json::array()},
            {"joints", JointsJson(result)},
            {"frf", Json::array()},
            {"sensor", nullptr},
            {"link", nullptr},
            {"structure", Json::array()},
            {"hands", Json::array()},
            {"validation", Json::array()},
            {"margins", ToJson(result.margins)},
            {"passive", Json::array()},
            {"warnings", FindingsJson(result.warnings)},
            {"refused", FindingsJson(result.refused)}};
  for (const AxisResult& axis : result.axes) AddAxisJson(axis, json);
  if (result.noise) json["noise"] = NoiseJson(*result.noise);
  if (result.tremor)
    json["vibration"] = {{"tremor_N", result.tremor->tremor_N},
                         {"p999_N", result.tremor->p999_N},
                         {"drag_factor", result.tremor->drag_factor},
                         {"seconds", result.tremor->seconds}};
  for (const PassiveLag& passive : result.passive) json["passive"].push_back(PassiveJson(passive));
  return session::ResultText(Judge(result), json);
}

namespace {

report::SummaryRow OverlayRow(const AxisResult& axis) {
  const ImpedanceFit& fit = *axis.overlay;
  return {fmt::format("Overlay, {}", axis.request.axis),
          fmt::format(
              "moves {:.2f} ± {:.2f} kg, {:.0f} ± {:.0f} N s/m, {:.0f} ± {:.0f} N/m, {:.2f} ± {:.2f} ms "
              "after its command",
              fit.mass_kg.value, fit.mass_kg.half_width, fit.damping_Ns_per_m.value,
              fit.damping_Ns_per_m.half_width, fit.stiffness_N_per_m.value, fit.stiffness_N_per_m.half_width,
              1e3 * fit.dead_time_s.value, 1e3 * fit.dead_time_s.half_width)};
}

report::SummaryRow ArmRow(const AxisResult& axis) {
  return {fmt::format("Arm{}, {} at {:.1f} mm/s rms", axis.request.held ? " with the hand" : "",
                      axis.request.axis, 1e3 * axis.rms_speed_m_per_s),
          FitText(axis)};
}

}  // namespace

std::string FitText(const AxisResult& axis) {
  const ServoFit& fit = axis.fit;
  return fmt::format(
      "{:.2f} ± {:.2f} Hz, damping {:.3f} ± {:.3f}, dead time {:.3f} ± {:.3f} ms, lag {:.3f} ± {:.3f} ms; "
      "chi² {:.2f}{}",
      fit.bandwidth_hz.value, fit.bandwidth_hz.half_width, fit.damping_ratio.value,
      fit.damping_ratio.half_width, 1e3 * fit.dead_time_s.value, 1e3 * fit.dead_time_s.half_width,
      1e3 * fit.lag_s.value, 1e3 * fit.lag_s.half_width, fit.chi2,
      axis.validation_chi2 ? fmt::format(", {:.2f} on other data", *axis.validation_chi2) : std::string());
}

std::vector<report::SummaryRow> Rows(const IdentifyResult& result) {
  std::vector<report::SummaryRow> rows{
      {"Cell", fmt::format("{}: {}, {}, {:g} ms", result.cell, result.valid_for.robot, result.valid_for.tool,
                           1e3 * result.valid_for.period_s)}};
  for (const AxisResult& axis : result.axes) {
    rows.push_back(axis.overlay ? OverlayRow(axis) : ArmRow(axis));
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
                      fmt::format("{:.0f} ± {:.0f} N/m, {:.1f} ± {:.1f} N s/m, {:.2f} ± {:.2f} kg{}",
                                  axis.hand->stiffness_N_per_m.value, axis.hand->stiffness_N_per_m.half_width,
                                  axis.hand->damping_Ns_per_m.value, axis.hand->damping_Ns_per_m.half_width,
                                  axis.hand->mass_kg.value, axis.hand->mass_kg.half_width,
                                  axis.hand->grip_time_s.value > 0.0
                                      ? fmt::format(", which follows the handle in {:.1f} ± {:.1f} ms",
                                                    1e3 * axis.hand->grip_time_s.value,
                                                    1e3 * axis.hand->grip_time_s.half_width)
                                      : std::string())});
    if (axis.felt_mass_kg)
      rows.push_back(
          {fmt::format("Hand moves the arm, {}", axis.request.axis),
           fmt::format("as {:.2f} ± {:.2f} kg", axis.felt_mass_kg->value, axis.felt_mass_kg->half_width)});
    rows.push_back({fmt::format("Link, {}", axis.request.axis),
                    fmt::format("{:.2f} % lost; jitter {:.3f} ms on average, 99th percentile {:.3f} ms",
                                100.0 * LossOf(axis.samples), 1e3 * axis.samples.jitter_mean_s,
                                1e3 * axis.samples.jitter_p99_s)});
  }
  for (const AxisResult& joint : result.joints) rows.push_back(JointRow(joint));
  if (result.noise) {
    rows.push_back(
        {"Force at rest",
         fmt::format("noise {:.3f} N, drift {:.3f} N in {:.0f} s; {}", result.noise->white_N,
                     result.noise->drift_N, result.noise->seconds,
                     result.noise->dead_zone_N() >= kMinDeadZone_N
                         ? fmt::format("a dead zone of {:.3g} N", result.noise->dead_zone_N())
                         : fmt::format("the drift asks for no dead zone (below {:g} N)", kMinDeadZone_N))});
    for (const NoiseLine& line : result.noise->lines)
      rows.push_back({"Line in the force", fmt::format("{:g} Hz, {:.3f} N", line.hz, line.amplitude)});
  }
  if (result.tremor)
    rows.push_back(
        {"Tremor",
         fmt::format("{:.3f} N between 5 and 40 Hz in 99.9 % of {:.0f} s; tremor_N {:.3f}, with which "
                     "the index adds {:.1f} % drag",
                     result.tremor->p999_N, result.tremor->seconds, result.tremor->tremor_N,
                     100.0 * (result.tremor->drag_factor - 1.0))});
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
    if (passive.notch_hz > 0.0)
      rows.push_back({"Notch", fmt::format("a width of {:g} Hz holds 95 % of each of the spindle's orders",
                                           passive.notch_hz)});
  }
  if (const TuneMargin* worst = WorstOf(result.margins, "own"))
    rows.push_back({"Present gains", MarginText(*worst)});
  rows.push_back({"Next", NextStep(result)});
  return rows;
}

}  // namespace osteon::studies
