#include "perception/perception_core.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <spdlog/fmt/fmt.h>

#include "common/config/depth_age.h"
#include "common/core/error.h"
#include "perception/clustering/table.h"
#include "perception/vision/jpeg_size.h"

namespace roundabout::perception {

namespace {

constexpr double kBlindAfter_s = 0.3;
constexpr double kBlindRate_hz = 10.0;
// Whom it has not seen for so long yet it may not have believed: nobody is no news.
constexpr double kBeginning_s = 0.3;
// More wait only while poses are missing.
constexpr std::size_t kMostWaiting = 16;
constexpr std::size_t kMostLooking = 8;
// What depth cameras see so near to an agent's body is a part of it, or of what it carries.
constexpr double kAroundAgent_m = 0.2;
// Beams without an echo clear the map up to here.
constexpr double kFreeRange_m = 6.0;
// A track nearer than this to another vehicle's middle is that vehicle.
constexpr double kAtVehicle_m = 0.3;
// A camera is silent after a second, or so many of its periods: one picture may be lost.
constexpr double kSilent_s = 1.0;
constexpr double kFewestSilentPeriods = 2.5;
constexpr double kMostSilentPeriods = 5.0;
// Of a picture's time stamp to the newest pose: poses and pictures come on ways of their own.
constexpr double kMostAhead_s = 0.5;
// Poses are remembered so much longer than pictures wait.
constexpr double kLongerThanDelay_s = 2.0;
constexpr double kManyUnusable = 0.1;
// A depth picture of which less was measured shows nothing: a covered lens, a dead projector.
constexpr double kLeastMeasured = 0.05;
constexpr double kRoomMargin_m = 1.0;

/// Of a picture's exposure, to what is known at a time.
bool isAhead(core::Utime exposure, core::Utime now) {
  return exposure > now + core::toUtime(kMostAhead_s);
}

std::size_t indexOf(const config::Experiment& experiment, const std::string& name) {
  for (std::size_t i = 0; i < experiment.vehicles.size(); ++i) {
    if (experiment.vehicles[i].name == name) {
      if (!experiment.vehicles[i].lidar) {
        throw core::StartupError(experiment.file, fmt::format("vehicles[{}].lidar", i),
                                 "one, since perception is asked for", "none");
      }
      return i;
    }
  }
  throw core::StartupError(experiment.file, "--vehicle", "a vehicle of the experiment",
                           "\"" + name + "\"");
}

config::Perception limitedBy(config::Perception settings, const config::Lidar& lidar) {
  settings.max_range_m = std::min(settings.max_range_m, lidar.max_range_m);
  return settings;
}

Eigen::AlignedBox2d boundsOf(const config::Room& room) {
  const Eigen::Vector2d margin = Eigen::Vector2d::Constant(kRoomMargin_m);
  return {room.min_m.head<2>() - margin, room.max_m.head<2>() + margin};
}

/// How many depth pictures wait until they count, for poses and sweeps that are late, and for the
/// map.
std::size_t mostDepths(const config::Vehicle& vehicle, const config::Perception& perception) {
  const double waiting_s =
      perception.image_delay_s + kLongerThanDelay_s + 1.0 / perception.map_rate_hz;
  double most = 0.0;
  for (const config::Camera& camera : vehicle.cameras) {
    const double period_s = std::max(perception.image_period_s, 1.0 / camera.rate_hz);
    most += camera.depth ? std::ceil(waiting_s / period_s) + 1.0 : 0.0;
  }
  return static_cast<std::size_t>(most);
}

bool measuredSomething(const core::DepthImage& image, const config::DepthSensing& sensing) {
  const auto measured =
      std::count_if(image.depth_mm.begin(), image.depth_mm.end(), [&](std::uint16_t depth_mm) {
        return depth_mm >= 1000.0 * sensing.nearest_m && depth_mm <= 1000.0 * sensing.farthest_m;
      });
  return static_cast<double>(measured) >=
         kLeastMeasured * static_cast<double>(image.depth_mm.size());
}

}  // namespace

PerceptionCore::PerceptionCore(const config::Experiment& experiment, const std::string& vehicle,
                               std::unique_ptr<PersonDetector> detector)
    : experiment_(experiment),
      own_index_(indexOf(experiment, vehicle)),
      detector_(std::move(detector)),
      finder_(limitedBy(experiment.perception, *experiment.vehicles[own_index_].lidar),
              makeClusterer(experiment.perception.clusterer, experiment.file)),
      mapper_(experiment.perception.map_resolution_m, boundsOf(experiment.room)),
      map_timer_(experiment.perception.map_rate_hz),
      publish_timer_(experiment.perception.map_publish_hz),
      blind_timer_(kBlindRate_hz),
      poses_({experiment.vehicles[own_index_].top_speed_mps, experiment.safety.jump_margin_m,
              experiment.safety.max_rejects_in_a_row,
              experiment.perception.image_delay_s + kLongerThanDelay_s}) {
  vehicle_ = experiment.vehicles[own_index_];
  newest_image_.resize(vehicle_.cameras.size(), 0);
  last_image_.resize(vehicle_.cameras.size(), 0);
  newest_depths_.resize(vehicle_.cameras.size(), 0);
  shown_depths_.resize(vehicle_.cameras.size(), 0);
  most_depths_ = mostDepths(vehicle_, experiment_.perception);
}

PerceptionCore::~PerceptionCore() = default;  // futures wait

const char* PerceptionCore::onFrame(const core::StatesFrame& frame) {
  const core::FrameVerdict verdict = frames_.judge(frame.utime);
  if (verdict == core::FrameVerdict::kRefused) {
    ++rejected_.poses;
    return "its time stamp is old, or corrupt";
  }
  if (verdict == core::FrameVerdict::kNewEpoch) {
    poses_.clear();
    beginEpoch();
  }
  const char* reason = nullptr;
  others_.clear();
  const core::VehicleState* own = nullptr;
  for (const core::VehicleState& state : frame.vehicles) {
    if (state.name == vehicle_.name) {
      own = &state;
    } else if (state.tracked) {
      others_.push_back(state);
    }
  }
  if (own == nullptr || !own->tracked) {
    ++rejected_.poses;
    reason = "the own vehicle is not tracked";
  } else {
    const PlanarPose pose{own->position_world_m.head<2>(), core::headingOf(own->orientation)};
    switch (poses_.add(frame.utime, pose)) {
      case PoseHistory::Verdict::kAccepted:
        last_own_pose_ = frame.utime;
        break;
      case PoseHistory::Verdict::kRejected:
        ++rejected_.poses;
        reason = "the own vehicle cannot have moved so far";
        break;
      case PoseHistory::Verdict::kJumped:
        ++rejected_.poses;
        last_own_pose_ = frame.utime;
        forget();
        reason = "the own vehicle is elsewhere; tracks and map are forgotten";
        break;
    }
  }
  useScans();
  if (core::toSeconds(frame.utime - last_used_scan_) > kBlindAfter_s &&
      blind_timer_.due(frame.utime)) {
    sayBlind(frame.utime);
  }
  return reason;
}

const char* PerceptionCore::onScan(const core::LaserScan& scan) {
  if (const char* reason = scans_.judge(scan)) {
    ++rejected_.scans;
    return reason;
  }
  if (scans_.newEpoch()) {
    beginEpoch();
  }
  waiting_.push_back(scan);
  if (waiting_.size() > kMostWaiting) {
    waiting_.pop_front();
    ++rejected_.scans;
    return "there is no pose of its time";
  }
  useScans();
  return nullptr;
}

const char* PerceptionCore::judgeImage(std::size_t camera, core::Utime exposure, int width,
                                       int height) {
  const config::Camera& settings = vehicle_.cameras[camera];
  if (width != settings.width || height != settings.height) {
    ++rejected_.images;
    return "another size than its camera's in the experiment file";
  }
  const bool can_judge = !poses_.empty();
  if (can_judge && isAhead(exposure, poses_.newest())) {
    ++rejected_.images;
    return "its time stamp is ahead of the poses";
  }
  // One from before the first pose may have been of any time.
  const bool last_is_true = !can_judge || !isAhead(last_image_[camera], poses_.newest());
  if (last_is_true && exposure <= last_image_[camera]) {
    ++rejected_.images;
    return "its time stamp is old";
  }
  last_image_[camera] = exposure;
  return nullptr;
}

bool PerceptionCore::isDue(std::size_t camera, core::Utime exposure) {
  const core::Utime period = core::toUtime(experiment_.perception.image_period_s);
  return exposure / period != std::exchange(newest_image_[camera], exposure) / period;
}

const char* PerceptionCore::onImage(std::size_t camera, const core::JpegImage& image) {
  const auto size = jpegSize(image.jpeg);
  if (!size || *size != PictureSize{image.width, image.height}) {
    ++rejected_.images;
    return size ? "its JPEG is of another size than it says" : "it is no JPEG, or cut off";
  }
  if (const char* reason = judgeImage(camera, image.utime, image.width, image.height)) {
    return reason;
  }
  if (!detector_ || looking_.size() >= kMostLooking || !isDue(camera, image.utime)) {
    return nullptr;
  }
  looking_.push_back(
      {camera, image.utime, std::async(std::launch::async, [this, jpeg = image.jpeg] {
         const std::lock_guard one_at_a_time(detector_mutex_);
         return detector_->detect(jpeg);
       })});
  return nullptr;
}

const char* PerceptionCore::onDepths(std::size_t camera, const core::DepthImage& image) {
  if (const char* reason = judgeImage(camera, image.utime, image.width, image.height)) {
    return reason;
  }
  if (!isDue(camera, image.utime)) {
    return nullptr;
  }
  // Those that wait longest are the next to count: dropped, none ever would.
  if (waiting_depths_.size() >= most_depths_) {
    ++rejected_.images;
    return "more come than its camera's rate_hz says, or no scan does";
  }
  waiting_depths_.push_back({camera, image});
  return nullptr;
}

std::optional<core::AgentTracks> PerceptionCore::takeTracks() {
  if (tracks_out_.empty()) {
    return std::nullopt;
  }
  core::AgentTracks tracks = std::move(tracks_out_.front());
  tracks_out_.pop_front();
  return tracks;
}

std::optional<core::OccupancyMap> PerceptionCore::takeMap() {
  return std::exchange(map_out_, std::nullopt);
}

bool PerceptionCore::saveMap() {
  waitForMap();
  const std::string& path = experiment_.perception.map_file;
  return path.empty() || mapper_.save(path);
}

void PerceptionCore::useScans() {
  while (!waiting_.empty() && waiting_.front().utime <= poses_.newest()) {
    const core::LaserScan scan = std::move(waiting_.front());
    waiting_.pop_front();
    const std::optional<PlanarPose> end = poses_.at(scan.utime);
    const core::Utime sweep = core::toUtime(vehicle_.lidar->sweep_s);
    const std::optional<PlanarPose> begin = poses_.at(scan.utime - sweep);
    if (!end || scan.utime <= last_used_scan_) {
      ++rejected_.scans;
    } else {
      useScan(scan, begin.value_or(*end), *end);
    }
  }
}

void PerceptionCore::useScan(const core::LaserScan& scan, const PlanarPose& begin,
                             const PlanarPose& end) {
  // After it was blind nobody is believed at first sight, as at the start.
  if (core::toSeconds(scan.utime - last_used_scan_) > kBlindAfter_s) {
    first_used_scan_ = scan.utime;
  }
  last_used_scan_ = scan.utime;
  const int unusable = finder_.update(scan, begin, end, cells_.get());
  rejected_.ranges += unusable;
  many_unusable_ = unusable > kManyUnusable * static_cast<double>(scan.ranges_m.size());
  markVehicles();
  useBoxes(scan.utime);
  useDepths(scan.utime);
  core::AgentTracks& tracks = tracks_out_.emplace_back();
  tracks.utime = scan.utime;
  tracks.vehicle = vehicle_.name;
  tracks.tracks = finder_.tracker().tracks();
  tracks.rejected = rejected_;
  judgeHealth(tracks);
  updateMap(scan.utime);
}

void PerceptionCore::useBoxes(core::Utime now) {
  const core::Utime delay = core::toUtime(experiment_.perception.image_delay_s);
  rejected_.images += static_cast<std::int64_t>(std::erase_if(
      looking_, [this](const Looking& each) { return isAhead(each.exposure, poses_.newest()); }));
  while (!looking_.empty() && looking_.front().exposure + delay <= now) {
    const auto boxes = looking_.front().boxes.get();
    const config::Camera& camera = vehicle_.cameras[looking_.front().camera];
    const std::optional<PlanarPose> pose = poses_.at(looking_.front().exposure);
    if (!boxes) {
      ++rejected_.images;
    } else {
      boxes_[camera.name] = *boxes;
      if (pose) {
        fuseBoxes(camera, *pose, *boxes, finder_.tracker().all());
      }
    }
    looking_.pop_front();
  }
}

void PerceptionCore::useDepths(core::Utime now) {
  const core::Utime delay = core::toUtime(experiment_.perception.image_delay_s);
  const core::Utime believed_from = first_used_scan_ + core::toUtime(kBeginning_s);
  rejected_.images +=
      static_cast<std::int64_t>(std::erase_if(waiting_depths_, [this](const Depths& each) {
        return isAhead(each.image.utime, poses_.newest());
      }));
  while (!waiting_depths_.empty() && waiting_depths_.front().image.utime + delay <= now) {
    Depths depths = std::move(waiting_depths_.front());
    waiting_depths_.pop_front();
    const core::Utime exposure = depths.image.utime;
    const std::optional<PlanarPose> pose = poses_.at(exposure);
    if (!pose) {
      ++rejected_.images;
    } else if (exposure >= believed_from) {
      if (views_.size() == most_depths_) {
        views_.erase(views_.begin());
        ++rejected_.images;
      }
      if (measuredSomething(depths.image, *vehicle_.cameras[depths.camera].depth)) {
        newest_depths_[depths.camera] = exposure;
      }
      views_.push_back({std::move(depths.image), vehicle_.cameras[depths.camera], *pose,
                        agentsAt(exposure, now)});
    }
  }
}

/// Everybody who may be an agent, and other vehicles that are not above all that is mapped, where
/// they were a moment ago.
std::vector<KeptOut> PerceptionCore::agentsAt(core::Utime utime, core::Utime now) const {
  const config::Perception& settings = experiment_.perception;
  const double ago_s = core::toSeconds(now - utime);
  std::vector<KeptOut> agents;
  for (const Track& track : finder_.tracker().all()) {
    const bool stands = finder_.tracker().classOf(track) == core::AgentClass::kStatic;
    const double least_m = stands ? settings.least_radius_m : settings.person_radius_m;
    agents.push_back({track.filter.position() - ago_s * track.filter.velocity(),
                      std::max(least_m, track.half_width_m) + kAroundAgent_m});
  }
  for (const core::VehicleState& other : others_) {
    const auto known =
        std::find_if(experiment_.vehicles.begin(), experiment_.vehicles.end(),
                     [&](const config::Vehicle& vehicle) { return vehicle.name == other.name; });
    const double radius_m =
        known == experiment_.vehicles.end() ? kAtVehicle_m : known->body_radius_m;
    if (other.position_world_m.z() - radius_m <= settings.depth_highest_m) {
      agents.push_back(
          {other.position_world_m.head<2>() - ago_s * other.velocity_world_mps.head<2>(),
           radius_m + kAroundAgent_m});
    }
  }
  return agents;
}

void PerceptionCore::updateMap(core::Utime now) {
  if (!map_timer_.due(now)) {
    return;
  }
  waitForMap();
  mapping_ = std::async(
      std::launch::async,
      [this, now, publish = publish_timer_.due(now), update = mapUpdateOf(finder_, kFreeRange_m),
       views = std::exchange(views_, {}), newest_depths = newest_depths_] {
        const config::Perception& settings = experiment_.perception;
        mapper_.insert(update);
        for (const DepthView& view : views) {
          mapper_.insert(depthUpdateOf(view, {settings.depth_lowest_m, settings.depth_highest_m},
                                       settings.map_resolution_m));
        }
        Mapped mapped{mapper_.cells(), {}, newest_depths};
        if (publish) {
          mapped.map = core::OccupancyMap{
              now, vehicle_.name, experiment_.perception.map_resolution_m, mapper_.binaryTree()};
        }
        return mapped;
      });
}

void PerceptionCore::waitForMap() {
  if (mapping_.valid()) {
    Mapped mapped = mapping_.get();
    cells_ = std::move(mapped.cells);
    if (mapped.map) {
      map_out_ = std::move(mapped.map);
      shown_depths_ = std::move(mapped.newest_depths);
    }
  }
}

void PerceptionCore::markVehicles() {
  for (Track& track : finder_.tracker().all()) {
    track.vehicle =
        std::any_of(others_.begin(), others_.end(), [&](const core::VehicleState& other) {
          return (other.position_world_m.head<2>() - track.filter.position()).norm() < kAtVehicle_m;
        });
  }
}

void PerceptionCore::sayBlind(core::Utime now) {
  core::AgentTracks& tracks = tracks_out_.emplace_back();
  tracks.utime = now;
  tracks.vehicle = vehicle_.name;
  tracks.health = core::PerceptionHealth::kBlind;
  tracks.reason = core::toSeconds(now - last_own_pose_) > kBlindAfter_s
                      ? "the own vehicle's pose is not known"
                  : scans_.last() == 0 ? "no laser scan yet"
                                       : "no usable laser scan for 0.3 s";
  tracks.rejected = rejected_;
}

void PerceptionCore::judgeHealth(core::AgentTracks& tracks) const {
  if (core::toSeconds(tracks.utime - first_used_scan_) < kBeginning_s) {
    tracks.health = core::PerceptionHealth::kBlind;
    tracks.reason = "it has only begun to look";
    return;
  }
  if (many_unusable_) {
    tracks.health = core::PerceptionHealth::kDegraded;
    tracks.reason = "more than a tenth of the ranges unusable";
  }
  for (std::size_t i = 0; i < vehicle_.cameras.size(); ++i) {
    const config::Camera& camera = vehicle_.cameras[i];
    if (!camera.depth) {
      if (detector_ && !isHeard(i, tracks.utime)) {
        tracks.health = core::PerceptionHealth::kDegraded;
        tracks.reason = fmt::format("camera {} is silent", camera.name);
      }
    } else if (const char* fault = faultOfDepths(i, tracks.utime)) {
      // What only its depths would have shown is in nobody's way: the robot must not drive on.
      tracks.health = core::PerceptionHealth::kBlind;
      tracks.reason = fmt::format("depth camera {} {}", camera.name, fault);
      return;
    }
  }
}

bool PerceptionCore::isHeard(std::size_t camera, core::Utime now) const {
  const core::Utime last = last_image_[camera];
  const double period_s = 1.0 / vehicle_.cameras[camera].rate_hz;
  return !isAhead(last, poses_.newest()) &&
         core::toSeconds(now - last) <=
             std::clamp(kSilent_s, kFewestSilentPeriods * period_s, kMostSilentPeriods * period_s);
}

const char* PerceptionCore::faultOfDepths(std::size_t camera, core::Utime now) const {
  if (!isHeard(camera, now)) {
    return "is silent";
  }
  if (shown_depths_[camera] == 0) {
    return "has no picture in the map yet";
  }
  const double oldest_s =
      config::oldestDepthsS(vehicle_, vehicle_.cameras[camera], experiment_.perception);
  return core::toSeconds(now - shown_depths_[camera]) > oldest_s ? "has shown nothing for too long"
                                                                 : nullptr;
}

void PerceptionCore::beginEpoch() {
  forget();
  std::fill(newest_image_.begin(), newest_image_.end(), 0);
  std::fill(last_image_.begin(), last_image_.end(), 0);
  map_timer_ = core::TickTimer(experiment_.perception.map_rate_hz);
  publish_timer_ = core::TickTimer(experiment_.perception.map_publish_hz);
  blind_timer_ = core::TickTimer(kBlindRate_hz);
}

void PerceptionCore::forget() {
  waitForMap();
  mapper_.clear();
  map_out_.reset();
  cells_.reset();
  finder_.forget();
  waiting_.clear();
  looking_.clear();
  waiting_depths_.clear();
  views_.clear();
  boxes_.clear();
  std::fill(newest_depths_.begin(), newest_depths_.end(), 0);
  std::fill(shown_depths_.begin(), shown_depths_.end(), 0);
  last_used_scan_ = 0;
  first_used_scan_ = 0;
}

}  // namespace roundabout::perception
