#pragma once

#include <string>
#include <vector>

namespace osteon::app {

/// How long the machine kept processors from this process's threads: the time that they were ready to run and
/// did not, by the kernel's own count (/proc/self/task/*/schedstat), over the threads that there are when it
/// is made. What a hypervisor takes away is not seen. Where the kernel does not count, involuntary switches
/// stand for it.
class RunQueueWatch {
 public:
  RunQueueWatch();
  ~RunQueueWatch();
  RunQueueWatch(const RunQueueWatch&) = delete;
  RunQueueWatch& operator=(const RunQueueWatch&) = delete;

  /// Begins anew. Some 2 us a thread.
  void Begin();
  /// Since Begin, the sum over the threads [us]. Without a kernel's count 0, or infinity where a switch was
  /// involuntary.
  [[nodiscard]] double Waited_us() const;

 private:
  std::vector<int> files_;
  std::vector<long long> waited_ns_;
  long switches_{0};
};

}  // namespace osteon::app
