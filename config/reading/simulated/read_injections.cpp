#include "config/reading/simulated/read_injections.h"

#include <array>
#include <cmath>
#include <string>

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace osteon::config {
namespace {

using hil::Wire;
using hil::WireFaults;

constexpr double kLongest_s = 86400.0;  // latest begin and end of an injection
constexpr double kLongest_ms = 200.0;   // longest delay and jitter
// An injection needs at least one of these keys.
constexpr std::array kFaults{"loss_ratio", "duplicate_ratio", "reorder_ratio", "corrupt_ratio",
                             "delay_ms",   "jitter_ms",       "silence"};

// Reads a share, 0 if absent.
double ReadShare(Reader& section, const char* key) {
  return section.Has(key) ? section.Number(key, 0, 1) : 0.0;
}

// Reads a key in ms, 0 if absent.
rt::Nanoseconds ReadTime(Reader& section, const char* key) {
  return section.Has(key) ? std::llround(section.Number(key, 0, kLongest_ms) * 1e9) : 0;
}

// Refuses faults that Modbus over TCP cannot have. A TCP stream delivers no packet twice, reordered or
// damaged. An injection acts on both directions of the stream.
void RefuseOnTcp(Reader& section, const hil::Injection& injection) {
  for (const char* key : {"duplicate_ratio", "reorder_ratio", "corrupt_ratio", "burst_count"})
    if (section.Has(key))
      section.Refuse(key,
                     "is nothing that a plc's wire can have, which is TCP; accepted loss_ratio, "
                     "delay_ms, jitter_ms, silence");
  if (injection.direction != hil::Direction::kBoth) section.Refuse("direction", "of wire plc: accepted both");
}

// Reads one entry of `injections`: the wire, its direction, the time from begin to end, and the faults.
hil::Injection ReadInjection(Reader& section) {
  hil::Injection injection;
  injection.wire = std::array{Wire::kArm, Wire::kForceSensor, Wire::kDrive, Wire::kPlc}.at(
      section.Choice("wire", {"arm", "force_sensor", "drive", "plc"}));
  injection.direction =
      std::array{hil::Direction::kToController, hil::Direction::kFromController, hil::Direction::kBoth}.at(
          section.Choice("direction", {"to_controller", "from_controller", "both"}));
  injection.from_s = section.Number("from_s", -1, kLongest_s);
  injection.to_s = section.Number("to_s", -1, kLongest_s);
  WireFaults& faults = injection.faults;
  faults.loss = ReadShare(section, "loss_ratio");
  const bool has_burst = section.Has("burst_count");
  if (has_burst) faults.burst = section.WholeNumber("burst_count", 1, 1000);
  faults.duplicate = ReadShare(section, "duplicate_ratio");
  faults.reorder = ReadShare(section, "reorder_ratio");
  faults.corrupt = ReadShare(section, "corrupt_ratio");
  faults.delay = ReadTime(section, "delay_ms");
  faults.jitter = ReadTime(section, "jitter_ms");
  faults.silence = section.Has("silence") && section.Bool("silence");
  section.Finish();  // report a missing or misspelt key before the errors below

  if (injection.to_s <= injection.from_s)
    section.Refuse("to_s", fmt::format("found {:.10g}, accepted more than from_s ({:.10g})", injection.to_s,
                                       injection.from_s));
  if (has_burst && !section.Has("loss_ratio")) section.Refuse("burst_count", "needs a loss_ratio");
  if (injection.wire == Wire::kPlc) RefuseOnTcp(section, injection);
  if (faults == WireFaults{.burst = faults.burst})
    section.Refuse("wire", fmt::format("an injection of nothing; accepted at least one of {}",
                                       fmt::join(kFaults, ", ")));
  return injection;
}

}  // namespace

hil::InjectionParams ReadInjections(Reader& cell) {
  hil::InjectionParams params;
  if (cell.Has("injection_seed"))
    params.seed = static_cast<std::uint64_t>(cell.WholeNumber("injection_seed", 0, 1'000'000'000));
  if (!cell.Has("injections")) return params;
  for (Reader& section : cell.Sections("injections", 0, 100))
    params.injections.push_back(ReadInjection(section));
  return params;
}

}  // namespace osteon::config
