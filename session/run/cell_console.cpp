#include "session/run/cell_console.h"

#include <nlohmann/json.hpp>

#include "io/fri/session_name.h"
#include "session/run/cell_screen.h"
#include "session/run/console_scene.h"
#include "simulation/solids/cup_frame.h"

namespace osteon::session {

control::TickRecord RecordOf(const hil::CellState& cycle, double spindle_rad_per_s) {
  control::TickRecord record;
  record.tick = cycle.cycle;
  record.stamp = cycle.stamp;
  record.session_state = static_cast<std::uint8_t>(cycle.session);
  for (std::size_t i = 0; i < record.q_meas.size(); ++i) {
    record.q_meas[i] = cycle.q_meas[i];
    record.q_cmd[i] = cycle.q_cmd[i];
  }
  record.X_WT_cmd = record.X_WT_meas = cycle.X_WT_meas;
  record.v_WT_cmd_m_per_s = cycle.v_WT_meas_m_per_s;
  record.F_operator_T_W = cycle.F_hand_T_W;
  record.input.spindle_meas_rad_per_s = spindle_rad_per_s;
  return record;
}

std::string CellNote(const hil::CellHostState& state, bool rsi) {
  const hil::CellState& arm = state.arm.cell;
  const nlohmann::json json{{"type", "cell"},
                            {"session", rsi ? RsiStateText(arm.session) : io::SessionName(arm.session)},
                            {"commanded", arm.session == control::SessionState::kCommandingActive},
                            {"stop", hil::DescribeStop(arm)},
                            {"script_done", arm.script_done},
                            {"run_permitted", state.plc.run_permitted},
                            {"power_on", state.plc.power_on},
                            {"blocks", hil::DescribeBlocks(state.plc.blocks)},
                            {"sent", arm.counters.sent},
                            {"answered", arm.counters.answered},
                            {"lost", arm.counters.lost},
                            {"overruns", state.arm.overruns}};
  return json.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

tl::expected<std::unique_ptr<CellConsole>, std::string> CellConsole::Open(const ConsoleChoice& choice,
                                                                          const config::CellConfig& config,
                                                                          const std::string& cell,
                                                                          double seconds) {
  std::unique_ptr<CellConsole> made(new CellConsole(config.link.rsi() != nullptr));
  CellSetup setup;  // it has no bone, but the site to cut is drawn
  setup.config = config;
  setup.cell_name = cell;
  setup.bone.name = cell;
  setup.X_WG = config.X_WG * simulation::CupPose(setup.bone.site).inverse();
  made->note_ = CellNote({}, made->rsi_);
  auto server = console::ConsoleServer::Start(
      {.address = choice.address,
       .port = choice.port,
       .only_this_port = choice.only_this_port,
       .page = ConsolePageFolder(),
       .hello = ConsoleScene(setup, "cell", seconds, ""),
       .context = LiveContextOf(setup),
       .request =
           [](console::OperatorRequest) {
             return console::RequestAnswer{
                 .done = false,
                 .reason = "found a request to a simulated cell alone, accepted by the run that commands it"};
           },
       .notes = {[cell_console = made.get()] { return cell_console->Note(); }}},
      made->feed_, made->surface_);
  if (!server) return tl::make_unexpected(server.error());
  made->server_ = std::move(*server);
  return made;
}

void CellConsole::TakeCycle(const hil::CellState& cycle) {
  stamp_ = cycle.stamp;
  feed_.TakeTick(RecordOf(cycle, spindle_rad_per_s_));
}

void CellConsole::Show(const hil::CellHostState& state, const std::vector<std::string>& lines) {
  spindle_rad_per_s_ = state.tool_speed_rad_per_s;
  for (const std::string& line : lines) feed_.TakeEvent({.stamp = stamp_, .text = line});
  std::string note = CellNote(state, rsi_);
  const std::lock_guard lock(mutex_);
  note_ = std::move(note);
}

std::string CellConsole::Note() {
  const std::lock_guard lock(mutex_);
  return note_;
}

}  // namespace osteon::session
