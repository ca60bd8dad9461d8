#include "base/halted_thread.h"

#include <sys/ptrace.h>
#include <sys/wait.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>

#include <fmt/format.h>

namespace osteon::base {
namespace {

// Returns the id of the thread with this name; 0 if there is none.
pid_t FindThread(pid_t process, const std::string& name) {
  std::error_code error;
  for (const auto& entry :
       std::filesystem::directory_iterator(fmt::format("/proc/{}/task", process), error)) {
    std::string found;
    std::getline(std::ifstream(entry.path() / "comm"), found);
    if (found == name) return static_cast<pid_t>(std::stol(entry.path().filename().string()));
  }
  return 0;
}

}  // namespace

tl::expected<std::unique_ptr<HaltedThread>, std::string> HaltedThread::Halt(pid_t process,
                                                                            const std::string& name) {
  const pid_t thread = FindThread(process, name);
  if (thread == 0)
    return tl::make_unexpected(fmt::format("process {}: found no thread \"{}\"", process, name));
  const auto refused = [&] {
    return tl::make_unexpected(
        fmt::format("cannot halt the thread \"{}\": {} (ptrace)", name, std::strerror(errno)));
  };
  if (ptrace(PTRACE_SEIZE, thread, nullptr, nullptr) != 0) return refused();
  std::unique_ptr<HaltedThread> halted(new HaltedThread(thread));
  if (ptrace(PTRACE_INTERRUPT, thread, nullptr, nullptr) != 0) return refused();
  if (waitpid(thread, nullptr, __WALL) != thread) return refused();
  return halted;
}

HaltedThread::~HaltedThread() { ptrace(PTRACE_DETACH, thread_, nullptr, nullptr); }

}  // namespace osteon::base
