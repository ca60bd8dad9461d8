#pragma once

#include <filesystem>
#include <string>

namespace YAML {
class Node;
}

// Reads a YAML file as one document, and describes places in it for errors.

namespace osteon::config {

/// Reads a file and notes that it was read (ConfigFileTracker).
/// @throws ConfigError if it is missing, larger than 1 MiB or unreadable.
[[nodiscard]] std::string ReadYamlText(const std::filesystem::path& path);

/// Parses a text. @param name  of the file, for errors
/// @throws ConfigError if the text is not YAML or not one document.
[[nodiscard]] YAML::Node ParseYamlDocument(const std::string& text, const std::filesystem::path& name);

/// The line of a node, counted from 1; 0 if the node has none.
[[nodiscard]] int LineOf(const YAML::Node& node);

/// The user's input, shortened for an error.
[[nodiscard]] std::string DescribeNode(const YAML::Node& node);

/// The accepted range of a number, for an error.
[[nodiscard]] std::string DescribeRange(double min, double max);

/// Reads a finite number from a plain scalar: "25" in quotes is a text. @returns whether the node is one
[[nodiscard]] bool ParseNumber(const YAML::Node& node, double& value);
[[nodiscard]] bool ParseNumber(const YAML::Node& node, int& value);

}  // namespace osteon::config
