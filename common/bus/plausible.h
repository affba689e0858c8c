#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "roundabout_msgs/agent_tracks_t.hpp"
#include "roundabout_msgs/fleet_status_t.hpp"
#include "roundabout_msgs/image_t.hpp"
#include "roundabout_msgs/mission_t.hpp"
#include "roundabout_msgs/occupancy_t.hpp"
#include "roundabout_msgs/planar_lidar_t.hpp"
#include "roundabout_msgs/planner_status_t.hpp"
#include "roundabout_msgs/vehicle_states_t.hpp"

namespace roundabout::bus {

/// LCM writes integers big-endian.
inline std::uint64_t bigEndian(std::span<const std::byte> bytes, std::size_t offset,
                               std::size_t size) {
  std::uint64_t value = 0;
  for (std::size_t i = 0; i < size; ++i) {
    value = (value << 8) | std::to_integer<std::uint64_t>(bytes[offset + i]);
  }
  return value;
}

/// The first eight bytes of every LCM message. Precondition: there are eight.
inline std::uint64_t fingerprintOf(std::span<const std::byte> payload) {
  return bigEndian(payload, 0, 8);
}

/// Where a type's element counts stand, counted from the start of the payload, and how many bytes
/// an element has at least (lcmtypes/README.md: counts come first). Types without variable arrays
/// have none.
struct CountField {
  std::size_t offset;
  std::size_t min_element_bytes;
};

template <class Message>
inline constexpr std::span<const CountField> kCountFields{};

namespace count_fields {
inline constexpr CountField kVehicleStates[] = {{32, 119}};
inline constexpr CountField kPlannerStatus[] = {{16, 4}};
inline constexpr CountField kMission[] = {{16, 24}};
inline constexpr CountField kPlanarLidar[] = {{16, 4}};  // and one behind the first array
inline constexpr CountField kAgentTracks[] = {{16, 85}};
inline constexpr CountField kOccupancy[] = {{16, 1}};
inline constexpr CountField kImage[] = {{32, 1}};  // and more behind the first array
inline constexpr CountField kFleetStatus[] = {{16, 48}, {20, 5}};
}  // namespace count_fields

template <>
inline constexpr std::span<const CountField> kCountFields<roundabout_msgs::vehicle_states_t>{
    count_fields::kVehicleStates};
template <>
inline constexpr std::span<const CountField> kCountFields<roundabout_msgs::planner_status_t>{
    count_fields::kPlannerStatus};
template <>
inline constexpr std::span<const CountField> kCountFields<roundabout_msgs::mission_t>{
    count_fields::kMission};
template <>
inline constexpr std::span<const CountField> kCountFields<roundabout_msgs::fleet_status_t>{
    count_fields::kFleetStatus};

template <>
inline constexpr std::span<const CountField> kCountFields<roundabout_msgs::planar_lidar_t>{
    count_fields::kPlanarLidar};

template <>
inline constexpr std::span<const CountField> kCountFields<roundabout_msgs::agent_tracks_t>{
    count_fields::kAgentTracks};
template <>
inline constexpr std::span<const CountField> kCountFields<roundabout_msgs::occupancy_t>{
    count_fields::kOccupancy};
template <>
inline constexpr std::span<const CountField> kCountFields<roundabout_msgs::image_t>{
    count_fields::kImage};

/// True if every count could fit into the payload.
template <class Message>
bool plausibleCounts(std::span<const std::byte> payload) {
  for (const CountField& field : kCountFields<Message>) {
    if (payload.size() < field.offset + 4) {
      return false;
    }
    const std::uint64_t count = bigEndian(payload, field.offset, 4);
    if (count * field.min_element_bytes > payload.size()) {
      return false;
    }
  }
  return true;
}

/// The layout is libbot2's: where the second count stands depends on the first.
template <>
inline bool plausibleCounts<roundabout_msgs::planar_lidar_t>(std::span<const std::byte> payload) {
  std::uint64_t offset = count_fields::kPlanarLidar[0].offset;
  for (int array = 0; array < 2; ++array) {
    if (payload.size() < offset + 4) {
      return false;
    }
    const std::uint64_t count = bigEndian(payload, static_cast<std::size_t>(offset), 4);
    offset += 4 + count * sizeof(float);
  }
  return offset <= payload.size();
}

/// The layout is libbot2's: the counts of the metadata stand one behind the other.
template <>
inline bool plausibleCounts<roundabout_msgs::image_t>(std::span<const std::byte> payload) {
  std::uint64_t offset = count_fields::kImage[0].offset;
  // Moves behind a count and so many bytes; false at the end of the payload.
  const auto skip = [&] {
    if (payload.size() < offset + 4) {
      return false;
    }
    offset += 4 + bigEndian(payload, static_cast<std::size_t>(offset), 4);
    return offset <= payload.size();
  };
  if (!skip() || payload.size() < offset + 4) {
    return false;
  }
  const std::uint64_t entries = bigEndian(payload, static_cast<std::size_t>(offset), 4);
  offset += 4;
  for (std::uint64_t i = 0; i < entries; ++i) {
    if (!skip() || !skip()) {  // key, value
      return false;
    }
  }
  return true;
}

}  // namespace roundabout::bus
