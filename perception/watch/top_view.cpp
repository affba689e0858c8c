#include "perception/watch/top_view.h"

#include <algorithm>
#include <cmath>

#include <opencv2/highgui.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/videoio.hpp>
#include <spdlog/fmt/fmt.h>

#include "common/core/error.h"

namespace roundabout::perception {

namespace {

constexpr int kSide_px = 720;
constexpr int kImageWidth_px = 320;
constexpr double kHalfGrey_mm = 2000.0;  // this far away is half as light as right here
constexpr double kPicturesPerSecond = 10.0;
// Blue, green, red; the colours of Okabe and Ito, which everybody can tell apart.
const cv::Scalar kPaper(255, 255, 255);
const cv::Scalar kInk(60, 60, 60);
const cv::Scalar kMap(170, 170, 170);
const cv::Scalar kDepthMap(153, 136, 221);
const cv::Scalar kPoint(178, 114, 0);
const cv::Scalar kCluster(0, 159, 230);
const cv::Scalar kPedestrian(0, 94, 213);
const cv::Scalar kOther(115, 158, 0);

const char* nameOf(core::AgentClass agent_class) {
  switch (agent_class) {
    case core::AgentClass::kPedestrian:
      return "person";
    case core::AgentClass::kVehicle:
      return "vehicle";
    case core::AgentClass::kStatic:
      return "static";
    case core::AgentClass::kUnknown:
      return "?";
  }
  return "";
}

}  // namespace

struct TopView::Canvas {
  Eigen::Vector2d corner_m;
  double px_per_m;
  cv::Mat picture{kSide_px, kSide_px + kImageWidth_px, CV_8UC3, kPaper};
  cv::VideoWriter video;
  bool window;
  int pictures = 0;

  cv::Point at(const Eigen::Vector2d& place_m) const {
    const Eigen::Vector2d place = px_per_m * (place_m - corner_m);
    return {static_cast<int>(std::lround(place.x())),
            kSide_px - static_cast<int>(std::lround(place.y()))};
  }
  int px(double length_m) const { return static_cast<int>(std::lround(px_per_m * length_m)); }

  void text(const std::string& words, const cv::Point& place, const cv::Scalar& colour) {
    cv::putText(picture, words, place, cv::FONT_HERSHEY_SIMPLEX, 0.45, colour, 1, cv::LINE_AA);
  }

  void drawScan(const AgentFinder& finder) {
    const ScanPoints& points = finder.points();
    for (std::size_t i = 0; i < points.size(); ++i) {
      if (points.hit[i] != 0) {
        cv::circle(picture, at(points.world_m[i]), 1, kPoint, cv::FILLED);
      }
    }
    for (const Detection& detection : finder.detections()) {
      cv::circle(picture, at(detection.position_m), px(detection.half_width_m), kCluster, 1,
                 cv::LINE_AA);
    }
    cv::circle(picture, at(points.sensor_m), px(0.2), kInk, 2, cv::LINE_AA);
  }

  void drawTracks(const std::vector<core::AgentTrack>& tracks) {
    for (const core::AgentTrack& track : tracks) {
      const bool person = track.agent_class == core::AgentClass::kPedestrian;
      const cv::Scalar& colour = person ? kPedestrian : kOther;
      const cv::Point centre = at(track.position_world_m);
      cv::circle(picture, centre, px(track.radius_m), colour, track.unseen_s > 0.0 ? 1 : 2,
                 cv::LINE_AA);
      cv::arrowedLine(picture, centre, at(track.position_world_m + track.velocity_world_mps),
                      colour, 2, cv::LINE_AA);
      text(fmt::format("{} {}", track.id, nameOf(track.agent_class)),
           centre + cv::Point(px(track.radius_m) + 2, 0), colour);
    }
  }

  /// Below what is there already. False if there is no place for it.
  bool drawImage(const std::string& camera, cv::Mat seen, int& top) {
    cv::resize(seen, seen, {kImageWidth_px, seen.rows * kImageWidth_px / seen.cols});
    if (top + seen.rows > kSide_px) {
      return false;
    }
    seen.copyTo(picture(cv::Rect(kSide_px, top, seen.cols, seen.rows)));
    text(camera, {kSide_px + 6, top + 16}, kPaper);
    top += seen.rows;
    return true;
  }

  /// Near is light, and what was not measured black.
  static cv::Mat greyOf(const core::DepthImage& image) {
    cv::Mat grey(image.height, image.width, CV_8UC1);
    std::transform(image.depth_mm.begin(), image.depth_mm.end(), grey.begin<std::uint8_t>(),
                   [](std::uint16_t depth_mm) {
                     return depth_mm == 0 ? 0.0 : 255.0 / (1.0 + depth_mm / kHalfGrey_mm);
                   });
    cv::cvtColor(grey, grey, cv::COLOR_GRAY2BGR);
    return grey;
  }

  void drawImages(const Sight& sight) {
    int top = 0;
    for (const auto& [camera, depths] : sight.depths) {
      if (!drawImage(camera, greyOf(depths), top)) {
        break;
      }
    }
    for (const auto& [camera, image] : sight.images) {
      cv::Mat seen = cv::imdecode(image.jpeg, cv::IMREAD_COLOR);
      if (seen.empty()) {
        continue;
      }
      if (const auto boxes = sight.boxes.find(camera); boxes != sight.boxes.end()) {
        for (const PersonBox& box : boxes->second) {
          cv::rectangle(seen, cv::Point2d(box.left, box.top), cv::Point2d(box.right, box.bottom),
                        kPedestrian, 2);
        }
      }
      if (!drawImage(camera, seen, top)) {
        break;
      }
    }
  }
};

TopView::TopView(const config::Room& room, const std::string& record, bool window)
    : canvas_(std::make_unique<Canvas>()) {
  const Eigen::Vector2d size_m = (room.max_m - room.min_m).head<2>();
  canvas_->px_per_m = kSide_px / size_m.maxCoeff();
  canvas_->corner_m = room.min_m.head<2>();
  canvas_->window = window;
  if (!record.empty() && !canvas_->video.open(record, cv::VideoWriter::fourcc('M', 'J', 'P', 'G'),
                                              kPicturesPerSecond, canvas_->picture.size())) {
    throw core::StartupError(record, "--record", "an .avi file that can be written", "none");
  }
}

TopView::~TopView() = default;

void TopView::draw(const Sight& sight) {
  Canvas& canvas = *canvas_;
  canvas.picture.setTo(kPaper);
  if (sight.cells != nullptr) {
    for (const Eigen::Vector2d& cell_m : sight.cells->centres()) {
      cv::circle(canvas.picture, canvas.at(cell_m), 2, kMap, cv::FILLED);
    }
    for (const Eigen::Vector2d& cell_m : sight.cells->depthCentres()) {
      cv::circle(canvas.picture, canvas.at(cell_m), 1, kDepthMap, cv::FILLED);
    }
  }
  if (sight.finder != nullptr) {
    canvas.drawScan(*sight.finder);
    canvas.drawTracks(sight.finder->tracker().tracks());
  }
  canvas.drawImages(sight);
  canvas.text(fmt::format("{:.2f} s", core::toSeconds(sight.utime)), {8, kSide_px - 8}, kInk);
  if (canvas.video.isOpened()) {
    canvas.video.write(canvas.picture);
  }
  if (canvas.window) {
    cv::imshow("roundabout perception", canvas.picture);
    cv::waitKey(1);
  }
  ++canvas.pictures;
}

bool TopView::save(const std::string& path) const {
  try {
    return cv::imwrite(path, canvas_->picture);
  } catch (const cv::Exception&) {
    return false;
  }
}

int TopView::pictures() const { return canvas_->pictures; }

}  // namespace roundabout::perception
