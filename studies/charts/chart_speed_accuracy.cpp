#include "studies/charts/chart_speed_accuracy.h"

#include <algorithm>
#include <chrono>
#include <deque>
#include <numeric>
#include <optional>
#include <stdexcept>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/interrupt.h"
#include "base/write_text.h"
#include "report/svg_text.h"
#include "session/process/exit_code.h"
#include "session/summary/chart_files.h"
#include "studies/bench/method_engine.h"
#include "studies/charts/chart_items.h"
#include "studies/sharding/exact_number.h"
#include "studies/sharding/study_items.h"

namespace osteon::studies {
namespace {

// Number of cells on the cut's surface at which the depth error is measured (AccuracyParams).
constexpr std::size_t kSurfaceCells = 20'000, kQuickSurfaceCells = 6'000;

// Writes progress to standard error.
void Say(const std::string& text) { fmt::print(stderr, "osteon chart speed-accuracy: {}\n", text); }

double Now_s() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

// A task at one seed with its mass points: made once, used by every method.
struct PlacedTask {
  simulation::CutWorkload work;
  std::vector<simulation::MassPoint> points;
};

// Measures every step of the ladder at every seed, or reads them from the part files of a study that was
// split over machines.
class Measurement {
 public:
  Measurement(const SpeedAccuracyOptions& options, StudyItems& items) : options_(options), items_(items) {
    if (!items.FromParts()) result_.machine = session::MachineName();
    for (MethodStep& step : MethodLadder(options.quick))
      if (options.methods.empty() || std::ranges::find(options.methods, step.method) != options.methods.end())
        rungs_.push_back(
            {.step = step, .point = {.method = step.method, .device = {}, .length_m = step.length_m}});
  }

  // Number of items of a study that is split: an item is a seed.
  static std::size_t ItemCount(const SpeedAccuracyOptions& options) {
    return options.quick ? std::min<std::size_t>(2, options.seeds) : options.seeds;
  }

  // Measures one seed with all methods before the next seed, so that a slow period of the machine affects all
  // methods alike.
  tl::expected<SpeedAccuracyResult, std::string> Measure() {
    const std::size_t seeds = ItemCount(options_);
    result_.wanted_seeds = seeds;
    for (std::size_t seed = 0; seed < seeds && !base::Interrupted(); ++seed) {
      if (items_.FromParts()) items_.Restore(seed, [&](const nlohmann::json& item) { Restore(item, seed); });
      if (!items_.Computes(seed)) continue;
      std::vector<PlacedTask> tasks;
      for (const simulation::CutTask task : simulation::kCutTasks) {
        PlacedTask placed{.work = MakeCutWorkload(task, WorkParams(seed)), .points = {}};
        placed.points = LadderPoints(placed.work);
        tasks.push_back(std::move(placed));
      }
      for (Rung& rung : rungs_) {
        if (rung.left_out || base::Interrupted()) continue;
        if (const auto measured = MeasureSeed(rung, tasks, seed); !measured)
          return tl::unexpected(measured.error());
      }
      if (items_.IsShard()) Store(seed);
    }
    result_.interrupted = base::Interrupted();
    for (Rung& rung : rungs_)
      if (!rung.point.seeds.empty() && !rung.left_out) result_.points.push_back(std::move(rung.point));
    return std::move(result_);
  }

 private:
  // One step of the ladder, with its results so far.
  struct Rung {
    MethodStep step;
    SpeedAccuracyPoint point;
    bool left_out{false};
    std::string why_left_out{};
  };

  // Stores what a seed has added to each step of the ladder, for the part file.
  void Store(std::size_t seed) {
    nlohmann::json rungs = nlohmann::json::array();
    for (const Rung& rung : rungs_) {
      if (rung.left_out) {
        rungs.push_back({{"left_out", rung.why_left_out}});
        continue;
      }
      const SpeedAccuracyPoint& point = rung.point;
      nlohmann::json tasks = nlohmann::json::object();
      if (seed == 0)
        for (const auto& [task, scores] : point.tasks) tasks[task] = ScoresItem(scores);
      rungs.push_back({{"scores", ScoresItem(point.seeds.back().scores)},
                       {"frame_us", FiguresItem(point.seeds.back().frame_us)},
                       {"device", point.device},
                       {"spheres", point.spheres},
                       {"r_max_m", ExactNumber(point.r_max_m)},
                       {"tasks", std::move(tasks)}});
    }
    items_.Store(seed, {{"machine", result_.machine}, {"rungs", std::move(rungs)}});
  }

  // Adds a seed's item that Store has written to the rungs.
  void Restore(const nlohmann::json& item, std::size_t seed) {
    std::string machine, device;
    ReadAt(item, "machine", machine);
    AddName(result_.machine, machine);
    for (std::size_t i = 0; i < rungs_.size(); ++i) {
      Rung& rung = rungs_[i];
      const nlohmann::json& kept = item.at("rungs").at(i);
      if (rung.left_out) continue;
      if (kept.contains("left_out")) {
        LeaveOut(rung, kept["left_out"].get<std::string>());
        continue;
      }
      SpeedAccuracyPoint& point = rung.point;
      point.seeds.push_back(
          {.scores = ScoresFrom(kept.at("scores")), .frame_us = FiguresFrom(kept.at("frame_us"))});
      ReadAt(kept, "device", device);
      NoteDevice(rung, device);
      if (seed > 0) continue;
      ReadAt(kept, "spheres", point.spheres);
      ReadAt(kept, "r_max_m", point.r_max_m);
      for (const auto& [task, scores] : kept.at("tasks").items()) point.tasks[task] = ScoresFrom(scores);
    }
  }

  // Sets the device of a rung. The result names the device of "ours", or else of another of our engines.
  void NoteDevice(Rung& rung, const std::string& device) {
    rung.point.device = device;
    if (rung.step.method == "ours" || (result_.device.empty() && IsOurs(rung.step.method)))
      result_.device = device;
  }

  simulation::CutWorkloadParams WorkParams(std::size_t seed) const {
    return {.seed = seed,
            .feed_m_per_s = options_.quick ? 0.060 : 0.020,
            .feel_m_per_s = options_.quick ? 0.080 : 0.040};
  }

  // Lists a rung as not measured, with the reason; no further seed of it is measured.
  void LeaveOut(Rung& rung, const std::string& why) {
    rung.left_out = true;
    rung.why_left_out = why;
    result_.left_out.push_back(
        fmt::format("{} at {:g} mm: {}", rung.step.method, rung.step.length_m * 1e3, why));
    Say("left out: " + result_.left_out.back());
  }

  // The task's bone, packed for a step; reused if an earlier step of this seed has the same packing.
  const LadderBone& Packed(const MethodStep& step, const PlacedTask& task, std::size_t seed) {
    if (packed_seed_ != seed) packed_.clear();
    packed_seed_ = seed;
    for (const Packing& known : packed_)
      if (known.task == task.work.task && SharePacking(known.step, step)) return known.bone;
    packed_.push_back(
        {.step = step, .task = task.work.task, .bone = PackForStep(step, task.work, task.points, seed)});
    return packed_.back().bone;
  }

  // Runs a step on every task at one seed and adds the scores to the rung, or leaves the rung out. An error
  // only if the device that was asked for can't be used.
  tl::expected<void, std::string> MeasureSeed(Rung& rung, const std::vector<PlacedTask>& tasks,
                                              std::size_t seed) {
    std::vector<simulation::WorkloadScores> scores;
    std::vector<double> frame_us;
    std::size_t elements = 0;
    std::string device;
    for (const PlacedTask& task : tasks) {
      const LadderBone& packed = Packed(rung.step, task, seed);
      auto engine = MakeMethodEngine(packed.bone, task.work.solid.get(), task.work.tool,
                                     CuttingForStep(rung.step, task.work),
                                     {.method = EngineOfStep(rung.step),
                                      .device = options_.device,
                                      .voxel_m = ScaledLength(rung.step.length_m, task.work)});
      if (!engine) {
        // a device that was asked for by name must be there
        if (EngineOfStep(rung.step) == "ours" && !options_.device.empty())
          return tl::unexpected(engine.error());
        LeaveOut(rung, engine.error());
        return {};
      }
      const auto before = ShapeOf(**engine);
      const double end_s = Now_s() + options_.max_seconds;
      const simulation::WorkloadRun run = RunWorkload(
          **engine, task.work, [&](std::size_t) { return base::Interrupted() || Now_s() > end_s; });
      if (!run.complete) {
        if (base::Interrupted()) return {};
        LeaveOut(rung, fmt::format("{} was not done within {:g} s", TaskName(task.work.task),
                                   options_.max_seconds));
        return {};
      }
      scores.push_back(ScoreWorkload(task.work, run, *before, *ShapeOf(**engine),
                                     options_.quick ? kQuickSurfaceCells : kSurfaceCells));
      frame_us.insert(frame_us.end(), run.frame_us.begin(), run.frame_us.end());
      elements += ElementsOf(**engine, packed.bone);
      device = (*engine)->device();
      if (task.work.task == simulation::CutTask::kReam && seed == 0) rung.point.r_max_m = packed.r_max_m;
      if (seed == 0) rung.point.tasks[std::string(TaskName(task.work.task))] = scores.back();
    }
    if (seed == 0) rung.point.spheres = elements;
    NoteDevice(rung, device);
    rung.point.seeds.push_back(
        {.scores = simulation::Combined(scores), .frame_us = simulation::FiguresOf(std::move(frame_us))});
    const SeedScores& last = rung.point.seeds.back();
    Say(fmt::format(
        "seed {}: {} {:g} mm: {:.0f} us, depth {:.4f} mm, volume {:.4f}, force {:.4f}, ripple {:.4f}", seed,
        rung.step.method, rung.step.length_m * 1e3, last.frame_us.p50_us, last.scores.depth_error_m * 1e3,
        last.scores.volume_error, last.scores.force.force_relative, last.scores.ripple));
    return {};
  }

  // A task's bone, packed for a step.
  struct Packing {
    MethodStep step;
    simulation::CutTask task;
    LadderBone bone;
  };

  const SpeedAccuracyOptions& options_;
  StudyItems& items_;
  std::vector<Rung> rungs_;
  std::deque<Packing> packed_;  ///< packings of one seed; a deque, so that references stay valid
  std::size_t packed_seed_{0};
  SpeedAccuracyResult result_;
};

std::vector<std::vector<std::string>> TableOf(const SpeedAccuracyResult& result) {
  std::vector<std::vector<std::string>> rows{{"method", "spheres or voxels", "r max or half a voxel [mm]",
                                              "frame p50 [us]", "p99.9 [us]", "depth error [mm]",
                                              "volume error", "force error", "normal [deg]", "ripple"}};
  for (const SpeedAccuracyPoint& point : result.points) {
    rows.push_back({point.method, report::Number(static_cast<double>(point.spheres), 0),
                    report::Number(point.r_max_m * 1e3, 3), report::Number(FrameTimeOf(point).median),
                    report::Number(FrameTimeOf(point, ChartTime::kWorst).median),
                    fmt::format("{:.4f}", SeedRangeOf(point, ChartFigure::kDepth).median),
                    fmt::format("{:.4f}", SeedRangeOf(point, ChartFigure::kVolume).median),
                    fmt::format("{:.4f}", SeedRangeOf(point, ChartFigure::kForce).median),
                    fmt::format("{:.2f}", SeedRangeOf(point, ChartFigure::kNormal).median),
                    fmt::format("{:.4f}", SeedRangeOf(point, ChartFigure::kRipple).median)});
  }
  return rows;
}

// "llvmpipe …; one thread, AVX-512": the devices that our engines ran on.
std::string OurDevices(const SpeedAccuracyResult& result) {
  std::vector<std::string> devices;
  for (const SpeedAccuracyPoint& point : result.points)
    if (IsOurs(point.method) && std::ranges::count(devices, point.device) == 0)
      devices.push_back(point.device);
  return devices.empty() ? "no device" : fmt::format("{}", fmt::join(devices, "; "));
}

void PrintTable(const std::vector<std::vector<std::string>>& rows) {
  for (const auto& row : rows) fmt::print("{}\n", fmt::join(row, "  "));
}

// One line for each error, as a table is too wide for a terminal.
void PrintDominance(const char* heading, const std::vector<std::vector<std::string>>& rows) {
  fmt::print("{}\n", heading);
  for (std::size_t i = 1; i < rows.size(); ++i)
    for (std::size_t column = 1; column < rows[i].size(); ++column)
      fmt::print("  {:<8} {}: {}\n", column == 1 ? rows[i][0] : "", rows[0][column], rows[i][column]);
}

std::string Csv(const SpeedAccuracyResult& result) {
  std::string csv =
      "method,length_mm,spheres,r_max_mm,seed,frame_us_p50,frame_us_p999,depth_error_mm,lost_mm,left_mm,"
      "probe_p95_mm,volume_error,force_error,normal_error_deg,ripple\n";
  for (const SpeedAccuracyPoint& point : result.points)
    for (std::size_t seed = 0; seed < point.seeds.size(); ++seed) {
      const SeedScores& s = point.seeds[seed];
      csv += fmt::format(
          "{},{:g},{},{:.4f},{},{:.1f},{:.1f},{:.5f},{:.5f},{:.5f},{:.5f},{:.5f},{:.5f},{:.3f},{:.5f}\n",
          point.method, point.length_m * 1e3, point.spheres, point.r_max_m * 1e3, seed, s.frame_us.p50_us,
          s.frame_us.p999_us, s.scores.depth_error_m * 1e3, s.scores.lost_m * 1e3, s.scores.left_m * 1e3,
          s.scores.probe_p95_m * 1e3, s.scores.volume_error, s.scores.force.force_relative,
          s.scores.force.normal_rms_deg, s.scores.ripple);
    }
  return csv;
}

// Checks the options, measures the chart and writes it, or the part of a shard. @returns the process's exit
// code
int Run(const SpeedAccuracyOptions& options) {
  if (const std::string wrong = session::ValidateOutputFolder("--out", options.out); !wrong.empty())
    return session::Fail("chart speed-accuracy", wrong);
  if (const std::string wrong = ValidateSharding(options.sharding, options.json); !wrong.empty())
    return session::Fail("chart speed-accuracy", wrong);
  const std::size_t count = Measurement::ItemCount(options);
  StudyItems items(options.sharding,
                   fmt::format("speed-accuracy {} {} {} {} {}", options.quick, options.device, count,
                               options.max_seconds, fmt::join(options.methods, " ")));
  if (const std::string wrong = items.Validate(count); !wrong.empty())
    return session::Fail("chart speed-accuracy", wrong);
  base::InstallInterrupt();
  const auto result = Measurement(options, items).Measure();
  if (!result) return session::Fail("chart speed-accuracy", result.error(), session::kFailed);
  if (items.IsShard()) {
    if (base::Interrupted()) return base::kExitInterrupted;
    const auto written = items.WritePart(options.json, count);
    return written ? 0 : session::Fail("chart speed-accuracy", written.error(), session::kFailed);
  }
  if (result->points.empty())
    return base::Interrupted()
               ? base::kExitInterrupted
               : session::Fail("chart speed-accuracy", "nothing was measured", session::kFailed);
  std::vector<std::string> notes{
      fmt::format("Ours on {}; the other methods in double precision on one thread of {}.",
                  OurDevices(*result), result->machine),
      "Four tasks: a ball of 5 mm plunges 5 mm into a block, and slides 6 mm along it; a reamer of 25 mm "
      "goes 3 mm deeper in its cup; a burr of 1.5 mm drills a channel of 9 mm. Then the same tool is pressed "
      "0.5 mm off its own way with the spindle still, and the force is compared with the spring's, which is "
      "exact there. Points are medians of the seeds, errors root mean squares over the tasks; bars reach "
      "from the least to the greatest seed. What is below 0.0001 is drawn there. Depth: bone lost beyond the "
      "sweep and left within it, over the cut's area, each packing against its own uncut self, which "
      "flatters disjoint ones. Ripple is over the exact mean force.",
      "Other methods beside ours: a point is faster and more exact than one of ours if both its time and its "
      "error are smaller; it is ahead of ours if none of ours is at once as fast and as exact, and one of "
      "ours is as fast.",
      "Labels: spheres or voxels of the four bones together, where balls are split as many as there are in "
      "the end, and the greatest radius r or the voxel's edge h in mm at the reamer; smaller tools have "
      "finer bones."};
  for (const std::string& left : result->left_out) notes.push_back("Not measured: " + left);
  const session::Verdict verdict = Judge(*result);
  const std::string json = SpeedAccuracyJson(*result);
  const std::string caption = fmt::format("{}; {}", OurDevices(*result), result->machine);
  const auto by_median = DominanceTable(*result, ChartTime::kMedian),
             by_worst = DominanceTable(*result, ChartTime::kWorst);
  const char* const kByMedian = "Other methods beside ours, by the median";
  const char* const kByWorst = "Other methods beside ours, by the 99.9th percentile";
  const session::ChartFiles chart{.name = "speed_accuracy",
                                  .title = "Speed and accuracy",
                                  .verdict = verdict.ForReport(),
                                  .svg = SpeedAccuracySvg(*result),
                                  .caption = caption,
                                  .csv = Csv(*result),
                                  .json = json,
                                  .json_copy = options.json,
                                  .table = TableOf(*result),
                                  .notes = notes,
                                  .parts = {{.heading = kByMedian, .table = by_median},
                                            {.heading = "The worst frame in a thousand",
                                             .name = "speed_accuracy_worst",
                                             .svg = SpeedAccuracySvg(*result, ChartTime::kWorst),
                                             .caption = caption},
                                            {.heading = kByWorst, .table = by_worst}}};
  if (const auto written = session::WriteChart(chart, options.out); !written)
    return session::Fail("chart speed-accuracy", written.error(), session::kFailed);
  if (const auto written =
          base::WriteText(options.out / "speed_accuracy_depth.svg", DepthOverTimeSvg(*result));
      !written)
    return session::Fail("chart speed-accuracy", written.error(), session::kFailed);
  session::PrintVerdict(verdict, 10);
  PrintTable(chart.table);
  PrintDominance(kByMedian, by_median);
  PrintDominance(kByWorst, by_worst);
  fmt::print("{}\n", (options.out / "speed_accuracy.html").string());
  return base::Interrupted() ? base::kExitInterrupted : 0;
}

}  // namespace

session::Verdict Judge(const SpeedAccuracyResult& result) {
  session::Verdict verdict;
  if (result.interrupted)
    verdict.Add(
        session::VerdictLevel::kBad,
        fmt::format(
            "it was ended by a signal: the chart is incomplete, {} points were measured, of {} seeds each "
            "where all was done",
            result.points.size(), result.wanted_seeds));
  for (const std::string& left : result.left_out)
    verdict.Add(session::VerdictLevel::kWarning, "not measured: " + left);
  const auto few = std::ranges::count_if(
      result.points, [&](const SpeedAccuracyPoint& p) { return p.seeds.size() < result.wanted_seeds; });
  if (few > 0)
    verdict.Add(session::VerdictLevel::kWarning,
                fmt::format("{} points were measured over fewer than {} seeds", few, result.wanted_seeds));
  return verdict;
}

int RunChartSpeedAccuracy(const SpeedAccuracyOptions& options) {
  try {
    return Run(options);
  } catch (const std::invalid_argument& error) {
    return session::Fail("chart speed-accuracy", error.what());
  }
}

}  // namespace osteon::studies
