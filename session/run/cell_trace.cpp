#include "session/run/cell_trace.h"

#include <algorithm>
#include <charconv>
#include <iterator>
#include <string_view>

#include <fmt/format.h>

namespace osteon::session {
namespace {

// A tool that is faster than this counts as moving.
constexpr double kRest_m_per_s = 0.002, kRest_rad_per_s = 0.02;

constexpr const char* kHeader =
    "stamp_ns,session,apex_x_m,apex_y_m,apex_z_m,speed_m_per_s,turn_rad_per_s,hand_N";

// Reads the first column of the row and removes it. False if it is not a number.
template <class Number>
bool ParseField(std::string_view& row, Number& number) {
  const auto [end, error] = std::from_chars(row.data(), row.data() + row.size(), number);
  if (error != std::errc()) return false;
  row.remove_prefix(static_cast<std::size_t>(end - row.data()));
  if (!row.empty()) row.remove_prefix(1);  // the comma
  return true;
}

}  // namespace

bool Moves(const CellCycle& cycle) {
  return cycle.speed_m_per_s > kRest_m_per_s || cycle.turn_rad_per_s > kRest_rad_per_s;
}

rt::Nanoseconds RestedFor(const std::vector<CellCycle>& cycles, rt::Nanoseconds since) {
  if (cycles.empty()) return 0;
  for (auto cycle = cycles.rbegin(); cycle != cycles.rend() && cycle->stamp > since; ++cycle)
    if (Moves(*cycle) || cycle->session == control::SessionState::kCommandingActive)
      return cycles.back().stamp - cycle->stamp;
  return std::max<rt::Nanoseconds>(0, cycles.back().stamp - since);
}

tl::expected<std::unique_ptr<CellTraceWriter>, std::string> CellTraceWriter::Open(
    const std::filesystem::path& file) {
  std::unique_ptr<CellTraceWriter> writer(new CellTraceWriter(file));
  writer->stream_ << kHeader << std::endl;
  if (!writer->stream_) return tl::make_unexpected(file.string() + ": cannot write it");
  return writer;
}

void CellTraceWriter::Write(const hil::CellState& cycle) {
  const Vector3 p_WT_m = Pose(cycle.X_WT_meas).translation();
  stream_ << fmt::format("{},{},{:.7f},{:.7f},{:.7f},{:.6f},{:.6f},{:.3f}\n", cycle.stamp,
                         static_cast<int>(cycle.session), p_WT_m.x(), p_WT_m.y(), p_WT_m.z(),
                         Vector3(cycle.v_WT_meas_m_per_s).norm(), Vector3(cycle.w_WT_meas_rad_per_s).norm(),
                         Wrench(cycle.F_hand_T_W).f.norm());
}

tl::expected<void, std::string> CellTraceWriter::Close(std::uint64_t dropped) {
  stream_.close();
  if (!stream_) return tl::make_unexpected(file_.string() + ": not written to its end");
  if (dropped > 0)
    return tl::make_unexpected(fmt::format("{}: {} cycles are missing", file_.string(), dropped));
  return {};
}

void CellTraceReader::Poll() {
  std::ifstream stream(file_);
  stream.seekg(at_);
  const std::string text(std::istreambuf_iterator<char>(stream), {});
  std::string_view rest = text;
  for (std::size_t end; (end = rest.find('\n')) != std::string_view::npos; rest.remove_prefix(end + 1)) {
    std::string_view row = rest.substr(0, end);
    CellCycle cycle;
    int session = 0;
    if (!ParseField(row, cycle.stamp) || !ParseField(row, session)) continue;  // not a row: the header
    cycle.session = static_cast<control::SessionState>(session);
    bool is_complete = true;
    for (double* value : {&cycle.p_WT_m.x(), &cycle.p_WT_m.y(), &cycle.p_WT_m.z(), &cycle.speed_m_per_s,
                          &cycle.turn_rad_per_s, &cycle.hand_N})
      is_complete = is_complete && ParseField(row, *value);
    if (is_complete) cycles_.push_back(cycle);
  }
  at_ += static_cast<std::streamoff>(text.size() - rest.size());
}

}  // namespace osteon::session
