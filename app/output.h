#pragma once

#include <memory>

namespace osteon::app {

/// Puts this process's stdout and stderr behind streams whose writes never fail: what a full disk or a closed
/// pipe does not take is dropped, and OutputExitCode says so at the end. Without it a print throws.
/// Descriptors 0 to 2 that are closed are opened on /dev/null first, or the next file that is opened would
/// get one of their numbers, and with it what is printed. To be called before anything else.
void InstallOutput();

/// After the last print. @param code  what the process would end with
/// @returns code; 1 in place of 0 where stdout did not take what was printed, which is then said on stderr;
/// 141 (128 + SIGPIPE) in place of 0 where nobody reads stdout any more.
[[nodiscard]] int OutputExitCode(int code);

class OutputQueue;

struct OutputThreadParams {
  /// A reader that closed stderr is one that went away, too. Not for a process whose stderr is its parent's.
  bool watch_stderr{false};
};

/// While it lives, what this process prints is handed over to a thread of its own: a print never waits, even
/// where the terminal was stopped (Ctrl-S) or the reader of a pipe is slow. What is printed to stderr while
/// 64 KiB wait is dropped and counted; stdout is kept.
///
/// A reader that goes away (`| head`, a terminal that was closed) does not end the process: SIGPIPE (and
/// SIGXFSZ, a file that may not grow) is ignored from here on, and Interrupted() becomes true within 0.1 s,
/// so that the work ends in order.
///
/// One at a time; to be made before the threads with a deadline, whose priority and CPU its thread would
/// inherit, and destroyed after they ended: waits until everything is written.
class OutputThread {
 public:
  explicit OutputThread(const OutputThreadParams& params = {});
  ~OutputThread();
  OutputThread(const OutputThread&) = delete;
  OutputThread& operator=(const OutputThread&) = delete;

 private:
  std::unique_ptr<OutputQueue> queue_;
};

}  // namespace osteon::app
