#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <tl/expected.hpp>

#include "config/reading/load_surgical_plan.h"
#include "procedure/assessment/assessment.h"
#include "session/procedure/session_cut.h"
#include "session/procedure/session_file.h"
#include "session/setup/cell_setup.h"

namespace osteon::studies {

/// Curves of a session for the page, with one value per kTraceStep_s.
struct SessionTrace {
  std::vector<double> t_s{}, height_mm{}, tilt_deg{}, aside_mm{}, force_N{};
  std::vector<double> proxy_mm{};  ///< height of the simulated head; where bone stops the head, it is above
                                   ///< the handle's height
  /// Limits of the corridor at the head's height: the lateral deviation up to which the head moves freely,
  /// and the one at which the spindle stops. Empty if the plan has no corridor.
  std::vector<double> free_mm{}, stop_mm{};
};
/// Time between two values of the curves.
inline constexpr double kTraceStep_s = 0.05;

/// A pass of the session, with times on the curves' time axis.
struct PassFigures {
  session::SessionPass pass{};
  double begin_s{0.0}, end_s{0.0};
  procedure::ProcessFigures figures{};
};

/// Sums over all passes with one of the plan's tools.
struct ToolFigures {
  double diameter_mm{0.0};
  int passes{0};  ///< number of passes that count for the result
  procedure::ProcessFigures figures{};
};

/// A session folder, read and measured.
struct AssessedSession {
  std::filesystem::path folder;
  session::SessionFile file{};
  config::SurgicalPlanConfig plan{};
  simulation::Bone bone{};  ///< the uncut bone
  /// Solid from which the bone was packed; null: not known
  std::shared_ptr<const simulation::Solid> solid{};
  /// The cut by the passes that count. It has a value after the session is read.
  std::optional<session::SessionCut> cut{};
  simulation::CarvedState state{};  ///< carved state after the last pass that counts
  procedure::Assessment assessment{};
  std::vector<ToolFigures> tools{};
  std::vector<PassFigures> passes{};
  SessionTrace trace{};
  double guidance_gain{0.0};  ///< the largest gain of any segment
  /// Names the counted passes whose recordings are incomplete: "pass 2: …". Empty if all are complete.
  std::string missing{};

  [[nodiscard]] bool guided() const { return guidance_gain > 0.0; }
};

/// Reads FOLDER/session.json, the plan, the recordings and the last carved state that counts, and measures
/// them. An error names the file and the reason: it cannot be read, or does not belong to the session.
/// @throws config::ConfigError for the plan
[[nodiscard]] tl::expected<AssessedSession, std::string> ReadAssessedSession(
    const std::filesystem::path& folder);

}  // namespace osteon::studies
