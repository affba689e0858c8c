#include "perception/vision/network_output.h"

#include <opencv2/dnn.hpp>

namespace roundabout::perception {

namespace {

using Kind = NetworkOutput::Kind;

constexpr int kCorners = 4;
constexpr int kDetection = 7;
// Networks that leave out doubles themselves say few boxes: left, top, right, bottom, score, class.
constexpr int kFinished = 6;
constexpr int kMostFinished = 300;
constexpr float kOverlap = 0.45F;
constexpr int kMostBoxes = 300;  // in one picture

/// Rows of numbers. Else they are features of a picture's places.
bool isTable(const cv::Mat& output) {
  return output.dims == 2 || (output.dims == 3 && output.size[0] == 1);
}

int columnsOf(const cv::Mat& output) { return output.size[output.dims - 1]; }

int rowsOf(const cv::Mat& output) {
  return static_cast<int>(output.total()) / std::max(columnsOf(output), 1);
}

cv::Mat asTable(const cv::Mat& output) {
  return {rowsOf(output), columnsOf(output), CV_32F, const_cast<uchar*>(output.ptr())};
}

std::optional<NetworkOutput> recogniseSplit(const std::vector<cv::Mat>& outputs) {
  if (outputs.size() != 2 || !isTable(outputs[0]) || !isTable(outputs[1]) ||
      rowsOf(outputs[0]) != rowsOf(outputs[1])) {
    return std::nullopt;
  }
  const bool is_ambiguous = columnsOf(outputs[0]) == kCorners && columnsOf(outputs[1]) == kCorners;
  const bool is_one_answer = rowsOf(outputs[0]) == 1;
  if (is_ambiguous || is_one_answer) {
    return std::nullopt;
  }
  const int boxes_at = columnsOf(outputs[0]) == kCorners ? 0 : 1;
  const cv::Mat& scores = outputs[static_cast<std::size_t>(1 - boxes_at)];
  if (columnsOf(outputs[static_cast<std::size_t>(boxes_at)]) != kCorners || columnsOf(scores) < 2) {
    return std::nullopt;
  }
  return NetworkOutput{Kind::kSplit, columnsOf(scores), boxes_at};
}

std::optional<NetworkOutput> recogniseYolo(const cv::Mat& output) {
  if (!isTable(output)) {
    return std::nullopt;
  }
  if (output.dims == 2) {
    const int classes = columnsOf(output) - kCorners - 1;
    const bool is_one_answer = rowsOf(output) == 1;  // of a classifier
    return is_one_answer || classes < 1 ? std::nullopt
                                        : std::optional(NetworkOutput{Kind::kRegions, classes});
  }
  // There are more boxes than numbers of a box.
  const bool columns = output.size[1] < output.size[2];
  const int numbers = columns ? output.size[1] : output.size[2];
  const int before_scores = columns ? kCorners : kCorners + 1;
  const bool is_finished = !columns && numbers == kFinished && output.size[1] <= kMostFinished;
  if (numbers <= before_scores || is_finished) {
    return std::nullopt;
  }
  return NetworkOutput{columns ? Kind::kColumns : Kind::kRows, numbers - before_scores};
}

void addDetections(const cv::Mat& rows, int person, cv::Size input, std::vector<PersonBox>& boxes) {
  for (int i = 0; i < rows.rows; ++i) {
    const float* row = rows.ptr<float>(i);
    if (row[1] == static_cast<float>(person)) {
      boxes.push_back({row[3] * input.width, row[4] * input.height, row[5] * input.width,
                       row[6] * input.height, row[2]});
    }
  }
}

void addSplit(const cv::Mat& corners, const cv::Mat& scores, int person, double least_confidence,
              cv::Size input, std::vector<PersonBox>& boxes) {
  for (int i = 0; i < corners.rows; ++i) {
    const float* corner = corners.ptr<float>(i);
    const float confidence = scores.at<float>(i, person);
    if (confidence >= least_confidence) {
      boxes.push_back({corner[0] * input.width, corner[1] * input.height, corner[2] * input.width,
                       corner[3] * input.height, confidence});
    }
  }
}

void addYolo(const cv::Mat& rows, Kind kind, int person, double least_confidence, cv::Size input,
             std::vector<PersonBox>& boxes) {
  const int score_at = (kind == Kind::kColumns ? kCorners : kCorners + 1) + person;
  for (int i = 0; i < rows.rows; ++i) {
    const float* row = rows.ptr<float>(i);
    const float confidence = row[score_at] * (kind == Kind::kRows ? row[kCorners] : 1.0F);
    if (!(confidence >= least_confidence)) {
      continue;
    }
    // Darknet's are shares, and so are those of some exports: no person is 2 pixels wide and high.
    const bool shares = kind == Kind::kRegions || (row[2] <= 2.0F && row[3] <= 2.0F);
    const double across = shares ? input.width : 1.0;
    const double along = shares ? input.height : 1.0;
    boxes.push_back({(row[0] - row[2] / 2) * across, (row[1] - row[3] / 2) * along,
                     (row[0] + row[2] / 2) * across, (row[1] + row[3] / 2) * along, confidence});
  }
}

}  // namespace

std::optional<NetworkOutput> recogniseOutput(const std::vector<cv::Mat>& outputs) {
  for (const cv::Mat& output : outputs) {
    if (output.type() != CV_32F || output.dims < 2 || output.empty()) {
      return std::nullopt;
    }
  }
  if (outputs.size() == 1 && outputs[0].dims == 4 && columnsOf(outputs[0]) == kDetection) {
    const bool is_one_list = outputs[0].size[0] == 1 && outputs[0].size[1] == 1;
    return is_one_list ? std::optional(NetworkOutput{Kind::kDetections}) : std::nullopt;
  }
  if (auto split = recogniseSplit(outputs)) {
    return split;
  }
  std::optional<NetworkOutput> common;
  for (const cv::Mat& output : outputs) {
    const auto each = recogniseYolo(output);
    if (!each || (common && (each->kind != common->kind || each->classes != common->classes))) {
      return std::nullopt;
    }
    common = each;
  }
  return common;
}

int customaryPerson(const NetworkOutput& output) {
  constexpr int kVocClasses = 20;
  constexpr int kVocPerson = 14;
  const int background = output.isYolo() ? 0 : 1;
  return (output.classes == kVocClasses + background ? kVocPerson : 0) + background;
}

std::vector<PersonBox> readBoxes(const NetworkOutput& output, const std::vector<cv::Mat>& outputs,
                                 int person, double least_confidence, cv::Size input) {
  std::vector<PersonBox> boxes;
  if (output.kind == Kind::kSplit) {
    const auto boxes_at = static_cast<std::size_t>(output.boxes_at);
    addSplit(asTable(outputs[boxes_at]), asTable(outputs[1 - boxes_at]), person, least_confidence,
             input, boxes);
    return boxes;
  }
  for (const cv::Mat& each : outputs) {
    if (output.kind == Kind::kDetections) {
      addDetections(asTable(each), person, input, boxes);
    } else if (output.kind == Kind::kColumns) {
      const cv::Mat columns(each.size[1], each.size[2], CV_32F, const_cast<uchar*>(each.ptr()));
      addYolo(columns.t(), output.kind, person, least_confidence, input, boxes);
    } else {
      addYolo(asTable(each), output.kind, person, least_confidence, input, boxes);
    }
  }
  return boxes;
}

std::vector<PersonBox> withoutDoubles(std::vector<PersonBox> boxes) {
  std::erase_if(boxes, [](const PersonBox& box) { return !isBox(box); });
  std::vector<cv::Rect2d> places;
  std::vector<float> confidences;
  for (const PersonBox& box : boxes) {
    places.emplace_back(box.left, box.top, box.right - box.left, box.bottom - box.top);
    confidences.push_back(static_cast<float>(box.confidence));
  }
  std::vector<int> kept;
  cv::dnn::NMSBoxes(places, confidences, 0.0F, kOverlap, kept, 1.0F, kMostBoxes);
  std::vector<PersonBox> result;
  for (const int index : kept) {
    result.push_back(boxes[static_cast<std::size_t>(index)]);
  }
  return result;
}

}  // namespace roundabout::perception
