#include "base/child_process.h"

#include <fcntl.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <thread>

#include <fmt/format.h>

#include "base/read_text.h"

namespace osteon::base {
namespace {

// time between two checks whether the process has ended
constexpr std::chrono::milliseconds kPollInterval{5};

// Makes `descriptor` write to a file. Called between fork and exec, where only async-signal-safe calls are
// permitted.
void Redirect(const char* file, int descriptor) {
  const int opened = open(file, O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0600);
  if (opened >= 0) dup2(opened, descriptor);
}

}  // namespace

std::filesystem::path ProgramBeside(const std::string& name) {
  std::error_code ignored;
  return std::filesystem::read_symlink("/proc/self/exe", ignored).parent_path() / name;
}

pid_t FindChild(pid_t parent, const std::string& word) {
  std::error_code error;
  for (const std::filesystem::directory_entry& entry : std::filesystem::directory_iterator("/proc", error)) {
    const std::string name = entry.path().filename().string();
    if (name.find_first_not_of("0123456789") != std::string::npos) continue;
    const std::string status = ReadText(entry.path() / "status");
    if (status.find(fmt::format("\nPPid:\t{}\n", parent)) == std::string::npos) continue;
    const std::string line = ReadText(entry.path() / "cmdline");  // each of its words ends with a zero
    if (line.find('\0' + word + '\0') != std::string::npos) return std::stoi(name);
  }
  return 0;
}

tl::expected<std::unique_ptr<ChildProcess>, std::string> ChildProcess::Start(ChildParams params) {
  params.words.insert(params.words.begin(), "osteon");
  std::vector<char*> arguments;
  for (std::string& word : params.words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  if (params.out.empty()) params.out = "/dev/null";
  if (params.program.empty()) params.program = "/proc/self/exe";

  const pid_t parent = getpid();
  const pid_t pid = fork();
  if (pid < 0) return tl::make_unexpected(std::string("cannot start a process: ") + std::strerror(errno));
  if (pid == 0) {
    prctl(PR_SET_PDEATHSIG, SIGTERM);
    if (getppid() != parent) _exit(1);
    setpgid(0, 0);  // Ctrl-C then reaches only the parent, which ends this child
    if (!params.folder.empty() && chdir(params.folder.c_str()) != 0) _exit(126);
    Redirect(params.out.c_str(), STDOUT_FILENO);
    if (!params.err.empty()) Redirect(params.err.c_str(), STDERR_FILENO);
    execv(params.program.c_str(), arguments.data());
    _exit(127);
  }
  return std::unique_ptr<ChildProcess>(new ChildProcess(pid));
}

ChildProcess::~ChildProcess() { End(std::chrono::milliseconds(0)); }

bool ChildProcess::Ended() {
  if (!ended_) ended_ = waitpid(pid_, &status_, WNOHANG) == pid_;
  return ended_;
}

void ChildProcess::Send(int signal_number) const {
  if (!ended_) kill(pid_, signal_number);
}

int ChildProcess::End(std::chrono::milliseconds patience) {
  const auto until = std::chrono::steady_clock::now() + patience;
  while (!Ended() && std::chrono::steady_clock::now() < until) std::this_thread::sleep_for(kPollInterval);
  if (!ended_) {
    kill(pid_, SIGKILL);
    ended_ = waitpid(pid_, &status_, 0) == pid_;
  }
  return WIFEXITED(status_) ? WEXITSTATUS(status_) : 128 + WTERMSIG(status_);
}

}  // namespace osteon::base
