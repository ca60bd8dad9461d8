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

/// Writes carved states and session.json in the order in which they were given, so that a session never names
/// a state that is not on the disk yet. In wall time a thread of its own writes, since a state takes some 70
/// ms; in virtual time the caller writes. The thread has a low normal priority, because it also measures the
/// bone (LiveScore).
class SessionWriter {
 public:
  /// @param bone  the bone of all states; must outlive this object
  SessionWriter(std::filesystem::path folder, const simulation::Bone& bone, bool with_thread);
  ~SessionWriter();
  SessionWriter(const SessionWriter&) = delete;
  SessionWriter& operator=(const SessionWriter&) = delete;

  /// Writes a state, or gives it to the thread. @param name  name of the file in the folder
  void WriteState(std::string name, std::shared_ptr<const simulation::CarvedState> state);
  void WriteSession(SessionFile session);
  /// Runs some work after everything that was given before, in the thread. Without a thread, the work is
  /// dropped.
  void RunAfter(std::function<void()> work);
  /// Waits until all is written. @returns the first error so far; empty: none
  [[nodiscard]] std::string Flush();

 private:
  // One thing to write, or work to do.
  struct Job {
    std::string name;  // name of the state's file; empty: session.json is written
    std::shared_ptr<const simulation::CarvedState> state;
    SessionFile session;
    std::function<void()> work{};  // done instead of writing; empty: the job is to write
  };
  // Gives the job to the thread, or does it at once without a thread.
  void Push(Job job);
  void Write(const Job& job);
  void Loop();

  const std::filesystem::path folder_;
  const simulation::Bone& bone_;
  std::mutex mutex_;  // guards the following members, down to error_
  std::condition_variable changed_;
  std::deque<Job> jobs_;
  bool busy_{false}, stop_{false};
  std::string error_;
  std::thread thread_;
};

}  // namespace osteon::session
