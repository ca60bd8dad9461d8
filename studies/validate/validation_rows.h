#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "studies/validate/measurements.h"
#include "studies/validate/validation_lab.h"

namespace osteon::studies {

/// A row's quantity with one condition changed, to show the cause of the row's error.
struct Ablation {
  std::string what;
  double simulated{0.0};  ///< in the row's unit
};

/// A part that gives way in a variant of a row, and is rigid in the row's own run.
enum class CompliantPart : std::uint8_t {
  kTool,   ///< the tool bends, as its file's `bending` says
  kLayer,  ///< the cartilage yields, as the materials' file says
  kMount,  ///< the bone moves on the mount of cell pelvis_mount
};
/// "tool", "layer", "mount": the keys of a cell's `compliance`.
[[nodiscard]] std::string_view NameOf(CompliantPart part);

/// A row's quantity, simulated with a part that gives way.
struct ComplianceVariant {
  CompliantPart part{CompliantPart::kTool};
  std::optional<double> simulated{};  ///< in the row's unit; nothing: the run had no result
  std::string error{};                ///< why the run had no result
};

/// The outcome of a row's runs.
struct Simulated {
  double value{0.0};  ///< in the measurement's unit
  std::string how;    ///< which shipped parts ran, and how
  /// Constants of materials on which the value depends: "cortical.cutting_energy".
  std::vector<std::string> constants{};
  std::vector<Ablation> ablations{};
  std::string reason{};  ///< why the value may miss the range, as the ablations show
  /// Variants with a part that gives way, if the cell has such a part; `value` is without any.
  std::vector<ComplianceVariant> compliance{};

  /// The variant in which this part gives way; null if the row has none.
  [[nodiscard]] const ComplianceVariant* With(CompliantPart part) const;
};

/// A row of the table: a measurement, and how it is simulated.
struct ValidationItem {
  std::string_view id;  ///< of the measurement
  std::function<Simulated(ValidationLab&)> simulate;
  /// The cells that the item runs, so that they can run at the same time as those of other items.
  std::function<std::vector<CellTrialParams>(bool quick)> cells{};
};

/// One item for each measurement, in their order.
[[nodiscard]] std::span<const ValidationItem> ValidationItems();

/// A finished row.
struct ValidationRow {
  const Measurement* measurement{nullptr};
  Simulated simulated;
  std::string error{};  ///< why there is no result; empty if there is one

  /// Whether a constant on which the value depends was fitted to the row's own measurement.
  [[nodiscard]] bool fitted() const;
  /// Nothing if the source states no spread, or there is no result.
  [[nodiscard]] std::optional<bool> within() const;
  /// "within", "misses", "calibrates", "not judged", "no result"
  [[nodiscard]] std::string_view verdict() const;
};

/// Runs the items of these ids, or all if there is none. @param begins  called with an id before its run
[[nodiscard]] std::vector<ValidationRow> RunValidation(ValidationLab& lab, std::span<const std::string> ids,
                                                       const std::function<void(std::string_view)>& begins);

/// A just noticeable difference or a published hand that the product itself uses.
struct PublishedUse {
  std::string_view row, value, where;
};
/// All such figures, with the source's row, the value, and where the product uses it.
[[nodiscard]] std::span<const PublishedUse> PublishedUses();

}  // namespace osteon::studies
