#pragma once

#include <string>
#include <vector>

#include "common/plot/canvas.h"
#include "logs/flight.h"
#include "logs/metrics/metrics.h"

namespace roundabout::logs {

/// One picture, as a bitmap and as vectors.
struct Figure {
  std::string title;
  std::string caption;
  std::string png_file;
  std::string svg_file;

  plot::PictureFiles files() const { return {png_file, svg_file}; }
};

struct Figures {
  std::vector<Figure> formations;  ///< one each, in the paper's style
  Figure overview;
  /// Separation, speed, modes, rates, latency; frame intervals if flown in real time.
  std::vector<Figure> over_time;

  /// How many pictures there are.
  std::size_t count() const;
};

/// Draws all pictures of a flight into the folder, which it makes. Throws core::StartupError if
/// gnuplot is missing or the folder cannot be written. Draws nothing for a flight without frames,
/// but makes the folder.
Figures drawFlight(const Flight& flight, const Metrics& metrics, const std::string& folder);

}  // namespace roundabout::logs
