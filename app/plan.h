#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include <tl/expected.hpp>

#include "app/plan_scene.h"

namespace osteon::app {

/// What is asked of a model, and what of the machine.
struct PlanRequest {
  double error_m{0.1e-3};  ///< mean depth that a cut may be off its sweep
  double rate_hz{1000.0};
  std::string device;  ///< part of a Vulkan device's name
  int rounds{3};       ///< so often the scene's cut is timed
  /// False: by the closed forms alone, the same on any machine; nothing is said of frames, and the rate is no
  /// matter.
  bool timed{true};
};

/// What could not be had together with the other.
struct GivenUp {
  std::string what;  ///< "error" [mm] or "rate" [Hz]
  double asked{0.0}, predicted{0.0};
};

/// The coarsest model that serves, and what it is expected to do.
struct FidelityPlan {
  std::string device;
  PackedLevel packed;
  simulation::Tool tool;
  double tool_gap_m{0.0};  ///< of its cutting surface from the scene's tool, in the mean
  simulation::ArmFidelity arm{simulation::ArmFidelity::kKinematic};
  int turn_parts{1};  ///< of a frame, at the fastest turn that the cell allows

  simulation::RemovalError removal;
  double error_m{0.0};  ///< of the cut's depth: removal and tool
  double promised_m{
      0.0};  ///< what the cut keeps: the error asked for, or where it was given up that much instead
  double arm_error_m{0.0};    ///< of where the tool is
  double leak_m{0.0};         ///< how deep a probe sinks between what is left, in the mean
  double leak_probe_m{0.0};   ///< its radius
  double cogging{0.0};        ///< tangential over normal force, rms
  double uniform_balls{0.0};  ///< that the whole bone, packed alike, would take for the same error
  /// The same of disjoint balls, as the cutting paper packs them (simulation/fidelity/disjoint_balls.h).
  double disjoint_balls{0.0};

  std::vector<PackedLevel> others;                  ///< packings that were timed before
  std::vector<simulation::FrameGroup> calibration;  ///< what they took
  simulation::FrameCost cost;
  double active_balls{0.0}, frame_us{0.0}, frame_p999_us{0.0};
  std::vector<GivenUp> given_up;  ///< empty: both are had
};

/// The coarsest model of tool and bone for an error, by the closed forms alone.
struct ModelChoice {
  simulation::Tool tool;
  double tool_gap_m{0.0};  ///< of its cutting surface from the scene's tool, in the mean
  std::optional<simulation::PackingLevel> level;  ///< nothing: no packing is fine enough
};
[[nodiscard]] ModelChoice ChooseModel(const PlanScene& scene, double error_m);

/// What of an error is left to the balls, beside a tool that takes its own part of it [m].
[[nodiscard]] double RemovalShare(double error_m, double tool_gap_m);

/// A coarser packing of a plan's kind, and what it leaves to expect.
struct CoarserZones {
  simulation::PackingLevel level;
  double promised_m{0.0};  ///< what a cut keeps
  double frame_us{0.0};    ///< expected
};

/// The finest packing that is coarser than `level`, by a fifth of its spacing and more, and whose frames are
/// expected to take at most `most_us`. Frames cost as the plan says, in the ratio that is seen now; active
/// balls go with the spacing's square. Nothing: none for which the closed forms hold has it.
/// @param plan  one that was timed  @param seen_us  what frames take now, at `level`
[[nodiscard]] std::optional<CoarserZones> CoarserFor(const PlanScene& scene, const FidelityPlan& plan,
                                                     const simulation::PackingLevel& level, double seen_us,
                                                     double most_us);

/// @param say  told what is going on; may be empty
/// @returns an error where there is no device, or no packing serves at all.
[[nodiscard]] tl::expected<FidelityPlan, std::string> MakePlan(
    const PlanScene& scene, const PlanRequest& request,
    const std::function<void(const std::string&)>& say = {});

/// A plan carried out.
struct PlanCheck {
  double error_m{0.0}, standard_error_m{0.0};  ///< as measured
  double lost_m{0.0}, left_m{0.0};             ///< its two parts
  double leak_m{0.0};
  simulation::FrameGroup frames;
  /// What the others, timed in turn with the plan, say of it: how far the model is off, whatever the machine
  /// does.
  double same_time_us{0.0};
  std::vector<std::string> missed;  ///< what was promised and not kept
};

/// Cuts the scene with the planned model and measures what was predicted, against the exact sweep of the
/// scene's whole tool. Missed are an error above
/// the promised one, and a median frame longer than the rate allows where that was not given up.
[[nodiscard]] tl::expected<PlanCheck, std::string> CheckPlan(const PlanScene& scene,
                                                             const PlanRequest& request,
                                                             const FidelityPlan& plan);

struct PlanOptions {
  PlanChoice choice;
  PlanRequest request;
  bool check{false};
  std::filesystem::path json;
};

/// The subcommand `plan`. @returns the process's exit code.
[[nodiscard]] int RunPlan(const PlanOptions& options);

}  // namespace osteon::app
