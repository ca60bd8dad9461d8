#pragma once

#include <expat.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

// Small XML documents as trees, read by expat.

namespace osteon::io::test {

/// The file's whole text. @throws std::runtime_error if the file cannot be read.
inline std::string ReadText(const std::filesystem::path& file) {
  std::ifstream in(file);
  if (!in) throw std::runtime_error("cannot be read");
  std::stringstream text;
  text << in.rdbuf();
  return text.str();
}

struct XmlNode {
  std::string name, text;
  std::map<std::string, std::string> attributes;
  std::vector<XmlNode> children;

  /// The first child with this name. @throws std::runtime_error if there is none.
  [[nodiscard]] const XmlNode& At(const std::string& child) const {
    for (const XmlNode& node : children)
      if (node.name == child) return node;
    throw std::runtime_error("<" + name + "> has no <" + child + ">");
  }
  /// The attribute's value. @throws std::runtime_error if there is none.
  [[nodiscard]] const std::string& Of(const std::string& attribute) const {
    const auto found = attributes.find(attribute);
    if (found == attributes.end()) throw std::runtime_error("<" + name + "> has no attribute " + attribute);
    return found->second;
  }
};

/// The root of a document. @throws std::runtime_error if it is not well-formed XML, with the reason.
inline XmlNode ParseXml(std::string_view text) {
  struct Reading {
    XmlNode above;               // parent of the root
    std::vector<XmlNode*> open;  // nodes without their end tag yet, innermost last
  } reading;
  reading.open = {&reading.above};
  XML_Parser parser = XML_ParserCreate(nullptr);
  XML_SetUserData(parser, &reading);
  XML_SetElementHandler(
      parser,
      [](void* data, const XML_Char* name, const XML_Char** attributes) {
        auto& r = *static_cast<Reading*>(data);
        // Only the innermost open node grows, so pointers to the outer ones stay valid.
        XmlNode& node = r.open.back()->children.emplace_back();
        node.name = name;
        for (; *attributes != nullptr; attributes += 2) node.attributes[attributes[0]] = attributes[1];
        r.open.push_back(&node);
      },
      [](void* data, const XML_Char*) { static_cast<Reading*>(data)->open.pop_back(); });
  XML_SetCharacterDataHandler(parser, [](void* data, const XML_Char* content, int size) {
    static_cast<Reading*>(data)->open.back()->text.append(content, static_cast<std::size_t>(size));
  });
  const bool well_formed =
      XML_Parse(parser, text.data(), static_cast<int>(text.size()), XML_TRUE) == XML_STATUS_OK;
  std::string error;
  if (!well_formed)
    error = std::string(XML_ErrorString(XML_GetErrorCode(parser))) + ", line " +
            std::to_string(XML_GetCurrentLineNumber(parser));
  XML_ParserFree(parser);
  if (!well_formed) throw std::runtime_error(error);
  return reading.above.children.front();
}

/// The root of a file. @throws std::runtime_error that names the file.
inline XmlNode ReadXmlTree(const std::filesystem::path& file) {
  try {
    return ParseXml(ReadText(file));
  } catch (const std::runtime_error& error) {
    throw std::runtime_error(file.string() + ": " + error.what());
  }
}

}  // namespace osteon::io::test
