#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include <foxglove.pb.h>
#include <gtest/gtest.h>

#include "io/recording/mcap_reader.h"
#include "kinematics/spatial.h"

// The bone's surface in a recording, as a viewer shows it after each message, and its volume. For tests.

namespace osteon::session {

/// Reads the messages of the topic "bone" from a recording, in their order.
inline std::vector<foxglove::SceneUpdate> BoneStates(const std::filesystem::path& recording) {
  std::vector<foxglove::SceneUpdate> states;
  auto reader = io::McapReader::Open(recording);
  EXPECT_TRUE(reader) << reader.error();
  io::McapMessage message;
  while (*reader->Next(message)) {
    if (message.channel->topic != "bone") continue;
    EXPECT_EQ(message.channel->schema_name, "foxglove.SceneUpdate");
    EXPECT_TRUE(states.emplace_back().ParseFromString({message.bytes.data(), message.bytes.size()}));
  }
  return states;
}

/// The parts of the bone that a viewer shows: the newest message of each, by the part's name.
using Shown = std::map<std::string, std::string>;
/// Applies a message to the shown parts as a viewer does.
inline void Show(const foxglove::SceneUpdate& state, Shown& shown) {
  for (const auto& deletion : state.deletions())
    if (deletion.type() == foxglove::SceneEntityDeletion::ALL) shown.clear();
  for (const auto& entity : state.entities()) {
    foxglove::SceneEntity part = entity;
    part.clear_timestamp();
    shown[part.id()] = part.SerializeAsString();
  }
}

/// Volume that the shown parts enclose together [mm³].
inline double VolumeOf(const Shown& shown) {
  double volume_m3 = 0.0;
  for (const auto& [id, bytes] : shown) {
    foxglove::SceneEntity entity;
    EXPECT_TRUE(entity.ParseFromString(bytes));
    for (const auto& part : entity.triangles()) {
      const auto point = [&](int i) {
        const auto& p = part.points(static_cast<int>(part.indices(i)));
        return Vector3(p.x(), p.y(), p.z());
      };
      for (int i = 0; i + 2 < part.indices_size(); i += 3)
        volume_m3 += point(i).dot(point(i + 1).cross(point(i + 2))) / 6.0;
    }
  }
  return 1e9 * volume_m3;
}

/// Volume of the shown bone after each message of a recording [mm³].
inline std::vector<double> BoneVolumes(const std::filesystem::path& recording) {
  std::vector<double> volumes_mm3;
  Shown shown;
  for (const foxglove::SceneUpdate& state : BoneStates(recording)) {
    Show(state, shown);
    volumes_mm3.push_back(VolumeOf(shown));
  }
  return volumes_mm3;
}

}  // namespace osteon::session
