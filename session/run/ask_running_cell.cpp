#include "session/run/ask_running_cell.h"

#include <cmath>
#include <cstdio>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "base/json_text.h"
#include "base/json_value.h"
#include "base/text.h"
#include "base/write_text.h"
#include "io/local/local_client.h"
#include "session/process/exit_code.h"

namespace osteon::session {
namespace {

using base::FlagAt;
using base::NumberAt;
using base::TextAt;
using base::ValueAt;

constexpr std::size_t kNameWidth = 20;  // number of columns before a row's value

void PrintRow(const char* name, const std::string& value) {
  fmt::print("  {:<{}} {}\n", name, kNameWidth - 3,
             base::WrapForTerminal(base::Printable(value), kNameWidth));
}

// Joins the texts of a list, as in "force, speed".
std::string JoinedNames(const nlohmann::json& names) {
  std::string text;
  for (const auto& name : names)
    if (name.is_string()) text += (text.empty() ? "" : ", ") + name.get<std::string>();
  return text;
}

// Formats "26.3 ms from hand to arm (sensor 1.0, …), 30.2 ms from bone to hand; assumed: sensor".
std::string LatencyLine(const nlohmann::json& latency) {
  std::string parts, assumed;
  for (const auto& [name, part] : ValueAt(latency, "parts").items()) {
    parts += fmt::format("{}{} {:.2f}", parts.empty() ? "" : ", ", name, NumberAt(part, "mean"));
    if (!FlagAt(part, "measured")) assumed += (assumed.empty() ? "" : ", ") + name;
  }
  const std::string from_hand =
      ValueAt(latency, "hand_to_arm").is_null()
          ? std::string("the hand moves the arm itself")
          : fmt::format("{:.1f} ms from hand to arm", NumberAt(latency, "hand_to_arm"));
  return fmt::format("{}, {:.1f} ms from bone to hand ({}){}", from_hand, NumberAt(latency, "bone_to_hand"),
                     parts, assumed.empty() ? "" : "; assumed: " + assumed);
}

// Formats the tool in use, its diameter and its number in the plan: "48 mm, 2 of 4".
std::string ToolLine(const nlohmann::json& procedure) {
  const nlohmann::json& tool = ValueAt(procedure, "tool");
  return fmt::format("{:g} mm, {:g} of {:g}", NumberAt(tool, "diameter_mm"), NumberAt(tool, "number"),
                     NumberAt(tool, "of"));
}

// Formats the number of passes: "3, and 1 undone".
std::string PassesLine(const nlohmann::json& procedure) {
  const double undone = NumberAt(procedure, "undone");
  return fmt::format("{:g}{}", NumberAt(procedure, "passes"),
                     undone > 0.0 ? fmt::format(", and {:g} undone", undone) : "");
}

// Formats the tool's place relative to the plan: "3.2 mm above its planned place, 0.4 mm aside, tilted by
// 2.1°; outside the plan's corridor: tilt".
std::string PlaceLine(const nlohmann::json& procedure) {
  if (!FlagAt(procedure, "known")) return "not known before the first frame";
  const double to_go_mm = NumberAt(procedure, "to_go_mm");
  std::string beyond;
  const nlohmann::json& flags = ValueAt(procedure, "beyond");
  for (const auto& [name, is_beyond] : flags.items())
    if (is_beyond.is_boolean() && is_beyond.get<bool>()) beyond += (beyond.empty() ? "" : ", ") + name;
  return fmt::format("{:.1f} mm {} its planned place, {:.1f} mm aside, tilted by {:.1f}°{}",
                     std::abs(to_go_mm), to_go_mm < 0.0 ? "below" : "above", NumberAt(procedure, "aside_mm"),
                     NumberAt(procedure, "tilt_deg"),
                     beyond.empty() ? "" : "; outside the plan's corridor: " + beyond);
}

// Formats the score: "61.2 of 100 so far, 30 points open; 2 passes, 14 s ago".
std::string ScoreLine(const nlohmann::json& score) {
  if (!FlagAt(score, "known")) return "not known before the first pass has ended";
  std::string text = fmt::format("{:.1f} of {:g} so far, {:g} points open; of {:g} pass{}, {:g} s ago",
                                 NumberAt(score, "total"), NumberAt(score, "of"),
                                 NumberAt(score, "open_points"), NumberAt(score, "passes"),
                                 NumberAt(score, "passes") == 1.0 ? "" : "es", NumberAt(score, "age_s"));
  if (FlagAt(score, "newer")) text += "; bone was cut since";
  if (FlagAt(score, "guided")) text += "; guided: not to be ranked with sessions without guidance";
  return text;
}

void PrintProcedure(const nlohmann::json& procedure) {
  if (!procedure.is_object()) return;
  PrintRow("Tool", ToolLine(procedure));
  PrintRow("Passes", PassesLine(procedure));
  PrintRow("Place", PlaceLine(procedure));
  if (const auto gain = procedure.find("guidance"); gain != procedure.end() && gain->is_number())
    PrintRow("Guidance", fmt::format("{:g} of the plan's", gain->get<double>()));
  const nlohmann::json& score = ValueAt(procedure, "score");
  if (!score.is_object() || !TextAt(score, "why").empty()) return;
  PrintRow("Score", ScoreLine(score));
  if (const std::string left = TextAt(score, "unfinished"); !left.empty()) PrintRow("Left of the plan", left);
}

// Makes the text that tells the user what a request has done; `procedure` is null without a session.
std::string DoneText(const std::string& request, const nlohmann::json& procedure) {
  if (request == "pause") return "the cell brakes to rest";
  if (request == "resume") return "motion begins once every condition holds";
  if (request == "recover") return "the faults are cleared once every condition holds";
  if (request == "stop") return "the run ends in order";
  if (!procedure.is_object()) return "done";
  const std::string word = request.substr(0, request.find(' '));
  if (word == "next" || word == "tool") return "tool: " + ToolLine(procedure);
  if (word == "undo") return "the last pass is undone; passes that count: " + PassesLine(procedure);
  if (word == "save") return "saved; passes that count: " + PassesLine(procedure);
  if (word == "finish") return "the session is saved, and the run ends in order";
  if (word == "cup") return "the tool's pose is kept as the cup's";
  if (word == "guidance") return "guidance: " + request.substr(request.find(' ') + 1) + " of the plan's";
  return "done";
}

void PrintStatus(const nlohmann::json& status, const nlohmann::json& run, const nlohmann::json& procedure) {
  fmt::print("Osteon {}: {}\n", TextAt(run, "command"), TextAt(run, "cell"));
  if (!FlagAt(status, "known")) return PrintRow("State", "waits for the first message");
  PrintRow("State", TextAt(status, "state") + ": " + TextAt(status, "does"));
  PrintRow("It leaves by", TextAt(status, "leave"));
  for (const auto& fault : ValueAt(status, "faults")) {
    PrintRow("Fault", TextAt(fault, "name") + ": " + TextAt(fault, "cause"));
    PrintRow("Cure", TextAt(fault, "clearing"));
  }
  for (const auto& permit : ValueAt(status, "permits"))
    if (FlagAt(status, "permits_known") && !FlagAt(permit, "holds", true))
      PrintRow("Missing", TextAt(permit, "text"));
  PrintProcedure(procedure);
  PrintRow("Force", fmt::format("{:.1f} N of at most {:g} N; hand {:.1f} N", NumberAt(status, "force_N"),
                                NumberAt(status, "force_limit_N"), NumberAt(status, "hand_N")));
  PrintRow("Depth", fmt::format("{:.2f} mm, deepest {:.2f} mm", NumberAt(status, "depth_mm"),
                                NumberAt(status, "deepest_mm")));
  PrintRow("Removed", fmt::format("{:.1f} mm³", NumberAt(status, "removed_mm3")));
  const std::string limits = JoinedNames(ValueAt(status, "limits"));
  PrintRow("Limits acting", limits.empty() ? "none" : limits);
  const auto age = [&status](const char* key) {
    return ValueAt(status, key).is_number() ? fmt::format("{:.1f} ms", NumberAt(status, key)) : "none yet";
  };
  PrintRow("Ages",
           fmt::format("contact model {}, force sensor {}", age("model_age_ms"), age("sensor_age_ms")));
  if (const auto latency = status.find("latency_ms"); latency != status.end() && latency->is_object())
    PrintRow("Latency", LatencyLine(*latency));
  const double wanted_s = NumberAt(run, "seconds"), paused_s = NumberAt(status, "paused_s");
  std::string time = fmt::format("{:.1f} s", NumberAt(status, "rendered_s"));
  if (wanted_s > 0.0) time += fmt::format(" of {:g} s", wanted_s);
  if (paused_s > 0.0) time += fmt::format(", and {:.1f} s paused", paused_s);
  PrintRow("Rendered", time);
}

// Returns the socket of the run with options.pid, or of the only run; empty: no such run.
std::filesystem::path SocketOf(const AskOptions& options, const std::vector<std::filesystem::path>& running) {
  if (options.pid == 0) return running.front();
  const std::string name = fmt::format("run-{}", options.pid);
  for (const std::filesystem::path& socket : running)
    if (socket.stem() == name) return socket;
  return {};
}

// Lists the running cells: "1234 (run hip), 1240 (demo acetabulum)".
std::string RunningCells(const std::vector<std::filesystem::path>& running) {
  std::string text;
  for (const std::filesystem::path& socket : running) {
    const auto answer = io::AskLocalServer(socket, "status");
    const auto json = answer ? nlohmann::json::parse(*answer, nullptr, false) : nlohmann::json();
    const std::string pid = socket.stem().string().substr(std::string("run-").size());
    text += (text.empty() ? "" : ", ") + pid;
    if (const nlohmann::json& run = ValueAt(json, "run"); run.is_object())
      text += " (" + TextAt(run, "command") + " " + TextAt(run, "cell") + ")";
  }
  return text;
}

// Whether the user's name for a cell fits this running cell: the folder of its session, or the cell's name.
bool IsNamed(const nlohmann::json& run, const std::string& name) {
  if (TextAt(run, "cell") == name) return true;
  const auto session = run.find("session");
  if (session == run.end() || !session->is_string()) return false;
  std::error_code error;
  return std::filesystem::equivalent(session->get<std::string>(), name, error);
}

// Shows an answer, and writes it to the JSON file if one is named. @returns the exit code
int ShowAnswer(const std::string& command, const std::string& request, const std::string& text,
               const std::filesystem::path& json) {
  const auto answer = nlohmann::json::parse(text, nullptr, false);
  if (!answer.is_object()) return Fail(command, "the running cell's answer cannot be read", kFailed);
  if (!json.empty())
    if (const auto written = base::WriteText(json, base::JsonText(answer)); !written)
      return Fail(command, written.error(), kFailed);
  if (!FlagAt(answer, "done")) return Fail(command, TextAt(answer, "reason"), kFailed);
  const nlohmann::json& procedure = ValueAt(answer, "procedure");
  if (request == "status")
    PrintStatus(ValueAt(answer, "status"), ValueAt(answer, "run"), procedure);
  else
    fmt::print("osteon {}: {}\n", command, DoneText(request, procedure));
  return 0;
}

// Says that no cell gave an answer, and writes that as the answer to the JSON file. @returns the exit code
int FailWithoutAnswer(const std::string& command, const std::string& reason,
                      const std::filesystem::path& json) {
  if (!json.empty())
    if (const auto written =
            base::WriteText(json, base::JsonText(nlohmann::json{{"done", false}, {"reason", reason}}));
        !written)
      return Fail(command, written.error(), kFailed);
  return Fail(command, reason, kFailed);
}

}  // namespace

int RunTell(const TellOptions& options) {
  std::vector<std::filesystem::path> named;
  for (const std::filesystem::path& socket : io::FindLocalServers()) {
    const auto text = io::AskLocalServer(socket, "status");
    const auto answer = text ? nlohmann::json::parse(*text, nullptr, false) : nlohmann::json();
    if (answer.is_object() && answer.contains("run") && IsNamed(ValueAt(answer, "run"), options.session))
      named.push_back(socket);
  }
  if (named.empty())
    return FailWithoutAnswer(
        "tell",
        fmt::format("found no running cell of {}, accepted a running session's folder or the name of a "
                    "running cell",
                    options.session),
        options.json);
  if (named.size() > 1)
    return Fail("tell", fmt::format("{}: found {} running cells of this name, accepted a session's folder",
                                    options.session, named.size()));
  const auto text = io::AskLocalServer(named.front(), options.request);
  if (!text) return FailWithoutAnswer("tell", text.error(), options.json);
  return ShowAnswer("tell", options.request, *text, options.json);
}

int RunAsk(const AskOptions& options) {
  const std::vector<std::filesystem::path> running = io::FindLocalServers();
  if (running.empty())
    return FailWithoutAnswer(
        options.request,
        "no cell runs on this machine under this user, and none as a service that this user may ask (group "
        "osteon)",
        options.json);
  if (options.pid == 0 && running.size() > 1)
    return Fail(options.request,
                "--pid: found none, and several cells run; accepted one of " + RunningCells(running));
  const std::filesystem::path socket = SocketOf(options, running);
  if (socket.empty())
    return Fail(options.request,
                fmt::format("--pid: found {}, accepted one of {}", options.pid, RunningCells(running)));
  const auto text = io::AskLocalServer(socket, options.request);
  if (!text) return FailWithoutAnswer(options.request, text.error(), options.json);
  return ShowAnswer(options.request, options.request, *text, options.json);
}

}  // namespace osteon::session
