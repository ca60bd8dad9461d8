#include "session/replay/export_tables.h"

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <iterator>
#include <memory>
#include <system_error>

#include <fmt/format.h>

#include "io/recording/recording_reader.h"
#include "session/replay/tick_fields.h"

namespace osteon::session {
namespace {

using control::TickRecord;
using simulation::FrameRecord;

constexpr std::size_t kBuffer = 1u << 18;       // rows are written in blocks of this many bytes
constexpr std::uint64_t kProgressEvery = 1000;  // number of messages between two reports of progress

// A table that is being written. After the first failure nothing more is written.
class Table {
 public:
  explicit Table(std::filesystem::path path)
      : path_(std::move(path)), file_(std::fopen(path_.c_str(), "we")) {
    if (!file_) Fail();
  }

  /// Appends a cell to the row.
  template <class T>
  void Cell(const T& value) {
    if (!row_starts_) row_.push_back(',');
    row_starts_ = false;
    fmt::format_to(std::back_inserter(row_), "{}", value);
  }
  void EmptyCells(std::size_t count) {
    for (std::size_t i = 0; i < count; ++i) Cell("");
  }
  void EndRow() {
    row_.push_back('\n');
    row_starts_ = true;
    if (row_.size() > kBuffer) Flush();
  }
  /// Completes the file. @returns the first error; empty: none
  std::string Close() {
    Flush();
    if (file_ && std::fclose(file_.release()) != 0) Fail();
    return error_;
  }
  [[nodiscard]] const std::filesystem::path& path() const { return path_; }
  [[nodiscard]] const std::string& error() const { return error_; }

 private:
  struct Closer {
    void operator()(std::FILE* file) const { std::fclose(file); }
  };
  void Flush() {
    if (file_ && error_.empty() && std::fwrite(row_.data(), 1, row_.size(), file_.get()) != row_.size())
      Fail();
    row_.clear();
  }
  void Fail() {
    if (error_.empty()) error_ = path_.string() + ": cannot write: " + std::generic_category().message(errno);
  }

  std::filesystem::path path_;
  std::unique_ptr<std::FILE, Closer> file_;
  fmt::memory_buffer row_;
  bool row_starts_{true};
  std::string error_;
};

// Time from `start` to `stamp` [s].
double Seconds(rt::Nanoseconds stamp, rt::Nanoseconds start) {
  return 1e-9 * static_cast<double>(stamp - start);
}

// Quotes a text by RFC 4180.
std::string Quoted(const std::string& text) {
  std::string quoted = "\"";
  for (const char c : text) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
  return quoted + '"';
}

// Makes a visitor that writes each field's name as a cell of the head line.
auto NameWriter(Table& table) {
  return [&table](const FieldName& name, auto) { table.Cell(name.Text()); };
}

void WriteTickHead(Table& ticks) {
  ticks.Cell("time_s");
  VisitOutputs(TickRecord{}, NameWriter(ticks));
  VisitInputs(TickRecord{}, NameWriter(ticks));
  ticks.EndRow();
}

void WriteHeads(Table& ticks, Table& frames, Table& events) {
  WriteTickHead(ticks);
  frames.Cell("time_s");
  VisitFrame(FrameRecord{}, NameWriter(frames));
  for (int i = 1; i <= simulation::kMaxContacts; ++i)
    VisitContact(simulation::Contact{}, [&](const FieldName& name, auto) {
      frames.Cell(fmt::format("contact_{}_{}", i, name.Text()));
    });
  frames.EndRow();
  for (const char* name : {"time_s", "stamp_ns", "text"}) events.Cell(name);
  events.EndRow();
}

void WriteTick(Table& table, const TickRecord& tick, rt::Nanoseconds start) {
  const auto cell = [&](const FieldName&, auto value) { table.Cell(value); };
  table.Cell(Seconds(tick.stamp, start));
  VisitOutputs(tick, cell);
  VisitInputs(tick, cell);
  table.EndRow();
}

void WriteFrame(Table& table, const FrameRecord& frame, rt::Nanoseconds start) {
  const auto cell = [&](const FieldName&, auto value) { table.Cell(value); };
  table.Cell(Seconds(frame.stamp, start));
  VisitFrame(frame, cell);
  std::size_t columns = 0;
  VisitContact(simulation::Contact{}, [&](const FieldName&, auto) { ++columns; });
  const int count = std::clamp(frame.model.contact_count, 0, simulation::kMaxContacts);
  for (int i = 0; i < count; ++i) VisitContact(frame.model.contacts[static_cast<std::size_t>(i)], cell);
  table.EmptyCells(columns * static_cast<std::size_t>(simulation::kMaxContacts - count));
  table.EndRow();
}

}  // namespace

tl::expected<ExportedTables, std::string> ExportTables(const std::filesystem::path& recording,
                                                       const std::filesystem::path& folder,
                                                       const std::string& stem,
                                                       const std::function<void(double)>& progress) {
  auto stream = io::RecordingStream::Open(recording);
  if (!stream) return tl::make_unexpected(stream.error());
  Table ticks(folder / (stem + "_ticks.csv")), frames(folder / (stem + "_frames.csv")),
      events(folder / (stem + "_events.csv"));
  WriteHeads(ticks, frames, events);

  ExportedTables exported;
  for (std::uint64_t messages = 0;; ++messages) {
    const auto topic = stream->Next();
    if (!topic) return tl::make_unexpected(topic.error());
    const rt::Nanoseconds start = stream->session.stamp;
    if (*topic == io::RecordedTopic::kOther) break;
    if (*topic == io::RecordedTopic::kTick) {
      WriteTick(ticks, stream->tick, start);
      ++exported.ticks;
    } else if (*topic == io::RecordedTopic::kFrame) {
      WriteFrame(frames, stream->frame, start);
      ++exported.frames;
    } else if (*topic == io::RecordedTopic::kEvent) {
      events.Cell(Seconds(stream->event.stamp, start));
      events.Cell(stream->event.stamp);
      events.Cell(Quoted(stream->event.text));
      events.EndRow();
      ++exported.events;
    }
    // every kProgressEvery messages: check the tables for errors, and report the progress
    if (messages % kProgressEvery != 0) continue;
    for (const Table* table : {&ticks, &frames, &events})
      if (!table->error().empty()) return tl::make_unexpected(table->error());
    if (progress)
      progress(static_cast<double>(stream->file().read_bytes()) /
               static_cast<double>(std::max<std::uint64_t>(1, stream->file().file_bytes())));
  }
  for (Table* table : {&ticks, &frames, &events}) {
    if (std::string wrong = table->Close(); !wrong.empty()) return tl::make_unexpected(wrong);
    exported.files.push_back(table->path());
  }
  exported.complete = stream->complete();
  exported.closed = stream->file().closed();
  exported.tail_bytes = stream->file().file_bytes() - stream->file().read_bytes();
  return exported;
}

tl::expected<void, std::string> ExportTicks(std::span<const TickRecord> ticks, rt::Nanoseconds start,
                                            const std::filesystem::path& path) {
  Table table(path);
  WriteTickHead(table);
  for (const TickRecord& tick : ticks) WriteTick(table, tick, start);
  if (std::string wrong = table.Close(); !wrong.empty()) return tl::make_unexpected(std::move(wrong));
  return {};
}

}  // namespace osteon::session
