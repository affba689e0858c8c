#include "planner/policy_tools/protobuf_wire.h"

#include <string>

#include <gtest/gtest.h>

namespace roundabout::planner {
namespace {

TEST(ProtobufWire, ReadsEveryKindOfField) {
  const std::string message(
      "\x08\x96\x01"                          // 1: varint 150
      "\x12\x03"                              // 2: three bytes
      "abc\x1d\x01\x02\x03\x04"               // 3: fixed32
      "\x21\x01\x00\x00\x00\x00\x00\x00\x80"  // 4: fixed64
      "\x80\x01\x07",                         // 16: varint 7
      25);
  const auto fields = parseMessage(message);
  ASSERT_TRUE(fields.has_value());
  ASSERT_EQ(fields->size(), 5U);
  EXPECT_EQ((*fields)[0].number, 1U);
  EXPECT_EQ((*fields)[0].value, 150U);
  EXPECT_EQ((*fields)[1].bytes, "abc");
  EXPECT_EQ((*fields)[2].value, 0x04030201U);
  EXPECT_EQ((*fields)[3].value, 0x8000000000000001U);
  EXPECT_EQ((*fields)[4].number, 16U);
  EXPECT_EQ((*fields)[4].value, 7U);
}

TEST(ProtobufWire, AnEmptyMessageHasNoFields) {
  const auto fields = parseMessage("");
  ASSERT_TRUE(fields.has_value());
  EXPECT_TRUE(fields->empty());
}

TEST(ProtobufWire, RefusesWhatIsMalformed) {
  EXPECT_FALSE(parseMessage("\x08"));  // no value
  EXPECT_FALSE(parseMessage("\x80"));  // half a key
  EXPECT_FALSE(
      parseMessage("\x12\x04"
                   "abc"));            // too short
  EXPECT_FALSE(parseMessage("\x12"));  // no length
  EXPECT_FALSE(
      parseMessage("\x15"
                   "abc"));  // too short
  EXPECT_FALSE(
      parseMessage("\x11"
                   "abcdefg"));                                                    // too short
  EXPECT_FALSE(parseMessage("\x0b"));                                              // a group
  EXPECT_FALSE(parseMessage("\x08\xff\xff\xff\xff\xff\xff\xff\xff\xff\xff\x01"));  // too long
}

}  // namespace
}  // namespace roundabout::planner
