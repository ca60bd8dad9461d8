#include "config/reading/sections/read_arm_link.h"

#include <algorithm>

#include <fmt/format.h>

#include "base/units.h"

namespace osteon::config {
namespace {

// Reads section `fri` for both ends of the connection: returns the parameters of the loop's end, and sets
// those of the simulated arm in `arm`.
io::FriSessionParams ReadFri(Reader section, hil::FriServerParams& arm) {
  io::FriSessionParams session;
  arm.send_period_ms = section.WholeNumber("period_ms", 1, 20);
  if (section.Has("receive_multiplier_count"))
    arm.receive_multiplier = section.WholeNumber("receive_multiplier_count", 1, 10);
  if (section.Has("version"))
    session.version = io::kFriVersions.at(
        section.Choice("version", {"1.11", "1.12", "1.13", "1.14", "1.15", "1.16", "2.5", "2.7"}));
  if (section.Has("wrench_torques"))
    session.torque_order = section.Choice("wrench_torques", {"zyx", "xyz"}) == 0 ? io::FriTorqueOrder::kZyx
                                                                                 : io::FriTorqueOrder::kXyz;
  arm.version = session.version;
  arm.torques_zyx = session.torque_order == io::FriTorqueOrder::kZyx;
  return session;
}

// Reads section `link_quality`: how the simulated arm rates the connection and when it ends the session.
void ReadLinkQuality(Reader section, hil::FriServerParams& fri) {
  hil::QualityPolicyParams& quality = fri.quality;
  quality.fair_after_answers = section.WholeNumber("fair_answered_count", 1, 1000);
  quality.good_after_answers = section.WholeNumber("good_answered_count", 1, 1000);
  quality.excellent_after_answers = section.WholeNumber("excellent_answered_count", 1, 1000);
  quality.good_max_lost_per_s = section.WholeNumber("good_lost_count", 0, 1000);
  quality.end_after_lost_in_a_row = section.WholeNumber("end_lost_in_a_row_count", 1, 1000);
  quality.end_after_lost_per_s = section.WholeNumber("end_lost_count", 1, 1000);
  quality.good_timeout_s = section.Number("good_timeout_s", 0.1, 600);
  if (section.Has("ask_again")) fri.request_again_after_loss = section.Bool("ask_again");
  if (section.Has("session_end"))
    fri.session_end = section.Choice("session_end", {"silence", "idle_messages"}) == 0
                          ? hil::SessionEnd::kSilence
                          : hil::SessionEnd::kIdleMessages;
}

// Refuses values that hil::LinkQuality does not accept, each at its line of the file.
void CheckLinkQuality(const Reader& section, const hil::FriServerParams& fri) {
  const hil::QualityPolicyParams& quality = fri.quality;
  const auto at_least = [&](const char* key, int value, const char* other_key, int other) {
    if (value < other)
      section.Refuse(key, fmt::format("found {}, accepted at least {} ({})", value, other_key, other));
  };
  at_least("good_answered_count", quality.good_after_answers, "fair_answered_count",
           quality.fair_after_answers);
  at_least("excellent_answered_count", quality.excellent_after_answers, "good_answered_count",
           quality.good_after_answers);
  const int answers_per_s = 1000 / (fri.send_period_ms * fri.receive_multiplier);
  if (quality.excellent_after_answers > answers_per_s)
    section.Refuse("excellent_answered_count",
                   fmt::format("found {}, accepted at most {}: the answers due in a second at this period_ms",
                               quality.excellent_after_answers, answers_per_s));
}

// Reads section `rsi` for the loop's end. @param[out] jump_accepted  value of accept_jump_after_lost_answers
io::RsiSessionParams ReadRsi(Reader section, bool& jump_accepted) {
  io::RsiSessionParams session;
  session.layout =
      section.Choice("layout", {"im_free", "kroshu"}) == 0 ? io::RsiLayout::kImFree : io::RsiLayout::kKroshu;
  session.kind = section.Choice("correction", {"axes", "cartesian"}) == 0 ? io::RsiCorrection::kAxes
                                                                          : io::RsiCorrection::kCartesian;
  session.absolute = section.Bool("absolute");
  session.hold_on = section.Bool("hold_on");
  jump_accepted =
      section.Has("accept_jump_after_lost_answers") && section.Bool("accept_jump_after_lost_answers");
  session.cycle_ms = section.Choice("cycle_ms", {"4", "12"}) == 0 ? 4 : 12;
  session.ipoc_step = section.WholeNumber("ipoc_step_count", 1, 12);
  session.timeout_cycles = section.WholeNumber("timeout_count", 1, 10'000);
  session.range = ReadCorrectionRange(section, "range", session.kind);
  if (section.Has("entry_step_deg"))
    session.entry_step_deg = section.Number("entry_step_deg", 0.01, 10) / kDegree;
  if (section.Has("settle_count")) session.settle_messages = section.WholeNumber("settle_count", 1, 1000);
  if (section.Has("late_at_start_count"))
    session.late_at_start = section.WholeNumber("late_at_start_count", 0, 100);
  if (section.Has("decimal_count")) session.decimals = section.WholeNumber("decimal_count", 1, 9);
  return session;
}

// The simulated arm's end of RSI, with the parameters that it must share with the loop's session.
hil::RsiArmParams ArmEndOf(const io::RsiSessionParams& session) {
  hil::RsiArmParams arm;
  arm.controller.cycle_ms = session.cycle_ms;
  arm.controller.format =
      session.layout == io::RsiLayout::kImFree ? hil::RsiFormat::kImFree : hil::RsiFormat::kKroshu;
  arm.controller.cartesian = session.kind == io::RsiCorrection::kCartesian;
  arm.controller.absolute = session.absolute;
  arm.controller.hold_on = session.hold_on;
  arm.controller.timeout_cycles = session.timeout_cycles;
  arm.controller.ipoc_step = session.ipoc_step;
  arm.handed_over_answers = session.settle_messages;
  return arm;
}

}  // namespace

std::array<double, 6> ReadCorrectionRange(Reader& section, const std::string& name, io::RsiCorrection kind) {
  std::array<double, 6> range{};
  if (kind == io::RsiCorrection::kAxes) {
    const std::vector<double> axes_rad = section.Numbers(name + "_deg", 6, 0.01, 360);
    for (std::size_t i = 0; i < 6; ++i) range[i] = axes_rad[i] / kDegree;
    return range;
  }
  const std::vector<double> translation_m = section.Numbers(name + "_mm", 3, 0.01, 5000),
                            rotation_rad = section.Numbers(name + "_deg", 3, 0.01, 180);
  for (std::size_t i = 0; i < 3; ++i) {
    range[i] = translation_m[i] / kMillimetre_m;
    range[i + 3] = rotation_rad[i] / kDegree;
  }
  return range;
}

ArmLinkSections ReadArmLink(Reader& cell_section, CellConfig& cell) {
  ArmLinkSections sections{.link = cell_section.OneSection({"fri", "rsi"})};
  cell.link.host = sections.link.Text("host");
  if (sections.link.Has("arm_host")) cell.link.arm_host = sections.link.Text("arm_host");
  cell.link.port = static_cast<std::uint16_t>(sections.link.WholeNumber("port", 1024, 65535));
  if (cell_section.Has("rsi")) {
    const io::RsiSessionParams session = ReadRsi(sections.link, sections.jump_accepted);
    cell.simulated.kr = ArmEndOf(session);
    cell.servo.period_s = 1e-3 * session.cycle_ms;
    cell.link.session = session;
  } else {
    cell.link.session = ReadFri(sections.link, cell.simulated.fri);
    cell.servo.period_s = 1e-3 * cell.simulated.fri.send_period_ms;
    if (cell.has_simulation || cell_section.Has("link_quality")) {
      sections.quality = cell_section.Section("link_quality");
      ReadLinkQuality(*sections.quality, cell.simulated.fri);
    }
  }
  return sections;
}

void CheckArmLink(const ArmLinkSections& sections, const CellConfig& cell) {
  // On an address other than the loopback's, a datagram of any machine could be taken for the arm's first
  // message.
  const std::string& host = cell.guard ? cell.guard->host : cell.link.host;
  if (!host.starts_with("127.") && cell.link.arm_host.empty())
    sections.link.Refuse("arm_host",
                         fmt::format("found none with the address {}, accepted the arm's address: "
                                     "datagrams of others are refused then",
                                     host));
  if (sections.quality) return CheckLinkQuality(*sections.quality, cell.simulated.fri);
  if (!cell.link.rsi()) return;
  const Reader& link = sections.link;
  const io::RsiSessionParams& session = *cell.link.rsi();
  if (session.absolute && !session.hold_on && !sections.jump_accepted)
    link.Refuse("hold_on",
                "found false with absolute corrections, accepted true: after a lost answer the arm would "
                "jump back to where RSI began. Set HOLDON to 1 in the Ethernet file and hold_on: true here, "
                "or accept the danger by accept_jump_after_lost_answers: true");
  if (session.ipoc_step != 1 && session.ipoc_step != session.cycle_ms)
    link.Refuse("ipoc_step_count",
                fmt::format("found {}, accepted 1, or cycle_ms ({})", session.ipoc_step, session.cycle_ms));
  // The robot's controller ends RSI if a correction leaves the range of its monitor [mm, deg], so the loop's
  // range must not be larger.
  const hil::Six& monitor = cell.simulated.kr->controller.range;
  for (std::size_t i = 0; i < 6; ++i)
    if (cell.has_simulation && session.range[i] > monitor[i])
      link.Refuse(session.kind == io::RsiCorrection::kCartesian && i < 3 ? "range_mm" : "range_deg",
                  fmt::format("found {:.10g}, accepted at most {:.10g}: the simulated arm's monitor, which "
                              "ends RSI",
                              session.range[i], monitor[i]));
}

void CompleteArmLink(const Reader& cell_section, CellConfig& cell) {
  const SixAxisConfig* six_axis = cell.robot.six_axis();
  const bool rsi = cell.link.rsi() != nullptr;
  if ((six_axis != nullptr) != rsi)
    cell_section.Refuse("robot",
                        fmt::format("found {} with {} joints, accepted {}", cell.robot.name, six_axis ? 6 : 7,
                                    rsi ? "an arm of six axes, which rsi drives; an LBR needs fri"
                                        : "an LBR, which fri drives; an arm of six axes needs rsi"));
  if (!six_axis) return;
  std::get<io::RsiSessionParams>(cell.link.session).arm = six_axis->params;
  cell.simulated.kr->controller.arm = six_axis->params;
}

}  // namespace osteon::config
