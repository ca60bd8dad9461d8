#pragma once

#include <cstdint>
#include <memory>
#include <mutex>
#include <string>
#include <utility>

namespace osteon::console {

/// Keeps the newest live message. Pages that need the same windows share it, so that it is made only once.
/// Any thread.
class SharedLive {
 public:
  /// The windows after number `from`, up to and including `to`, in one epoch of the feed.
  struct Span {
    std::uint64_t epoch{0}, from{0}, to{0};
    bool operator==(const Span&) const = default;
  };

  /// Returns the message of these windows. Makes the message unless it is the stored one.
  /// @param make  () → std::string, called without the lock
  template <class Make>
  [[nodiscard]] std::shared_ptr<const std::string> Get(const Span& span, const Make& make) {
    {
      const std::lock_guard lock(mutex_);
      if (text_ && span == span_) return text_;
    }
    auto text = std::make_shared<const std::string>(make());
    const std::lock_guard lock(mutex_);
    span_ = span;
    text_ = text;
    return text;
  }

 private:
  std::mutex mutex_;
  Span span_;
  std::shared_ptr<const std::string> text_;
};

}  // namespace osteon::console
