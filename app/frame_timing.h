#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <tl/expected.hpp>

#include "app/method_engine.h"
#include "simulation/metrics/frame_workload.h"

namespace osteon::app {

struct FrameTimingParams {
  std::vector<std::string> methods{"ours"};
  std::string device;               ///< part of a Vulkan device's name
  std::size_t frames{2000};         ///< timed
  double most_seconds{60.0};        ///< of timing; at least 20 frames
  double most_seat_seconds{600.0};  ///< until the tool is seated; beyond that it is an error
  std::size_t pass_frames{200};     ///< of a second run with the device's time by pass; 0: none
  double voxel_m{0.25e-3};          ///< of the methods that have voxels
  /// Says what is going on; may be empty.
  std::function<void(const std::string&)> progress;
};

/// What a method took for its frames.
struct FrameTiming {
  std::string method, device;
  std::size_t elements{0};  ///< spheres, or voxels
  std::size_t frames{0};
  simulation::TimeFigures frame_us{};
  double mean_us{0.0};
  std::optional<double>
      active_spheres_mean{};                ///< spheres that a frame worked on; nothing where it does not say
  std::map<std::string, double> pass_us{};  ///< medians
  double force_N{0.0};                      ///< mean of the coupling's, so that it is seen that it pressed
  double removed_mm3{0.0};                  ///< from where timing began to its end
  [[nodiscard]] double rate_hz() const { return frame_us.p50_us > 0.0 ? 1e6 / frame_us.p50_us : 0.0; }
};

/// Where timing begins, as "ours" has carved it.
struct SeatedStart {
  simulation::CarvedState state;
  simulation::WorkloadPlayer player;
  simulation::ContactModel last;
};
[[nodiscard]] tl::expected<SeatedStart, std::string> Seat(const simulation::FrameWorkload& work,
                                                          const FrameTimingParams& params);

/// Times the methods' frames on one workload, in this process and frame by frame in turn, so that what else
/// the machine does falls on all alike; the CPUs awake, as a run has them (rt::KeepCpusAwake). Methods that
/// share their state begin from the one that "ours" has carved until the tool was seated; the others carve
/// their own. Ends early, with what there is, on Ctrl-C.
/// @param start  of Seat on the same workload; null: made here where a method needs it
[[nodiscard]] tl::expected<std::vector<FrameTiming>, std::string> TimeFrames(
    const simulation::FrameWorkload& work, const FrameTimingParams& params,
    const SeatedStart* start = nullptr);

}  // namespace osteon::app
