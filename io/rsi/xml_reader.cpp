#include "io/rsi/xml_reader.h"

namespace osteon::io {
namespace {

constexpr std::string_view kSpace = " \t\r\n";

bool IsSpace(char c) OSTEON_RT { return kSpace.find(c) != std::string_view::npos; }

bool IsNameStart(char c) OSTEON_RT {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_' || c == ':';
}

bool IsNameCharacter(char c) OSTEON_RT {
  return IsNameStart(c) || (c >= '0' && c <= '9') || c == '.' || c == '-';
}

// Characters that XML 1.0 allows; bytes from 0x80 on belong to UTF-8 and matter only in skipped parts.
bool IsText(char c) OSTEON_RT { return static_cast<unsigned char>(c) >= 0x20 || IsSpace(c); }

}  // namespace

XmlReader::Event XmlReader::Error() OSTEON_RT {
  failed_ = true;
  return Event::kError;
}

void XmlReader::SkipSpace() OSTEON_RT {
  while (HasMore() && IsSpace(text_[at_])) ++at_;
}

// If a part that starts with `begin` comes next and its `end` is present, skips it and returns true.
bool XmlReader::Skip(std::string_view begin, std::string_view end) OSTEON_RT {
  if (!Starts(begin)) return false;
  const std::size_t found = text_.find(end, at_ + begin.size());
  if (found == std::string_view::npos) return false;
  at_ = found + end.size();
  return true;
}

// Reads a name into name_. False if the next byte cannot start a name.
bool XmlReader::ReadName() OSTEON_RT {
  if (!HasMore() || !IsNameStart(text_[at_])) return false;
  const std::size_t begin = at_;
  while (HasMore() && IsNameCharacter(text_[at_])) ++at_;
  name_ = text_.substr(begin, at_ - begin);
  return true;
}

XmlReader::Event XmlReader::Next() OSTEON_RT {
  if (failed_) return Event::kError;
  if (closing_) {
    closing_ = false;
    --depth_;
  }
  if (in_tag_) return InTag();

  for (;;) {
    if (depth_ == 0) {  // before or after the root element
      SkipSpace();
      while (had_root_ && HasMore() && (text_[at_] == '\0' || IsSpace(text_[at_]))) ++at_;
      if (!HasMore()) return had_root_ ? Event::kEnd : Error();
      if (!had_root_ && Skip("<?xml", "?>")) continue;
    } else {  // the text up to the next tag, without white space at both ends
      const std::size_t begin = at_;
      while (HasMore() && text_[at_] != '<') {
        if (!IsText(text_[at_])) return Error();
        ++at_;
      }
      if (!HasMore()) return Error();
      value_ = text_.substr(begin, at_ - begin);
      while (!value_.empty() && IsSpace(value_.front())) value_.remove_prefix(1);
      while (!value_.empty() && IsSpace(value_.back())) value_.remove_suffix(1);
      if (!value_.empty()) return Event::kText;
    }
    if (Skip("<!--", "-->")) continue;
    if (text_[at_] != '<') return Error();
    if (Starts("</")) return CloseTag();

    // start of an element
    if ((depth_ == 0 && had_root_) || depth_ == kMaxDepth) return Error();
    ++at_;
    if (!ReadName()) return Error();
    had_root_ = in_tag_ = true;
    open_[depth_++] = name_;
    return Event::kOpen;
  }
}

// Continues inside a start tag: reads its next attribute, or its end.
XmlReader::Event XmlReader::InTag() OSTEON_RT {
  const std::size_t before = at_;
  SkipSpace();
  if (!HasMore()) return Error();
  if (text_[at_] == '>') {
    ++at_;
    in_tag_ = false;
    return Next();
  }
  if (Starts("/>")) {
    at_ += 2;
    in_tag_ = false;
    closing_ = true;
    name_ = open_[depth_ - 1];
    return Event::kClose;
  }
  if (at_ == before || !ReadName()) return Error();  // an attribute must be preceded by white space
  SkipSpace();
  if (!HasMore() || text_[at_] != '=') return Error();
  ++at_;
  SkipSpace();
  if (!HasMore() || (text_[at_] != '"' && text_[at_] != '\'')) return Error();
  const char quote = text_[at_++];
  const std::size_t begin = at_;
  while (HasMore() && text_[at_] != quote) {
    if (text_[at_] == '<' || !IsText(text_[at_])) return Error();
    ++at_;
  }
  if (!HasMore()) return Error();
  value_ = text_.substr(begin, at_ - begin);
  ++at_;
  return Event::kAttribute;
}

// Reads an end tag, which must have the name of the innermost open element.
XmlReader::Event XmlReader::CloseTag() OSTEON_RT {
  if (depth_ == 0) return Error();
  const std::size_t begin = at_;
  at_ += 2;
  if (!ReadName() || name_ != open_[depth_ - 1]) {
    at_ = begin;
    return Error();
  }
  SkipSpace();
  if (!HasMore() || text_[at_] != '>') return Error();
  ++at_;
  closing_ = true;
  return Event::kClose;
}

}  // namespace osteon::io
