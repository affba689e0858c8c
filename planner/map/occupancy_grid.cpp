#include "planner/map/occupancy_grid.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <string_view>
#include <system_error>

#include "common/core/sensor_data.h"

namespace roundabout::planner {

namespace {

constexpr int kDepth = 16;
constexpr double kFinest_m = 0.01;
constexpr double kCoarsest_m = 1.0;

// Squared distance, in cells, to what is not there.
constexpr double kNowhere = 1e12;

/// For each place of a line the least of (way to another)² + value there: the lower envelope of
/// parabolas (Felzenszwalb and Huttenlocher 2012), in linear time.
class DistanceTransform {
 public:
  explicit DistanceTransform(std::size_t longest)
      : values_(longest), roots_(longest), begins_(longest) {}

  void apply(double* first, std::size_t count, std::size_t stride) {
    std::size_t parabolas = 0;
    for (std::size_t at = 0; at < count; ++at) {
      values_[at] = first[at * stride];
      double begin = -kNowhere;
      while (parabolas > 0) {
        begin = crossing(roots_[parabolas - 1], at);
        if (begin > begins_[parabolas - 1]) {
          break;
        }
        --parabolas;
      }
      roots_[parabolas] = at;
      begins_[parabolas] = parabolas > 0 ? begin : -kNowhere;
      ++parabolas;
    }
    std::size_t current = 0;
    for (std::size_t at = 0; at < count; ++at) {
      const auto place = static_cast<double>(at);
      while (current + 1 < parabolas && begins_[current + 1] <= place) {
        ++current;
      }
      const double way = place - static_cast<double>(roots_[current]);
      first[at * stride] = way * way + values_[roots_[current]];
    }
  }

 private:
  // From where on the parabola over b is lower than that over a. a < b.
  double crossing(std::size_t a, std::size_t b) const {
    const auto from = static_cast<double>(a);
    const auto to = static_cast<double>(b);
    return 0.5 * (from + to + (values_[b] - values_[a]) / (to - from));
  }

  std::vector<double> values_;
  std::vector<std::size_t> roots_;
  std::vector<double> begins_;
};

/// The nodes of an OcTree behind the header of a .bt file: two bits a child, eight children a node,
/// depth first (Hornung et al. 2013, section 3.6).
class TreeReader {
 public:
  TreeReader(std::span<const std::uint8_t> nodes, double resolution_m, OccupancyGrid& grid)
      : nodes_(nodes), resolution_m_(resolution_m), grid_(grid) {}

  bool read() {
    const double half_m = std::ldexp(resolution_m_, kDepth - 1);
    return readNode({-half_m, -half_m}, 2.0 * half_m, 0) && at_ == nodes_.size();
  }

 private:
  enum Child : unsigned { kUnknown = 0, kFree = 1, kOccupied = 2, kInner = 3 };

  bool readNode(const Eigen::Vector2d& corner_m, double side_m, int depth) {
    if (depth >= kDepth || at_ + 2 > nodes_.size()) {
      return false;
    }
    const unsigned bits = nodes_[at_] | static_cast<unsigned>(nodes_[at_ + 1]) << 8U;
    at_ += 2;
    const double half_m = side_m / 2.0;
    for (unsigned child = 0; child < 8; ++child) {
      const unsigned kind = bits >> (2 * child) & 3U;
      // Bit 0 of a child's number is x, bit 1 y, bit 2 z.
      const Eigen::Vector2d corner =
          corner_m + half_m * Eigen::Vector2d(child & 1U ? 1.0 : 0.0, child & 2U ? 1.0 : 0.0);
      if (kind == kOccupied) {
        const Eigen::Vector2d inset = Eigen::Vector2d::Constant(0.25 * resolution_m_);
        grid_.occupy({corner + inset, corner + Eigen::Vector2d::Constant(half_m) - inset});
      } else if (kind == kInner && !readNode(corner, half_m, depth + 1)) {
        return false;
      }
    }
    return true;
  }

  std::span<const std::uint8_t> nodes_;
  double resolution_m_;
  OccupancyGrid& grid_;
  std::size_t at_ = 0;
};

struct Header {
  double resolution_m = 0.0;
  std::optional<std::size_t> nodes;
  std::size_t data = 0;  // where the nodes begin
};

std::optional<Header> headerOf(std::string_view text) {
  constexpr std::string_view kFirst = "# Octomap OcTree binary file";
  if (!text.starts_with(kFirst)) {
    return std::nullopt;
  }
  Header header;
  bool is_tree = false;
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = text.find('\n', begin);
    if (end == std::string_view::npos) {
      return std::nullopt;
    }
    const std::string_view line = text.substr(begin, end - begin);
    begin = end + 1;
    if (line == "data") {
      header.data = begin;
      return is_tree && header.nodes ? std::optional(header) : std::nullopt;
    }
    const std::string_view value = line.substr(std::min(line.find(' ') + 1, line.size()));
    if (line.starts_with("id ")) {
      is_tree = value == "OcTree";
    } else if (line.starts_with("res ")) {
      std::from_chars(value.data(), value.data() + value.size(), header.resolution_m);
    } else if (line.starts_with("size ")) {
      std::size_t nodes = 0;
      const auto [end_of_number, error] =
          std::from_chars(value.data(), value.data() + value.size(), nodes);
      header.nodes = error == std::errc() ? std::optional(nodes) : std::nullopt;
    }
  }
  return std::nullopt;
}

}  // namespace

OccupancyGrid::OccupancyGrid(const Eigen::AlignedBox2d& bounds_m, double resolution_m)
    : corner_m_(bounds_m.min()),
      resolution_m_(resolution_m),
      columns_(std::max(1, static_cast<int>(std::ceil(bounds_m.sizes().x() / resolution_m)))),
      rows_(std::max(1, static_cast<int>(std::ceil(bounds_m.sizes().y() / resolution_m)))),
      cells_(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_), 0) {}

std::optional<OccupancyGrid> OccupancyGrid::fromTree(std::span<const std::uint8_t> tree,
                                                     const Eigen::AlignedBox2d& bounds_m,
                                                     const char** refusal) {
  const auto refuse = [refusal](const char* reason) {
    if (refusal != nullptr) {
      *refusal = reason;
    }
    return std::nullopt;
  };
  const std::string_view text(reinterpret_cast<const char*>(tree.data()), tree.size());
  const std::optional<Header> header = headerOf(text);
  if (!header) {
    return refuse("its tree has no header of an OctoMap tree");
  }
  if (!(header->resolution_m >= kFinest_m) || !(header->resolution_m <= kCoarsest_m)) {
    return refuse("no map has its resolution");
  }
  if (bounds_m.volume() / (header->resolution_m * header->resolution_m) > core::kMostMapCells) {
    return refuse("its resolution is too fine for this room");
  }
  OccupancyGrid grid(bounds_m, header->resolution_m);
  const std::span<const std::uint8_t> nodes = tree.subspan(header->data);
  if (*header->nodes == 0 ? !nodes.empty()
                          : !TreeReader(nodes, header->resolution_m, grid).read()) {
    return refuse("its tree is cut off, or too long");
  }
  return grid;
}

OccupancyGrid::Cell OccupancyGrid::cellAt(const Eigen::Vector2d& place_m) const {
  const Eigen::Vector2d cell = (place_m - corner_m_) / resolution_m_;
  // Far outside is outside, whatever fits into an int.
  constexpr double kFar = 1e8;
  return {static_cast<int>(std::floor(std::clamp(cell.x(), -kFar, kFar))),
          static_cast<int>(std::floor(std::clamp(cell.y(), -kFar, kFar)))};
}

Eigen::Vector2d OccupancyGrid::centreOf(const Cell& cell) const {
  return corner_m_ + resolution_m_ * Eigen::Vector2d(cell.column + 0.5, cell.row + 0.5);
}

void OccupancyGrid::occupy(const Eigen::AlignedBox2d& box_m) {
  const Cell low = cellAt(box_m.min());
  const Cell high = cellAt(box_m.max());
  for (int row = std::max(low.row, 0); row <= std::min(high.row, rows_ - 1); ++row) {
    for (int column = std::max(low.column, 0); column <= std::min(high.column, columns_ - 1);
         ++column) {
      cells_[indexOf({column, row})] = 1;
    }
  }
}

std::vector<float> OccupancyGrid::clearance(double most_m) const {
  // Squared, in cells; in each pass of the nearest in a line of the pass before.
  std::vector<double> squared(cells_.size());
  std::transform(cells_.begin(), cells_.end(), squared.begin(),
                 [](std::uint8_t occupied) { return occupied != 0 ? 0.0 : kNowhere; });
  DistanceTransform transform(static_cast<std::size_t>(std::max(columns_, rows_)));
  const auto columns = static_cast<std::size_t>(columns_);
  const auto rows = static_cast<std::size_t>(rows_);
  for (std::size_t column = 0; column < columns; ++column) {
    transform.apply(squared.data() + column, rows, columns);
  }
  for (std::size_t row = 0; row < rows; ++row) {
    transform.apply(squared.data() + row * columns, columns, 1);
  }
  std::vector<float> clearance(cells_.size());
  std::transform(squared.begin(), squared.end(), clearance.begin(), [&](double cells) {
    return static_cast<float>(std::min(most_m, resolution_m_ * std::sqrt(cells)));
  });
  return clearance;
}

}  // namespace roundabout::planner
