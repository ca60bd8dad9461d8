#include "session/summary/run_files.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <ctime>
#include <system_error>

#include <fmt/chrono.h>
#include <fmt/format.h>

namespace osteon::session {
namespace {

namespace fs = std::filesystem;

// When the file was last written; the epoch if it cannot be read.
std::chrono::system_clock::time_point WrittenAt(const fs::path& file) {
  struct stat status {};
  return std::chrono::system_clock::from_time_t(stat(file.c_str(), &status) == 0 ? status.st_mtime : 0);
}

// Returns the first free name among NAME, NAME_2, NAME_3 …
template <class IsFree>
std::string FirstFree(const std::string& name, const IsFree& is_free) {
  std::string free = name;
  for (int number = 2; !is_free(free); ++number) free = fmt::format("{}_{}", name, number);
  return free;
}

// Whether a file's name, such as "run_2_stop_1.html", is that of a file beside a session's recording:
// "run_", a number, "_".
bool IsOfSessionsRecording(const std::string& name) {
  if (!name.starts_with("run_")) return false;
  const std::size_t end = name.find_first_not_of("0123456789", 4);
  return end != std::string::npos && end > 4 && name[end] == '_';
}

}  // namespace

fs::path ReportPage(const fs::path& recording) {
  return recording.parent_path() / (recording.stem().string() + "_report.html");
}

fs::path StopPage(const fs::path& folder, const std::string& stem, std::size_t number) {
  return folder / fmt::format("{}_stop_{}.html", stem, number);
}

fs::path StopTable(const fs::path& folder, const std::string& stem, std::size_t number) {
  return folder / fmt::format("{}_stop_{}_ticks.csv", stem, number);
}

std::string DateAndTime(std::chrono::system_clock::time_point time) {
  return fmt::format("{:%Y-%m-%d_%H-%M-%S}", fmt::localtime(std::chrono::system_clock::to_time_t(time)));
}

fs::path DatedRecording(const fs::path& folder, std::chrono::system_clock::time_point time) {
  return folder /
         (FirstFree("run_" + DateAndTime(time),
                    [&](const std::string& name) { return FilesOfRun(folder / (name + ".mcap")).empty(); }) +
          ".mcap");
}

std::vector<fs::path> FilesOfRun(const fs::path& recording) {
  std::error_code error;
  std::vector<fs::path> files;
  const auto add_if_it_exists = [&](const fs::path& file) {
    const bool exists = fs::is_regular_file(file, error);
    if (exists) files.push_back(file);
    return exists;
  };
  add_if_it_exists(recording);
  add_if_it_exists(ReportPage(recording));
  const fs::path folder = recording.parent_path();
  const std::string stem = recording.stem().string();
  for (std::size_t number = 1;; ++number) {
    const bool has_page = add_if_it_exists(StopPage(folder, stem, number));
    const bool has_table = add_if_it_exists(StopTable(folder, stem, number));
    if (!has_page && !has_table) return files;
  }
}

std::string ValidateRecordingName(const fs::path& recording) {
  const std::vector<fs::path> files = FilesOfRun(recording);
  if (files.empty()) return "";
  return fmt::format("--record {}: found {}, of an earlier run; accepted a name that is free, or --overwrite",
                     recording.string(),
                     files.front() == recording ? "a recording" : files.front().filename().string());
}

std::string RemoveFiles(const std::vector<fs::path>& files) {
  for (const fs::path& file : files) {
    std::error_code error;
    fs::remove(file, error);
    if (error) return file.string() + ": can't be removed: " + error.message();
  }
  return "";
}

FolderClaim::~FolderClaim() {
  if (descriptor_ >= 0) close(descriptor_);
}

std::string FolderClaim::Acquire(const fs::path& folder) {
  if (descriptor_ >= 0) return "";
  const int opened = open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (opened < 0) return "";  // no error here: the code that creates or fills the folder reports it
  if (flock(opened, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK) {
    close(opened);
    return fmt::format("--out {}: found a folder that another osteon writes into, accepted another one",
                       folder.string());
  }
  descriptor_ = opened;
  return "";
}

std::vector<fs::path> FilesOfDemo(const fs::path& folder) {
  std::vector<fs::path> files;
  std::error_code error;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error)) {
    const std::string name = entry->path().filename().string();
    if (!entry->is_regular_file(error)) continue;
    const bool of_recording = name.starts_with("recording.") || name.starts_with("recording_");
    if (of_recording || IsOfSessionsRecording(name) || name == "summary.json" || name == "report.html")
      files.push_back(entry->path());
  }
  std::sort(files.begin(), files.end());
  return files;
}

tl::expected<fs::path, std::string> KeepEarlierDemo(const fs::path& folder) {
  return KeepEarlier(folder, FilesOfDemo(folder));
}

tl::expected<fs::path, std::string> KeepEarlier(const fs::path& folder, const std::vector<fs::path>& files) {
  if (files.empty()) return fs::path();
  auto newest = WrittenAt(files.front());
  for (const fs::path& file : files) newest = std::max(newest, WrittenAt(file));
  std::error_code error;
  const fs::path earlier = folder / FirstFree("earlier_" + DateAndTime(newest), [&](const std::string& name) {
                             return !fs::exists(folder / name, error);
                           });
  fs::create_directory(earlier, error);
  if (error) return tl::make_unexpected(earlier.string() + ": cannot make the folder: " + error.message());
  for (const fs::path& file : files) {
    fs::rename(file, earlier / file.filename(), error);
    if (error)
      return tl::make_unexpected(file.string() + ": cannot be moved to " + earlier.string() + ": " +
                                 error.message());
  }
  return earlier;
}

}  // namespace osteon::session
