// The report in a real browser: its script runs, plays and says what the log says. Skipped without
// Chromium.

#include <cstdlib>
#include <filesystem>

#include <gmock/gmock.h>

#include "logs/figures/figures.h"
#include "logs/files.h"
#include "logs/log_commands.h"
#include "logs/report/player.h"
#include "tests/logs/synthetic_flight.h"
#include "tests/support/scratch_folder.h"

namespace roundabout::logs {
namespace {

using testing::HasSubstr;
using testing::Not;

class ReportPage : public testing::Test {
 protected:
  void SetUp() override {
    if (std::system("command -v chromium >/dev/null") != 0) {
      GTEST_SKIP() << "no chromium (Debian package chromium)";
    }
    SyntheticFlight flight;
    flight.vehicles = {{"hex1", straight({-2, 0, 1}, {2, 0, 1}, 0.5)},
                       {"<b>hex2</b>", standing({0, 1.5, 1})}};
    flight.formations = {{"</script>", 0.0, 9.0, 10.0, {{2, 0, 1}, {0, 1.5, 1}}}};
    flight.write(folder_.file("flight.lcm"));
    CLI::App app;
    addLogCommands(app);
    testing::internal::CaptureStdout();
    app.parse("log report " + folder_.file("flight.lcm") + " -o " + page(), false);
    testing::internal::GetCapturedStdout();
  }

  std::string page() const { return folder_.file("report.html"); }

  /// The document after its script has run.
  std::string shownAt(const std::string& address) const {
    const std::string command =
        "chromium --headless --no-sandbox --disable-gpu --user-data-dir='" +
        folder_.file("profile") + "' --host-resolver-rules='MAP * ~NOTFOUND' --dump-dom 'file://" +
        page() + address + "' > '" + folder_.file("dom") + "' 2> '" + folder_.file("errors") + "'";
    EXPECT_EQ(std::system(command.c_str()), 0) << readFile(folder_.file("errors"));
    return readFile(folder_.file("dom"));
  }

  test::ScratchFolder folder_;
};

TEST_F(ReportPage, ShowsTheFlightAtTheTimeInItsAddress) {
  const std::string shown = shownAt("#t=6");
  EXPECT_THAT(shown, HasSubstr("data-player=\"ready\""));
  EXPECT_THAT(shown, HasSubstr("6.00 / 10.0 s"));
  // hex1 is at 1.0 m, 1.0 m from its goal, at 0.5 m/s; the other one stands at its goal.
  EXPECT_THAT(shown, HasSubstr("hex1</td><td>1.00</td><td>0.50</td><td>1.00</td>"));
  EXPECT_THAT(shown, HasSubstr("&lt;b&gt;hex2&lt;/b&gt;</td><td>1.00</td><td>0.00</td>"));
  EXPECT_THAT(shown, HasSubstr("<span class=\"good\">&lt;/script&gt; formed</span>"));
}

TEST_F(ReportPage, LoadsNothingFromAnywhere) {
  const std::string html = readFile(page());
  for (const char* reference : {"src=\"http", "href=\"http", "url(http", "fetch(", "import("}) {
    EXPECT_THAT(html, Not(HasSubstr(reference)));
  }
  EXPECT_TRUE(std::filesystem::exists(page()));
  EXPECT_FALSE(std::filesystem::exists(folder_.file("overview.png")));
}

TEST(Player, OfAFlightWithoutFramesIsNothing) { EXPECT_EQ(playerHtml(Flight(), Metrics()), ""); }

}  // namespace
}  // namespace roundabout::logs
