#include "session/planning/run_queue_watch.h"

#include <fcntl.h>
#include <sys/resource.h>
#include <unistd.h>

#include <array>
#include <charconv>
#include <filesystem>
#include <limits>
#include <string_view>

namespace osteon::session {
namespace {

/// Reads a thread's time waited [ns], the second of the three numbers in its schedstat file; 0 if the file
/// has none.
long long WaitedNs(int file) {
  std::array<char, 96> text{};
  const ssize_t read = ::pread(file, text.data(), text.size(), 0);
  const std::string_view line(text.data(), read > 0 ? static_cast<std::size_t>(read) : 0);
  const std::size_t space = line.find(' ');
  if (space == line.npos) return 0;
  long long value = 0;
  std::from_chars(line.data() + space + 1, line.data() + line.size(), value);
  return value;
}

/// Number of involuntary context switches of this process.
long InvoluntarySwitches() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return usage.ru_nivcsw;
}

}  // namespace

RunQueueWatch::RunQueueWatch() {
  std::error_code error;
  for (const auto& task : std::filesystem::directory_iterator("/proc/self/task", error)) {
    const int file = ::open((task.path() / "schedstat").c_str(), O_RDONLY | O_CLOEXEC);
    if (file >= 0) files_.push_back(file);
  }
  Restart();
}

RunQueueWatch::~RunQueueWatch() {
  for (const int file : files_) ::close(file);
}

void RunQueueWatch::Restart() {
  waited_ns_.clear();
  for (const int file : files_) waited_ns_.push_back(WaitedNs(file));
  switches_ = InvoluntarySwitches();
}

double RunQueueWatch::Waited_us() const {
  if (files_.empty())
    return InvoluntarySwitches() != switches_ ? std::numeric_limits<double>::infinity() : 0.0;
  double sum_ns = 0.0;
  for (std::size_t i = 0; i < files_.size(); ++i)
    sum_ns += static_cast<double>(WaitedNs(files_[i]) - waited_ns_[i]);
  return 1e-3 * sum_ns;
}

}  // namespace osteon::session
