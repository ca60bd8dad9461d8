#pragma once

#include <netinet/in.h>

#include <atomic>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <tl/expected.hpp>

#include "base/latest_value.h"
#include "io/engine/block_transfer.h"
#include "io/engine/engine_ports.h"

// A run and its engine on two machines, or on one, over UDP. The engine serves one run at a time: from that
// run's greeting on, nobody else is heard. A lost message is not sent again: a newer pose or model follows.
// Only blocks (block_transfer.h) are requested until they are complete.

namespace osteon::io {

/// The longest token that a greeting may carry.
inline constexpr std::size_t kMaxToken = 256;
/// After this long without a message from its run, an engine is free for the next run.
inline constexpr rt::Nanoseconds kRunSilence = 5 * rt::kSecond;
/// Interval at which a run greets its engine while it has no command to send.
inline constexpr rt::Nanoseconds kGreetEvery = 100 * rt::kMillisecond;

/// The state of an engine toward a run, as its welcome tells it.
enum class EngineProgress : std::uint8_t {
  kTakesSetup,  ///< the run's set-up is being received
  kMakes,       ///< the engine is being made
  kRuns,
  kCarved,   ///< ended: the carved state can be fetched
  kBusy,     ///< serves another run
  kRefused,  ///< the token is wrong, or the engine could not be made
};

struct UdpEngineParams {
  std::string address;
  std::uint16_t port{0};
  std::string token{};
  rt::Nanoseconds answer_within{3 * rt::kSecond};   ///< longest wait for an answer to the first greeting
  rt::Nanoseconds ready_within{120 * rt::kSecond};  ///< longest wait until the engine is made
};

/// The run's side. The servo thread calls Load and Store; one other thread receives.
class UdpEngineClient final : public EngineClient {
 public:
  /// Greets the engine's process, sends the set-up, and waits until the engine is made. The error says what
  /// to do.
  [[nodiscard]] static tl::expected<std::unique_ptr<UdpEngineClient>, std::string> Connect(
      const UdpEngineParams& params, std::span<const std::uint8_t> setup);
  ~UdpEngineClient() override;
  UdpEngineClient(const UdpEngineClient&) = delete;
  UdpEngineClient& operator=(const UdpEngineClient&) = delete;

  [[nodiscard]] const simulation::ContactModel& Load() OSTEON_RT override { return models_.Load(); }
  void Store(const simulation::ToolCommand& command) OSTEON_RT override;
  [[nodiscard]] bool AwaitFrame(EngineFrame& frame, rt::Nanoseconds deadline) override;
  void Send(const EngineCommand& command) override;
  [[nodiscard]] tl::expected<std::vector<std::uint8_t>, std::string> FetchCarved(
      rt::Nanoseconds deadline) override;
  [[nodiscard]] EngineCounters counters() const override { return counters_; }
  [[nodiscard]] const std::string& engine() const override { return engine_; }
  [[nodiscard]] const std::string& device() const override { return device_; }

 private:
  UdpEngineClient(int socket, const UdpEngineParams& params, std::span<const std::uint8_t> setup);
  // The engine's answer to a greeting.
  struct Welcome {
    EngineProgress progress{EngineProgress::kRefused};
    std::uint64_t carved_bytes{0};
    std::string engine, device, error;
  };
  // Greets until the engine runs, sending it the set-up. Returns an empty string, or the error.
  [[nodiscard]] std::string Greet();
  void SendHello();
  void SendBytes(const EngineBytes& bytes) OSTEON_RT;
  void SendCommand(const EngineCommand& command) OSTEON_RT;
  // Waits for one message of the engine. False if none came.
  bool Receive(rt::Nanoseconds deadline, EngineHeader& header, std::span<const std::uint8_t>& content);
  [[nodiscard]] static std::optional<Welcome> DecodeWelcome(std::span<const std::uint8_t> content);

  int socket_;
  UdpEngineParams params_;
  std::vector<std::uint8_t> setup_;
  std::uint64_t session_{0};                       // 0: no welcome yet
  std::uint64_t sent_{0}, greeted_{0}, asked_{0};  // commands, greetings and pieces sent
  std::uint64_t next_frame_{1};                    // number of the frame expected next
  rt::Nanoseconds last_stamp_{0}, hello_at_{0};
  EngineBytes command_bytes_;
  std::array<std::uint8_t, kEngineMaxMessage + 1> in_;
  rt::LatestValue<simulation::ContactModel> models_;
  EngineCounters counters_;
  std::string engine_, device_;
};

struct UdpServerParams {
  std::string address{"127.0.0.1"};
  std::uint16_t port{0};  ///< 0: any free one
  std::string token{};    ///< that a greeting must carry; empty: any greeting is accepted
};

/// The engine's side.
class UdpEngineServer final : public EngineServer {
 public:
  [[nodiscard]] static tl::expected<std::unique_ptr<UdpEngineServer>, std::string> Open(
      const UdpServerParams& params);
  ~UdpEngineServer() override;
  UdpEngineServer(const UdpEngineServer&) = delete;
  UdpEngineServer& operator=(const UdpEngineServer&) = delete;

  [[nodiscard]] std::uint16_t port() const { return port_; }
  /// Waits for a run's set-up, at most until `deadline`; nothing if none came, or only part of it.
  [[nodiscard]] std::optional<std::vector<std::uint8_t>> AwaitSetup(rt::Nanoseconds deadline);
  /// Tells the run that the engine is made, with its name and device; or (SetFailed) why there is none.
  void SetRunning(const std::string& engine, const std::string& device);
  void SetFailed(const std::string& why);

  [[nodiscard]] EngineEvent Await(EngineCommand& command, rt::Nanoseconds deadline) override;
  void Publish(const EngineFrame& frame) override;
  void PutCarved(std::vector<std::uint8_t> bytes) override;
  /// Ends the session with the present run, and is free for the next.
  void ResetSession();

  [[nodiscard]] const EngineCounters& counters() const { return counters_; }

 private:
  explicit UdpEngineServer(int socket, std::uint16_t port, std::string token);
  // Kind of a message received; a greeting is already answered.
  enum class Heard : std::uint8_t { kNothing, kHello, kCommand, kWant, kPiece, kEnd, kGoodbye };
  Heard Receive(rt::Nanoseconds deadline, EngineHeader& header, std::span<const std::uint8_t>& content);
  // Whether the sender is the present run.
  [[nodiscard]] bool IsPeer(const sockaddr_in& sender) const;
  // Checks a greeting, begins a session if none is open, and answers with a welcome.
  void AnswerHello(std::span<const std::uint8_t> content, const sockaddr_in& sender);
  void SendWelcome(const sockaddr_in& to, EngineProgress progress, std::uint64_t session);
  void SendBytes(const EngineBytes& bytes, const sockaddr_in& to);

  int socket_;
  std::uint16_t port_;
  std::string token_;
  std::optional<sockaddr_in> peer_;
  rt::Nanoseconds heard_{0};                 // time of the run's last message
  std::uint64_t session_{0};                 // 0: no run
  std::uint64_t made_{0}, last_command_{0};  // frames made; number of the newest command
  std::uint64_t sent_{0};                    // messages sent other than frames
  EngineProgress progress_{EngineProgress::kTakesSetup};
  std::optional<BlockReceiver> setup_;
  std::vector<std::uint8_t> carved_;
  std::string engine_, device_, error_;
  EngineBytes frame_bytes_;
  std::array<std::uint8_t, kEngineMaxMessage + 1> in_;
  EngineCounters counters_;
};

}  // namespace osteon::io
