#include "common/bus/memory_bus.h"

#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace roundabout::bus {
namespace {

std::vector<std::byte> bytesOf(const std::string& text) {
  std::vector<std::byte> bytes;
  for (const char character : text) {
    bytes.push_back(static_cast<std::byte>(character));
  }
  return bytes;
}

std::string textOf(std::span<const std::byte> bytes) {
  std::string text;
  for (const std::byte byte : bytes) {
    text += static_cast<char>(byte);
  }
  return text;
}

class MemoryBusTest : public testing::Test {
 protected:
  void listen(MemoryBus& bus, const std::string& channel) {
    bus.subscribe(channel, [this](const Received& received) {
      heard_.push_back(std::string(received.channel) + "=" + textOf(received.payload));
    });
  }
  static int drain(MemoryBus& bus) { return bus.handle(std::chrono::milliseconds(0)); }

  std::shared_ptr<MemoryNetwork> network_ = std::make_shared<MemoryNetwork>();
  MemoryBus a_{network_};
  MemoryBus b_{network_};
  std::vector<std::string> heard_;
};

TEST_F(MemoryBusTest, DeliversInOrderAcrossChannels) {
  listen(b_, "X");
  listen(b_, "Y");
  a_.publish("X", bytesOf("1"));
  a_.publish("Y", bytesOf("2"));
  a_.publish("X", bytesOf("3"));
  EXPECT_TRUE(heard_.empty()) << "delivered outside handle()";
  EXPECT_EQ(drain(b_), 3);
  EXPECT_EQ(heard_, (std::vector<std::string>{"X=1", "Y=2", "X=3"}));
  EXPECT_EQ(drain(b_), 0);
}

TEST_F(MemoryBusTest, APublisherHearsItself) {
  listen(a_, "X");
  a_.publish("X", bytesOf("1"));
  EXPECT_EQ(drain(a_), 1);
  EXPECT_EQ(heard_, std::vector<std::string>{"X=1"});
}

TEST_F(MemoryBusTest, AChannelIsANameAndNotAPattern) {
  listen(b_, "COMMAND_hex1");
  a_.publish("COMMAND_hex10", bytesOf("1"));
  a_.publish("COMMAND_.*", bytesOf("2"));
  EXPECT_EQ(drain(b_), 0);
}

TEST_F(MemoryBusTest, APrefixHearsEveryChannelThatBeginsWithIt) {
  b_.subscribePrefix("COMMAND_",
                     [this](const Received& received) { heard_.emplace_back(received.channel); });
  a_.publish("COMMAND_hex1", {});
  a_.publish("MY_COMMAND_hex1", {});
  a_.publish("COMMAND_hex2", {});
  EXPECT_EQ(drain(b_), 2);
  EXPECT_EQ(heard_, (std::vector<std::string>{"COMMAND_hex1", "COMMAND_hex2"}));
}

TEST_F(MemoryBusTest, WhatWasSaidBeforeSubscribingIsNotHeard) {
  a_.publish("X", bytesOf("1"));
  listen(b_, "X");
  EXPECT_EQ(drain(b_), 0);
  EXPECT_EQ(network_->published("X"), 1);
}

TEST_F(MemoryBusTest, KeepsACopyOfThePayload) {
  listen(b_, "X");
  std::vector<std::byte> payload = bytesOf("1");
  a_.publish("X", payload);
  payload[0] = std::byte{'2'};
  drain(b_);
  EXPECT_EQ(heard_, std::vector<std::string>{"X=1"});
}

TEST_F(MemoryBusTest, TwoSubscriptionsOfOneChannelBothHear) {
  listen(b_, "X");
  listen(b_, "X");
  a_.publish("X", bytesOf("1"));
  EXPECT_EQ(drain(b_), 1);
  EXPECT_EQ(heard_.size(), 2u);
}

TEST_F(MemoryBusTest, AnAnswerFromAHandlerArrives) {
  listen(a_, "ANSWER");
  b_.subscribe("QUESTION", [this](const Received&) { b_.publish("ANSWER", bytesOf("42")); });
  a_.publish("QUESTION", {});
  drain(b_);
  drain(a_);
  EXPECT_EQ(heard_, std::vector<std::string>{"ANSWER=42"});
}

TEST_F(MemoryBusTest, AnExceptionLeavesHandleAndTheRestIsHeardNextTime) {
  listen(b_, "X");
  b_.subscribe("BAD", [](const Received&) { throw std::runtime_error("bad"); });
  a_.publish("BAD", {});
  a_.publish("X", bytesOf("1"));
  EXPECT_THROW(drain(b_), std::runtime_error);
  EXPECT_EQ(drain(b_), 1);
  EXPECT_EQ(heard_, std::vector<std::string>{"X=1"});
}

TEST_F(MemoryBusTest, ABusThatIsGoneDisturbsNobody) {
  listen(b_, "X");
  {
    MemoryBus gone(network_);
    listen(gone, "X");
  }
  a_.publish("X", bytesOf("1"));
  EXPECT_EQ(drain(b_), 1);
  EXPECT_EQ(heard_.size(), 1u);
}

}  // namespace
}  // namespace roundabout::bus
