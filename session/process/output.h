#pragma once

#include <memory>

namespace osteon::session {

/// Replaces this process's stdout and stderr by streams whose writes never fail: output that a full disk or a
/// closed pipe does not accept is dropped, and OutputExitCode reports it at the end. Without this a print
/// throws. Closed descriptors 0 to 2 are opened on /dev/null first; otherwise the next opened file would get
/// one of these numbers, and the output would go into that file. Call it before anything else.
void InstallOutput();

/// Returns the exit code after the last print. @param code the exit code of the process's work @returns code;
/// 1 instead of 0 if stdout did not accept all output, which is then said on stderr; 141 (128 + SIGPIPE)
/// instead of 0 if nobody reads stdout any more.
[[nodiscard]] int OutputExitCode(int code);

class OutputQueue;

/// Parameters of OutputThread.
struct OutputThreadParams {
  /// Also treat a closed stderr as a reader that has gone away. Do not set it if stderr belongs to the parent
  /// process.
  bool watch_stderr{false};
};

/// While the object lives, a thread of its own writes what this process prints. So a print never waits, even
/// if the terminal is stopped (Ctrl-S) or the reader of a pipe is slow. While 64 KiB of output wait, output
/// to stderr is dropped and counted; output to stdout is kept.
///
/// A reader that goes away (`| head`, a terminal that was closed) does not end the process: SIGPIPE (and
/// SIGXFSZ, a file that may not grow) is ignored from here on, and Interrupted() becomes true within 0.1 s,
/// so that the work ends in order.
///
/// At most one at a time. Create it before the threads with a deadline, whose priority and CPU its thread
/// would inherit. Destroy it after they have ended; the destructor waits until everything is written.
class OutputThread {
 public:
  explicit OutputThread(const OutputThreadParams& params = {});
  ~OutputThread();
  OutputThread(const OutputThread&) = delete;
  OutputThread& operator=(const OutputThread&) = delete;

 private:
  std::unique_ptr<OutputQueue> queue_;
};

}  // namespace osteon::session
