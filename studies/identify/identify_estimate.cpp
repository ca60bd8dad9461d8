#include "studies/identify/identify_estimate.h"

#include <algorithm>
#include <cmath>
#include <deque>
#include <fstream>
#include <future>
#include <iterator>
#include <numbers>

#include <fmt/format.h>
#include <Eigen/Cholesky>

#include "base/fnv1a.h"
#include "control/excitation/multisine.h"
#include "io/recording/recording_reader.h"
#include "session/setup/recorded_config.h"

namespace osteon::studies {
namespace {

// Least time in motion for a total lag; its speed.
constexpr double kMinMotion_s = 10.0, kMoves_m_per_s = 1e-3;
constexpr double kPassiveHand_N = 5.0;  // least peak force for a compliance beside a total lag
constexpr double kPosture_rad = 0.02;   // largest joint difference of equal start postures
constexpr double kStructureChi2 = 3.0;  // chi² above which handle and encoders move differently
// Largest residual of a model that is still usable, relative to a response of 1.
constexpr double kNearModel = 0.01;

// A recording with the cell that it contains and its excitation.
struct ReadRun {
  config::IdentifiedRecording named;
  io::Recording recording;
  std::optional<ExcitationRequest> request;  // none: nothing was excited
  std::string another_cell;                  // why the recording is not of this cell; empty: it is
  config::CellConfig cell;                   // the cell with which it was recorded
};

// Says why the found cell is not the accepted one; empty: it is.
std::string DifferenceOf(const config::CellConfig& found, const config::CellConfig& accepted) {
  if (found.robot.name != accepted.robot.name)
    return fmt::format("another cell's recording: found the robot {}, accepted {}", found.robot.name,
                       accepted.robot.name);
  if (found.tool.tool.name != accepted.tool.tool.name)
    return fmt::format("another cell's recording: found the tool {}, accepted {}", found.tool.tool.name,
                       accepted.tool.tool.name);
  if (found.servo.period_s != accepted.servo.period_s)
    return fmt::format("another cell's recording: found a period of {:g} ms, accepted {:g} ms",
                       1e3 * found.servo.period_s, 1e3 * accepted.servo.period_s);
  const double off_rad = (found.start.q - accepted.start.q).cwiseAbs().maxCoeff();
  if (!(off_rad <= kPosture_rad))
    return fmt::format(
        "another cell's recording: found a start whose joints differ by {:.3f} rad, accepted {:g} rad",
        off_rad, kPosture_rad);
  return "";
}

tl::expected<ReadRun, std::string> ReadRunOf(const std::filesystem::path& file,
                                             const config::CellConfig& cell) {
  auto recording = io::ReadRecording(file);
  if (!recording) return tl::unexpected(recording.error());
  if (!recording->complete)
    return tl::unexpected(
        fmt::format("{}: {}; accepted a whole recording", file.string(), recording->end_error));
  auto recorded = session::LoadRecordedCell(recording->session.config);
  if (!recorded) return tl::unexpected(file.string() + ": " + recorded.error());
  ReadRun run{.named = {.file = file.filename().string(), .hash = HashOf(file)},
              .recording = std::move(*recording),
              .request = {},
              .another_cell = DifferenceOf(*recorded, cell),
              .cell = std::move(*recorded)};
  for (const io::RecordedEvent& event : run.recording.events)
    if (const auto request = ParseEvent(event.text)) run.request = request;
  return run;
}

// The noise of the force in its noisiest direction, over the ticks at rest in the pause.
ForceNoise NoiseOf(const std::vector<control::TickRecord>& ticks, double period_s) {
  std::array<std::vector<double>, 3> force_N;
  for (const control::TickRecord& tick : ticks) {
    if (tick.cell_state != static_cast<std::uint8_t>(safety::CellState::kPaused)) continue;
    const Vector3 f = tick.input.F_sensor_S.f;
    for (int i = 0; i < 3; ++i) force_N[static_cast<std::size_t>(i)].push_back(f[i]);
  }
  ForceNoise worst;
  for (const std::vector<double>& component : force_N) {
    const ForceNoise noise = MeasureNoise(component, period_s);
    if (worst.seconds == 0.0 ||
        std::hypot(noise.white_N, noise.drift_N) > std::hypot(worst.white_N, worst.drift_N))
      worst = noise;
  }
  return worst;
}

// The tremor of a hand at the handle, from the ticks at rest in the pause.
HandTremor TremorOf(const std::vector<control::TickRecord>& ticks, const config::CellConfig& cell) {
  const Pose X_TS = cell.tool.X_FT.inverse() * Pose(cell.servo.sensor.X_FS);
  std::vector<Wrench> F_T;
  for (const control::TickRecord& tick : ticks) {
    if (tick.cell_state != static_cast<std::uint8_t>(safety::CellState::kPaused)) continue;
    const Vector3 f = X_TS.linear() * Vector3(tick.input.F_sensor_S.f);
    F_T.push_back(
        {.f = f, .t = X_TS.linear() * Vector3(tick.input.F_sensor_S.t) + X_TS.translation().cross(f)});
  }
  return MeasureTremor(F_T, cell.servo.vibration, cell.servo.period_s);
}

// The harmonics of the turning spindle in the force, along the direction in which they are largest.
void FillHarmonics(const std::vector<control::TickRecord>& ticks, double period_s, PassiveLag& lag) {
  constexpr double kMinTurning_s = 2.0;
  std::array<std::vector<double>, 3> force_N;
  std::vector<double> speed_rad_per_s;
  for (const control::TickRecord& tick : ticks) {
    if (static_cast<safety::CellState>(tick.cell_state) != safety::CellState::kCutting) continue;
    speed_rad_per_s.push_back(tick.input.spindle_meas_rad_per_s);
    const Vector3 f = tick.input.F_sensor_S.f;
    for (int i = 0; i < 3; ++i) force_N[static_cast<std::size_t>(i)].push_back(f[i]);
  }
  if (period_s * static_cast<double>(speed_rad_per_s.size()) < kMinTurning_s) return;
  for (const double speed : speed_rad_per_s)
    lag.spindle_hz +=
        std::abs(speed) / (2.0 * std::numbers::pi * static_cast<double>(speed_rad_per_s.size()));
  const auto largest = [](const std::vector<SpindleHarmonic>& harmonics) {
    double amplitude_N = 0.0;
    for (const SpindleHarmonic& harmonic : harmonics)
      amplitude_N = std::max(amplitude_N, harmonic.amplitude_N);
    return amplitude_N;
  };
  for (const std::vector<double>& component : force_N) {
    std::vector<SpindleHarmonic> found = FitSpindleHarmonics(component, speed_rad_per_s, period_s);
    if (largest(found) > largest(lag.harmonics)) lag.harmonics = std::move(found);
    lag.notch_hz = std::max(lag.notch_hz, MeasureNotchWidth(component, speed_rad_per_s, period_s));
  }
}

// Motion per command by the force sensor: F / q_cmd divided by the inertial force per motion, m w^2.
MeasuredResponse ByForce(MeasuredResponse response, double mass_kg) {
  for (ResponseLine& line : response.lines) {
    const double w = 2.0 * std::numbers::pi * line.hz, per_m = mass_kg * w * w;
    line.value /= per_m;
    line.noise_sd /= per_m;
    line.sd /= per_m;
  }
  return response;
}

// Sums for the least squares of error = lag × speed + c × force over a part of a motion. Solve: (lag, c).
struct LagSums {
  Eigen::Matrix2d normal{Eigen::Matrix2d::Zero()};
  Eigen::Vector2d right{Eigen::Vector2d::Zero()};
  int ticks{0};

  void Add(double error_m, double speed_m_per_s, double force_N) {
    const Eigen::Vector2d row(speed_m_per_s, force_N);
    normal += row * row.transpose();
    right += error_m * row;
  }
  [[nodiscard]] Eigen::Vector2d Solve() const {
    if (!(normal(1, 1) > 0.0)) return {right[0] / normal(0, 0), 0.0};
    return normal.ldlt().solve(right);
  }
};

// The effective mass of the arm for the hand's force, estimated line by line; absent if the hand's effect
// does not stand out. P is measured, since friction changes it by more than the hand does.
// @param arm  the model of the commanded arm
std::optional<Estimate> FeltMass(const ServoModel& arm, const AxisResult& free, const AxisResult& held,
                                 double tool_mass_kg) {
  constexpr double kMaxHz = 30.0;
  const double delay_s = free.tool ? free.tool->delay_s.value : held.hand->delay_s.value;
  const double natural = 2.0 * std::numbers::pi * arm.bandwidth_hz;
  double weighted_sum = 0.0, weights = 0.0, squares = 0.0;
  int lines = 0;
  std::vector<std::pair<std::complex<double>, double>> inverse_masses;  // 1 / M by each line, and its sd
  for (std::size_t i = 0; i < held.by_encoders.lines.size(); ++i) {
    const ResponseLine& line = held.by_encoders.lines[i];
    const double w = 2.0 * std::numbers::pi * line.hz;
    if (line.hz > kMaxHz) break;
    // the hand's force is the sensor's reading, without its delay, plus the tool's inertial force
    const std::complex<double> force =
        (held.force_over_position->lines[i].value * std::polar(1.0, w * delay_s) - tool_mass_kg * w * w) *
        line.value;
    // 1 / M = (Y/U - P) / (F/U) (w0^2 - w^2 + 2 i z w0 w), see FillFeltMasses; w0, z are the arm's
    const std::complex<double> spring(natural * natural - w * w, 2.0 * arm.damping_ratio * natural * w);
    const std::complex<double> per_mass = (line.value - free.by_encoders.lines[i].value) / force * spring;
    const double sd = std::hypot(line.sd, free.by_encoders.lines[i].sd) / std::abs(force) * std::abs(spring);
    inverse_masses.emplace_back(per_mass, sd);
    weighted_sum += per_mass.real() / (sd * sd);
    weights += 1.0 / (sd * sd);
    ++lines;
  }
  if (lines < 4) return {};
  const double inverse = weighted_sum / weights;
  for (const auto& [per_mass, sd] : inverse_masses) squares += std::norm(per_mass - inverse) / (sd * sd);
  const double chi2 = squares / (2.0 * lines - 1.0);
  const double half_width = 2.0 * std::sqrt(std::max(1.0, chi2) / weights);
  if (!(inverse > half_width) || !(inverse > 0.01 && inverse < 100.0)) return {};
  return Estimate{.value = 1.0 / inverse, .half_width = half_width / (inverse * inverse)};
}

// The arm of a cell whose excitation was a force; nothing if the cell has no LBR with masses.
std::optional<OverlaidArm> OverlaidArmOf(const config::CellConfig& cell, const ExcitedAxis& axis,
                                         const kinematics::JointVectorN<7>& joint_rms_rad_per_s) {
  const config::LbrConfig* lbr = cell.robot.lbr();
  if (lbr == nullptr || !lbr->chain.has_masses) return std::nullopt;
  const Matrix3 R_BW = cell.X_WB.linear().transpose();
  return OverlaidArm{.arm = {.chain = lbr->chain,
                             .arm = cell.simulated.dynamic,
                             .X_FT = cell.tool.X_FT,
                             .q = cell.start.q,
                             .gravity_B = R_BW * kinematics::kGravity_W_m_per_s2,
                             .torque = cell.simulated.fri.command_mode == control::CommandMode::kTorque},
                     .axis_B = R_BW * axis.hold.axis_W,
                     .nominal_N_per_m = axis.hold.overlay.stiffness_N_per_m,
                     .joint_rms_rad_per_s = joint_rms_rad_per_s};
}

// The free run of the same axis whose speed is nearest to that of a held run; null if there is none.
// @param with_model  only runs whose model holds, or has a small residual. With little noise, friction can
// make a usable model fail
const AxisResult* FreeRunBeside(const IdentifyResult& result, const AxisResult& held, bool with_model) {
  const AxisResult* nearest = nullptr;
  const auto speed_difference = [&](const AxisResult& axis) {
    return std::abs(axis.rms_speed_m_per_s - held.rms_speed_m_per_s);
  };
  for (const AxisResult& axis : result.axes)
    if (!axis.request.held && axis.request.axis == held.request.axis &&
        (!with_model || axis.model_holds || axis.fit.residual <= kNearModel) &&
        (nearest == nullptr || speed_difference(axis) < speed_difference(*nearest)))
      nearest = &axis;
  return nearest;
}

// Fits the hand in each counted period alone.
void FillWindows(const ExcitedRun& run, double tool_mass_kg, AxisResult& axis) {
  const std::vector<std::vector<ResponseLine>> periods =
      MeasurePeriods(run, Signal::kPosition, Signal::kForce, *axis.force_over_position);
  for (std::size_t i = 0; i < periods.size(); ++i)
    if (const auto hand = FitHand(periods[i], tool_mass_kg, {.delay_s = axis.hand->delay_s.value}))
      axis.hand_windows.push_back({.from_s = control::Multisine::kPeriod_s * static_cast<double>(i),
                                   .stiffness_N_per_m = hand->stiffness_N_per_m});
}

double SecondsOf(const ReadRun& run) {
  return run.cell.servo.period_s * static_cast<double>(run.recording.ticks.size());
}

// Estimates an axis or a joint from an excited run. If this is not possible, adds a finding to `refused`.
std::optional<AxisResult> EstimateRun(const ReadRun& run, IdentifyResult& result) {
  const std::string where = run.named.file;
  const auto refuse = [&](const std::string& what) {
    result.refused.push_back({where, what});
    return std::nullopt;
  };
  if (!run.another_cell.empty()) return refuse(run.another_cell);
  const auto axis = ExcitedAxisOf(run.cell, *run.request);
  if (!axis) return refuse(axis.error());
  auto samples = SamplesOf(run.recording.ticks, *axis);
  if (!samples) return refuse(samples.error());
  if (samples->abort != control::ExcitationAbort::kNone)
    return refuse(fmt::format("the excitation ended early: {}; find the cause and measure again",
                              control::Describe(samples->abort)));
  const std::optional<OverlaidArm> overlaid =
      run.request->overlay ? OverlaidArmOf(run.cell, *axis, samples->joint_rms_rad_per_s) : std::nullopt;
  if (run.request->overlay && !overlaid)
    return refuse("found an arm without masses, accepted one whose file has them: a force moves them");
  auto estimated = EstimateAxis(samples->run, *run.request, run.cell.servo.sensor.tool_mass_kg,
                                overlaid ? &*overlaid : nullptr);
  if (!estimated) return refuse(estimated.error());
  const control::ExcitationPath path(axis->hold.path, axis->hold.period_s);
  estimated->rms_speed_m_per_s = path.rms_speed_m_per_s();
  estimated->recording = run.named;
  samples->run.samples.clear();
  estimated->samples = std::move(*samples);
  return std::move(*estimated);
}

}  // namespace

std::string HashOf(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  base::Fnv1a hash;
  std::string block(1 << 20, '\0');
  while (stream.read(block.data(), static_cast<std::streamsize>(block.size())) || stream.gcount() > 0)
    hash.Add(std::string_view(block.data(), static_cast<std::size_t>(stream.gcount())));
  return fmt::format("{:016x}", hash.hash());
}

tl::expected<AxisResult, std::string> EstimateAxis(const ExcitedRun& run, const ExcitationRequest& request,
                                                   double tool_mass_kg, const OverlaidArm* overlaid) {
  AxisResult axis{.request = request, .recording = {}, .by_encoders = {}, .fit = {}};
  auto response = MeasureResponse(run, Signal::kCommand, Signal::kPosition);
  if (!response) return tl::unexpected(response.error());
  axis.by_encoders = std::move(*response);
  auto fit = FitServo(axis.by_encoders.lines, run.period_s);
  if (!fit) return tl::unexpected(fit.error());
  axis.fit = *fit;
  // the force sensor cannot describe one joint: its force has all directions
  if (request.joint > 0) return axis;
  if (request.overlay && overlaid != nullptr) {
    axis.overlaid = *overlaid;
    axis.overlaid->has_friction = axis.by_encoders.odd_ratio > kNotLinear;
    const auto overlay = FitImpedance(axis.by_encoders.lines, *axis.overlaid, run.period_s);
    if (!overlay) return tl::unexpected(overlay.error());
    axis.overlay = *overlay;
    axis.over_force = PerForce(axis.by_encoders, overlaid->nominal_N_per_m);
  }
  auto force = MeasureResponse(run, Signal::kPosition, Signal::kForce);
  if (!force) return tl::unexpected(force.error());
  axis.force_over_position = std::move(*force);
  if (request.held) {
    if (const auto hand = FitHand(axis.force_over_position->lines, tool_mass_kg)) axis.hand = *hand;
    if (axis.hand) FillWindows(run, tool_mass_kg, axis);
    if (auto loop = MeasureResponse(run, Signal::kCommand, Signal::kForce); loop && !request.overlay)
      axis.force_over_command = std::move(*loop);
    return axis;
  }
  const auto tool = FitToolForce(axis.force_over_position->lines);
  if (!tool) {
    axis.no_tool = tool.error();
    return axis;
  }
  axis.tool = *tool;
  if (auto by_force = MeasureResponse(run, Signal::kCommand, Signal::kForce))
    axis.by_force = ByForce(std::move(*by_force), tool->mass_kg.value);
  return axis;
}

tl::expected<PassiveLag, std::string> EstimatePassiveLag(const std::vector<control::TickRecord>& ticks,
                                                         double period_s) {
  const auto part_ticks = static_cast<int>(std::lround(1.0 / period_s));
  LagSums all;
  std::vector<LagSums> parts(1);
  PassiveLag lag;
  for (const control::TickRecord& tick : ticks) {
    const auto state = static_cast<safety::CellState>(tick.cell_state);
    if (tick.input.received != 0 || tick.cell_state == control::kNoCellState || !safety::Renders(state))
      continue;
    const Vector3 v = tick.v_WT_cmd_m_per_s, f = tick.F_operator_T_W.f;
    if (!(v.norm() > kMoves_m_per_s)) continue;
    const Vector3 error_m = Vector3(tick.X_WT_cmd.p) - Vector3(tick.X_WT_meas.p);
    if (parts.back().ticks == part_ticks) parts.emplace_back();
    for (int i = 0; i < 3; ++i) {
      all.Add(error_m[i], v[i], f[i]);
      parts.back().Add(error_m[i], v[i], f[i]);
    }
    ++all.ticks;
    ++parts.back().ticks;
    lag.peak_hand_N = std::max(lag.peak_hand_N, f.norm());
  }
  lag.seconds = period_s * all.ticks;
  if (lag.seconds < kMinMotion_s)
    return tl::unexpected(
        fmt::format("too little: found {:.1f} s of motion, accepted {:g} s or more: record a longer run",
                    lag.seconds, kMinMotion_s));
  if (parts.back().ticks < part_ticks) parts.pop_back();
  const Eigen::Vector2d solved = all.Solve();
  double squares = 0.0;
  for (const LagSums& part : parts) squares += std::pow(part.Solve()[0] - solved[0], 2);
  const auto count = static_cast<double>(parts.size());
  lag.lag_s = {solved[0], 2.0 * std::sqrt(squares / (count * std::max(1.0, count - 1.0)))};
  lag.compliance_m_per_N = lag.peak_hand_N > kPassiveHand_N ? solved[1] : 0.0;
  return lag;
}

void UseFreeRuns(IdentifyResult& result) {
  const auto is_free = [](const AxisResult& axis) { return !axis.request.held && !axis.request.overlay; };
  const auto feels = [&](const AxisResult& axis) { return is_free(axis) && axis.tool; };
  const bool feels_tool =
      std::ranges::any_of(result.axes, feels) || std::ranges::none_of(result.axes, is_free);
  for (AxisResult& held : result.axes) {
    if (!held.hand || !held.force_over_position) continue;
    HandFitOptions options;
    const AxisResult* free = FreeRunBeside(result, held, false);
    if (free != nullptr && !free->request.overlay && free->fit.chi2 > kStructureChi2)
      options.accuracy = std::max(options.accuracy, free->fit.residual);
    if (const auto hand =
            FitHand(held.force_over_position->lines, feels_tool ? result.tool_mass_kg : 0.0, options))
      held.hand = *hand;
  }
}

void FillFeltMasses(IdentifyResult& result) {
  for (AxisResult& held : result.axes) {
    if (!held.request.held || held.request.overlay || !held.hand || !held.force_over_position) continue;
    const AxisResult *free = FreeRunBeside(result, held, false), *arm = FreeRunBeside(result, held, true);
    if (free != nullptr && arm != nullptr)
      held.felt_mass_kg = FeltMass(arm->fit.model, *free, held, result.tool_mass_kg);
  }
}

namespace {

// Adds the estimate that the recording's excitation allows: total lag, noise, tremor, axis or joint.
tl::expected<void, std::string> AddFit(const tl::expected<ReadRun, std::string>& run,
                                       IdentifyResult& result) {
  if (!run) return tl::unexpected(run.error());
  result.data_s += SecondsOf(*run);
  if (!run->request) {
    if (!run->another_cell.empty()) {
      result.refused.push_back({run->named.file, run->another_cell});
      return {};
    }
    auto lag = EstimatePassiveLag(run->recording.ticks, run->cell.servo.period_s);
    if (!lag) {
      result.refused.push_back({run->named.file, lag.error()});
      return {};
    }
    lag->recording = run->named;
    FillHarmonics(run->recording.ticks, run->cell.servo.period_s, *lag);
    result.passive.push_back(*lag);
    return {};
  }
  if (run->request->rest_s > 0.0) {
    if (run->another_cell.empty()) result.at_rest.push_back(run->named);
    if (run->another_cell.empty() && run->request->held)
      result.tremor = TremorOf(run->recording.ticks, run->cell);
    else if (run->another_cell.empty())
      result.noise = NoiseOf(run->recording.ticks, run->cell.servo.period_s);
    else
      result.refused.push_back({run->named.file, run->another_cell});
    return {};
  }
  if (auto axis = EstimateRun(*run, result))
    (run->request->joint > 0 ? result.joints : result.axes).push_back(std::move(*axis));
  return {};
}

// Sets the validation chi² of those fits whose run had the same excitation as this recording, apart from the
// seed.
tl::expected<void, std::string> AddValidation(const std::filesystem::path& file,
                                              const tl::expected<ReadRun, std::string>& run,
                                              IdentifyResult& result) {
  if (!run) return tl::unexpected(run.error());
  result.data_s += SecondsOf(*run);
  if (!run->request || run->request->rest_s > 0.0)
    return tl::unexpected(file.string() +
                          ": found a recording without excitation, accepted one of a validation run");
  const auto other = EstimateRun(*run, result);
  if (!other) return {};
  bool used = false;
  for (AxisResult& axis : run->request->joint > 0 ? result.joints : result.axes) {
    if (axis.request.joint != run->request->joint || axis.request.axis != run->request->axis ||
        axis.request.held != run->request->held || axis.request.overlay != run->request->overlay ||
        axis.request.peak_speed_m_per_s != run->request->peak_speed_m_per_s)
      continue;
    const double period_s = run->cell.servo.period_s;
    axis.validation_chi2 =
        axis.overlay ? ValidationChi2(*axis.overlay, *axis.overlaid, other->by_encoders.lines, period_s)
                     : ValidationChi2(axis.fit.model, other->by_encoders.lines, period_s);
    used = true;
  }
  if (!used)
    return tl::unexpected(
        fmt::format("{}: found {}, accepted an axis, or a joint, and a speed of the other recordings",
                    file.string(), NameOf(*run->request)));
  return {};
}

}  // namespace

tl::expected<void, std::string> AddRecording(const std::filesystem::path& file,
                                             const config::CellConfig& cell, IdentifyResult& result) {
  return AddFit(ReadRunOf(file, cell), result);
}

tl::expected<void, std::string> AddAll(std::span<const std::filesystem::path> fits,
                                       std::span<const std::filesystem::path> validations,
                                       const config::CellConfig& cell, IdentifyResult& result) {
  constexpr std::size_t kAhead = 2;  // number of files that are read ahead while another is estimated
  const std::size_t count = fits.size() + validations.size();
  const auto file = [&](std::size_t i) { return i < fits.size() ? fits[i] : validations[i - fits.size()]; };
  std::deque<std::future<tl::expected<ReadRun, std::string>>> coming;
  for (std::size_t i = 0, asked = 0; i < count; ++i) {
    for (; asked < std::min(count, i + 1 + kAhead); ++asked)
      coming.push_back(
          std::async(std::launch::async, [&cell, next = file(asked)] { return ReadRunOf(next, cell); }));
    const auto run = coming.front().get();
    coming.pop_front();
    const auto added = i < fits.size() ? AddFit(run, result) : AddValidation(file(i), run, result);
    if (!added) return added;
  }
  return {};
}

IdentifyResult EmptyResult(const std::string& name, const config::CellConfig& cell) {
  IdentifyResult result{
      .cell = name,
      .valid_for = {.robot = cell.robot.name, .tool = cell.tool.tool.name, .period_s = cell.servo.period_s},
      .law = cell.servo.law,
      .tool_mass_kg = cell.servo.sensor.tool_mass_kg,
      .axes = {}};
  for (std::size_t i = 0; i < 7; ++i)
    result.valid_for.start_rad[i] = cell.start.q[static_cast<Eigen::Index>(i)];
  return result;
}

}  // namespace osteon::studies
