#pragma once

#include <sys/types.h>

#include <memory>
#include <string>

#include <tl/expected.hpp>

namespace osteon::app {

/// A thread of a child process that stands still, as if it hung or were dead, while the rest of that process
/// goes on; it goes on where this object goes. The system's means for debuggers (ptrace), so nothing of the
/// other process takes part in it.
class HaltedThread {
 public:
  /// @param name  of one of its threads, see rt::NameThread
  /// The error says that there is no such thread, or that the system does not allow it.
  [[nodiscard]] static tl::expected<std::unique_ptr<HaltedThread>, std::string> Halt(pid_t process,
                                                                                     const std::string& name);
  /// By the thread that halted it, as the system wants it.
  ~HaltedThread();
  HaltedThread(const HaltedThread&) = delete;
  HaltedThread& operator=(const HaltedThread&) = delete;

 private:
  explicit HaltedThread(pid_t thread) : thread_(thread) {}

  pid_t thread_;
};

}  // namespace osteon::app
