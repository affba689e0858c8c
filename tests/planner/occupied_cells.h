#pragma once

#include <algorithm>
#include <iterator>
#include <string>
#include <vector>

#include "common/core/sensor_data.h"

namespace roundabout::test {

/// A cell of 10 cm: (0, 0) begins at the origin.
struct CellKey {
  int x;
  int y;
};

/// The nodes of an OctoMap tree in which these cells of the layer above the floor are occupied.
inline void writeNode(const std::vector<CellKey>& cells, int x, int y, int z, int half,
                      std::string& nodes) {
  unsigned bits = 0;
  std::string below;
  for (int child = 0; child < 8; ++child) {
    const int child_x = x + (child & 1 ? half : 0);
    const int child_y = y + (child & 2 ? half : 0);
    const int child_z = z + (child & 4 ? half : 0);
    std::vector<CellKey> inside;
    std::copy_if(cells.begin(), cells.end(), std::back_inserter(inside), [&](const CellKey& key) {
      return key.x >= child_x && key.x < child_x + half && key.y >= child_y &&
             key.y < child_y + half && child_z <= 0 && 0 < child_z + half;
    });
    if (!inside.empty()) {
      bits |= (half == 1 ? 2U : 3U) << (2 * child);
      if (half > 1) {
        writeNode(inside, child_x, child_y, child_z, half / 2, below);
      }
    }
  }
  nodes += static_cast<char>(bits & 0xFFU);
  nodes += static_cast<char>(bits >> 8U);
  nodes += below;
}

/// An OctoMap tree as perception sends it, made by hand.
inline core::OccupancyMap mapOf(const std::vector<CellKey>& cells) {
  std::string text = "# Octomap OcTree binary file\nid OcTree\nsize 1\nres 0.1\ndata\n";
  writeNode(cells, -32768, -32768, -32768, 32768, text);
  core::OccupancyMap map;
  map.resolution_m = 0.1;
  map.tree.assign(text.begin(), text.end());
  return map;
}

}  // namespace roundabout::test
