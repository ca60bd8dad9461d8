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

// Connection of a run and its engine by UDP, on one machine or on two. The engine serves one run at a time:
// after a run's greeting (kHello), it refuses other runs. A lost message is not repeated, because a newer
// pose or model follows. Only the pieces of blocks (block_transfer.h) are requested until the block is
// complete.

namespace osteon::io {

/// Largest size of the token in a greeting [bytes].
inline constexpr std::size_t kMaxToken = 256;
/// After this time without a message from its run, an engine is free for another run.
inline constexpr rt::Nanoseconds kRunSilence = 5 * rt::kSecond;
/// Interval at which a run sends greetings to its engine while it has no command to send.
inline constexpr rt::Nanoseconds kGreetEvery = 100 * rt::kMillisecond;

/// The engine's state with respect to a run, as reported in a welcome message.
enum class EngineProgress : std::uint8_t {
  kTakesSetup,  ///< the run's set-up is being received
  kMakes,       ///< the engine is being made
  kRuns,
  kCarved,   ///< the engine has ended; the carved state can be fetched
  kBusy,     ///< the engine serves another run
  kRefused,  ///< the token is wrong, or the engine could not be made
};

struct UdpEngineParams {
  std::string address;
  std::uint16_t port{0};
  std::string token{};
  rt::Nanoseconds answer_within{3 * rt::kSecond};   ///< longest wait for an answer to the first greeting
  rt::Nanoseconds ready_within{120 * rt::kSecond};  ///< longest wait until the engine is made
};

/// The run's side of the connection. The servo thread calls Load and Store; one other thread receives.
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
  // Sends greetings and the set-up until the engine runs. Returns the error text; empty on success.
  [[nodiscard]] std::string Greet();
  void SendHello();
  void SendBytes(const EngineBytes& bytes) OSTEON_RT;
  void SendCommand(const EngineCommand& command) OSTEON_RT;
  // Waits for one message from the engine. Returns false if none arrived until `deadline`.
  bool Receive(rt::Nanoseconds deadline, EngineHeader& header, std::span<const std::uint8_t>& content);
  [[nodiscard]] static std::optional<Welcome> DecodeWelcome(std::span<const std::uint8_t> content);

  int socket_;
  UdpEngineParams params_;
  std::vector<std::uint8_t> setup_;
  std::uint64_t session_{0};  // 0: no welcome yet
  // numbers of commands, greetings and pieces sent
  std::uint64_t sent_{0}, greeted_{0}, asked_{0};
  std::uint64_t next_frame_{1};  // number of the frame expected next
  rt::Nanoseconds last_stamp_{0}, hello_at_{0};
  EngineBytes command_bytes_;
  std::array<std::uint8_t, kEngineMaxMessage + 1> in_;
  rt::LatestValue<simulation::ContactModel> models_;
  EngineCounters counters_;
  std::string engine_, device_;
};

struct UdpServerParams {
  std::string address{"127.0.0.1"};
  std::uint16_t port{0};  ///< 0: any free port
  std::string token{};    ///< token that a greeting must contain; empty: every greeting is accepted
};

/// The engine's side of the connection.
class UdpEngineServer final : public EngineServer {
 public:
  [[nodiscard]] static tl::expected<std::unique_ptr<UdpEngineServer>, std::string> Open(
      const UdpServerParams& params);
  ~UdpEngineServer() override;
  UdpEngineServer(const UdpEngineServer&) = delete;
  UdpEngineServer& operator=(const UdpEngineServer&) = delete;

  [[nodiscard]] std::uint16_t port() const { return port_; }
  /// Waits for a run's set-up, at most until `deadline`. Returns nothing if no set-up or only a part of it
  /// arrived.
  [[nodiscard]] std::optional<std::vector<std::uint8_t>> AwaitSetup(rt::Nanoseconds deadline);
  /// Tells the run that the engine is running, with its name and device. SetFailed tells why there is no
  /// engine.
  void SetRunning(const std::string& engine, const std::string& device);
  void SetFailed(const std::string& why);

  [[nodiscard]] EngineEvent Await(EngineCommand& command, rt::Nanoseconds deadline) override;
  void Publish(const EngineFrame& frame) override;
  void PutCarved(std::vector<std::uint8_t> bytes) override;
  /// Ends the session with the present run; the server is then free for another run.
  void ResetSession();

  [[nodiscard]] const EngineCounters& counters() const { return counters_; }

 private:
  explicit UdpEngineServer(int socket, std::uint16_t port, std::string token);
  // Kind of a received message. Greetings have already been answered.
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
  std::uint64_t made_{0}, last_command_{0};  // number of frames made; sequence number of the newest command
  std::uint64_t sent_{0};                    // number of messages sent other than frames
  EngineProgress progress_{EngineProgress::kTakesSetup};
  std::optional<BlockReceiver> setup_;
  std::vector<std::uint8_t> carved_;
  std::string engine_, device_, error_;
  EngineBytes frame_bytes_;
  std::array<std::uint8_t, kEngineMaxMessage + 1> in_;
  EngineCounters counters_;
};

}  // namespace osteon::io
