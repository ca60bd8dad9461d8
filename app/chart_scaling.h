#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "app/frame_timing.h"
#include "app/verdict.h"

namespace osteon::app {

/// `osteon chart scaling`: the paper's figure 4, frame rate against number of spheres.
struct ScalingOptions {
  std::filesystem::path out{"scaling"};
  std::size_t max_spheres{10'000'000};
  std::string device{};
  std::size_t frames{1000};      ///< timed at each point
  double most_seconds{120.0};    ///< of a point; slower ones are left out, and said so
  std::filesystem::path json{};  ///< a further copy
};

/// One point of the chart.
struct ScalingPoint {
  std::string series;
  std::size_t spheres{0};
  double cut_zone_m{0.0};
  FrameTiming timing;
};

/// What came out.
struct ScalingResult {
  std::string device;
  std::size_t tool_spheres{0};
  std::vector<ScalingPoint> points;
  std::vector<std::string> left_out;  ///< what was not measured, and why
  std::size_t ours_left_out{0};       ///< of these, points of our own series
  std::size_t most_spheres{0};        ///< that were asked for
  std::size_t frames{0};              ///< asked for at each point of ours
  bool interrupted{false};            ///< ended by a signal before all was measured
  /// Median frame time at the most spheres over that at 100 000 (or the nearest), the cut zone as it is; 0
  /// where there are no two such points.
  [[nodiscard]] double Growth() const;
};

/// Bad where the chart was ended before all was measured; to be looked at where a point of ours is missing,
/// or was timed over fewer frames than asked for. A method that is too slow to be timed is a finding, said in
/// a note.
[[nodiscard]] Verdict Judge(const ScalingResult& result);

[[nodiscard]] std::string ScalingSvg(const ScalingResult& result);
/// schema osteon.chart.scaling/1
[[nodiscard]] std::string ScalingJson(const ScalingResult& result, const std::string& machine);

/// @returns the process's exit code: 0; 1 where it can't be run here; 2 bad input; 130 ended by Ctrl-C.
[[nodiscard]] int RunChartScaling(const ScalingOptions& options);

}  // namespace osteon::app
