#pragma once

#include <filesystem>
#include <istream>
#include <map>
#include <set>
#include <string>
#include <vector>

namespace osteon::architecture {

/// The references between a program's functions: calls, jumps, and addresses that are taken. The target of a
/// call through a pointer is unknown, so each implementation of a virtual function must be checked by its own
/// name.
class CallGraph {
 public:
  /// Reads the output of `objdump -d --no-show-raw-insn PROGRAM`.
  static CallGraph Read(std::istream& disassembly);

  /// The functions to which a function refers, by their names in the symbol table. These are functions of
  /// this program and functions of shared libraries, without "@plt" and version. Null if the program has no
  /// such function.
  [[nodiscard]] const std::set<std::string>* Callees(const std::string& function) const;
  [[nodiscard]] const std::map<std::string, std::set<std::string>>& functions() const { return functions_; }

 private:
  std::map<std::string, std::set<std::string>> functions_;
};

/// A symbol in C++ notation, as in "osteon::rt::MonotonicNow()". A symbol that is not mangled is returned
/// unchanged.
std::string Demangled(const std::string& symbol);

/// A rule about a function: a tick may call it although it is outside the program (`allow`), or it belongs to
/// the program but its calls are not followed (`skip`).
struct CallRule {
  /// a qualified name (QualifiedName) or a signature; a '*' at its end stands for any further characters
  std::string pattern;
  std::string reason;
  bool opaque{false};  ///< "skip": a function of this program whose own calls are not followed
};

/// Reads the lines `allow PATTERN … | why` and `skip PATTERN … | why`; '#' begins a comment.
/// @throws std::runtime_error with file, line and the accepted form if a line has another form.
std::vector<CallRule> ReadCallRules(const std::filesystem::path& file);

/// The result of checking the calls of the marked functions.
struct CallCheck {
  std::vector<std::string> forbidden;  ///< one per callee: "osteon::A::Step() > B::Grow() > malloc"
  /// Marked functions that exist in the program. The compiler has inlined all others.
  std::set<std::string> roots;
  std::set<std::string> used;  ///< patterns of the rules that matched a symbol
  std::size_t reached{0};      ///< number of functions of the program whose calls were followed
};

/// Follows every call from the marked functions (given by qualified names) until a rule applies or a
/// library's function is reached.
CallCheck CheckCalls(const CallGraph& graph, const std::set<std::string>& marked,
                     const std::vector<CallRule>& rules);

}  // namespace osteon::architecture
