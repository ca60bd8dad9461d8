#pragma once

#include <functional>
#include <optional>
#include <string>

#include <nlohmann/json_fwd.hpp>
#include <tl/expected.hpp>

#include "app/cell_setup.h"
#include "app/plan.h"

namespace osteon::app {

/// How fine the bone of a run is, as the command line says it.
struct FidelityChoice {
  bool as_packed{false};                   ///< by the scene's own `packing`
  std::optional<double> error_m, rate_hz;  ///< instead of the scene's `fidelity`
};

/// What a cell's bone was planned for, and the plan.
struct PlannedCell {
  PlanScene scene;
  PlanRequest request;
  FidelityPlan plan;
};

/// Packs the bone of a prepared cell as coarse as its error and rate allow (plan.h), and sets the cell's tool
/// and cutting to what the plan has. By the scene's own packing where the choice says so, or neither scene
/// nor choice asks for anything. A bone that was loaded stays.
/// @param timed  what frames take is measured first, on the device; otherwise the closed forms alone decide,
///   alike on any machine
/// @returns an error where a scene that is cut along neither cup nor path, or a bone that was loaded, is
/// asked for an error or a rate, or the plan fails.
[[nodiscard]] tl::expected<void, std::string> PackCell(
    CellSetup& setup, const FidelityChoice& choice, const std::string& device, bool timed,
    const std::function<void(const std::string&)>& say = {});

/// The plan in a line, for summary and recording.
[[nodiscard]] std::string PlannedText(const PlannedCell& planned);
/// The same as keys of a run's summary.
[[nodiscard]] nlohmann::json PlannedJson(const PlannedCell& planned);

}  // namespace osteon::app
