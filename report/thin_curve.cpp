#include "report/thin_curve.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <span>

namespace osteon::report {
namespace {

using Point = ThinCurve::Point;

// Appends the points of a bucket that are kept, in their order: the first, smallest, largest and last finite
// point, and the first gap.
void AppendExtremes(std::span<const Point> bucket, std::vector<Point>& kept) {
  const std::size_t none = bucket.size();
  std::size_t first = none, least = none, greatest = none, last = none, gap = none;
  for (std::size_t i = 0; i < bucket.size(); ++i) {
    const double value = bucket[i].value;
    if (!std::isfinite(value)) {
      gap = std::min(gap, i);
      continue;
    }
    if (first == none) first = least = greatest = i;
    if (value < bucket[least].value) least = i;
    if (value > bucket[greatest].value) greatest = i;
    last = i;
  }
  std::array<std::size_t, 5> keep{first, least, greatest, last, gap};
  std::sort(keep.begin(), keep.end());
  for (std::size_t i = 0; i < keep.size(); ++i)
    if (keep[i] != none && (i == 0 || keep[i] != keep[i - 1])) kept.push_back(bucket[keep[i]]);
}

}  // namespace

void ThinCurve::Add(rt::Nanoseconds stamp, double value) {
  points_.push_back({stamp, value});
  if (points_.size() < kMaxPoints) return;
  // a wider bucket consists of exactly two former buckets, so that points already thinned can be thinned
  // again
  for (Thin(); points_.size() > kMaxPoints / 2; Thin()) ++shift_;
}

void ThinCurve::Thin() {
  // buckets are counted from the curve's first stamp; unsigned numbers cannot overflow for any stamps in a
  // file
  const auto bucket_of = [origin = static_cast<std::uint64_t>(points_.front().stamp),
                          this](const Point& point) {
    return shift_ < 64 ? (static_cast<std::uint64_t>(point.stamp) - origin) >> shift_ : 0;
  };
  std::vector<Point> kept;
  for (std::size_t begin = 0; begin < points_.size();) {
    std::size_t end = begin + 1;
    while (end < points_.size() && bucket_of(points_[end]) == bucket_of(points_[begin])) ++end;
    AppendExtremes(std::span(points_).subspan(begin, end - begin), kept);
    begin = end;
  }
  points_ = std::move(kept);
}

std::pair<std::vector<double>, std::vector<double>> ThinCurve::Columns(rt::Nanoseconds start) const {
  std::pair<std::vector<double>, std::vector<double>> columns;
  for (const Point& point : points_) {
    columns.first.push_back(rt::ToSeconds(point.stamp - start));
    columns.second.push_back(point.value);
  }
  return columns;
}

}  // namespace osteon::report
