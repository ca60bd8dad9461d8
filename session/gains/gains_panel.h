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

/// The gains that an operator may change from the console, and how far.
///
/// A page asks for the coupling's stiffness, the virtual tool's drag, or the gains before. What is accepted
/// goes to the loop as a saved gains file does (ServoLoop::RequestGains): it ramps without making energy, and
/// is recorded.
///
/// **Bounds.** The cell's own gains are what `osteon tune` was asked about. A softer coupling and a larger
/// drag keep that margin: both boundaries of tune's map are the first crossings of a scan, upward in
/// stiffness and downward in drag. So the stiffness is accepted from kMinStiffnessShare of the cell's own up
/// to it, and the drag from the cell's own up to kMaxDragFactor times. No limit of force, torque or speed can
/// be asked for.
///
/// Request and Json belong to the pages' threads, Take and SetPresent to the thread that supervises the run.
class GainsPanel {
 public:
  static constexpr double kMinStiffnessShare = 0.1, kMaxDragFactor = 5.0;

  /// @param cell  with the gains that the loop is made with
  explicit GainsPanel(const config::CellConfig& cell);

  /// Shows what `osteon tune` found for this cell. Before the pages open. @param advice  or why there is none
  void SetTune(tl::expected<TuneAdvice, std::string> advice) { tune_ = std::move(advice); }
  /// Accepts or refuses a page's request. The answer names the value found and the values accepted.
  [[nodiscard]] console::RequestAnswer Request(const console::GainsRequest& request);
  /// Returns gains that were accepted since the last call, once.
  [[nodiscard]] std::optional<control::Gains> Take();
  /// Takes gains that came another way, from a gains file: what is shown and what the next request starts
  /// from.
  void SetPresent(const control::Gains& gains);
  /// The message for the pages: {"type": "gains", …}; console/web/src/messages.ts has its fields.
  [[nodiscard]] std::string Json() const;

 private:
  [[nodiscard]] double Drag(const control::Gains& gains) const;
  [[nodiscard]] bool KeepsOwnMargin() const;
  [[nodiscard]] nlohmann::json TuneJson() const;

  const control::Gains own_;
  const bool has_drag_;          ///< the law has a virtual tool
  const double planes_N_per_m_;  ///< stiffness by which the planes of a frame turn: force limit over radius
  tl::expected<TuneAdvice, std::string> tune_{tl::unexpect, ""};
  mutable std::mutex mutex_;
  control::Gains present_;              // guarded by mutex_, as the following
  std::vector<control::Gains> former_;  // newest last
  bool asked_{false};
};

}  // namespace osteon::session
