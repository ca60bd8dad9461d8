#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "base/marker.h"

namespace osteon::io {

/// Reads the XML of small messages token by token, in place: no tree, no allocation, one pass.
///
///     <Rob Type="KUKA"><Delay D="0"/><IPOC>7</IPOC></Rob>
///     Open Rob, Attribute Type, Open Delay, Attribute D, Close Delay, Open IPOC, Text 7, Close IPOC, Close
///     Rob, End
///
/// Accepts one element with its content, both kinds of quotes, white space wherever XML allows it, comments,
/// and an XML declaration. Refuses what RSI does not use (DOCTYPE, CDATA, processing instructions, more than
/// kMaxDepth levels) and what is not well-formed; entities are left unchanged. White space and NULs may
/// follow at the end.
class XmlReader {
 public:
  static constexpr std::size_t kMaxDepth = 8;

  enum class Event : std::uint8_t {
    kOpen,       ///< name()
    kAttribute,  ///< name(), value() of an attribute of the element opened last
    kText,       ///< value(), trimmed, never empty
    kClose,      ///< name(); also returned for an element of one tag, <a/>
    kEnd,        ///< the end of a complete message
    kError,      ///< at() gives the place; stays in this state
  };

  /// @param text must outlive the reader
  explicit XmlReader(std::string_view text) OSTEON_RT : text_(text) {}

  [[nodiscard]] Event Next() OSTEON_RT;
  [[nodiscard]] std::string_view name() const OSTEON_RT { return name_; }
  [[nodiscard]] std::string_view value() const OSTEON_RT { return value_; }
  /// Number of open elements: 1 after the root's kOpen, and until its kClose.
  [[nodiscard]] std::size_t depth() const OSTEON_RT { return depth_; }
  /// Offset of the next byte; after kError, of the refused one.
  [[nodiscard]] std::size_t at() const OSTEON_RT { return at_; }

 private:
  [[nodiscard]] bool HasMore() const OSTEON_RT { return at_ < text_.size(); }
  [[nodiscard]] bool Starts(std::string_view word) const OSTEON_RT {
    return text_.substr(at_).starts_with(word);
  }
  void SkipSpace() OSTEON_RT;
  bool Skip(std::string_view begin, std::string_view end) OSTEON_RT;
  bool ReadName() OSTEON_RT;
  Event InTag() OSTEON_RT;
  Event CloseTag() OSTEON_RT;
  Event Error() OSTEON_RT;

  std::string_view text_, name_, value_;
  std::size_t at_{0}, depth_{0};
  std::array<std::string_view, kMaxDepth> open_{};  // names of the open elements
  bool in_tag_{false};                              // between an element's name and its '>'
  bool had_root_{false};                            // only white space, comments and NULs may follow it
  bool closing_{false};  // a kClose was returned: depth_ decreases with the next event
  bool failed_{false};
};

}  // namespace osteon::io
