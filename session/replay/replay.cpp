#include "session/replay/replay.h"

#include <bit>
#include <map>
#include <tuple>
#include <type_traits>

#include <fmt/format.h>

#include "control/loop/loop_repeat.h"
#include "session/replay/tick_fields.h"
#include "session/setup/recorded_config.h"

namespace osteon::session {
namespace {

using control::TickRecord;
using simulation::ContactModel;

// A killed process loses its last frames, while the ticks that used these frames may already be written. If
// such ticks at the end span at most this time, the replay still counts as identical.
constexpr rt::Nanoseconds kMaxTornEnd = rt::kSecond;

// The contact models of a recording's frames. A tick's record of its model (frame, stamp, status) finds the
// model.
class Models {
 public:
  explicit Models(const std::vector<simulation::FrameRecord>& frames) {
    for (const simulation::FrameRecord& frame : frames) {
      const ContactModel& m = frame.model;
      models_[{m.frame, m.pose_stamp, static_cast<std::uint8_t>(m.status)}] = &m;
      last_frame_ = std::max(last_frame_, m.frame);
    }
  }

  // Finds the model that a tick used. Null if the model's frame is not in the recording.
  [[nodiscard]] const ContactModel* Find(const TickRecord& tick) {
    const auto found = models_.find({tick.model_frame, tick.input.model_pose_stamp, tick.input.model_status});
    if (found != models_.end()) return found->second;
    if (tick.model_frame != 0 || tick.input.model_pose_stamp != 0) return nullptr;
    none_.status = static_cast<simulation::EngineStatus>(tick.input.model_status);
    return &none_;
  }
  [[nodiscard]] std::uint64_t last_frame() const { return last_frame_; }

 private:
  std::map<std::tuple<std::uint64_t, rt::Nanoseconds, std::uint8_t>, const ContactModel*> models_;
  ContactModel none_;  // the model that ticks see before the first frame
  std::uint64_t last_frame_{0};
};

// Returns the bits of a double, or the value of an integer.
template <class T>
std::uint64_t BitsOf(T value) {
  if constexpr (std::is_floating_point_v<T>)
    return std::bit_cast<std::uint64_t>(value);
  else
    return static_cast<std::uint64_t>(value);
}

// Returns the first field whose bits differ, or nothing.
std::optional<ReplayDifference> FirstDifference(const TickRecord& recorded, const TickRecord& replayed) {
  constexpr std::size_t kMaxFields = 192;
  std::array<std::uint64_t, kMaxFields> bits{};
  std::size_t count = 0;
  VisitOutputs(recorded, [&](const FieldName&, auto value) { bits.at(count++) = BitsOf(value); });
  std::size_t at = 0, first = count;
  VisitOutputs(replayed, [&](const FieldName&, auto value) {
    if (bits[at] != BitsOf(value) && at < first) first = at;
    ++at;
  });
  if (first == count) return {};

  ReplayDifference difference{.tick = recorded.tick, .field = {}, .recorded = {}, .replayed = {}};
  // returns the differing value as text, and sets the field's name
  const auto text_of = [first](const TickRecord& record, std::string& name) {
    std::string text;
    std::size_t i = 0;
    VisitOutputs(record, [&](const FieldName& field, auto value) {
      if (i++ != first) return;
      name = field.Text();
      text = fmt::format("{}", value);
    });
    return text;
  };
  difference.recorded = text_of(recorded, difference.field);
  difference.replayed = text_of(replayed, difference.field);
  return difference;
}

}  // namespace

ReplayResult Replay(const io::Recording& recording, const config::CellConfig& cell,
                    const std::vector<ProcedureTool>& tools, int first_tool) {
  ReplayResult result;
  control::ServoLoop loop = MakeServoLoop(cell);
  if (!tools.empty()) SetTools(tools, first_tool, loop);
  Models models(recording.frames);
  control::ArmCommand command;
  bool torn_end = false;
  for (const TickRecord& recorded : recording.ticks) {
    // refuse a tick whose inputs are incomplete
    const ContactModel* model = models.Find(recorded);
    if (recorded.input.now == 0) {
      result.why_not = fmt::format("tick {} has no inputs: they were not recorded yet then", recorded.tick);
    } else if (recorded.tick != result.ticks) {
      result.why_not =
          fmt::format("found tick {} where {} was due: the disk was behind and ticks are missing",
                      recorded.tick, result.ticks);
    } else if (model == nullptr) {
      result.why_not = fmt::format("tick {} saw frame {}, which is not in the recording", recorded.tick,
                                   recorded.model_frame);
      torn_end = recorded.model_frame > models.last_frame() &&
                 recording.ticks.back().stamp - recorded.stamp <= kMaxTornEnd;
    }
    if (!result.why_not.empty()) break;

    TickRecord replayed = control::ReplayTick(loop, recorded, *model, command);
    // compare the command that is sent, not the loop's own record of it
    replayed.q_cmd = command.q;
    replayed.activation_cmd = command.activation;
    replayed.F_cmd_T = command.F;
    replayed.tau_cmd = command.tau;
    if (recorded.cell_state == control::kNoCellState) {  // an old recording without this field
      replayed.cell_state = recorded.cell_state;
      replayed.permits = recorded.permits;
    }
    ++result.ticks;
    auto difference = FirstDifference(recorded, replayed);
    if (!difference) continue;
    ++result.different_ticks;
    if (!result.first_difference) result.first_difference = std::move(difference);
  }
  result.not_run = recording.ticks.size() - result.ticks;
  result.identical = result.ticks > 0 && result.different_ticks == 0 && (result.not_run == 0 || torn_end);
  return result;
}

}  // namespace osteon::session
