#include "studies/diff/run_figures.h"

#include <algorithm>
#include <cmath>

#include "base/fnv1a.h"
#include "base/units.h"
#include "console/stream/live_window.h"
#include "io/recording/recording_reader.h"
#include "report/duration_counts.h"
#include "safety/acting_limits.h"
#include "safety/cell_state.h"
#include "session/summary/deflection_events.h"
#include "session/summary/each_fault.h"
#include "session/summary/latency.h"

namespace osteon::studies {
namespace {

using console::Length;

// Sums and maxima, accumulated tick by tick and frame by frame.
struct Gathered {
  std::uint64_t rendering{0}, frames{0};  // number of ticks that rendered a force, and number of frames
  double force_sum_N{0.0}, peak_force_N{0.0}, peak_hand_N{0.0}, peak_speed_m_per_s{0.0}, tool_in_bone_m{0.0};
  double least_share{1.0};  // least factor by which the limits scaled the force
  double most_age_s{0.0};   // age of the oldest contact model
  double removed_m3{0.0}, removed_kg{0.0}, work_J{0.0}, depth_m{0.0};
  double period_s{0.0};
  report::DurationCounts compute, frame;
  session::PeakDeflection deflected;
  session::LatencyMeter latency;
};

void UpdatePeak(double& peak, double value) { peak = std::max(peak, value); }

void AddTick(const control::TickRecord& tick, Gathered& all) {
  UpdatePeak(all.peak_force_N, Length(tick.F_coupling_T_W.f));
  UpdatePeak(all.peak_hand_N, Length(tick.F_operator_T_W.f));
  UpdatePeak(all.peak_speed_m_per_s, Length(tick.v_WT_cmd_m_per_s));
  UpdatePeak(all.tool_in_bone_m, tick.tool_in_bone_m);
  all.compute.Add(tick.compute_ns);
  all.deflected.Add(tick.compliance);
  all.latency.Add(tick);
  if (!safety::Renders(static_cast<safety::CellState>(tick.cell_state))) return;
  ++all.rendering;
  all.force_sum_N += Length(tick.F_coupling_T_W.f);
  all.least_share = std::min(all.least_share, tick.wrench_scale);
  UpdatePeak(all.most_age_s, tick.model_age_s);
  if (tick.input.period_s > 0.0) all.period_s = tick.input.period_s;
}

void AddFrame(const simulation::FrameRecord& frame, Gathered& all) {
  ++all.frames;
  all.removed_m3 = frame.model.removed_volume_m3;
  all.removed_kg = frame.model.removed_mass_kg;
  all.work_J = frame.model.cutting_work_J;
  all.depth_m = frame.cup_depth_m;
  all.frame.Add(frame.duration_ns);
}

double Percentile99_us(const report::DurationCounts& durations) {
  if (durations.count() == 0) return 0.0;
  return 1e-3 * static_cast<double>(durations.At((durations.count() - 1) * 99 / 100));
}

// Adds the largest displacement of each compliant part; 0 if the part is rigid.
void AddDeflections(const session::PeakDeflection& peak, std::vector<RunFigure>& figures) {
  constexpr double kLeast_mm = 0.02;  // smaller differences never count
  const auto add_mm = [&](const char* name, const char* key, double value_m) {
    figures.push_back(
        {.name = name, .key = key, .unit = "mm", .value = 1e3 * value_m, .least_difference = kLeast_mm});
  };
  add_mm("largest bend of the tool", "peak_bend_mm", peak.bend_m);
  add_mm("largest yield of the surface layer", "peak_layer_mm", peak.layer_m);
  add_mm("largest shift of the bone's mount", "peak_mount_mm", peak.mount_m);
  figures.push_back({.name = "largest turn of the bone's mount",
                     .key = "peak_mount_deg",
                     .unit = "deg",
                     .value = peak.mount_rad / kDegree,
                     .least_difference = 0.02});
}

// Adds the mean latencies of the run. They include the machine's computing times, so they are not judged.
void AddLatency(const Gathered& all, std::vector<RunFigure>& figures) {
  const session::LatencyFigures latency = all.latency.Figures(all.period_s, {});
  const auto add = [&](const char* name, const char* key, double value_s) {
    figures.push_back({.name = name, .key = key, .unit = "ms", .value = 1e3 * value_s, .judged = false});
  };
  add("latency from hand to arm", "latency_hand_to_arm_ms", latency.hand_to_arm_s);
  add("latency from bone to hand", "latency_bone_to_hand_ms", latency.bone_to_hand_s);
}

// Computes the figures of a run from its sums. The figures and their order are the same for all runs.
std::vector<RunFigure> Figures(const Gathered& all) {
  const auto ticks = static_cast<double>(std::max<std::uint64_t>(1, all.rendering));
  std::vector<RunFigure> figures{{.name = "rendered",
                                  .key = "rendered_s",
                                  .unit = "s",
                                  .value = all.period_s * static_cast<double>(all.rendering),
                                  .least_difference = 0.05},
                                 {.name = "peak force to the hand",
                                  .key = "peak_force_N",
                                  .unit = "N",
                                  .value = all.peak_force_N,
                                  .least_difference = 0.5},
                                 {.name = "mean force to the hand",
                                  .key = "mean_force_N",
                                  .unit = "N",
                                  .value = all.force_sum_N / ticks,
                                  .least_difference = 0.5},
                                 {.name = "peak force of the hand",
                                  .key = "peak_sensor_force_N",
                                  .unit = "N",
                                  .value = all.peak_hand_N,
                                  .least_difference = 0.5},
                                 {.name = "deepest tool in bone",
                                  .key = "peak_tool_in_bone_mm",
                                  .unit = "mm",
                                  .value = 1e3 * all.tool_in_bone_m,
                                  .least_difference = 0.05},
                                 {.name = "depth of the cut",
                                  .key = "cup_depth_mm",
                                  .unit = "mm",
                                  .value = 1e3 * all.depth_m,
                                  .least_difference = 0.02},
                                 {.name = "removed volume",
                                  .key = "removed_volume_mm3",
                                  .unit = "mm³",
                                  .value = 1e9 * all.removed_m3,
                                  .least_difference = 5.0},
                                 {.name = "removed mass",
                                  .key = "removed_mass_g",
                                  .unit = "g",
                                  .value = 1e3 * all.removed_kg,
                                  .least_difference = 0.005},
                                 {.name = "cutting work",
                                  .key = "cutting_work_J",
                                  .unit = "J",
                                  .value = all.work_J,
                                  .least_difference = 0.05},
                                 {.name = "peak tool speed",
                                  .key = "peak_tool_speed_mm_per_s",
                                  .unit = "mm/s",
                                  .value = 1e3 * all.peak_speed_m_per_s,
                                  .least_difference = 1.0},
                                 {.name = "least share of the coupling that the limits passed",
                                  .key = "min_wrench_share",
                                  .unit = "",
                                  .value = all.least_share,
                                  .least_difference = 0.02},
                                 {.name = "oldest contact model",
                                  .key = "max_model_age_ms",
                                  .unit = "ms",
                                  .value = 1e3 * all.most_age_s,
                                  .least_difference = 0.0,
                                  .judged = false},
                                 {.name = "tick, 99th percentile",
                                  .key = "tick_compute_p99_us",
                                  .unit = "µs",
                                  .value = Percentile99_us(all.compute),
                                  .least_difference = 0.0,
                                  .judged = false},
                                 {.name = "frame, 99th percentile",
                                  .key = "frame_p99_us",
                                  .unit = "µs",
                                  .value = Percentile99_us(all.frame),
                                  .least_difference = 0.0,
                                  .judged = false}};
  AddDeflections(all.deflected, figures);
  AddLatency(all, figures);
  return figures;
}

}  // namespace

tl::expected<RunFigures, std::string> ReadRunFigures(const std::filesystem::path& recording) {
  auto stream = io::RecordingStream::Open(recording);
  if (!stream) return tl::unexpected(stream.error());
  RunFigures run;
  run.limits.resize(safety::kLimitCount);
  Gathered all;
  base::Fnv1a hash;
  std::string bytes, excitation;
  std::uint32_t faults = 0;
  while (true) {
    const auto topic = stream->Next();
    if (!topic) return tl::unexpected(topic.error());
    if (*topic == io::RecordedTopic::kOther) break;
    if (*topic == io::RecordedTopic::kEvent) run.end = stream->event.text;
    if (*topic == io::RecordedTopic::kEvent && IsExcitation(stream->event.text))
      excitation = stream->event.text;
    if (*topic == io::RecordedTopic::kFrame) {
      AddFrame(stream->frame, all);
      run.depth_mm.Add(stream->frame.stamp, 1e3 * stream->frame.cup_depth_m);
      run.removed_mm3.Add(stream->frame.stamp, 1e9 * stream->frame.model.removed_volume_m3);
    }
    if (*topic != io::RecordedTopic::kTick) continue;
    control::TickRecord& tick = stream->tick;
    if (run.ticks == 0) run.first = tick.stamp;
    ++run.ticks;
    faults |= tick.faults;
    for (std::size_t i = 0; i < safety::kLimitCount; ++i) run.limits[i] += tick.limits >> i & 1u;
    AddTick(tick, all);
    run.force_N.Add(tick.stamp, Length(tick.F_coupling_T_W.f));
    tick.wakeup_ns = tick.compute_ns = 0;  // the hash leaves out the times that the machine took
    io::Encode(tick, bytes);
    hash.Add(bytes);
  }
  if (run.ticks == 0) return tl::unexpected(recording.string() + ": found no tick, accepted at least 1");
  session::ForEachFault([&](safety::Fault fault, const safety::FaultText&) {
    if ((faults & static_cast<std::uint32_t>(fault)) != 0) run.faults.Latch(fault);
  });
  run.session = stream->session;
  run.hash = hash.hash();
  run.end_error = stream->EndError();
  run.figures = Figures(all);
  if (!excitation.empty()) run.excited = ReadExcitedFigures(recording, run.session, excitation);
  return run;
}

}  // namespace osteon::studies
