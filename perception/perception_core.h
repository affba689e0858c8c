#pragma once

#include <deque>
#include <future>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "common/config/experiment.h"
#include "common/core/agent_tracks.h"
#include "common/core/frame_gate.h"
#include "common/core/sensor_data.h"
#include "common/core/tick_timer.h"
#include "common/core/vehicle_state.h"
#include "perception/agent_finder.h"
#include "perception/mapping/occupancy_mapper.h"
#include "perception/pose_history.h"
#include "perception/scan/scan_gate.h"
#include "perception/vision/box_fusion.h"
#include "perception/vision/person_detector.h"

namespace roundabout::perception {

/// One vehicle's perception without wires. Time is the data's: a sweep is used as soon as a pose
/// from after it is known, boxes and depths count from perception.image_delay_s after their
/// exposure, and a map's cells from one insertion to the next. So the order in which messages of
/// different channels arrive changes nothing, and neither does how long detector and map take: they
/// work beside, and are waited for when their time has come.
class PerceptionCore {
 public:
  /// detector: nullptr: images are not looked at. Throws core::StartupError if the experiment has
  /// no such vehicle, it has no lidar, or the clusterer is unknown.
  PerceptionCore(const config::Experiment& experiment, const std::string& vehicle,
                 std::unique_ptr<PersonDetector> detector);
  ~PerceptionCore();

  /// Each returns nullptr, or why its argument was not used, in a few words, and counts that.
  const char* onFrame(const core::StatesFrame& frame);
  const char* onScan(const core::LaserScan& scan);
  const char* onImage(std::size_t camera, const core::JpegImage& image);
  const char* onDepths(std::size_t camera, const core::DepthImage& image);
  /// What could not even be decoded.
  void onBrokenScan() { ++rejected_.scans; }
  void onBrokenImage() { ++rejected_.images; }
  void onBrokenPose() { ++rejected_.poses; }

  /// What is to be said, in order of time: tracks of every sweep, or ten times a second that there
  /// are none to be had.
  std::optional<core::AgentTracks> takeTracks();
  /// perception.map_publish_hz of data time.
  std::optional<core::OccupancyMap> takeMap();
  /// Writes perception.map_file, if there is one. False if it cannot be written.
  bool saveMap();

  const config::Vehicle& vehicle() const { return vehicle_; }
  const AgentFinder& finder() const { return finder_; }
  /// nullptr: there is no map yet.
  const StaticCells* cells() const { return cells_.get(); }
  /// What the detector found last, by camera.
  const std::map<std::string, std::vector<PersonBox>>& boxes() const { return boxes_; }

 private:
  struct Looking {  // at an image
    std::size_t camera;
    core::Utime exposure;
    std::future<std::optional<std::vector<PersonBox>>> boxes;
  };

  struct Depths {  // that wait until they count
    std::size_t camera;
    core::DepthImage image;
  };

  struct Mapped {
    std::shared_ptr<const StaticCells> cells;
    std::optional<core::OccupancyMap> map;
    std::vector<core::Utime> newest_depths;  // of each camera: in it
  };

  void useScans();
  void useScan(const core::LaserScan& scan, const PlanarPose& begin, const PlanarPose& end);
  const char* judgeImage(std::size_t camera, core::Utime exposure, int width, int height);
  /// Whether it is time to look at a camera's image again; from then on it is not.
  bool isDue(std::size_t camera, core::Utime exposure);
  void useBoxes(core::Utime now);
  void useDepths(core::Utime now);
  std::vector<KeptOut> agentsAt(core::Utime utime, core::Utime now) const;
  void updateMap(core::Utime now);
  void waitForMap();
  void markVehicles();
  void sayBlind(core::Utime now);
  void judgeHealth(core::AgentTracks& tracks) const;
  bool isHeard(std::size_t camera, core::Utime now) const;
  /// Why nobody may drive by what a depth camera shows; nullptr: all is well.
  const char* faultOfDepths(std::size_t camera, core::Utime now) const;
  /// Time begins anew: nothing of what was before can be compared.
  void beginEpoch();
  void forget();

  config::Experiment experiment_;
  config::Vehicle vehicle_;
  std::size_t own_index_ = 0;
  std::size_t most_depths_ = 0;  // that wait, or go into the map at once
  std::unique_ptr<PersonDetector> detector_;
  std::mutex detector_mutex_;
  AgentFinder finder_;
  OccupancyMapper mapper_;
  std::shared_ptr<const StaticCells> cells_;
  std::map<std::string, std::vector<PersonBox>> boxes_;
  core::TickTimer map_timer_;
  core::TickTimer publish_timer_;
  core::TickTimer blind_timer_;
  core::FrameGate frames_;
  ScanGate scans_;
  PoseHistory poses_;
  std::deque<core::LaserScan> waiting_;
  std::deque<Depths> waiting_depths_;
  std::vector<DepthView> views_;            // that go into the map with the next scan that does
  std::vector<core::Utime> newest_image_;   // of each camera: looked at
  std::vector<core::Utime> last_image_;     // of each camera: heard
  std::vector<core::Utime> newest_depths_;  // of each camera: that measured something, for the map
  std::vector<core::Utime> shown_depths_;   // of each camera: in the map that went out last
  std::vector<core::VehicleState> others_;
  core::Utime last_used_scan_ = 0;
  core::Utime first_used_scan_ = 0;  // since it forgot the world, or was blind
  core::Utime last_own_pose_ = 0;
  bool many_unusable_ = false;
  core::PerceptionRejections rejected_;
  std::deque<core::AgentTracks> tracks_out_;
  std::optional<core::OccupancyMap> map_out_;
  // Last, since they wait for their threads when they go.
  std::deque<Looking> looking_;
  std::future<Mapped> mapping_;
};

}  // namespace roundabout::perception
