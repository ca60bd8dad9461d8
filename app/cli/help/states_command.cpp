#include "app/cli/help/states_command.h"

#include <map>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "base/text.h"
#include "base/write_text.h"
#include "safety/cell_state.h"
#include "safety/motion_permit.h"
#include "session/process/exit_code.h"

namespace osteon::app {
namespace {

using safety::CellAction;
using safety::CellEvent;
using safety::CellState;
using safety::CellTransition;

template <class Each>
void ForEachState(Each&& each) {
  for (int i = 0; i < safety::kCellStates; ++i) each(static_cast<CellState>(i));
}
template <class Each>
void ForEachEvent(Each&& each) {
  for (int i = 0; i < safety::kCellEvents; ++i) each(static_cast<CellEvent>(i));
}
// Whether a transition neither changes the state nor acts.
bool HasNoEffect(CellState state, const CellTransition& next) {
  return next.state == state && next.action == CellAction::kNone;
}

// Returns the state machine as a Mermaid diagram: an arrow from state to state names the events that cause
// it.
std::string TransitionDiagram() {
  std::string text = "```mermaid\nstateDiagram-v2\n";
  ForEachState([&](CellState state) {
    text += fmt::format("  state \"{}\" as s{}\n", safety::Describe(state).name, static_cast<int>(state));
  });
  text += "  [*] --> s0\n";
  ForEachState([&](CellState state) {
    std::map<CellState, std::vector<std::string>> arrows;
    ForEachEvent([&](CellEvent event) {
      const CellTransition next = safety::Next(state, event);
      if (next.state != state) arrows[next.state].push_back(safety::Describe(event).name);
    });
    for (const auto& [to, events] : arrows)
      text += fmt::format("  s{} --> s{}: {}\n", static_cast<int>(state), static_cast<int>(to),
                          fmt::join(events, " / "));
  });
  return text + "```\n";
}

// Returns a Markdown table with a row per event and a column per state. A cell has the next state and the
// action; it is empty if the event has no effect.
std::string TransitionTable() {
  std::string head = "| |", line = "|---|";
  ForEachState([&](CellState state) {
    head += fmt::format(" {} |", safety::Describe(state).name);
    line += "---|";
  });
  std::string text = head + "\n" + line + "\n";
  ForEachEvent([&](CellEvent event) {
    text += fmt::format("| **{}** |", safety::Describe(event).name);
    ForEachState([&](CellState state) {
      const CellTransition next = safety::Next(state, event);
      if (HasNoEffect(state, next))
        text += " |";
      else
        text += fmt::format(" {}: {} |", safety::Describe(next.state).name, safety::NameOf(next.action));
    });
    text += "\n";
  });
  return text;
}

// Content of the file of `osteon states --json`.
std::string StatesJson() {
  nlohmann::ordered_json states = nlohmann::json::array(), transitions = nlohmann::json::array();
  ForEachState([&](CellState state) {
    const safety::CellStateText text = safety::Describe(state);
    states.push_back({{"number", static_cast<int>(state)},
                      {"name", text.name},
                      {"does", text.does},
                      {"leave", text.leave}});
    ForEachEvent([&](CellEvent event) {
      const CellTransition next = safety::Next(state, event);
      transitions.push_back({{"state", text.name},
                             {"event", safety::Describe(event).name},
                             {"next", safety::Describe(next.state).name},
                             {"action", safety::NameOf(next.action)}});
    });
  });
  return nlohmann::ordered_json{
             {"schema", "osteon.states/1"}, {"states", states}, {"transitions", transitions}}
             .dump(2) +
         "\n";
}

}  // namespace

std::string StatesPage() {
  std::string page =
      "# What the cell does, and what leads from one state to another\n\n" +
      base::WrapMarkdown(
          "Written by `osteon states --markdown docs/states.md` from the table in `safety/cell_state.cpp`, "
          "by which the servo loop lives. The recording has the number of the state by tick "
          "(`cell_state`).") +
      "\n\n"
      "| | state | what is done from tick to tick | how it is left |\n|---|---|---|---|\n";
  ForEachState([&](CellState state) {
    const safety::CellStateText text = safety::Describe(state);
    page += fmt::format("| {} | {} | {} | {} |\n", static_cast<int>(state), text.name, text.does, text.leave);
  });
  page += "\n## Before anything moves\n\n" +
          base::WrapMarkdown(
              "All of these hold in one tick (bits of `permits` in the recording, as last looked at while "
              "nothing moves; `osteon run` names what is missing):") +
          "\n\n| bit | |\n|---|---|\n";
  for (int bit = 0; bit < safety::kMotionPermits; ++bit)
    page += fmt::format("| {} | {} |\n", bit,
                        safety::DescribeMissing(static_cast<safety::MotionPermit>(1u << bit)));
  page +=
      "\n## Events\n\nThe worst first: of several in a tick the first counts first.\n\n"
      "| event | when |\n|---|---|\n";
  ForEachEvent([&](CellEvent event) {
    const safety::CellEventText text = safety::Describe(event);
    page += fmt::format("| {} | {} |\n", text.name, text.meaning);
  });
  page += "\n## State × event: next state, and what is done then\n\nEmpty: it stays, and goes on.\n\n";
  page += TransitionTable();
  page +=
      "\n## Stops\n\n" +
      base::WrapMarkdown(
          "Stop 0: the arm is not under control (silent, or not in COMMANDING_ACTIVE); nothing that is "
          "commanded counts. Stop 1: what is commanded brakes to rest, and the request for motion is "
          "withdrawn, so that the PLC may cut the power. Stop 2: the same under power, for a pause. Which "
          "fault leads to which: [faults.md](faults.md). What is braked is what was commanded, the tool's "
          "twist, the joints' last step or the path's clock, whatever the state was taken to be.") +
      "\n\n"
      "A pause is asked for with `osteon pause` and ended with `osteon resume`, of `osteon run` and "
      "`osteon demo`.\n\n"
      "## As a diagram\n\n";
  return page + TransitionDiagram();
}

int RunStates(const StatesOptions& options) {
  ForEachState([](CellState state) {
    const safety::CellStateText text = safety::Describe(state);
    fmt::print("{}\n  does:  {}\n  left:  {}\n", text.name, text.does, text.leave);
    ForEachEvent([&](CellEvent event) {
      const CellTransition next = safety::Next(state, event);
      if (!HasNoEffect(state, next))
        fmt::print("  {:<14} -> {}: {}\n", safety::Describe(event).name, safety::Describe(next.state).name,
                   safety::NameOf(next.action));
    });
  });
  for (const auto& [file, text] :
       {std::pair(options.markdown, StatesPage()), std::pair(options.json, StatesJson())}) {
    if (file.empty()) continue;
    if (const auto written = base::WriteText(file, text); !written)
      return session::Fail("states", written.error(), session::kFailed);
  }
  return 0;
}

}  // namespace osteon::app
