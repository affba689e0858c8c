#include "fleet/formations/stroke_font.h"

#include <cstdlib>
#include <memory>

#include "common/core/error.h"

extern "C" {
#include <hersheyfont.h>
}

namespace roundabout::fleet {

namespace {

constexpr double kCapitalHeight = 21.0;  // in the font's units
constexpr char kFirstVisible = '!';
constexpr char kLastVisible = '~';

std::string installedFont() {
  const char* folder = std::getenv("HERSHEY_FONTS_DIR");
  return std::string(folder != nullptr ? folder : "/usr/share/hershey-fonts") + "/futural.jhf";
}

std::vector<Stroke> strokesOf(const hershey_glyph& glyph) {
  std::vector<Stroke> strokes;
  for (const hershey_path* path = glyph.paths; path != nullptr; path = path->next) {
    Stroke& stroke = strokes.emplace_back();
    for (int i = 0; i < path->nverts; ++i) {
      // The vertices are a C flexible array at the end of the struct.
      const hershey_vertex& vertex = (&path->verts[0])[i];
      stroke.emplace_back(vertex.x / kCapitalHeight, vertex.y / kCapitalHeight);
    }
  }
  return strokes;
}

}  // namespace

StrokeFont::StrokeFont() : StrokeFont(installedFont()) {}

StrokeFont::StrokeFont(const std::string& file) {
  const std::unique_ptr<hershey_font, decltype(&hershey_font_free)> font(
      hershey_jhf_font_load(file.c_str()), &hershey_font_free);
  if (font == nullptr) {
    throw core::StartupError(file, "letters", "the font of package hershey-fonts-data", "none");
  }
  for (char character = kFirstVisible; character <= kLastVisible; ++character) {
    const hershey_glyph* glyph =
        hershey_font_glyph(font.get(), static_cast<unsigned char>(character));
    if (glyph != nullptr && glyph->npaths > 0) {
      glyphs_[character] = strokesOf(*glyph);
    }
  }
}

}  // namespace roundabout::fleet
