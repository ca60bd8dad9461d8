#pragma once

#include <filesystem>
#include <istream>
#include <map>
#include <set>
#include <string>
#include <vector>

namespace osteon::architecture {

/// Which function of a program names which others: by calls, jumps and addresses taken. A call through a
/// pointer names nobody: of a virtual function each implementation has to be looked at by its own name.
class CallGraph {
 public:
  /// Reads what `objdump -d --no-show-raw-insn PROGRAM` writes.
  static CallGraph Read(std::istream& disassembly);

  /// The names, as the symbol table has them, that a function refers to: functions of this program, and those
  /// of shared libraries without "@plt" or a version. Null where the program has no such function.
  [[nodiscard]] const std::set<std::string>* Callees(const std::string& function) const;
  [[nodiscard]] const std::map<std::string, std::set<std::string>>& functions() const { return functions_; }

 private:
  std::map<std::string, std::set<std::string>> functions_;
};

/// A symbol as C++ writes it: "osteon::rt::MonotonicNow()". Others stay as they are.
std::string Demangled(const std::string& symbol);

/// What may be called in a tick though it is no function of ours, or is not looked into.
struct CallRule {
  std::string pattern;  ///< a qualified name (QualifiedName) or a signature, or its beginning and a '*'
  std::string reason;
  bool opaque{false};  ///< "skip": a function of this program whose own calls are not looked at
};

/// The lines `allow PATTERN … | why` and `skip PATTERN … | why`; '#' begins a comment.
/// @throws std::runtime_error naming file, line and what is accepted, where a line is not of that form.
std::vector<CallRule> ReadCallRules(const std::filesystem::path& file);

/// What the marked functions come to.
struct CallCheck {
  std::vector<std::string> forbidden;  ///< one a callee: "osteon::A::Step() > B::Grow() > malloc"
  std::set<std::string> roots;         ///< marked functions that the program has as such; the rest is inlined
  std::set<std::string> used;          ///< patterns of rules that something matched
  std::size_t reached{0};              ///< functions of the program that were looked into
};

/// Follows every call from the marked functions (qualified names) to the program's edge.
CallCheck CheckCalls(const CallGraph& graph, const std::set<std::string>& marked,
                     const std::vector<CallRule>& rules);

}  // namespace osteon::architecture
