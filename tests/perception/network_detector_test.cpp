// People from SSD and YOLO networks: in every form that they come in, where they are in the
// picture.

#include <filesystem>
#include <fstream>
#include <functional>
#include <limits>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "perception/vision/network_output.h"
#include "perception/vision/person_detector.h"
#include "sim/sensors/jpeg.h"
#include "tests/perception/network_files.h"
#include "tests/support/scratch_folder.h"
#include "tests/support/startup_error.h"

namespace roundabout::perception {
namespace {

constexpr int kWidth = 640;
constexpr int kHeight = 400;

struct Colour {
  std::uint8_t red;
  std::uint8_t green;
  std::uint8_t blue;
};
constexpr Colour kRed{255, 0, 0};
constexpr Colour kBlue{0, 0, 255};

/// Grey, with one block of a colour.
std::vector<std::uint8_t> pictureWith(const Colour& colour, double left, double top, double right,
                                      double bottom) {
  std::vector<std::uint8_t> rgb;
  for (int row = 0; row < kHeight; ++row) {
    for (int column = 0; column < kWidth; ++column) {
      const bool inside = column >= left && column < right && row >= top && row < bottom;
      const Colour here = inside ? colour : Colour{110, 110, 110};
      rgb.insert(rgb.end(), {here.red, here.green, here.blue});
    }
  }
  return sim::encodeJpeg(rgb, kWidth, kHeight, 200'000);
}

struct Form {
  std::string name;
  std::string file;
  std::function<void(const std::string& path)> write;
  int width = 0;  // of the network's input
  int height = 0;
  bool letterbox = false;
  std::string says;
};

void PrintTo(const Form& form, std::ostream* out) { *out << form.name; }

class EveryForm : public ::testing::TestWithParam<Form> {
 protected:
  std::unique_ptr<PersonDetector> detector() {
    const Form& form = GetParam();
    settings_.detector = folder_.file(form.file);
    settings_.network.input_px.emplace(form.width, form.height);
    form.write(settings_.detector);
    return makePersonDetector(settings_, "test");
  }

  /// A column of the network's input in the picture, and a row.
  static double pictureX(double x) {
    const Form& form = GetParam();
    return form.letterbox ? (x - (form.width - kWidth * scale()) / 2) / scale()
                          : x * kWidth / form.width;
  }
  static double pictureY(double y) {
    const Form& form = GetParam();
    return form.letterbox ? (y - (form.height - kHeight * scale()) / 2) / scale()
                          : y * kHeight / form.height;
  }
  static double scale() {
    return std::min(static_cast<double>(GetParam().width) / kWidth,
                    static_cast<double>(GetParam().height) / kHeight);
  }

  /// With a block of a colour where the network's fourth cell is, in the fifth row.
  static std::vector<std::uint8_t> pictureOf(const Colour& colour) {
    return pictureWith(colour, pictureX(96), pictureY(128), pictureX(128), pictureY(160));
  }

  test::ScratchFolder folder_;
  config::Perception settings_;
};

TEST_P(EveryForm, FindsWhoIsThereWhereHeIs) {
  const auto boxes = detector()->detect(pictureOf(kRed));
  ASSERT_TRUE(boxes);
  ASSERT_EQ(boxes->size(), 1U);
  const PersonBox& box = boxes->front();
  EXPECT_GT(box.confidence, 0.8);
  EXPECT_LE(box.confidence, 1.001);
  // 64 wide and 96 high around the cell's middle.
  EXPECT_NEAR(box.left, pictureX(80), 0.5);
  EXPECT_NEAR(box.right, pictureX(144), 0.5);
  EXPECT_NEAR(box.top, pictureY(96), 0.5);
  EXPECT_NEAR(box.bottom, pictureY(192), 0.5);
}

TEST_P(EveryForm, TakesColoursInTheirOrder) {
  const auto boxes = detector()->detect(pictureOf(kBlue));
  ASSERT_TRUE(boxes);
  EXPECT_TRUE(boxes->empty());
}

TEST_P(EveryForm, LeavesOutWhoIsNoPersonForSure) {
  settings_.detector_confidence = 0.5;
  const Colour reddish{200, 110, 110};  // 0.35 redder than the rest
  const auto sure = detector()->detect(pictureOf(reddish));
  ASSERT_TRUE(sure);
  EXPECT_TRUE(sure->empty());
}

TEST_P(EveryForm, SaysWhatItIs) {
  const std::string name = detector()->name();
  EXPECT_NE(name.find(GetParam().says), std::string::npos) << name;
  EXPECT_NE(name.find(GetParam().file), std::string::npos) << name;
}

INSTANTIATE_TEST_SUITE_P(
    Networks, EveryForm,
    ::testing::Values(
        Form{"yolo5", "n.onnx", [](const auto& path) { test::writeYolo5(path, 640, 512, 80, 0); },
             640, 512, true, "YOLO, 640 x 512 pixels, class 0 of 80"},
        Form{"yolo8", "n.onnx", [](const auto& path) { test::writeYolo8(path, 512, 416, 80, 0); },
             512, 416, true, "YOLO, 512 x 416 pixels, class 0 of 80"},
        Form{"yolo8_voc", "n.onnx",
             [](const auto& path) { test::writeYolo8(path, 320, 320, 20, 14); }, 320, 320, true,
             "class 14 of 20"},
        Form{"darknet", "n.weights", [](const auto& path) { test::writeDarknet(path, 320, 256); },
             320, 256, true, "YOLO, 320 x 256 pixels, class 0 of 1"},
        Form{"caffe_ssd", "n.caffemodel", [](const auto& path) { test::writeCaffeSsd(path, 300); },
             300, 300, false, "SSD, 300 x 300 pixels, class 15"},
        Form{"onnx_ssd_voc", "n.onnx",
             [](const auto& path) { test::writeOnnxSsd(path, 320, 256, 21, 15); }, 320, 256, false,
             "SSD, 320 x 256 pixels, class 15 of 21"},
        Form{"onnx_ssd_coco", "n.onnx",
             [](const auto& path) { test::writeOnnxSsd(path, 320, 320, 81, 1); }, 320, 320, false,
             "class 1 of 81"}),
    [](const auto& each) { return each.param.name; });

class NetworkDetector : public ::testing::Test {
 protected:
  std::unique_ptr<PersonDetector> make() { return makePersonDetector(settings_, "lab.yaml"); }
  std::string refusal() {
    return test::startupErrorOf([this] { make(); });
  }

  test::ScratchFolder folder_;
  config::Perception settings_ = [this] {
    config::Perception settings;
    settings.detector = folder_.file("n.onnx");
    settings.network.input_px.emplace(320, 320);
    return settings;
  }();
};

TEST_F(NetworkDetector, KnowsAPersonByTheClassThatTheFileSays) {
  test::writeYolo8(settings_.detector, 320, 320, 3, 2);
  const auto red = pictureWith(kRed, 192, 136, 256, 200);
  EXPECT_EQ(make()->detect(red)->size(), 0U);
  settings_.network.person_class = 2;
  EXPECT_EQ(make()->detect(red)->size(), 1U);
}

TEST_F(NetworkDetector, TakesThePictureAsTheFileSays) {
  test::writeYolo8(settings_.detector, 320, 320, 1, 0);
  const auto red = pictureWith(kRed, 192, 136, 256, 200);
  EXPECT_EQ(make()->detect(red)->size(), 1U);
  settings_.network.red_first = false;
  EXPECT_EQ(make()->detect(red)->size(), 0U);
  settings_.network.red_first = true;
  settings_.network.scale = 0.4 / 255.0;
  EXPECT_EQ(make()->detect(red)->size(), 0U);
  settings_.network.scale.reset();
  settings_.network.mean.emplace(140.0, 0.0, 0.0);
  EXPECT_EQ(make()->detect(red)->size(), 0U);
}

TEST_F(NetworkDetector, TakesTheSizeThatDarknetsFileSays) {
  settings_.detector = folder_.file("n.weights");
  settings_.network.input_px.reset();
  test::writeDarknet(settings_.detector, 352, 256);
  const std::string name = make()->name();
  EXPECT_NE(name.find("352 x 256 pixels"), std::string::npos) << name;
}

TEST_F(NetworkDetector, TakesTheSizeThatCaffesFileSays) {
  settings_.detector = folder_.file("n.caffemodel");
  settings_.network.input_px.reset();
  test::writeCaffeSsd(settings_.detector, 384);
  const auto detector = make();
  EXPECT_NE(detector->name().find("384 x 384 pixels"), std::string::npos) << detector->name();
  const auto boxes = detector->detect(pictureWith(kRed, 160.0, 133.0, 213.0, 167.0));
  ASSERT_TRUE(boxes);
  ASSERT_EQ(boxes->size(), 1U);
  EXPECT_NEAR(boxes->front().left, 80 * kWidth / 384.0, 0.5);
  EXPECT_NEAR(boxes->front().bottom, 192 * kHeight / 384.0, 0.5);
}

// The boxes are those of the camera's pixels.
TEST_F(NetworkDetector, TurnsNoPicture) {
  test::writeYolo8(settings_.detector, 320, 320, 1, 0);
  const auto upright = pictureWith(kRed, 192, 136, 256, 200);
  const auto expected = make()->detect(upright);
  ASSERT_TRUE(expected);
  ASSERT_EQ(expected->size(), 1U);
  // EXIF that says: upside down. A directory of one entry, Orientation, the short 3.
  const std::vector<std::uint8_t> exif{0xFF, 0xE1, 0, 34, 'E', 'x', 'i', 'f', 0,    0,    'I', 'I',
                                       42,   0,    8, 0,  0,   0,   1,   0,   0x12, 0x01, 3,   0,
                                       1,    0,    0, 0,  3,   0,   0,   0,   0,    0,    0,   0};
  auto marked = upright;
  marked.insert(marked.begin() + 2, exif.begin(), exif.end());
  const auto boxes = make()->detect(marked);
  ASSERT_TRUE(boxes);
  ASSERT_EQ(boxes->size(), 1U);
  EXPECT_EQ(boxes->front().left, expected->front().left);
  EXPECT_EQ(boxes->front().top, expected->front().top);
}

TEST_F(NetworkDetector, IsTimedAtTheStart) {
  test::writeYolo8(settings_.detector, 320, 320, 80, 0);
  EXPECT_GT(make()->pictureS(), 0.0);
  settings_.image_delay_s = 0.3;
  settings_.image_period_s = 0.2;
  EXPECT_EQ(whyTooSlow(0.06, 3, settings_), "");
  EXPECT_EQ(whyTooSlow(0.07, 3, settings_),
            "to find people in a picture of each of 3 cameras takes 0.21 s, more than "
            "perception.image_delay_s (0.3) or image_period_s (0.2): tracks will wait for it");
  settings_.image_delay_s = 0.1;
  EXPECT_NE(whyTooSlow(0.15, 1, settings_), "");
}

TEST_F(NetworkDetector, RefusesASizeThatTheNetworkDoesNotTake) {
  test::writeYolo5(settings_.detector, 320, 256, 1, 0);
  const std::string said = refusal();
  EXPECT_NE(said.find("lab.yaml: perception.network.input_px"), std::string::npos) << said;
  EXPECT_NE(said.find("320 x 320 pixels"), std::string::npos) << said;
}

TEST_F(NetworkDetector, RefusesWhatSaysNoBoxes) {
  test::writeClassifier(settings_.detector, 320, 320, 10);
  const std::string said = refusal();
  EXPECT_NE(said.find("perception.detector"), std::string::npos) << said;
  EXPECT_NE(said.find("whose output is 1 x 10"), std::string::npos) << said;
}

TEST_F(NetworkDetector, RefusesAClassThatTheNetworkDoesNotHave) {
  test::writeYolo8(settings_.detector, 320, 320, 3, 2);
  settings_.network.person_class = 3;
  const std::string said = refusal();
  EXPECT_NE(said.find("perception.network.person_class: expected below 3"), std::string::npos)
      << said;
}

TEST_F(NetworkDetector, RefusesATornFile) {
  test::writeYolo8(settings_.detector, 320, 320, 3, 2);
  std::filesystem::resize_file(settings_.detector,
                               std::filesystem::file_size(settings_.detector) / 2);
  const std::string said = refusal();
  EXPECT_NE(said.find("perception.detector"), std::string::npos) << said;
  EXPECT_NE(said.find(settings_.detector), std::string::npos) << said;
}

TEST_F(NetworkDetector, RefusesTornWeightsOfDarknet) {
  settings_.detector = folder_.file("n.weights");
  test::writeDarknet(settings_.detector, 320, 320);
  const auto whole = std::filesystem::file_size(settings_.detector);
  std::filesystem::resize_file(settings_.detector, whole - 8);
  const std::string said = refusal();
  EXPECT_NE(said.find("perception.detector: expected the whole file"), std::string::npos) << said;
  EXPECT_NE(said.find(fmt::format("n.weights\" of {}", whole - 8)), std::string::npos) << said;
}

TEST_F(NetworkDetector, RefusesWhatSaysNoNumbers) {
  settings_.detector = folder_.file("n.weights");
  test::writeDarknet(settings_.detector, 320, 320);
  constexpr std::streamoff kFirstBias = 20;
  const float nan = std::numeric_limits<float>::quiet_NaN();
  std::fstream(settings_.detector, std::ios::binary | std::ios::in | std::ios::out)
      .seekp(kFirstBias)
      .write(reinterpret_cast<const char*>(&nan), sizeof(nan));
  const std::string said = refusal();
  EXPECT_NE(said.find("which does not say numbers"), std::string::npos) << said;
}

TEST_F(NetworkDetector, RefusesAPathThatNoFileCanHave) {
  settings_.detector = std::string(5000, 'a') + ".onnx";
  EXPECT_NE(refusal().find("lab.yaml: perception.detector"), std::string::npos) << refusal();
}

TEST_F(NetworkDetector, RefusesWeightsWithoutTheFileBesideThem) {
  settings_.detector = folder_.file("n.caffemodel");
  test::writeCaffeSsd(settings_.detector, 300);
  std::filesystem::remove(folder_.file("n.prototxt"));
  const std::string said = refusal();
  EXPECT_NE(said.find("n.prototxt\" beside the weights"), std::string::npos) << said;
}

cv::Mat zeros(const std::vector<int>& sizes) { return {sizes, CV_32F, cv::Scalar(0.0)}; }

TEST(NetworkOutput, IsNoDetectorsIfItOnlyLooksLikeOne) {
  EXPECT_TRUE(recogniseOutput({zeros({1, 1, 100, 7})}));
  EXPECT_FALSE(recogniseOutput({zeros({1, 512, 7, 7})})) << "features of a picture";
  EXPECT_TRUE(recogniseOutput({zeros({1, 3000, 4}), zeros({1, 3000, 21})}));
  EXPECT_FALSE(recogniseOutput({zeros({1, 4}), zeros({1, 21})})) << "one box of a regression";
  EXPECT_FALSE(recogniseOutput({zeros({1, 20, 9, 4}), zeros({1, 20, 9, 21})})) << "features";
  EXPECT_FALSE(recogniseOutput({zeros({1, 3000, 4}), zeros({1, 3000, 4})})) << "which are boxes?";
  EXPECT_TRUE(recogniseOutput({zeros({1, 6300, 6})}));
  EXPECT_FALSE(recogniseOutput({zeros({1, 300, 6})})) << "corners, score and class";
}

TEST(NetworkOutput, WhatIsNoBoxDisplacesNobody) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  constexpr double kFar = std::numeric_limits<double>::infinity();
  const auto left = withoutDoubles({{kNan, 0.0, 50.0, 100.0, 0.99},
                                    {10.0, 10.0, 50.0, 100.0, 0.9},
                                    {11.0, 10.0, 50.0, 100.0, 0.8},
                                    {90.0, 10.0, 60.0, 100.0, 0.95},
                                    {-kFar, -kFar, kFar, kFar, 0.97},
                                    {12.0, 10.0, 50.0, 100.0, kFar},
                                    {200.0, 10.0, 240.0, 100.0, 0.7}});
  ASSERT_EQ(left.size(), 2U);
  EXPECT_EQ(left[0].confidence, 0.9);
  EXPECT_EQ(left[1].confidence, 0.7);
}

}  // namespace
}  // namespace roundabout::perception
