#include "session/setup/recorded_config.h"

#include <algorithm>
#include <fstream>
#include <iterator>

#include <fmt/format.h>

#include "base/work_folder.h"
#include "kinematics/lbr_arm.h"
#include "kinematics/ortho_parallel_arm.h"

namespace osteon::session {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMaxFiles = 1000;  // a recording with more is refused

// The deepest folder that contains all files.
fs::path CommonFolder(const std::vector<config::ConfigFileTracker::File>& files) {
  fs::path common;
  for (const auto& file : files) {
    const fs::path folder = file.path.parent_path();
    if (common.empty()) common = folder;
    const auto [end, ignored] = std::mismatch(common.begin(), common.end(), folder.begin(), folder.end());
    fs::path shared;
    for (auto part = common.begin(); part != end; ++part) shared /= *part;
    common = shared;
  }
  return common;
}

// Whether a name that is appended to a folder's path stays inside this folder: it is no absolute path and has
// no "..".
bool StaysInside(const std::string& name) {
  const fs::path path(name);
  return !name.empty() && name.find('\0') == std::string::npos && path.is_relative() &&
         path == path.lexically_normal() && path.has_filename() && *path.begin() != "..";
}

// Writes the files into the folder. @returns what is wrong; empty: nothing
std::string WriteFiles(const io::ConfigSource& source, const fs::path& folder) {
  if (source.files.size() > kMaxFiles)
    return fmt::format("found {} configuration files, accepted up to {}", source.files.size(), kMaxFiles);
  for (const io::ConfigFile& file : source.files) {
    if (!StaysInside(file.name))
      return fmt::format("configuration file \"{}\": accepted a name below its folder",
                         file.name.substr(0, 80));
    const fs::path path = folder / file.name;
    std::error_code error;
    fs::create_directories(path.parent_path(), error);
    std::ofstream stream(path, std::ios::binary);
    stream.write(file.content.data(), static_cast<std::streamsize>(file.content.size()));
    stream.close();
    if (error || !stream) return path.string() + ": cannot write";
  }
  return {};
}

// Removes the temporary folder's path from a text, so that the text shows the files by their own names.
std::string WithoutFolder(std::string text, const fs::path& folder) {
  const std::string prefix = folder.string() + '/';
  for (std::size_t at = 0; (at = text.find(prefix, at)) != std::string::npos;) text.erase(at, prefix.size());
  return text;
}

}  // namespace

tl::expected<io::ConfigSource, std::string> KeepConfig(const config::ConfigFileTracker& scope,
                                                       const fs::path& cell_yaml,
                                                       const std::optional<config::ToolChoice>& tool,
                                                       const fs::path& gains, const fs::path& identified) {
  const fs::path folder = CommonFolder(scope.files());
  const auto name_of = [&](const fs::path& path) {
    return fs::absolute(path).lexically_normal().lexically_relative(folder).generic_string();
  };
  io::ConfigSource source;
  for (const auto& file : scope.files()) {
    std::ifstream stream(file.path, std::ios::binary);
    std::string content(std::istreambuf_iterator<char>(stream), {});
    if (!stream) return tl::make_unexpected(file.path.string() + ": cannot read it again for the recording");
    source.files.push_back({.name = name_of(file.path), .content = std::move(content)});
    if (file.by_whole_path) source.folder = folder.string();
  }
  source.cell_file = name_of(cell_yaml);
  if (tool) {
    source.tool_file = name_of(tool->file);
    source.tool_diameter_m = tool->diameter_m;
  }
  if (!gains.empty()) source.gains_file = name_of(gains);
  if (!identified.empty()) source.identified_file = name_of(identified);
  return source;
}

namespace {

// Writes a recording's files into a temporary folder and loads the cell from them. Calls
// use_files(cell file, gains file or empty, cell) before the folder is removed.
template <class UseFiles>
tl::expected<config::CellConfig, std::string> LoadFromFiles(const io::ConfigSource& source,
                                                            const UseFiles& use_files) {
  if (source.files.empty())
    return tl::make_unexpected(
        std::string("found no configuration files in the recording, accepted one that has them (it is older "
                    "than replay)"));
  const auto leads_out = [](const std::string& name) { return !name.empty() && !StaysInside(name); };
  if (source.cell_file.empty() || leads_out(source.cell_file) || leads_out(source.tool_file) ||
      leads_out(source.gains_file) || leads_out(source.identified_file))
    return tl::make_unexpected(std::string(
        "the cell's, the tool's, the gains' or the identified file has a name that leads elsewhere"));
  const base::WorkFolder folder("replay");
  if (folder.path().empty())
    return tl::make_unexpected(fs::temp_directory_path().string() + ": cannot make a temporary folder");
  if (std::string wrong = WriteFiles(source, folder.path()); !wrong.empty())
    return tl::make_unexpected(WithoutFolder(std::move(wrong), folder.path()));

  const config::ConfigFileTracker scope({.root = folder.path(), .once_at = source.folder});
  std::optional<config::ToolChoice> tool;
  if (!source.tool_file.empty())
    tool = {.file = folder.path() / source.tool_file, .diameter_m = source.tool_diameter_m};
  const fs::path gains = source.gains_file.empty() ? fs::path() : folder.path() / source.gains_file;
  const fs::path identified =
      source.identified_file.empty() ? fs::path() : folder.path() / source.identified_file;
  try {
    config::CellConfig cell = config::LoadCell(folder.path() / source.cell_file, tool, gains, identified);
    use_files(folder.path() / source.cell_file, gains, cell);
    return cell;
  } catch (const std::exception& error) {
    return tl::make_unexpected("the recorded configuration: " + WithoutFolder(error.what(), folder.path()));
  }
}

}  // namespace

tl::expected<config::CellConfig, std::string> LoadRecordedCell(const io::ConfigSource& source) {
  return LoadFromFiles(source, [](const fs::path&, const fs::path&, const config::CellConfig&) {});
}

tl::expected<RecordedCell, std::string> LoadRecordedTools(const io::ConfigSource& source) {
  const auto list = FindToolList(source);
  if (!list) return tl::make_unexpected(list.error());
  RecordedCell recorded;
  if (*list) recorded.list = **list;
  auto cell = LoadFromFiles(
      source, [&](const fs::path& cell_yaml, const fs::path& gains, const config::CellConfig& base) {
        if (*list) recorded.tools = LoadProcedureTools(base, cell_yaml, base.tool_file, gains, recorded.list);
      });
  if (!cell) return tl::make_unexpected(cell.error());
  recorded.config = std::move(*cell);
  PrepareForTools(recorded.tools, recorded.config);
  return recorded;
}

control::ServoLoop MakeServoLoop(const config::CellConfig& cell) {
  if (const config::SixAxisConfig* arm = cell.robot.six_axis())
    return {cell.servo, kinematics::OrthoParallelArm(arm->params), cell.X_WB, cell.tool.X_FT};
  return {cell.servo, kinematics::LbrArm(cell.robot.lbr()->params), cell.X_WB, cell.tool.X_FT,
          cell.start.arm_angle_rad};
}

}  // namespace osteon::session
