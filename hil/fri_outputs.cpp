#include "hil/fri_outputs.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

namespace osteon::hil {
namespace {

template <class Item>
auto Find(std::vector<Item>& items, const std::string& name) {
  return std::find_if(items.begin(), items.end(), [&](const Item& item) { return item.name == name; });
}

template <class Item>
void RequireNames(const std::vector<Item>& items, std::size_t most, const char* what) {
  if (items.size() > most)
    throw std::invalid_argument(
        fmt::format("simulated arm: {}: found {}, accepted at most {}", what, items.size(), most));
  for (std::size_t i = 0; i < items.size(); ++i) {
    const std::string& name = items[i].name;
    if (name.empty() || name.size() > FriOutputs::kMaxName)
      throw std::invalid_argument(
          fmt::format("simulated arm: {}: found a name of {} characters, accepted 1 … {}", what, name.size(),
                      FriOutputs::kMaxName));
    for (std::size_t j = 0; j < i; ++j)
      if (items[j].name == name)
        throw std::invalid_argument(fmt::format("simulated arm: {}: found \"{}\" twice", what, name));
  }
}

}  // namespace

FriOutputs::FriOutputs(std::vector<ArmIo> ios, std::vector<ArmFrame> frames)
    : ios_(std::move(ios)), frames_(std::move(frames)) {
  RequireNames(ios_, kMaxIos, "ios");
  RequireNames(frames_, kMaxFrames, "frames");
}

std::uint64_t FriOutputs::ApplyRequests(const FriCommand& command) {
  std::uint64_t refused = 0;
  for (const ArmIo& io : command.ios) {
    const auto own = Find(ios_, io.name);
    if (own == ios_.end() || !own->output || own->type != io.type || !std::isfinite(io.analog)) {
      ++refused;
      continue;
    }
    own->digital = io.digital;
    own->analog = io.analog;
  }
  for (const ArmFrame& frame : command.frames) {
    const auto own = Find(frames_, frame.name);
    if (own == frames_.end())
      ++refused;
    else
      own->X = frame.X;
  }
  return refused;
}

bool FriOutputs::SetInput(const ArmIo& input) {
  const auto own = Find(ios_, input.name);
  if (own == ios_.end() || own->output || own->type != input.type) return false;
  own->digital = input.digital;
  own->analog = input.analog;
  return true;
}

}  // namespace osteon::hil
