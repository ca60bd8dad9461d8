#pragma once

#include <array>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "session/summary/verdict.h"
#include "simulation/fidelity/frame_workload.h"
#include "simulation/metrics/workload_scores.h"
#include "studies/charts/dominance.h"
#include "studies/charts/method_ladder.h"
#include "studies/sharding/shard.h"

namespace osteon::studies {

/// Options of `osteon chart speed-accuracy`: methods × resolutions on one workload.
struct SpeedAccuracyOptions {
  std::filesystem::path out{"speed_accuracy"};
  bool quick{false};     ///< fewer resolutions, 2 seeds
  std::string device{};  ///< part of a Vulkan device's name; empty: the default device
  std::size_t seeds{5};
  /// Limit for the time of a method's frames in a task; slower methods are left out, and listed.
  double max_seconds{60.0};
  std::vector<std::string> methods{};  ///< empty: all
  std::filesystem::path json{};
  Sharding sharding{};
};

/// The scores of one method at one resolution and one seed, over all tasks.
struct SeedScores {
  simulation::WorkloadScores scores;
  simulation::TimeFigures frame_us;
};

/// One point of the chart.
struct SpeedAccuracyPoint {
  std::string method, device;
  double length_m{0.0};    ///< length_m of its MethodStep
  std::size_t spheres{0};  ///< number of spheres or voxels of all four bones, seed 0
  double r_max_m{0.0};     ///< largest radius in the reamer's bone; for voxels half the edge
  std::vector<SeedScores> seeds{};
  std::map<std::string, simulation::WorkloadScores> tasks{};  ///< scores by task, of the first seed
};

/// The result of `osteon chart speed-accuracy`.
struct SpeedAccuracyResult {
  std::string machine, device;
  std::vector<SpeedAccuracyPoint> points;
  std::vector<std::string> left_out;  ///< points that were not measured, and why
  std::size_t wanted_seeds{0};        ///< requested number of seeds for each point
  bool interrupted{false};            ///< a signal ended it before all was measured
};

/// A figure of a point: median and range over its seeds.
struct SeedRange {
  double median{0.0}, low{0.0}, high{0.0};
};
/// The errors that the chart has a panel for.
enum class ChartFigure { kDepth, kVolume, kForce, kNormal, kRipple };
inline constexpr std::array kChartFigures{ChartFigure::kDepth, ChartFigure::kVolume, ChartFigure::kForce,
                                          ChartFigure::kNormal, ChartFigure::kRipple};
[[nodiscard]] SeedRange SeedRangeOf(const SpeedAccuracyPoint& point, ChartFigure figure);

/// The frame time of a point that is compared [us].
enum class ChartTime {
  kMedian,
  kWorst,  ///< the 99.9th percentile
};
[[nodiscard]] SeedRange FrameTimeOf(const SpeedAccuracyPoint& point, ChartTime time = ChartTime::kMedian);

/// Compares the other methods' points with those of our engines, for one error.
[[nodiscard]] Dominance DominanceOf(const SpeedAccuracyResult& result, ChartFigure figure, ChartTime time);
/// A row for each error: its name, then the points of CompareWithOurs, or "none".
[[nodiscard]] std::vector<std::vector<std::string>> DominanceTable(const SpeedAccuracyResult& result,
                                                                   ChartTime time);

/// "bad" if the chart was ended before all was measured; "look" if points are missing.
[[nodiscard]] session::Verdict Judge(const SpeedAccuracyResult& result);

/// Draws the depth error alone, at the width of a page's column.
[[nodiscard]] std::string DepthOverTimeSvg(const SpeedAccuracyResult& result);
/// Draws a panel for each error, log-log, one below the other.
[[nodiscard]] std::string SpeedAccuracySvg(const SpeedAccuracyResult& result,
                                           ChartTime time = ChartTime::kMedian);
/// JSON, schema osteon.chart.speed-accuracy/1.
[[nodiscard]] std::string SpeedAccuracyJson(const SpeedAccuracyResult& result);

/// @returns the process's exit code: 0; 1 if it can't run here; 2 bad input; 130 ended by Ctrl-C.
[[nodiscard]] int RunChartSpeedAccuracy(const SpeedAccuracyOptions& options);

}  // namespace osteon::studies
