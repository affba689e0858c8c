// The only file that sees libtorch. Of its headers the two that are needed: torch/torch.h costs
// four times as much to compile.

#include <ATen/ATen.h>
#include <ATen/Parallel.h>
#include <torch/csrc/autograd/autograd.h>

#include "learning/training/scores.h"
#include "learning/training/sorted_batch.h"
#include "learning/training/torch_library.h"

namespace roundabout::learning {

namespace {

using Layer = ParameterLayout::Layer;
using at::Tensor;

/// Of memory that somebody else owns and nobody changes.
Tensor view(const float* begin, Eigen::Index rows, Eigen::Index columns) {
  return at::from_blob(const_cast<float*>(begin), {rows, columns}, at::kFloat);
}

Tensor view(const Matrix& matrix) { return view(matrix.data(), matrix.rows(), matrix.cols()); }

/// A layer's parameters, as leaves of the graph.
struct Leaves {
  Layer layer;
  Tensor kernel;
  Tensor bias;

  Tensor apply(const Tensor& input) const { return at::addmm(bias, input, kernel); }
  Tensor applyRelu(const Tensor& input) const { return at::relu(apply(input)); }
};

class TorchNetwork final : public TrainableNetwork {
 public:
  explicit TorchNetwork(const TorchPlan& plan) : plan_(plan) {}

  const Matrix& forward(const Parameters& parameters, const Batch& batch) override;
  void backward(const Parameters& parameters, const Batch& batch, const Matrix& d_heads,
                Parameters& gradient) override;

 private:
  void takeLeaves(const Parameters& parameters);
  const Leaves& leaf(const char* name) const { return leaves_.at(name); }

  Tensor summary(const Batch& batch);
  Tensor recurrent() const;
  Tensor shared() const;
  Tensor pooled() const;
  Tensor attentive() const;
  Tensor readPairs() const;
  Tensor none(Eigen::Index observations, Eigen::Index units) const {
    return at::zeros({observations, units});
  }

  const TorchPlan plan_;
  SortedBatch sorted_;
  std::map<std::string, Leaves, std::less<>> leaves_;
  Tensor output_;
  // The graph refers to these.
  Matrix egos_, read_;
  Matrix heads_, d_heads_;
};

void TorchNetwork::takeLeaves(const Parameters& parameters) {
  for (const auto& [name, layer] : plan_.layers) {
    Leaves& leaves = leaves_[name];
    leaves.layer = layer;
    leaves.kernel = view(parameters.data() + layer.kernel, layer.inputs, layer.outputs);
    leaves.kernel.requires_grad_();
    if (layer.bias >= 0) {
      leaves.bias = view(parameters.data() + layer.bias, 1, layer.outputs);
      leaves.bias.requires_grad_();
    }
  }
}

Tensor TorchNetwork::summary(const Batch& batch) {
  if (plan_.architecture == "ga3c_cadrl_lstm") {
    read_ = sorted_.byStep(batch);
    return recurrent();
  }
  if (plan_.architecture == "ga3c_cadrl_ws") {
    read_ = sorted_.slots(batch, plan_.max_others);
    return shared();
  }
  read_ = sorted_.pairs(batch);
  return plan_.architecture == "ga3c_cadrl_attention" ? attentive() : pooled();
}

// Rows are those who read at the first step, then those at the second, and so on; they are the
// first rows of the step before.
Tensor TorchNetwork::recurrent() const {
  constexpr float kForgetBias = 1.0F;  // as the planner's loader
  const Leaves& lstm = leaf("lstm");
  const Eigen::Index units = lstm.layer.outputs / 4;
  const Eigen::Index fields = planner::kOtherInputs;
  const Tensor from_hidden = lstm.kernel.narrow(0, fields, units);
  const Tensor gates_from_inputs =
      at::addmm(lstm.bias, view(read_), lstm.kernel.narrow(0, 0, fields));
  std::vector<Tensor> ended;  // hidden states, of the last observations first
  if (const Eigen::Index alone = sorted_.size() - sorted_.readingAt(0); alone > 0) {
    ended.push_back(none(alone, units));
  }
  Tensor hidden;
  Tensor cell;
  for (std::size_t t = 0; t < sorted_.reading().size(); ++t) {
    Tensor gates = gates_from_inputs.narrow(0, sorted_.beginOfStep(t), sorted_.readingAt(t));
    if (t > 0) {
      gates = at::addmm(gates, hidden.narrow(0, 0, sorted_.readingAt(t)), from_hidden);
    }
    const std::vector<Tensor> each = gates.chunk(4, 1);
    Tensor next = at::sigmoid(each[0]) * at::tanh(each[1]);
    if (t > 0) {
      next = next + at::sigmoid(each[2] + kForgetBias) * cell.narrow(0, 0, sorted_.readingAt(t));
    }
    cell = next;
    hidden = at::sigmoid(each[3]) * at::tanh(cell);
    const Eigen::Index go_on = sorted_.readingAt(t + 1);
    if (const Eigen::Index ending = sorted_.readingAt(t) - go_on; ending > 0) {
      ended.push_back(hidden.narrow(0, go_on, ending));
    }
  }
  std::reverse(ended.begin(), ended.end());
  return at::cat(ended);
}

Tensor TorchNetwork::shared() const {
  const Leaves& other = leaf("other");
  const Tensor read = other.applyRelu(view(read_));
  return read.view({sorted_.size(), plan_.max_others * other.layer.outputs});
}

Tensor TorchNetwork::readPairs() const {
  return leaf("other2").applyRelu(leaf("other1").applyRelu(view(read_)));
}

// Observations with as many others are one dense tensor.
Tensor TorchNetwork::pooled() const {
  const Tensor read = readPairs();
  std::vector<Tensor> maxima;
  for (const SortedBatch::Group& group : sorted_.groups()) {
    maxima.push_back(group.others == 0
                         ? none(group.count, read.size(1))
                         : read.narrow(0, group.first_pair, group.count * group.others)
                               .view({group.count, group.others, read.size(1)})
                               .amax(1));
  }
  return at::cat(maxima);
}

Tensor TorchNetwork::attentive() const {
  const Tensor read = readPairs();
  const Tensor contents = leaf("content").apply(read);
  const Tensor scores = at::mm(read, leaf("score").kernel);
  const Eigen::Index units = contents.size(1);
  const Eigen::Index heads = scores.size(1);
  std::vector<Tensor> means;
  for (const SortedBatch::Group& group : sorted_.groups()) {
    if (group.others == 0) {
      means.push_back(none(group.count, units));
      continue;
    }
    const Eigen::Index pairs = group.count * group.others;
    const Tensor weights = scores.narrow(0, group.first_pair, pairs)
                               .view({group.count, group.others, heads, 1})
                               .softmax(1);
    const Tensor parts = contents.narrow(0, group.first_pair, pairs)
                             .view({group.count, group.others, heads, units / heads});
    means.push_back((weights * parts).sum(1).view({group.count, units}));
  }
  return at::cat(means);
}

const Matrix& TorchNetwork::forward(const Parameters& parameters, const Batch& batch) {
  // OpenMP keeps this for each thread.
  static thread_local const bool kAlone = (at::set_num_threads(1), true);
  static_cast<void>(kAlone);
  heads_.resize(batch.size(), kHeads);
  if (batch.size() == 0) {
    return heads_;
  }
  sorted_.sort(batch);
  egos_ = sorted_.egos(batch);
  takeLeaves(parameters);
  const Tensor joint = at::cat({view(egos_), summary(batch)}, 1);
  const Tensor wide =
      leaf("layer3").applyRelu(leaf("layer2").applyRelu(leaf("layer1").applyRelu(joint)));
  output_ = at::cat({leaf("policy").apply(wide), leaf("value").apply(wide)}, 1);
  const Eigen::Map<const Matrix> heads(output_.data_ptr<float>(), batch.size(), kHeads);
  for (Eigen::Index place = 0; place < sorted_.size(); ++place) {
    heads_.row(sorted_.observation(place)) = heads.row(place);
  }
  return heads_;
}

void TorchNetwork::backward(const Parameters&, const Batch&, const Matrix& d_heads,
                            Parameters& gradient) {
  if (d_heads.rows() == 0) {
    return;
  }
  d_heads_.resize(d_heads.rows(), kHeads);
  for (Eigen::Index place = 0; place < sorted_.size(); ++place) {
    d_heads_.row(place) = d_heads.row(sorted_.observation(place));
  }
  std::vector<Tensor> leaves;
  std::vector<Eigen::Index> begins;
  for (const auto& [name, each] : leaves_) {
    leaves.push_back(each.kernel);
    begins.push_back(each.layer.kernel);
    if (each.bias.defined()) {
      leaves.push_back(each.bias);
      begins.push_back(each.layer.bias);
    }
  }
  constexpr bool kSomeMayBeUnused = true;  // the others' layers, if there are no others
  const auto gradients = torch::autograd::grad({output_}, leaves, {view(d_heads_)}, c10::nullopt,
                                               false, kSomeMayBeUnused);
  for (std::size_t i = 0; i < leaves.size(); ++i) {
    if (gradients[i].defined()) {
      const Tensor dense = gradients[i].contiguous();
      gradient.segment(begins[i], dense.numel()) +=
          Eigen::Map<const Parameters>(dense.data_ptr<float>(), dense.numel());
    }
  }
}

}  // namespace

extern "C" __attribute__((visibility("default"))) TrainableNetwork* roundaboutMakeTorchNetwork(
    const TorchPlan& plan) {
  return new TorchNetwork(plan);
}

}  // namespace roundabout::learning
