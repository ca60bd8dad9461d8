#include "app/cli/subcommands.h"

#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <system_error>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "app/cli/usage/cell_file.h"
#include "base/json_text.h"
#include "base/write_text.h"
#include "config/reading/load.h"
#include "session/process/exit_code.h"

namespace osteon::app {
namespace {

namespace fs = std::filesystem;

// Returns the text of a cell file that extends `from` (a name or a path). It has the keys that nearly every
// user changes, with the values of `cell`; further keys are comments. @param schema  path of the JSON schema
std::string ExtendingCellText(const config::CellConfig& cell, const std::string& from,
                              const std::string& schema) {
  const Vector3 base_mm = 1e3 * cell.X_WB.translation(), bone_mm = 1e3 * cell.X_WG.translation();
  return fmt::format(
      "# yaml-language-server: $schema={8}\n"
      "# What is not here is as in {0}. Every key: docs/cell_files.md, config/cells/demo.yaml.\n"
      "extends: {0}\n"
      "base_in_world:                  # where the arm stands; W is your own frame, +z up\n"
      "  position_mm: [{1:g}, {2:g}, {3:g}]\n"
      "bone_in_world:                  # the site: origin at the cup's centre or the entry, +z out of the "
      "bone\n"
      "  position_mm: [{4:g}, {5:g}, {6:g}]\n"
      "limits:\n"
      "  max_force_N: {7:g}              # of the coupling; keep script: push_force_N below it\n"
      "# tool: reamer                  # a name under tools/, or a YAML file\n"
      "# tool_diameter_mm: 54\n"
      "# bone:                         # a mesh instead of the scene's bone; the numbers are those of one "
      "mesh\n"
      "#   mesh: hip.obj\n"
      "#   cup: {{center_mm: [8.8, -131.9, 517.9], outward_axis: [-0.983, -0.175, 0.052], radius_mm: 21}}\n"
      "# A real cell's wires (docs/set_up.md):\n"
      "# fri: {{host: 192.170.10.10, arm_host: 192.170.10.2}}   # this PC's card; the arm\n"
      "# can: [{{name: tool, interface: can0}}]\n"
      "# plc: {{host: 192.168.1.20, port: 502}}\n",
      from, base_mm.x(), base_mm.y(), base_mm.z(), bone_mm.x(), bone_mm.y(), bone_mm.z(),
      cell.servo.wrench.max_force_N, schema);
}

// Returns the text of a cell file, with `schema` in place of the path of its JSON schema.
std::string CopyWithSchema(const fs::path& file, const std::string& schema) {
  std::ifstream stream(file, std::ios::binary);
  std::string text(std::istreambuf_iterator<char>(stream), {});
  const std::string head = "# yaml-language-server: $schema=";
  if (text.starts_with(head)) text.replace(0, text.find('\n'), head + schema);
  return text;
}

class NewCellCommand final : public Subcommand {
 public:
  explicit NewCellCommand(CLI::App& app);
  [[nodiscard]] int Run(const Invocation& invocation) override;

 private:
  std::string name_, from_{"demo"};
  std::filesystem::path json_;
};

NewCellCommand::NewCellCommand(CLI::App& app)
    : Subcommand(app.add_subcommand("new-cell", "writes a short cell of your own to begin with")) {
  sub_->add_option("name", name_, "the file, NAME.yaml; anywhere, with folders if you like")
      ->type_name("FILE")
      ->required();
  sub_->add_option("--from", from_, "a name under cells/, or a YAML file")
      ->type_name("CELL")
      ->capture_default_str();
  sub_->add_option("--json", json_, "also write the file's path there, as JSON")->type_name("FILE");
  sub_->footer(
      "The file extends the other cell, or is a copy of it where that one extends another itself.\n\n"
      "Examples:\n  osteon new-cell my_cell\n  osteon new-cell ~/lab/tooth --from molar");
}

int NewCellCommand::Run(const Invocation& invocation) {
  const auto refuse = [](const std::string& what) { return session::Fail("new-cell", what); };
  const fs::path file(name_.ends_with(".yaml") ? name_ : name_ + ".yaml");
  std::error_code error;
  if (fs::exists(file, error))
    return refuse(fmt::format("found {}, accepted a name that no file has yet", file.string()));
  const auto from = FindCell(invocation.config_root, from_);
  if (!from) return refuse("--from " + from.error());
  const config::CellConfig cell = config::LoadCell(*from);  // main shows a ConfigError
  if (file.has_parent_path()) fs::create_directories(file.parent_path(), error);

  const bool from_extends = !config::Reader::LoadExtending(*from, "cells").Extended().empty();
  const bool is_shipped =
      fs::equivalent(fs::absolute(*from).parent_path(), invocation.config_root / "cells", error);
  const std::string from_name =
      is_shipped ? from->stem().string() : fs::absolute(*from).lexically_normal().string();
  const std::string schema =
      fs::absolute(invocation.config_root / "schemas" / "cell.json").lexically_normal().string();
  std::ofstream stream(file, std::ios::binary);
  stream << (from_extends ? CopyWithSchema(*from, schema) : ExtendingCellText(cell, from_name, schema));
  stream.close();
  if (!stream) return refuse(file.string() + ": cannot write it");
  try {
    static_cast<void>(config::LoadCell(file));
  } catch (const config::ConfigError& wrong) {
    // A copied file may have relative paths, which start from its own folder: in the new folder they may name
    // no file.
    fs::remove(file, error);
    return refuse(fmt::format("{}: it names files beside it, accepted names or whole paths", wrong.what()));
  }
  fmt::print("{}\n", file.string());
  if (json_.empty()) return 0;
  const nlohmann::ordered_json json{{"schema", "osteon.new_cell/1"},
                                    {"file", file.string()},
                                    {"from", from_name},
                                    {"copied", from_extends}};
  const auto written = base::WriteText(json_, base::JsonText(json));
  return written ? 0 : refuse(written.error());
}

}  // namespace

void AddNewCellCommand(CLI::App& app, Subcommands& all) {
  all.push_back(std::make_unique<NewCellCommand>(app));
}

}  // namespace osteon::app
