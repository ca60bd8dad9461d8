#pragma once

#include <cstddef>
#include <utility>
#include <vector>

#include "base/clock.h"

namespace osteon::report {

/// A curve over time for a chart, for runs of any length. It keeps every point while there are fewer than
/// kMaxPoints. Beyond that it divides time into buckets, and keeps in each bucket the first, smallest,
/// largest and last point and the first point that is not finite (a gap), so that no peak is lost. If too
/// many points are kept, the buckets are doubled in width. At least kMaxPoints / 20 buckets remain, which is
/// several for each pixel of a chart.
class ThinCurve {
 public:
  static constexpr std::size_t kMaxPoints = std::size_t{1} << 16;  ///< points of 65 s at 1 kHz; 1 MiB

  struct Point {
    rt::Nanoseconds stamp;
    double value;
  };

  /// Adds a point; stamps must ascend.
  void Add(rt::Nanoseconds stamp, double value);

  [[nodiscard]] const std::vector<Point>& points() const { return points_; }
  /// Returns two columns: seconds since `start`, and the values.
  [[nodiscard]] std::pair<std::vector<double>, std::vector<double>> Columns(rt::Nanoseconds start) const;

 private:
  void Thin();

  std::vector<Point> points_;
  int shift_{20};  // a bucket is 2^shift_ ns wide
};

}  // namespace osteon::report
