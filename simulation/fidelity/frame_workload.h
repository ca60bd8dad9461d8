#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "simulation/bone/scenes.h"
#include "simulation/fidelity/pressing_hand.h"
#include "simulation/packing/counted_packing.h"
#include "simulation/tools/motion_player.h"
#include "simulation/tools/shell_tool.h"

// Workload for timing one cutting frame: shared by `osteon bench frame`, `osteon chart scaling` and
// osteon_frame_bench.

namespace osteon::simulation {

struct FrameWorkloadParams {
  SceneParams scene;
  Tool tool;
  CuttingParams cutting;
  std::size_t spheres{0};  ///< 0: as many as the scene asks for
  CountedGrade grade{CountedGrade::kFixedZone};
  bool disjoint{false};  ///< pack disjoint balls as in the cutting paper; 10 000 balls if `spheres` is 0
  std::size_t tool_spheres{1};  ///< number of balls of the head; 1: one analytic ball
  ShellPart shell{ShellPart::kHemisphere};
  std::optional<ToolMotion> motion;  ///< a recorded motion instead of the pressing hand
  double rate_hz{1000.0};
  double force_N{100.0};                         ///< of the hand
  double spindle_rad_per_s{26.179938779914945};  ///< 250 rpm
};

/// A cup reamed by a hand that presses with a constant force along its axis; or any scene with a recorded
/// motion.
struct FrameWorkload {
  std::shared_ptr<const Solid> solid;
  Bone bone;
  Tool tool;
  CuttingParams cutting;
  std::optional<MotionPlayer> motion;
  PressingHandParams hand;
  double seat_m{0.0};            ///< feed at which the centres of head and cup coincide
  double cut_zone_m{0.0};        ///< mean spacing of the balls' centres in the cut zone
  double cut_zone_depth_m{0.0};  ///< depth below the cuttable surface over which the spacing was measured
  std::size_t cutting_balls{0};  ///< of the tool
};

/// Parameters of a workload: the generated acetabulum with its default fineness, cut by a reamer of 50 mm
/// diameter at 100 N and 250 rpm.
[[nodiscard]] FrameWorkloadParams CupWorkload();

/// Makes the workload's bone, tool and motion.
/// @throws std::invalid_argument naming the parameter, its value and what is accepted.
[[nodiscard]] FrameWorkload MakeFrameWorkload(const FrameWorkloadParams& params);

/// Generates the inputs of the frames, one after the other. A copy continues independently from the state in
/// which it was copied.
class WorkloadPlayer {
 public:
  /// @param workload  must outlive the player
  explicit WorkloadPlayer(const FrameWorkload& workload);

  /// The input of the next frame.
  /// @param last  the contact model of the frame before; a default-constructed one before the first frame
  [[nodiscard]] FrameInput Next(const ContactModel& last);
  /// True if the timing may begin: a pressed head's proxy is seated in the cup, or a tool with a recorded
  /// motion has touched the bone.
  [[nodiscard]] bool Ready(const ContactModel& last) const;
  /// True after the last frame of a recorded motion. A pressing hand never ends.
  [[nodiscard]] bool AtEnd() const;

 private:
  const FrameWorkload* workload_;
  PressingHand hand_;
  std::size_t frame_{0};
};

/// Runs frames until the player is ready.
/// @returns false if the recorded motion ended first, 20 000 frames were not enough, the engine refused a
///   frame, or `stop` returned true.
/// @param stop  called before each frame; true ends the run; may be empty
[[nodiscard]] bool RunUntilReady(CuttingEngine& engine, WorkloadPlayer& player, ContactModel& last,
                                 const std::function<bool()>& stop = {});

/// Percentiles of the frames' wall time [us]: median, 95th, 99th, 99.9th, and the maximum.
struct TimeFigures {
  double p50_us{0.0}, p95_us{0.0}, p99_us{0.0}, p999_us{0.0}, max_us{0.0};
};
/// Computes the percentiles by nearest rank; all are 0 if there are no times.
[[nodiscard]] TimeFigures FiguresOf(std::vector<double> times_us);

/// Runs one frame. @returns the wall time of CuttingEngine::Step [us].
double TimedStep(CuttingEngine& engine, const FrameInput& input, ContactModel& model);

}  // namespace osteon::simulation
