#pragma once

#include <memory>
#include <string>

#include "common/config/experiment.h"
#include "perception/vision/person_detector.h"

namespace roundabout::perception {

/// An SSD or YOLO network from `settings.detector` (.onnx, .caffemodel beside a .prototxt, .weights
/// beside a .cfg, .pb beside a .pbtxt), run by OpenCV's dnn on the CPU. How it wants its picture
/// and which class is a person follow the custom of its kind (docs/perception.md) where
/// `settings.network` says nothing. It is tried here, on nothing: throws core::StartupError naming
/// `where` if the file is missing, torn or no network, if the network cannot take such a picture,
/// says no boxes, or does not have the class as far as its output says its classes.
std::unique_ptr<PersonDetector> makeNetworkDetector(const config::Perception& settings,
                                                    const std::string& where);

}  // namespace roundabout::perception
