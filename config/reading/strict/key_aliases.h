#pragma once

#include <span>
#include <string>
#include <string_view>

namespace YAML {
class Node;
}

// Keys that were renamed. The older name is still accepted, so that existing files of users remain valid.

namespace osteon::config {

/// A renamed key: its older and its current name.
struct KeyAlias {
  std::string_view old_name, name;
};

/// All renamed keys.
[[nodiscard]] std::span<const KeyAlias> KeyAliases();

/// Current name of a key; the key itself if it was not renamed.
[[nodiscard]] std::string CurrentKey(const std::string& key);

/// The name under which a mapping has a key: the current or the older name. Returns `key` itself if the
/// mapping has neither.
[[nodiscard]] std::string WrittenKey(const YAML::Node& mapping, const std::string& key);

/// Removes a key such as "start.arm_angle_deg" from a mapping, under its current or its older name. @returns
/// whether the mapping had the key
bool RemoveKey(YAML::Node mapping, const std::string& key);

}  // namespace osteon::config
