#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <tl/expected.hpp>

#include "simulation/fidelity/frame_workload.h"
#include "studies/bench/method_engine.h"

namespace osteon::studies {

/// Parameters of TimeFrames, Seat and SeatMethod.
struct FrameTimingParams {
  std::vector<std::string> methods{"ours"};
  std::string device;              ///< part of a Vulkan device's name
  std::size_t frames{2000};        ///< number of frames to time
  double max_seconds{60.0};        ///< time limit of the timing; at least 20 frames are timed in any case
  double max_seat_seconds{600.0};  ///< limit for seating the tool; beyond it, seating fails
  std::size_t pass_frames{200};    ///< frames of a second run that measures each pass or stage; 0: none
  double voxel_m{0.25e-3};         ///< edge of a voxel, for the methods that have voxels
  /// Receives progress text; may be empty.
  std::function<void(const std::string&)> progress;
};

/// The frame times of one method.
struct FrameTiming {
  std::string method, device;
  std::vector<double> times_us{};  ///< of every frame, in order
  std::size_t elements{0};         ///< spheres, or voxels
  std::size_t frames{0};
  simulation::TimeFigures frame_us{};
  double mean_us{0.0};
  /// Spheres that a frame worked on; nothing if the method does not report it.
  std::optional<double> active_spheres_mean{};
  std::map<std::string, double> pass_us{};  ///< median time of each pass or stage
  double force_N{0.0};                      ///< mean coupling force, which shows that the tool pressed
  double removed_mm3{0.0};                  ///< volume that was removed while the frames were timed
  [[nodiscard]] double rate_hz() const { return frame_us.p50_us > 0.0 ? 1e6 / frame_us.p50_us : 0.0; }
};

/// The state in which the timing begins: the bone that a method has carved until the tool was seated.
struct SeatedStart {
  simulation::CarvedState state;
  simulation::WorkloadPlayer player;
  simulation::ContactModel last;
};
/// Makes the start of all methods that share their state (SharesState). The CPU engine carves it if "cpu" is
/// among the timed methods, otherwise "ours" does.
[[nodiscard]] tl::expected<SeatedStart, std::string> Seat(const simulation::FrameWorkload& work,
                                                          const FrameTimingParams& params);
/// Makes the start with one method: it carves until the tool is seated.
[[nodiscard]] tl::expected<SeatedStart, std::string> SeatMethod(const simulation::FrameWorkload& work,
                                                                const FrameTimingParams& params,
                                                                const std::string& method);
/// The starts of methods that carve their own start, by the method's name.
using OwnStarts = std::map<std::string, SeatedStart>;

/// Times the methods' frames on one workload, in this process and alternating frame by frame, so that other
/// load on the machine affects all methods equally. The first frames of each method are not timed, because an
/// engine makes its lists in them. The CPUs are kept awake as in a run (rt::KeepCpusAwake). Methods that
/// share their state begin from the state that Seat carved; the other methods carve their own start. On
/// Ctrl-C the timing ends early, with the frames so far.
/// @param start  result of Seat on the same workload; null: made here if a method needs it
/// @param own    results of SeatMethod; methods that are not in it carve here
[[nodiscard]] tl::expected<std::vector<FrameTiming>, std::string> TimeFrames(
    const simulation::FrameWorkload& work, const FrameTimingParams& params,
    const SeatedStart* start = nullptr, const OwnStarts& own = {});

}  // namespace osteon::studies
