#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "base/child_process.h"

namespace osteon::studies {

/// The report that `osteon cell` writes at its end.
struct CellReport {
  std::string plc_blocks{};  ///< why the PLC does not permit motion; empty: it permits motion
  bool plc_permits{false};
  double spindle_rad_per_s{0.0};
};

/// A slower spindle counts as stopped.
inline constexpr double kSpindleStands_rad_per_s = 0.5;

/// Starts the parts of a simulated cell as a user starts them: `osteon cell`, `osteon guard` and `osteon
/// run`, on free ports. Each part has a folder of its own, for its output and its report (`cell.json` for the
/// cell).
class CellProcesses {
 public:
  /// @param folder  exists already, or is made when the first part starts
  /// @param stop  polled while waiting for a part; true ends the waiting. May be empty.
  CellProcesses(std::filesystem::path folder, std::function<bool()> stop)
      : folder_(std::move(folder)), stop_(std::move(stop)) {}

  /// Sets the cell's file, and chooses free ports for the cell.
  /// @throws std::exception that says what is wrong with the file, or that no port is free.
  void UseCell(const std::filesystem::path& file);

  /// Empties the part's folder and starts the part in it. @param part  "cell", "guard" or "run"
  /// @param more  further arguments, after the cell's name and port
  /// @throws std::runtime_error saying why the part does not start.
  [[nodiscard]] std::unique_ptr<base::ChildProcess> Start(const std::string& part,
                                                          const std::vector<std::string>& more) const;
  /// Waits until the cell or the guard prints that it is ready. @returns false if it ends before, or is not
  /// ready within a minute
  [[nodiscard]] bool AwaitReady(const std::string& part, base::ChildProcess& process) const;

  [[nodiscard]] std::filesystem::path Folder(const std::string& part) const { return folder_ / part; }
  /// All that a part has printed.
  [[nodiscard]] std::string Printed(const std::string& part) const;
  /// The last line of a part's errors; empty if there is none.
  [[nodiscard]] std::string LastError(const std::string& part) const;

  /// A part's report (`--json PART.json`); a discarded JSON value if there is none.
  [[nodiscard]] nlohmann::json Report(const std::string& part) const;
  /// The cell's report; nothing if it left none.
  [[nodiscard]] std::optional<CellReport> ReportOfCell() const;
  /// Why the guard withheld datagrams; empty if it did not, or left no report.
  [[nodiscard]] std::string ReasonOfGuard() const;

 private:
  std::filesystem::path folder_, cell_file_;
  std::function<bool()> stop_;
  std::string port_;
};

}  // namespace osteon::studies
