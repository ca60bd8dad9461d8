#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include <tl/expected.hpp>

#include "base/clock.h"
#include "console/server/foxglove_protocol.h"
#include "console/server/surface_reader.h"

namespace osteon::console {

inline constexpr int kFoxglovePort = 8765;             ///< the port that viewers propose by default
inline constexpr std::size_t kMaxFoxgloveViewers = 8;  ///< number of viewers served at the same time

/// A message of a topic.
struct FoxgloveMessage {
  rt::Nanoseconds stamp{0};
  std::string bytes;
};

/// The progress of one subscription: the numbers of the newest data that were sent for it. Only the source
/// reads or changes it.
struct FoxgloveCursor {
  bool begun{false};
  std::uint64_t epoch{0}, window{0}, events{0};
  std::size_t tool{0};
  std::shared_ptr<SurfaceReader> bone{};  ///< created by a source that has a bone; otherwise null
};

/// The source of the messages for viewers. Any number of threads may call it.
class FoxgloveSource {
 public:
  virtual ~FoxgloveSource() = default;
  [[nodiscard]] virtual const std::vector<FoxgloveChannel>& channels() const = 0;
  /// Appends a channel's messages after the cursor, and advances the cursor. The first call appends all
  /// messages that a new viewer needs. For a value that changes all the time, only the newest message is
  /// appended.
  virtual void New(std::size_t channel, FoxgloveCursor& cursor, std::vector<FoxgloveMessage>& out) const = 0;
};

/// The address of a server for viewers, and the name that it gives them.
struct FoxgloveParams {
  std::string name;  ///< name of the cell, which the viewer shows
  /// for any but a loopback address, viewers need a token, which the server makes
  std::string address{"127.0.0.1"};
  int port{kFoxglovePort};  ///< 0: any free one
};

/// Shows a cell to Foxglove, Lichtblick and other viewers of the same protocol. It accepts only
/// subscriptions, so no viewer can act on the cell. A viewer that reads slowly gets fewer messages; the
/// connection to a viewer that reads nothing for some seconds is closed.
class FoxgloveServer {
 public:
  /// @param source  outlives the server
  /// @returns the running server, or an error that names address and port, and what to do
  [[nodiscard]] static tl::expected<std::unique_ptr<FoxgloveServer>, std::string> Start(
      const FoxgloveParams& params, const FoxgloveSource& source);
  /// Closes every viewer and ends all threads.
  virtual ~FoxgloveServer() = default;
  FoxgloveServer(const FoxgloveServer&) = delete;
  FoxgloveServer& operator=(const FoxgloveServer&) = delete;

  /// The address that a person enters in the viewer: "ws://127.0.0.1:8765/", with the token if one is needed.
  [[nodiscard]] virtual std::string url() const = 0;
  [[nodiscard]] virtual int port() const = 0;
  [[nodiscard]] virtual std::size_t viewers() const = 0;

 protected:
  FoxgloveServer() = default;
};

}  // namespace osteon::console
