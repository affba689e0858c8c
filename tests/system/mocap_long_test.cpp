// What takes a network, or flies in real time.

#include <gmock/gmock.h>

#include "tests/support/npm.h"
#include "tests/system/mocap_lab.h"

namespace roundabout::test {
namespace {

using testing::Contains;
using testing::HasSubstr;

TEST_F(MocapLab, TheVendorsOwnClientReadsOurQtm) {
  const NpmPackage client = npmPackage("qualisys-rt", "0.3.1");
  if (!client.problem.empty()) {
    GTEST_SKIP() << client.problem;
  }
  startEmulator("qualisys", {"--bodies", "2"});
  write("client.js", R"(
const qtm = require('qualisys-rt');
const api = new qtm.Api();
let names = [];
api.on('frame', (data) => {
  const component = data.components[Object.keys(data.components)[0]] || data.components;
  console.log(JSON.stringify({names, component}));
  process.exit(0);
});
api.connect(Number(process.argv[2]), '127.0.0.1')
  .then(() => api.get6dBodies())
  .then((bodies) => { names = bodies.map((body) => body.name); return api.streamFrames({components: ['6D'], frequency: 'AllFrames'}); })
  .catch((error) => { console.log('failed: ' + error); process.exit(1); });
)");
  const Ended ended = run("env", {"NODE_PATH=" + client.modules.string(), "node", scratch_.file("client.js"),
                                   std::to_string(command_port_)});
  ASSERT_FALSE(ended.lines.empty());
  EXPECT_THAT(ended.lines, Contains(HasSubstr("hex1")));
}

TEST_F(MocapLab, FliesThroughAnEmulatedMotive) {
  auto& flight = startFlight(twoSwap(), {"--mocap", "natnet", "--no-report"});
  const Ended ended = finish(flight);
  EXPECT_EQ(ended.status.code, 0) << testing::PrintToString(ended.lines);
  EXPECT_TRUE(leftRunning().empty());
}

}  // namespace
}  // namespace roundabout::test
