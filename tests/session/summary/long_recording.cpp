#include "tests/session/summary/long_recording.h"

#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cmath>
#include <exception>
#include <random>
#include <stdexcept>

#include "config/reading/load.h"
#include "control/ports.h"
#include "io/recording/recorder.h"
#include "report/run_charts.h"
#include "session/summary/run_accumulator.h"
#include "session/summary/summary.h"
#include "simulation/tools/swept_tool.h"
#include "simulation/tools/tool_kinds.h"

namespace osteon::session {
namespace {

constexpr unsigned kSeed = 20261126;
constexpr std::uint64_t kPauseEvery = 120'000, kStopping = 300, kStopped = 2000;  // ticks of 1 ms

// The hand's motion: a slow path over some centimetres, and a tremor of 0.1 mm at 9 Hz.
Pose HandPose(double t_s) {
  Pose X_WT = Pose::Identity();
  X_WT.translation() =
      Vector3(0.02 * std::sin(0.7 * t_s), 0.015 * std::sin(1.1 * t_s + 0.4), 0.01 * std::sin(0.13 * t_s));
  X_WT.translation() += 1e-4 * Vector3(std::sin(56.5 * t_s), std::cos(58.1 * t_s), std::sin(55.2 * t_s));
  X_WT.linear() = ExpRotation({0.1 * std::sin(0.5 * t_s), 0.1 * std::cos(0.4 * t_s), 0.0});
  return X_WT;
}

// The loop's phase in a tick: 1 s of waiting, then rendering with a pause every two minutes.
control::Phase PhaseOf(std::uint64_t tick) {
  const std::uint64_t since = tick % kPauseEvery;
  if (tick < 1000) return control::Phase::kWaiting;
  if (tick < kPauseEvery || since >= kStopping + kStopped) return control::Phase::kHaptic;
  return since < kStopping ? control::Phase::kStopping : control::Phase::kStopped;
}

// Makes the ticks and frames of the run, with noise from a fixed seed.
class Source {
 public:
  control::TickRecord Tick(std::uint64_t i) {
    const double t_s = 1e-3 * static_cast<double>(i);
    control::TickRecord tick;
    tick.tick = i;
    tick.stamp = tick.input.now = static_cast<rt::Nanoseconds>(i) * rt::kMillisecond + Scatter(20'000);
    tick.phase = PhaseOf(i);
    tick.session_state = static_cast<std::uint8_t>(control::SessionState::kCommandingActive);
    tick.input.pause = i % kPauseEvery == 0;
    if (i % 7001 == 0) tick.input.received = static_cast<std::uint8_t>(control::ReceiveResult::kTimeout);
    for (std::size_t j = 0; j < 7; ++j) {
      tick.q_cmd[j] = 0.3 * std::sin(0.1 * t_s + static_cast<double>(j));
      tick.q_meas[j] = tick.q_cmd[j] + 1e-5 * noise_(random_);
      tick.input.tau_ext[j] = noise_(random_);
    }
    tick.X_WT_cmd = HandPose(t_s);
    tick.X_WT_meas = HandPose(t_s - 1e-3);
    tick.v_WT_cmd_m_per_s = Vector3(0.014 * std::cos(0.7 * t_s), 0.016 * std::cos(1.1 * t_s), 0.0);
    tick.F_operator_T_W =
        Wrench{.f = Vector3(noise_(random_), noise_(random_), -60.0 + noise_(random_)), .t = Vector3::Zero()};
    tick.F_coupling_T_W = Wrench{.f = Vector3(noise_(random_), noise_(random_), 58.0), .t = Vector3::Zero()};
    tick.input.F_sensor_S = tick.F_operator_T_W;
    tick.wrench_scale = i % 900 == 0 ? 0.8 : 1.0;
    tick.model_frame = i;
    tick.model_age_s = 1e-3 + 1e-9 * static_cast<double>(Scatter(900'000));
    tick.spindle_rad_per_s = 30.0 + 0.1 * noise_(random_);
    tick.wakeup_ns = 20'000 + Scatter(30'000);
    tick.compute_ns = 9'000 + Scatter(20'000);
    return tick;
  }
  simulation::FrameRecord Frame(std::uint64_t i) {
    simulation::FrameRecord frame;
    frame.stamp = static_cast<rt::Nanoseconds>(i) * rt::kMillisecond + 500'000 + Scatter(100'000);
    frame.duration_ns = 400'000 + Scatter(500'000);
    simulation::ContactModel& model = frame.model;
    model.frame = i + 1;
    model.pose_stamp = frame.stamp - frame.duration_ns;
    model.X_WP = HandPose(1e-3 * static_cast<double>(i));
    model.F_T_W = Wrench{.f = Vector3(0.0, 0.0, 58.0 + noise_(random_)), .t = Vector3::Zero()};
    model.contact_count = 2;
    for (std::size_t k = 0; k < 2; ++k) {
      model.contacts[k].p_W_m = Vector3(noise_(random_), noise_(random_), noise_(random_));
      model.contacts[k].n_W = Vector3(0, 0, 1);
      model.contacts[k].gap_m = -1e-4;
    }
    model.removed_volume_m3 = 1e-14 * static_cast<double>(i);
    return frame;
  }

 private:
  // A random duration: the absolute value of a normal distribution with this standard deviation.
  rt::Nanoseconds Scatter(double deviation_ns) {
    return static_cast<rt::Nanoseconds>(deviation_ns * std::abs(noise_(random_)));
  }
  std::mt19937 random_{kSeed};
  std::normal_distribution<double> noise_;
};

}  // namespace

CellSetup SetupOfLongRun() {
  CellSetup setup;
  setup.config = config::LoadCell(std::filesystem::path(OSTEON_SOURCE_DIR) / "config/cells/thin_plate.yaml");
  setup.config.tool.tool = simulation::MakeReamer(0.025, 0.008, 0.1, 0.9, Vector3::Zero());
  return setup;
}

void WriteLongRecording(const std::filesystem::path& path, double seconds) {
  io::SessionInfo session;
  session.version = "long run";
  auto recorder = io::Recorder::Open({.path = path, .writer_thread = false}, session);
  if (!recorder) throw std::runtime_error(recorder.error());
  Source source;
  const auto ticks = static_cast<std::uint64_t>(1e3 * seconds);
  for (std::uint64_t i = 0; i < ticks; ++i) {
    (void)(*recorder)->Push(source.Tick(i));
    (void)(*recorder)->PushFrame(source.Frame(i));
    if (i % 1000 == 999) (*recorder)->Drain();
  }
  if (const auto closed = (*recorder)->Close(); !closed) throw std::runtime_error(closed.error());
}

LongRunEnd EndLongRun(const std::filesystem::path& recording, const std::filesystem::path& folder) {
  const CellSetup setup = SetupOfLongRun();
  StopPages stops({.folder = folder, .stem = "long", .cell = setup.config});
  const auto run = ReadRun(recording, setup, stops);
  if (!run) throw std::runtime_error(run.error());
  const auto pages = stops.Finish();
  if (!pages) throw std::runtime_error(pages.error());
  const DurationFigures figures[] = {Quantiles(run->active.wakeup), Quantiles(run->active.compute),
                                     Quantiles(run->curves.frame)};
  const std::size_t drawn =
      report::ForceChart(run->curves, 200.0).size() + report::ProgressChart(run->curves).size() +
      report::MotionChart(run->curves, 0.25).size() + report::WakeupHistogram(run->curves).size() +
      report::FrameTimeHistogram(run->curves).size();
  const simulation::SweptTool swept(setup.config.tool.tool, run->path.X_GP());
  if (figures[2].count != run->frames || drawn == 0 || swept.empty())
    throw std::runtime_error("a figure is missing");
  return {.ticks = run->ticks,
          .frames = run->frames,
          .stops = pages->size(),
          .path_tolerance_m = run->path.tolerance_m()};
}

std::uint64_t PeakMemory(const std::function<void()>& work) {
  const pid_t child = fork();
  if (child == 0) {
    int code = 1;
    try {
      work();
      code = 0;
    } catch (const std::exception& error) {
      (void)!write(STDERR_FILENO, error.what(), std::string(error.what()).size());
    }
    _exit(code);
  }
  int status = 0;
  rusage usage{};
  if (child < 0 || wait4(child, &status, 0, &usage) != child || !WIFEXITED(status) ||
      WEXITSTATUS(status) != 0)
    return 0;
  return static_cast<std::uint64_t>(usage.ru_maxrss) << 10;
}

}  // namespace osteon::session
