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

/// A part that yields in a variant of a row. In the row's own run, all parts are rigid.
enum class CompliantPart : std::uint8_t {
  kTool,   ///< the tool bends, as its file's `bending` says
  kLayer,  ///< the cartilage yields, as the materials' file says
  kMount,  ///< the bone moves on the mount of cell pelvis_mount
};
/// "tool", "layer", "mount": the keys of a cell's `compliance`.
[[nodiscard]] std::string_view NameOf(CompliantPart part);

/// A row's quantity, simulated with one part that yields.
struct ComplianceVariant {
  CompliantPart part{CompliantPart::kTool};
  std::optional<double> simulated{};  ///< in the row's unit; nothing: the run had no result
  std::string error{};                ///< why the run had no result
};

/// The outcome of a row's runs.
struct Simulated {
  double value{0.0};  ///< result, in the measurement's unit
  std::string how;    ///< which shipped parts ran, and how
  /// Names of the material constants on which the value depends, e.g. "cortical.cutting_energy".
  std::vector<std::string> constants{};
  std::vector<Ablation> ablations{};
  std::string reason{};  ///< why the value may be outside the accepted range; the ablations show it
  /// One variant for each part of the cell that can yield; `value` has rigid parts only.
  std::vector<ComplianceVariant> compliance{};

  /// The variant in which this part yields; null if the row has none.
  [[nodiscard]] const ComplianceVariant* With(CompliantPart part) const;
};

/// A row of the table: a measurement, and how it is simulated.
struct ValidationItem {
  std::string_view id;  ///< id of the measurement
  std::function<Simulated(ValidationLab&)> simulate;
  /// The cells that the item runs. They can run at the same time as those of other items.
  std::function<std::vector<CellTrialParams>(bool quick)> cells{};
};

/// One item for each measurement, in their order.
[[nodiscard]] std::span<const ValidationItem> ValidationItems();

/// A row of the table with its result.
struct ValidationRow {
  const Measurement* measurement{nullptr};
  Simulated simulated;
  std::string error{};  ///< why there is no result; empty if there is one

  /// Whether a constant on which the value depends was fitted to the row's own measurement.
  [[nodiscard]] bool fitted() const;
  /// Whether the value lies in the accepted range; nothing if the source states no spread, or there is no
  /// result.
  [[nodiscard]] std::optional<bool> within() const;
  /// The outcome in words: "within", "misses", "calibrates", "not judged", "no result".
  [[nodiscard]] std::string_view verdict() const;
};

/// Runs the items with these ids, or all items if the list is empty. @param begins  called with each item's
/// id before its run
[[nodiscard]] std::vector<ValidationRow> RunValidation(ValidationLab& lab, std::span<const std::string> ids,
                                                       const std::function<void(std::string_view)>& begins);

/// A figure from the literature that the product itself uses: a just noticeable difference, or a figure of a
/// hand.
struct PublishedUse {
  std::string_view row, value, where;
};
/// All these figures, each with the source's row, the value, and the place where the product uses it.
[[nodiscard]] std::span<const PublishedUse> PublishedUses();

}  // namespace osteon::studies
