#pragma once

#include <optional>
#include <vector>

#include <opencv2/core.hpp>

#include "perception/vision/person_detector.h"

namespace roundabout::perception {

/// What the outputs of a detector's network are.
struct NetworkOutput {
  enum class Kind {
    kDetections,  ///< SSD with its DetectionOutput layer: 1 x 1 x N x [image, class, confidence,
                  ///< left, top, right, bottom], as shares of the input
    kSplit,       ///< SSD without: N x [left, top, right, bottom] as shares, and N x scores
    kRows,        ///< YOLO up to 7: N x [middle x, y, width, height, objectness, scores]
    kColumns,     ///< YOLO from 8: [middle x, y, width, height, scores] x N
    kRegions,     ///< YOLO through Darknet's layers: as kRows, scores times objectness already
  };
  Kind kind = Kind::kRows;
  int classes = 0;   ///< 0: it does not say
  int boxes_at = 0;  ///< kSplit: which of the outputs are the boxes

  bool isYolo() const { return kind != Kind::kDetections && kind != Kind::kSplit; }
};

/// Nothing if they are no boxes in a form that is known. By their sizes alone.
std::optional<NetworkOutput> recogniseOutput(const std::vector<cv::Mat>& outputs);

/// The class of people by the custom of the data set that has so many classes: PASCAL VOC (20) or
/// COCO (80, 90), to which SSD networks add the background as class 0.
int customaryPerson(const NetworkOutput& output);

/// Boxes of a class, in pixels of the network's input; several for who is seen several times.
std::vector<PersonBox> readBoxes(const NetworkOutput& output, const std::vector<cv::Mat>& outputs,
                                 int person, double least_confidence, cv::Size input);

/// Of boxes that overlap the most confident one; what is no box is left out first, so that it
/// displaces nobody.
std::vector<PersonBox> withoutDoubles(std::vector<PersonBox> boxes);

}  // namespace roundabout::perception
