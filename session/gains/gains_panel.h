#pragma once

#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <nlohmann/json_fwd.hpp>
#include <tl/expected.hpp>

#include "config/reading/cell_config.h"
#include "console/server/console_server.h"
#include "control/laws/gains.h"
#include "session/gains/tune_advice.h"

namespace osteon::session {

/// The gains that an operator may change from the console, and their bounds.
///
/// A page asks for the coupling's stiffness, for the virtual tool's drag, or to undo the last change.
/// Accepted gains go to the loop by ServoLoop::RequestGains, like those of a gains file. The loop ramps to
/// them without generating energy, and records them.
///
/// **Bounds.** `osteon tune` computes the stability margin of the cell's own gains. A softer coupling or a
/// larger drag keeps that margin: tune scans upward in stiffness and downward in drag, and takes the first
/// unstable value as the boundary. So the stiffness is accepted from kMinStiffnessShare of the cell's own up
/// to the cell's own, and the drag from the cell's own up to kMaxDragFactor times the cell's own. Limits of
/// force, torque or speed cannot be changed here.
///
/// The pages' threads call Request and Json; the thread that supervises the run calls Take and SetPresent.
class GainsPanel {
 public:
  static constexpr double kMinStiffnessShare = 0.1, kMaxDragFactor = 5.0;

  /// @param cell  the cell, with the gains with which the loop was made
  explicit GainsPanel(const config::CellConfig& cell);

  /// Sets the result of `osteon tune` for this cell, for the pages to show. Call it before the pages open.
  /// @param advice  the result of tune, or the reason why there is none
  void SetTune(tl::expected<TuneAdvice, std::string> advice) { tune_ = std::move(advice); }
  /// Accepts or refuses a page's request. The answer names the value found and the values accepted.
  [[nodiscard]] console::RequestAnswer Request(const console::GainsRequest& request);
  /// Returns the gains if a request was accepted since the last call; otherwise nothing.
  [[nodiscard]] std::optional<control::Gains> Take();
  /// Sets the present gains after a change that did not come from a page (a gains file). The pages show them,
  /// and the next request starts from them. Earlier changes can no longer be undone.
  void SetPresent(const control::Gains& gains);
  /// Makes the message for the pages, {"type": "gains", …}; console/web/src/messages.ts has its fields.
  [[nodiscard]] std::string Json() const;

 private:
  [[nodiscard]] double MinDrag(const control::Gains& gains) const;
  [[nodiscard]] bool KeepsOwnMargin() const;
  // Makes the part of the message about the result of `osteon tune`; null if there is no result.
  [[nodiscard]] nlohmann::json TuneJson() const;

  const control::Gains own_;     ///< the cell's own gains
  const bool has_drag_;          ///< the law has a virtual tool, whose drag can be changed
  const double planes_N_per_m_;  ///< largest stiffness caused by a rotation of the contact planes: force
                                 ///< limit over tool radius
  tl::expected<TuneAdvice, std::string> tune_{tl::unexpect, ""};
  mutable std::mutex mutex_;
  control::Gains present_;              // guarded by mutex_, like the members below
  std::vector<control::Gains> former_;  // the gains before each change that can still be undone, newest last
  bool asked_{false};                   // gains were accepted that Take has not returned yet
};

}  // namespace osteon::session
