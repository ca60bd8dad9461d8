#include "session/run/ask_running_cell.h"

#include <cmath>
#include <cstdio>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "base/json_text.h"
#include "base/text.h"
#include "base/write_text.h"
#include "io/local/local_client.h"
#include "session/process/exit_code.h"

namespace osteon::session {
namespace {

constexpr std::size_t kName = 20;  // columns of a row's name

void PrintRow(const char* name, const std::string& value) {
  fmt::print("  {:<{}} {}\n", name, kName - 3, base::WrapForTerminal(value, kName));
}

std::string Joined(const nlohmann::json& names) {
  std::string text;
  for (const auto& name : names) text += (text.empty() ? "" : ", ") + name.get<std::string>();
  return text;
}

// "26.3 ms from hand to arm (sensor 1.0, …), 30.2 ms from bone to hand; assumed: sensor".
std::string LatencyLine(const nlohmann::json& latency) {
  std::string parts, assumed;
  for (const auto& [name, part] : latency["parts"].items()) {
    parts += fmt::format("{}{} {:.2f}", parts.empty() ? "" : ", ", name, part.value("mean", 0.0));
    if (!part.value("measured", false)) assumed += (assumed.empty() ? "" : ", ") + name;
  }
  return fmt::format("{:.1f} ms from hand to arm, {:.1f} ms from bone to hand ({}){}",
                     latency.value("hand_to_arm", 0.0), latency.value("bone_to_hand", 0.0), parts,
                     assumed.empty() ? "" : "; assumed: " + assumed);
}

// "48 mm, 2 of 4".
std::string ToolLine(const nlohmann::json& procedure) {
  const nlohmann::json tool = procedure.value("tool", nlohmann::json::object());
  return fmt::format("{:g} mm, {} of {}", tool.value("diameter_mm", 0.0), tool.value("number", 0),
                     tool.value("of", 0));
}

std::string PassesLine(const nlohmann::json& procedure) {
  const int undone = procedure.value("undone", 0);
  return fmt::format("{}{}", procedure.value("passes", 0),
                     undone > 0 ? fmt::format(", and {} undone", undone) : "");
}

// "3.2 mm above its planned place, 0.4 mm aside, tilted by 2.1°; outside the plan's corridor: tilt".
std::string PlaceLine(const nlohmann::json& procedure) {
  if (!procedure.value("known", false)) return "not known before the first frame";
  const double to_go_mm = procedure.value("to_go_mm", 0.0);
  std::string beyond;
  const nlohmann::json all = procedure.value("beyond", nlohmann::json::object());
  for (const auto& [name, is_beyond] : all.items())
    if (is_beyond.is_boolean() && is_beyond.get<bool>()) beyond += (beyond.empty() ? "" : ", ") + name;
  return fmt::format("{:.1f} mm {} its planned place, {:.1f} mm aside, tilted by {:.1f}°{}",
                     std::abs(to_go_mm), to_go_mm < 0.0 ? "below" : "above", procedure.value("aside_mm", 0.0),
                     procedure.value("tilt_deg", 0.0),
                     beyond.empty() ? "" : "; outside the plan's corridor: " + beyond);
}

void PrintProcedure(const nlohmann::json& procedure) {
  if (!procedure.is_object()) return;
  PrintRow("Tool", ToolLine(procedure));
  PrintRow("Passes", PassesLine(procedure));
  PrintRow("Place", PlaceLine(procedure));
  if (const auto gain = procedure.find("guidance"); gain != procedure.end() && gain->is_number())
    PrintRow("Guidance", fmt::format("{:g} of the plan's", gain->get<double>()));
}

// Says to the person who asked what a request has done; `procedure` is null without a session.
std::string DoneText(const std::string& request, const nlohmann::json& procedure) {
  if (request == "pause") return "the cell brakes to rest";
  if (request == "resume") return "motion begins once every condition holds";
  if (request == "recover") return "the faults are cleared once every condition holds";
  if (request == "stop") return "the run ends in order";
  if (!procedure.is_object()) return "done";
  const std::string word = request.substr(0, request.find(' '));
  if (word == "next" || word == "tool") return "tool: " + ToolLine(procedure);
  if (word == "undo") return "the last pass is taken back; passes that count: " + PassesLine(procedure);
  if (word == "save") return "saved; passes that count: " + PassesLine(procedure);
  if (word == "cup") return "the tool's pose is kept as the cup's";
  if (word == "guidance") return "guidance: " + request.substr(request.find(' ') + 1) + " of the plan's";
  return "done";
}

// The answer was made by this program's own kind, yet a value of another type must not end the process.
void PrintStatus(const nlohmann::json& status, const nlohmann::json& run, const nlohmann::json& procedure) {
  fmt::print("Osteon {}: {}\n", run.value("command", ""), run.value("cell", ""));
  if (!status.value("known", false)) return PrintRow("State", "waits for the first message");
  PrintRow("State", status.value("state", "") + ": " + status.value("does", ""));
  PrintRow("It leaves by", status.value("leave", ""));
  for (const auto& fault : status["faults"]) {
    PrintRow("Fault", fault.value("name", "") + ": " + fault.value("cause", ""));
    PrintRow("Cure", fault.value("clearing", ""));
  }
  for (const auto& permit : status["permits"])
    if (status.value("permits_known", false) && !permit.value("holds", true))
      PrintRow("Missing", permit.value("text", ""));
  PrintProcedure(procedure);
  PrintRow("Force", fmt::format("{:.1f} N of at most {:g} N; hand {:.1f} N", status.value("force_N", 0.0),
                                status.value("force_limit_N", 0.0), status.value("hand_N", 0.0)));
  PrintRow("Depth", fmt::format("{:.2f} mm, deepest {:.2f} mm", status.value("depth_mm", 0.0),
                                status.value("deepest_mm", 0.0)));
  PrintRow("Removed", fmt::format("{:.1f} mm³", status.value("removed_mm3", 0.0)));
  PrintRow("Limits acting", status["limits"].empty() ? "none" : Joined(status["limits"]));
  PrintRow("Ages", fmt::format("contact model {:.1f} ms, force sensor {:.1f} ms",
                               status.value("model_age_ms", 0.0), status.value("sensor_age_ms", 0.0)));
  if (const auto latency = status.find("latency_ms"); latency != status.end() && latency->is_object())
    PrintRow("Latency", LatencyLine(*latency));
  const double wanted_s = run.value("seconds", 0.0), paused_s = status.value("paused_s", 0.0);
  std::string time = fmt::format("{:.1f} s", status.value("rendered_s", 0.0));
  if (wanted_s > 0.0) time += fmt::format(" of {:g} s", wanted_s);
  if (paused_s > 0.0) time += fmt::format(", and {:.1f} s paused", paused_s);
  PrintRow("Rendered", time);
}

std::filesystem::path SocketOf(const AskOptions& options, const std::vector<std::filesystem::path>& running) {
  if (options.pid == 0) return running.front();
  const std::string name = fmt::format("run-{}", options.pid);
  for (const std::filesystem::path& socket : running)
    if (socket.stem() == name) return socket;
  return {};
}

std::string Names(const std::vector<std::filesystem::path>& running) {
  std::string text;
  for (const std::filesystem::path& socket : running) {
    const auto answer = io::AskLocalServer(socket, "status");
    const auto json = answer ? nlohmann::json::parse(*answer, nullptr, false) : nlohmann::json();
    const std::string pid = socket.stem().string().substr(std::string("run-").size());
    text += (text.empty() ? "" : ", ") + pid;
    if (json.is_object() && json.contains("run"))
      text += " (" + json["run"].value("command", "") + " " + json["run"].value("cell", "") + ")";
  }
  return text;
}

// Whether a running cell is the one that the user names: by its session's folder, or by the cell's name.
bool IsNamed(const nlohmann::json& run, const std::string& name) {
  if (run.value("cell", "") == name) return true;
  const auto session = run.find("session");
  if (session == run.end() || !session->is_string()) return false;
  std::error_code error;
  return std::filesystem::equivalent(session->get<std::string>(), name, error);
}

// Shows an answer and keeps it. @returns the exit code
int TakeAnswer(const std::string& command, const std::string& request, const std::string& text,
               const std::filesystem::path& json) {
  const auto answer = nlohmann::json::parse(text, nullptr, false);
  if (!answer.is_object()) return Fail(command, "the running cell's answer cannot be read", kFailed);
  if (!json.empty())
    if (const auto written = base::WriteText(json, base::JsonText(answer)); !written)
      return Fail(command, written.error(), kFailed);
  if (!answer.value("done", false)) return Fail(command, answer.value("reason", ""), kFailed);
  const nlohmann::json procedure = answer.value("procedure", nlohmann::json(nullptr));
  if (request == "status")
    PrintStatus(answer["status"], answer["run"], procedure);
  else
    fmt::print("osteon {}: {}\n", command, DoneText(request, procedure));
  return 0;
}

}  // namespace

int RunTell(const TellOptions& options) {
  std::vector<std::filesystem::path> named;
  for (const std::filesystem::path& socket : io::FindLocalServers()) {
    const auto text = io::AskLocalServer(socket, "status");
    const auto answer = text ? nlohmann::json::parse(*text, nullptr, false) : nlohmann::json();
    if (answer.is_object() && answer.contains("run") && IsNamed(answer["run"], options.session))
      named.push_back(socket);
  }
  if (named.empty())
    return Fail(
        "tell",
        fmt::format("found no running cell of {}, accepted a running session's folder or the name of a "
                    "running cell",
                    options.session),
        kFailed);
  if (named.size() > 1)
    return Fail("tell", fmt::format("{}: found {} running cells of this name, accepted a session's folder",
                                    options.session, named.size()));
  const auto text = io::AskLocalServer(named.front(), options.request);
  if (!text) return Fail("tell", text.error(), kFailed);
  return TakeAnswer("tell", options.request, *text, options.json);
}

int RunAsk(const AskOptions& options) {
  const std::vector<std::filesystem::path> running = io::FindLocalServers();
  if (running.empty()) return Fail(options.request, "no cell runs on this machine under this user", kFailed);
  if (options.pid == 0 && running.size() > 1)
    return Fail(options.request,
                "--pid: found none, and several cells run; accepted one of " + Names(running));
  const std::filesystem::path socket = SocketOf(options, running);
  if (socket.empty())
    return Fail(options.request,
                fmt::format("--pid: found {}, accepted one of {}", options.pid, Names(running)));
  const auto text = io::AskLocalServer(socket, options.request);
  if (!text) return Fail(options.request, text.error(), kFailed);
  return TakeAnswer(options.request, options.request, *text, options.json);
}

}  // namespace osteon::session
