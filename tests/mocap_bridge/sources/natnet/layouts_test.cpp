// Packets laid out by hand from the protocol's tables, every section filled: what our own writer,
// which sends rigid bodies only, cannot show.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "mocap_bridge/sources/byte_writer.h"
#include "mocap_bridge/sources/natnet/interpreter.h"
#include "tests/support/mocap_fixtures.h"

namespace roundabout::mocap_bridge::natnet {
namespace {

using Writer = LittleEndianWriter;
using Items = std::vector<std::vector<std::byte>>;

class Layout {
 public:
  explicit Layout(Version version) : v_(version) {}

  std::vector<std::byte> frame() const {
    return frame({markerSet("hexA", 3), markerSet("all", 4)});
  }

  // As Motive sends it of drones with four markers each: a set for each, and one of them all.
  std::vector<std::byte> frameOfDrones(int count) const {
    Items sets;
    for (int i = 1; i <= count; ++i) {
      sets.push_back(markerSet(("Hex_" + std::to_string(i)).c_str(), 4));
    }
    sets.push_back(markerSet("all", 4 * count));
    return frame(sets);
  }

  std::vector<std::byte> frame(const Items& marker_sets) const {
    Writer out;
    out.put<std::int32_t>(4242);
    section(out, marker_sets);
    section(out, {floats(3, 9.0F), floats(3, 8.0F)});  // other markers
    section(out, {body(7, 1.25F, true, 4), body(11, -3.5F, false, 0)});
    if (v_ >= Version{2, 1}) {
      section(out,
              {owner(5, {body((5 << 16) | 1, 2.0F, true, 2), body((5 << 16) | 2, 3.0F, true, 0)})});
    }
    if (v_ >= Version{4, 1}) {
      Writer asset;
      asset.put(owner(3, {body(1, 1.0F, true, 0), body(2, 2.0F, true, 0)}));
      asset.put<std::int32_t>(2);
      asset.put(labeledMarker(1));
      asset.put(labeledMarker(2));
      section(out, {asset.bytes()});
    }
    if (v_ >= Version{2, 3}) {
      section(out, {labeledMarker(65537), labeledMarker(65538), labeledMarker(50007)});
    }
    if (v_ >= Version{2, 9}) {
      section(out, {analog(1)});
    }
    if (v_ >= Version{2, 11}) {
      section(out, {analog(2), analog(3)});
    }
    suffix(out);
    return out.bytes();
  }

  std::vector<std::byte> models() const {
    struct Dataset {
      std::int32_t type;
      std::vector<std::byte> bytes;
    };
    std::vector<Dataset> datasets = {{0, texts("hexA", {"m1", "m2"})},
                                     {1, definition("hexA", 7, 3)}};
    Writer skeleton;
    skeleton.putText("Skeleton");
    skeleton.put(owner(5, {definition("Hip", 1, 2), definition("Ab", 2, 0)}));
    datasets.push_back({2, skeleton.bytes()});
    if (v_ >= Version{3, 0}) {
      datasets.push_back({3, forcePlate()});
      datasets.push_back({4, device()});
    }
    Writer camera;
    camera.putText("Camera 1");
    camera.put(floats(7, 0.0F));
    datasets.push_back({5, camera.bytes()});
    if (v_ >= Version{4, 1}) {
      datasets.push_back({6, assetDefinition()});
    }
    datasets.push_back({1, definition("hexB", 11, 0)});
    Writer out;
    out.put(static_cast<std::int32_t>(datasets.size()));
    for (const Dataset& dataset : datasets) {
      out.put(dataset.type);
      if (v_ >= Version{4, 1}) {
        out.put(static_cast<std::uint32_t>(dataset.bytes.size()));
      }
      out.put(dataset.bytes);
    }
    return out.bytes();
  }

 private:
  static std::vector<std::byte> floats(int count, float first) {
    Writer out;
    for (int i = 0; i < count; ++i) {
      out.put(first + static_cast<float>(i));
    }
    return out.bytes();
  }

  void section(Writer& out, const Items& items) const {
    std::size_t size = 0;
    for (const auto& item : items) {
      size += item.size();
    }
    out.put(static_cast<std::int32_t>(items.size()));
    if (v_ >= Version{4, 1}) {
      out.put(static_cast<std::uint32_t>(size));
    }
    for (const auto& item : items) {
      out.put(item);
    }
  }

  static std::vector<std::byte> markerSet(const char* name, int markers) {
    Writer out;
    out.putText(name);
    out.put<std::int32_t>(markers);
    out.put(floats(3 * markers, 1.0F));
    return out.bytes();
  }

  std::vector<std::byte> body(std::int32_t id, float x, bool tracked, int markers) const {
    Writer out;
    out.put(id);
    out.put(floats(3, x));
    for (const float part : {0.0F, 0.6F, 0.0F, 0.8F}) {
      out.put(part);
    }
    if (v_ < Version{3, 0}) {
      out.put<std::int32_t>(markers);
      out.put(floats(5 * markers, 0.5F));  // positions, ids, sizes
    }
    out.put(0.0007F);
    if (v_ >= Version{2, 6}) {
      out.put<std::int16_t>(tracked ? 1 : 0);
    }
    return out.bytes();
  }

  // A skeleton's frame or definition, or the first half of an asset's frame.
  static std::vector<std::byte> owner(std::int32_t id, const Items& bodies) {
    Writer out;
    out.put(id);
    out.put(static_cast<std::int32_t>(bodies.size()));
    for (const auto& one : bodies) {
      out.put(one);
    }
    return out.bytes();
  }

  std::vector<std::byte> labeledMarker(std::int32_t id) const {
    Writer out;
    out.put(id);
    out.put(floats(4, 1.0F));  // position, size
    if (v_ >= Version{2, 6}) {
      out.put<std::int16_t>(10);
    }
    if (v_ >= Version{3, 0}) {
      out.put(0.0003F);
    }
    return out.bytes();
  }

  // A force plate or device: one channel with two values, one with none.
  static std::vector<std::byte> analog(std::int32_t id) {
    Writer out;
    for (const std::int32_t number : {id, 2, 2}) {
      out.put(number);
    }
    out.put(floats(2, 0.1F));
    out.put<std::int32_t>(0);
    return out.bytes();
  }

  void suffix(Writer& out) const {
    if (v_ < Version{3, 0}) {
      out.put(77.5F);
    }
    out.put<std::uint32_t>(1001);
    out.put<std::uint32_t>(2);
    if (v_ >= Version{2, 7}) {
      out.put(12.625);
    } else if (v_ >= Version{2, 6}) {
      out.put(12.625F);
    }
    for (const std::uint64_t ticks : {111U, 222U, 333U}) {
      if (v_ >= Version{3, 0}) {
        out.put(ticks);
      }
    }
    for (const std::uint32_t precision : {99U, 1234U}) {
      if (v_ >= Version{4, 1}) {
        out.put(precision);
      }
    }
    if (v_ >= Version{2, 6}) {
      out.put<std::int16_t>(5);
    }
    out.put<std::int32_t>(0);
  }

  std::vector<std::byte> definition(const char* name, std::int32_t id, int markers) const {
    Writer out;
    out.putText(name);
    out.put(id);
    out.put<std::int32_t>(-1);
    out.put(floats(3, 0.0F));
    if (v_ >= Version{4, 2}) {
      out.put(floats(4, 0.0F));
    }
    if (v_ >= Version{3, 0}) {
      out.put<std::int32_t>(markers);
      out.put(floats(4 * markers, 1.0F));  // positions, labels
    }
    for (int i = 0; v_ >= Version{4, 0} && i < markers; ++i) {
      out.putText("Marker " + std::to_string(i));
    }
    return out.bytes();
  }

  static std::vector<std::byte> texts(const char* name, const std::vector<std::string>& list) {
    Writer out;
    if (name != nullptr) {
      out.putText(name);
    }
    out.put(static_cast<std::int32_t>(list.size()));
    for (const std::string& text : list) {
      out.putText(text);
    }
    return out.bytes();
  }

  static std::vector<std::byte> forcePlate() {
    Writer out;
    out.put<std::int32_t>(1);
    out.putText("FP-1");
    out.put(floats(2 + 3 + 144 + 12, 0.0F));
    out.put<std::int32_t>(1);
    out.put<std::int32_t>(2);
    out.put(texts(nullptr, {"Fx", "Fy"}));
    return out.bytes();
  }

  static std::vector<std::byte> device() {
    Writer out;
    out.put<std::int32_t>(2);
    out.putText("NI");
    out.putText("serial");
    out.put<std::int32_t>(1);
    out.put<std::int32_t>(2);
    out.put(texts(nullptr, {"channel"}));
    return out.bytes();
  }

  std::vector<std::byte> assetDefinition() const {
    Writer out;
    out.putText("Asset");
    out.put<std::int32_t>(1);
    out.put(owner(9, {definition("bone", 1, 1)}));
    out.put<std::int32_t>(1);
    out.putText("marker");
    out.put<std::int32_t>(1);
    out.put(floats(4, 1.0F));
    out.put<std::int16_t>(2);
    return out.bytes();
  }

  Version v_;
};

class NatnetLayouts : public testing::TestWithParam<Version> {};

TEST_P(NatnetLayouts, FramesAreReadToTheLastByte) {
  const Version version = GetParam();
  Frame frame;
  const std::vector<std::byte> payload = Layout(version).frame();
  ASSERT_STREQ(parseFrame(payload, version, frame), nullptr);
  EXPECT_EQ(frame.number, 4242);
  EXPECT_EQ(frame.marker_sets, 2);
  EXPECT_EQ(frame.other_markers, 2);
  ASSERT_EQ(frame.bodies.size(), 2U);
  EXPECT_EQ(frame.bodies[0].id, 7);
  EXPECT_EQ(frame.bodies[0].position, (std::array<float, 3>{1.25F, 2.25F, 3.25F}));
  EXPECT_EQ(frame.bodies[1].id, 11);
  EXPECT_EQ(frame.bodies[1].orientation_xyzw, (std::array<float, 4>{0.0F, 0.6F, 0.0F, 0.8F}));
  EXPECT_EQ(frame.bodies[1].mean_error_m, 0.0007F);
  EXPECT_TRUE(frame.bodies[0].tracked);
  EXPECT_EQ(frame.bodies[1].tracked, version < Version(2, 6));
  EXPECT_EQ(frame.skeletons, version >= Version(2, 1) ? 1 : 0);
  EXPECT_EQ(frame.assets, version >= Version(4, 1) ? 1 : 0);
  EXPECT_EQ(frame.labeled_markers, version >= Version(2, 3) ? 3 : 0);
  EXPECT_EQ(frame.force_plates, version >= Version(2, 9) ? 1 : 0);
  EXPECT_EQ(frame.devices, version >= Version(2, 11) ? 2 : 0);
  EXPECT_EQ(frame.timecode, 1001U);
  EXPECT_EQ(frame.timecode_subframe, 2U);
  if (version >= Version{2, 6}) {
    EXPECT_EQ(frame.timestamp_s, 12.625);
    EXPECT_EQ(frame.params, 5);
  }
  if (version < Version{3, 0}) {
    EXPECT_EQ(frame.software_latency_s, 77.5F);
  } else {
    EXPECT_EQ(frame.mid_exposure_ticks, 111U);
    EXPECT_EQ(frame.data_received_ticks, 222U);
    EXPECT_EQ(frame.transmit_ticks, 333U);
  }
  if (version >= Version{4, 1}) {
    EXPECT_EQ(frame.precision_s, 99U);
    EXPECT_EQ(frame.precision_fraction, 1234U);
  }
}

TEST(NatnetLayout, SectionsWhoseItemsDifferAreReadOfANewerVersion) {
  constexpr Version kNewer{4, 3};
  for (int drones = 1; drones <= 12; ++drones) {
    Frame frame;
    EXPECT_STREQ(parseFrame(Layout(kNewer).frameOfDrones(drones), kNewer, frame), nullptr)
        << drones;
    EXPECT_EQ(frame.marker_sets, drones + 1);
    EXPECT_EQ(frame.bodies.size(), 2U);
    EXPECT_EQ(frame.labeled_markers, 3);
    EXPECT_EQ(frame.transmit_ticks, 333U);
  }
}

TEST_P(NatnetLayouts, FramesCutAtAnyByteAreRefused) {
  const std::vector<std::byte> payload = Layout(GetParam()).frame();
  Frame frame;
  for (std::size_t size = 0; size < payload.size(); ++size) {
    EXPECT_STRNE(parseFrame(Bytes(payload).first(size), GetParam(), frame), nullptr) << size;
  }
}

TEST_P(NatnetLayouts, DefinitionsOfEveryKindAreReadToTheLastByte) {
  ModelDef models;
  ASSERT_STREQ(parseModelDef(Layout(GetParam()).models(), GetParam(), models), nullptr);
  ASSERT_EQ(models.bodies.size(), 2U) << "bones of skeletons and assets are no bodies";
  EXPECT_EQ(models.bodies[0].name, "hexA");
  EXPECT_EQ(models.bodies[1].name, "hexB");
  EXPECT_EQ(models.bodies[1].id, 11);
}

// True if a range of versions such as "2.9 or 2.10" has that version.
bool covers(std::string_view range, Version version) {
  const auto first = parseVersion(range.substr(0, range.find(' ')));
  const auto last = parseVersion(range.substr(range.rfind(' ') + 1));
  return *first <= version && version <= *last;
}

TEST_P(NatnetLayouts, AreToldApartByWhatFitsToTheLastByte) {
  const auto frame = onlyFrameLayoutOf(Layout(GetParam()).frame());
  EXPECT_EQ(frame.has_value(), GetParam() >= Version(2, 3));
  EXPECT_TRUE(!frame || covers(*frame, GetParam())) << frame.value_or("");
  const auto models = onlyModelDefLayoutOf(Layout(GetParam()).models());
  ASSERT_TRUE(models);
  EXPECT_TRUE(covers(*models, GetParam())) << *models;
}

TEST_P(NatnetLayouts, AFrameOfAnotherVersionIsSaidToBeOfWhich) {
  NatnetInterpreter interpreter({GetParam() < Version{3, 0} ? Version{3, 0} : Version{2, 7}});
  interpreter.showEverything();
  test::Collected heard;
  Writer datagram;
  datagram.put<std::uint16_t>(7);
  datagram.put<std::uint16_t>(0);
  datagram.put(Bytes(Layout(GetParam()).frame()));
  interpreter.onPacket({1'700'000'000'000'000, 0, 0, datagram.bytes()}, heard);
  ASSERT_EQ(heard.packets.size(), 1U);
  const std::string& error = heard.packets[0].error;
  EXPECT_THAT(error, testing::HasSubstr(GetParam() < Version{3, 0} ? "read as NatNet 3.0"
                                                                   : "read as NatNet 2.7"));
  if (GetParam() >= Version{2, 3}) {
    EXPECT_THAT(error, testing::HasSubstr("it would be whole"));
  }
}

INSTANTIATE_TEST_SUITE_P(All, NatnetLayouts,
                         testing::Values(Version{2, 0}, Version{2, 3}, Version{2, 5}, Version{2, 6},
                                         Version{2, 7}, Version{2, 9}, Version{2, 10},
                                         Version{2, 11}, Version{3, 0}, Version{3, 1},
                                         Version{4, 0}, Version{4, 1}, Version{4, 2}),
                         [](const auto& instance) {
                           return "v" + std::to_string(instance.param.major) + "_" +
                                  std::to_string(instance.param.minor);
                         });

}  // namespace
}  // namespace roundabout::mocap_bridge::natnet
