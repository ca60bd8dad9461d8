#pragma once

#include <condition_variable>
#include <deque>
#include <filesystem>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <thread>

#include "session/procedure/session_file.h"
#include "simulation/bone/bone.h"
#include "simulation/engine/cutting_engine.h"

namespace osteon::session {

/// Writes carved states and session.json, in the order in which they were given: a session never names a
/// state that is not on the disk yet. In wall time on a thread of its own, as a state takes some 70 ms; else
/// at once. That thread has a low normal priority: it measures the bone as well (LiveScore).
class SessionWriter {
 public:
  /// @param bone  of all states; outlives this
  SessionWriter(std::filesystem::path folder, const simulation::Bone& bone, bool with_thread);
  ~SessionWriter();
  SessionWriter(const SessionWriter&) = delete;
  SessionWriter& operator=(const SessionWriter&) = delete;

  /// @param name  of the file, in the folder
  void WriteState(std::string name, std::shared_ptr<const simulation::CarvedState> state);
  void WriteSession(SessionFile session);
  /// Runs some work after what was given before; without a thread it is left out.
  void RunAfter(std::function<void()> work);
  /// Waits until all is written. @returns the first error so far; empty: none
  [[nodiscard]] std::string Flush();

 private:
  struct Job {
    std::string name;  // empty: the session
    std::shared_ptr<const simulation::CarvedState> state;
    SessionFile session;
    std::function<void()> work{};  // instead of writing; empty: none
  };
  void Push(Job job);
  void Write(const Job& job);
  void Loop();

  const std::filesystem::path folder_;
  const simulation::Bone& bone_;
  std::mutex mutex_;  // of what follows, down to error_
  std::condition_variable changed_;
  std::deque<Job> jobs_;
  bool busy_{false}, stop_{false};
  std::string error_;
  std::thread thread_;
};

}  // namespace osteon::session
