#include "logs/figures/figures.h"

#include <filesystem>

#include <gmock/gmock.h>

#include "common/config/experiment_file.h"
#include "common/core/error.h"
#include "common/plot/palette.h"
#include "logs/figures/formation_figure.h"
#include "logs/files.h"
#include "logs/report/html.h"
#include "logs/report/report.h"
#include "tests/logs/log_writer.h"
#include "tests/logs/synthetic_flight.h"
#include "tests/support/scratch_folder.h"

namespace roundabout::logs {
namespace {

using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

class FiguresTest : public testing::Test {
 protected:
  explicit FiguresTest(SyntheticFlight synthetic = showcase()) {
    synthetic.write(folder_.file("flight.lcm"));
    writeFile(folder_.file("experiment.yaml"), config::toYaml(synthetic.experiment()));
    flight_ = readFlight(folder_.file("flight.lcm"));
    metrics_ = computeMetrics(flight_);
  }

  static void expectPicture(const Figure& figure) {
    const std::string png = readFile(figure.png_file);
    EXPECT_THAT(png, StartsWith("\x89PNG\r\n")) << figure.png_file;
    EXPECT_THAT(png.substr(png.size() - 8), HasSubstr("IEND")) << figure.png_file << " is cut off";
    EXPECT_GT(png.size(), 8000u) << figure.png_file;
    const std::string svg = readFile(figure.svg_file);
    EXPECT_THAT(svg, HasSubstr("<svg")) << figure.svg_file;
    EXPECT_THAT(svg, HasSubstr("</svg>")) << figure.svg_file << " is cut off";
  }

  test::ScratchFolder folder_;
  Flight flight_;
  Metrics metrics_;
};

TEST_F(FiguresTest, DrawsOnePictureForEveryFormationAndTheFlight) {
  const Figures figures = drawFlight(flight_, metrics_, folder_.file("pictures"));
  ASSERT_EQ(figures.formations.size(), 2u);
  EXPECT_THAT(figures.formations[0].title, StartsWith("C: formed in 10.0 s"));
  EXPECT_THAT(figures.formations[1].png_file, HasSubstr("formation_02_L.png"));
  for (const Figure& figure : figures.formations) {
    expectPicture(figure);
  }
  expectPicture(figures.overview);
  ASSERT_EQ(figures.over_time.size(), 5u) << "no frame intervals of a flight in lockstep";
  for (const Figure& figure : figures.over_time) {
    expectPicture(figure);
  }
}

TEST_F(FiguresTest, DrawsBodiesToScale) {
  GnuplotScript script;
  Figure figure;
  drawFormation(script, flight_, metrics_.formations[0], figure);
  EXPECT_THAT(script.text(), HasSubstr("set size ratio -1"));
  EXPECT_THAT(script.text(), HasSubstr("with circles"));
  EXPECT_THAT(script.text(), HasSubstr(" 0.350 ")) << "circles of body radius";
  EXPECT_THAT(script.text(), HasSubstr("title \"hex6\""));
}

TEST_F(FiguresTest, AReportHoldsVerdictPicturesAndExperiment) {
  const Figures figures = drawFlight(flight_, metrics_, folder_.file("pictures"));
  writeReport(folder_.file("report.html"), flight_, metrics_, figures, "roundabout fly <x>");
  const std::string html = readFile(folder_.file("report.html"));
  EXPECT_THAT(html, HasSubstr("2 of 2 formations formed"));
  EXPECT_THAT(html, HasSubstr("closest bodies"));
  EXPECT_THAT(html, HasSubstr("closest assumed radii"));
  EXPECT_THAT(html, HasSubstr("roundabout fly &lt;x&gt;"));
  EXPECT_THAT(html, HasSubstr("assumed_radius_m"));
  EXPECT_THAT(html, Not(HasSubstr("src=\"http"))) << "the page must load nothing";
  EXPECT_THAT(html, Not(HasSubstr("href=")));
}

/// A flight on which everything goes wrong that a picture can show.
class TroubledFiguresTest : public FiguresTest {
 protected:
  TroubledFiguresTest() : FiguresTest(troubled()) {}

  static SyntheticFlight troubled() {
    SyntheticFlight flight;
    flight.wall_clock_per_data = 1.0;
    flight.vehicles = {{"hex_1", straight({0, 0, 1}, {5, 0, 1}, 1.0), 4.05, 1.0, 2.0},
                       {"only_floor", standing({9, 9, 0})}};
    flight.formations = {{"a/\"b\\", 1.0, 1e9, 8.0, {{5, 0, 1}}}};
    flight.last_phase = FleetPhase::kFailed;
    return flight;
  }
};

TEST_F(FiguresTest, SaysWhichCirclesArePeople) {
  const auto drawn = [this] {
    GnuplotScript script;
    Figure figure;
    drawFormation(script, flight_, metrics_.formations[0], figure);
    return script.text();
  };
  EXPECT_THAT(drawn(), Not(HasSubstr("title \"people\"")));
  for (const Frame& frame : flight_.frames) {
    flight_.people.push_back({frame.utime, {{1, {0.5, 0.5}, 0.275}}, {}});
  }
  EXPECT_THAT(drawn(), HasSubstr("title \"people\""));
  EXPECT_THAT(drawn(), HasSubstr("0.500 0.500 0.275"));
}

TEST_F(TroubledFiguresTest, AreDrawnAllTheSame) {
  const Figures figures = drawFlight(flight_, metrics_, folder_.file("pictures"));
  ASSERT_EQ(figures.formations.size(), 1u);
  EXPECT_THAT(figures.formations[0].png_file, HasSubstr("formation_01_ax2fx22bx5c.png"));
  expectPicture(figures.formations[0]);
  ASSERT_EQ(figures.over_time.size(), 6u);
  expectPicture(figures.over_time[5]);
}

TEST_F(TroubledFiguresTest, AreExplainedInTheReport) {
  const Figures figures = drawFlight(flight_, metrics_, folder_.file("pictures"));
  writeReport(folder_.file("report.html"), flight_, metrics_, figures, "");
  const std::string html = readFile(folder_.file("report.html"));
  EXPECT_THAT(html, HasSubstr("verdict failed"));
  EXPECT_THAT(html, HasSubstr("a/&quot;b\\ was not formed"));
  EXPECT_THAT(html, HasSubstr("planner of hex_1 silent from 4.0 s to the end"));
  EXPECT_THAT(html, HasSubstr("VEHICLE_STATES at <b>200.00 Hz</b>"));
}

TEST(Palette, GivesEveryVehicleAColourOfItsOwn) {
  for (const std::size_t count : {6u, 20u}) {
    std::set<int> colors;
    for (std::size_t i = 0; i < count; ++i) {
      colors.insert(plot::rgbNumber(plot::vehicleColor(i, count)));
    }
    EXPECT_EQ(colors.size(), count);
  }
}

TEST(Html, EncodesBase64) {
  EXPECT_EQ(base64("a"), "YQ==");
  EXPECT_EQ(base64("ab"), "YWI=");
  EXPECT_EQ(base64("abc"), "YWJj");
  EXPECT_EQ(base64("\xff\xfe\xfd\xfc"), "//79/A==");
}

}  // namespace
}  // namespace roundabout::logs
