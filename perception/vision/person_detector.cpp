#include "perception/vision/person_detector.h"

#include <algorithm>

#include <fmt/format.h>
#include <opencv2/objdetect.hpp>

#include "perception/vision/network_detector.h"
#include "perception/vision/opencv_detector.h"

namespace roundabout::perception {

namespace {

class HogDetector final : public OpenCvDetector {
 public:
  explicit HogDetector(double least_confidence) : OpenCvDetector(least_confidence) {
    hog_.setSVMDetector(cv::HOGDescriptor::getDefaultPeopleDetector());
  }
  std::string name() const override { return "hog"; }

 private:
  std::vector<PersonBox> find(const cv::Mat& picture) override {
    std::vector<cv::Rect> places;
    std::vector<double> weights;
    hog_.detectMultiScale(picture, places, weights, 0.0, cv::Size(8, 8), cv::Size(16, 16), 1.1,
                          2.0);
    std::vector<PersonBox> boxes;
    for (std::size_t i = 0; i < places.size(); ++i) {
      const cv::Rect& place = places[i];
      // The window has a margin of an eighth around a person.
      const double across = place.width / 8.0;
      const double along = place.height / 8.0;
      boxes.push_back({place.x + across, place.y + along, place.x + place.width - across,
                       place.y + place.height - along, std::min(weights[i], 1.0)});
    }
    return boxes;
  }

  cv::HOGDescriptor hog_;
};

}  // namespace

std::string whyTooSlow(double picture_s, std::size_t cameras, const config::Perception& settings) {
  const double takes_s = static_cast<double>(cameras) * picture_s;
  if (takes_s <= std::min(settings.image_delay_s, settings.image_period_s)) {
    return {};
  }
  return fmt::format(
      "to find people in a picture of each of {} cameras takes {:.3g} s, more than "
      "perception.image_delay_s ({}) or image_period_s ({}): tracks will wait for it",
      cameras, takes_s, settings.image_delay_s, settings.image_period_s);
}

std::unique_ptr<PersonDetector> makePersonDetector(const config::Perception& settings,
                                                   const std::string& where) {
  if (settings.detector == "none") {
    return nullptr;
  }
  if (settings.detector == "hog") {
    return std::make_unique<HogDetector>(settings.detector_confidence);
  }
  return makeNetworkDetector(settings, where);
}

}  // namespace roundabout::perception
