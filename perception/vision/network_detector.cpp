#include "perception/vision/network_detector.h"

#include <algorithm>
#include <cctype>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <new>
#include <optional>

#include <fmt/format.h>
#include <opencv2/core/utils/logger.hpp>
#include <opencv2/dnn.hpp>
#include <opencv2/imgproc.hpp>

#include "common/core/error.h"
#include "perception/vision/network_output.h"
#include "perception/vision/opencv_detector.h"

namespace roundabout::perception {

namespace {

/// How a network wants its picture: (x - mean) * scale.
struct Input {
  cv::Size size_px;
  cv::Scalar mean;  // red, green, blue; or blue, green, red
  double scale = 1.0;
  bool red_first = true;
  bool letterbox = false;  // the whole picture in its proportions, grey around it; else stretched
};

enum class Format { kOnnx, kCaffe, kDarknet, kTensorFlow };

Format formatOf(const std::filesystem::path& path) {
  const auto extension = path.extension();
  return extension == ".caffemodel" ? Format::kCaffe
         : extension == ".weights"  ? Format::kDarknet
         : extension == ".pb"       ? Format::kTensorFlow
                                    : Format::kOnnx;
}

/// The file beside the weights that says what they are weights of; empty: they say it themselves.
std::string topologyOf(std::filesystem::path path) {
  switch (formatOf(path)) {
    case Format::kCaffe:
      return path.replace_extension(".prototxt").string();
    case Format::kDarknet:
      return path.replace_extension(".cfg").string();
    case Format::kTensorFlow:
      return path.replace_extension(".pbtxt").string();
    case Format::kOnnx:
      break;
  }
  return {};
}

/// What Darknet's .cfg says of its input, which OpenCV does not tell. Nothing: it does not say.
std::optional<cv::Size> sizeInConfiguration(const std::string& path) {
  std::ifstream file(path);
  cv::Size size;
  for (std::string line; std::getline(file, line) && size.empty();) {
    std::erase_if(line, [](unsigned char character) { return std::isspace(character) != 0; });
    std::sscanf(line.c_str(), "width=%d", &size.width);
    std::sscanf(line.c_str(), "height=%d", &size.height);
  }
  return size.empty() ? std::nullopt : std::optional(size);
}

/// What the file says of its input, which OpenCV tells of Caffe's; else what is customary.
cv::Size sizeOf(const cv::dnn::Net& network, Format format, const std::string& topology) {
  if (format == Format::kDarknet) {
    if (const auto said = sizeInConfiguration(topology)) {
      return *said;
    }
  }
  std::vector<cv::dnn::MatShape> inputs;
  std::vector<cv::dnn::MatShape> outputs;
  network.getLayerShapes(cv::dnn::MatShape(), 0, inputs, outputs);
  if (!inputs.empty() && inputs[0].size() == 4 && inputs[0][2] > 0 && inputs[0][3] > 0) {
    return {inputs[0][3], inputs[0][2]};
  }
  const int side = format == Format::kOnnx ? 640 : format == Format::kDarknet ? 416 : 300;
  return {side, side};
}

/// What Darknet's .weights have room for at least: numbers alone, so that OpenCV takes a torn file
/// for a whole one.
std::uintmax_t bytesOfWeights(const cv::dnn::Net& network) {
  constexpr std::uintmax_t kHeader = 16;
  std::uintmax_t bytes = kHeader;
  for (const std::string& name : network.getLayerNames()) {
    const auto layer = network.getLayer(network.getLayerId(name));
    if (layer->type == "Convolution" || layer->type == "BatchNorm" ||
        layer->type == "InnerProduct") {
      for (const cv::Mat& blob : layer->blobs) {
        bytes += blob.total() * sizeof(float);
      }
    }
  }
  return bytes;
}

/// As the networks of each kind that most use were trained.
void preprocessAsCustomary(Format format, const NetworkOutput& output, Input& input) {
  if (output.isYolo()) {
    input.scale = 1.0 / 255.0;
    input.letterbox = true;
  } else if (format == Format::kCaffe) {
    input.mean = cv::Scalar::all(127.5);
    input.scale = 1.0 / 127.5;
    input.red_first = false;
  } else if (format == Format::kOnnx) {
    input.mean = cv::Scalar::all(127.0);
    input.scale = 1.0 / 128.0;
  }
}

/// DetectionOutput says no number of classes: Caffe's networks are of PASCAL VOC, others of COCO.
int personAsCustomary(Format format, const NetworkOutput& output) {
  constexpr int kVocPerson = 15;
  return format == Format::kCaffe && output.classes == 0 ? kVocPerson : customaryPerson(output);
}

class NetworkDetector final : public OpenCvDetector {
 public:
  NetworkDetector(const config::Perception& settings, const std::string& where)
      : OpenCvDetector(settings.detector_confidence), path_(settings.detector) {
    const config::DetectorNetwork& wanted = settings.network;
    const Format format = formatOf(path_);
    network_ = cv::dnn::readNet(path_, topologyOf(path_));
    if (format == Format::kDarknet) {
      refuseTornWeights(where);
    }
    input_.size_px = wanted.input_px ? cv::Size(wanted.input_px->cast<int>().x(),
                                                wanted.input_px->cast<int>().y())
                                     : sizeOf(network_, format, topologyOf(path_));
    recognise(where);
    timeOneRun();
    preprocessAsCustomary(format, output_, input_);
    if (wanted.mean) {
      input_.mean = {wanted.mean->x(), wanted.mean->y(), wanted.mean->z()};
    }
    input_.scale = wanted.scale.value_or(input_.scale);
    input_.red_first = wanted.red_first.value_or(input_.red_first);
    person_ = wanted.person_class.value_or(personAsCustomary(format, output_));
    if (output_.classes > 0 && person_ >= output_.classes) {
      throw core::StartupError(where, "perception.network.person_class",
                               fmt::format("below {}, the classes of {}", output_.classes, path_),
                               std::to_string(person_));
    }
  }

  std::string name() const override {
    const std::string classes =
        output_.classes > 0 ? fmt::format(" of {}", output_.classes) : std::string();
    return fmt::format("{} ({}, {} x {} pixels, class {}{})", path_,
                       output_.isYolo() ? "YOLO" : "SSD", input_.size_px.width,
                       input_.size_px.height, person_, classes);
  }
  double pictureS() const override { return picture_s_; }

 private:
  std::vector<PersonBox> find(const cv::Mat& picture) override {
    constexpr double kGrey = 114.0;
    const cv::Rect place = placeOf(picture.size());
    cv::Mat fitted(input_.size_px, picture.type(), cv::Scalar::all(kGrey));
    cv::resize(picture, fitted(place), place.size());
    std::vector<PersonBox> boxes =
        readBoxes(output_, run(fitted), person_, leastConfidence(), input_.size_px);
    const double across = static_cast<double>(picture.cols) / place.width;
    const double along = static_cast<double>(picture.rows) / place.height;
    for (PersonBox& box : boxes) {
      box.left = (box.left - place.x) * across;
      box.right = (box.right - place.x) * across;
      box.top = (box.top - place.y) * along;
      box.bottom = (box.bottom - place.y) * along;
    }
    return withoutDoubles(boxes);
  }

  /// Of a picture, in the network's input.
  cv::Rect placeOf(cv::Size picture) const {
    const cv::Size input = input_.size_px;
    if (!input_.letterbox) {
      return {{0, 0}, input};
    }
    const double shrink = std::max(static_cast<double>(picture.width) / input.width,
                                   static_cast<double>(picture.height) / input.height);
    const int width =
        std::clamp(static_cast<int>(std::lround(picture.width / shrink)), 1, input.width);
    const int height =
        std::clamp(static_cast<int>(std::lround(picture.height / shrink)), 1, input.height);
    return {(input.width - width) / 2, (input.height - height) / 2, width, height};
  }

  std::vector<cv::Mat> run(const cv::Mat& picture) {
    network_.setInput(cv::dnn::blobFromImage(picture, input_.scale, input_.size_px, input_.mean,
                                             input_.red_first, false));
    std::vector<cv::Mat> outputs;
    network_.forward(outputs, network_.getUnconnectedOutLayersNames());
    return outputs;
  }

  void refuseTornWeights(const std::string& where) const {
    const std::uintmax_t expected = bytesOfWeights(network_);
    const std::uintmax_t found = std::filesystem::file_size(path_);
    if (found < expected) {
      throw core::StartupError(
          where, "perception.detector",
          fmt::format("the whole file: at least {} bytes by {}", expected, topologyOf(path_)),
          fmt::format("\"{}\" of {}", path_, found));
    }
  }

  void recognise(const std::string& where) {
    std::vector<cv::Mat> outputs;
    const std::string size =
        fmt::format("{} x {} pixels", input_.size_px.width, input_.size_px.height);
    try {
      outputs = run(cv::Mat::zeros(input_.size_px, CV_8UC3));
    } catch (const cv::Exception& error) {
      throw core::StartupError(where, "perception.network.input_px",
                               "the size of picture that " + path_ + " takes",
                               size + ", with which it does not run: " + error.err);
    }
    const auto output = recogniseOutput(outputs);
    if (!output) {
      std::string sizes;
      for (const cv::Mat& each : outputs) {
        sizes += sizes.empty() ? "" : " and ";
        for (int i = 0; i < each.dims; ++i) {
          sizes += (i == 0 ? "" : " x ") + std::to_string(each.size[i]);
        }
      }
      throw core::StartupError(where, "perception.detector",
                               "a network of the kinds SSD or YOLO (docs/perception.md)",
                               "\"" + path_ + "\", whose output is " + sizes);
    }
    if (!std::all_of(outputs.begin(), outputs.end(),
                     [](const cv::Mat& each) { return cv::checkRange(each); })) {
      throw core::StartupError(where, "perception.detector", "a network that is whole",
                               "\"" + path_ + "\", which does not say numbers");
    }
    output_ = *output;
  }

  /// Not the first, which prepares the others.
  void timeOneRun() {
    const auto began = std::chrono::steady_clock::now();
    run(cv::Mat::zeros(input_.size_px, CV_8UC3));
    picture_s_ = std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
  }

  std::string path_;
  cv::dnn::Net network_;
  Input input_;
  NetworkOutput output_;
  int person_ = 0;
  double picture_s_ = 0.0;
};

/// OpenCV writes its errors to the standard error too; they are said once, in our words.
class QuietOpenCv {
 public:
  QuietOpenCv() : before_(cv::utils::logging::setLogLevel(cv::utils::logging::LOG_LEVEL_SILENT)) {}
  QuietOpenCv(const QuietOpenCv&) = delete;
  QuietOpenCv& operator=(const QuietOpenCv&) = delete;
  ~QuietOpenCv() { cv::utils::logging::setLogLevel(before_); }

 private:
  cv::utils::logging::LogLevel before_;
};

}  // namespace

std::unique_ptr<PersonDetector> makeNetworkDetector(const config::Perception& settings,
                                                    const std::string& where) {
  const std::string& path = settings.detector;
  std::error_code unreadable;
  if (!std::filesystem::is_regular_file(path, unreadable)) {
    throw core::StartupError(where, "perception.detector", "hog, none or the path of a model",
                             "\"" + path + "\", where there is no file");
  }
  const std::string topology = topologyOf(path);
  if (!topology.empty() && !std::filesystem::is_regular_file(topology, unreadable)) {
    throw core::StartupError(where, "perception.detector",
                             "\"" + topology + "\" beside the weights", "no such file");
  }
  const QuietOpenCv quiet;
  try {
    return std::make_unique<NetworkDetector>(settings, where);
  } catch (const std::bad_alloc&) {
    throw core::StartupError(where, "perception.detector", "a network that fits into memory",
                             "\"" + path + "\"");
  } catch (const cv::Exception& error) {
    throw core::StartupError(where, "perception.detector",
                             "a network that OpenCV's dnn reads (.onnx, .caffemodel with "
                             ".prototxt, .weights with .cfg, .pb with .pbtxt)",
                             "\"" + path + "\": " + error.err);
  } catch (const core::StartupError&) {
    throw;
  } catch (const std::exception& error) {  // of what OpenCV reads files with
    throw core::StartupError(where, "perception.detector", "a network that OpenCV's dnn reads",
                             "\"" + path + "\": " + error.what());
  }
}

}  // namespace roundabout::perception
