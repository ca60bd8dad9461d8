#include "session/procedure/procedure_tools.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "base/json_text.h"
#include "config/reading/load.h"
#include "session/procedure/plan_guidance.h"
#include "simulation/removal/cut_metrics.h"

namespace osteon::session {
namespace {

// Name of the file that holds the ToolList in a recording's configuration.
constexpr const char* kListFile = "procedure_tools.json";

}  // namespace

std::vector<simulation::Tool> ToolsOf(std::span<const ProcedureTool> tools) {
  std::vector<simulation::Tool> only;
  for (const ProcedureTool& tool : tools) only.push_back(tool.tool);
  return only;
}

std::vector<ProcedureTool> LoadProcedureTools(const config::CellConfig& base,
                                              const std::filesystem::path& cell_yaml,
                                              const std::filesystem::path& tool_file,
                                              const std::filesystem::path& gains, const ToolList& list) {
  std::vector<ProcedureTool> tools;
  for (const double diameter_mm : list.diameters_mm) {
    config::CellConfig cell = config::LoadCell(
        cell_yaml, config::ToolChoice{.file = tool_file, .diameter_m = 1e-3 * diameter_mm}, gains);
    tools.push_back({.diameter_m = 1e-3 * diameter_mm,
                     .tool = std::move(cell.tool.tool),
                     .loop = {.X_FT = cell.tool.X_FT,
                              .sensor = list.physical ? cell.servo.sensor : base.servo.sensor,
                              .arm_body = list.physical ? cell.servo.arm_body : std::nullopt,
                              .bending = cell.servo.compliance.tool}});
  }
  for (std::size_t i = 0; i < list.guidance.size(); ++i) tools.at(i).loop.guidance = list.guidance[i];
  return tools;
}

void PrepareForTools(const std::vector<ProcedureTool>& tools, config::CellConfig& cell) {
  double& radius_m = cell.servo.stabilisers.age_governor.tool_radius_m;
  for (const ProcedureTool& tool : tools)
    if (const simulation::ToolBall* head = simulation::CuttingHead(tool.tool))
      radius_m = std::max(radius_m, head->radius_m);
}

void SetTools(const std::vector<ProcedureTool>& tools, int first, control::ServoLoop& loop) {
  std::vector<control::LoopTool> table;
  for (const ProcedureTool& tool : tools) table.push_back(tool.loop);
  loop.SetTools(std::move(table), first);
}

void KeepToolList(const ToolList& list, io::ConfigSource& source) {
  nlohmann::json json{
      {"diameters_mm", list.diameters_mm}, {"first", list.first}, {"physical", list.physical}};
  for (const control::GuidanceParams& guidance : list.guidance) json["guidance"].push_back(ToJson(guidance));
  source.files.push_back({.name = kListFile, .content = base::JsonText(json)});
}

tl::expected<std::optional<ToolList>, std::string> FindToolList(const io::ConfigSource& source) {
  const auto file = std::find_if(source.files.begin(), source.files.end(),
                                 [](const io::ConfigFile& f) { return f.name == kListFile; });
  if (file == source.files.end()) return std::optional<ToolList>();
  const auto refuse = [](const std::string& why) {
    return tl::make_unexpected(fmt::format("{}: {}", kListFile, why));
  };
  try {
    const auto json = nlohmann::json::parse(file->content);
    ToolList list{.diameters_mm = json.at("diameters_mm").get<std::vector<double>>(),
                  .first = json.at("first").get<int>(),
                  .physical = json.at("physical").get<bool>()};
    const int count = static_cast<int>(list.diameters_mm.size());
    if (count < 1 || count > control::kMaxLoopTools)
      return refuse(fmt::format("diameters_mm: found {}, accepted 1 … {}", count, control::kMaxLoopTools));
    if (list.first < 0 || list.first >= count)
      return refuse(fmt::format("first: found {}, accepted 0 … {}", list.first, count - 1));
    for (const double d : list.diameters_mm)
      if (!std::isfinite(d)) return refuse("diameters_mm: accepted numbers");
    for (const auto& guidance : json.value("guidance", nlohmann::json::array()))
      list.guidance.push_back(GuidanceFromJson(guidance));
    if (!list.guidance.empty() && list.guidance.size() != list.diameters_mm.size())
      return refuse(fmt::format("guidance: found {}, accepted one for each of {} tools", list.guidance.size(),
                                list.diameters_mm.size()));
    return list;
  } catch (const std::exception& error) {
    return refuse(error.what());
  }
}

}  // namespace osteon::session
