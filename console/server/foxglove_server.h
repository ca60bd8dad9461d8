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

inline constexpr int kFoxglovePort = 8765;             ///< that viewers propose
inline constexpr std::size_t kMaxFoxgloveViewers = 8;  ///< that are served at a time

/// A message of a topic.
struct FoxgloveMessage {
  rt::Nanoseconds stamp{0};
  std::string bytes;
};

/// How far a subscription is: numbers of what it got last. For the source alone.
struct FoxgloveCursor {
  bool begun{false};
  std::uint64_t epoch{0}, window{0}, events{0};
  std::size_t tool{0};
  std::shared_ptr<SurfaceReader> bone{};  ///< made by the source that has a bone
};

/// What viewers are shown. Any number of threads.
class FoxgloveSource {
 public:
  virtual ~FoxgloveSource() = default;
  [[nodiscard]] virtual const std::vector<FoxgloveChannel>& channels() const = 0;
  /// Appends a channel's messages since the cursor, which moves on. The first time: all that a viewer needs
  /// to begin with. Of what changes all the time the newest alone.
  virtual void New(std::size_t channel, FoxgloveCursor& cursor, std::vector<FoxgloveMessage>& out) const = 0;
};

struct FoxgloveParams {
  std::string name;                  ///< of the cell, shown by the viewer
  std::string address{"127.0.0.1"};  ///< any but the loopback's needs a token, which the server makes
  int port{kFoxglovePort};           ///< 0: any free one
};

/// Shows a cell to Foxglove, Lichtblick and other viewers of the same protocol. It takes nothing but
/// subscriptions, so no viewer can do anything to the cell. A viewer that reads slowly gets fewer messages;
/// one that reads nothing for some seconds is closed.
class FoxgloveServer {
 public:
  /// @param source  outlives the server
  /// @returns the error names address and port, and what to do.
  [[nodiscard]] static tl::expected<std::unique_ptr<FoxgloveServer>, std::string> Start(
      const FoxgloveParams& params, const FoxgloveSource& source);
  /// Closes every viewer and ends all threads.
  virtual ~FoxgloveServer() = default;
  FoxgloveServer(const FoxgloveServer&) = delete;
  FoxgloveServer& operator=(const FoxgloveServer&) = delete;

  /// What a person enters in the viewer: "ws://127.0.0.1:8765/", with the token where one is needed.
  [[nodiscard]] virtual std::string url() const = 0;
  [[nodiscard]] virtual int port() const = 0;
  [[nodiscard]] virtual std::size_t viewers() const = 0;

 protected:
  FoxgloveServer() = default;
};

}  // namespace osteon::console
