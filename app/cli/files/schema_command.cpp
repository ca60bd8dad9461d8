#include "app/cli/subcommands.h"

#include <algorithm>
#include <charconv>
#include <filesystem>
#include <fstream>
#include <map>
#include <string>
#include <system_error>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "config/reading/file_kinds.h"
#include "config/reading/named_file.h"
#include "config/reading/strict/key_aliases.h"
#include "config/reading/strict/key_table.h"
#include "config/reading/strict/units.h"
#include "session/process/exit_code.h"

namespace osteon::app {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;
using config::KeyInfo;
using config::KeyTable;
using Type = config::KeyInfo::Type;
using Help = std::map<std::string, std::string>;  // text by a key's path, e.g. "limits.max_force_N"

// Reads the comment behind each key of a shipped file ("key: 1 # comment") into `help`. Editors show this
// help for the key in every file of that kind. A key that already has a help text keeps it.
void ReadHelp(const fs::path& file, Help& help) {
  std::ifstream stream(file);
  std::vector<std::pair<std::size_t, std::string>> enclosing;  // indentation and name of the enclosing keys
  for (std::string line; std::getline(stream, line);) {
    const std::size_t indent = line.find_first_not_of(" -");
    const std::size_t colon = line.find(':');
    if (indent == std::string::npos || line[indent] == '#' || colon == std::string::npos) continue;
    while (!enclosing.empty() && enclosing.back().first >= indent) enclosing.pop_back();
    std::string path;
    for (const auto& [ignored, key] : enclosing) path += key + ".";
    const std::string key = line.substr(indent, colon - indent);
    enclosing.emplace_back(indent, key);
    if (const std::size_t hash = line.find(" # ", colon); hash != std::string::npos)
      help.try_emplace(path + key, line.substr(hash + 3));
  }
}

// Describes the range and unit of a key that takes numbers; empty for any other key.
std::string UnitText(const std::string& key, const KeyInfo& info) {
  if (info.type != Type::kNumber && info.type != Type::kNumbers && info.type != Type::kWhole) return "";
  return fmt::format("{:.10g} … {:.10g}, in the unit at the key's end ({})", info.min, info.max,
                     config::UnitEnding(key));
}

// Returns the values that a key with these words accepts; a word that YAML reads as a number is also accepted
// as that number.
Json AcceptedWords(const std::vector<std::string>& words) {
  Json accepted = Json::array();
  for (const std::string& word : words) {
    accepted.push_back(word);
    double number = 0.0;
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), number);
    if (error == std::errc() && end == word.data() + word.size()) accepted.push_back(number);
  }
  return accepted;
}

Json ObjectSchema(const KeyTable& table, const std::string& path, const Help& help,
                  const fs::path& config_root, bool required);

// Returns the schema of a key's value. @param path  of the enclosing section, e.g. "limits."
// @param required  false in a file that extends another one: every key may then be missing
Json ValueSchema(const KeyTable& table, const std::string& key, const KeyInfo& info, const std::string& path,
                 const Help& help, const fs::path& config_root, bool required) {
  static const KeyTable kNoKeys;
  const auto inner = table.inner.find(key);
  const KeyTable& inner_table = inner == table.inner.end() ? kNoKeys : inner->second;
  Json value = Json::object();
  switch (info.type) {
    case Type::kNumber:
      value = {{"type", "number"}, {"minimum", info.min}, {"maximum", info.max}};
      break;
    case Type::kWhole:
      value = {{"type", "integer"}, {"minimum", info.min}, {"maximum", info.max}};
      break;
    case Type::kNumbers:
      value = {{"type", "array"},
               {"items", {{"type", "number"}, {"minimum", info.min}, {"maximum", info.max}}}};
      if (info.size > 0) value["minItems"] = value["maxItems"] = info.size;
      break;
    case Type::kBool:
      value = {{"type", "boolean"}};
      break;
    case Type::kText:
      // a text: YAML may read "12" or "yes" as another type
      value = {{"type", {"string", "number", "boolean"}}};
      break;
    case Type::kChoice:
      value = {{"enum", AcceptedWords(info.words)}};
      break;
    case Type::kWords:
      value = {{"type", "array"}, {"items", {{"enum", AcceptedWords(info.words)}}}, {"uniqueItems", true}};
      break;
    case Type::kFile:
      value = {{"type", "string"}, {"minLength", 1}};
      if (!info.folder.empty())
        for (const fs::path& file : config::YamlFilesIn(config_root / info.folder))
          value["examples"].push_back(file.stem().string());
      break;
    case Type::kSection:
      value = ObjectSchema(inner_table, path + key + ".", help, config_root, required);
      break;
    case Type::kList:
      // A list replaces that of the extended file as a whole, so each of its items needs all its keys.
      value = {{"type", "array"},
               {"items", ObjectSchema(inner_table, path + key + ".", help, config_root, true)},
               {"minItems", info.min},
               {"maxItems", info.max}};
      break;
    case Type::kAny:
      break;
  }
  std::string text = UnitText(key, info);
  if (const auto found = help.find(path + key); found != help.end())
    text = found->second + (text.empty() ? "" : "; " + text);
  if (!text.empty()) value["description"] = text;
  return value;
}

// Returns the schema that every object with this key fulfils.
Json RequiresKey(const std::string& key) { return {{"required", {key}}}; }

// Returns the schema of a mapping. A key that has an older name may be given under either name.
Json ObjectSchema(const KeyTable& table, const std::string& path, const Help& help,
                  const fs::path& config_root, bool required) {
  Json properties = Json::object(), required_keys = Json::array(), required_by_either_name = Json::array();
  for (const auto& [key, info] : table.keys) {
    properties[key] = ValueSchema(table, key, info, path, help, config_root, required);
    const auto alias = std::ranges::find(config::KeyAliases(), key, &config::KeyAlias::name);
    if (alias != config::KeyAliases().end()) {
      const std::string old_name(alias->old_name);
      properties[old_name] = properties[key];
      properties[old_name]["deprecationMessage"] = "the older name of " + key;
      if (info.required)
        required_by_either_name.push_back({{"oneOf", {RequiresKey(key), RequiresKey(old_name)}}});
    } else if (info.required) {
      required_keys.push_back(key);
    }
  }
  Json object{{"type", "object"}, {"additionalProperties", false}, {"properties", properties}};
  if (!required) return object;
  if (!required_keys.empty()) object["required"] = required_keys;
  if (!required_by_either_name.empty()) object["allOf"] = required_by_either_name;
  // A case: if the key has this value, then further keys are required or unknown.
  for (const config::KeyCase& key_case : table.cases) {
    Json excluded_keys = Json::object();
    for (const std::string& key : key_case.excluded) excluded_keys[key] = false;
    const KeyInfo& deciding_key = table.keys.at(key_case.key);
    Json then = Json::object();
    if (!key_case.required.empty()) then["required"] = key_case.required;
    if (!excluded_keys.empty()) then["properties"] = excluded_keys;
    object["allOf"].push_back(
        {{"if",
          {{"required", {key_case.key}},
           {"properties",
            {{key_case.key,
              {{"enum", deciding_key.type == Type::kChoice ? AcceptedWords({key_case.word})
                                                           : Json{key_case.word}}}}}}}},
         {"then", then}});
  }
  return object;
}

// Returns the schema of a kind of file. If such a file can extend another one, its keys are required only if
// it does not.
Json SchemaOf(const config::FileKind& kind, const fs::path& config_root) {
  const KeyTable table = config::RecordKeys(kind.load);
  Help help;
  if (!kind.folder.empty()) {
    if (kind.folder == "cells") ReadHelp(config_root / "cells" / "demo.yaml", help);
    for (const fs::path& file : config::YamlFilesIn(config_root / kind.folder)) ReadHelp(file, help);
  }
  Json schema{{"$schema", "http://json-schema.org/draft-07/schema#"},
              {"title", "Osteon: " + kind.name},
              {"description", "Made by `osteon schema` from the readers' keys. docs/cell_files.md"}};
  if (!table.keys.contains("extends")) {
    schema.update(ObjectSchema(table, "", help, config_root, true));
    return schema;
  }
  schema.update(ObjectSchema(table, "", help, config_root, false));
  schema["properties"]["remove"] = {{"type", "array"},
                                    {"items", {{"type", "string"}}},
                                    {"description", "keys of the extended file that do not hold here"}};
  schema["if"] = {{"not", {{"required", {"extends"}}}}};
  schema["then"] = {{"$ref", "#/definitions/whole"}};
  Json whole = ObjectSchema(table, "", {}, config_root, true);
  schema["definitions"]["whole"] = whole;
  return schema;
}

class SchemaCommand final : public Subcommand {
 public:
  explicit SchemaCommand(CLI::App& app);
  [[nodiscard]] int Run(const Invocation& invocation) override;

 private:
  std::filesystem::path out_{"schemas"};
};

SchemaCommand::SchemaCommand(CLI::App& app)
    : Subcommand(app.add_subcommand("schema", "JSON Schema of every kind of YAML file, for editors")) {
  sub_->add_option("--out", out_, "folder for cell.json, robot.json, …")
      ->type_name("FOLDER")
      ->capture_default_str();
  sub_->footer(
      "Editors with yaml-language-server complete and check a file that begins with\n"
      "  # yaml-language-server: $schema=PATH/cell.json\n\nExamples:\n  osteon schema --out schemas");
}

int SchemaCommand::Run(const Invocation& invocation) {
  std::error_code error;
  fs::create_directories(out_, error);
  for (const config::FileKind& kind : config::FileKinds()) {
    const fs::path file = out_ / (kind.name + ".json");
    std::ofstream stream(file, std::ios::binary);
    stream << SchemaOf(kind, invocation.config_root).dump(1) << "\n";
    stream.close();
    if (!stream) return session::Fail("schema", fmt::format("{}: cannot write it", file.string()));
    fmt::print("{}\n", file.string());
  }
  return 0;
}

}  // namespace

void AddSchemaCommand(CLI::App& app, Subcommands& all) {
  all.push_back(std::make_unique<SchemaCommand>(app));
}

}  // namespace osteon::app
