#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <string_view>

namespace osteon::studies {

/// The kind of evidence that a row of `osteon validate` gives.
enum class RowUse : std::uint8_t {
  kValidates,   ///< a measured level to which nothing in the model was fitted
  kTrend,       ///< how a measured quantity changes with a condition, as a ratio
  kRange,       ///< a measured range, in which the simulation should lie: an operator's choice is part of it
  kTolerance,   ///< a just noticeable difference, below which the simulation should stay
  kCalibrates,  ///< a value to which a constant of the model was fitted, so the row shows nothing
};
/// "validates", "trend", "range", "tolerance", "calibrates".
[[nodiscard]] std::string_view NameOf(RowUse use);

/// No value: the source states none.
inline constexpr double kNotStated = std::numeric_limits<double>::quiet_NaN();

/// A quantity that others have measured.
struct Measurement {
  std::string_view id;  ///< number of the source's row and the case in that row: "9-1000"
  std::string_view quantity, unit;
  RowUse use{RowUse::kValidates};
  double measured{0.0};                      ///< in `unit`
  double low{kNotStated}, high{kNotStated};  ///< accepted range; not stated: the row is not judged
  std::string_view spread;                   ///< origin of low and high
  std::string_view source, conditions;       ///< of the measurement
  std::string_view leaves_out;               ///< effects that the row's simulation leaves out
  /// Last stated digit, to which a simulated value is rounded before it is compared; 0: not rounded.
  double resolution{0.0};

  /// Whether there is an accepted range.
  [[nodiscard]] bool judged() const { return low == low && high == high; }
  /// Whether a simulated value, rounded to `resolution`, lies in the accepted range.
  [[nodiscard]] bool Contains(double value) const;
};

/// All measurements, in the order of the table. Most sources were read as abstracts or first pages; if they
/// do not state a condition, the row says "not stated".
[[nodiscard]] std::span<const Measurement> Measurements();

/// Finds the measurement with an id; null if there is none.
[[nodiscard]] const Measurement* FindMeasurement(std::string_view id);

}  // namespace osteon::studies
