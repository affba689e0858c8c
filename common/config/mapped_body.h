#pragma once

#include <cstdint>
#include <string>

#include "common/config/experiment.h"

namespace roundabout::config {

/// By what a motion-capture system's body is known: its name or its streaming id.
struct BodyKey {
  std::string name;  ///< empty: by id
  int id = -1;       ///< negative: by name
  bool operator==(const BodyKey&) const = default;
};

/// For people: "Hex_1", or "id 4" of a body without a name.
inline std::string bodyText(const std::string& name, std::int64_t id) {
  return name.empty() ? "id " + std::to_string(id) : name;
}
inline std::string text(const BodyKey& key) { return bodyText(key.name, key.id); }

/// True if a body with that name and streaming id is the one that is wanted.
inline bool matches(const BodyKey& key, const std::string& name, std::int64_t id) {
  return key.name.empty() ? id == key.id : name == key.name;
}

/// What mocap.bodies says of a vehicle, or nullptr.
inline const MocapBody* mocapBodyOf(const Mocap& mocap, const std::string& vehicle) {
  for (const MocapBody& body : mocap.bodies) {
    if (body.vehicle == vehicle) {
      return &body;
    }
  }
  return nullptr;
}

/// The body that is a vehicle: that of mocap.bodies, or one with the vehicle's name.
inline BodyKey bodyKeyOf(const Mocap& mocap, const std::string& vehicle) {
  const MocapBody* body = mocapBodyOf(mocap, vehicle);
  if (body == nullptr || (body->body.empty() && body->id < 0)) {
    return {vehicle, -1};
  }
  return {body->body, body->body.empty() ? body->id : -1};
}

}  // namespace roundabout::config
