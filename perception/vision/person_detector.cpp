#include "perception/vision/person_detector.h"

#include <algorithm>
#include <filesystem>

#include <opencv2/core.hpp>
#include <opencv2/dnn.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/objdetect.hpp>

#include "common/core/error.h"

namespace roundabout::perception {

namespace {

cv::Mat decode(std::span<const std::uint8_t> jpeg) {
  // cv::Mat takes no pointer to const, and only reads.
  const cv::Mat bytes(1, static_cast<int>(jpeg.size()), CV_8UC1,
                      const_cast<std::uint8_t*>(jpeg.data()));
  return jpeg.empty() ? cv::Mat() : cv::imdecode(bytes, cv::IMREAD_COLOR);
}

/// What both kinds share: decoding, and that nothing is thrown.
class OpenCvDetector : public PersonDetector {
 public:
  explicit OpenCvDetector(double least_confidence) : least_confidence_(least_confidence) {}

  std::optional<std::vector<PersonBox>> detect(std::span<const std::uint8_t> jpeg) final {
    try {
      const cv::Mat picture = decode(jpeg);
      if (picture.empty()) {
        return std::nullopt;
      }
      std::vector<PersonBox> boxes = find(picture);
      std::erase_if(boxes, [this](const PersonBox& box) {
        return !(box.confidence >= least_confidence_) || !(box.right > box.left) ||
               !(box.bottom > box.top);
      });
      return boxes;
    } catch (const cv::Exception&) {
      return std::nullopt;
    }
  }

 protected:
  virtual std::vector<PersonBox> find(const cv::Mat& picture) = 0;

 private:
  double least_confidence_;
};

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

/// SSD: rows of [image, class, confidence, left, top, right, bottom], sides as shares. YOLO: rows
/// of [middle x, middle y, width, height, (objectness,) class scores], as rows or as columns.
class NetworkDetector final : public OpenCvDetector {
 public:
  NetworkDetector(double least_confidence, const std::string& path)
      : OpenCvDetector(least_confidence),
        path_(path),
        least_confidence_(static_cast<float>(least_confidence)) {
    const std::filesystem::path file(path);
    std::string topology;
    if (file.extension() == ".caffemodel") {
      topology = std::filesystem::path(file).replace_extension(".prototxt").string();
    } else if (file.extension() == ".weights") {
      topology = std::filesystem::path(file).replace_extension(".cfg").string();
    }
    network_ = cv::dnn::readNet(path, topology);
    caffe_ = file.extension() == ".caffemodel";
  }
  std::string name() const override { return path_; }

 private:
  // MobileNet-SSD and VGG-SSD on PASCAL VOC call people 15; networks on COCO call them 0 (YOLO) or
  // 1 (SSD).
  static constexpr int kVocPerson = 15;
  static constexpr int kCocoSsdPerson = 1;
  static constexpr int kSsdSide = 300;
  static constexpr int kYoloSide = 640;
  static constexpr float kOverlap = 0.45F;

  std::vector<PersonBox> find(const cv::Mat& picture) override {
    // The published SSD networks take 300 x 300 pixels from -1 to 1, YOLO networks 640 x 640 from 0
    // to 1.
    const int side = caffe_ ? kSsdSide : kYoloSide;
    const double scale = caffe_ ? 1.0 / 127.5 : 1.0 / 255.0;
    const cv::Scalar mean = caffe_ ? cv::Scalar::all(127.5) : cv::Scalar();
    network_.setInput(
        cv::dnn::blobFromImage(picture, scale, cv::Size(side, side), mean, !caffe_, false));
    std::vector<cv::Mat> outputs;
    network_.forward(outputs, network_.getUnconnectedOutLayersNames());
    std::vector<PersonBox> boxes;
    for (const cv::Mat& output : outputs) {
      if (output.dims == 4 && output.size[3] == 7) {
        addSsd(output, picture.size(), boxes);
      } else if (output.dims == 3) {
        addYolo(output, picture.size(), side, boxes);
      }
    }
    return withoutDoubles(boxes);
  }

  void addSsd(const cv::Mat& output, cv::Size size, std::vector<PersonBox>& boxes) const {
    const cv::Mat rows(output.size[2], 7, CV_32F, const_cast<uchar*>(output.ptr()));
    for (int i = 0; i < rows.rows; ++i) {
      const float* row = rows.ptr<float>(i);
      const int kind = static_cast<int>(row[1]);
      if (kind == (caffe_ ? kVocPerson : kCocoSsdPerson)) {
        boxes.push_back({row[3] * size.width, row[4] * size.height, row[5] * size.width,
                         row[6] * size.height, row[2]});
      }
    }
  }

  void addYolo(const cv::Mat& output, cv::Size size, int side,
               std::vector<PersonBox>& boxes) const {
    cv::Mat rows(output.size[1], output.size[2], CV_32F, const_cast<uchar*>(output.ptr()));
    const bool by_columns = rows.rows < rows.cols;  // version 8 and later, which have no objectness
    if (by_columns) {
      rows = rows.t();
    }
    for (int i = 0; i < rows.rows && rows.cols >= 5; ++i) {
      const float* row = rows.ptr<float>(i);
      const float confidence = by_columns ? row[4] : row[4] * (rows.cols > 5 ? row[5] : 1.0F);
      // Of versions that say shares, sides are below 2.
      const double unit = row[2] <= 2.0F && row[3] <= 2.0F ? 1.0 : 1.0 / side;
      if (confidence >= least_confidence_) {
        const double across = unit * size.width;
        const double along = unit * size.height;
        boxes.push_back({(row[0] - row[2] / 2) * across, (row[1] - row[3] / 2) * along,
                         (row[0] + row[2] / 2) * across, (row[1] + row[3] / 2) * along,
                         confidence});
      }
    }
  }

  std::vector<PersonBox> withoutDoubles(const std::vector<PersonBox>& boxes) const {
    std::vector<cv::Rect2d> places;
    std::vector<float> confidences;
    for (const PersonBox& box : boxes) {
      places.emplace_back(box.left, box.top, box.right - box.left, box.bottom - box.top);
      confidences.push_back(static_cast<float>(box.confidence));
    }
    std::vector<int> kept;
    cv::dnn::NMSBoxes(places, confidences, least_confidence_, kOverlap, kept);
    std::vector<PersonBox> result;
    for (const int index : kept) {
      result.push_back(boxes[static_cast<std::size_t>(index)]);
    }
    return result;
  }

  std::string path_;
  float least_confidence_;
  bool caffe_ = false;
  cv::dnn::Net network_;
};

}  // namespace

std::unique_ptr<PersonDetector> makePersonDetector(const std::string& specification,
                                                   double least_confidence,
                                                   const std::string& where) {
  if (specification == "hog") {
    return std::make_unique<HogDetector>(least_confidence);
  }
  if (!std::filesystem::is_regular_file(specification)) {
    throw core::StartupError(where, "perception.detector", "hog, none or the path of a model",
                             "\"" + specification + "\", where there is no file");
  }
  try {
    return std::make_unique<NetworkDetector>(least_confidence, specification);
  } catch (const cv::Exception& error) {
    throw core::StartupError(
        where, "perception.detector",
        "a network that OpenCV's dnn reads (.onnx, .caffemodel with .prototxt)",
        "\"" + specification + "\": " + error.err);
  }
}

}  // namespace roundabout::perception
