#pragma once

#include <string>

namespace roundabout::test {

/// Networks that find what is red, written in the formats that people's detectors come in. A cell
/// of 32 x 32 pixels is a detection of the class "person" with the confidence that its red
/// exceeds the mean of its green and blue by (of full scale); its box is 64 wide and 96 high around
/// the cell's middle. All other classes are 0.9 sure of nothing: their confidence is 0.

/// As YOLO 5 to 7 export themselves: rows [middle, size, objectness, scores] in pixels.
void writeYolo5(const std::string& path, int width, int height, int classes, int person);

/// As YOLO 8 and later: columns [middle, size, scores] in pixels.
void writeYolo8(const std::string& path, int width, int height, int classes, int person);

/// As SSD networks come from PyTorch: "scores" with one class for the background, and "boxes" with
/// corners as shares; input is (x - 127) / 128 in the order red, green, blue.
void writeOnnxSsd(const std::string& path, int width, int height, int classes, int person);

/// An image classifier: no detector.
void writeClassifier(const std::string& path, int width, int height, int classes);

/// MobileNet-SSD's form: a .caffemodel at `path` and the .prototxt beside it, a square input
/// (x - 127.5) / 127.5 in the order blue, green, red, 21 classes of which 15 is a person.
void writeCaffeSsd(const std::string& path, int side);

/// YOLO 3's form: a .weights at `path` and the .cfg beside it, one class.
void writeDarknet(const std::string& path, int width, int height);

}  // namespace roundabout::test
