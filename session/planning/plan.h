#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include <tl/expected.hpp>

#include "session/planning/plan_scene.h"

namespace osteon::session {

/// The demands on the model and on the machine.
struct PlanRequest {
  double error_m{0.1e-3};  ///< mean depth by which a cut may differ from its sweep
  double rate_hz{1000.0};
  EngineChoice engine;  ///< the engine whose frames are timed
  int rounds{3};        ///< number of times that the scene's cut is timed
  /// False: only the closed forms decide, with the same result on every machine. There are no frame times,
  /// and the rate is ignored.
  bool timed{true};
};

/// A demand that could not be met: error and rate could not both be reached.
struct UnmetDemand {
  std::string what;  ///< "error" [mm] or "rate" [Hz]
  double asked{0.0}, predicted{0.0};
};

/// The coarsest model that meets the demands, and its predicted figures.
struct FidelityPlan {
  std::string engine, device;  ///< the ones that were timed; empty: none was
  PackedLevel packed;
  simulation::Tool tool;   ///< with fewer balls than the scene's tool
  double tool_gap_m{0.0};  ///< mean gap between its cutting surface and the scene tool's
  simulation::ArmFidelity arm{simulation::ArmFidelity::kKinematic};
  int turn_parts{1};  ///< straight parts that stand for a frame's motion, at the fastest turn of the cell

  simulation::RemovalError removal;
  double error_m{0.0};  ///< predicted error of the cut's depth, from removal and tool together
  /// Bound of the error that the plan promises: the demanded error or, if that cannot be met, a larger one.
  double promised_m{0.0};
  double arm_error_m{0.0};    ///< of the tool's pose
  double leak_m{0.0};         ///< mean depth to which a probe sinks between the remaining balls
  double leak_probe_m{0.0};   ///< radius of that probe
  double cogging{0.0};        ///< tangential over normal force, rms
  double uniform_balls{0.0};  ///< balls that the whole bone, packed uniformly, would need for the same error
  /// Number of disjoint balls for the same error, as in the cutting paper
  /// (simulation/fidelity/disjoint_balls.h).
  double disjoint_balls{0.0};

  std::vector<PackedLevel> others;                  ///< packings that were timed for the calibration
  std::vector<simulation::FrameGroup> calibration;  ///< their frame times
  simulation::FrameCost cost;
  double active_balls{0.0}, frame_us{0.0}, frame_p999_us{0.0};
  std::vector<UnmetDemand> unmet;  ///< empty: both demands are met
};

/// The coarsest model of tool and bone that meets an error, chosen by the closed forms only.
struct ModelChoice {
  simulation::Tool tool;
  double tool_gap_m{0.0};  ///< mean gap between its cutting surface and the scene tool's
  std::optional<simulation::PackingLevel> level;  ///< nothing: no packing is fine enough
};
[[nodiscard]] ModelChoice ChooseModel(const PlanScene& scene, double error_m);

/// Returns the scene's tool with as few balls as an error allows.
[[nodiscard]] simulation::Tool ToolForError(const PlanScene& scene, double error_m);

/// Returns the part of an error that the bone's balls may cause, after the tool's own part [m].
[[nodiscard]] double RemovalShare(double error_m, double tool_gap_m);

/// A coarser packing of a plan's kind, and its predicted figures.
struct CoarserZones {
  simulation::PackingLevel level;
  double promised_m{0.0};  ///< bound of a cut's error
  double frame_us{0.0};    ///< expected frame time
};

/// Finds the finest packing that is coarser than `level` by at least a fifth of its spacing, and whose frames
/// are predicted to take at most `max_us`. The prediction is the plan's, scaled by the ratio of measured to
/// planned time; the number of active balls goes with the spacing's square. Returns nothing if no packing
/// within the validity of the closed forms is fast enough.
/// @param plan  a timed plan  @param seen_us  measured frame time at `level`
[[nodiscard]] std::optional<CoarserZones> CoarserFor(const PlanScene& scene, const FidelityPlan& plan,
                                                     const simulation::PackingLevel& level, double seen_us,
                                                     double max_us);

/// Makes the plan. @param say  receives progress text; may be empty
/// @returns an error if the engine can't be made, or no packing serves at all.
[[nodiscard]] tl::expected<FidelityPlan, std::string> MakePlan(
    const PlanScene& scene, const PlanRequest& request,
    const std::function<void(const std::string&)>& say = {});

/// The measured values of a plan's predictions.
struct PlanCheck {
  double error_m{0.0}, standard_error_m{0.0};  ///< error of the cut's depth, and its statistical uncertainty
  double lost_m{0.0}, left_m{0.0};             ///< the two parts of error_m
  double leak_m{0.0};
  simulation::FrameGroup frames;
  /// Frame time that a fit to the other packings gives for the plan's. They are timed in turn with the plan,
  /// so that variations of the machine affect all alike.
  double same_time_us{0.0};
  std::vector<std::string> missed;  ///< promises that were not kept
};

/// Cuts the scene with the planned model and measures the predicted figures, against the exact sweep of the
/// scene's whole tool. Misses are an error above the promised one, and a median frame longer than the rate
/// allows unless the rate was given up.
[[nodiscard]] tl::expected<PlanCheck, std::string> CheckPlan(const PlanScene& scene,
                                                             const PlanRequest& request,
                                                             const FidelityPlan& plan);

}  // namespace osteon::session
