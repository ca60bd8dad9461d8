#include "studies/processes/cell_processes.h"

#include <chrono>
#include <stdexcept>
#include <thread>
#include <utility>

#include "base/read_text.h"
#include "config/reading/load.h"
#include "session/run/cell_ports.h"

namespace osteon::studies {
namespace {

// Longest wait until a part is ready; generous, so that a busy machine does not decide the outcome.
constexpr std::chrono::seconds kReady{60};
constexpr std::chrono::milliseconds kPollInterval{20};

}  // namespace

void CellProcesses::UseCell(const std::filesystem::path& file) {
  config::CellConfig cell = config::LoadCell(file);
  const auto port = session::UseSimulated(cell, 0);
  if (!port) throw std::runtime_error(port.error());
  port_ = std::to_string(*port);
  cell_file_ = std::filesystem::absolute(file);
}

std::unique_ptr<base::ChildProcess> CellProcesses::Start(const std::string& part,
                                                         const std::vector<std::string>& more) const {
  std::filesystem::remove_all(Folder(part));
  std::filesystem::create_directories(Folder(part));
  std::vector<std::string> words{part, cell_file_.string(), "--port", port_};
  words.insert(words.end(), more.begin(), more.end());
  auto process = base::ChildProcess::Start({.words = words,
                                            .program = base::ProgramBeside("osteon"),
                                            .folder = Folder(part),
                                            .out = Folder(part) / "stdout",
                                            .err = Folder(part) / "stderr"});
  if (!process) throw std::runtime_error(process.error());
  return std::move(*process);
}

bool CellProcesses::AwaitReady(const std::string& part, base::ChildProcess& process) const {
  const auto end = std::chrono::steady_clock::now() + kReady;
  while (std::chrono::steady_clock::now() < end && !(stop_ && stop_())) {
    if (base::ReadText(Folder(part) / "stdout").find("Ctrl-C ends it") != std::string::npos) return true;
    if (process.Ended()) return false;
    std::this_thread::sleep_for(kPollInterval);
  }
  return false;
}

std::string CellProcesses::Printed(const std::string& part) const {
  return base::ReadText(Folder(part) / "stderr") + base::ReadText(Folder(part) / "stdout");
}

std::string CellProcesses::LastError(const std::string& part) const {
  std::string text = base::ReadText(Folder(part) / "stderr");
  while (text.ends_with('\n')) text.pop_back();
  return text.substr(text.rfind('\n') + 1);
}

nlohmann::json CellProcesses::Report(const std::string& part) const {
  return nlohmann::json::parse(base::ReadText(Folder(part) / (part + ".json")), nullptr, false);
}

std::optional<CellReport> CellProcesses::ReportOfCell() const {
  const nlohmann::json cell = Report("cell");
  if (!cell.is_object()) return std::nullopt;
  return CellReport{.plc_blocks = cell.at("plc").at("blocks"),
                    .plc_permits = cell.at("plc").at("run_permitted"),
                    .spindle_rad_per_s = cell.at("spindle").at("speed_rad_per_s")};
}

std::string CellProcesses::ReasonOfGuard() const {
  const nlohmann::json guard = Report("guard");
  return guard.is_object() && guard.at("reason").is_string() ? guard.at("reason").get<std::string>() : "";
}

}  // namespace osteon::studies
