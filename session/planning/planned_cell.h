#pragma once

#include <functional>
#include <optional>
#include <string>

#include <nlohmann/json_fwd.hpp>
#include <tl/expected.hpp>

#include "session/planning/plan.h"
#include "session/setup/cell_setup.h"

namespace osteon::session {

/// The options of a command line that say how fine a run's bone is packed.
struct FidelityChoice {
  bool as_packed{false};                   ///< pack by the scene's own `packing`
  std::optional<double> error_m, rate_hz;  ///< replace those of the scene's `fidelity`
};

/// The demands that a cell's bone was planned for, and the plan.
struct PlannedCell {
  PlanScene scene;
  PlanRequest request;
  FidelityPlan plan;
};

/// Packs the bone of a prepared cell as coarsely as its error and rate allow (plan.h), and replaces the
/// cell's tool and cutting parameters by those of the plan. Uses the scene's own packing if the choice says
/// so, or if neither scene nor choice demands anything. A bone that was loaded from a packing file is not
/// changed.
/// @param timed  true: frame times of the engine are measured first; false: the plan is made by closed forms
/// alone, with the same result on every machine
/// @returns an error if the plan fails, or if an error or a rate is demanded of a loaded bone or of a scene
/// that is cut along neither cup nor path.
[[nodiscard]] tl::expected<void, std::string> PackCell(
    CellSetup& setup, const FidelityChoice& choice, const EngineChoice& engine, bool timed,
    const std::function<void(const std::string&)>& say = {});

/// Beginning of the text of a recorded event that describes a planned bone.
inline constexpr const char* kPackingEvent = "packing: ";

/// Describes the plan in one line, for summary and recording.
[[nodiscard]] std::string PlannedText(const PlannedCell& planned);
/// Returns the plan as keys of a run's summary.
[[nodiscard]] nlohmann::json PlannedJson(const PlannedCell& planned);

}  // namespace osteon::session
