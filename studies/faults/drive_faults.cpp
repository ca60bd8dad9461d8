#include "studies/faults/drive_faults.h"

#include <functional>
#include <memory>
#include <stdexcept>
#include <utility>

#include "studies/faults/drive_bench.h"

namespace osteon::studies {
namespace {

using safety::CellState;
using safety::Fault;

// Error codes of the drive's EMCY message.
constexpr int kUnderVoltage = 0x3220, kTooHot = 0x4310;
// Time in which the drive is configured and reaches its speed.
constexpr rt::Nanoseconds kRunsBefore = 900 * rt::kMillisecond;
constexpr std::uint16_t kHeartbeat = 0x710;     // CAN identifier of the drive's heartbeat
constexpr std::uint8_t kPreOperational = 0x7F;  // NMT state in a heartbeat

// Ticks from a fault to its detection.
constexpr int kAtOnce = 1;
constexpr int kStatusLost = 46;      // ten cycles of 4 ms, and some ticks
constexpr int kHeartbeatLost = 152;  // three heartbeats of 50 ms, and some ticks
constexpr int kLong = 500;           // ticks for which a fault lasts
constexpr int kAllResets = 2400;     // ticks until every reset was tried; resets are half a second apart

/// Applies the fault to the drive. @param since  ticks since the injection began, from 0
using DriveInjection = std::function<void(DriveBench& bench, int since, bool before_motion)>;

// Injects a fault into the drive of a run, and checks the drive's resets: up to DriveReset::kAttempts are
// allowed before the first motion and in a recovery, none at any other time.
class WatchedDrive {
 public:
  // @param runs_before  true: when the fault begins the drive is configured and at speed, even if the cell
  // still waits
  WatchedDrive(DriveInjection injection, bool runs_before)
      : inject_(std::move(injection)), runs_before_(runs_before) {}

  // Replaces the tick's spindle reading by that of the faulty drive.
  // @throws std::logic_error if the drive was reset when it must not be, or too often
  void operator()(RigInputs& in, int since, FaultRig& rig) {
    const CellState state = rig.loop().state();
    const control::CellCommands commands = rig.loop().cell_commands();
    if (since == 0) {
      before_motion_ = safety::Waits(state);
      const bool runs = runs_before_ || !before_motion_;
      bench_ = std::make_shared<DriveBench>(in.now - FaultRig::kTick - (runs ? kRunsBefore : 0));
      bench_->RunTo(in.now - FaultRig::kTick, commands);
    }
    const bool allowed = state == CellState::kRecovery || (before_motion_ && safety::Waits(state));
    before_motion_ = before_motion_ && !safety::IsMotion(state);
    inject_(*bench_, since, before_motion_);
    const int resets = bench_->device().resets();
    in.readings.spindle = bench_->RunTo(in.now, commands);
    if (bench_->device().resets() > resets && !allowed)
      throw std::logic_error("the drive was reset in mid-run");
    if (bench_->device().resets() > io::DriveReset::kAttempts) throw std::logic_error("it is reset for ever");
  }

 private:
  DriveInjection inject_;
  bool runs_before_;
  bool before_motion_{false};
  std::shared_ptr<DriveBench> bench_;
};

// Expected reactions: before the first motion the drive is reset or configured again, and the cell begins.
// During a run the fault stops the cell, and the drive is not reset until a person starts a recovery.
FaultCase DriveCase(const char* name, const char* injected, int ticks, bool runs_before,
                    DriveInjection injection) {
  safety::FaultSet fault;
  fault.Latch(Fault::kSpindle);
  const Expected stops{.reaction = Reaction::kStops, .faults = fault, .ticks = ticks};
  const Expected brakes_on{.reaction = Reaction::kBrakesOn}, waits{.reaction = Reaction::kWaits};
  return {.name = name,
          .injected = injected,
          .inject = WatchedDrive(std::move(injection), runs_before),
          .lasts = kLong,
          .waiting = {.reaction = Reaction::kGoesOn},
          .aligning = stops,
          .rendering = stops,
          .paused = waits,
          .stop1 = brakes_on,
          .stop2 = ticks == kAtOnce ? stops : brakes_on};
}

// The drive's heartbeat frame with this NMT state.
io::CanFrame HeartbeatOf(std::uint8_t nmt_state) {
  return {.id = kHeartbeat, .size = 1, .data = {nmt_state}};
}

// During a run, interrupts the drive's supply for one tick. Before motion it does nothing: the drive was just
// switched on.
void Boot(DriveBench& bench, int since, bool before_motion) {
  if (before_motion) return;
  if (since == 0) bench.device().SetPower(false);
  if (since == 1) bench.device().SetPower(true);
}

}  // namespace

std::vector<FaultCase> DriveFaultCases() {
  std::vector<FaultCase> cases;
  cases.push_back(DriveCase("drive boots in fault", "0x3220, which a reset clears", kStatusLost, false,
                            [](DriveBench& bench, int since, bool before_motion) {
                              if (since == 0) bench.device().SetBootError(kUnderVoltage);
                              Boot(bench, since, before_motion);
                            }));
  {
    FaultCase made = DriveCase(
        "drive boots in fault and stays in it", "0x4310, whatever is reset", kStatusLost, false,
        [](DriveBench& bench, int since, bool before_motion) {
          if (since == 0) bench.device().InjectFault(kTooHot);
          Boot(bench, since, before_motion);
          if (since == kAllResets && before_motion && bench.device().resets() != io::DriveReset::kAttempts)
            throw std::logic_error("it was not reset as often as it may be");
        });
    made.lasts = kAllResets + 1;
    made.waiting.reaction = Reaction::kWaits;
    cases.push_back(std::move(made));
  }
  cases.push_back(DriveCase("drive's boot-up message", "in mid-run; its status goes on", kAtOnce, true,
                            [](DriveBench& bench, int since, bool) {
                              if (since == 0) bench.Forge(HeartbeatOf(0));
                            }));
  cases.push_back(DriveCase("drive left OPERATIONAL", "its heartbeat says pre-operational", kAtOnce, true,
                            [](DriveBench& bench, int since, bool) {
                              if (since == 0) bench.Forge(HeartbeatOf(kPreOperational));
                            }));
  cases.push_back(DriveCase("drive's EMCY", "0x4310; its status goes on", kAtOnce, true,
                            [](DriveBench& bench, int since, bool) {
                              if (since == 0) bench.device().SendEmergency(kTooHot);
                            }));
  {
    FaultCase made =
        DriveCase("drive's heartbeat lost", "its status goes on", kHeartbeatLost, true,
                  [](DriveBench& bench, int since, bool) {
                    if (since == 0)
                      bench.passes = [](const io::CanFrame& frame) { return frame.id != kHeartbeat; };
                  });
    made.waiting.reaction = Reaction::kWaits;
    cases.push_back(std::move(made));
  }
  return cases;
}

}  // namespace osteon::studies
