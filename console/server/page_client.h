#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include <tl/expected.hpp>

namespace osteon::console {

/// A page without a browser: opens a console's WebSocket and takes all that it sends, or stops reading. For
/// measurements.
class PageClient {
 public:
  /// @param reads  false: takes nothing, as a page that hangs
  /// @returns the error says why the console refused.
  [[nodiscard]] static tl::expected<std::unique_ptr<PageClient>, std::string> Open(const std::string& host,
                                                                                   int port, bool reads);
  virtual ~PageClient() = default;
  PageClient(const PageClient&) = delete;
  PageClient& operator=(const PageClient&) = delete;

  [[nodiscard]] virtual std::uint64_t messages() const = 0;
  [[nodiscard]] virtual std::uint64_t bytes() const = 0;

  /// How the carved bone reached the page, from its first whole change on, which is the bone as it was.
  struct Bone {
    std::uint64_t messages{0}, bytes{0};  ///< of its mesh
    std::vector<double> whole_s{};        ///< times at which a change was whole, from the first one on [s]
    std::vector<double> age_ms{};         ///< how old the bone was at each of them
  };
  [[nodiscard]] virtual Bone bone() const = 0;
  /// Time from a tick until its live message was taken here, of each message [ms]: for a cell of this machine
  /// in wall time, whose clock is this one. A browser draws after that.
  [[nodiscard]] virtual std::vector<double> received_ms() const = 0;

 protected:
  PageClient() = default;
};

}  // namespace osteon::console
