#pragma once

#include <cstdint>
#include <exception>
#include <optional>
#include <span>
#include <vector>

#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

#include "perception/vision/person_detector.h"

namespace roundabout::perception {

/// What all detectors share: decoding, that nothing is thrown, and what counts as a box.
class OpenCvDetector : public PersonDetector {
 public:
  std::optional<std::vector<PersonBox>> detect(std::span<const std::uint8_t> jpeg) final {
    try {
      // cv::Mat takes no pointer to const, and only reads.
      const cv::Mat bytes(1, static_cast<int>(jpeg.size()), CV_8UC1,
                          const_cast<std::uint8_t*>(jpeg.data()));
      // As the camera's pixels are: what EXIF says of its orientation would turn the boxes.
      constexpr int kAsItIs = cv::IMREAD_COLOR | cv::IMREAD_IGNORE_ORIENTATION;
      const cv::Mat picture = jpeg.empty() ? cv::Mat() : cv::imdecode(bytes, kAsItIs);
      if (picture.empty()) {
        return std::nullopt;
      }
      std::vector<PersonBox> boxes = find(picture);
      std::erase_if(boxes, [this](const PersonBox& box) { return !counts(box); });
      return boxes;
    } catch (const std::exception&) {  // OpenCV's, or no memory
      return std::nullopt;
    }
  }

 protected:
  explicit OpenCvDetector(double least_confidence) : least_confidence_(least_confidence) {}

  /// picture: 8 bits, blue, green, red.
  virtual std::vector<PersonBox> find(const cv::Mat& picture) = 0;
  double leastConfidence() const { return least_confidence_; }

 private:
  bool counts(const PersonBox& box) const {
    return box.confidence >= least_confidence_ && isBox(box);
  }

  double least_confidence_;
};

}  // namespace roundabout::perception
