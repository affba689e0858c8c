#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace roundabout::perception {

/// Where somebody is in an image. Pixels, from the upper left corner.
struct PersonBox {
  double left = 0.0;
  double top = 0.0;
  double right = 0.0;
  double bottom = 0.0;
  double confidence = 0.0;  ///< 0 to 1
};

/// Finds people in pictures. One thread at a time may use an object.
class PersonDetector {
 public:
  PersonDetector() = default;
  PersonDetector(const PersonDetector&) = delete;
  PersonDetector& operator=(const PersonDetector&) = delete;
  virtual ~PersonDetector() = default;

  /// Nothing if the bytes are no picture that can be decoded. Never throws.
  virtual std::optional<std::vector<PersonBox>> detect(std::span<const std::uint8_t> jpeg) = 0;
  virtual std::string name() const = 0;
};

/// "hog": histograms of oriented gradients with the weights that OpenCV brings (Dalal, Triggs,
/// CVPR 2005); else the path of an SSD or YOLO network that OpenCV's dnn reads (.onnx, .caffemodel
/// beside a .prototxt, .pb). Throws core::StartupError naming `where` if the file is missing or is
/// no network.
std::unique_ptr<PersonDetector> makePersonDetector(const std::string& specification,
                                                   double least_confidence,
                                                   const std::string& where);

}  // namespace roundabout::perception
