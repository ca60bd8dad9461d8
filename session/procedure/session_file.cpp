#include "session/procedure/session_file.h"

#include <cstdint>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <system_error>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "base/fnv1a.h"
#include "base/json_text.h"
#include "base/write_text.h"

namespace osteon::session {
namespace {

using nlohmann::json;

constexpr const char* kSchema = "osteon.session/1";

// A state's or a recording's file lies in the session's folder itself.
void RequireName(const std::string& key, const std::string& name) {
  if (name.empty()) return;
  const std::filesystem::path path(name);
  if (path != path.filename() || name == "." || name == "..")
    throw std::runtime_error(
        fmt::format("{}: found \"{}\", accepted the name of a file in the session's folder", key, name));
}

std::string ReadName(const json& object, const char* key) {
  std::string name = object.at(key).get<std::string>();
  RequireName(key, name);
  return name;
}

json SegmentJson(const SessionSegment& s, const SessionFile& session) {
  return {{"tool_index", s.tool_index},
          {"tool_diameter_mm", session.diameters_mm.at(static_cast<std::size_t>(s.tool_index))},
          {"recording", s.recording},
          {"begin_ns", s.begin},
          {"end_ns", s.end},
          {"begin_state", s.begin_state},
          {"begin_state_hash", s.begin_state_hash},
          {"end_state", s.end_state},
          {"end_state_hash", s.end_state_hash},
          {"guidance_gain", s.guidance_gain}};
}

json PassJson(const SessionPass& p, const SessionFile& session) {
  return {{"number", p.number},
          {"segment", p.segment},
          {"tool_index", p.tool_index},
          {"tool_diameter_mm", session.diameters_mm.at(static_cast<std::size_t>(p.tool_index))},
          {"begin_ns", p.begin},
          {"end_ns", p.end},
          {"cutting_s", p.cutting_s},
          {"removed_mm3", p.removed_mm3},
          {"state", p.state},
          {"state_hash", p.state_hash},
          {"undone", p.undone},
          {"to_go_mm", p.to_go_mm ? json(*p.to_go_mm) : json(nullptr)}};
}

int ReadToolIndex(const json& object, const SessionFile& session) {
  const int index = object.at("tool_index").get<int>();
  if (index < 0 || index >= static_cast<int>(session.diameters_mm.size()))
    throw std::runtime_error(fmt::format("tool_index: found {}, accepted 0 … {}", index,
                                         static_cast<int>(session.diameters_mm.size()) - 1));
  return index;
}

SessionSegment ReadSegment(const json& object, const SessionFile& session) {
  return {.tool_index = ReadToolIndex(object, session),
          .recording = ReadName(object, "recording"),
          .begin = object.at("begin_ns").get<rt::Nanoseconds>(),
          .end = object.at("end_ns").get<rt::Nanoseconds>(),
          .begin_state = ReadName(object, "begin_state"),
          .begin_state_hash = object.at("begin_state_hash").get<std::string>(),
          .end_state = ReadName(object, "end_state"),
          .end_state_hash = object.at("end_state_hash").get<std::string>(),
          .guidance_gain = object.at("guidance_gain").get<double>()};
}

SessionPass ReadPass(const json& object, const SessionFile& session) {
  SessionPass pass{.number = object.at("number").get<int>(),
                   .segment = object.at("segment").get<int>(),
                   .tool_index = ReadToolIndex(object, session),
                   .begin = object.at("begin_ns").get<rt::Nanoseconds>(),
                   .end = object.at("end_ns").get<rt::Nanoseconds>(),
                   .cutting_s = object.at("cutting_s").get<double>(),
                   .removed_mm3 = object.at("removed_mm3").get<double>(),
                   .state = ReadName(object, "state"),
                   .state_hash = object.at("state_hash").get<std::string>(),
                   .undone = object.at("undone").get<bool>()};
  if (const auto to_go = object.find("to_go_mm"); to_go != object.end() && !to_go->is_null())
    pass.to_go_mm = to_go->get<double>();
  if (pass.segment < 0 || pass.segment >= static_cast<int>(session.segments.size()))
    throw std::runtime_error(fmt::format("segment: found {}, accepted 0 … {}", pass.segment,
                                         static_cast<int>(session.segments.size()) - 1));
  if (pass.state.empty()) throw std::runtime_error("state: found none, accepted the file of a carved state");
  return pass;
}

json PoseJson(const PlainPose& plain) {
  const Pose X = plain;
  json rows = json::array();
  for (int row = 0; row < 3; ++row) {
    const auto r = X.matrix().row(row);
    rows.push_back({r[0], r[1], r[2], r[3]});
  }
  return rows;
}

PlainPose ReadPose(const json& rows) {
  Pose X = Pose::Identity();
  for (std::size_t row = 0; row < 3; ++row)
    for (std::size_t column = 0; column < 4; ++column)
      X.matrix()(static_cast<Eigen::Index>(row), static_cast<Eigen::Index>(column)) =
          rows.at(row).at(column).get<double>();
  if (!X.matrix().allFinite() || (X.linear() * X.linear().transpose() - Matrix3::Identity()).norm() > 1e-6)
    throw std::runtime_error("cup_X_GT: accepted three rows of a pose");
  return X;
}

}  // namespace

int SessionFile::PassesLeft() const {
  int left = 0;
  for (const SessionPass& pass : passes) left += pass.undone ? 0 : 1;
  return left;
}

std::string SessionFile::LastState() const {
  for (auto pass = passes.rbegin(); pass != passes.rend(); ++pass)
    if (!pass->undone) return pass->state;
  return {};
}

std::string ToJson(const SessionFile& session) {
  json segments = json::array(), passes = json::array();
  for (const SessionSegment& segment : session.segments) segments.push_back(SegmentJson(segment, session));
  for (const SessionPass& pass : session.passes) passes.push_back(PassJson(pass, session));
  json all{
      {"schema", kSchema},
      {"cell", session.cell},
      {"cell_file", session.cell_file},
      {"plan", session.plan_file},
      {"plan_name", session.plan_name},
      {"checksums",
       {{"plan", session.plan_checksum}, {"cell", session.cell_checksum}, {"bone", session.bone_checksum}}},
      {"scene", session.scene},
      {"mesh", session.mesh_file.empty() ? json(nullptr)
                                         : json{{"file", session.mesh_file}, {"scale", session.mesh_scale}}},
      {"tool", session.tool},
      {"diameters_mm", session.diameters_mm},
      {"tool_change", session.tool_change},
      {"clock", session.clock},
      {"gains",
       {{"law", session.gains.law},
        {"stiffness_N_per_mm", session.gains.stiffness_N_per_mm},
        {"damping_Ns_per_m", session.gains.damping_Ns_per_m},
        {"mass_kg", session.gains.mass_kg},
        {"drag_Ns_per_m", session.gains.drag_Ns_per_m}}},
      {"ended", session.ended},
      {"segments", std::move(segments)},
      {"passes", std::move(passes)},
      {"cup_X_GT", session.cup_X_GT ? PoseJson(*session.cup_X_GT) : json(nullptr)}};
  return base::JsonText(all);
}

tl::expected<SessionFile, std::string> ParseSession(const std::string& text) {
  try {
    const json all = json::parse(text);
    if (const std::string schema = all.at("schema").get<std::string>(); schema != kSchema)
      return tl::make_unexpected(fmt::format("schema: found \"{}\", accepted \"{}\"", schema, kSchema));
    SessionFile session{.cell = all.at("cell").get<std::string>(),
                        .cell_file = all.at("cell_file").get<std::string>(),
                        .plan_file = ReadName(all, "plan"),
                        .plan_name = all.value("plan_name", ""),
                        .plan_checksum = all.at("checksums").at("plan").get<std::string>(),
                        .cell_checksum = all.at("checksums").at("cell").get<std::string>(),
                        .bone_checksum = all.at("checksums").at("bone").get<std::string>(),
                        .scene = all.at("scene").get<std::string>(),
                        .mesh_file = {},
                        .tool = all.at("tool").get<std::string>(),
                        .diameters_mm = all.at("diameters_mm").get<std::vector<double>>(),
                        .tool_change = all.at("tool_change").get<std::string>(),
                        .clock = all.at("clock").get<std::string>(),
                        .gains = {},
                        .ended = all.at("ended").get<bool>(),
                        .segments = {},
                        .passes = {},
                        .cup_X_GT = {}};
    const json& gains = all.at("gains");
    session.gains = {.law = gains.at("law").get<std::string>(),
                     .stiffness_N_per_mm = gains.at("stiffness_N_per_mm").get<double>(),
                     .damping_Ns_per_m = gains.at("damping_Ns_per_m").get<double>(),
                     .mass_kg = gains.at("mass_kg").get<std::array<double, 3>>(),
                     .drag_Ns_per_m = gains.at("drag_Ns_per_m").get<std::array<double, 3>>()};
    if (const auto mesh = all.find("mesh"); mesh != all.end() && !mesh->is_null()) {
      session.mesh_file = mesh->at("file").get<std::string>();
      session.mesh_scale = mesh->at("scale").get<double>();
    }
    for (const json& segment : all.at("segments")) session.segments.push_back(ReadSegment(segment, session));
    for (const json& pass : all.at("passes")) session.passes.push_back(ReadPass(pass, session));
    if (const json& cup = all.at("cup_X_GT"); !cup.is_null()) session.cup_X_GT = ReadPose(cup);
    return session;
  } catch (const std::exception& error) {
    return tl::make_unexpected(std::string(error.what()));
  }
}

tl::expected<void, std::string> WriteSession(const std::filesystem::path& folder,
                                             const SessionFile& session) {
  return base::WriteText(folder / kSessionFileName, ToJson(session));
}

tl::expected<SessionFile, std::string> ReadSession(const std::filesystem::path& folder) {
  const std::filesystem::path path = folder / kSessionFileName;
  std::ifstream stream(path, std::ios::binary);
  if (!stream)
    return tl::make_unexpected(path.string() + ": found no readable file, accepted the folder of a session");
  const std::string text(std::istreambuf_iterator<char>(stream), {});
  auto session = ParseSession(text);
  if (!session) return tl::make_unexpected(path.string() + ": " + session.error());
  return session;
}

std::string TextChecksum(const std::string& text) {
  base::Fnv1a hash;
  hash.Add(text);
  return fmt::format("{:016x}", hash.hash());
}

bool HasBegun(const std::filesystem::path& recording) {
  constexpr std::uintmax_t kMagicBytes = 8;
  std::error_code error;
  const std::uintmax_t size = std::filesystem::file_size(recording, error);
  return !error && size >= kMagicBytes;
}

std::vector<std::string> BegunRecordings(const SessionFile& session, const std::filesystem::path& folder) {
  std::vector<std::string> names;
  for (const SessionSegment& segment : session.segments)
    if ((names.empty() || names.back() != segment.recording) && HasBegun(folder / segment.recording))
      names.push_back(segment.recording);
  return names;
}

}  // namespace osteon::session
