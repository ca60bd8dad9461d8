#include "app/cell_process.h"

#include <fcntl.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <sstream>
#include <thread>
#include <vector>

#include <fmt/format.h>

namespace osteon::app {
namespace {

constexpr std::chrono::seconds kPatience{5};
constexpr std::chrono::milliseconds kLook{5};

std::string ToolText(const config::ToolChoice& tool) {
  const std::string file = std::filesystem::absolute(tool.file).string();
  return tool.diameter_m ? fmt::format("{}:{:.10g}", file, *tool.diameter_m * 1e3) : file;
}

}  // namespace

tl::expected<std::unique_ptr<CellProcess>, std::string> CellProcess::Start(const CellProcessParams& params) {
  std::string report = (std::filesystem::temp_directory_path() / "osteon_cell_XXXXXX").string();
  const int file = mkstemp(report.data());
  if (file < 0) return tl::make_unexpected(report + ": cannot make a file: " + std::strerror(errno));
  close(file);

  std::vector<std::string> words{"osteon", "cell", std::filesystem::absolute(params.cell).string(), "--json",
                                 report};
  if (params.seconds > 0.0) words.insert(words.end(), {"--seconds", fmt::format("{:.17g}", params.seconds)});
  if (params.first_port != 0) words.insert(words.end(), {"--port", std::to_string(params.first_port)});
  if (params.cpu >= 0) words.insert(words.end(), {"--cpu", std::to_string(params.cpu)});
  if (params.tool) words.insert(words.end(), {"--tool", ToolText(*params.tool)});
  std::vector<char*> arguments;
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);

  const pid_t parent = getpid();
  const pid_t pid = fork();
  if (pid < 0) return tl::make_unexpected(std::string("cannot start a process: ") + std::strerror(errno));
  if (pid == 0) {
    // only what may be called between fork and exec
    prctl(PR_SET_PDEATHSIG, SIGTERM);
    if (getppid() != parent) _exit(1);
    setpgid(0, 0);  // Ctrl-C is for the controller, which then ends the cell
    const int nothing = open("/dev/null", O_WRONLY | O_CLOEXEC);
    if (nothing >= 0) dup2(nothing, STDOUT_FILENO);
    execv("/proc/self/exe", arguments.data());
    _exit(127);
  }
  return std::unique_ptr<CellProcess>(new CellProcess(pid, report));
}

CellProcess::~CellProcess() {
  AskToEnd();
  static_cast<void>(End());
  std::error_code error;
  std::filesystem::remove(report_, error);
}

bool CellProcess::Ended() {
  if (!ended_) ended_ = waitpid(pid_, nullptr, WNOHANG) == pid_;
  return ended_;
}

void CellProcess::AskToEnd() const {
  if (!ended_) kill(pid_, SIGTERM);
}

std::string CellProcess::End() {
  const auto until = std::chrono::steady_clock::now() + kPatience;
  while (!Ended() && std::chrono::steady_clock::now() < until) std::this_thread::sleep_for(kLook);
  if (!ended_) {
    kill(pid_, SIGKILL);
    ended_ = waitpid(pid_, nullptr, 0) == pid_;
  }
  std::ostringstream text;
  text << std::ifstream(report_).rdbuf();
  return text.str();
}

}  // namespace osteon::app
