#include "config/reading/load_identified.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "base/units.h"
#include "config/reading/strict/reader.h"

namespace osteon::config {
namespace {

// accepted ranges
constexpr double kMaxSpeed_mm_per_s = 250.0, kMaxFrequency_hz = 1000.0, kMaxTime_ms = 1000.0;
// the estimate of a delay near zero may be negative
constexpr double kMinDelay_ms = -10.0, kMaxDeadTime_ms = 200.0, kMaxSensorDelay_ms = 50.0;
constexpr double kMaxLoss = 0.99;  // share of the answers that the arm did not use
// number of lines of a response; length of any other list
constexpr std::size_t kMaxLines = 400, kMaxItems = 100;
// RequireLag accepts a lag that differs from the model's lag by at most kLagTolerance × that lag +
// kLagTolerance_s.
constexpr double kLagTolerance = 0.1, kLagTolerance_s = 0.5e-3;
constexpr double kTurn_rad = 2.0 * std::numbers::pi;
// A file belongs to a cell if the joint positions at the start and the period differ by no more than this.
constexpr double kSamePosture_rad = 0.02, kSamePeriod_s = 1e-9;
constexpr const char* kAxes[] = {"x", "y", "z"};

std::string ReadAxis(Reader& section) { return kAxes[section.Choice("axis", {"x", "y", "z"})]; }

// A key and its interval. RequireInterval refuses an interval that does not contain the value.
struct IntervalCheck {
  Reader section;
  std::string key;
  double value;
  IdentifiedInterval interval;
};

IdentifiedInterval ReadInterval(Reader& section, const std::string& key, double min, double max) {
  const std::vector<double> ends = section.Numbers(key, 2, min, max);
  return {.low = ends[0], .high = ends[1]};
}

void RequireInterval(const IntervalCheck& check) {
  if (check.interval.low <= check.interval.high && check.interval.Contains(check.value)) return;
  const double unit = check.key.ends_with("_ms") ? 1e-3 : 1.0;  // the file's unit, in SI
  check.section.Refuse(
      check.key, fmt::format("found {:.6g} … {:.6g}, accepted an interval around the value beside it, {:.6g}",
                             check.interval.low / unit, check.interval.high / unit, check.value / unit));
}

// Requires that lag_ms is dead time + 2 z / w (damping ratio z, bandwidth w in rad/s). Otherwise model and
// response belong to two different arms.
void RequireLag(const Reader& section, const IdentifiedArm& arm) {
  const double lag_s = arm.dead_time_s + 2.0 * arm.damping_ratio / (kTurn_rad * arm.bandwidth_hz);
  if (std::abs(arm.lag_s - lag_s) <= kLagTolerance_s + kLagTolerance * std::abs(lag_s)) return;
  section.Refuse("lag_ms",
                 fmt::format("found {:.4g}, accepted dead_time_ms + 2 damping_ratio / (2 pi "
                             "bandwidth_hz), which is {:.4g}, within {:g} % plus {:g} ms",
                             1e3 * arm.lag_s, 1e3 * lag_s, 100.0 * kLagTolerance, 1e3 * kLagTolerance_s));
}

// Refuses an item that is the same as an earlier one. `same` compares axis, speed and kind of two items.
template <class Item, class Same>
void RequireOnce(const std::vector<Reader>& sections, const std::vector<Item>& items, const Same& same) {
  for (std::size_t i = 0; i < items.size(); ++i)
    for (std::size_t j = 0; j < i; ++j)
      if (same(items[i], items[j]))
        sections[i].Refuse("axis", fmt::format("found {} at this speed twice, accepted once", items[i].axis));
}

void RequireHash(const Reader& section, const std::string& hash) {
  if (hash.size() == 16 && hash.find_first_not_of("0123456789abcdef") == std::string::npos) return;
  section.Refuse("hash", fmt::format("found {}, accepted 16 hexadecimal digits", hash));
}

// Requires that a response with a hand names one of the file's hands.
void RequireHand(const Reader& section, const std::string& name, const std::vector<IdentifiedHand>& hands) {
  if (name.empty()) return;
  std::string names;
  for (const IdentifiedHand& hand : hands) {
    if (hand.name == name) return;
    names += (names.empty() ? "" : ", ") + hand.name;
  }
  section.Refuse("hand", fmt::format("found {}, accepted a name of hands: {}", name,
                                     names.empty() ? "there are none" : names));
}

constexpr const char* kLaws[] = {"admittance", "impedance"};  // in the order of control::Law

IdentifiedValidity ReadValidity(Reader section, std::optional<control::Law>& law,
                                std::vector<Reader>& recordings) {
  IdentifiedValidity valid{.robot = section.Text("robot"), .tool = section.Text("tool")};
  valid.period_s = section.Number("period_ms", 0.1, 100);
  const std::vector<double> start = section.Numbers("start_deg", 7, -360, 360);
  std::copy(start.begin(), start.end(), valid.start_rad.begin());
  if (section.Has("law"))
    law = section.Choice("law", {kLaws[0], kLaws[1]}) == 0 ? control::Law::kAdmittance
                                                           : control::Law::kImpedance;
  recordings = section.Sections("recordings", 0, kMaxItems);
  for (Reader& recording : recordings)
    valid.recordings.push_back({.file = recording.Text("file"), .hash = recording.Text("hash")});
  return valid;
}

IdentifiedImpedance ReadImpedance(Reader section) {
  const auto read = [&section](const char* key, double min, double max) {
    return section.Has(key) ? std::optional(section.Number(key, min, max)) : std::nullopt;
  };
  IdentifiedImpedance impedance{.translation_N_per_m = read("translation_N_per_m", 1, 1e5),
                                .rotation_Nm_per_rad = read("rotation_Nm_per_rad", 0.1, 1e4),
                                .joint_Nm_per_rad = read("joint_Nm_per_rad", 0.1, 1e5),
                                .damping_ratio = read("damping_ratio", 0.001, 10)};
  if (section.Has("on_mount")) impedance.on_mount = section.Bool("on_mount");
  return impedance;
}

IdentifiedArm ReadArm(Reader& section, std::vector<IntervalCheck>& checks) {
  IdentifiedArm arm{.axis = ReadAxis(section)};
  arm.speed_m_per_s = section.Number("speed_mm_per_s", 0, kMaxSpeed_mm_per_s);
  arm.bandwidth_hz = section.Number("bandwidth_hz", 0.1, kMaxFrequency_hz);
  arm.damping_ratio = section.Number("damping_ratio", 0, 100);
  arm.dead_time_s = section.Number("dead_time_ms", kMinDelay_ms, kMaxDeadTime_ms);
  arm.gain = section.Number("gain_ratio", 0, 10);
  arm.lag_s = section.Number("lag_ms", -kMaxTime_ms, kMaxTime_ms);
  if (section.Has("felt_mass_kg")) arm.felt_mass_kg = section.Number("felt_mass_kg", 0.01, 1000);
  if (section.Has("impedance")) arm.impedance = ReadImpedance(section.Section("impedance"));
  arm.chi2 = section.Number("chi2_ratio", 0, 1e9);
  Reader interval = section.Section("interval");
  const auto read = [&](const char* key, double value, double min, double max) {
    const IdentifiedInterval found = ReadInterval(interval, key, min, max);
    checks.push_back({.section = interval, .key = key, .value = value, .interval = found});
    return found;
  };
  arm.bandwidth_interval_hz = read("bandwidth_hz", arm.bandwidth_hz, 0, 1e6);
  arm.damping_interval = read("damping_ratio", arm.damping_ratio, -1e6, 1e6);
  arm.dead_time_interval_s = read("dead_time_ms", arm.dead_time_s, -1e6, 1e6);
  arm.lag_interval_s = read("lag_ms", arm.lag_s, -1e6, 1e6);
  return arm;
}

IdentifiedResponse ReadResponse(Reader& section, std::vector<Reader>& lines) {
  IdentifiedResponse response{.axis = ReadAxis(section)};
  response.speed_m_per_s = section.Number("speed_mm_per_s", 0, kMaxSpeed_mm_per_s);
  const auto by = section.Choice("by", {"encoders", "force", "hand"});  // 0, 1, 2
  response.by_force = by == 1;
  if (section.Has("hand")) response.hand = section.Text("hand");
  if ((by == 2) == response.hand.empty())
    section.Refuse("by", by == 2 ? "found hand without a key hand, accepted the name of one of hands in it"
                                 : "found a key hand beside it, accepted by: hand");
  if (section.Has("spring_N_per_m")) response.spring_N_per_m = section.Number("spring_N_per_m", 1, 1e6);
  lines = section.Sections("lines", 2, kMaxLines);
  for (Reader& line : lines)
    response.lines.push_back({.hz = line.Number("hz", 0, kMaxFrequency_hz),
                              .re = line.Number("re_ratio", -1e6, 1e6),
                              .im = line.Number("im_ratio", -1e6, 1e6),
                              .sd = line.Number("sd_ratio", 0, 1e6)});
  return response;
}

IdentifiedHand ReadHand(Reader& section, std::vector<IntervalCheck>& checks) {
  IdentifiedHand hand{.name = section.Text("name")};
  hand.stiffness_N_per_m = section.Number("stiffness_N_per_m", 0, 1e5);
  hand.stiffness_interval_N_per_m = ReadInterval(section, "stiffness_interval_N_per_m", -1e6, 1e6);
  checks.push_back({.section = section,
                    .key = "stiffness_interval_N_per_m",
                    .value = hand.stiffness_N_per_m,
                    .interval = hand.stiffness_interval_N_per_m});
  hand.damping_Ns_per_m = section.Number("damping_Ns_per_m", -1e4, 1e4);
  hand.mass_kg = section.Number("mass_kg", -100, 100);
  return hand;
}

void ReadSensorAndLink(Reader& cell, IdentifiedCell& identified) {
  if (cell.Has("sensor")) {
    Reader section = cell.Section("sensor");
    IdentifiedSensor& sensor = identified.sensor.emplace();
    if (section.Has("delay_ms"))
      sensor.delay_s = section.Number("delay_ms", kMinDelay_ms, kMaxSensorDelay_ms);
    sensor.noise_N = section.Number("noise_N", 0, 1000);
    sensor.drift_N = section.Number("drift_N", 0, 1000);
  }
  if (cell.Has("link")) {
    Reader section = cell.Section("link");
    identified.link = IdentifiedLink{.jitter_mean_s = section.Number("jitter_mean_ms", 0, kMaxTime_ms),
                                     .jitter_p99_s = section.Number("jitter_p99_ms", 0, kMaxTime_ms),
                                     .loss_ratio = section.Number("loss_ratio", 0, kMaxLoss)};
  }
}

void ReadVibration(Reader& cell, IdentifiedCell& identified) {
  if (cell.Has("vibration")) {
    Reader section = cell.Section("vibration");
    IdentifiedVibration& vibration = identified.vibration.emplace();
    if (section.Has("tremor_N")) vibration.tremor_N = section.Number("tremor_N", 0, 50);
    if (section.Has("notch_hz")) vibration.notch_hz = {section.Number("notch_hz", 0, 20)};
  }
  if (cell.Has("dead_zone_N")) identified.dead_zone_N = cell.Number("dead_zone_N", 0, 50);
}

// The content of a file, its section valid_for (in which later checks refuse a key), and the law that the
// file names, if any.
struct IdentifiedFile {
  IdentifiedCell identified;
  Reader valid_for;
  std::optional<control::Law> law{};
};

IdentifiedFile ReadIdentifiedFile(const std::filesystem::path& file) {
  Reader reader = Reader::Load(file);
  Reader cell = reader.Section("identified");
  Reader validity = cell.Section("valid_for");
  std::optional<control::Law> law;
  std::vector<Reader> recordings;
  IdentifiedFile read{.identified = {.valid_for = ReadValidity(validity, law, recordings)},
                      .valid_for = validity};
  read.law = law;
  IdentifiedCell& identified = read.identified;
  std::vector<IntervalCheck> checks;
  std::vector<std::vector<Reader>> lines;  // sections of the lines, for each response
  std::vector<Reader> arms = cell.Sections("arm", 0, kMaxItems),
                      responses = cell.Sections("response", 0, kMaxItems);
  for (Reader& arm : arms) identified.arm.push_back(ReadArm(arm, checks));
  for (Reader& response : responses)
    identified.response.push_back(ReadResponse(response, lines.emplace_back()));
  ReadSensorAndLink(cell, identified);
  if (cell.Has("structure"))
    for (Reader& resonance : cell.Sections("structure", 1, kMaxItems))
      identified.structure.push_back({.hz = resonance.Number("hz", 0.1, kMaxFrequency_hz),
                                      .damping_ratio = resonance.Number("damping_ratio", 0, 10)});
  if (cell.Has("hands"))
    for (Reader& hand : cell.Sections("hands", 1, kMaxItems))
      identified.hands.push_back(ReadHand(hand, checks));
  ReadVibration(cell, identified);
  reader.Finish();

  // All keys are present. Check the values against each other.
  for (const IntervalCheck& check : checks) RequireInterval(check);
  for (std::size_t i = 0; i < arms.size(); ++i) RequireLag(arms[i], identified.arm[i]);
  for (std::size_t i = 0; i < recordings.size(); ++i)
    RequireHash(recordings[i], identified.valid_for.recordings[i].hash);
  RequireOnce(arms, identified.arm, [](const IdentifiedArm& a, const IdentifiedArm& b) {
    return a.axis == b.axis && a.speed_m_per_s == b.speed_m_per_s;
  });
  RequireOnce(responses, identified.response, [](const IdentifiedResponse& a, const IdentifiedResponse& b) {
    return a.axis == b.axis && a.speed_m_per_s == b.speed_m_per_s && a.by_force == b.by_force &&
           a.hand == b.hand;
  });
  for (std::size_t i = 0; i < responses.size(); ++i)
    RequireHand(responses[i], identified.response[i].hand, identified.hands);
  for (std::size_t r = 0; r < lines.size(); ++r)
    for (std::size_t i = 1; i < lines[r].size(); ++i) {
      const std::vector<IdentifiedLine>& found = identified.response[r].lines;
      if (!(found[i].hz > found[i - 1].hz))
        lines[r][i].Refuse("hz", fmt::format("found {:g} after {:g}, accepted rising frequencies",
                                             found[i].hz, found[i - 1].hz));
    }
  return read;
}

// The Text functions return a part of the file as YAML, as the Read functions above accept it.

// @param unit  of the text, in SI
std::string IntervalText(const IdentifiedInterval& interval, double unit) {
  return fmt::format("[{:.10g}, {:.10g}]", interval.low / unit, interval.high / unit);
}

constexpr double kMilli = 1e-3;  // size of the units ms and mm/s in SI

const char* NameOf(control::Law law) { return kLaws[law == control::Law::kAdmittance ? 0 : 1]; }

std::string ValidityText(const IdentifiedValidity& valid, std::optional<control::Law> law) {
  std::string start, recordings;
  for (const double q : valid.start_rad)
    start += fmt::format("{}{:.10g}", start.empty() ? "" : ", ", q / kDegree);
  for (const IdentifiedRecording& recording : valid.recordings)
    recordings += fmt::format("\n      - {{file: \"{}\", hash: \"{}\"}}", recording.file, recording.hash);
  return fmt::format(
      "  valid_for:\n    robot: \"{}\"\n    tool: \"{}\"\n    period_ms: {:.10g}\n    start_deg: [{}]\n"
      "{}    recordings:{}\n",
      valid.robot, valid.tool, valid.period_s / kMilli, start,
      law ? fmt::format("    law: {}\n", NameOf(*law)) : "", recordings.empty() ? " []" : recordings);
}

std::string ImpedanceText(const IdentifiedImpedance& impedance) {
  std::string text;
  const auto add = [&text](const char* key, const std::optional<double>& value) {
    if (value) text += fmt::format("{}: {:.10g}, ", key, *value);
  };
  add("translation_N_per_m", impedance.translation_N_per_m);
  add("rotation_Nm_per_rad", impedance.rotation_Nm_per_rad);
  add("joint_Nm_per_rad", impedance.joint_Nm_per_rad);
  add("damping_ratio", impedance.damping_ratio);
  return fmt::format("\n      impedance: {{{}on_mount: {}}}", text, impedance.on_mount);
}

std::string ArmText(const IdentifiedArm& arm) {
  const std::string mass =
      (arm.felt_mass_kg ? fmt::format("\n      felt_mass_kg: {:.10g}", *arm.felt_mass_kg) : "") +
      (arm.impedance ? ImpedanceText(*arm.impedance) : "");
  return fmt::format(
             "    - axis: {}\n      speed_mm_per_s: {:.10g}\n      bandwidth_hz: {:.10g}\n      "
             "damping_ratio: {:.10g}\n      dead_time_ms: {:.10g}\n      gain_ratio: {:.10g}\n      lag_ms: "
             "{:.10g}{}\n"
             "      chi2_ratio: {:.10g}\n",
             arm.axis, arm.speed_m_per_s / kMilli, arm.bandwidth_hz, arm.damping_ratio,
             arm.dead_time_s / kMilli, arm.gain, arm.lag_s / kMilli, mass, arm.chi2) +
         fmt::format(
             "      interval: {{bandwidth_hz: {}, damping_ratio: {},\n        dead_time_ms: {}, lag_ms: "
             "{}}}\n",
             IntervalText(arm.bandwidth_interval_hz, 1.0), IntervalText(arm.damping_interval, 1.0),
             IntervalText(arm.dead_time_interval_s, kMilli), IntervalText(arm.lag_interval_s, kMilli));
}

std::string ResponseText(const IdentifiedResponse& response) {
  const char* by = response.by_force ? "force" : "encoders";
  std::string text =
      fmt::format("    - axis: {}\n      speed_mm_per_s: {:.10g}\n      by: {}\n", response.axis,
                  response.speed_m_per_s / kMilli, response.hand.empty() ? by : "hand");
  if (!response.hand.empty()) text += fmt::format("      hand: \"{}\"\n", response.hand);
  if (response.spring_N_per_m)
    text += fmt::format("      spring_N_per_m: {:.10g}\n", *response.spring_N_per_m);
  text += "      lines:\n";
  for (const IdentifiedLine& line : response.lines)
    text +=
        fmt::format("        - {{hz: {:.10g}, re_ratio: {:.10g}, im_ratio: {:.10g}, sd_ratio: {:.10g}}}\n",
                    line.hz, line.re, line.im, line.sd);
  return text;
}

// Force sensor, link, and the structure's resonances.
std::string DevicesText(const IdentifiedCell& identified) {
  std::string text;
  if (const auto& sensor = identified.sensor) {
    const std::string delay =
        sensor->delay_s ? fmt::format("delay_ms: {:.10g}, ", *sensor->delay_s / kMilli) : "";
    text += fmt::format("  sensor: {{{}noise_N: {:.10g}, drift_N: {:.10g}}}\n", delay, sensor->noise_N,
                        sensor->drift_N);
  }
  if (const auto& link = identified.link)
    text += fmt::format("  link: {{jitter_mean_ms: {:.10g}, jitter_p99_ms: {:.10g}, loss_ratio: {:.10g}}}\n",
                        link->jitter_mean_s / kMilli, link->jitter_p99_s / kMilli, link->loss_ratio);
  if (!identified.structure.empty()) text += "  structure:\n";
  for (const IdentifiedResonance& resonance : identified.structure)
    text +=
        fmt::format("    - {{hz: {:.10g}, damping_ratio: {:.10g}}}\n", resonance.hz, resonance.damping_ratio);
  return text;
}

// Hands, vibration and dead zone.
std::string HandsText(const IdentifiedCell& identified) {
  std::string text = identified.hands.empty() ? "" : "  hands:\n";
  for (const IdentifiedHand& hand : identified.hands)
    text += fmt::format(
        "    - {{name: \"{}\", stiffness_N_per_m: {:.10g}, stiffness_interval_N_per_m: {},\n"
        "       damping_Ns_per_m: {:.10g}, mass_kg: {:.10g}}}\n",
        hand.name, hand.stiffness_N_per_m, IntervalText(hand.stiffness_interval_N_per_m, 1.0),
        hand.damping_Ns_per_m, hand.mass_kg);
  if (const auto& vibration = identified.vibration) {
    text += "  vibration:\n";
    if (vibration->tremor_N > 0.0) text += fmt::format("    tremor_N: {:.10g}\n", vibration->tremor_N);
    if (!vibration->notch_hz.empty())
      text += fmt::format("    notch_hz: {:.10g}\n", std::ranges::max(vibration->notch_hz));
  }
  if (identified.dead_zone_N) text += fmt::format("  dead_zone_N: {:.10g}\n", *identified.dead_zone_N);
  return text;
}

}  // namespace

IdentifiedCell ReadIdentified(const std::filesystem::path& file) {
  return ReadIdentifiedFile(file).identified;
}

IdentifiedCell ReadIdentifiedFor(const std::filesystem::path& file, const CellConfig& cell) {
  const IdentifiedFile read = ReadIdentifiedFile(file);
  const IdentifiedValidity& valid = read.identified.valid_for;
  const auto require = [&](const std::string& key, const std::string& found, const std::string& accepted) {
    if (found != accepted)
      read.valid_for.Refuse(
          key, fmt::format("found {}, accepted {}: this is another cell's file; identify this cell", found,
                           accepted));
  };
  require("robot", valid.robot, cell.robot.name);
  require("tool", valid.tool, cell.tool.tool.name);
  if (!(std::abs(valid.period_s - cell.servo.period_s) <= kSamePeriod_s))
    require("period_ms", fmt::format("{:g}", valid.period_s / kMilli),
            fmt::format("{:g}, this cell's", cell.servo.period_s / kMilli));
  if (read.law && *read.law != cell.servo.law) require("law", NameOf(*read.law), NameOf(cell.servo.law));
  for (std::size_t i = 0; i < valid.start_rad.size(); ++i) {
    const double accepted_rad = cell.start.q[static_cast<int>(i)];
    if (!(std::abs(valid.start_rad[i] - accepted_rad) <= kSamePosture_rad))
      require("start_deg", fmt::format("{:.2f} for joint {}", valid.start_rad[i] / kDegree, i + 1),
              fmt::format("{:.2f} ± {:.1f}, this cell's start", accepted_rad / kDegree,
                          kSamePosture_rad / kDegree));
  }
  return read.identified;
}

std::string WriteIdentified(const IdentifiedCell& identified, const std::string& comment,
                            std::optional<control::Law> law) {
  std::string text;
  for (std::size_t begin = 0; begin < comment.size();) {
    const std::size_t end = std::min(comment.find('\n', begin), comment.size());
    text += "# " + comment.substr(begin, end - begin) + "\n";
    begin = end + 1;
  }
  text += "identified:\n" + ValidityText(identified.valid_for, law);
  text += identified.arm.empty() ? "  arm: []\n" : "  arm:\n";
  for (const IdentifiedArm& arm : identified.arm) text += ArmText(arm);
  text += identified.response.empty() ? "  response: []\n" : "  response:\n";
  for (const IdentifiedResponse& response : identified.response) text += ResponseText(response);
  return text + DevicesText(identified) + HandsText(identified);
}

}  // namespace osteon::config
