#pragma once

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "common/config/experiment.h"
#include "common/core/sensor_data.h"
#include "perception/agent_finder.h"
#include "perception/mapping/occupancy_mapper.h"
#include "perception/vision/person_detector.h"

namespace roundabout::perception {

/// What a picture shows.
struct Sight {
  core::Utime utime = 0;
  const AgentFinder* finder = nullptr;            ///< scan, clusters and tracks
  const StaticCells* cells = nullptr;             ///< nullptr: no map yet
  std::map<std::string, core::JpegImage> images;  ///< by camera
  std::map<std::string, core::DepthImage> depths;
  std::map<std::string, std::vector<PersonBox>> boxes;
};

/// Draws the room from above, and cameras' images beside it, into a window, a video, or both.
class TopView {
 public:
  /// record: path of an .avi file (Motion JPEG, 10 pictures a second of data time); empty: none.
  /// Throws core::StartupError if it cannot be written.
  TopView(const config::Room& room, const std::string& record, bool window);
  ~TopView();

  void draw(const Sight& sight);
  /// The last picture as a JPEG or PNG file, by the path's ending. False if it cannot be written.
  bool save(const std::string& path) const;
  int pictures() const;

 private:
  struct Canvas;
  std::unique_ptr<Canvas> canvas_;
};

}  // namespace roundabout::perception
