#include "tests/architecture/marked_functions.h"

#include <algorithm>
#include <cctype>
#include <regex>
#include <vector>

namespace osteon::architecture {
namespace {

bool IsNamePart(char c) { return std::isalnum(static_cast<unsigned char>(c)) || c == '_'; }

// Returns the index behind the literal that begins at index `i`.
std::size_t EndOfLiteral(std::string_view text, std::size_t i) {
  if (text[i] == '"' && i > 0 && text[i - 1] == 'R') {
    const std::string close = ")" + std::string(text.substr(i + 1, text.find('(', i) - i - 1)) + "\"";
    return text.find(close, i) + close.size();
  }
  const char quote = text[i++];
  for (; i < text.size() && text[i] != quote; ++i) i += text[i] == '\\' ? 1 : 0;
  return i + 1;
}

// Removes comments, literals and preprocessor lines.
std::string CodeOnly(std::string_view text) {
  std::string out;
  bool line_begins = true;
  for (std::size_t i = 0; i < text.size();) {
    const std::string_view rest = text.substr(i);
    if (rest.starts_with("//")) {
      i = std::min(text.find('\n', i), text.size());
    } else if (rest.starts_with("/*")) {
      i = std::min(text.find("*/", i), text.size() - 2) + 2;
    } else if (line_begins && rest.starts_with('#')) {
      do i = std::min(text.find('\n', i + 1), text.size());
      while (i < text.size() && text[i - 1] == '\\');
    } else if (rest[0] == '"' || (rest[0] == '\'' && (i == 0 || !IsNamePart(text[i - 1])))) {
      i = EndOfLiteral(text, i);  // a ' within a number only separates digits and begins no literal
      out += '0';
    } else {
      line_begins = rest[0] == '\n' || (line_begins && std::isspace(static_cast<unsigned char>(rest[0])));
      out += text[i++];
    }
  }
  return out;
}

std::string Trimmed(std::string text) {
  const auto first = text.find_first_not_of(" \t\n"), last = text.find_last_not_of(" \t\n");
  return first == std::string::npos ? "" : text.substr(first, last - first + 1);
}

// Removes template arguments. The characters < and > in an operator's name stay.
std::string WithoutTemplateArguments(std::string_view name) {
  static constexpr std::string_view kOperator = "operator";
  std::string out;
  int depth = 0;
  for (std::size_t i = 0; i < name.size(); ++i) {
    if (depth == 0 && name.substr(i).starts_with(kOperator) && (i == 0 || !IsNamePart(name[i - 1]))) {
      out += kOperator;
      for (i += kOperator.size(); i < name.size() && std::ispunct(static_cast<unsigned char>(name[i])) &&
                                  (name[i] != '(' || name.substr(i).starts_with("()("));)
        out += name[i++];
      --i;
      continue;
    }
    if (name[i] == '<') ++depth;
    if (depth == 0) out += name[i];
    if (name[i] == '>') --depth;
  }
  return out;
}

// The name of the function that a declaration declares. `head` is the declaration's text before OSTEON_RT.
// Empty if there is no name.
std::string DeclaredName(std::string head) {
  head = Trimmed(std::move(head));
  for (const std::string_view qualifier : {"const", "&"})
    if (head.ends_with(qualifier)) head = Trimmed(head.substr(0, head.size() - qualifier.size()));
  if (!head.ends_with(')')) return {};
  int depth = 0;
  std::size_t at = head.size();
  do {
    --at;
    depth += head[at] == ')' ? 1 : head[at] == '(' ? -1 : 0;
  } while (depth > 0 && at > 0);
  const std::string before = WithoutTemplateArguments(Trimmed(head.substr(0, at)));
  static const std::regex name(R"(((\w+::)*~?(operator\s*[^\w\s]+|\w+))$)");
  std::smatch match;
  return std::regex_search(before, match, name) ? match[1].str() : std::string();
}

// The name of the namespace or class that a brace opens; empty if the brace opens another scope.
std::string ScopeName(const std::string& head) {
  static const std::regex space(R"(namespace\s+([\w:]+)\s*$)");
  static const std::regex type(
      R"((class|struct|union)\s+(?:\[\[[^\]]*\]\]\s*)?(?:alignas\s*\([^)]*\)\s*)?(\w+)(?:<[^{]*>)?\s*(final\s*)?(:[^:][^{]*)?$)");
  std::smatch match;
  if (std::regex_search(head, match, space)) return match[1];
  if (std::regex_search(head, match, type)) return match[2];
  return {};
}

}  // namespace

std::set<std::string> MarkedFunctions(std::string_view text) {
  static constexpr std::string_view kMark = "OSTEON_RT";
  const std::string code = CodeOnly(text);
  std::set<std::string> names;
  std::vector<std::string> scopes;
  std::string head;  // text of the current statement so far
  int parentheses = 0;
  for (std::size_t i = 0; i < code.size(); ++i) {
    const char c = code[i];
    if (code.compare(i, kMark.size(), kMark) == 0 && (i == 0 || !IsNamePart(code[i - 1])) &&
        !IsNamePart(code[i + kMark.size()])) {
      if (const std::string name = DeclaredName(head); !name.empty()) {
        std::string qualified;
        for (const std::string& scope : scopes)
          if (!scope.empty()) qualified += scope + "::";
        names.insert(qualified + name);
      }
      i += kMark.size() - 1;
      continue;
    }
    parentheses += c == '(' ? 1 : c == ')' ? -1 : 0;
    if (parentheses == 0 && (c == '{' || c == '}' || c == ';')) {
      if (c == '{') scopes.push_back(ScopeName(head));
      if (c == '}' && !scopes.empty()) scopes.pop_back();
      head.clear();
    } else {
      head += c;
    }
  }
  return names;
}

std::string QualifiedName(std::string_view demangled) {
  static const std::regex unnamed(R"(\(anonymous namespace\)::|\[abi:\w+\])");
  const std::string plain = WithoutTemplateArguments(std::regex_replace(std::string(demangled), unnamed, ""));
  static const std::regex call(R"((\S*operator\s*(?:\(\)|[^\w\s(]+)|\S*?[\w~]+)\s*\()");
  // The first parenthesis begins the parameters. The last space before the name ends the return type.
  std::smatch match;
  return std::regex_search(plain, match, call) ? match[1].str() : plain;
}

}  // namespace osteon::architecture
