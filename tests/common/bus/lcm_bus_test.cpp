#include "common/bus/lcm_bus.h"

#include <chrono>
#include <cstdlib>
#include <stdexcept>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <sched.h>
#include <sys/wait.h>
#include <unistd.h>

#include "common/core/error.h"
#include "tests/support/lcm_url.h"
#include "tests/support/startup_error.h"

namespace roundabout::bus {
namespace {

using std::chrono::milliseconds;

constexpr int kPatienceMs = 5000;

std::vector<std::byte> bytes(std::size_t size) { return std::vector<std::byte>(size); }

/// Handles messages until `done` or for five seconds.
template <class Condition>
bool handleUntil(LcmBus& bus, const Condition& done) {
  const auto end = std::chrono::steady_clock::now() + milliseconds(kPatienceMs);
  while (!done() && std::chrono::steady_clock::now() < end) {
    bus.handle(milliseconds(10));
  }
  return done();
}

TEST(LcmBus, TwoBusesHearEachOther) {
  const std::string url = test::ownLcmUrl();
  LcmBus a(url);
  LcmBus b(url);
  std::vector<std::size_t> at_a;
  std::vector<std::size_t> at_b;
  a.subscribe("TO_A", [&](const Received& received) { at_a.push_back(received.payload.size()); });
  b.subscribe("TO_B", [&](const Received& received) {
    EXPECT_EQ(received.channel, "TO_B");
    EXPECT_GT(received.recv_utime, 0);
    at_b.push_back(received.payload.size());
  });
  a.publish("TO_B", bytes(1));
  a.publish("TO_B", bytes(2));
  b.publish("TO_A", bytes(3));
  EXPECT_TRUE(handleUntil(b, [&] { return at_b.size() == 2; }));
  EXPECT_TRUE(handleUntil(a, [&] { return at_a.size() == 1; }));
  EXPECT_EQ(at_b, (std::vector<std::size_t>{1, 2}));
  EXPECT_EQ(at_a, (std::vector<std::size_t>{3}));
}

TEST(LcmBus, APrefixHearsEveryChannelThatBeginsWithIt) {
  LcmBus bus(test::ownLcmUrl());
  std::vector<std::string> heard;
  bus.subscribePrefix("COMMAND_",
                      [&](const Received& received) { heard.emplace_back(received.channel); });
  bus.publish("COMMAND_hex1", bytes(1));
  bus.publish("MY_COMMAND_hex1", bytes(1));
  bus.publish("COMMAND_hex2", bytes(1));
  EXPECT_TRUE(handleUntil(bus, [&] { return heard.size() == 2; }));
  EXPECT_EQ(heard, (std::vector<std::string>{"COMMAND_hex1", "COMMAND_hex2"}));
}

TEST(LcmBus, HandleReturnsAfterItsTimeWithoutMessages) {
  LcmBus bus(test::ownLcmUrl());
  bus.subscribe("QUIET", [](const Received&) {});
  EXPECT_EQ(bus.handle(milliseconds(1)), 0);
}

TEST(LcmBus, KeepsASecondOfStatesForABusyProcess) {
  // Small messages, so that the kernel's buffer is not what loses them; LCM by itself keeps 30.
  const std::string url = test::ownLcmUrl();
  LcmBus sender(url);
  LcmBus busy(url);
  LcmBus idle(url);
  constexpr int kMessages = 200;
  int heard_by_busy = 0;
  int heard_by_idle = 0;
  busy.subscribe("STATES", [&](const Received&) { ++heard_by_busy; });
  idle.subscribe("STATES", [&](const Received&) { ++heard_by_idle; });
  for (int i = 0; i < kMessages; ++i) {
    sender.publish("STATES", bytes(10));
  }
  ASSERT_TRUE(handleUntil(idle, [&] { return heard_by_idle == kMessages; })) << heard_by_idle;
  EXPECT_TRUE(handleUntil(busy, [&] { return heard_by_busy == kMessages; })) << heard_by_busy;
}

TEST(LcmBus, TheDescriptorIsReadableWhenAMessageWaits) {
  const std::string url = test::ownLcmUrl();
  LcmBus sender(url);
  LcmBus receiver(url);
  receiver.subscribe("X", [](const Received&) {});
  sender.publish("X", bytes(1));
  pollfd waiting{receiver.fileDescriptor(), POLLIN, 0};
  EXPECT_EQ(poll(&waiting, 1, kPatienceMs), 1);
  EXPECT_EQ(receiver.handle(milliseconds(0)), 1);
}

TEST(LcmBus, AnExceptionInAHandlerLeavesHandle) {
  const std::string url = test::ownLcmUrl();
  LcmBus bus(url);
  bool thrown = false;
  int heard_after = 0;
  bus.subscribe("BAD", [&](const Received&) {
    thrown = true;
    throw std::runtime_error("bad");
  });
  bus.subscribe("GOOD", [&](const Received&) { ++heard_after; });
  bus.publish("BAD", bytes(1));
  bus.publish("GOOD", bytes(1));
  EXPECT_THROW(handleUntil(bus, [&] { return thrown; }), std::runtime_error);
  EXPECT_TRUE(handleUntil(bus, [&] { return heard_after == 1; })) << "the bus is of no use after";
}

TEST(LcmBus, AUrlThatIsNoneIsAStartupError) {
  for (const char* url : {"", "udp://239.255.76.67:7667", "udpm://lab:7667", "memq://",
                          "udpm://239.255.76.67:99999999999", "udpm://239.255.76.67:7667 "}) {
    EXPECT_EQ(test::startupErrorOf([&] { LcmBus bus(url); }),
              std::string("lcm_url: ") + url +
                  ": expected udpm://ADDRESS:PORT?ttl=N, found something else");
  }
}

TEST(LcmBus, AnAddressThatIsNotMulticastOrAPortThatIsNoneIsAStartupError) {
  EXPECT_EQ(
      test::startupErrorOf([] { LcmBus bus("udpm://10.0.0.1:7667?ttl=0"); }),
      "lcm_url: udpm://10.0.0.1:7667?ttl=0: expected a multicast address and a port from 1 to "
      "65535, found 10.0.0.1:7667");
  EXPECT_EQ(test::startupErrorOf([] { LcmBus bus("udpm://239.255.76.67:70000"); }),
            "lcm_url: udpm://239.255.76.67:70000: expected a multicast address and a port from 1 "
            "to 65535, found 239.255.76.67:70000");
}

/// The error of making a bus in a child process in which the network is empty; nothing if the
/// machine does not let us make one.
std::string errorWithoutNetwork() {
  int pipe_ends[2];
  if (pipe(pipe_ends) != 0) {
    return {};
  }
  const pid_t child = fork();
  if (child == 0) {
    if (unshare(CLONE_NEWNET) == 0 || unshare(CLONE_NEWUSER | CLONE_NEWNET) == 0) {
      const std::string error =
          test::startupErrorOf([] { LcmBus bus("udpm://239.255.76.67:7667?ttl=0"); });
      const std::string line = error.empty() ? "no error" : error;
      const ssize_t written = write(pipe_ends[1], line.data(), line.size());
      _exit(written == static_cast<ssize_t>(line.size()) ? 0 : 1);
    }
    _exit(1);
  }
  close(pipe_ends[1]);
  std::string line(1000, '\0');
  const ssize_t size = read(pipe_ends[0], line.data(), line.size());
  close(pipe_ends[0]);
  waitpid(child, nullptr, 0);
  line.resize(size > 0 ? static_cast<std::size_t>(size) : 0);
  return line;
}

TEST(LcmBus, WithoutAMulticastRouteStartupFailsWithTheRemedy) {
  const std::string error = errorWithoutNetwork();
  if (error.empty()) {
    GTEST_SKIP() << "this machine lets no process have a network namespace of its own";
  }
  EXPECT_THAT(error, testing::StartsWith("lcm_url: udpm://239.255.76.67:7667?ttl=0: expected a "
                                         "multicast route to 239.255.76.67, found Network is "
                                         "unreachable (try: sudo ip link set lo up"));
}

TEST(ResolveUrl, PrefersTheExplicitOneThenTheEnvironmentThenThisMachineOnly) {
  setenv("LCM_DEFAULT_URL", "udpm://239.255.76.67:7001?ttl=1", 1);
  EXPECT_EQ(resolveUrl("udpm://239.255.76.67:7002"), "udpm://239.255.76.67:7002");
  EXPECT_EQ(resolveUrl(""), "udpm://239.255.76.67:7001?ttl=1");
  setenv("LCM_DEFAULT_URL", "", 1);
  EXPECT_EQ(resolveUrl(""), "udpm://239.255.76.67:7667?ttl=0");
  unsetenv("LCM_DEFAULT_URL");
  EXPECT_EQ(resolveUrl(""), "udpm://239.255.76.67:7667?ttl=0");
}

}  // namespace
}  // namespace roundabout::bus
