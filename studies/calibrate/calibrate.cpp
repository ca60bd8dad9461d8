#include "studies/calibrate/calibrate.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "base/json_text.h"
#include "base/write_text.h"
#include "config/reading/load.h"
#include "control/setup/calibration.h"
#include "io/recording/recording_reader.h"
#include "kinematics/lbr_arm.h"
#include "kinematics/ortho_parallel_arm.h"
#include "session/process/exit_code.h"
#include "studies/calibrate/calibration_history.h"

namespace osteon::studies {
namespace {

constexpr double kStill_rad = 5e-4;      // largest motion of a joint during a rest
constexpr double kRest_s = 0.5;          // shortest rest
constexpr double kSettle_s = 0.2;        // time at the beginning of a rest that is left out of the mean
constexpr double kSamePlace_rad = 0.02;  // largest difference of a joint between rests at one posture
constexpr double kFresh_s = 0.02;        // largest age of a sensor reading that counts

double Seconds(rt::Nanoseconds from, rt::Nanoseconds to) { return 1e-9 * static_cast<double>(to - from); }

// Whether the tick has a fresh and trusted reading of the force sensor, in a session with the arm.
bool Usable(const control::TickRecord& tick) {
  return tick.sensor_age_s <= kFresh_s && tick.input.sensor_trusted && tick.session_state != 0;
}

// Mean joint positions and force of the ticks [first, last), without the first kSettle_s.
RestingPose MeanOf(const std::vector<control::TickRecord>& ticks, std::size_t first, std::size_t last) {
  RestingPose rest;
  rest.begin_s = Seconds(ticks.front().stamp, ticks[first].stamp);
  rest.seconds = Seconds(ticks[first].stamp, ticks[last - 1].stamp);
  while (first + 1 < last && Seconds(ticks.front().stamp, ticks[first].stamp) < rest.begin_s + kSettle_s)
    ++first;
  const auto count = static_cast<double>(last - first);
  for (std::size_t i = first; i < last; ++i) {
    for (std::size_t j = 0; j < rest.q.size(); ++j) rest.q[j] += ticks[i].q_meas[j] / count;
    rest.F_S.f += Vector3(ticks[i].input.F_sensor_S.f) / count;
    rest.F_S.t += Vector3(ticks[i].input.F_sensor_S.t) / count;
  }
  return rest;
}

// Whether two rests are at one posture.
bool SamePlace(const RestingPose& a, const RestingPose& b) {
  for (std::size_t j = 0; j < a.q.size(); ++j)
    if (std::abs(a.q[j] - b.q[j]) > kSamePlace_rad) return false;
  return true;
}

// Adds a rest. If its posture is known, keeps the longer of the two rests and counts the visit.
void KeepLonger(const RestingPose& rest, std::vector<RestingPose>& rests) {
  for (RestingPose& known : rests) {
    if (!SamePlace(known, rest)) continue;
    const int visits = known.visits + 1;
    const double repeat_N = std::max(known.repeat_N, (Vector3(known.F_S.f) - Vector3(rest.F_S.f)).norm());
    if (rest.seconds > known.seconds) known = rest;
    known.visits = visits;
    known.repeat_N = repeat_N;
    return;
  }
  rests.push_back(rest);
}

// The flange's pose in W.
Pose FlangePose(const config::CellConfig& cell, const RestingPose& rest) {
  if (const config::SixAxisConfig* arm = cell.robot.six_axis())
    return cell.X_WB * kinematics::OrthoParallelArm(arm->params)
                           .FlangePose(Eigen::Map<const kinematics::OrthoParallelArm::Joints>(rest.q.data()));
  return cell.X_WB * kinematics::LbrArm(cell.robot.lbr()->params)
                         .FlangePose(Eigen::Map<const kinematics::JointVector>(rest.q.data()));
}

// The rests of a recording; an error if the recording is truncated or has no rest.
tl::expected<std::vector<RestingPose>, std::string> RestsOf(const std::filesystem::path& file) {
  const auto recording = io::ReadRecording(file);
  if (!recording) return tl::unexpected(recording.error());
  if (!recording->complete)
    return tl::unexpected(
        fmt::format("{}: {}; accepted a whole recording", file.string(), recording->end_error));
  std::vector<RestingPose> rests = FindRestingPoses(recording->ticks);
  if (rests.empty())
    return tl::unexpected(fmt::format("{}: found no rest of {} s in {} ticks", file.string(), kRest_s,
                                      recording->ticks.size()));
  return rests;
}

nlohmann::ordered_json Triple(const Vector3& v, double scale) {
  return nlohmann::ordered_json::array({scale * v.x(), scale * v.y(), scale * v.z()});
}
std::string Text(const Vector3& v, double scale) {
  return fmt::format("[{:.6g}, {:.6g}, {:.6g}]", scale * v.x(), scale * v.y(), scale * v.z());
}

// How well a fit explains one posture.
struct PostureResidual {
  std::array<double, 7> q{};  // [rad]
  double begin_s{0.0};
  double residual{0.0};  // remaining error: [N] for the payload, [m] for the pivot
  int visits{1};
  double repeat_N{0.0};
};

// Results of the calibration. A part whose recording was not given has no value.
struct Result {
  std::optional<control::PayloadFit> payload;
  std::vector<PostureResidual> payload_residuals, pivot_residuals;
  std::vector<std::string> drift;       // one sentence for each quantity (DriftSince)
  std::size_t earlier{0};               // number of calibrations in the history
  Vector3 center_F_m{Vector3::Zero()};  // centre of mass of the payload
  std::size_t payload_poses{0};
  std::optional<control::PivotFit> pivot;
  std::size_t pivot_poses{0};
};

// For each posture, the difference between the mean force and the force that the fit predicts from bias and
// weight.
std::vector<PostureResidual> PayloadResiduals(const control::PayloadFit& fit,
                                              const std::vector<RestingPose>& rests,
                                              const std::vector<control::RestPose>& poses) {
  std::vector<PostureResidual> list;
  for (std::size_t i = 0; i < rests.size(); ++i) {
    const Vector3 expected_N = Vector3(fit.bias_S.f) + fit.mass_kg * poses[i].R_WS.transpose() *
                                                           Vector3(kinematics::kGravity_W_m_per_s2);
    list.push_back({.q = rests[i].q,
                    .begin_s = rests[i].begin_s,
                    .residual = (Vector3(rests[i].F_S.f) - expected_N).norm(),
                    .visits = rests[i].visits,
                    .repeat_N = rests[i].repeat_N});
  }
  return list;
}

// For each posture, the distance of the tool's tip from the fixed point that the fit found.
std::vector<PostureResidual> PivotResiduals(const control::PivotFit& fit,
                                            const std::vector<RestingPose>& rests,
                                            const std::vector<Pose>& X_WF) {
  std::vector<PostureResidual> list;
  for (std::size_t i = 0; i < rests.size(); ++i)
    list.push_back({.q = rests[i].q,
                    .begin_s = rests[i].begin_s,
                    .residual = (X_WF[i] * fit.p_FT_m - fit.p_WT_m).norm(),
                    .visits = rests[i].visits,
                    .repeat_N = rests[i].repeat_N});
  return list;
}

// Largest difference of force between two rests at one posture [N]; nothing if no posture was visited twice.
std::optional<double> Repeatability_N(const std::vector<PostureResidual>& residuals) {
  std::optional<double> max_difference_N;
  for (const PostureResidual& at : residuals)
    if (at.visits > 1) max_difference_N = std::max(max_difference_N.value_or(0.0), at.repeat_N);
  return max_difference_N;
}

nlohmann::ordered_json ToJson(const std::vector<PostureResidual>& residuals, const char* key, double unit) {
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (const PostureResidual& at : residuals) {
    nlohmann::ordered_json q = nlohmann::ordered_json::array();
    for (const double angle : at.q) q.push_back(angle * 180.0 / std::numbers::pi);
    list.push_back({{"q_deg", q}, {"at_s", at.begin_s}, {key, at.residual / unit}, {"visits", at.visits}});
  }
  return list;
}

CalibrationEntry EntryOf(const Result& result) {
  CalibrationEntry entry{.time = UtcNow()};
  if (const auto& payload = result.payload)
    entry.payload = CalibrationEntry::Payload{.mass_kg = payload->mass_kg,
                                              .mass_sd_kg = payload->mass_sd_kg,
                                              .center_F_m = result.center_F_m,
                                              .center_sd_m = payload->center_sd_m,
                                              .bias_N = payload->bias_S.f,
                                              .residual_N = payload->residual_N};
  if (const auto& pivot = result.pivot)
    entry.apex =
        CalibrationEntry::Apex{.p_FT_m = pivot->p_FT_m, .sd_m = pivot->sd_m, .residual_m = pivot->residual_m};
  return entry;
}

std::string ToYaml(const Result& result, const std::string& command_line) {
  std::string yaml = "# What hangs on the flange, as measured. Written by\n#   " + command_line +
                     "\n# A cell's file names it: calibration: FILE\n";
  if (result.payload)
    yaml += fmt::format(
        "# {} poses; residual {:.3g} N, {:.3g} N·m\npayload:\n  mass_kg: {:.6g}\n  center_mm: {}\n  bias_N: "
        "{}\n"
        "  bias_Nm: {}\n",
        result.payload_poses, result.payload->residual_N, result.payload->residual_Nm,
        result.payload->mass_kg, Text(result.center_F_m, 1e3), Text(result.payload->bias_S.f, 1.0),
        Text(result.payload->bias_S.t, 1.0));
  if (result.pivot)
    yaml += fmt::format("# {} poses; residual {:.3g} mm, worst {:.3g} mm\ntcp_mm: {}\n", result.pivot_poses,
                        1e3 * result.pivot->residual_m, 1e3 * result.pivot->worst_m,
                        Text(result.pivot->p_FT_m, 1e3));
  return yaml;
}

nlohmann::ordered_json ToJson(const Result& result, const CalibrateOptions& options) {
  nlohmann::ordered_json json{{"schema", "osteon.calibrate/1"},
                              {"cell", options.cell.string()},
                              {"tcp", nullptr},
                              {"payload", nullptr},
                              {"residual", nlohmann::ordered_json::object()},
                              {"repeatability_N", nullptr},
                              {"drift", result.drift},
                              {"history", HistoryFile(options.out).string()},
                              {"earlier_calibrations", result.earlier},
                              {"overlay", options.out.string()},
                              {"command", options.command_line}};
  if (const auto& payload = result.payload) {
    json["payload"] = {{"mass_kg", payload->mass_kg},
                       {"mass_sd_kg", payload->mass_sd_kg},
                       {"center_mm", Triple(result.center_F_m, 1e3)},
                       {"center_sd_mm", 1e3 * payload->center_sd_m},
                       {"bias_N", Triple(payload->bias_S.f, 1.0)},
                       {"bias_Nm", Triple(payload->bias_S.t, 1.0)},
                       {"poses", result.payload_poses}};
    json["payload"]["postures"] = ToJson(result.payload_residuals, "residual_N", 1.0);
    if (const auto repeat_N = Repeatability_N(result.payload_residuals)) json["repeatability_N"] = *repeat_N;
    json["residual"]["payload_N"] = payload->residual_N;
    json["residual"]["payload_Nm"] = payload->residual_Nm;
  }
  if (const auto& pivot = result.pivot) {
    json["tcp"] = {{"position_mm", Triple(pivot->p_FT_m, 1e3)},
                   {"sd_mm", 1e3 * pivot->sd_m},
                   {"point_in_world_mm", Triple(pivot->p_WT_m, 1e3)},
                   {"poses", result.pivot_poses}};
    json["tcp"]["postures"] = ToJson(result.pivot_residuals, "residual_mm", 1e-3);
    json["residual"]["tcp_mm"] = 1e3 * pivot->residual_m;
    json["residual"]["tcp_worst_mm"] = 1e3 * pivot->worst_m;
  }
  return json;
}

// "0.01 N at 0.0 s, 0.02 N at 1.2 s": the residual of each posture at the time of its rest.
std::string ByPosture(const std::vector<PostureResidual>& residuals, const char* unit, double scale) {
  std::string text;
  for (const PostureResidual& at : residuals)
    text += fmt::format("{}{:.3f} {} at {:.1f} s", text.empty() ? "" : ", ", at.residual / scale, unit,
                        at.begin_s);
  return text;
}

void Print(const Result& result, const CalibrateOptions& options) {
  const auto row = [](const char* name, const std::string& value) {
    fmt::print("  {:<22} {}\n", name, value);
  };
  fmt::print("Osteon calibrate: {}\n", options.cell.stem().string());
  if (const auto& payload = result.payload) {
    row("Payload", fmt::format("{:.3f} ± {:.3f} kg, from {} poses", payload->mass_kg, payload->mass_sd_kg,
                               result.payload_poses));
    row("Its centre, in F",
        fmt::format("{} ± {:.2f} mm", Text(result.center_F_m, 1e3), 1e3 * payload->center_sd_m));
    row("Bias", fmt::format("{} N, {} N·m", Text(payload->bias_S.f, 1.0), Text(payload->bias_S.t, 1.0)));
    row("Residual", fmt::format("{:.3f} N, {:.4f} N·m rms", payload->residual_N, payload->residual_Nm));
    row("By posture", ByPosture(result.payload_residuals, "N", 1.0));
    const auto repeat_N = Repeatability_N(result.payload_residuals);
    row("Repeatability", repeat_N ? fmt::format("{:.3f} N between rests at the same posture", *repeat_N)
                                  : std::string("not known: no posture was visited twice"));
  }
  if (const auto& pivot = result.pivot) {
    row("Tool's apex, in F", fmt::format("{} ± {:.3f} mm, from {} poses", Text(pivot->p_FT_m, 1e3),
                                         1e3 * pivot->sd_m, result.pivot_poses));
    row("Residual",
        fmt::format("{:.3f} mm rms, {:.3f} mm at worst", 1e3 * pivot->residual_m, 1e3 * pivot->worst_m));
    row("By posture", ByPosture(result.pivot_residuals, "mm", 1e-3));
  }
  row("History", fmt::format("{}: {} earlier", HistoryFile(options.out).string(), result.earlier));
  for (const std::string& drift : result.drift) row("Warning", drift);
  row("Written", options.out.string() + ": name it in the cell's file as its `calibration`");
}

}  // namespace

std::vector<RestingPose> FindRestingPoses(const std::vector<control::TickRecord>& ticks) {
  std::vector<RestingPose> rests;
  std::size_t first = 0;
  // Ends the rest at tick `last` (excluded), and stores it if it is long enough.
  const auto end = [&](std::size_t last) {
    if (last > first && Seconds(ticks[first].stamp, ticks[last - 1].stamp) >= kRest_s)
      KeepLonger(MeanOf(ticks, first, last), rests);
    first = last;
  };
  for (std::size_t i = 0; i < ticks.size(); ++i) {
    if (!Usable(ticks[i])) {
      end(i);
      first = i + 1;
      continue;
    }
    for (std::size_t j = 0; j < ticks[i].q_meas.size(); ++j)
      if (!(std::abs(ticks[i].q_meas[j] - ticks[first].q_meas[j]) <= kStill_rad)) {
        end(i);
        break;
      }
  }
  end(ticks.size());
  return rests;
}

int RunCalibrate(const CalibrateOptions& options) {
  const config::CellConfig cell = config::LoadCell(options.cell);
  Result result;
  if (!options.payload.empty()) {
    const auto rests = RestsOf(options.payload);
    if (!rests) return session::Fail("calibrate", rests.error());
    const Pose X_FS = cell.servo.sensor.X_FS;
    std::vector<control::RestPose> poses;
    for (const RestingPose& rest : *rests)
      poses.push_back({.R_WS = (FlangePose(cell, rest) * X_FS).linear(), .F_S = rest.F_S});
    const auto fit = control::FitPayload(poses);
    if (!fit)
      return session::Fail("calibrate", options.payload.string() + ": " + fit.error(), session::kFailed);
    result.payload = *fit;
    result.center_F_m = X_FS * fit->center_S_m;
    result.payload_poses = poses.size();
    result.payload_residuals = PayloadResiduals(*fit, *rests, poses);
  }
  if (!options.pivot.empty()) {
    const auto rests = RestsOf(options.pivot);
    if (!rests) return session::Fail("calibrate", rests.error());
    std::vector<Pose> poses;
    for (const RestingPose& rest : *rests) poses.push_back(FlangePose(cell, rest));
    const auto fit = control::FitPivot(poses);
    if (!fit)
      return session::Fail("calibrate", options.pivot.string() + ": " + fit.error(), session::kFailed);
    result.pivot = *fit;
    result.pivot_poses = poses.size();
    result.pivot_residuals = PivotResiduals(*fit, *rests, poses);
  }
  // Read the history first, so that an unreadable history is reported before any file is written.
  const auto history = ReadHistory(HistoryFile(options.out));
  if (!history) return session::Fail("calibrate", history.error());
  const CalibrationEntry entry = EntryOf(result);
  result.drift = DriftSince(*history, entry);
  result.earlier = history->size();
  if (const auto written = base::WriteText(options.out, ToYaml(result, options.command_line)); !written)
    return session::Fail("calibrate", written.error(), session::kFailed);
  if (const auto appended = AppendHistory(HistoryFile(options.out), entry); !appended)
    return session::Fail("calibrate", appended.error(), session::kFailed);
  if (!options.json.empty())
    if (const auto written = base::WriteText(options.json, base::JsonText(ToJson(result, options))); !written)
      return session::Fail("calibrate", written.error(), session::kFailed);
  Print(result, options);
  return 0;
}

}  // namespace osteon::studies
