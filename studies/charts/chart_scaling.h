#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "session/summary/verdict.h"
#include "studies/bench/frame_timing.h"
#include "studies/sharding/shard.h"

namespace osteon::studies {

/// Options of `osteon chart scaling`: the paper's figure 4, frame rate against number of spheres.
struct ScalingOptions {
  std::filesystem::path out{"scaling"};
  std::size_t max_spheres{10'000'000};  ///< larger bones are not measured
  std::string device{};                 ///< part of a Vulkan device's name; empty: the default device
  std::size_t frames{1000};             ///< timed at each point
  double max_seconds{120.0};            ///< per point; slower points are left out and listed
  std::filesystem::path json{};         ///< a second copy of the JSON file
  Sharding sharding{};
};

/// One point of the chart.
struct ScalingPoint {
  std::string series;
  std::size_t spheres{0};
  double cut_zone_m{0.0};  ///< spacing of the spheres where the bone is cut
  FrameTiming timing;
};

/// The result of `osteon chart scaling`.
struct ScalingResult {
  std::string machine, device;
  std::size_t tool_spheres{0};
  std::vector<ScalingPoint> points;
  std::vector<std::string> left_out;  ///< points that were not measured, and why
  std::size_t ours_left_out{0};       ///< number of left-out points of our own series
  std::size_t max_spheres{0};         ///< largest number of spheres that was requested
  std::size_t frames{0};              ///< number of frames requested at each of our points
  bool interrupted{false};            ///< a signal ended it before all was measured
  /// Returns the median frame time at the most spheres divided by that at 100 000 (or the nearest), with the
  /// cut zone unchanged; 0 if there are no two such points.
  [[nodiscard]] double Growth() const;
};

/// "bad" if the chart was ended before all was measured. "look" if one of our points is missing, or was timed
/// over fewer frames than requested. A method that is too slow to be timed is a finding, stated in a note.
[[nodiscard]] session::Verdict Judge(const ScalingResult& result);

[[nodiscard]] std::string ScalingSvg(const ScalingResult& result);
/// JSON, schema osteon.chart.scaling/1.
[[nodiscard]] std::string ScalingJson(const ScalingResult& result);

/// @returns the process's exit code: 0; 1 if it can't run here; 2 bad input; 130 ended by Ctrl-C.
[[nodiscard]] int RunChartScaling(const ScalingOptions& options);

}  // namespace osteon::studies
