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
  bool disjoint{false};         ///< the paper's packing instead: disjoint balls, 10 000 where `spheres` is 0
  std::size_t tool_spheres{1};  ///< of the head; 1: one analytic ball
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

/// The generated acetabulum with its default fineness, reamed by a reamer of 50 mm at 100 N and 250 rpm.
[[nodiscard]] FrameWorkloadParams CupWorkload();

/// Makes the workload's bone, tool and motion.
/// @throws std::invalid_argument naming the parameter, its value and what is accepted.
[[nodiscard]] FrameWorkload MakeFrameWorkload(const FrameWorkloadParams& params);

/// Generates the frames' inputs. A copy continues independently from the state at its making.
class WorkloadPlayer {
 public:
  /// @param workload  must outlive the player
  explicit WorkloadPlayer(const FrameWorkload& workload);

  /// The next input. @param last  the model of the frame before; a new one before the first
  [[nodiscard]] FrameInput Next(const ContactModel& last);
  /// True when timing may begin: the head's proxy is seated in the cup, or a played tool has met the bone.
  [[nodiscard]] bool Ready(const ContactModel& last) const;
  /// True at a motion's end; a pressing hand has no end.
  [[nodiscard]] bool AtEnd() const;

 private:
  const FrameWorkload* workload_;
  PressingHand hand_;
  std::size_t frame_{0};
};

/// Runs frames until the player is ready.
/// @returns false where a motion's end, 20 000 frames, a refused frame or `stop` came first.
/// @param stop  called before each frame; may be empty
[[nodiscard]] bool RunUntilReady(CuttingEngine& engine, WorkloadPlayer& player, ContactModel& last,
                                 const std::function<bool()>& stop = {});

/// Percentiles of the frames' wall time [us]: median, 95th, 99th, 99.9th, and the maximum.
struct TimeFigures {
  double p50_us{0.0}, p95_us{0.0}, p99_us{0.0}, p999_us{0.0}, max_us{0.0};
};
/// Percentiles by nearest rank; zeros where there are no times.
[[nodiscard]] TimeFigures FiguresOf(std::vector<double> times_us);

/// Runs one frame. @returns the wall time of CuttingEngine::Step [us].
double TimedStep(CuttingEngine& engine, const FrameInput& input, ContactModel& model);

}  // namespace osteon::simulation
