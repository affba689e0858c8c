// What robots see: tracks, images, maps and odometry.

#include <algorithm>
#include <cmath>
#include <iterator>

#include "common/bus/messages.h"

namespace roundabout::bus {

namespace {

constexpr int kMostPixelsPerSide = 8192;
// Whoever adds a million to keep them apart from vehicles can. Negative ones are vehicles in the
// simulator's truth.
constexpr int kLargestTrackId = 1'000'000'000;
constexpr int kSmallestTrackId = -100'000;
constexpr std::uint8_t kJpegStart[] = {0xFF, 0xD8};

Eigen::Vector2d vectorOf(const double (&values)[2]) { return {values[0], values[1]}; }

void copyTo(double (&target)[2], const Eigen::Vector2d& source) {
  target[0] = source.x();
  target[1] = source.y();
}

bool isCameraSize(const roundabout_msgs::image_t& message) {
  return message.width >= 1 && message.height >= 1 && message.width <= kMostPixelsPerSide &&
         message.height <= kMostPixelsPerSide;
}

bool isUsable(const roundabout_msgs::agent_track_t& track) {
  const double values[] = {
      track.confidence,  track.position[0], track.position[1],        track.velocity[0],
      track.velocity[1], track.radius,      track.position_deviation, track.velocity_deviation,
      track.age,         track.unseen};
  return track.id >= kSmallestTrackId && track.id <= kLargestTrackId &&
         std::all_of(std::begin(values), std::end(values),
                     [](double value) { return std::isfinite(value); }) &&
         track.radius > 0.0 && track.position_deviation >= 0.0 && track.velocity_deviation >= 0.0 &&
         track.unseen >= 0.0 && track.agent_class >= roundabout_msgs::agent_track_t::UNKNOWN &&
         track.agent_class <= roundabout_msgs::agent_track_t::STATIC;
}

roundabout_msgs::agent_track_t toMessage(const core::AgentTrack& track) {
  roundabout_msgs::agent_track_t message;
  message.id = track.id;
  message.agent_class = static_cast<std::int8_t>(track.agent_class);
  message.confidence = track.confidence;
  copyTo(message.position, track.position_world_m);
  copyTo(message.velocity, track.velocity_world_mps);
  message.radius = track.radius_m;
  message.position_deviation = track.position_deviation_m;
  message.velocity_deviation = track.velocity_deviation_mps;
  message.age = track.age_s;
  message.unseen = track.unseen_s;
  return message;
}

core::AgentTrack fromMessage(const roundabout_msgs::agent_track_t& message) {
  return {message.id,
          static_cast<core::AgentClass>(message.agent_class),
          message.confidence,
          vectorOf(message.position),
          vectorOf(message.velocity),
          message.radius,
          message.position_deviation,
          message.velocity_deviation,
          message.age,
          message.unseen};
}

}  // namespace

roundabout_msgs::agent_tracks_t toMessage(const core::AgentTracks& tracks) {
  roundabout_msgs::agent_tracks_t message;
  message.utime = tracks.utime;
  message.num_tracks = static_cast<std::int32_t>(tracks.tracks.size());
  for (const core::AgentTrack& track : tracks.tracks) {
    message.tracks.push_back(toMessage(track));
  }
  message.vehicle = tracks.vehicle;
  message.health = static_cast<std::int8_t>(tracks.health);
  message.reason = tracks.reason;
  message.rejected_scans = tracks.rejected.scans;
  message.rejected_ranges = tracks.rejected.ranges;
  message.rejected_images = tracks.rejected.images;
  message.rejected_poses = tracks.rejected.poses;
  message.compute_time = tracks.compute_time_s;
  return message;
}

const char* fromMessage(const roundabout_msgs::agent_tracks_t& message, core::AgentTracks& tracks,
                        int& left_out) {
  if (message.health < roundabout_msgs::agent_tracks_t::GOOD ||
      message.health > roundabout_msgs::agent_tracks_t::BLIND) {
    return "unknown health";
  }
  if (message.num_tracks > kMostTracks) {
    return "more tracks than anybody follows";
  }
  tracks.utime = message.utime;
  tracks.vehicle = message.vehicle;
  tracks.health = static_cast<core::PerceptionHealth>(message.health);
  tracks.reason = message.reason;
  tracks.rejected = {message.rejected_scans, message.rejected_ranges, message.rejected_images,
                     message.rejected_poses};
  tracks.compute_time_s = message.compute_time;
  tracks.tracks.clear();
  for (const roundabout_msgs::agent_track_t& track : message.tracks) {
    if (isUsable(track)) {
      tracks.tracks.push_back(fromMessage(track));
    }
  }
  left_out = static_cast<int>(message.tracks.size() - tracks.tracks.size());
  return nullptr;
}

roundabout_msgs::image_t toMessage(const core::JpegImage& image) {
  roundabout_msgs::image_t message;
  message.utime = image.utime;
  message.width = image.width;
  message.height = image.height;
  message.row_stride = 0;
  message.pixelformat = roundabout_msgs::image_t::PIXEL_FORMAT_MJPEG;
  message.size = static_cast<std::int32_t>(image.jpeg.size());
  message.data = image.jpeg;
  message.nmetadata = 0;
  return message;
}

const char* fromMessage(const roundabout_msgs::image_t& message, core::JpegImage& image) {
  if (message.pixelformat != roundabout_msgs::image_t::PIXEL_FORMAT_MJPEG) {
    return "not a JPEG";
  }
  if (!isCameraSize(message)) {
    return "a size that no camera has";
  }
  if (message.data.size() < std::size(kJpegStart) ||
      !std::equal(std::begin(kJpegStart), std::end(kJpegStart), message.data.begin())) {
    return "does not begin like a JPEG";
  }
  image.utime = message.utime;
  image.width = message.width;
  image.height = message.height;
  image.jpeg = message.data;
  return nullptr;
}

roundabout_msgs::image_t toMessage(const core::DepthImage& image) {
  roundabout_msgs::image_t message;
  message.utime = image.utime;
  message.width = image.width;
  message.height = image.height;
  message.row_stride = 2 * image.width;
  message.pixelformat = roundabout_msgs::image_t::PIXEL_FORMAT_LE_GRAY16;
  message.size = static_cast<std::int32_t>(2 * image.depth_mm.size());
  message.data.reserve(2 * image.depth_mm.size());
  for (const std::uint16_t depth_mm : image.depth_mm) {
    message.data.push_back(static_cast<std::uint8_t>(depth_mm & 0xFFU));
    message.data.push_back(static_cast<std::uint8_t>(depth_mm >> 8));
  }
  message.nmetadata = 0;
  return message;
}

const char* fromMessage(const roundabout_msgs::image_t& message, core::DepthImage& image) {
  if (message.pixelformat != roundabout_msgs::image_t::PIXEL_FORMAT_LE_GRAY16) {
    return "not a depth picture (16 bits of grey a pixel, little-endian)";
  }
  if (!isCameraSize(message)) {
    return "a size that no camera has";
  }
  if (message.row_stride != 2 * message.width) {
    return "rows that are not two bytes a pixel long";
  }
  const auto pixels =
      static_cast<std::size_t>(message.width) * static_cast<std::size_t>(message.height);
  if (message.data.size() != 2 * pixels) {
    return "another number of bytes than its rows have";
  }
  image.utime = message.utime;
  image.width = message.width;
  image.height = message.height;
  image.depth_mm.resize(pixels);
  for (std::size_t i = 0; i < pixels; ++i) {
    image.depth_mm[i] =
        static_cast<std::uint16_t>(message.data[2 * i] | (message.data[2 * i + 1] << 8));
  }
  return nullptr;
}

roundabout_msgs::occupancy_t toMessage(const core::OccupancyMap& map) {
  roundabout_msgs::occupancy_t message;
  message.utime = map.utime;
  message.num_bytes = static_cast<std::int32_t>(map.tree.size());
  message.tree = map.tree;
  message.vehicle = map.vehicle;
  message.resolution = map.resolution_m;
  return message;
}

const char* fromMessage(const roundabout_msgs::occupancy_t& message, core::OccupancyMap& map) {
  if (!std::isfinite(message.resolution) || message.resolution <= 0.0) {
    return "a resolution that is not positive";
  }
  map = {message.utime, message.vehicle, message.resolution, message.tree};
  return nullptr;
}

roundabout_msgs::odometry_t toMessage(const core::Odometry& odometry) {
  roundabout_msgs::odometry_t message;
  message.utime = odometry.utime;
  message.vehicle = odometry.vehicle;
  copyTo(message.position, odometry.position_world_m);
  message.heading = odometry.heading_world_rad;
  message.speed = odometry.speed_mps;
  message.turn_rate = odometry.turn_rate_radps;
  return message;
}

const char* fromMessage(const roundabout_msgs::odometry_t& message, core::Odometry& odometry) {
  const double values[] = {message.position[0], message.position[1], message.heading, message.speed,
                           message.turn_rate};
  if (!std::all_of(std::begin(values), std::end(values),
                   [](double value) { return std::isfinite(value); })) {
    return "not a finite number";
  }
  odometry = {message.utime,   message.vehicle, vectorOf(message.position),
              message.heading, message.speed,   message.turn_rate};
  return nullptr;
}

}  // namespace roundabout::bus
