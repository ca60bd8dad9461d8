#pragma once

#include <filesystem>
#include <istream>
#include <map>
#include <set>
#include <string>
#include <vector>

namespace osteon::architecture {

/// The references between a program's functions: calls, jumps and addresses taken. A call through a pointer
/// has no target here: each implementation of a virtual function has to be checked by its own name.
class CallGraph {
 public:
  /// Reads the output of `objdump -d --no-show-raw-insn PROGRAM`.
  static CallGraph Read(std::istream& disassembly);

  /// The functions that a function refers to, by the symbol table's names: functions of this program, and
  /// those of shared libraries without "@plt" or a version. Null if the program has no such function.
  [[nodiscard]] const std::set<std::string>* Callees(const std::string& function) const;
  [[nodiscard]] const std::map<std::string, std::set<std::string>>& functions() const { return functions_; }

 private:
  std::map<std::string, std::set<std::string>> functions_;
};

/// A symbol in C++ notation: "osteon::rt::MonotonicNow()". Other symbols are returned unchanged.
std::string Demangled(const std::string& symbol);

/// A function outside the program that a tick may call, or one of the program whose calls are not followed.
struct CallRule {
  std::string pattern;  ///< a qualified name (QualifiedName) or a signature, or its beginning and a '*'
  std::string reason;
  bool opaque{false};  ///< "skip": a function of this program whose own calls are not followed
};

/// Reads the lines `allow PATTERN … | why` and `skip PATTERN … | why`; '#' begins a comment.
/// @throws std::runtime_error with file, line and the accepted form if a line has another form.
std::vector<CallRule> ReadCallRules(const std::filesystem::path& file);

/// The result for the marked functions.
struct CallCheck {
  std::vector<std::string> forbidden;  ///< one per callee: "osteon::A::Step() > B::Grow() > malloc"
  /// Marked functions that exist in the program; the others are inlined.
  std::set<std::string> roots;
  std::set<std::string> used;  ///< patterns of rules that matched
  std::size_t reached{0};      ///< functions of the program that were followed
};

/// Follows every call from the marked functions (qualified names) up to a rule or a function of a library.
CallCheck CheckCalls(const CallGraph& graph, const std::set<std::string>& marked,
                     const std::vector<CallRule>& rules);

}  // namespace osteon::architecture
