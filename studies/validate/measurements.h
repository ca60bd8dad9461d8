#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <string_view>

namespace osteon::studies {

/// The kind of evidence that a row of `osteon validate` gives.
enum class RowUse : std::uint8_t {
  kValidates,   ///< a measured quantity to which nothing in the model was fitted
  kTrend,       ///< a ratio that shows how a measured quantity changes with a condition
  kRange,       ///< a measured range that the simulation should meet; it includes the operator's choice
  kTolerance,   ///< a just noticeable difference; the simulation's error should be smaller
  kCalibrates,  ///< a value to which a constant of the model was fitted, so that agreement proves nothing
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
  std::string_view source, conditions;       ///< origin and conditions of the measurement
  std::string_view leaves_out;               ///< effects that the row's simulation leaves out
  /// Unit of the last stated digit: a simulated value is rounded to it before the comparison. 0: not rounded.
  double resolution{0.0};

  /// Whether the row is judged: low and high are stated.
  [[nodiscard]] bool judged() const { return low == low && high == high; }
  /// Whether a simulated value, rounded to `resolution`, lies in the accepted range.
  [[nodiscard]] bool Contains(double value) const;
};

/// All measurements, in the order of the table. Most sources were read as abstracts or first pages only. A
/// condition that these do not state is given as "not stated".
[[nodiscard]] std::span<const Measurement> Measurements();

/// Finds the measurement with an id; null if there is none.
[[nodiscard]] const Measurement* FindMeasurement(std::string_view id);

}  // namespace osteon::studies
