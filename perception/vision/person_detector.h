#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "common/config/experiment.h"

namespace roundabout::perception {

/// Where somebody is in an image. Pixels, from the upper left corner.
struct PersonBox {
  double left = 0.0;
  double top = 0.0;
  double right = 0.0;
  double bottom = 0.0;
  double confidence = 0.0;  ///< 0 to 1
};

/// Whether it has edges, an area, and a confidence.
inline bool isBox(const PersonBox& box) {
  return std::isfinite(box.left) && std::isfinite(box.top) && std::isfinite(box.right) &&
         std::isfinite(box.bottom) && box.right > box.left && box.bottom > box.top &&
         std::isfinite(box.confidence);
}

/// Finds people in pictures. One thread at a time may use an object.
class PersonDetector {
 public:
  PersonDetector() = default;
  PersonDetector(const PersonDetector&) = delete;
  PersonDetector& operator=(const PersonDetector&) = delete;
  virtual ~PersonDetector() = default;

  /// Nothing if the bytes are no picture that can be decoded. Never throws.
  virtual std::optional<std::vector<PersonBox>> detect(std::span<const std::uint8_t> jpeg) = 0;
  /// What it is, in words.
  virtual std::string name() const = 0;
  /// What a picture takes it at least, here. s; 0: it was not tried.
  virtual double pictureS() const { return 0.0; }
};

/// Why tracks will come late by a detector that a picture takes so long, when so many cameras take
/// theirs at once; empty: they will not.
std::string whyTooSlow(double picture_s, std::size_t cameras, const config::Perception& settings);

/// Of `settings.detector`: "hog": histograms of oriented gradients with the weights that OpenCV
/// brings (Dalal, Triggs, CVPR 2005); "none": nullptr; else the path of a network
/// (makeNetworkDetector). Throws core::StartupError naming `where`.
std::unique_ptr<PersonDetector> makePersonDetector(const config::Perception& settings,
                                                   const std::string& where);

}  // namespace roundabout::perception
