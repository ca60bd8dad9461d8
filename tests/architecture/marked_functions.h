#pragma once

#include <set>
#include <string>
#include <string_view>

namespace osteon::architecture {

/// The functions that a C++ text marks OSTEON_RT, by their qualified names without parameters and template
/// arguments: "osteon::control::ServoLoop::Tick". Lambdas have no name and are left out.
/// A reader of this house's style and no C++ parser: preprocessor lines, comments and literals are skipped,
/// namespaces and classes followed by their braces.
std::set<std::string> MarkedFunctions(std::string_view text);

/// The same form of a demangled symbol: without return type, parameters, template arguments and unnamed
/// namespaces. "void osteon::rt::Prefetch<int>(int const&)" becomes "osteon::rt::Prefetch".
std::string QualifiedName(std::string_view demangled);

}  // namespace osteon::architecture
