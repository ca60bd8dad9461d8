#include "tests/architecture/call_graph.h"

#include <cxxabi.h>

#include <cstdlib>
#include <deque>
#include <fstream>
#include <memory>
#include <regex>
#include <sstream>
#include <stdexcept>

#include "tests/architecture/marked_functions.h"

namespace osteon::architecture {
namespace {

// The symbol in an operand of objdump's output, without "+0x…", "@plt" and a version.
std::string SymbolOf(const std::string& operand) { return operand.substr(0, operand.find_first_of("+@")); }

// The first rule that matches a symbol. For a function of the program only `skip` rules apply, for other
// functions only `allow` rules. Null if no rule matches.
const CallRule* FindRule(const std::vector<CallRule>& rules, const std::string& symbol, bool of_program) {
  static constexpr std::string_view kUnnamed = "(anonymous namespace)::";
  std::string signature = Demangled(symbol);
  for (std::size_t at; (at = signature.find(kUnnamed)) != std::string::npos;)
    signature.erase(at, kUnnamed.size());
  const std::string name = QualifiedName(signature);
  for (const CallRule& rule : rules) {
    if (rule.opaque != of_program) continue;
    const std::string& pattern = rule.pattern;
    const std::string& text = pattern.find('(') == std::string::npos ? name : signature;
    if (pattern.ends_with('*') ? text.starts_with(std::string_view(pattern).substr(0, pattern.size() - 1))
                               : text == pattern)
      return &rule;
  }
  return nullptr;
}

}  // namespace

CallGraph CallGraph::Read(std::istream& disassembly) {
  CallGraph graph;
  std::set<std::string>* callees = nullptr;
  std::set<std::string> external;
  std::string line, name;
  while (std::getline(disassembly, line)) {
    if (line.ends_with(">:")) {
      name = line.substr(line.find('<') + 1);
      name.resize(name.size() - 2);
      // an entry of the procedure linkage table only calls a function of a library
      callees = name.find('@') == std::string::npos ? &graph.functions_[name] : nullptr;
      continue;
    }
    if (!callees || !line.ends_with('>')) continue;
    const std::size_t begin = line.rfind('<') + 1;
    const std::string operand = line.substr(begin, line.size() - 1 - begin), symbol = SymbolOf(operand);
    if (symbol == name) continue;
    // "@@Base" is the version of the program's own symbols. Symbols that begin with "_ZT" are vtables and
    // type information of the standard library, thus data
    if (operand.find('@') != std::string::npos && operand.find("@@Base") == std::string::npos &&
        !symbol.starts_with("_ZT"))
      external.insert(symbol);
    callees->insert(symbol);
  }
  // Remove names that are neither functions of the program nor of a library: they are data.
  for (auto& [function, names] : graph.functions_)
    std::erase_if(names, [&](const std::string& callee) {
      return !external.contains(callee) && !graph.functions_.contains(callee);
    });
  return graph;
}

const std::set<std::string>* CallGraph::Callees(const std::string& function) const {
  const auto found = functions_.find(function);
  return found == functions_.end() ? nullptr : &found->second;
}

std::string Demangled(const std::string& symbol) {
  int status = 0;
  // GCC names parts and copies of a function by the function's symbol, a dot and a suffix
  const std::unique_ptr<char, decltype(&std::free)> text(
      abi::__cxa_demangle(symbol.substr(0, symbol.find('.')).c_str(), nullptr, nullptr, &status), &std::free);
  return status == 0 ? text.get() : symbol;
}

std::vector<CallRule> ReadCallRules(const std::filesystem::path& file) {
  std::ifstream stream(file);
  if (!stream) throw std::runtime_error(file.string() + ": cannot be read");
  static const std::regex form(R"(^\s*(allow|skip)\s+([^|]*[^|\s])\s*\|\s*(\S.*)$)");
  std::vector<CallRule> rules;
  std::string line;
  for (int number = 1; std::getline(stream, line); ++number) {
    if (const auto first = line.find_first_not_of(" \t"); first == std::string::npos || line[first] == '#')
      continue;
    std::smatch match;
    if (!std::regex_match(line, match, form))
      throw std::runtime_error(file.string() + ":" + std::to_string(number) + ": found '" + line +
                               "', accepted 'allow NAME … | why' or 'skip NAME … | why'");
    std::istringstream names(match[2]);
    for (std::string name; names >> name;)
      rules.push_back({.pattern = name, .reason = match[3], .opaque = match[1] == "skip"});
  }
  return rules;
}

CallCheck CheckCalls(const CallGraph& graph, const std::set<std::string>& marked,
                     const std::vector<CallRule>& rules) {
  CallCheck check;
  // for each reached symbol, the function that calls it; empty for a root
  std::map<std::string, std::string> caller_of;
  std::deque<std::string> to_follow;
  for (const auto& [symbol, callees] : graph.functions()) {
    const std::string name = QualifiedName(Demangled(symbol));
    if (!marked.contains(name)) continue;
    check.roots.insert(name);
    caller_of[symbol];
    to_follow.push_back(symbol);
  }
  while (!to_follow.empty()) {
    const std::string symbol = to_follow.front();
    to_follow.pop_front();
    const std::set<std::string>* callees = graph.Callees(symbol);
    if (callees) ++check.reached;
    if (const CallRule* rule = FindRule(rules, symbol, callees != nullptr)) {
      check.used.insert(rule->pattern);
      continue;
    }
    if (!callees) {
      std::string chain = Demangled(symbol);
      for (std::string at = caller_of[symbol]; !at.empty(); at = caller_of[at])
        chain = Demangled(at) + " > " + chain;
      check.forbidden.push_back(std::move(chain));
      continue;
    }
    for (const std::string& callee : *callees)
      if (caller_of.try_emplace(callee, symbol).second) to_follow.push_back(callee);
  }
  return check;
}

}  // namespace osteon::architecture
