#include "session/view/carved_keys.h"

#include <algorithm>
#include <utility>

#include "base/realtime_thread.h"

namespace osteon::session {

CarvedBone::CarvedBone(std::shared_ptr<const surface::SolidField> solid,
                       std::shared_ptr<const RecordedCut> cut)
    : field(std::move(solid)), sweep(cut->tools.front(), cut->X_WG), cut_(std::move(cut)) {
  cut_->CarveEarlier(field);
}

// Begins a new path if the tool has changed: no bone is swept between the last place of one tool and the
// first place of the next tool.
void CarvedBone::Use(std::size_t tool) {
  if (tool == tool_ || tool >= cut_->tools.size()) return;
  Gather();
  sweep = surface::ToolSweep(cut_->tools[tool], cut_->X_WG);
  tool_ = tool;
}

void CarvedBone::Gather() {
  const std::vector<surface::Capsule> swept = sweep.TakeCapsules();
  gathered_.insert(gathered_.end(), swept.begin(), swept.end());
}

void CarvedBone::Take(io::RecordedTopic topic, const RecordingTimeline& timeline) {
  const io::RecordingStream& message = timeline.message();
  if (topic == io::RecordedTopic::kTick) {
    turns = message.tick.spindle_rad_per_s != 0.0;
    last_tick = message.tick.stamp;
    at_s = timeline.At(last_tick);
    Use(message.tick.input.tool_index);
  }
  if (topic != io::RecordedTopic::kFrame) return;
  const simulation::ContactModel& model = message.frame.model;
  const bool cuts = turns && cut_->Counts(model.pose_stamp);
  if (!sweep.Add(surface::MakeToolFrame(model, cuts ? 1.0 : 0.0))) return;
  Gather();
  if (gathered_.size() >= kMaxGathered) Carve();
}

void CarvedBone::Carve() {
  field.Carve(gathered_);
  gathered_.clear();
}

void CarvedBone::JumpTo(const CarvedBone& other) {
  field.SetSwept(other.field.swept());
  sweep = other.sweep;
  tool_ = other.tool_;
  turns = other.turns;
  at_s = other.at_s;
  last_tick = other.last_tick;
  gathered_ = other.gathered_;
}

void CarvedBone::CarveAll() {
  Carve();
  field.Carve(sweep.TakeCapsules());
}

CarvedKeys::CarvedKeys(const std::filesystem::path& recording, const CarvedBone& begin)
    : thread_([this, recording, begin] { Run(recording, begin); }) {}

CarvedKeys::~CarvedKeys() {
  stop_.store(true);
  thread_.join();
}

std::shared_ptr<const CarvedBone> CarvedKeys::Before(double at_s) const {
  const std::lock_guard lock(mutex_);
  const auto after = std::ranges::upper_bound(keys_, at_s, {}, [](const auto& key) { return key->at_s; });
  return after == keys_.begin() ? nullptr : *std::prev(after);
}

void CarvedKeys::Run(const std::filesystem::path& recording, CarvedBone bone) {
  rt::NameThread("view keys");
  rt::LowerPriority();
  auto timeline = RecordingTimeline::Open(recording);
  if (!timeline) return;
  (void)timeline->Seek(0.0);
  double next_s = step_s_;
  while (!stop_.load()) {
    const auto topic = timeline->Next();
    if (!topic || *topic == io::RecordedTopic::kOther) {
      complete_.store(true);
      return;
    }
    bone.Take(*topic, *timeline);
    if (*topic != io::RecordedTopic::kTick || bone.at_s < next_s) continue;
    bone.Carve();
    Keep(bone);
    next_s = bone.at_s + step_s_;
  }
}

void CarvedKeys::Keep(const CarvedBone& bone) {
  auto key = std::make_shared<const CarvedBone>(bone);
  const std::lock_guard lock(mutex_);
  keys_.push_back(std::move(key));
  std::size_t bytes = 0;
  for (const auto& each : keys_) bytes += each->field.swept().Bytes();
  if (keys_.size() < 2 || (keys_.size() <= kMaxKeys && bytes <= kMaxBytes)) return;
  for (std::size_t i = 0; 2 * i + 1 < keys_.size(); ++i) keys_[i] = keys_[2 * i + 1];
  keys_.resize(keys_.size() / 2);
  step_s_ *= 2.0;
}

bool GoOnFrom(const CarvedBone& bone, RecordingTimeline& timeline) {
  (void)timeline.Seek(bone.at_s);
  if (bone.last_tick == 0) return true;
  while (true) {
    const auto topic = timeline.Next();
    if (!topic || *topic == io::RecordedTopic::kOther) return false;
    if (*topic == io::RecordedTopic::kTick && timeline.message().tick.stamp == bone.last_tick) return true;
  }
}

}  // namespace osteon::session
