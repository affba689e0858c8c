#include "mocap_bridge/estimation/axes.h"

#include "common/core/error.h"

namespace roundabout::mocap_bridge {

namespace {

constexpr const char* kExpected = "auto, y_up, z_up or three of x, y, z with signs, as \"x,-z,y\"";

[[noreturn]] void refuse(const std::string& expected, const std::string& axes) {
  throw core::StartupError("mocap", "axes", expected, "\"" + axes + "\"");
}

}  // namespace

AxisMap::AxisMap(const std::string& axes) {
  if (axes == "z_up") {
    return;
  }
  const std::string text = axes == "y_up" ? "x,-z,y" : axes;
  rotation_.setZero();
  std::size_t at = 0;
  for (int row = 0; row < 3; ++row) {
    if (row > 0 && (at >= text.size() || text[at++] != ',')) {
      refuse(kExpected, axes);
    }
    double sign = 1.0;
    if (at < text.size() && (text[at] == '-' || text[at] == '+')) {
      sign = text[at++] == '-' ? -1.0 : 1.0;
    }
    if (at >= text.size() || text[at] < 'x' || text[at] > 'z') {
      refuse(kExpected, axes);
    }
    rotation_(row, text[at++] - 'x') = sign;
  }
  if (at != text.size()) {
    refuse(kExpected, axes);
  }
  const double determinant = rotation_.determinant();
  if (determinant == 0.0) {
    refuse("each of x, y and z once", axes);
  }
  if (determinant < 0.0) {
    refuse(
        "right-handed axes (this is a mirror image; one sign or one pair is the wrong way round)",
        axes);
  }
}

AxisMap AxisMap::inverse() const {
  AxisMap inverse;
  inverse.rotation_ = rotation_.transpose();
  return inverse;
}

}  // namespace roundabout::mocap_bridge
