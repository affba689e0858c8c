#include <limits>

#include <gtest/gtest.h>

#include "common/bus/messages.h"
#include "common/bus/typed.h"
#include "tests/common/bus/sample_messages.h"

namespace roundabout::bus {
namespace {

const double kNotNumbers[] = {std::numeric_limits<double>::quiet_NaN(),
                              std::numeric_limits<double>::infinity(),
                              -std::numeric_limits<double>::infinity()};

TEST(SensorMessages, TracksSurviveTheWire) {
  const auto message = sample<roundabout_msgs::agent_tracks_t>();
  core::AgentTracks tracks;
  int left_out = -1;
  ASSERT_EQ(fromMessage(message, tracks, left_out), nullptr);
  EXPECT_EQ(left_out, 0);
  ASSERT_EQ(tracks.tracks.size(), 2u);
  EXPECT_EQ(tracks.tracks[1].position_world_m, Eigen::Vector2d(1.5, 0.5));
  EXPECT_EQ(tracks.tracks[0].agent_class, core::AgentClass::kPedestrian);
  EXPECT_EQ(tracks.health, core::PerceptionHealth::kDegraded);
  EXPECT_EQ(encode(toMessage(tracks)), encode(message));
}

TEST(SensorMessages, ABrokenTrackIsLeftOutAndHidesNobodyElse) {
  using Track = roundabout_msgs::agent_track_t;
  const auto breaks = {
      +[](Track& track, double value) { track.position[1] = value; },
      +[](Track& track, double value) { track.velocity[0] = value; },
      +[](Track& track, double value) { track.radius = value; },
      +[](Track& track, double value) { track.position_deviation = value; },
      +[](Track& track, double value) { track.unseen = value; },
      +[](Track& track, double) { track.radius = 0.0; },
      +[](Track& track, double) { track.velocity_deviation = -0.1; },
      +[](Track& track, double) { track.agent_class = 4; },
      +[](Track& track, double) { track.agent_class = -1; },
      +[](Track& track, double) { track.id = 2'000'000'000; },
      +[](Track& track, double) { track.id = -200'000; },
  };
  for (const auto& breakIt : breaks) {
    for (const double value : kNotNumbers) {
      auto message = sample<roundabout_msgs::agent_tracks_t>();
      breakIt(message.tracks[0], value);
      core::AgentTracks tracks;
      int left_out = 0;
      ASSERT_EQ(fromMessage(message, tracks, left_out), nullptr);
      EXPECT_EQ(left_out, 1);
      ASSERT_EQ(tracks.tracks.size(), 1u);
      EXPECT_EQ(tracks.tracks[0].id, 18);
    }
  }
}

TEST(SensorMessages, TracksOfAnUnknownHealthOrTooManyAreRefused) {
  auto message = sample<roundabout_msgs::agent_tracks_t>();
  core::AgentTracks tracks;
  int left_out = 0;
  message.health = 3;
  EXPECT_STREQ(fromMessage(message, tracks, left_out), "unknown health");
  message = sample<roundabout_msgs::agent_tracks_t>();
  message.num_tracks = kMostTracks + 1;
  message.tracks.resize(static_cast<std::size_t>(message.num_tracks));
  EXPECT_STREQ(fromMessage(message, tracks, left_out), "more tracks than anybody follows");
}

TEST(SensorMessages, AnImageSurvivesTheWire) {
  auto message = sample<roundabout_msgs::image_t>();
  message.nmetadata = 0;
  message.metadata.clear();
  core::JpegImage image;
  ASSERT_EQ(fromMessage(message, image), nullptr);
  EXPECT_EQ(image.width, 320);
  EXPECT_EQ(encode(toMessage(image)), encode(message));
}

TEST(SensorMessages, WhatIsNoJpegIsRefused) {
  core::JpegImage image;
  auto message = sample<roundabout_msgs::image_t>();
  message.pixelformat = roundabout_msgs::image_t::PIXEL_FORMAT_RGB;
  EXPECT_STREQ(fromMessage(message, image), "not a JPEG");
  for (const int width : {0, -1, 100'000}) {
    message = sample<roundabout_msgs::image_t>();
    message.width = width;
    EXPECT_STREQ(fromMessage(message, image), "a size that no camera has");
  }
  message = sample<roundabout_msgs::image_t>();
  message.data[0] = 0;
  EXPECT_STREQ(fromMessage(message, image), "does not begin like a JPEG");
  message.data.clear();
  message.size = 0;
  EXPECT_STREQ(fromMessage(message, image), "does not begin like a JPEG");
}

TEST(SensorMessages, DepthsSurviveTheWireLowByteFirst) {
  const core::DepthImage sent{5, 3, 2, {0, 1, 255, 256, 4000, 65'535}};
  const roundabout_msgs::image_t message = toMessage(sent);
  EXPECT_EQ(message.pixelformat, 'L' | 'G' << 8 | '1' << 16 | '6' << 24);
  EXPECT_EQ(message.row_stride, 6);
  EXPECT_EQ(message.size, 12);
  EXPECT_EQ(message.data[6], 0);
  EXPECT_EQ(message.data[7], 1);
  core::DepthImage heard;
  ASSERT_EQ(fromMessage(message, heard), nullptr);
  EXPECT_EQ(heard.depth_mm, sent.depth_mm);
  EXPECT_EQ(encode(toMessage(heard)), encode(message));
}

TEST(SensorMessages, WhatIsNoDepthPictureIsRefused) {
  const roundabout_msgs::image_t good = toMessage(core::DepthImage{5, 3, 2, {0, 1, 2, 3, 4, 5}});
  core::DepthImage image;
  auto message = good;
  message.pixelformat = roundabout_msgs::image_t::PIXEL_FORMAT_MJPEG;
  EXPECT_STREQ(fromMessage(message, image),
               "not a depth picture (16 bits of grey a pixel, little-endian)");
  core::JpegImage colour;
  EXPECT_STREQ(fromMessage(good, colour), "not a JPEG");
  for (const int height : {0, -2, 1 << 30}) {
    message = good;
    message.height = height;
    EXPECT_STREQ(fromMessage(message, image), "a size that no camera has");
  }
  for (const int stride : {0, 3, 8, -6}) {
    message = good;
    message.row_stride = stride;
    EXPECT_STREQ(fromMessage(message, image), "rows that are not two bytes a pixel long");
  }
  for (const std::size_t size : {0U, 11U, 13U, 24U}) {
    message = good;
    message.data.resize(size);
    EXPECT_STREQ(fromMessage(message, image), "another number of bytes than its rows have");
  }
}

TEST(SensorMessages, AMapAndOdometrySurviveTheWire) {
  const auto map_message = sample<roundabout_msgs::occupancy_t>();
  core::OccupancyMap map;
  ASSERT_EQ(fromMessage(map_message, map), nullptr);
  EXPECT_EQ(map.resolution_m, 0.0625);
  EXPECT_EQ(encode(toMessage(map)), encode(map_message));
  const auto odometry_message = sample<roundabout_msgs::odometry_t>();
  core::Odometry odometry;
  ASSERT_EQ(fromMessage(odometry_message, odometry), nullptr);
  EXPECT_EQ(odometry.speed_mps, 1.25);
  EXPECT_EQ(encode(toMessage(odometry)), encode(odometry_message));
}

TEST(SensorMessages, AMapOrOdometryThatIsNotFiniteIsRefused) {
  for (const double value : kNotNumbers) {
    core::OccupancyMap map;
    auto map_message = sample<roundabout_msgs::occupancy_t>();
    map_message.resolution = value;
    EXPECT_STREQ(fromMessage(map_message, map), "a resolution that is not positive");
    core::Odometry odometry;
    auto odometry_message = sample<roundabout_msgs::odometry_t>();
    odometry_message.position[1] = value;
    EXPECT_STREQ(fromMessage(odometry_message, odometry), "not a finite number");
  }
}

}  // namespace
}  // namespace roundabout::bus
