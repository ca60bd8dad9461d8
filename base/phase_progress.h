#pragma once

#include <condition_variable>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

namespace osteon::base {

/// Shows on stderr which of several phases a command is in. A terminal shows a bar with the time of the
/// running phase; a file or a pipe gets one line per phase, or nothing. Stores the duration of each phase.
class PhaseProgress {
 public:
  struct Phase {
    std::string name;
    double seconds{0.0};
  };

  /// @param command  text at the beginning of each line  @param phases  number of phases
  /// @param lines  false: print nothing if stderr is not a terminal
  PhaseProgress(std::string command, int phases, bool lines = true);
  ~PhaseProgress();
  PhaseProgress(const PhaseProgress&) = delete;
  PhaseProgress& operator=(const PhaseProgress&) = delete;

  /// Ends the previous phase and begins the next.
  void BeginPhase(const std::string& name);
  /// Ends the last phase and clears the bar.
  void Done();
  [[nodiscard]] const std::vector<Phase>& phases() const { return done_; }

 private:
  /// Stores the duration of the running phase. Call with mutex_ locked.
  void EndPhase();
  /// The drawing thread: draws the bar ten times a second.
  void Draw(std::stop_token stop);

  std::string command_;
  int count_;  ///< number of phases
  bool terminal_, lines_;
  std::string running_;  ///< name of the running phase; empty: none
  double begun_s_{0.0};
  std::vector<Phase> done_;
  std::mutex mutex_;  ///< guards running_, begun_s_ and done_ against the drawing thread
  std::condition_variable_any wake_;
  std::jthread drawer_;
};

}  // namespace osteon::base
