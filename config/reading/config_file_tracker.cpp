#include "config/reading/config_file_tracker.h"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <stdexcept>
#include <system_error>
#include <utility>

#include "config/reading/named_file.h"
#include "config/reading/shipped_folder.h"

namespace osteon::config {
namespace {

// the tracker of this thread; null: this thread has none
thread_local ConfigFileTracker* present_tracker = nullptr;

// Whether a path lies in a folder, at any depth, or is the folder itself. Both paths must be absolute and
// normal.
bool IsBelow(const std::filesystem::path& path, const std::filesystem::path& folder) {
  const std::filesystem::path relative = path.lexically_relative(folder);
  return !relative.empty() && *relative.begin() != "..";
}

// The shipped folder of this process: found at the first call, and replaced by SetShippedFolder.
std::filesystem::path& Shipped() {
  static std::filesystem::path folder = [] {
    std::error_code error;
    return FindShippedFolder(std::getenv("OSTEON_ROOT"), ".",
                             std::filesystem::read_symlink("/proc/self/exe", error));
  }();
  return folder;
}

bool IsFile(const std::filesystem::path& path) {
  std::error_code error;
  return std::filesystem::is_regular_file(path, error);
}

// Finds the first file of this name, in the order of the paths, in any folder named `kind` below the root.
std::filesystem::path FindBelow(const std::filesystem::path& root, const std::string& kind,
                                const std::string& file) {
  std::filesystem::path found;
  std::error_code error;
  for (std::filesystem::recursive_directory_iterator at(root, error), end; !error && at != end;
       at.increment(error)) {
    const std::filesystem::path& path = at->path();
    if (path.filename() == file && path.parent_path().filename() == kind && (found.empty() || path < found))
      found = path;
  }
  return found;
}

}  // namespace

std::filesystem::path FindShippedFolder(const char* root, const std::filesystem::path& here,
                                        const std::filesystem::path& program) {
  if (root) return std::filesystem::path(root) / "config";
  constexpr std::array<const char*, 1> kRequiredFolders{"cells"};
  if (!HasFolders(here / "config", kRequiredFolders))
    if (const std::filesystem::path found = FindShippedAbove(program, kRequiredFolders); !found.empty())
      return found;
  return here / "config";
}

std::filesystem::path ShippedFolder() { return Shipped(); }

void SetShippedFolder(const std::filesystem::path& folder) { Shipped() = folder; }

ConfigFileTracker::ConfigFileTracker() : ConfigFileTracker(Params{}) {}

ConfigFileTracker::ConfigFileTracker(Params params) : params_(std::move(params)) {
  if (present_tracker) throw std::logic_error("config: a ConfigFileTracker inside another");
  if (!params_.root.empty()) params_.root = AbsolutePath(params_.root);
  present_tracker = this;
}

ConfigFileTracker::~ConfigFileTracker() { present_tracker = nullptr; }

void ConfigFileTracker::RecordFile(const std::filesystem::path& path, bool by_whole_path) {
  if (!present_tracker) return;
  const std::filesystem::path whole = AbsolutePath(path);
  const auto known = std::find_if(present_tracker->files_.begin(), present_tracker->files_.end(),
                                  [&](const File& f) { return f.path == whole; });
  if (known == present_tracker->files_.end())
    present_tracker->files_.push_back({.path = whole, .by_whole_path = by_whole_path});
  else
    known->by_whole_path |= by_whole_path;
}

std::filesystem::path ConfigFileTracker::ResolveNamed(const std::filesystem::path& folder,
                                                      const std::filesystem::path& named) {
  const std::filesystem::path path = (folder / named).lexically_normal();
  if (!present_tracker || present_tracker->params_.root.empty()) {
    RecordFile(path, named.is_absolute());
    return path;
  }
  const Params& params = present_tracker->params_;
  const std::filesystem::path found =
      named.is_absolute() && !params.once_at.empty() && IsBelow(named.lexically_normal(), params.once_at)
          ? params.root / named.lexically_normal().lexically_relative(params.once_at)
          : AbsolutePath(path);
  return IsBelow(found, params.root) ? found : std::filesystem::path();
}

std::filesystem::path ConfigFileTracker::FindByName(const std::filesystem::path& by, const std::string& kind,
                                                    const std::string& name) {
  const std::string file = name + ".yaml";
  const std::filesystem::path folder = by.parent_path(),
                              sibling = kind == "cells" ? folder / file : folder / ".." / kind / file;
  const bool confined = present_tracker && !present_tracker->params_.root.empty();
  std::filesystem::path found = confined ? AbsolutePath(sibling) : sibling.lexically_normal();
  const bool is_there = IsFile(found) && AbsolutePath(found) != AbsolutePath(by);
  if (confined) {
    if (!is_there || !IsBelow(found, present_tracker->params_.root))
      found = FindBelow(present_tracker->params_.root, kind, file);
  } else if (!is_there) {
    found = (Shipped() / kind / file).lexically_normal();
  }
  if (found.empty() || !IsFile(found)) return {};
  RecordFile(found);
  return found;
}

}  // namespace osteon::config
