#include "io/modbus/plc_client.h"

#include <arpa/inet.h>
#include <modbus/modbus.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <stdexcept>

#include "base/number_text.h"
#include "base/realtime_thread.h"

namespace osteon::io {
namespace {

// interval at which a pause checks whether Stop() was called
constexpr rt::Nanoseconds kSlice = 10 * rt::kMillisecond;

// Throws std::invalid_argument unless a parameter is accepted.
void Require(bool accepted, const char* name, double found, const char* range) {
  if (!accepted)
    throw std::invalid_argument(std::string("PLC: ") + name + ": found " + base::NumberText(found) +
                                ", accepted " + range);
}

// Returns the next time of a periodic action that was due at `due`. If the action is late by more than 1 ms,
// the next period begins at `now`: missed times are skipped.
rt::Nanoseconds NextDue(rt::Nanoseconds due, rt::Nanoseconds now, int every_ms) {
  return std::max(due, now - rt::kMillisecond) + every_ms * rt::kMillisecond;
}

}  // namespace

// Owns libmodbus' context; null if memory was not sufficient.
struct PlcClient::Connection {
  explicit Connection(const PlcClientParams& params)
      : context(modbus_new_tcp(params.address.c_str(), params.port)) {
    if (context != nullptr)
      // without a byte timeout, the response timeout applies to the whole answer
      modbus_set_byte_timeout(context, 0, 0);
  }
  ~Connection() {
    if (context == nullptr) return;
    modbus_close(context);
    modbus_free(context);
  }
  Connection(const Connection&) = delete;
  Connection& operator=(const Connection&) = delete;

  // Sets the longest wait for an answer.
  void SetTimeout(int ms) const {
    modbus_set_response_timeout(context, static_cast<std::uint32_t>(ms / 1000),
                                static_cast<std::uint32_t>(ms % 1000) * 1000u);
  }

  modbus_t* context;
};

PlcClient::PlcClient(const PlcClientParams& params) : params_(params) {
  in_addr parsed{};
  if (inet_pton(AF_INET, params.address.c_str(), &parsed) != 1)
    throw std::invalid_argument("PLC: address: found \"" + params.address +
                                "\", accepted a dotted IPv4 address such as 127.0.0.1");
  Require(params.port != 0, "port", params.port, "1 … 65535");
  Require(params.read_every_ms >= 1 && params.read_every_ms <= 100, "read_every_ms", params.read_every_ms,
          "1 … 100");
  Require(params.heartbeat_every_ms >= 1 && params.heartbeat_every_ms <= 100, "heartbeat_every_ms",
          params.heartbeat_every_ms, "1 … 100: what the PLC allows");
  Require(params.response_timeout_ms >= 1 && params.response_timeout_ms <= 1000, "response_timeout_ms",
          params.response_timeout_ms, "1 … 1000");
  Require(params.connect_timeout_ms >= 1 && params.connect_timeout_ms <= 5000, "connect_timeout_ms",
          params.connect_timeout_ms, "1 … 5000");
  Require(params.first_pause_ms >= 1, "first_pause_ms", params.first_pause_ms, ">= 1");
  Require(params.longest_pause_ms >= params.first_pause_ms && params.longest_pause_ms <= 60'000,
          "longest_pause_ms", params.longest_pause_ms, "first_pause_ms … 60000");
  thread_ = std::thread([this] { Run(); });
}

PlcClient::~PlcClient() { Stop(); }

void PlcClient::Stop() {
  stop_.store(true, std::memory_order_relaxed);
  if (thread_.joinable()) thread_.join();
}

void PlcClient::Pause(rt::Nanoseconds until) {
  for (rt::Nanoseconds now = rt::MonotonicNow(); now < until && !stop_.load(std::memory_order_relaxed);
       now = rt::MonotonicNow())
    rt::SleepUntil(std::min(until, now + kSlice));
}

PlcClient::Answer PlcClient::CountFailure(int error) {
  reading_.last_error = error;
  if (error < MODBUS_ENOBASE) {
    if (error == ETIMEDOUT) ++reading_.counters.timeouts;
    return Answer::kNone;
  }
  ++reading_.counters.rejected;  // error numbers from MODBUS_ENOBASE on are defined by libmodbus
  return error >= EMBXILFUN && error <= EMBXGTAR ? Answer::kException : Answer::kNonsense;
}

void PlcClient::PublishDisconnected() {
  if (reading_.link == PlcLink::kConnected) reading_.link = PlcLink::kConnecting;
  Publish();
}

void PlcClient::Run() {
  rt::NameThread("PLC client");
  rt::RaisePriority();
  int pause_ms = params_.first_pause_ms;
  while (!stop_.load(std::memory_order_relaxed)) {
    Connection connection(params_);
    if (Connect(connection)) {
      const bool has_read = ServeConnection(connection);
      ++reading_.counters.lost;
      if (has_read) {
        pause_ms = params_.first_pause_ms;
        // reconnect without a pause, because the last reading is still in use and grows older
        if (reading_.link == PlcLink::kConnected) continue;
      }
    }
    if (stop_.load(std::memory_order_relaxed)) break;
    PublishDisconnected();
    Pause(rt::MonotonicNow() + pause_ms * rt::kMillisecond);
    pause_ms = std::min(2 * pause_ms, params_.longest_pause_ms);
  }
  PublishDisconnected();
}

bool PlcClient::ServeConnection(Connection& connection) {
  // whether an answer ends the connection
  const auto ends_connection = [this](Answer answer) {
    if (answer == Answer::kNonsense)
      PublishDisconnected();  // publish at once, because the last reading must not be used any longer
    return answer == Answer::kNone || answer == Answer::kNonsense;
  };
  bool has_read = false;
  rt::Nanoseconds next_read = rt::MonotonicNow(), next_beat = next_read;
  while (!stop_.load(std::memory_order_relaxed)) {
    const Answer block = ReadBlock(connection);
    has_read |= block == Answer::kWhole;
    const bool ends = ends_connection(block);
    if (block != Answer::kWhole) Publish();
    if (ends) break;
    const rt::Nanoseconds now = rt::MonotonicNow();
    if (now >= next_beat && reading_.link == PlcLink::kConnected) {
      if (ends_connection(WriteHeartbeat(connection))) break;
      next_beat = NextDue(next_beat, now, params_.heartbeat_every_ms);
    }
    next_read = NextDue(next_read, rt::MonotonicNow(), params_.read_every_ms);
    Pause(std::min(next_read, std::max(next_beat, now)));
  }
  return has_read;
}

bool PlcClient::Connect(Connection& connection) {
  int error = ENOMEM;
  if (connection.context != nullptr) {
    connection.SetTimeout(params_.connect_timeout_ms);
    if (modbus_connect(connection.context) == 0) {
      connection.SetTimeout(params_.response_timeout_ms);
      return true;
    }
    error = errno;
  }
  ++reading_.counters.refused;
  reading_.link = PlcLink::kConnecting;
  reading_.last_error = error;
  return false;
}

PlcClient::Answer PlcClient::ReadBlock(Connection& connection) {
  std::array<std::uint16_t, kPlcReadCount> block{};
  const rt::Nanoseconds asked = rt::MonotonicNow();
  if (modbus_read_registers(connection.context, kPlcFirstRead, kPlcReadCount, block.data()) != kPlcReadCount)
    return CountFailure(errno);
  PlcInputs inputs;
  if (const auto bad = DecodePlc(block, inputs)) {
    ++reading_.counters.rejected;
    reading_.bad = *bad;
    reading_.last_error = EMBXILVAL;
    return Answer::kNonsense;
  }
  ++reading_.counters.reads;
  reading_.last_error = 0;
  const bool first = reading_.link != PlcLink::kConnected;
  const bool changed = first || inputs.heartbeat != reading_.inputs.heartbeat;
  // After the switch was squeezed through, it must be released before its middle position enables motion
  // again (IEC 60204-1, 10.9).
  if (reading_.inputs.enabling == PlcEnabling::kSqueezed && inputs.enabling == PlcEnabling::kEnabled)
    inputs.enabling = PlcEnabling::kSqueezed;
  reading_.inputs = inputs;
  reading_.stamp = asked;
  if (inputs.version != kPlcVersion) {
    reading_.link = PlcLink::kWrongVersion;
    return Answer::kNonsense;  // nothing may be written to a PLC of another version; Run() connects again
                               // after a pause
  }
  if (changed) reading_.heartbeat_changed = asked;
  reading_.link = PlcLink::kConnected;
  Publish();
  return Answer::kWhole;
}

PlcClient::Answer PlcClient::WriteHeartbeat(Connection& connection) {
  const std::uint32_t beats = beats_.load(std::memory_order_relaxed);
  // NotifyAlive() was not called: if the loop stops, the heartbeat stops too
  if (beats == beats_written_) return Answer::kWhole;
  const std::array<std::uint16_t, 2> values{
      static_cast<std::uint16_t>(heartbeat_ + 1u),
      static_cast<std::uint16_t>(motion_.load(std::memory_order_relaxed) ? 1 : 0)};
  // the register of MOTION_REQUEST or GUARD_PERMITS follows that of the heartbeat
  const int count = static_cast<int>(values.size());
  const int address = params_.role == PlcRole::kController ? kPlcControllerHeartbeat : kPlcGuardHeartbeat;
  if (modbus_write_registers(connection.context, address, count, values.data()) != count)
    return CountFailure(errno);
  heartbeat_ = values[0];
  beats_written_ = beats;
  ++reading_.counters.writes;
  return Answer::kWhole;
}

namespace {

// Returns why there is no connection; empty if no reason is known. If a connect takes too long, libmodbus
// reports EINPROGRESS.
std::string ReasonOf(const PlcClientParams& params, const PlcReading& reading) {
  if (reading.last_error == EMBXILVAL && reading.bad.address != 0)
    return "register " + std::to_string(reading.bad.address) + ": found " +
           std::to_string(reading.bad.found) + ", accepted 0 … " + std::to_string(reading.bad.accepted_most);
  if (reading.last_error == EINPROGRESS)
    return "nobody answers there (within " + std::to_string(params.connect_timeout_ms) + " ms)";
  if (reading.last_error == ETIMEDOUT)
    return "no answer to a request (within " + std::to_string(params.response_timeout_ms) + " ms)";
  return reading.last_error != 0 ? modbus_strerror(reading.last_error) : "";
}

}  // namespace

std::string Describe(const PlcClientParams& params, const PlcReading& reading) {
  const std::string place = "PLC " + params.address + ":" + std::to_string(params.port) + ": ";
  const PlcCounters& n = reading.counters;
  switch (reading.link) {
    case PlcLink::kConnected:
      return place + "connected, " + std::to_string(n.reads) + " blocks read" +
             (reading.last_error != 0
                  ? std::string("; it answers no more: ") + modbus_strerror(reading.last_error)
                  : "");
    case PlcLink::kWrongVersion:
      return place + "VERSION (977): found " + std::to_string(reading.inputs.version) + ", accepted " +
             std::to_string(kPlcVersion) + "; nothing is written to it";
    case PlcLink::kConnecting:
      break;
  }
  const std::string reason = ReasonOf(params, reading);
  return place + "no connection" + (reason.empty() ? "" : ": " + reason) + " (" + std::to_string(n.refused) +
         " attempts in vain, " + std::to_string(n.timeouts) + " time-outs, " + std::to_string(n.lost) +
         " connections lost)";
}

const char* Describe(PlcVerdict verdict) {
  switch (verdict) {
    case PlcVerdict::kRun:
      return "motion is permitted";
    case PlcVerdict::kNoConnection:
      return "no connection to the PLC: Stop 1";
    case PlcVerdict::kWrongVersion:
      return "the PLC's VERSION (977) is another one: no start";
    case PlcVerdict::kStale:
      return "the PLC's registers are too old: Stop 1";
    case PlcVerdict::kPlcStopped:
      return "the PLC answers, but PLC_HEARTBEAT (983) stands still: Stop 1";
    case PlcVerdict::kEmergencyStop:
      return "EMERGENCY_STOP (978) is 1: Stop 1";
    case PlcVerdict::kNotPermitted:
      return "RUN_PERMITTED (974) is 0: Stop 1";
  }
  return "unknown";
}

}  // namespace osteon::io
