#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <memory>
#include <string>
#include <vector>

#include <tl/expected.hpp>

#include "hil/simulated_cell.h"

namespace osteon::session {

/// The true state in one cycle of the simulated arm: a row of `osteon cell --trace`.
struct CellCycle {
  rt::Nanoseconds stamp{0};  ///< the system's monotonic clock, common to all processes of a machine
  control::SessionState session{control::SessionState::kIdle};
  Vector3 p_WT_m{Vector3::Zero()};  ///< place of the tool's apex in the world
  double speed_m_per_s{0.0}, turn_rad_per_s{0.0};
  double hand_N{0.0};  ///< size of the force of the operator's hand
};

/// Whether the tool moves: it is faster than 2 mm/s or 0.02 rad/s.
[[nodiscard]] bool Moves(const CellCycle& cycle);

/// Returns how long the arm has been at rest at the end of `cycles`, counted from `since` at the earliest. An
/// arm that is commanded (COMMANDING_ACTIVE) does not count as at rest, however slow it is, because its stop
/// is still to come.
[[nodiscard]] rt::Nanoseconds RestedFor(const std::vector<CellCycle>& cycles, rt::Nanoseconds since);

/// Writes each cycle of a simulated arm into a CSV file while the arm runs.
class CellTraceWriter {
 public:
  /// The error names the file.
  [[nodiscard]] static tl::expected<std::unique_ptr<CellTraceWriter>, std::string> Open(
      const std::filesystem::path& file);

  /// Writes a cycle; a reader sees it after Flush.
  void Write(const hil::CellState& cycle);
  void Flush() { stream_.flush(); }
  /// Writes the file's end. @param dropped  number of cycles that were lost before Write The error names the
  /// file, and what is missing.
  [[nodiscard]] tl::expected<void, std::string> Close(std::uint64_t dropped);

 private:
  explicit CellTraceWriter(const std::filesystem::path& file) : file_(file), stream_(file) {}

  std::filesystem::path file_;
  std::ofstream stream_;
};

/// Reads the file of a CellTraceWriter while it grows.
class CellTraceReader {
 public:
  explicit CellTraceReader(std::filesystem::path file) : file_(std::move(file)) {}

  /// Reads the complete rows since the last call. The file may not exist yet.
  void Poll();
  [[nodiscard]] const std::vector<CellCycle>& cycles() const { return cycles_; }

 private:
  std::filesystem::path file_;
  std::streamoff at_{0};  // position of the first row that has not been read
  std::vector<CellCycle> cycles_;
};

}  // namespace osteon::session
