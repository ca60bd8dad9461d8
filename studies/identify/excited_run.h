#pragma once

#include <atomic>
#include <filesystem>
#include <functional>
#include <string>

#include <tl/expected.hpp>

#include "session/setup/cell_setup.h"
#include "studies/identify/excited_axis.h"

namespace osteon::studies {

/// The excitation of one run, the file of its recording, and the arm.
struct ExcitedRunParams {
  ExcitationRequest request;
  std::filesystem::path recording;  ///< the MCAP file to write
  bool simulated{true};             ///< the simulated cell, in virtual time; false: the connected arm
  /// With `simulated`: the run is in wall time, and the simulated arm and devices are reached on loopback, by
  /// the protocols of a connected cell.
  bool wall_time{false};
  double wait_s{60.0};  ///< connected arm: longest wait until the arm is handed over
  const std::atomic<bool>* stop{nullptr};
  std::function<void(const std::string&)> notice{};  ///< called with messages for the user, a line each
};

/// Moves the arm of a cell by an excitation, and records it. The servo loop goes to the start, begins to
/// render in free air, is paused, and holds the arm. Meanwhile control::ExcitedHold adds its offset to each
/// answer. The spindle does not turn, and the cutting engine does not run. The loop's checks of a pause and
/// the checks of the excited hold act.
///
/// A simulated cell runs in virtual time: arm, wires, devices and PLC as in `osteon demo --virtual-time`.
/// There are two differences: nobody holds the handle, unless the request says so; and the sensor carries the
/// tool's inertia, as a real sensor does.
///
/// A recording of a connected arm can be replayed as any other recording, since the loop's own command is
/// that of a pause. Before a joint is moved, its travel of kMaxJointTravel_rad to either side is checked for
/// obstacles, as the start path is.
/// @returns an error if nothing could be run, or a text that says why the run ended early
[[nodiscard]] tl::expected<void, std::string> RunExcited(const session::CellSetup& setup,
                                                         const ExcitedRunParams& params);

}  // namespace osteon::studies
