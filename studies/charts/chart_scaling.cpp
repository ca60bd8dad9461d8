#include "studies/charts/chart_scaling.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "base/interrupt.h"
#include "report/svg_plot.h"
#include "report/svg_text.h"
#include "session/process/exit_code.h"
#include "session/summary/chart_files.h"
#include "session/summary/summary.h"
#include "studies/charts/chart_items.h"
#include "studies/sharding/exact_number.h"
#include "studies/sharding/study_items.h"

namespace osteon::studies {
namespace {

// Names of the three series: our engine with more spheres below the same cut zone, our engine with spheres of
// one size everywhere, and the engine that tests every sphere in every frame.
constexpr const char* kFixed = "ours, cut zone as it is";
constexpr const char* kUniform = "ours, all of the bone alike";
constexpr const char* kBrute = "the same without culling";
// Numbers of spheres at which the chart has points.
constexpr std::array<std::size_t, 9> kCounts{1'000,   3'000,     10'000,    30'000,    100'000,
                                             300'000, 1'000'000, 3'000'000, 10'000'000};
constexpr std::size_t kBruteFrames = 60;  // timed at each point of the engine without culling
constexpr std::size_t kMinFrames = 20;    // a point with fewer frames has no median, and is left out

// Writes progress to standard error.
void Say(const std::string& text) { fmt::print(stderr, "osteon chart scaling: {}\n", text); }

// Measures the points of the chart, or reads them from the part files of a study that was split over
// machines.
class Scaling {
 public:
  Scaling(const ScalingOptions& options, StudyItems& items) : options_(options), items_(items) {
    result_.machine = items.FromParts() ? "" : session::MachineName();
    result_.max_spheres = options.max_spheres;
    result_.frames = options.frames;
  }

  // An item is one number of spheres in one of our series. The series without culling is measured with the
  // items of the first series.
  static std::size_t ItemCount(const ScalingOptions& options) {
    return 2 * static_cast<std::size_t>(std::ranges::count_if(
                   kCounts, [&](std::size_t count) { return count <= options.max_spheres; }));
  }

  // Measures everything; an error if nothing can be measured here.
  tl::expected<ScalingResult, std::string> Measure() {
    for (std::size_t item = 0; item < ItemCount(options_) && !base::Interrupted(); ++item) {
      if (items_.FromParts()) {
        items_.Restore(item, [this](const nlohmann::json& json) { Restore(json); });
      } else if (items_.Computes(item)) {
        const std::size_t points = result_.points.size(), left_out = result_.left_out.size(),
                          ours = result_.ours_left_out;
        if (const auto measured = MeasureCount(kCounts[item / 2], item % 2 == 1); !measured)
          return tl::unexpected(measured.error());
        if (items_.IsShard()) Store(item, points, left_out, result_.ours_left_out - ours);
      }
    }
    result_.interrupted = base::Interrupted();
    return std::move(result_);
  }

 private:
  // Stores what one item has added to the result, for the part file.
  // @param points, left_out  sizes of these lists before the item was measured
  // @param ours_left_out     number of our own points that the item has left out
  void Store(std::size_t item, std::size_t points, std::size_t left_out, std::size_t ours_left_out) {
    nlohmann::json added{{"machine", result_.machine},
                         {"tool_spheres", result_.tool_spheres},
                         {"ours_left_out", ours_left_out},
                         {"points", nlohmann::json::array()},
                         {"left_out", nlohmann::json::array()}};
    for (std::size_t i = points; i < result_.points.size(); ++i)
      added["points"].push_back(ScalingPointItem(result_.points[i]));
    for (std::size_t i = left_out; i < result_.left_out.size(); ++i)
      added["left_out"].push_back(result_.left_out[i]);
    items_.Store(item, std::move(added));
  }

  // Adds an item that Store has written to the result.
  void Restore(const nlohmann::json& item) {
    std::string machine;
    std::size_t ours_left_out = 0;
    std::vector<std::string> left_out;
    ReadAt(item, "machine", machine);
    ReadAt(item, "ours_left_out", ours_left_out);
    ReadAt(item, "left_out", left_out);
    AddName(result_.machine, machine);
    result_.ours_left_out += ours_left_out;
    std::ranges::move(left_out, std::back_inserter(result_.left_out));
    for (const nlohmann::json& point : item.at("points")) {
      result_.points.push_back(ScalingPointFrom(point));
      AddName(result_.device, result_.points.back().timing.device);
      ReadAt(item, "tool_spheres", result_.tool_spheres);
    }
  }

  FrameTimingParams Params(const std::string& method, std::size_t frames) const {
    return {.methods = {method},
            .device = options_.device,
            .frames = frames,
            .max_seconds = options_.max_seconds,
            .max_seat_seconds = options_.max_seconds,
            .pass_frames = 0,
            .progress = {}};
  }

  // Adds a point; leaves it out if there are too few frames for a median (a signal may end the timing before
  // the first frame). @returns whether it was added
  bool Add(const char* series, std::size_t count, const simulation::FrameWorkload& work,
           const FrameTiming& timing) {
    if (timing.frames < kMinFrames) {
      LeaveOut(series, count, "it was ended before there were enough frames");
      return false;
    }
    result_.device = timing.device;
    result_.tool_spheres = work.cutting_balls;
    result_.points.push_back({.series = series,
                              .spheres = work.bone.balls.size(),
                              .cut_zone_m = work.cut_zone_m,
                              .timing = timing});
    Say(fmt::format("{}: {} spheres: {:.1f} us a frame", series, work.bone.balls.size(),
                    timing.frame_us.p50_us));
    return true;
  }

  // Lists a point as not measured, with the reason.
  void LeaveOut(const char* series, std::size_t count, const std::string& why) {
    result_.left_out.push_back(fmt::format("{}, {} spheres: {}", series, count, why));
    if (std::string_view(series) != kBrute) ++result_.ours_left_out;
    Say("left out: " + result_.left_out.back());
  }

  // Measures our engine with `count` spheres and, unless they are uniform, the engine without culling too.
  // An error if the very first point can't be measured.
  tl::expected<void, std::string> MeasureCount(std::size_t count, bool uniform) {
    const char* series = uniform ? kUniform : kFixed;
    simulation::FrameWorkloadParams params = simulation::CupWorkload();
    params.spheres = count;
    if (uniform) params.grade = simulation::CountedGrade::kUniform;
    const simulation::FrameWorkload work = simulation::MakeFrameWorkload(params);
    const auto seated = Seat(work, Params("ours", options_.frames));
    if (!seated) {
      if (result_.points.empty() && !base::Interrupted()) return tl::unexpected(seated.error());
      LeaveOut(series, count, seated.error());
      return {};
    }
    const auto timed = TimeFrames(work, Params("ours", options_.frames), &*seated);
    if (!timed) return tl::unexpected(timed.error());
    if (!Add(series, count, work, timed->front()) || uniform) return {};

    // without culling a frame's time is proportional to the number of spheres: skip points that would take
    // too long
    const double expected_s = brute_us_per_sphere_ * 1e-6 * static_cast<double>(work.bone.balls.size()) *
                              static_cast<double>(kMinFrames);
    if (brute_refused_) return {};
    if (expected_s > options_.max_seconds) {
      LeaveOut(kBrute, count, fmt::format("{} frames would take {:.0f} s", kMinFrames, expected_s));
      return {};
    }
    const auto brute = TimeFrames(work, Params("brute", kBruteFrames), &*seated);
    if (!brute) {
      brute_refused_ = true;
      LeaveOut(kBrute, count, brute.error());
      return {};
    }
    if (!Add(kBrute, count, work, brute->front())) return {};
    brute_us_per_sphere_ = brute->front().frame_us.p50_us / static_cast<double>(work.bone.balls.size());
    return {};
  }

  const ScalingOptions& options_;
  StudyItems& items_;
  ScalingResult result_;
  double brute_us_per_sphere_{0.0};  // time per sphere at the last point without culling
  bool brute_refused_{false};        // the engine without culling doesn't run: its points are skipped
};

std::string Csv(const ScalingResult& result) {
  std::string csv =
      "series,spheres,tool_spheres,cut_zone_mm,frames,rate_hz,frame_us_p50,frame_us_p95,frame_us_p99,frame_"
      "us_p999,active_spheres_mean\n";
  for (const ScalingPoint& point : result.points) {
    const FrameTiming& t = point.timing;
    csv += fmt::format("\"{}\",{},{},{:.4f},{},{:.2f},{:.1f},{:.1f},{:.1f},{:.1f},{}\n", point.series,
                       point.spheres, result.tool_spheres, point.cut_zone_m * 1e3, t.frames, t.rate_hz(),
                       t.frame_us.p50_us, t.frame_us.p95_us, t.frame_us.p99_us, t.frame_us.p999_us,
                       t.active_spheres_mean ? fmt::format("{:.1f}", *t.active_spheres_mean) : "");
  }
  return csv;
}

std::vector<std::vector<std::string>> TableOf(const ScalingResult& result) {
  std::vector<std::vector<std::string>> rows{
      {"series", "spheres", "spacing where it is cut [mm]", "frames", "rate [Hz]", "p50 [us]", "p99 [us]"}};
  for (const ScalingPoint& point : result.points)
    rows.push_back({point.series, report::Number(static_cast<double>(point.spheres), 0),
                    report::Number(point.cut_zone_m * 1e3),
                    report::Number(static_cast<double>(point.timing.frames), 0),
                    report::Number(point.timing.rate_hz()), report::Number(point.timing.frame_us.p50_us),
                    report::Number(point.timing.frame_us.p99_us)});
  return rows;
}

// Checks the options, measures the chart and writes it, or the part of a shard. @returns the process's exit
// code
int Run(const ScalingOptions& options) {
  if (const std::string wrong = session::ValidateOutputFolder("--out", options.out); !wrong.empty())
    return session::Fail("chart scaling", wrong);
  if (const std::string wrong = ValidateSharding(options.sharding, options.json); !wrong.empty())
    return session::Fail("chart scaling", wrong);
  StudyItems items(options.sharding, fmt::format("scaling {} {} {} {}", options.max_spheres, options.device,
                                                 options.frames, options.max_seconds));
  if (const std::string wrong = items.Validate(Scaling::ItemCount(options)); !wrong.empty())
    return session::Fail("chart scaling", wrong);
  base::InstallInterrupt();
  const auto result = Scaling(options, items).Measure();
  if (!result) return session::Fail("chart scaling", result.error(), session::kFailed);
  if (items.IsShard()) {
    if (base::Interrupted()) return base::kExitInterrupted;
    const auto written = items.WritePart(options.json, Scaling::ItemCount(options));
    return written ? 0 : session::Fail("chart scaling", written.error(), session::kFailed);
  }
  if (result->points.empty())
    return base::Interrupted() ? base::kExitInterrupted
                               : session::Fail("chart scaling", "nothing was measured", session::kFailed);

  const session::Verdict verdict = Judge(*result);
  const std::string &machine = result->machine, json = ScalingJson(*result);
  std::vector<std::string> notes{
      fmt::format("{}; {}. A 50 mm reamer, pressed into the cup by 100 N at 250 rpm, is timed once it is "
                  "seated. With the cut zone as it is, more spheres fill the bone below it; from 100 000 "
                  "spheres to the most the median frame grows by {:.2f}. Rates are one over the median; bars "
                  "reach to the 95th percentile.",
                  result->device, machine, result->Growth())};
  for (const std::string& left : result->left_out) notes.push_back("Not measured: " + left);
  const session::ChartFiles chart{.name = "scaling",
                                  .title = "Frame rate against number of spheres",
                                  .verdict = verdict.ForReport(),
                                  .svg = ScalingSvg(*result),
                                  .caption = "After figure 4 of Kaluschke et al., IEEE VR 2019.",
                                  .csv = Csv(*result),
                                  .json = json,
                                  .json_copy = options.json,
                                  .table = TableOf(*result),
                                  .notes = notes};
  if (const auto written = session::WriteChart(chart, options.out); !written)
    return session::Fail("chart scaling", written.error(), session::kFailed);
  session::PrintVerdict(verdict, 28);
  for (const auto& row : chart.table)
    fmt::print("{:<28} {:>12} {:>10} {:>12} {:>12}\n", row[0], row[1], row[4].substr(0, 12), row[5], row[6]);
  fmt::print("{}\n", (options.out / "scaling.html").string());
  return base::Interrupted() ? base::kExitInterrupted : 0;
}

}  // namespace

session::Verdict Judge(const ScalingResult& result) {
  session::Verdict verdict;
  if (result.interrupted)
    verdict.Add(
        session::VerdictLevel::kBad,
        fmt::format(
            "it was ended by a signal: the chart is incomplete, {} points were measured of those up to "
            "{} spheres",
            result.points.size(), result.max_spheres));
  else if (result.ours_left_out > 0)
    verdict.Add(session::VerdictLevel::kWarning,
                fmt::format("the chart is incomplete: {} of our own points were not measured, see the notes",
                            result.ours_left_out));
  const auto few = std::ranges::count_if(result.points, [&](const ScalingPoint& point) {
    return point.series != kBrute && point.timing.frames < result.frames;
  });
  if (few > 0)
    verdict.Add(session::VerdictLevel::kWarning,
                fmt::format("{} of our own points were timed over fewer frames than the {} asked for", few,
                            result.frames));
  return verdict;
}

double ScalingResult::Growth() const {
  const ScalingPoint *first = nullptr, *last = nullptr;
  const auto log_distance = [](const ScalingPoint& point) {  // from 100 000 spheres
    return std::abs(std::log(static_cast<double>(point.spheres) / 1e5));
  };
  for (const ScalingPoint& point : points) {
    if (point.series != kFixed) continue;
    if (first == nullptr || log_distance(point) < log_distance(*first)) first = &point;
    last = &point;
  }
  return first == last || !(first->timing.frame_us.p50_us > 0.0)
             ? 0.0
             : last->timing.frame_us.p50_us / first->timing.frame_us.p50_us;
}

std::string ScalingSvg(const ScalingResult& result) {
  report::LineChart chart{.title = "Cutting frames a second",
                          .x_label = "spheres in the bone",
                          .y_label = "frame rate [Hz]",
                          .log_x = true,
                          .log_y = true,
                          .plot_height_px = 380.0};
  const std::pair<const char*, report::Marker> series[] = {{kFixed, report::Marker::kCircle},
                                                           {kUniform, report::Marker::kSquare},
                                                           {kBrute, report::Marker::kTriangle}};
  double least = HUGE_VAL, most = 0.0;
  for (const auto& [name, marker] : series) {
    report::Series drawn{.name = name, .width_px = 1.8, .marker = marker};
    for (const ScalingPoint& point : result.points) {
      if (point.series != name) continue;
      drawn.x.push_back(static_cast<double>(point.spheres));
      drawn.y.push_back(point.timing.rate_hz());
      drawn.y_low.push_back(1e6 / point.timing.frame_us.p95_us);
      drawn.y_high.push_back(point.timing.rate_hz());
      least = std::min(least, drawn.y_low.back());
      most = std::max(most, drawn.y.back());
    }
    if (!drawn.x.empty()) chart.series.push_back(std::move(drawn));
  }
  chart.series.push_back({.name = "the paper: 1 kHz up to 300 000 (GTX 1080 Ti)",
                          .x = {300e3},
                          .y = {1e3},
                          .color = report::kTextColor,
                          .width_px = 0.0,
                          .marker = report::Marker::kCross});
  chart.limits.push_back({.value = 1e3, .label = "1 kHz"});
  chart.y = report::Range{std::min(least, 500.0) / 1.4, std::max(most, 1.5e3) * 1.4};
  return report::Svg(chart, 860.0);
}

std::string ScalingJson(const ScalingResult& result) {
  nlohmann::ordered_json json{{"schema", "osteon.chart.scaling/1"},
                              {"subcommand", "chart scaling"},
                              {"device", result.device},
                              {"machine", result.machine},
                              {"tool_spheres", result.tool_spheres},
                              {"growth", result.Growth()},
                              {"left_out", result.left_out},
                              {"points", nlohmann::ordered_json::array()}};
  for (const ScalingPoint& point : result.points) {
    const FrameTiming& t = point.timing;
    nlohmann::ordered_json entry{{"series", point.series},
                                 {"method", t.method},
                                 {"spheres", point.spheres},
                                 {"cut_zone_mm", point.cut_zone_m * 1e3},
                                 {"frames", t.frames},
                                 {"rate_hz", t.rate_hz()},
                                 {"frame_us_p50", t.frame_us.p50_us},
                                 {"frame_us_p95", t.frame_us.p95_us},
                                 {"frame_us_p99", t.frame_us.p99_us},
                                 {"frame_us_p999", t.frame_us.p999_us},
                                 {"active_spheres_mean", nullptr}};
    if (t.active_spheres_mean) entry["active_spheres_mean"] = *t.active_spheres_mean;
    json["points"].push_back(std::move(entry));
  }
  return session::ResultText(Judge(result), json);
}

int RunChartScaling(const ScalingOptions& options) {
  try {
    return Run(options);
  } catch (const std::invalid_argument& error) {
    return session::Fail("chart scaling", error.what());
  }
}

}  // namespace osteon::studies
