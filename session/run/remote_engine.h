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

/// The client of an engine in another process. In lockstep it is an engine like any other; in wall time the
/// servo loop and a FrameReceiver use its client().
class RemoteEngine final : public simulation::CuttingEngine {
 public:
  /// Starts `osteon simulate` as a child process, or connects to the one that the cell's file names, and
  /// waits until it has made its engine. The error says what failed, in that process or in this one.
  [[nodiscard]] static tl::expected<std::unique_ptr<RemoteEngine>, std::string> Open(
      const CellSetup& setup, const EngineChoice& choice, const std::filesystem::path& cell_yaml);
  ~RemoteEngine() override;

  /// Steps the engine and waits for its frame. If the frame takes longer than kLockstepPatience, the status
  /// is kDeviceLost.
  simulation::ContactModel Step(const simulation::FrameInput& input) override;
  /// The carved state, after Finish.
  [[nodiscard]] simulation::CarvedState Snapshot() const override { return carved_; }
  /// @throws std::invalid_argument always: the process begins with the uncut bone
  void Restore(const simulation::CarvedState& state) override;
  [[nodiscard]] std::string name() const override { return client_->engine(); }
  [[nodiscard]] std::string device() const override { return client_->device(); }

  [[nodiscard]] io::EngineClient& client() { return *client_; }
  /// Says why the process has ended by itself; empty while it runs, or if this run did not start it.
  [[nodiscard]] std::string DescribeEnd();
  /// Ends the frames and takes the carved state from the process. If that process is gone, an engine in this
  /// process cuts the recorded frames again. Then ends that process, if this run started it.
  /// @param recording  the run's recording, which must be closed
  [[nodiscard]] EngineProcessResult Finish(const std::filesystem::path& recording);
  /// The process in words: "local, process 123" or its address and port.
  [[nodiscard]] const std::string& where() const { return where_; }

  static constexpr rt::Nanoseconds kLockstepPatience = 10 * rt::kSecond;

 private:
  RemoteEngine(const CellSetup& setup, EngineChoice choice) : setup_(setup), choice_(std::move(choice)) {}
  // Start the child process, or connect to one over UDP; fetch carved_ from it, or compute carved_ from the
  // recorded frames on the CPU. Each returns what went wrong; empty: nothing.
  [[nodiscard]] std::string StartLocal();
  [[nodiscard]] std::string Connect(const std::filesystem::path& cell_yaml);
  [[nodiscard]] std::string FetchCarved();
  [[nodiscard]] std::string CarveAgain(const std::filesystem::path& recording);

  const CellSetup& setup_;
  EngineChoice choice_;
  std::unique_ptr<io::EngineClient> client_;
  std::unique_ptr<base::ChildProcess> child_;  // null: this run did not start it
  std::string where_;                          // process or address, in words
  std::string ended_;                          // why the process ended by itself; empty: not seen to end
  simulation::CarvedState carved_;
};

/// Returns the path of the program `osteon`, which lies beside this one: osteon-studies has no `simulate`.
[[nodiscard]] std::filesystem::path OsteonProgram();

/// Makes the engine of a run in this process or, if the cell's `simulation` says so, in another process; then
/// `remote` points to it.
[[nodiscard]] tl::expected<std::unique_ptr<simulation::CuttingEngine>, std::string> MakeRunEngine(
    const CellSetup& setup, const EngineChoice& choice, const std::filesystem::path& cell_yaml,
    RemoteEngine*& remote);

}  // namespace osteon::session
