#pragma once

#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "config/reading/cell_config.h"
#include "config/reading/strict/reader.h"

// Checks whether a cell's geometry (base X_WB, bone X_WG, tool X_FT, workspace, start) is consistent. A pose
// that was measured wrongly, or written in another unit, is valid by itself. Its error shows only in a
// comparison with the other poses.

namespace osteon::config {

/// One quantity of a registration, and its accepted range: a row of the table that is shown before a run.
struct RegistrationRow {
  std::string name;   ///< "from the arm's base to the site"
  double value{0.0};  ///< value of the quantity, in `unit`
  std::string unit;   ///< "mm", "deg"
  double low{-std::numeric_limits<double>::infinity()};
  double high{std::numeric_limits<double>::infinity()};
  /// section and key of the cell's file that are probably wrong if the row does not hold
  std::string section, key;
  std::string hint;  ///< likely cause of a failure; may be empty
  std::string note;  ///< remark if the row holds; may be empty

  /// Whether the value is in the accepted range, up to rounding.
  [[nodiscard]] bool holds() const noexcept { return value >= low - 1e-9 && value <= high + 1e-9; }
  /// "150.0 … 1126.0 mm", "at least 1.0 deg"; "any" if nothing is refused.
  [[nodiscard]] std::string accepted() const;
  /// "ok", "note: …" or "refused: accepted …".
  [[nodiscard]] std::string verdict() const;
};

struct RegistrationReport {
  std::vector<RegistrationRow> rows;
};

/// All checks, measured on a cell that LoadCell has returned.
///
/// | what | accepted |
/// |---|---|
/// | base to site | the base's foot and a bone have room beside each other: 150 mm or more |
/// | shoulder to site | the stretched arm's reach with the tool's apex |
/// | flange to apex | below 600 mm |
/// | the tool's rotation | a rotation, to 1e-6 |
/// | the site's room in the workspace | site radius + depth of the work below it, to every bound |
/// | the base's tilt from the vertical | any; noted, since the arm's own controller must know of it |
/// | start: joints | joint_margin_deg or more from the limits |
/// | start: the apex in the workspace | inside |
/// | start: tool axis from the site's axis | points into the bone, to 60 deg |
/// | start: flange above the workspace's plane | above |
/// | start: the apex before the depth limit's bound | before, if the cell has a depth limit |
/// | start: flange and elbow in their zones | inside, if the cell has zones for them |
///
/// The start's values are computed from its joints by forward kinematics (W to B to F to T), independently of
/// the inverse kinematics that found the joints. The depth of the work is that of the scene's zone: the
/// deepest point of a path, or the bottom of a cup.
[[nodiscard]] RegistrationReport DescribeRegistration(const CellConfig& cell);

/// Checks the rows of base, bone, tool and workspace before the arm is placed at the start, because a mistake
/// in one of them makes the placement impossible, and the resulting error could not tell which one is wrong.
/// @param reader  of the cell's file
/// @throws ConfigError at the first row that does not hold: file:line, key, found and accepted.
void CheckFrames(const CellConfig& cell, const Reader& reader);
/// Refuses a start that is impossible: the arm cannot reach it, or the apex would be outside the workspace.
/// The error names the key that is probably wrong. The candidates are, in this order:
///
/// - the pose of base or bone, if correcting it (from metres to millimetres, or by turning it over) makes the
///   start possible
/// - start.height_mm, if height 0 makes the start possible
/// - the bone's position, if the flange would be beyond the stretched arm's reach
/// - start.height_mm
///
/// @param is_possible  returns whether the arm can be placed at the start of the given cell; may change that
///   cell
/// @param what  text of the error that makes the start impossible
/// @throws ConfigError always.
[[noreturn]] void RefuseStart(const CellConfig& cell, const Reader& reader, const std::string& what,
                              const std::function<bool(CellConfig&)>& is_possible);

/// Checks the rows of the start, once cell.start.q is known. @throws ConfigError at the first row that does
/// not hold, as CheckFrames.
void CheckStart(const CellConfig& cell, const Reader& reader);

}  // namespace osteon::config
