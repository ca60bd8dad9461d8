#pragma once

#include <string>
#include <string_view>
#include <vector>

#include <tl/expected.hpp>

#include "simulation/packing/packing_file.h"

// The two text sections of a packing file: UTF-8, lines "key=value" in a fixed order, each ended by a line
// feed. In values a backslash is written \\ and a line feed \n; no other control character may occur.

namespace osteon::simulation {

/// An error in a text: place, what was found, what is accepted.
struct TextError {
  std::size_t byte{0};
  std::string where, found, accepted;
};

struct NamedProvenance {
  std::string name;  ///< the bone's name
  PackingProvenance provenance;
};

/// Converts materials to the text of the section "materials"; MaterialsFromText converts back.
/// @returns an error if a value is not UTF-8, contains a control character or is out of range.
[[nodiscard]] tl::expected<std::string, TextError> MaterialsToText(const std::vector<Material>& materials);
[[nodiscard]] tl::expected<std::vector<Material>, TextError> MaterialsFromText(std::string_view text);

/// Converts a provenance to the text of the section "provenance", and back. @returns an error as
/// MaterialsToText
[[nodiscard]] tl::expected<std::string, TextError> ProvenanceToText(const NamedProvenance& value);
[[nodiscard]] tl::expected<NamedProvenance, TextError> ProvenanceFromText(std::string_view text);

}  // namespace osteon::simulation
