#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include <tl/expected.hpp>

namespace osteon::console {

/// A substitute for a console's page without a browser, for measurements. Opens the WebSocket and reads every
/// message, or reads none.
class PageClient {
 public:
  /// @param reads  false: reads nothing, like a page that hangs The error says why the console refused.
  [[nodiscard]] static tl::expected<std::unique_ptr<PageClient>, std::string> Open(const std::string& host,
                                                                                   int port, bool reads);
  virtual ~PageClient() = default;
  PageClient(const PageClient&) = delete;
  PageClient& operator=(const PageClient&) = delete;

  [[nodiscard]] virtual std::uint64_t messages() const = 0;  ///< number of messages received
  [[nodiscard]] virtual std::uint64_t bytes() const = 0;     ///< number of bytes received

  /// How the carved bone reached the page. A change is a set of bricks of one time, in one message or
  /// several; the first change is the whole bone as it was when the page opened.
  struct Bone {
    std::uint64_t messages{0}, bytes{0};  ///< messages and bytes of the mesh after the first change
    std::vector<double> whole_s{};  ///< times at which a change was complete, relative to the first one [s]
    std::vector<double> age_ms{};   ///< age of the bone at each of these times
  };
  [[nodiscard]] virtual Bone bone() const = 0;
  /// For each live message, the time from its newest tick until the message was read here [ms]. Valid only
  /// for a cell that runs on this machine in wall time, because its stamps are then of the same clock. The
  /// time that a browser needs for drawing is not included.
  [[nodiscard]] virtual std::vector<double> received_ms() const = 0;

 protected:
  PageClient() = default;
};

}  // namespace osteon::console
