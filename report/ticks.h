#pragma once

#include <span>
#include <string>
#include <vector>

namespace osteon::report {

struct Range {
  double min{0.0}, max{1.0};
};

/// The marks of an axis and their texts.
struct Ticks {
  std::vector<double> at;
  std::vector<std::string> labels;  ///< one for each of `at`; empty if a mark has no text
};

/// Places marks at multiples of 1, 2 or 5 times a power of ten, at most `max_count` of them, within [min,
/// max]. Empty if the range is not finite or not positive.
[[nodiscard]] Ticks LinearTicks(Range range, int max_count);

/// Places marks at 1, 2 and 5 times each power of ten within [min, max], min > 0. If the range has more than
/// `max_count`/3 decades, only the powers of ten have a text. If it has more than `max_count` decades, only
/// every second power or fewer have a text.
[[nodiscard]] Ticks LogTicks(Range range, int max_count);

/// Returns the smallest of 1, 2 and 5 times a power of ten that is not below `value`, which is above 0.
[[nodiscard]] double NiceStep(double value);

/// Returns the smallest range that contains `range` and begins and ends at a tick. A range of zero width is
/// widened.
[[nodiscard]] Range NiceRange(Range range, int max_count);

/// A point in the data's units or in pixels.
struct PlotPoint {
  double x, y;
};

/// Thins a curve for drawing in `columns` columns over [x.min, x.max]: in each column the first, smallest,
/// largest and last point are kept, in their order, so that every peak is drawn. Points outside the range are
/// dropped. A point that is not finite ends a line, and the next finite point begins another.
[[nodiscard]] std::vector<std::vector<PlotPoint>> DecimateMinMax(std::span<const double> x,
                                                                 std::span<const double> y, Range x_range,
                                                                 int columns);

}  // namespace osteon::report
