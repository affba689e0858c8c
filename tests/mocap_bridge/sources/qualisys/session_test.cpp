// A session and a QTM whose every word is the test's, over loopback sockets.

#include "mocap_bridge/sources/qualisys/session.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "mocap_bridge/sources/table.h"
#include "tests/support/mocap_fixtures.h"

namespace roundabout::mocap_bridge::qualisys {
namespace {

using testing::Contains;
using testing::HasSubstr;

constexpr core::Utime kStep = 5'000;

class QualisysSessionTest : public testing::Test {
 protected:
  QualisysSessionTest() {
    config::Mocap mocap;
    mocap.server = "127.0.0.1";
    mocap.command_port = listener_.port();
    session_ = std::make_unique<QualisysSession>(mocap);
    sent_.bodies.resize(1);
    sent_.bodies[0].tracked = true;
    sent_.has_bodies = true;
  }

  void event(Event event) {
    const std::byte number{static_cast<std::uint8_t>(event)};
    stream_->send(writePacket(PacketType::kEvent, Bytes(&number, 1)));
  }

  void obey(const std::string& command) {
    commands_.push_back(command);
    if (command.starts_with("Version")) {
      stream_->send(writeText(PacketType::kCommand, "Version set to " + command.substr(8)));
    } else if (command == "GetState") {
      if (refuses_state_) {
        stream_->send(writeText(PacketType::kError, "Parse error"));
      } else if (says_state_) {
        event(state_);
      }
    } else if (command.starts_with("GetParameters")) {
      if (refuses_names_) {
        stream_->send(writeText(PacketType::kError, "no 6D settings"));
        return;
      }
      stream_->send(writeText(PacketType::kXml,
                              "<QTM_Parameters_Ver_1.28><The_6D><Body><Name>hex1</Name></Body>"
                              "</The_6D></QTM_Parameters_Ver_1.28>"));
    } else if (command.starts_with("StreamFrames")) {
      if (refuses_residuals_ && command.ends_with("6DRes")) {
        stream_->send(writeText(PacketType::kError, "Parse error"));
        return;
      }
      streaming_ = true;
    }
  }

  void serve() {
    if (auto accepted = listener_.accept()) {
      ++connections_;
      stream_ = std::move(accepted);
      streaming_ = false;
      received_.clear();
      stream_->send(writeText(PacketType::kCommand, "QTM RT Interface connected"));
    }
    if (!stream_ || dead_) {
      return;
    }
    for (Bytes bytes = stream_->receive(); !bytes.empty(); bytes = stream_->receive()) {
      received_.insert(received_.end(), bytes.begin(), bytes.end());
    }
    Bytes rest(received_);
    bool broken = false;
    while (const auto packet = takePacket(rest, broken)) {
      obey(parseText(packet->payload));
    }
    received_.assign(rest.begin(), rest.end());
    if (streaming_ && live_) {
      sent_.timestamp_us += kStep;
      stream_->send(writeData(sent_, Component::k6D));
    }
  }

  void run(double seconds) {
    for (int i = 0; i < static_cast<int>(seconds * 200.0); ++i) {
      now_ += kStep;
      serve();
      session_->poll(now_, heard_);
      for (std::string& note : session_->takeNotes()) {
        notes_.push_back(std::move(note));
      }
    }
  }

  // In the last of the frames that were heard.
  bool lastIsRecorded() const { return !heard_.frames.empty() && heard_.frames.back().recorded; }

  TcpListener listener_{"QTM", {kLoopback, 0}};
  std::unique_ptr<TcpStream> stream_;
  std::unique_ptr<QualisysSession> session_;
  std::vector<std::byte> received_;
  std::vector<std::string> commands_;
  int connections_ = 0;
  bool streaming_ = false;
  bool live_ = true;
  bool dead_ = false;  // neither reads nor says anything, as behind a cable that was pulled
  bool refuses_residuals_ = false;
  bool refuses_names_ = false;
  bool refuses_state_ = false;
  bool says_state_ = true;
  Event state_ = Event::kCaptureStarted;
  Data sent_;
  core::Utime now_ = 1'700'000'000'000'000;
  test::Collected heard_;
  std::vector<std::string> notes_;
};

TEST_F(QualisysSessionTest, AConnectionWhoseOtherEndIsGoneIsGivenUp) {
  run(1.0);
  ASSERT_FALSE(heard_.frames.empty());
  dead_ = true;
  run(4.0);
  EXPECT_EQ(connections_, 2);
  EXPECT_THAT(notes_, Contains(HasSubstr("not answered for 3 s")));
  EXPECT_THAT(notes_, testing::Not(Contains(HasSubstr("QTM answers, but sends no frame"))));
  dead_ = false;
  run(3.0);
  const std::size_t before = heard_.frames.size();
  run(1.0);
  EXPECT_EQ(heard_.frames.size(), before + 200);
}

TEST_F(QualisysSessionTest, AQtmWithoutAMeasurementIsKept) {
  live_ = false;
  run(8.0);
  EXPECT_EQ(connections_, 1);
  EXPECT_THAT(notes_, Contains(HasSubstr("QTM answers, but sends no frame")));
}

TEST_F(QualisysSessionTest, WhatIsPlayedBackAlreadyWhenTheBridgeConnectsIsNotLive) {
  state_ = Event::kRtFromFileStarted;
  run(1.0);
  ASSERT_FALSE(heard_.frames.empty());
  for (const SourceFrame& frame : heard_.frames) {
    EXPECT_TRUE(frame.recorded);
  }
  event(Event::kCaptureStarted);  // the event of the end was missed
  run(0.1);
  EXPECT_FALSE(lastIsRecorded());
}

TEST_F(QualisysSessionTest, WhatMayBePlayedBackIsNotLive) {
  refuses_state_ = true;
  run(1.0);
  ASSERT_FALSE(heard_.frames.empty());
  EXPECT_TRUE(lastIsRecorded());
  EXPECT_THAT(notes_, Contains(HasSubstr("does not say whether it measures")));
  event(Event::kCaptureStarted);
  run(0.1);
  EXPECT_FALSE(lastIsRecorded());
}

TEST_F(QualisysSessionTest, AnAnswerThatIsLateSaysWhetherItIsLive) {
  says_state_ = false;
  run(1.0);
  event(Event::kCameraSettingsChanged);  // says nothing of it
  run(1.0);
  EXPECT_TRUE(lastIsRecorded());
  EXPECT_THAT(notes_, testing::Not(Contains(HasSubstr("QTM says what it streams"))));
  event(Event::kConnected);
  run(0.1);
  EXPECT_FALSE(lastIsRecorded());
  EXPECT_THAT(notes_, Contains(HasSubstr("QTM says what it streams")));
}

TEST_F(QualisysSessionTest, WhatHappensBesideIsNoAnswerToTheQuestionForTheState) {
  says_state_ = false;
  run(0.1);
  event(Event::kCameraSettingsChanged);
  run(1.0);
  ASSERT_FALSE(heard_.frames.empty());
  for (const SourceFrame& frame : heard_.frames) {
    EXPECT_TRUE(frame.recorded);
  }
}

TEST_F(QualisysSessionTest, AQtmThatRefusesToSayItsStateIsKept) {
  refuses_state_ = true;
  live_ = false;
  run(8.0);
  EXPECT_EQ(connections_, 1);
}

TEST_F(QualisysSessionTest, OnlyARefusedStreamIsStreamedWithoutResiduals) {
  refuses_names_ = true;
  run(3.0);
  EXPECT_THAT(commands_, testing::Not(Contains("StreamFrames AllFrames 6D")));
  refuses_names_ = false;
  refuses_residuals_ = true;
  for (int i = 0; i < 2; ++i) {
    stream_->close();
    commands_.clear();
    run(3.0);
    EXPECT_THAT(commands_, Contains("StreamFrames AllFrames 6DRes")) << "each connection anew";
    EXPECT_THAT(commands_, Contains("StreamFrames AllFrames 6D"));
  }
  EXPECT_EQ(std::count_if(notes_.begin(), notes_.end(),
                          [](const std::string& note) {
                            return note.find("refuses 6D with residuals") != std::string::npos;
                          }),
            1);
}

}  // namespace
}  // namespace roundabout::mocap_bridge::qualisys
