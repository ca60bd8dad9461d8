#include "config/config_file_tracker.h"

#include <algorithm>
#include <stdexcept>
#include <utility>

namespace osteon::config {
namespace {

thread_local ConfigFileTracker* present = nullptr;

std::filesystem::path AbsolutePath(const std::filesystem::path& path) {
  return std::filesystem::absolute(path).lexically_normal();
}

bool IsBelow(const std::filesystem::path& path, const std::filesystem::path& folder) {
  const std::filesystem::path relative = path.lexically_relative(folder);
  return !relative.empty() && *relative.begin() != "..";
}

}  // namespace

ConfigFileTracker::ConfigFileTracker() : ConfigFileTracker(Params{}) {}

ConfigFileTracker::ConfigFileTracker(Params params) : params_(std::move(params)) {
  if (present) throw std::logic_error("config: a FileScope inside another");
  if (!params_.root.empty()) params_.root = AbsolutePath(params_.root);
  present = this;
}

ConfigFileTracker::~ConfigFileTracker() { present = nullptr; }

void ConfigFileTracker::RecordFile(const std::filesystem::path& path, bool by_whole_path) {
  if (!present) return;
  const std::filesystem::path whole = AbsolutePath(path);
  const auto known = std::find_if(present->files_.begin(), present->files_.end(),
                                  [&](const File& f) { return f.path == whole; });
  if (known == present->files_.end())
    present->files_.push_back({.path = whole, .by_whole_path = by_whole_path});
  else
    known->by_whole_path |= by_whole_path;
}

std::filesystem::path ConfigFileTracker::ResolveNamed(const std::filesystem::path& folder,
                                                      const std::filesystem::path& named) {
  const std::filesystem::path path = (folder / named).lexically_normal();
  if (!present || present->params_.root.empty()) {
    RecordFile(path, named.is_absolute());
    return path;
  }
  const Params& params = present->params_;
  const std::filesystem::path found =
      named.is_absolute() && !params.once_at.empty() && IsBelow(named.lexically_normal(), params.once_at)
          ? params.root / named.lexically_normal().lexically_relative(params.once_at)
          : AbsolutePath(path);
  return IsBelow(found, params.root) ? found : std::filesystem::path();
}

}  // namespace osteon::config
