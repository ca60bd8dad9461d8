#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "config/reading/cell_config.h"
#include "io/recording/recording_reader.h"
#include "session/procedure/procedure_tools.h"

namespace osteon::session {

/// The first value that differs in the replay.
struct ReplayDifference {
  std::uint64_t tick{0};
  std::string field;               ///< name of its column in the exported ticks
  std::string recorded, replayed;  ///< decimal, enough digits to tell them apart
};

/// The result of running a recording's ticks again.
struct ReplayResult {
  std::uint64_t ticks{0};            ///< number of ticks replayed
  std::uint64_t different_ticks{0};  ///< number of replayed ticks in which a value differs
  std::optional<ReplayDifference> first_difference;
  std::uint64_t not_run{0};  ///< number of ticks at the end that could not be replayed
  std::string why_not;       ///< why these ticks could not be replayed
  /// True if every replayed tick gave the same bits and every tick was replayed. One exception is allowed,
  /// the end of a run that was killed: ticks of the last second that could not be replayed because they used
  /// a frame newer than the last recorded one.
  bool identical{false};
};

/// Runs a new servo loop of `cell` on the recorded inputs and compares commands and records bit for bit. The
/// inputs are the arm's message or its absence, the force reading, the contact model that the tick saw, the
/// time, and whether a stop had been requested.
///
/// Ends early if an input is missing: a tick that the recorder had no room for, a contact model whose frame
/// is missing, an old recording without inputs. The bits depend on this program and this kind of processor:
/// the C library chooses its sine by the processor's features.
/// @param tools  of a procedure, whose tool `first_tool` was in use at the beginning; empty: the cell's own
[[nodiscard]] ReplayResult Replay(const io::Recording& recording, const config::CellConfig& cell,
                                  const std::vector<ProcedureTool>& tools = {}, int first_tool = 0);

}  // namespace osteon::session
