#pragma once

#include <atomic>
#include <filesystem>
#include <functional>
#include <string>

#include <tl/expected.hpp>

#include "session/setup/cell_setup.h"
#include "studies/identify/excited_axis.h"

namespace osteon::studies {

/// What one excited run does, where it is recorded, and with which arm.
struct ExcitedRunParams {
  ExcitationRequest request;
  std::filesystem::path recording;  ///< the MCAP file to write
  bool simulated{true};             ///< the simulated cell, in virtual time; false: the connected arm
  /// With `simulated`: the run is in wall time, and the simulated arm and devices are reached by their real
  /// protocols on loopback, as those of a connected cell.
  bool wall_time{false};
  double wait_s{60.0};  ///< real arm: longest wait until it is handed over
  const std::atomic<bool>* stop{nullptr};
  std::function<void(const std::string&)> notice{};  ///< called with a line for the user
};

/// Moves the arm of a cell by an excitation, and records it: the servo loop goes to the start, begins to
/// render in free air, is paused, and holds the arm, while control::ExcitedHold adds its offset to each
/// answer. Spindle and cutting engine stand still. All checks of the loop in a pause act, and those of the
/// excited hold.
///
/// A simulated cell runs in virtual time: arm, wires, devices, PLC as in `osteon demo --virtual-time`, except
/// that nobody takes the handle, unless the request says so, and that the sensor carries the tool's inertia,
/// as a real one does. A recording of a connected arm replays as any other: the loop's own command is the
/// pause's. Before a joint is moved, its travel of kMaxJointTravel_rad to either side is checked for
/// obstacles, as the path to the start is.
/// @returns an error if nothing could be run, or a text that says why the run ended early
[[nodiscard]] tl::expected<void, std::string> RunExcited(const session::CellSetup& setup,
                                                         const ExcitedRunParams& params);

}  // namespace osteon::studies
