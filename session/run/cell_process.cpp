#include "session/run/cell_process.h"

#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <sstream>
#include <utility>
#include <vector>

#include <fmt/format.h>

namespace osteon::session {
namespace {

constexpr std::chrono::seconds kPatience{5};  // longest wait for a process to end before it is killed

// Makes the value of --tool: the file, or "FILE:DIAMETER" in mm.
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

  std::unique_ptr<CellProcess> cell(new CellProcess(report));
  // the arguments that the cell's process and the guard's process share
  std::vector<std::string> common_words{std::filesystem::absolute(params.cell).string()};
  if (params.first_port != 0)
    common_words.insert(common_words.end(), {"--port", std::to_string(params.first_port)});
  if (params.tool) common_words.insert(common_words.end(), {"--tool", ToolText(*params.tool)});
  const auto start = [&common_words](std::vector<std::string> words) {
    words.insert(words.end(), common_words.begin(), common_words.end());
    return base::ChildProcess::Start({.words = std::move(words)});
  };

  // the cell's process serves no page, because the run's own process serves one
  std::vector<std::string> words{"cell", "--json", report, "--console", "off"};
  if (!params.identified.empty())
    words.insert(words.end(), {"--identified", std::filesystem::absolute(params.identified).string()});
  if (!params.plan.empty())
    words.insert(words.end(),
                 {"--plan", std::filesystem::absolute(params.plan).string(), "--operator", params.hand});
  if (params.seconds > 0.0) words.insert(words.end(), {"--seconds", fmt::format("{:.17g}", params.seconds)});
  if (params.cpu >= 0) words.insert(words.end(), {"--cpu", std::to_string(params.cpu)});
  auto process = start(std::move(words));
  if (!process) return tl::make_unexpected(process.error());
  cell->process_ = std::move(*process);
  if (params.guard) {
    auto guard = start({"guard"});
    if (!guard) return tl::make_unexpected(guard.error());
    cell->guard_ = std::move(*guard);
  }
  return cell;
}

CellProcess::~CellProcess() {
  if (process_) AskToEnd();
  static_cast<void>(End());
  std::error_code error;
  std::filesystem::remove(report_, error);
}

std::string CellProcess::End() {
  if (process_) process_->End(kPatience);
  if (guard_) {
    guard_->Send(SIGTERM);
    guard_->End(kPatience);
  }
  std::ostringstream text;
  text << std::ifstream(report_).rdbuf();
  return text.str();
}

}  // namespace osteon::session
