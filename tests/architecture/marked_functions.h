#pragma once

#include <set>
#include <string>
#include <string_view>

namespace osteon::architecture {

/// Finds the functions that a C++ text marks with OSTEON_RT. Returns their qualified names without parameters
/// and template arguments: "osteon::control::ServoLoop::Tick". Lambdas have no name and are left out. The
/// function is no C++ parser and reads only the style of this project: it skips preprocessor lines, comments
/// and literals, and recognises namespaces and classes by their braces.
std::set<std::string> MarkedFunctions(std::string_view text);

/// Brings a demangled symbol to the form of MarkedFunctions: without return type, parameters, template
/// arguments and unnamed namespaces. "void osteon::rt::Prefetch<int>(int const&)" becomes
/// "osteon::rt::Prefetch".
std::string QualifiedName(std::string_view demangled);

}  // namespace osteon::architecture
