#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include <tl/expected.hpp>

#include "session/planning/plan_scene.h"

namespace osteon::session {

/// The demands on a plan: largest error, smallest frame rate, and how they are checked.
struct PlanRequest {
  double error_m{0.1e-3};  ///< largest mean depth by which a cut may differ from the tool's exact sweep
  double rate_hz{1000.0};
  EngineChoice engine;  ///< the engine whose frames are timed
  int rounds{3};        ///< how often the scene's cut is run to time its frames
  /// False: the plan is made by closed forms alone, with the same result on every machine. No frame times are
  /// measured, and the rate is ignored.
  bool timed{true};
};

/// A demand that the plan does not meet, because error and rate could not both be reached.
struct UnmetDemand {
  std::string what;  ///< "error" [mm] or "rate" [Hz]
  double asked{0.0}, predicted{0.0};
};

/// The coarsest model that meets the demands, and its predicted figures.
struct FidelityPlan {
  std::string engine, device;  ///< engine and device that were timed; empty: nothing was timed
  PackedLevel packed;
  simulation::Tool tool;   ///< the planned tool, with fewer balls than the scene's tool
  double tool_gap_m{0.0};  ///< mean gap between its cutting surface and the scene tool's
  simulation::ArmFidelity arm{simulation::ArmFidelity::kKinematic};
  int turn_parts{1};  ///< number of straight parts into which a frame's motion is divided, for the cell's
                      ///< fastest rotation

  simulation::RemovalError removal;
  double error_m{0.0};  ///< predicted error of the cut's depth, from removal and tool together
  /// Bound of the error that the plan promises: the demanded error or, if that cannot be met, a larger one.
  double promised_m{0.0};
  double arm_error_m{0.0};  ///< predicted error of the tool's pose by the arm's model
  double leak_m{0.0};  ///< predicted mean depth to which a spherical probe sinks between the remaining balls
  double leak_probe_m{0.0};   ///< radius of the probe
  double cogging{0.0};        ///< RMS ratio of tangential to normal force
  double uniform_balls{0.0};  ///< number of balls of a uniform packing of the whole bone with the same error
  /// Number of balls of a disjoint packing, as in the cutting paper, with the same error
  /// (simulation/fidelity/disjoint_balls.h).
  double disjoint_balls{0.0};

  std::vector<PackedLevel> others;                  ///< packings that were timed for the calibration
  std::vector<simulation::FrameGroup> calibration;  ///< their frame times
  simulation::FrameCost cost;
  double active_balls{0.0}, frame_us{0.0}, frame_p999_us{0.0};
  std::vector<UnmetDemand> unmet;  ///< empty: both demands are met
};

/// The coarsest model of tool and bone that meets an error, chosen by closed forms alone.
struct ModelChoice {
  simulation::Tool tool;
  double tool_gap_m{0.0};  ///< mean gap between its cutting surface and the scene tool's
  std::optional<simulation::PackingLevel> level;  ///< nothing: no packing is fine enough
};
[[nodiscard]] ModelChoice ChooseModel(const PlanScene& scene, double error_m);

/// Returns the scene's tool approximated by as few balls as the tool's share of an error allows.
[[nodiscard]] simulation::Tool ToolForError(const PlanScene& scene, double error_m);

/// Returns the part of an error that the bone's balls may cause [m]: what remains after the part of the tool.
[[nodiscard]] double RemovalShare(double error_m, double tool_gap_m);

/// A coarser packing of a plan's kind, and its predicted figures.
struct CoarserZones {
  simulation::PackingLevel level;
  double promised_m{0.0};  ///< bound of a cut's error with this packing
  double frame_us{0.0};    ///< expected frame time
};

/// Finds the finest packing that is coarser than `level` by at least a fifth of its spacing, and whose frames
/// are predicted to take at most `max_us`. The prediction is the plan's frame time model, multiplied by the
/// ratio of measured to predicted time at `level`; the number of active balls is inversely proportional to
/// the square of the spacing. Returns nothing if no packing is fast enough for which the closed forms are
/// valid.
/// @param plan  a timed plan  @param seen_us  measured frame time at `level`
[[nodiscard]] std::optional<CoarserZones> CoarserFor(const PlanScene& scene, const FidelityPlan& plan,
                                                     const simulation::PackingLevel& level, double seen_us,
                                                     double max_us);

/// Makes the plan. @param say  receives progress text; may be empty
/// @returns the plan, or an error if the engine can't be made or no packing is suitable at all.
[[nodiscard]] tl::expected<FidelityPlan, std::string> MakePlan(
    const PlanScene& scene, const PlanRequest& request,
    const std::function<void(const std::string&)>& say = {});

/// Measured values of the figures that a plan predicts.
struct PlanCheck {
  double error_m{0.0}, standard_error_m{0.0};  ///< error of the cut's depth, and its statistical uncertainty
  double lost_m{0.0}, left_m{0.0};             ///< the two parts of error_m
  double leak_m{0.0};
  simulation::FrameGroup frames;
  /// Frame time of the plan's packing, predicted by a fit to the other packings. These are timed in turn with
  /// the plan's packing, so that variations of the machine affect all of them equally.
  double same_time_us{0.0};
  std::vector<std::string> missed;  ///< texts of the predictions that were not met
};

/// Cuts the scene with the planned model and measures the predicted figures, against the exact sweep of the
/// scene's whole tool. A prediction is missed if the error is above the promised one, or if the median frame
/// time is longer than the rate allows, unless the plan already says that the rate cannot be met.
[[nodiscard]] tl::expected<PlanCheck, std::string> CheckPlan(const PlanScene& scene,
                                                             const PlanRequest& request,
                                                             const FidelityPlan& plan);

}  // namespace osteon::session
