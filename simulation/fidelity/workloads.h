#pragma once

#include <array>
#include <functional>
#include <memory>
#include <string_view>
#include <vector>

#include "simulation/engine/cutting_engine.h"
#include "simulation/fidelity/force_error.h"
#include "simulation/solids/cut_zone.h"
#include "simulation/tools/tool.h"

// The workloads on which methods are compared: a cut with a known exact result, then a touch of that cut with
// a known exact force. Poses are given beforehand (open loop), so that every method gets the same ones.
//
//     cut    spindle on, RemovalLaw::kImmediate: the tool follows the given poses; all bone in its sweep goes
//     feel   spindle off: the same tool moves back along its own path, displaced from it by an offset d
//
// A ball that has cut a path fits into that path exactly: its centre is free only on the path. With a
// frictionless coupling the force is therefore -K d wherever d is normal to the path and points into the
// bone, whatever the shape of the cut. (d leads down and to the side, because the path is open above.)

namespace osteon::simulation {

enum class CutTask : std::uint8_t {
  kPlunge,   ///< a ball of 5 mm radius, straight down 5 mm into a block
  kSlide,    ///< as kPlunge, then 6 mm sideways: a trench
  kReam,     ///< a reamer of 25 mm radius in a cup of the same radius, 3 mm deeper
  kChannel,  ///< a burr of 1.5 mm radius, 2 mm deep, along an arc of 9.4 mm
  kScene,    ///< a scene's own cut (scene_workload.h); methods are not compared on it
};
inline constexpr std::array kCutTasks{CutTask::kPlunge, CutTask::kSlide, CutTask::kReam, CutTask::kChannel};

/// "plunge", "slide", "ream", "channel", "scene".
[[nodiscard]] std::string_view TaskName(CutTask task);

struct CutWorkload {
  CutTask task{CutTask::kPlunge};
  std::shared_ptr<const Solid> solid;
  std::shared_ptr<const CutZone> zone;  ///< the cut zone, in which a packing is fine
  std::vector<Material> materials;      ///< one, without friction
  Tool tool;                            ///< one ball
  CuttingParams cutting;
  double rate_hz{1000.0};
  std::vector<FrameInput> frames;  ///< poses in W; the frames W and G coincide
  std::size_t cut_end{0};          ///< number of the frames that cut; they come first
  std::size_t feel_begin{0};       ///< from this frame on the offset is complete, and forces are compared
  std::vector<FeltForce> exact;    ///< for the frames from feel_begin on
  /// Poses of the cut.
  [[nodiscard]] std::vector<Pose> CutPath() const;
};

/// Parameters of a workload's motion.
struct CutWorkloadParams {
  std::uint64_t seed{0};  ///< moves and turns the path relative to packing and voxels; 0: does neither
  double rate_hz{1000.0};
  double feed_m_per_s{0.020};  ///< of the cut
  double feel_m_per_s{0.040};  ///< speed of the way back
  double offset_m{0.5e-3};     ///< |d|: 10 N at 20 N/mm
};

/// Makes a workload's solid, tool and frames.
/// @throws std::invalid_argument if rate, speeds or offset are not positive, or the offset exceeds 1 mm.
[[nodiscard]] CutWorkload MakeCutWorkload(CutTask task, const CutWorkloadParams& params = {});

/// Result of a workload's run on an engine.
struct WorkloadRun {
  std::vector<double> frame_us;   ///< wall times of the frames in which the tool touched
  std::vector<FeltForce> felt;    ///< from feel_begin on
  double removed_volume_m3{0.0};  ///< as the engine itself counts it, at the cut's end
  bool complete{false};           ///< false: a frame was refused, or `stop` ended the run
};
/// Runs a workload on an engine.
/// @param stop  called with the number of the next frame; true ends the run; may be empty
[[nodiscard]] WorkloadRun RunWorkload(CuttingEngine& engine, const CutWorkload& workload,
                                      const std::function<bool(std::size_t)>& stop = {});

}  // namespace osteon::simulation
