#pragma once

#include <string>
#include <vector>

namespace osteon::session {

/// Measures how long the machine kept processors from this process's threads: the time that they were ready
/// to run and did not, by the kernel's own count (/proc/self/task/*/schedstat), over the threads that exist
/// when it is constructed. Time that a hypervisor takes is not visible. If the kernel does not count,
/// involuntary context switches stand in.
class RunQueueWatch {
 public:
  RunQueueWatch();
  ~RunQueueWatch();
  RunQueueWatch(const RunQueueWatch&) = delete;
  RunQueueWatch& operator=(const RunQueueWatch&) = delete;

  /// Restarts the count. Takes about 2 us per thread.
  void Restart();
  /// Time since Restart, summed over the threads [us]. Without a kernel's count: 0, or infinity after an
  /// involuntary switch.
  [[nodiscard]] double Waited_us() const;

 private:
  std::vector<int> files_;
  std::vector<long long> waited_ns_;
  long switches_{0};
};

}  // namespace osteon::session
