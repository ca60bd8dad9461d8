#pragma once

#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "config/cell_config.h"
#include "config/reader.h"

// Whether what a cell says of where things are (base X_WB, bone X_WG, tool X_FT, workspace, start) makes
// sense together. A pose that was measured wrongly, or written in another unit, is a valid pose: only beside
// the others does it show.

namespace osteon::config {

/// One thing that was measured on a registration, and what is accepted. For a table before a run.
struct RegistrationRow {
  std::string name;   ///< "from the arm's base to the site"
  double value{0.0};  ///< in `unit`
  std::string unit;   ///< "mm", "deg"
  double low{-std::numeric_limits<double>::infinity()};
  double high{std::numeric_limits<double>::infinity()};
  std::string section, key;  ///< of the cell's file, which is to blame where it does not hold
  std::string hint;          ///< what it looks like then; may be empty
  std::string note;          ///< to be known where it holds; may be empty

  [[nodiscard]] bool holds() const noexcept { return value >= low && value <= high; }
  /// "150.0 … 1126.0 mm", "at least 1.0 deg"; "any" where nothing is refused.
  [[nodiscard]] std::string accepted() const;
  /// "ok", "note: …" or "refused: accepted …".
  [[nodiscard]] std::string verdict() const;
};

struct RegistrationReport {
  std::vector<RegistrationRow> rows;
};

/// All that is checked, measured on a cell that LoadCell has returned.
///
/// | what | accepted |
/// |---|---|
/// | base to site | the base's foot and a bone have room beside each other: 150 mm or more |
/// | shoulder to site | what the stretched arm reaches with the tool's apex |
/// | flange to apex | below 600 mm |
/// | the tool's rotation | a rotation, to 1e-6 |
/// | the site's room in the workspace | site radius + depth of the work below it, to every bound |
/// | the base's tilt from the vertical | any; noted, since the arm's own controller must know of it |
/// | start: joints | joint_margin_deg or more from the limits |
/// | start: the apex in the workspace | inside |
/// | start: tool axis from the site's axis | points into the bone, to 60 deg |
/// | start: flange above the workspace's plane | above |
///
/// The start's figures come from its joints by forward kinematics, through W B F T: nothing of the way by
/// which they were found. A depth is that of the scene's zone: the deepest point of a path, the bottom of a
/// cup.
[[nodiscard]] RegistrationReport DescribeRegistration(const CellConfig& cell);

/// The rows of base, bone, tool and workspace: before the arm is placed at the start, which a mistake in one
/// of these makes impossible, without saying which.
/// @param reader  of the cell's file
/// @throws ConfigError at the first that does not hold: file:line, key, found and accepted.
void CheckFrames(const CellConfig& cell, const Reader& reader);
/// The pose at the start cannot be had (the arm does not get there, or the apex would be outside the
/// workspace): refuses the key that is to blame. The one of the registration is, if it alone, written in
/// millimetres or turned over, makes the start possible, or if no height above the site does; elsewhere
/// start.height_mm.
/// @param is_possible  whether the arm can be placed in a cell, which it may change
/// @param what  is wrong at the start
/// @throws ConfigError always.
[[noreturn]] void RefuseStart(const CellConfig& cell, const Reader& reader, const std::string& what,
                              const std::function<bool(CellConfig&)>& is_possible);

/// The rows of the start: where cell.start.q is known. @throws as CheckFrames.
void CheckStart(const CellConfig& cell, const Reader& reader);

}  // namespace osteon::config
