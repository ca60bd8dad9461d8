#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "base/realtime_thread.h"
#include "config/reading/cell_config.h"
#include "config/reading/load.h"
#include "io/fri/fri_relay.h"
#include "io/modbus/plc_reading.h"
#include "safety/guard_monitor.h"

namespace osteon::session {

/// The options of `osteon guard`.
struct GuardOptions {
  std::filesystem::path cell;                ///< the cell's YAML file
  std::optional<config::ToolChoice> tool{};  ///< replaces the cell's tool
  std::optional<std::uint16_t> port{};       ///< for a simulated cell: the first of its ports
  int cpu{-1};                               ///< CPU on which the relay runs; -1: any
  std::filesystem::path json{};
};

/// Derives from the cell's file the limits that the guard enforces on the cell's controller.
/// @pre the cell has an LBR and a guard; the loader checks this
[[nodiscard]] safety::GuardParams GuardParamsOf(const config::CellConfig& cell);

/// The result of a run of the guard.
struct GuardReport {
  std::string cell, config_checksum;
  std::string version;                    ///< version of the FRI between arm and controller
  std::string arm_side, controller_side;  ///< "127.0.0.1:30209"
  io::FriRelayCounters relayed;
  safety::GuardCounters judged;  ///< counts of the datagrams that the monitor checked
  safety::GuardReason reason;    ///< kNone: nothing was latched
  rt::DurationHistogram message_delay, answer_delay;
  rt::RealtimeGrant thread;
  std::optional<io::PlcReading> plc;  ///< last reading of the PLC; absent: the cell has no PLC
};

/// Makes one JSON object, schema osteon.guard/1.
[[nodiscard]] std::string ToJson(const GuardReport& report);

/// Runs `osteon guard`: relays between arm and controller until Ctrl-C. With a PLC it then withdraws the
/// motion request and continues to relay until the arm is no longer commanded, at most 3 s; without a PLC it
/// ends at once.
/// @returns the process's exit code: 0: no datagram was withheld. 1: a datagram was withheld and the motion
/// request was withdrawn, or a socket was closed, or the report could not be written. 2: wrong input. 129:
/// its terminal was closed. 141: nobody reads its stdout.
[[nodiscard]] int RunGuard(const GuardOptions& options);

}  // namespace osteon::session
