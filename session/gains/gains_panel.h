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
/// Accepted gains go to the loop as those of a saved gains file do (ServoLoop::RequestGains): the loop ramps
/// to them without making energy, and records them.
///
/// **Bounds.** `osteon tune` computes the stability margin of the cell's own gains. A softer coupling and a
/// larger drag keep that margin: both boundaries of tune's map are the first crossings of a scan, upward in
/// stiffness and downward in drag. So the stiffness is accepted from kMinStiffnessShare of the cell's own up
/// to the cell's own, and the drag from the cell's own up to kMaxDragFactor times the cell's own. Limits of
/// force, torque or speed cannot be changed here.
///
/// Request and Json belong to the pages' threads, Take and SetPresent to the thread that supervises the run.
class GainsPanel {
 public:
  static constexpr double kMinStiffnessShare = 0.1, kMaxDragFactor = 5.0;

  /// @param cell  with the gains that the loop is made with
  explicit GainsPanel(const config::CellConfig& cell);

  /// Sets the result of `osteon tune` for this cell, for the pages to show. Call it before the pages open.
  /// @param advice  the error is why there is none
  void SetTune(tl::expected<TuneAdvice, std::string> advice) { tune_ = std::move(advice); }
  /// Accepts or refuses a page's request. The answer names the value found and the values accepted.
  [[nodiscard]] console::RequestAnswer Request(const console::GainsRequest& request);
  /// Returns gains that were accepted since the last call, once.
  [[nodiscard]] std::optional<control::Gains> Take();
  /// Sets the present gains after a change from elsewhere (a gains file): they are shown, and the next
  /// request starts from them. Changes before them cannot be undone any more.
  void SetPresent(const control::Gains& gains);
  /// Makes the message for the pages, {"type": "gains", …}; console/web/src/messages.ts has its fields.
  [[nodiscard]] std::string Json() const;

 private:
  [[nodiscard]] double MinDrag(const control::Gains& gains) const;
  [[nodiscard]] bool KeepsOwnMargin() const;
  // The part of the message about the result of `osteon tune`; null: there is none.
  [[nodiscard]] nlohmann::json TuneJson() const;

  const control::Gains own_;     ///< the cell's own
  const bool has_drag_;          ///< the law has a virtual tool
  const double planes_N_per_m_;  ///< stiffness that the planes' rotation causes: force limit over tool radius
  tl::expected<TuneAdvice, std::string> tune_{tl::unexpect, ""};
  mutable std::mutex mutex_;
  control::Gains present_;              // guarded by mutex_, as the following
  std::vector<control::Gains> former_;  // gains before each change that can be undone, newest last
  bool asked_{false};                   // gains were accepted that Take has not returned yet
};

}  // namespace osteon::session
