#pragma once

#include <sys/types.h>

#include <memory>
#include <string>

#include <tl/expected.hpp>

namespace osteon::base {

/// Halts a thread of a child process, as if it hung or were dead, while the rest of that process goes on. The
/// thread continues when this object is destroyed. Uses ptrace, as a debugger does, so the other process
/// needs no code for this.
class HaltedThread {
 public:
  /// @param name  of one of the process's threads, see rt::NameThread
  /// The error says that there is no such thread, or that the system does not permit halting it.
  [[nodiscard]] static tl::expected<std::unique_ptr<HaltedThread>, std::string> Halt(pid_t process,
                                                                                     const std::string& name);
  /// Lets the thread continue. Must run on the thread that called Halt, as the system requires.
  ~HaltedThread();
  HaltedThread(const HaltedThread&) = delete;
  HaltedThread& operator=(const HaltedThread&) = delete;

 private:
  explicit HaltedThread(pid_t thread) : thread_(thread) {}

  pid_t thread_;
};

}  // namespace osteon::base
