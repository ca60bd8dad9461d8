#pragma once

#include <atomic>
#include <cstdint>
#include <deque>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "hil/plc/modbus_server.h"
#include "hil/plc/panel.h"
#include "hil/plc/plc_logic.h"

namespace osteon::hil {

struct PlcServerParams {
  std::string bind_address{"127.0.0.1"};  ///< IPv4 address in dotted notation
  std::uint16_t port{1502};               ///< 0: any free port
  int cycle_ms{10};                       ///< cycle of the PLC program, 1 … 100
  PlcLogicParams logic{};
};

struct PlcServerCounters {
  std::uint64_t requests{0}, connections{0};
  std::uint64_t refused{0};  ///< connections beyond the maximum number
  std::uint64_t broken{0};   ///< connections closed because the received bytes were not Modbus TCP
  std::uint64_t dropped{0};  ///< connections closed by DropConnections()
  std::uint64_t delayed{0};  ///< answers that DelayAnswers() delayed
};

/// The simulated PLC in wall time: PlcLogic, its panel, and a Modbus TCP server for a few connections, all in
/// one thread. The register map is that of io/modbus/register_map.h, written independently.
class PlcServer {
 public:
  /// Starts at once. @throws std::system_error if the port is not available, std::invalid_argument on a
  /// parameter out of range.
  explicit PlcServer(const PlcServerParams& params);
  ~PlcServer();
  PlcServer(const PlcServer&) = delete;
  PlcServer& operator=(const PlcServer&) = delete;

  // These functions may be called by any thread.
  void SetPanel(const PlcPanel& panel);
  /// Fault: connections stay open, but the server does not answer. False ends the fault.
  void SetHung(bool hung) { hung_.store(hung, std::memory_order_relaxed); }
  /// Fault: the PLC program does not run, but the server answers.
  void StopProgram(bool stopped) { program_stopped_.store(stopped, std::memory_order_relaxed); }
  /// Fault: closes all present connections.
  void DropConnections() { drop_.store(true, std::memory_order_relaxed); }
  /// Fault: delays the answers to all further requests by this time, >= 0; their order is kept. The reads and
  /// writes themselves take effect without delay.
  void DelayAnswers(rt::Nanoseconds delay) { delay_.store(delay, std::memory_order_relaxed); }
  /// Fault: delays the next answer only, by this time, >= 0.
  void DelayNextAnswer(rt::Nanoseconds delay) { delay_once_.store(delay, std::memory_order_relaxed); }
  /// Fault: refuses the next `requests` requests as "busy" (exception 6); the connection stays open.
  void RefuseAsBusy(int requests) { busy_.store(requests, std::memory_order_relaxed); }
  [[nodiscard]] PlcLogicOutputs outputs() const;
  [[nodiscard]] PlcServerCounters counters() const;
  [[nodiscard]] std::uint16_t port() const { return port_; }

  /// Ends the thread and closes all sockets. May be called twice.
  void Stop();

 private:
  struct Answer {
    rt::Nanoseconds due;
    std::vector<std::uint8_t> bytes;
  };
  struct Client {
    int socket;
    std::vector<std::uint8_t> received;
    std::deque<Answer> answers;  ///< answers still to be sent, oldest first
  };

  void Run();          // the server's thread
  void StepProgram();  // one cycle of PlcLogic with the panel and the written registers
  void Accept();       // accepts or refuses a new connection
  bool Serve(Client& client);
  static bool SendDue(Client& client, rt::Nanoseconds now);
  void SendDueAnswers();
  // Returns the time of the next cycle, or of the earliest due answer if that is earlier.
  [[nodiscard]] rt::Nanoseconds NextWake(rt::Nanoseconds cycle_due) const;

  PlcServerParams params_;
  int listener_{-1};
  std::uint16_t port_{0};
  PlcLogic logic_;
  std::vector<Client> clients_;
  std::uint16_t controller_heartbeat_{0}, motion_request_{0}, guard_heartbeat_{0},
      guard_permits_{0};  // values last written by controller and guard
  PlcPanel shown_;        // panel in the program's last step
  ModbusRegisters registers_;
  mutable std::mutex mutex_;  // guards panel_, outputs_ and counters_
  PlcPanel panel_;
  PlcLogicOutputs outputs_;
  PlcServerCounters counters_;
  /// Delay of each answer, and of the next answer only.
  std::atomic<rt::Nanoseconds> delay_{0}, delay_once_{0};
  std::atomic<int> busy_{0};  ///< number of requests that are still to be refused
  std::atomic<bool> hung_{false}, program_stopped_{false}, drop_{false}, stop_{false};
  std::thread thread_;
};

}  // namespace osteon::hil
