#pragma once

#include <array>
#include <cstddef>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "config/reading/cell_config.h"
#include "control/guidance/guidance_field.h"
#include "safety/fault.h"
#include "studies/bench/tick_parts.h"

// Times a whole servo tick: the arm's message over loopback, the cell's devices in memory, the loop with
// eight planes at the tool, the answer, the recorder.

namespace osteon::studies {

/// The measured times of some ticks [us], one entry per tick.
struct TickTimes {
  static constexpr std::array<const char*, 5> kStages{"receive", "devices", "loop", "send", "record"};

  std::vector<double> tick;
  std::array<std::vector<double>, kStages.size()> stages;
  std::array<std::vector<double>, TickParts::kCount> parts;
  std::vector<double> bare;            ///< the kernel's own times (LoopbackBaseline), in some periods
  int allocations{0};                  ///< number of allocations in the ticks
  double force_N{0.0}, pressing{0.0};  ///< means of the coupling force and of the number of pressing planes
  double guided{0.0};                  ///< share of the ticks in which guidance acts
  bool realtime{false};
};

/// A cell in virtual time whose ticks are timed. Only ticks in which the tool presses count.
class TickBench {
 public:
  /// @param cell  with an LBR that has masses, a reaming script, and no PLC or interlock
  /// @param seconds  length of the script  @param guidance  along a plan, for the cell's tool; absent: none
  /// @throws std::runtime_error if something can't be opened.
  TickBench(const config::CellConfig& cell, double seconds,
            const std::optional<control::GuidanceParams>& guidance = {});
  ~TickBench();
  TickBench(TickBench&&) noexcept;
  TickBench& operator=(TickBench&&) = delete;

  [[nodiscard]] safety::FaultSet faults() const;

  struct Parts;  ///< everything that a tick needs; defined in tick_bench.cpp
  [[nodiscard]] Parts& parts() { return *parts_; }

 private:
  std::unique_ptr<Parts> parts_;
};

/// Times the benches' ticks in turn, each tick in a period of its own. The order of the benches is reversed
/// every second time. So a slow minute of the machine affects all benches equally. Runs in a thread of its
/// own, which gets real-time priority if the system permits it; the process keeps its own priority. Ends
/// early on Ctrl-C; a bench whose cell has ended has fewer ticks.
/// @returns the times of each bench, up to `ticks` of them
/// @throws std::runtime_error if a message is not answered.
[[nodiscard]] std::vector<TickTimes> TimeInTurn(std::span<TickBench> benches, std::size_t ticks);

/// The demo cell without the parts that a bench cannot use: the PLC, which another thread reads, and
/// injections.
/// @throws config::ConfigError, or std::invalid_argument if TickBench cannot use cells/demo.yaml.
[[nodiscard]] config::CellConfig BenchCell(const std::filesystem::path& config_root);

/// Length of a script in which the tool presses in at least `ticks` ticks [s].
[[nodiscard]] double ScriptSeconds(const config::CellConfig& cell, std::size_t ticks);

}  // namespace osteon::studies
