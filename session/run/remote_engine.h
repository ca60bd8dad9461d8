#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>

#include <tl/expected.hpp>

#include "base/child_process.h"
#include "io/engine/engine_ports.h"
#include "session/run/cell_run.h"
#include "session/setup/cell_setup.h"
#include "simulation/engine/cutting_engine.h"

namespace osteon::session {

/// An engine in another process. In virtual time it is stepped like any other engine. In wall time the servo
/// loop and a FrameReceiver use client() instead.
class RemoteEngine final : public simulation::CuttingEngine {
 public:
  /// Starts `osteon simulate` as a child process, or connects to the process that the cell's file names, and
  /// waits until that process has made its engine. The error says what failed in either process.
  [[nodiscard]] static tl::expected<std::unique_ptr<RemoteEngine>, std::string> Open(
      const CellSetup& setup, const EngineChoice& choice, const std::filesystem::path& cell_yaml);
  ~RemoteEngine() override;

  /// Steps the engine and waits for its frame. If the frame takes longer than kLockstepPatience, the status
  /// is kDeviceLost.
  simulation::ContactModel Step(const simulation::FrameInput& input) override;
  /// The carved state. It is known only after Finish.
  [[nodiscard]] simulation::CarvedState Snapshot() const override { return carved_; }
  /// @throws std::invalid_argument always, because the other process always begins with the uncut bone
  void Restore(const simulation::CarvedState& state) override;
  [[nodiscard]] std::string name() const override { return client_->engine(); }
  [[nodiscard]] std::string device() const override { return client_->device(); }

  [[nodiscard]] io::EngineClient& client() { return *client_; }
  /// Says why the process has ended by itself; empty while it runs, or if this run did not start it.
  [[nodiscard]] std::string DescribeEnd();
  /// Ends the frames and fetches the carved state from the other process. If that process is gone, an engine
  /// in this process cuts the recorded frames again. Then ends the other process, if this run started it.
  /// @param recording  the run's recording, which must be closed
  [[nodiscard]] EngineProcessResult Finish(const std::filesystem::path& recording);
  /// The process in words: "local, process 123" or its address and port.
  [[nodiscard]] const std::string& where() const { return where_; }

  static constexpr rt::Nanoseconds kLockstepPatience = 10 * rt::kSecond;

 private:
  RemoteEngine(const CellSetup& setup, EngineChoice choice) : setup_(setup), choice_(std::move(choice)) {}
  // These functions start the child process, connect to a process over UDP, fetch carved_ from it, and
  // compute carved_ from the recorded frames on the CPU. Each returns what went wrong; empty: nothing.
  [[nodiscard]] std::string StartLocal();
  [[nodiscard]] std::string Connect(const std::filesystem::path& cell_yaml);
  [[nodiscard]] std::string FetchCarved();
  [[nodiscard]] std::string CarveAgain(const std::filesystem::path& recording);

  const CellSetup& setup_;
  EngineChoice choice_;
  std::unique_ptr<io::EngineClient> client_;
  std::unique_ptr<base::ChildProcess> child_;  // the child process; null: this run started none
  std::string where_;                          // process or address, in words
  std::string ended_;                          // why the process ended by itself; empty: not seen to end
  simulation::CarvedState carved_;
};

/// Returns the path of the program `osteon` in the folder of the running program, which may be
/// osteon-studies: that has no `simulate`.
[[nodiscard]] std::filesystem::path OsteonProgram();

/// Makes the engine of a run in this process or, if the cell's `simulation` says so, in another process. In
/// the latter case `remote` points to the engine.
[[nodiscard]] tl::expected<std::unique_ptr<simulation::CuttingEngine>, std::string> MakeRunEngine(
    const CellSetup& setup, const EngineChoice& choice, const std::filesystem::path& cell_yaml,
    RemoteEngine*& remote);

}  // namespace osteon::session
