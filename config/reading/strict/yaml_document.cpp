#include "config/reading/strict/yaml_document.h"

#include <charconv>
#include <cmath>
#include <cstdint>
#include <fstream>
#include <sstream>

#include <fmt/format.h>
#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/yaml.h>

#include "base/no_file_text.h"
#include "config/reading/config_file_tracker.h"
#include "config/reading/strict/config_error.h"

namespace osteon::config {
namespace {

constexpr std::uintmax_t kMaxYamlBytes = 1 << 20;  // bytes; the shipped files have a few kB

// Counts the documents that a parser finds, and notes whether any of them has content.
class DocumentCounter final : public YAML::EventHandler {
 public:
  int count{0};
  int line{0};  // first line of the last document
  bool has_content{false};

  void OnDocumentStart(const YAML::Mark& mark) override {
    ++count;
    line = mark.line + 1;
  }
  void OnDocumentEnd() override {}
  void OnNull(const YAML::Mark&, YAML::anchor_t) override {}
  void OnAlias(const YAML::Mark&, YAML::anchor_t) override { has_content = true; }
  void OnScalar(const YAML::Mark&, const std::string&, YAML::anchor_t, const std::string&) override {
    has_content = true;
  }
  void OnSequenceStart(const YAML::Mark&, const std::string&, YAML::anchor_t,
                       YAML::EmitterStyle::value) override {
    has_content = true;
  }
  void OnSequenceEnd() override {}
  void OnMapStart(const YAML::Mark&, const std::string&, YAML::anchor_t, YAML::EmitterStyle::value) override {
    has_content = true;
  }
  void OnMapEnd() override {}
};

// Whether the line is indented by a tab. YAML forbids this, but the parser's errors for it differ.
bool HasTabInIndentation(const std::string& text, int line) {
  std::istringstream lines(text);
  std::string each;
  for (int i = 0; i < line; ++i)
    if (!std::getline(lines, each)) return false;
  return each.substr(0, each.find_first_not_of(" \t")).find('\t') != std::string::npos;
}

// Reads a finite decimal number from a plain scalar, whatever the locale. @returns false for anything else,
// such as a number in quotes or hexadecimal
template <typename T>
bool ParsePlainNumber(const YAML::Node& node, T& value) {
  if (!node.IsScalar() || node.Tag() == "!") return false;
  const std::string& text = node.Scalar();
  const char* end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, value);
  return error == std::errc() && stop == end && std::isfinite(static_cast<double>(value));
}

// Refuses control characters except tab and line ends, which are the only ones in YAML. This also refuses a
// text in UTF-16, in which every other byte may be NUL.
void RequireText(const std::string& text, const std::filesystem::path& name) {
  int line = 1;
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (c == '\n') ++line;
    if ((byte < 0x20 && c != '\n' && c != '\r' && c != '\t') || byte == 0x7f)
      throw ConfigError(name.string(), line,
                        fmt::format("not YAML: found the byte 0x{:02x}, accepted text in UTF-8", byte));
  }
}

}  // namespace

std::string ReadYamlText(const std::filesystem::path& path) {
  if (const std::string wrong = base::NoFileText(path); !wrong.empty())
    throw ConfigError(path.string(), 0, wrong);
  std::error_code error;
  if (const auto bytes = std::filesystem::file_size(path, error); bytes > kMaxYamlBytes)
    throw ConfigError(
        path.string(), 0,
        fmt::format("found {} bytes, accepted at most {}: not a configuration", bytes, kMaxYamlBytes));
  std::ifstream stream(path, std::ios::binary);
  std::ostringstream text;
  text << stream.rdbuf();
  if (!stream) throw ConfigError(path.string(), 0, "can not be read");
  ConfigFileTracker::RecordFile(path);
  return text.str();
}

YAML::Node ParseYamlDocument(const std::string& text, const std::filesystem::path& name) {
  RequireText(text, name);
  try {
    // YAML::LoadAll never returns for a text that begins with an invalid token (", a"), because it does not
    // consume the token. Therefore the documents are counted first, up to the second one.
    std::istringstream stream(text);
    YAML::Parser parser(stream);
    DocumentCounter counter;
    while (counter.count < 2 && parser.HandleNextDocument(counter)) {
    }
    if (counter.count > 1 && !counter.has_content)
      throw ConfigError(name.string(), counter.line, "not YAML: a document can not begin like this");
    if (counter.count != 1)
      throw ConfigError(name.string(), 0, fmt::format("found {} documents, accepted 1", counter.count));
    return YAML::Load(text);
  } catch (const YAML::Exception& error) {
    const int line = error.mark.is_null() ? 0 : error.mark.line + 1;
    if (HasTabInIndentation(text, line))
      throw ConfigError(name.string(), line, "not YAML: found a tab before the text, accepted blanks alone");
    throw ConfigError(name.string(), line, "not YAML: " + error.msg);
  }
}

int LineOf(const YAML::Node& node) { return node.Mark().is_null() ? 0 : node.Mark().line + 1; }

std::string DescribeNode(const YAML::Node& node) {
  if (node.IsMap()) return "a mapping";
  if (node.IsSequence()) return fmt::format("a list of {}", node.size());
  if (node.IsNull()) return "nothing";
  std::string text = node.Scalar().substr(0, 40);
  for (char& c : text)
    if (static_cast<unsigned char>(c) < 0x20) c = ' ';
  return node.Tag() == "!" ? '"' + text + '"' : text;
}

std::string DescribeRange(double min, double max) { return fmt::format("{:.10g} … {:.10g}", min, max); }

bool ParseNumber(const YAML::Node& node, double& value) { return ParsePlainNumber(node, value); }

bool ParseNumber(const YAML::Node& node, int& value) { return ParsePlainNumber(node, value); }

}  // namespace osteon::config
