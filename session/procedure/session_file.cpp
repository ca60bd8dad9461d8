#include "session/procedure/session_file.h"

#include <algorithm>
#include <charconv>
#include <cstdint>
#include <fstream>
#include <stdexcept>
#include <system_error>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "base/fnv1a.h"
#include "base/json_text.h"
#include "base/read_text.h"
#include "base/write_text.h"

namespace osteon::session {
namespace {

using nlohmann::json;

// Largest magnitudes that are accepted from a file.
constexpr std::int64_t kMaxStamp = std::int64_t{1} << 62;
constexpr double kMaxFigure = 1e9, kMaxToGo_mm = 1e4, kMaxDiameter_mm = 500.0;

// Checks that a state's or a recording's name is a plain file name: these files lie in the session's folder.
void RequireName(const std::string& key, const std::string& name) {
  if (name.empty()) return;
  const std::filesystem::path path(name);
  if (path != path.filename() || name == "." || name == ".." || name.find('\0') != std::string::npos)
    throw std::runtime_error(
        fmt::format("{}: found \"{}\", accepted the name of a file in the session's folder", key, name));
}

// Throws the error for a key that is refused. @param found the refused value; null: the key is missing
[[noreturn]] void Refuse(const char* key, const json* found, const std::string& accepted) {
  constexpr std::size_t kShown = 60;  // number of characters of the value in the message
  throw std::runtime_error(fmt::format(
      "{}: found {}, accepted {}", key,
      found ? found->dump(-1, ' ', false, json::error_handler_t::replace).substr(0, kShown) : "none",
      accepted));
}

// The following functions return the value of a key. If the key is missing, or its value is of another kind
// or beyond the bounds, they throw an error that names the key, what was found and what is accepted.
const json& At(const json& object, const char* key, const char* accepted) {
  if (!object.is_object()) Refuse(key, nullptr, accepted);
  const auto at = object.find(key);
  if (at == object.end()) Refuse(key, nullptr, accepted);
  return *at;
}

std::string ReadText(const json& object, const char* key) {
  const json& value = At(object, key, "a text");
  if (!value.is_string()) Refuse(key, &value, "a text");
  return value.get<std::string>();
}

bool ReadBool(const json& object, const char* key) {
  const json& value = At(object, key, "true or false");
  if (!value.is_boolean()) Refuse(key, &value, "true or false");
  return value.get<bool>();
}

double ReadNumber(const json& object, const char* key, double min, double max) {
  const std::string accepted = fmt::format("{:g} … {:g}", min, max);
  const json& value = At(object, key, accepted.c_str());
  if (!value.is_number() || !(value.get<double>() >= min && value.get<double>() <= max))
    Refuse(key, &value, accepted);
  return value.get<double>();
}

std::int64_t ReadWhole(const json& object, const char* key, std::int64_t min, std::int64_t max) {
  const std::string accepted = fmt::format("a whole number, {} … {}", min, max);
  const json& value = At(object, key, accepted.c_str());
  const bool is_whole =
      value.is_number_integer() &&
      (!value.is_number_unsigned() || value.get<std::uint64_t>() <= static_cast<std::uint64_t>(kMaxStamp));
  if (!is_whole || value.get<std::int64_t>() < min || value.get<std::int64_t>() > max)
    Refuse(key, &value, accepted);
  return value.get<std::int64_t>();
}

const json& ReadList(const json& object, const char* key) {
  const json& value = At(object, key, "a list");
  if (!value.is_array()) Refuse(key, &value, "a list");
  return value;
}

template <std::size_t N>
std::array<double, N> ReadNumbers(const json& object, const char* key, double min, double max) {
  const std::string accepted = fmt::format("{} numbers, {:g} … {:g}", N, min, max);
  const json& list = At(object, key, accepted.c_str());
  if (!list.is_array() || list.size() != N) Refuse(key, &list, accepted);
  std::array<double, N> numbers{};
  for (std::size_t i = 0; i < N; ++i) {
    if (!list[i].is_number() || !(list[i].get<double>() >= min && list[i].get<double>() <= max))
      Refuse(key, &list[i], accepted);
    numbers[i] = list[i].get<double>();
  }
  return numbers;
}

// Reads the name of a file in the session's folder.
std::string ReadName(const json& object, const char* key) {
  std::string name = ReadText(object, key);
  RequireName(key, name);
  return name;
}

// Reads the time at which the session began; empty: there is none.
std::string ReadBegan(const json& all) {
  // each 0 stands for any digit
  constexpr std::string_view kForm = "0000-00-00T00:00:00Z";
  const auto at = all.find("began");
  if (at == all.end() || at->is_null()) return "";
  const std::string text = at->is_string() ? at->get<std::string>() : "";
  const bool has_form =
      std::equal(text.begin(), text.end(), kForm.begin(), kForm.end(),
                 [](char c, char form) { return form == '0' ? c >= '0' && c <= '9' : c == form; });
  if (!has_form) Refuse("began", &*at, "a time in UTC, such as 2026-11-29T09:30:00Z, or null");
  return text;
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

json MissedJson(const MissedChange& missed, const SessionFile& session) {
  return {{"tool_index", missed.tool_index},
          {"tool_diameter_mm", session.diameters_mm.at(static_cast<std::size_t>(missed.tool_index))},
          {"reason", missed.reason}};
}

int ReadToolIndex(const json& object, const SessionFile& session) {
  return static_cast<int>(
      ReadWhole(object, "tool_index", 0, static_cast<std::int64_t>(session.diameters_mm.size()) - 1));
}

SessionSegment ReadSegment(const json& object, const SessionFile& session) {
  SessionSegment segment{.tool_index = ReadToolIndex(object, session),
                         .recording = ReadName(object, "recording"),
                         .begin = ReadWhole(object, "begin_ns", 0, kMaxStamp),
                         .end = ReadWhole(object, "end_ns", 0, kMaxStamp),
                         .begin_state = ReadName(object, "begin_state"),
                         .begin_state_hash = ReadText(object, "begin_state_hash"),
                         .end_state = ReadName(object, "end_state"),
                         .end_state_hash = ReadText(object, "end_state_hash"),
                         .guidance_gain = ReadNumber(object, "guidance_gain", 0.0, 1.0)};
  if (segment.recording.empty()) Refuse("recording", nullptr, "the name of a recording");
  if (segment.end != 0 && segment.end < segment.begin)
    Refuse("end_ns", &object.at("end_ns"), "0, or no less than begin_ns");
  return segment;
}

// Reads a pass. @param number the number that the pass must have
SessionPass ReadPass(const json& object, const SessionFile& session, std::int64_t number) {
  SessionPass pass{.number = static_cast<int>(ReadWhole(object, "number", number, number)),
                   .segment = static_cast<int>(ReadWhole(
                       object, "segment", 0, static_cast<std::int64_t>(session.segments.size()) - 1)),
                   .tool_index = ReadToolIndex(object, session),
                   .begin = ReadWhole(object, "begin_ns", 0, kMaxStamp),
                   .end = ReadWhole(object, "end_ns", 0, kMaxStamp),
                   .cutting_s = ReadNumber(object, "cutting_s", 0.0, kMaxFigure),
                   .removed_mm3 = ReadNumber(object, "removed_mm3", 0.0, kMaxFigure),
                   .state = ReadName(object, "state"),
                   .state_hash = ReadText(object, "state_hash"),
                   .undone = ReadBool(object, "undone")};
  if (pass.end < pass.begin) Refuse("end_ns", &object.at("end_ns"), "no less than begin_ns");
  if (const auto to_go = object.find("to_go_mm"); to_go != object.end() && !to_go->is_null())
    pass.to_go_mm = ReadNumber(object, "to_go_mm", -kMaxToGo_mm, kMaxToGo_mm);
  if (pass.state.empty()) Refuse("state", nullptr, "the file of a carved state");
  return pass;
}

// Makes the rows of [R | p].
json PoseJson(const PlainPose& plain) {
  const Pose X = plain;
  json rows = json::array();
  for (int row = 0; row < 3; ++row) {
    const auto r = X.matrix().row(row);
    rows.push_back({r[0], r[1], r[2], r[3]});
  }
  return rows;
}

// Reads the cup's pose; refuses rows whose R is no rotation.
PlainPose ReadPose(const json& rows) {
  constexpr const char* kAccepted = "three rows [R | p] of a pose in m";
  Pose X = Pose::Identity();
  const bool is_list = rows.is_array() && rows.size() == 3;
  for (std::size_t row = 0; row < 3; ++row)
    for (std::size_t column = 0; column < 4; ++column) {
      if (!is_list || !rows[row].is_array() || rows[row].size() != 4 || !rows[row][column].is_number())
        Refuse("cup_X_GT", &rows, kAccepted);
      X.matrix()(static_cast<Eigen::Index>(row), static_cast<Eigen::Index>(column)) =
          rows[row][column].get<double>();
    }
  if (!X.matrix().allFinite() || (X.linear() * X.linear().transpose() - Matrix3::Identity()).norm() > 1e-6 ||
      X.linear().determinant() < 0.0)
    Refuse("cup_X_GT", &rows, kAccepted);
  return X;
}

}  // namespace

int SessionFile::PassesLeft() const {
  int count = 0;
  for (const SessionPass& pass : passes) count += pass.undone ? 0 : 1;
  return count;
}

std::string SessionFile::LastState() const {
  for (auto pass = passes.rbegin(); pass != passes.rend(); ++pass)
    if (!pass->undone) return pass->state;
  return {};
}

std::string ToJson(const SessionFile& session) {
  json segments = json::array(), passes = json::array(), missed = json::array();
  for (const MissedChange& change : session.missed_changes) missed.push_back(MissedJson(change, session));
  for (const SessionSegment& segment : session.segments) segments.push_back(SegmentJson(segment, session));
  for (const SessionPass& pass : session.passes) passes.push_back(PassJson(pass, session));
  json all{
      {"schema", kSessionSchema},
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
      {"began", session.began.empty() ? json(nullptr) : json(session.began)},
      {"gains",
       {{"law", session.gains.law},
        {"stiffness_N_per_mm", session.gains.stiffness_N_per_mm},
        {"damping_Ns_per_m", session.gains.damping_Ns_per_m},
        {"mass_kg", session.gains.mass_kg},
        {"drag_Ns_per_m", session.gains.drag_Ns_per_m}}},
      {"ended", session.ended},
      {"segments", std::move(segments)},
      {"passes", std::move(passes)},
      {"missed_changes", std::move(missed)},
      {"cup_X_GT", session.cup_X_GT ? PoseJson(*session.cup_X_GT) : json(nullptr)}};
  return base::JsonText(all);
}

tl::expected<SessionFile, std::string> ParseSession(const std::string& text) {
  std::string place;  // the part that is being read, for the error: "passes[2]: "
  try {
    const json all = json::parse(text);
    if (const std::string schema = ReadText(all, "schema"); schema != kSessionSchema)
      return tl::make_unexpected(
          fmt::format("schema: found \"{}\", accepted \"{}\"", schema, kSessionSchema));
    const json& checksums = At(all, "checksums", "the checksums of plan, cell and bone");
    SessionFile session{.cell = ReadText(all, "cell"),
                        .cell_file = ReadText(all, "cell_file"),
                        .plan_file = ReadName(all, "plan"),
                        .plan_name = all.contains("plan_name") ? ReadText(all, "plan_name") : "",
                        .plan_checksum = ReadText(checksums, "plan"),
                        .cell_checksum = ReadText(checksums, "cell"),
                        .bone_checksum = ReadText(checksums, "bone"),
                        .scene = ReadText(all, "scene"),
                        .mesh_file = {},
                        .tool = ReadText(all, "tool"),
                        .diameters_mm = {},
                        .tool_change = ReadText(all, "tool_change"),
                        .clock = ReadText(all, "clock"),
                        .began = ReadBegan(all),
                        .gains = {},
                        .ended = ReadBool(all, "ended"),
                        .segments = {},
                        .passes = {},
                        .cup_X_GT = {}};
    for (const json& diameter : ReadList(all, "diameters_mm")) {
      if (!diameter.is_number() ||
          !(diameter.get<double>() > 0.0 && diameter.get<double>() <= kMaxDiameter_mm))
        Refuse("diameters_mm", &diameter, fmt::format("more than 0, at most {:g}", kMaxDiameter_mm));
      session.diameters_mm.push_back(diameter.get<double>());
    }
    const json& gains = At(all, "gains", "the gains of the session's start");
    session.gains = {.law = ReadText(gains, "law"),
                     .stiffness_N_per_mm = ReadNumber(gains, "stiffness_N_per_mm", 0.0, kMaxFigure),
                     .damping_Ns_per_m = ReadNumber(gains, "damping_Ns_per_m", 0.0, kMaxFigure),
                     .mass_kg = ReadNumbers<3>(gains, "mass_kg", 0.0, kMaxFigure),
                     .drag_Ns_per_m = ReadNumbers<3>(gains, "drag_Ns_per_m", 0.0, kMaxFigure)};
    if (const auto mesh = all.find("mesh"); mesh != all.end() && !mesh->is_null()) {
      session.mesh_file = ReadText(*mesh, "file");
      session.mesh_scale = ReadNumber(*mesh, "scale", 1e-9, kMaxFigure);
    }
    for (const json& segment : ReadList(all, "segments")) {
      place = fmt::format("segments[{}]: ", session.segments.size());
      session.segments.push_back(ReadSegment(segment, session));
    }
    for (const json& pass : ReadList(all, "passes")) {
      place = fmt::format("passes[{}]: ", session.passes.size());
      session.passes.push_back(ReadPass(pass, session, static_cast<std::int64_t>(session.passes.size()) + 1));
    }
    place.clear();
    if (all.contains("missed_changes"))  // not in older sessions
      for (const json& change : ReadList(all, "missed_changes"))
        session.missed_changes.push_back(
            {.tool_index = ReadToolIndex(change, session), .reason = ReadText(change, "reason")});
    if (const json& cup = At(all, "cup_X_GT", "three rows of a pose, or null"); !cup.is_null())
      session.cup_X_GT = ReadPose(cup);
    return session;
  } catch (const std::exception& error) {
    return tl::make_unexpected(place + error.what());
  }
}

tl::expected<void, std::string> WriteSession(const std::filesystem::path& folder,
                                             const SessionFile& session) {
  return base::WriteText(folder / kSessionFileName, ToJson(session));
}

tl::expected<SessionFile, std::string> ReadSession(const std::filesystem::path& folder) {
  const std::filesystem::path path = folder / kSessionFileName;
  if (std::error_code error; !std::filesystem::is_regular_file(path, error) || !std::ifstream(path)) {
    const bool is_file = std::filesystem::is_regular_file(folder, error);  // the user gave a recording
    const std::filesystem::path meant = is_file ? folder.parent_path() : folder / "session";  // of a demo
    const bool is_meant = std::filesystem::is_regular_file(meant / kSessionFileName, error);
    return tl::make_unexpected(
        (is_file ? folder.string() + ": found a file" : path.string() + ": found no readable file") +
        ", accepted the folder of a session" +
        (is_meant ? "; did you mean " + (meant.empty() ? "." : meant.string()) + "?" : ""));
  }
  auto session = ParseSession(base::ReadText(path));
  if (!session) return tl::make_unexpected(path.string() + ": " + session.error());
  return session;
}

int LastNumber(const std::filesystem::path& folder, const std::string& prefix, const std::string& extension) {
  int last = 0;
  std::error_code error;
  for (std::filesystem::directory_iterator entry(folder, error), end; !error && entry != end;
       entry.increment(error)) {
    const std::string name = entry->path().filename().string();
    if (name.size() <= prefix.size() + extension.size() || !name.starts_with(prefix) ||
        !name.ends_with(extension))
      continue;
    int number = 0;
    const char* const from = name.data() + prefix.size();
    const char* const to = name.data() + name.size() - extension.size();
    if (const auto read = std::from_chars(from, to, number); read.ec == std::errc() && read.ptr == to)
      last = std::max(last, number);
  }
  return last;
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
