#pragma once

#include <string>
#include <vector>

namespace osteon::session {

/// Measures the time that this process's threads waited for a processor: they were ready to run, but had to
/// wait. The kernel counts this time (/proc/self/task/*/schedstat). The threads that exist at construction
/// are watched. Time that a hypervisor takes is not visible. If the kernel does not count, involuntary
/// context switches are used instead.
class RunQueueWatch {
 public:
  RunQueueWatch();
  ~RunQueueWatch();
  RunQueueWatch(const RunQueueWatch&) = delete;
  RunQueueWatch& operator=(const RunQueueWatch&) = delete;

  /// Restarts the count. Takes about 2 us per thread.
  void Restart();
  /// Time since Restart, summed over the threads [us]. If the kernel does not count: infinity if an
  /// involuntary context switch has happened since Restart, else 0.
  [[nodiscard]] double Waited_us() const;

 private:
  std::vector<int> files_;            // descriptors of the threads' schedstat files
  std::vector<long long> waited_ns_;  // time waited of each thread at Restart
  long switches_{0};                  // the process's involuntary switches at Restart
};

}  // namespace osteon::session
