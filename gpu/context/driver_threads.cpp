#include "gpu/context/driver_threads.h"

#include <sched.h>
#include <unistd.h>

#include <algorithm>
#include <charconv>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <thread>

namespace osteon::gpu {
namespace {

constexpr const char* kTasks = "/proc/self/task";  // has a folder for each thread of this process
// PinWorkers reads the threads' names at most kMaxLooks times, with the pause kLookPause in between.
constexpr int kMaxLooks = 15;
constexpr std::chrono::milliseconds kLookPause{2};
constexpr const char* kRasterizer = "llvmpipe-";  // prefix of a rasterizer thread's name, before its number

// Sorted ids of this process's threads; empty if the system does not list them.
std::vector<int> Threads() {
  std::vector<int> ids;
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator(kTasks, error)) {
    const std::string text = entry.path().filename().string();
    int id = 0;
    if (std::from_chars(text.data(), text.data() + text.size(), id).ec == std::errc{}) ids.push_back(id);
  }
  std::sort(ids.begin(), ids.end());
  return ids;
}

// Name of a thread of this process; empty if the thread has ended.
std::string NameOf(int id) {
  std::ifstream file(std::filesystem::path(kTasks) / std::to_string(id) / "comm");
  std::string name;
  std::getline(file, name);
  return name;
}

}  // namespace

DriverThreads::DriverThreads() : before_(Threads()) {}

// Finds rasterizer threads (by name) and worker threads (by order) among the threads begun since
// construction.
DriverThreads::Begun DriverThreads::FindWorkers() const {
  // a thread without a name of its own inherits the name of the thread that created it
  const std::string own_name = NameOf(static_cast<int>(gettid()));
  std::vector<int> ids;
  const std::vector<int> now = Threads();
  std::set_difference(now.begin(), now.end(), before_.begin(), before_.end(), std::back_inserter(ids));
  Begun begun;
  for (const int id : ids) {
    const std::string name = NameOf(id);
    if (name.starts_with(kRasterizer)) ++begun.rasterizers;
    if (name != own_name) continue;
    ++begun.unnamed;
    if (begun.workers.size() < begun.rasterizers) begun.workers.push_back(id);
  }
  return begun;
}

int DriverThreads::PinWorkers() const {
  // A rasterizer thread sets its name when it first runs. On a busy machine this can be some time after the
  // device is open.
  Begun begun = FindWorkers();
  for (int look = 0; look < kMaxLooks && begun.unnamed != begun.rasterizers; ++look) {
    std::this_thread::sleep_for(kLookPause);
    begun = FindWorkers();
  }
  const std::vector<int>& workers = begun.workers;
  cpu_set_t allowed;
  if (workers.size() != begun.rasterizers || sched_getaffinity(0, sizeof allowed, &allowed) != 0 ||
      static_cast<std::size_t>(CPU_COUNT(&allowed)) < workers.size())
    return 0;

  int pinned = 0, core = 0;
  for (const int id : workers) {
    while (!CPU_ISSET(core, &allowed)) ++core;
    cpu_set_t alone;
    CPU_ZERO(&alone);
    CPU_SET(core++, &alone);
    if (sched_setaffinity(id, sizeof alone, &alone) == 0) ++pinned;
  }
  return pinned;
}

}  // namespace osteon::gpu
