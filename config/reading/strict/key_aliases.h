#pragma once

#include <span>
#include <string>
#include <string_view>

namespace YAML {
class Node;
}

// Keys that were renamed. A file with the older name is still read, because a key is a contract.

namespace osteon::config {

/// A renamed key: its older name and today's.
struct KeyAlias {
  std::string_view old_name, name;
};

/// Every older name with today's.
[[nodiscard]] std::span<const KeyAlias> KeyAliases();

/// Today's name of a key; the key itself if it was not renamed.
[[nodiscard]] std::string CurrentKey(const std::string& key);

/// The name under which a mapping has a key: today's or its older one; `key` itself if the mapping has
/// neither.
[[nodiscard]] std::string WrittenKey(const YAML::Node& mapping, const std::string& key);

/// Removes the key "start.arm_angle_deg" of a mapping, by today's name or its older one. @returns whether it
/// was there
bool RemoveKey(YAML::Node mapping, const std::string& key);

}  // namespace osteon::config
