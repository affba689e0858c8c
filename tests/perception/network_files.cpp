#include "tests/perception/network_files.h"

#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <string_view>
#include <vector>

#include <fmt/format.h>

namespace roundabout::test {

namespace {

constexpr int kCell = 32;
constexpr float kBoxWidth = 64.0F;
constexpr float kBoxHeight = 96.0F;

/// A message of Protocol Buffers, field by field.
class Fields {
 public:
  Fields& number(int field, std::int64_t value) {
    varint(static_cast<std::uint64_t>(field) << 3U);
    varint(static_cast<std::uint64_t>(value));
    return *this;
  }
  Fields& bytes(int field, std::string_view value) {
    varint((static_cast<std::uint64_t>(field) << 3U) | 2U);
    varint(value.size());
    text_ += value;
    return *this;
  }
  Fields& message(int field, const Fields& value) { return bytes(field, value.text_); }
  Fields& floats(int field, const std::vector<float>& values) {
    std::string raw(values.size() * sizeof(float), '\0');
    std::memcpy(raw.data(), values.data(), raw.size());
    return bytes(field, raw);
  }
  const std::string& text() const { return text_; }

 private:
  void varint(std::uint64_t value) {
    for (; value >= 0x80U; value >>= 7U) {
      text_ += static_cast<char>((value & 0x7FU) | 0x80U);
    }
    text_ += static_cast<char>(value);
  }

  std::string text_;
};

void writeFile(const std::string& path, const std::string& text) {
  std::ofstream(path, std::ios::binary) << text;
}

/// A graph of ONNX (onnx.proto, IR version 7, operator set 12).
class OnnxGraph {
 public:
  void input(const std::string& name, int width, int height) {
    Fields shape;
    for (const int size : {1, 3, height, width}) {
      shape.message(1, Fields().number(1, size));
    }
    const Fields tensor = Fields().number(1, 1).message(2, shape);
    graph_.message(11, Fields().bytes(1, name).message(2, Fields().message(1, tensor)));
  }
  void output(const std::string& name) {
    const Fields tensor = Fields().number(1, 1).message(2, {});
    graph_.message(12, Fields().bytes(1, name).message(2, Fields().message(1, tensor)));
  }

  void floats(const std::string& name, const std::vector<std::int64_t>& shape,
              const std::vector<float>& values) {
    Fields tensor;
    for (const std::int64_t size : shape) {
      tensor.number(1, size);
    }
    graph_.message(5, tensor.number(2, 1).bytes(8, name).floats(4, values));
  }
  void integers(const std::string& name, const std::vector<std::int64_t>& values) {
    Fields tensor;
    tensor.number(1, static_cast<std::int64_t>(values.size())).number(2, 7).bytes(8, name);
    for (const std::int64_t value : values) {
      tensor.number(7, value);
    }
    graph_.message(5, tensor);
  }
  struct Attribute {
    std::string name;
    std::vector<std::int64_t> values;
  };
  void node(const std::string& type, const std::vector<std::string>& inputs,
            const std::string& output, const std::vector<Attribute>& attributes = {}) {
    Fields node;
    for (const std::string& input : inputs) {
      node.bytes(1, input);
    }
    node.bytes(2, output).bytes(3, output).bytes(4, type);
    for (const Attribute& each : attributes) {
      constexpr int kIntegers = 7;
      Fields attribute;
      attribute.bytes(1, each.name);
      for (const std::int64_t value : each.values) {
        attribute.number(8, value);
      }
      node.message(5, attribute.number(20, kIntegers));
    }
    graph_.message(1, node);
  }
  void write(const std::string& path) {
    graph_.bytes(2, "red");
    writeFile(path,
              Fields().number(1, 7).message(7, graph_).message(8, Fields().number(2, 12)).text());
  }

 private:
  Fields graph_;
};

/// Of a convolution over cells, from three planes to `outputs`: the plane `red_at` of the output
/// is how far red exceeds the others, the rest is 0. `planes_red`: which plane of the input is red.
std::vector<float> findRed(int outputs, int red_at, int plane_red, float gain) {
  std::vector<float> weights(static_cast<std::size_t>(outputs) * 3 * kCell * kCell, 0.0F);
  for (int plane = 0; plane < 3; ++plane) {
    const float weight = gain * (plane == plane_red ? 1.0F : -0.5F) / (kCell * kCell);
    const auto begin = weights.begin() + (red_at * 3 + plane) * kCell * kCell;
    std::fill(begin, begin + kCell * kCell, weight);
  }
  return weights;
}

/// input -> "cells": outputs x (height / 32) x (width / 32), and -> "rows": outputs x cells.
void addCells(OnnxGraph& graph, int outputs, int red_at, float gain) {
  graph.floats("weights", {outputs, 3, kCell, kCell}, findRed(outputs, red_at, 0, gain));
  graph.node("Conv", {"input", "weights"}, "cells",
             {{"kernel_shape", {kCell, kCell}}, {"strides", {kCell, kCell}}});
  graph.integers("flat", {1, outputs, -1});
  graph.node("Reshape", {"cells", "flat"}, "columns");
}

std::vector<float> middles(int width, int height) {
  std::vector<float> xy;
  for (int row = 0; row < height / kCell; ++row) {
    for (int column = 0; column < width / kCell; ++column) {
      xy.push_back(static_cast<float>(kCell) * (static_cast<float>(column) + 0.5F));
      xy.push_back(static_cast<float>(kCell) * (static_cast<float>(row) + 0.5F));
    }
  }
  return xy;
}

}  // namespace

void writeYolo5(const std::string& path, int width, int height, int classes, int person) {
  const int outputs = 5 + classes;
  const std::vector<float> xy = middles(width, height);
  const std::size_t cells = xy.size() / 2;
  std::vector<float> rest(cells * static_cast<std::size_t>(outputs), 0.0F);
  for (std::size_t i = 0; i < cells; ++i) {
    float* row = rest.data() + i * static_cast<std::size_t>(outputs);
    row[0] = xy[2 * i];
    row[1] = xy[2 * i + 1];
    row[2] = kBoxWidth;
    row[3] = kBoxHeight;
    row[5 + person] = 1.0F;
  }
  OnnxGraph graph;
  graph.input("input", width, height);
  addCells(graph, outputs, 4, 1.0F);
  graph.node("Transpose", {"columns"}, "rows", {{"perm", {0, 2, 1}}});
  graph.floats("rest", {1, static_cast<std::int64_t>(cells), outputs}, rest);
  graph.node("Add", {"rows", "rest"}, "output");
  graph.output("output");
  graph.write(path);
}

void writeYolo8(const std::string& path, int width, int height, int classes, int person) {
  const int outputs = 4 + classes;
  const std::vector<float> xy = middles(width, height);
  const std::size_t cells = xy.size() / 2;
  std::vector<float> rest(cells * static_cast<std::size_t>(outputs), 0.0F);
  for (std::size_t i = 0; i < cells; ++i) {
    rest[i] = xy[2 * i];
    rest[cells + i] = xy[2 * i + 1];
    rest[2 * cells + i] = kBoxWidth;
    rest[3 * cells + i] = kBoxHeight;
  }
  OnnxGraph graph;
  graph.input("input", width, height);
  addCells(graph, outputs, 4 + person, 1.0F);
  graph.floats("rest", {1, outputs, static_cast<std::int64_t>(cells)}, rest);
  graph.node("Add", {"columns", "rest"}, "output");
  graph.output("output");
  graph.write(path);
}

void writeOnnxSsd(const std::string& path, int width, int height, int classes, int person) {
  const std::vector<float> xy = middles(width, height);
  const auto cells = static_cast<std::int64_t>(xy.size() / 2);
  std::vector<float> corners;
  for (std::size_t i = 0; i < xy.size(); i += 2) {
    const auto w = static_cast<float>(width);
    const auto h = static_cast<float>(height);
    corners.insert(corners.end(), {(xy[i] - kBoxWidth / 2) / w, (xy[i + 1] - kBoxHeight / 2) / h,
                                   (xy[i] + kBoxWidth / 2) / w, (xy[i + 1] + kBoxHeight / 2) / h});
  }
  OnnxGraph graph;
  graph.input("input", width, height);
  // (x - 127) / 128 is 255 / 128 times as far apart as x / 255.
  addCells(graph, classes, person, 128.0F / 255.0F);
  graph.node("Transpose", {"columns"}, "scores", {{"perm", {0, 2, 1}}});
  // Boxes that depend on the input by nothing, as an importer folds what is constant.
  graph.floats("none", {4, 3, kCell, kCell}, std::vector<float>(4UL * 3 * kCell * kCell, 0.0F));
  graph.node("Conv", {"input", "none"}, "nowhere",
             {{"kernel_shape", {kCell, kCell}}, {"strides", {kCell, kCell}}});
  graph.integers("flat_boxes", {1, 4, -1});
  graph.node("Reshape", {"nowhere", "flat_boxes"}, "nowhere_columns");
  graph.node("Transpose", {"nowhere_columns"}, "nowhere_rows", {{"perm", {0, 2, 1}}});
  graph.floats("corners", {1, cells, 4}, corners);
  graph.node("Add", {"nowhere_rows", "corners"}, "boxes");
  graph.output("scores");
  graph.output("boxes");
  graph.write(path);
}

void writeClassifier(const std::string& path, int width, int height, int classes) {
  OnnxGraph graph;
  graph.input("input", width, height);
  graph.floats("weights", {classes, 3, kCell, kCell}, findRed(classes, 0, 0, 1.0F));
  graph.node("Conv", {"input", "weights"}, "cells",
             {{"kernel_shape", {kCell, kCell}}, {"strides", {kCell, kCell}}});
  graph.node("GlobalAveragePool", {"cells"}, "mean");
  graph.integers("flat", {1, classes});
  graph.node("Reshape", {"mean", "flat"}, "output");
  graph.output("output");
  graph.write(path);
}

void writeCaffeSsd(const std::string& path, int side) {
  constexpr int kClasses = 21;
  constexpr int kPerson = 15;
  // Priors of 64 x 96 pixels: one of PriorBox's sizes is the root of its area, the ratio 2 / 3.
  writeFile(std::filesystem::path(path).replace_extension(".prototxt"),
            fmt::format(R"(name: "red"
input: "data"
input_shape {{ dim: 1 dim: 3 dim: {0} dim: {0} }}
layer {{ name: "conf" type: "Convolution" bottom: "data" top: "conf"
  convolution_param {{ num_output: {1} kernel_size: {2} stride: {2} bias_term: false }} }}
layer {{ name: "conf_perm" type: "Permute" bottom: "conf" top: "conf_perm"
  permute_param {{ order: 0 order: 2 order: 3 order: 1 }} }}
layer {{ name: "conf_flat" type: "Flatten" bottom: "conf_perm" top: "conf_flat" flatten_param {{ axis: 1 }} }}
layer {{ name: "loc" type: "Convolution" bottom: "data" top: "loc"
  convolution_param {{ num_output: 4 kernel_size: {2} stride: {2} bias_term: false }} }}
layer {{ name: "loc_perm" type: "Permute" bottom: "loc" top: "loc_perm"
  permute_param {{ order: 0 order: 2 order: 3 order: 1 }} }}
layer {{ name: "loc_flat" type: "Flatten" bottom: "loc_perm" top: "loc_flat" flatten_param {{ axis: 1 }} }}
layer {{ name: "priors" type: "PriorBox" bottom: "loc" bottom: "data" top: "priors"
  prior_box_param {{ width: {3} height: {4} variance: 0.1 variance: 0.1 variance: 0.2 variance: 0.2
    step: {2} offset: 0.5 flip: false clip: false }} }}
layer {{ name: "detection_out" type: "DetectionOutput" bottom: "loc_flat" bottom: "conf_flat" bottom: "priors" top: "detection_out"
  detection_output_param {{ num_classes: {1} share_location: true background_label_id: 0
    nms_param {{ nms_threshold: 0.45 top_k: 100 }} code_type: CENTER_SIZE keep_top_k: 100 confidence_threshold: 0.01 }} }}
)",
                        side, kClasses, kCell, kBoxWidth, kBoxHeight));
  const auto layer = [](const std::string& name, int outputs, const std::vector<float>& weights) {
    Fields shape;
    for (const int size : {outputs, 3, kCell, kCell}) {
      shape.number(1, size);
    }
    const Fields blob = Fields().message(7, shape).floats(5, weights);
    return Fields().bytes(1, name).bytes(2, "Convolution").message(7, blob);
  };
  writeFile(path,
            Fields()
                .bytes(1, "red")
                // In the order blue, green, red.
                .message(100, layer("conf", kClasses, findRed(kClasses, kPerson, 2, 0.5F)))
                .message(100, layer("loc", 4, std::vector<float>(4UL * 3 * kCell * kCell, 0.0F)))
                .text());
}

void writeDarknet(const std::string& path, int width, int height) {
  constexpr int kOutputs = 6;
  writeFile(
      std::filesystem::path(path).replace_extension(".cfg"),
      fmt::format("[net]\n# the input\nwidth = {}\nheight={}\nchannels=3\n\n"
                  "[convolutional]\nfilters={}\nsize={}\nstride={}\npad=0\nactivation=linear\n\n"
                  "[yolo]\nmask=0\nanchors={},{}\nclasses=1\nnum=1\n",
                  width, height, kOutputs, kCell, kCell, kBoxWidth, kBoxHeight));
  // Objectness and class pass a sigmoid: 20 x, where x is 0.5 more or less than red exceeds.
  std::string text;
  const auto add = [&text](const auto& value) {
    text.append(reinterpret_cast<const char*>(&value), sizeof(value));
  };
  for (const std::int32_t version : {0, 2, 0}) {
    add(version);
  }
  add(std::int64_t{0});
  const std::vector<float> biases{0.0F, 0.0F, 0.0F, 0.0F, -10.0F, 10.0F};
  for (const float bias : biases) {
    add(bias);
  }
  for (const float weight : findRed(kOutputs, 4, 0, 20.0F)) {
    add(weight);
  }
  writeFile(path, text);
}

}  // namespace roundabout::test
