#include "hil/plc/plc_logic.h"

#include <algorithm>
#include <array>
#include <stdexcept>
#include <utility>

namespace osteon::hil {
namespace {

constexpr std::uint16_t Bit(PlcBlock block) { return static_cast<std::uint16_t>(block); }

}  // namespace

std::string DescribeBlocks(std::uint16_t blocks) {
  constexpr std::array<std::pair<PlcBlock, const char*>, 10> kNames{{
      {PlcBlock::kEmergencyStop, "emergency stop"},
      {PlcBlock::kControllerLost, "controller's heartbeat lost"},
      {PlcBlock::kGuardLost, "guard's heartbeat lost"},
      {PlcBlock::kGuardWithdrew, "guard withdrew the request"},
      {PlcBlock::kNoController, "no controller yet"},
      {PlcBlock::kNoGuard, "no guard yet"},
      {PlcBlock::kNoMode, "no mode"},
      {PlcBlock::kNotEnabled, "not enabled"},
      {PlcBlock::kNotRequested, "not requested"},
      {PlcBlock::kNotReset, "not reset"},
  }};
  std::string text;
  for (const auto& [block, name] : kNames)
    if (blocks & Bit(block)) text += (text.empty() ? "" : ", ") + std::string(name);
  return text.empty() ? "none" : text;
}

bool PlcLogic::Heartbeat::UpdateHeartbeat(rt::Nanoseconds now, std::uint16_t heartbeat,
                                          rt::Nanoseconds timeout) {
  if (seen && heartbeat != value) {
    lives = true;
    changed = now;
  }
  seen = true;
  value = heartbeat;
  if (!lives || now - changed <= timeout) return false;
  lives = false;
  return true;
}

PlcLogic::PlcLogic(const PlcLogicParams& params) : params_(params), latched_(Bit(PlcBlock::kNotReset)) {
  for (const auto& [name, time] : {std::pair{"heartbeat_timeout", params.heartbeat_timeout},
                                   {"power_cut_delay", params.power_cut_delay}})
    if (time <= 0)
      throw std::invalid_argument(std::string("simulated PLC: ") + name + ": found " + std::to_string(time) +
                                  " ns, accepted > 0");
  outputs_.blocks = latched_;
}

const PlcLogicOutputs& PlcLogic::Step(rt::Nanoseconds now, const PlcLogicInputs& inputs) {
  now_ = std::max(now_, now);

  // causes of latching blocks in this step
  std::uint16_t latching = 0;
  if (inputs.emergency_stop) latching |= Bit(PlcBlock::kEmergencyStop);
  if (controller_.UpdateHeartbeat(now_, inputs.controller_heartbeat, params_.heartbeat_timeout))
    latching |= Bit(PlcBlock::kControllerLost);
  if (params_.guard && guard_.UpdateHeartbeat(now_, inputs.guard_heartbeat, params_.heartbeat_timeout))
    latching |= Bit(PlcBlock::kGuardLost);
  if (params_.guard && guard_.lives && !inputs.guard_permits) latching |= Bit(PlcBlock::kGuardWithdrew);
  latched_ |= latching;
  const bool guarded = !params_.guard || guard_.lives;

  // a press of the reset button clears those latched blocks whose cause is gone
  if (inputs.reset && !reset_before_) {
    int still_present = latching;
    if (!controller_.lives) still_present |= Bit(PlcBlock::kControllerLost);
    if (!guarded) still_present |= Bit(PlcBlock::kGuardLost);
    latched_ = static_cast<std::uint16_t>(latched_ & still_present);
  }
  reset_before_ = inputs.reset;

  // the enabling switch: after it was squeezed through, it must be released first
  if (inputs.enabling == EnablingSwitch::kSqueezed) must_release_ = true;
  if (inputs.enabling == EnablingSwitch::kReleased) must_release_ = false;
  const bool enabled = inputs.enabling == EnablingSwitch::kMiddle && !must_release_;

  // The request for motion is valid if it is made while nothing is latched. A latching cause or a change of
  // mode cancels it.
  if (latched_ != 0 || inputs.mode != mode_before_ || !inputs.motion_request)
    requested_ = false;
  else if (!request_before_)
    requested_ = true;
  request_before_ = inputs.motion_request;
  mode_before_ = inputs.mode;

  std::uint16_t blocks = latched_;
  if (!controller_.lives && !(latched_ & Bit(PlcBlock::kControllerLost)))
    blocks |= Bit(PlcBlock::kNoController);
  if (!guarded && !(latched_ & Bit(PlcBlock::kGuardLost))) blocks |= Bit(PlcBlock::kNoGuard);
  if (inputs.mode == ModeSelector::kNone) blocks |= Bit(PlcBlock::kNoMode);
  if (!enabled) blocks |= Bit(PlcBlock::kNotEnabled);
  if (!requested_) blocks |= Bit(PlcBlock::kNotRequested);

  outputs_.blocks = blocks;
  outputs_.run_permitted = blocks == 0;
  outputs_.spindle_permitted = outputs_.run_permitted && inputs.foot_pedal;
  outputs_.emergency_stop = (latched_ & Bit(PlcBlock::kEmergencyStop)) != 0;
  if (outputs_.run_permitted) {
    permitted_at_ = now_;
    powered_ = true;
  } else if (now_ - permitted_at_ >= params_.power_cut_delay) {
    powered_ = false;
  }
  outputs_.power_on = powered_;
  ++outputs_.heartbeat;
  return outputs_;
}

}  // namespace osteon::hil
