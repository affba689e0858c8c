#include "planner/policy_tools/checkpoint.h"

#include <filesystem>
#include <fstream>
#include <sstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "planner/policies/ga3c_cadrl/weights.h"
#include "planner/policy_tools/crc32c.h"
#include "planner/policy_tools/import_checkpoint.h"
#include "tests/planner/policy_tools/fake_checkpoint.h"
#include "tests/support/reference.h"
#include "tests/support/scratch_folder.h"
#include "tests/support/startup_error.h"
#include "tests/support/weights.h"

namespace roundabout::planner {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::StartsWith;

std::string bytesOf(const std::string& path) {
  std::ostringstream bytes;
  bytes << std::ifstream(path, std::ios::binary).rdbuf();
  return bytes.str();
}

void writeBytes(const std::string& path, const std::string& bytes) {
  std::ofstream(path, std::ios::binary) << bytes;
}

TEST(Crc32c, EqualsTheExamplesOfItsRfc) {
  EXPECT_EQ(crc32c(std::string(32, '\0')), 0x8a9136aaU);
  EXPECT_EQ(crc32c(std::string(32, '\xff')), 0x62a8ab43U);
  EXPECT_EQ(crc32c("123456789"), 0xe3069283U);
}

class CheckpointFile : public ::testing::Test {
 protected:
  CheckpointFile() {
    checkpoint_.add("layer/bias:0", {{3}, {1.0F, -2.0F, 3.5F}});
    checkpoint_.add("layer/kernel:0", {{2, 3}, {1.0F, 2.0F, 3.0F, 4.0F, 5.0F, 6.0F}});
    checkpoint_.addInt("step:0", 4688585);
  }

  std::string error(const std::string& tensor = "layer/kernel:0") const {
    return test::startupErrorOf([&] { Checkpoint(prefix_).readFloats(tensor); });
  }

  test::ScratchFolder folder_;
  std::string prefix_ = folder_ / "network_00000001";
  FakeCheckpoint checkpoint_{prefix_};
};

TEST_F(CheckpointFile, GivesBackItsTensors) {
  checkpoint_.write();
  const Checkpoint checkpoint(prefix_);
  const nn::Tensor kernel = checkpoint.readFloats("layer/kernel:0");
  EXPECT_EQ(kernel.shape, (std::vector<std::int64_t>{2, 3}));
  EXPECT_EQ(kernel.values, (std::vector<float>{1.0F, 2.0F, 3.0F, 4.0F, 5.0F, 6.0F}));
  EXPECT_EQ(checkpoint.readFloats("layer/bias:0").values, (std::vector<float>{1.0F, -2.0F, 3.5F}));
  EXPECT_EQ(checkpoint.readInt("step:0"), 4688585);
}

TEST_F(CheckpointFile, MayHaveACompressedIndex) {
  for (int i = 0; i < 100; ++i) {
    checkpoint_.add("more/" + std::to_string(i), {{1}, {0.0F}});
  }
  checkpoint_.write();
  const auto plain_bytes = std::filesystem::file_size(checkpoint_.indexPath());
  checkpoint_.compression = leveldb::kSnappyCompression;
  checkpoint_.write();
  ASSERT_LT(std::filesystem::file_size(checkpoint_.indexPath()), plain_bytes);
  EXPECT_EQ(Checkpoint(prefix_).readFloats("layer/bias:0").values.size(), 3U);
}

TEST_F(CheckpointFile, IsRefusedWithoutItsIndex) {
  EXPECT_THAT(error(), AllOf(StartsWith(prefix_ + ".index: checkpoint index: expected a file"),
                             HasSubstr("No such file")));
}

TEST_F(CheckpointFile, IsRefusedWithoutItsData) {
  checkpoint_.write();
  std::filesystem::remove(checkpoint_.dataPath());
  EXPECT_EQ(error(),
            checkpoint_.dataPath() + ": checkpoint data: expected a readable file, found none");
}

TEST_F(CheckpointFile, IsRefusedWithATruncatedIndex) {
  checkpoint_.write();
  const std::string bytes = bytesOf(checkpoint_.indexPath());
  for (std::size_t length = 0; length < bytes.size(); ++length) {
    writeBytes(checkpoint_.indexPath(), bytes.substr(0, length));
    EXPECT_THAT(error(), StartsWith(checkpoint_.indexPath() + ": ")) << length << " bytes";
  }
}

TEST_F(CheckpointFile, IsRefusedWithADamagedIndex) {
  checkpoint_.write();
  std::string bytes = bytesOf(checkpoint_.indexPath());
  bytes[20] = static_cast<char>(bytes[20] ^ 1);
  writeBytes(checkpoint_.indexPath(), bytes);
  EXPECT_THAT(error(), HasSubstr("expected whole blocks, found Corruption: block checksum"));
}

TEST_F(CheckpointFile, NamesTheTensorThatIsDamaged) {
  checkpoint_.write();
  std::string bytes = bytesOf(checkpoint_.dataPath());
  bytes[12] = static_cast<char>(bytes[12] ^ 1);
  writeBytes(checkpoint_.dataPath(), bytes);
  EXPECT_THAT(error(), StartsWith(checkpoint_.dataPath() +
                                  ": tensor layer/kernel:0: expected masked CRC-32C "));
  EXPECT_EQ(error("layer/bias:0"), "");
}

TEST_F(CheckpointFile, NamesTheTensorThatIsTruncated) {
  checkpoint_.write();
  writeBytes(checkpoint_.dataPath(), bytesOf(checkpoint_.dataPath()).substr(0, 30));
  EXPECT_EQ(error(), checkpoint_.dataPath() +
                         ": tensor layer/kernel:0: expected 24 bytes from byte 12 on, found 18 "
                         "bytes before the end of the file");
}

TEST_F(CheckpointFile, SaysWhatThereIsWhenATensorIsMissing) {
  checkpoint_.write();
  EXPECT_EQ(error("layer/kernel"),
            checkpoint_.indexPath() +
                ": tensor layer/kernel: expected to be there, found only layer/bias:0, "
                "layer/kernel:0, step:0");
}

TEST_F(CheckpointFile, NamesTheTensorOfAnotherType) {
  checkpoint_.write();
  EXPECT_EQ(error("step:0"), checkpoint_.indexPath() +
                                 ": tensor step:0: expected type 1 (types.proto), 4 bytes, found "
                                 "type 3, 4 bytes");
}

TEST_F(CheckpointFile, NamesTheEntryThatIsMalformed) {
  for (const std::string& entry :
       {std::string("\x08"), std::string("\x12\x05x"), std::string("\x0f\x01"),
        std::string("\x35\x01\x02"), std::string("\x12\x03\x12\x01\x08")}) {
    checkpoint_.entries["layer/kernel:0"] = entry;
    checkpoint_.write();
    EXPECT_EQ(error("layer/bias:0"),
              checkpoint_.indexPath() +
                  ": entry layer/kernel:0: expected a protocol buffer, found a malformed one");
  }
}

TEST_F(CheckpointFile, NamesTheEntryWithAnImpossibleShape) {
  checkpoint_.entries["layer/kernel:0"] =
      "\x12\x0c\x12\x0a\x08" + FakeCheckpoint::varint(std::uint64_t{1} << 60);
  checkpoint_.write();
  EXPECT_THAT(error("layer/bias:0"), HasSubstr("entry layer/kernel:0: expected sizes up to "));
}

TEST_F(CheckpointFile, IsRefusedWithMoreThanOneDataFileOrAnotherByteOrder) {
  checkpoint_.header = "\x08\x02";
  checkpoint_.write();
  EXPECT_THAT(error(), HasSubstr("expected 1 data file, little-endian, found 2 data files"));
  checkpoint_.header = "\x08\x01\x10\x01";
  checkpoint_.write();
  EXPECT_THAT(error(), HasSubstr("found 1 data files, big-endian"));
}

// The names of the published checkpoints.
const std::map<std::string, std::string> kPublishedNames = {
    {"lstm/kernel", "rnn/lstm_cell/kernel:0"},     {"lstm/bias", "rnn/lstm_cell/bias:0"},
    {"layer1/kernel", "layer1/kernel:0"},          {"layer1/bias", "layer1/bias:0"},
    {"layer2/kernel", "layer2/kernel:0"},          {"layer2/bias", "layer2/bias:0"},
    {"layer3/kernel", "fullyconnected1/kernel:0"}, {"layer3/bias", "fullyconnected1/bias:0"},
    {"policy/kernel", "logits_p/kernel:0"},        {"policy/bias", "logits_p/bias:0"},
    {"value/kernel", "logits_v/kernel:0"},         {"value/bias", "logits_v/bias:0"},
};

class ImportedCheckpoint : public ::testing::Test {
 protected:
  ImportedCheckpoint() {
    for (const auto& [ours, published] : kPublishedNames) {
      checkpoint_.add(published, network_.tensors.at(ours));
    }
    checkpoint_.addInt("step:0", 123);
  }

  test::ScratchFolder folder_;
  std::string prefix_ = folder_ / "network_00000123";
  nn::TensorFile network_ = test::randomGa3cCadrl(1);
  FakeCheckpoint checkpoint_{prefix_};
};

TEST_F(ImportedCheckpoint, KeepsEveryTensor) {
  checkpoint_.write();
  const nn::TensorFile imported = importCheckpoint(prefix_);
  ASSERT_EQ(imported.tensors.size(), network_.tensors.size());
  for (const auto& [name, tensor] : network_.tensors) {
    EXPECT_EQ(imported.tensors.at(name).values, tensor.values) << name;
  }
}

TEST_F(ImportedCheckpoint, SaysWhereItComesFromAndHowItsInputIsNormalised) {
  checkpoint_.write();
  const nn::TensorFile imported = importCheckpoint(prefix_);
  EXPECT_THAT(imported.metadata.at("provenance"),
              AllOf(HasSubstr("/network_00000123"), HasSubstr("training step 123")));
  EXPECT_EQ(imported.metadata.at("ego_deviation"), "[5.0,3.14,1.0,1.0]");
  EXPECT_EQ(imported.metadata.at("other_mean"), "[0.0,0.0,0.0,0.0,0.5,0.0,1.0]");
}

TEST_F(ImportedCheckpoint, IsRefusedWhenItIsAnotherNetwork) {
  checkpoint_.add("logits_p/kernel:0", {{256, 15}, std::vector<float>(256 * 15)});
  checkpoint_.write();
  EXPECT_EQ(test::startupErrorOf([this] { importCheckpoint(prefix_); }),
            prefix_ + ": tensor policy/kernel: expected shape [256, 11], found shape [256, 15]");
}

TEST(PublishedCheckpoint, IsReadWholeWithGoodSums) {
  const auto folder = test::referenceFolder() / "ga3c_cadrl/checkpoints/gym_qedrf08y_01900000";
  if (!std::filesystem::exists(folder)) {
    GTEST_SKIP() << "no published network in " << folder;
  }
  const nn::TensorFile file = importCheckpoint(folder / "network_01900000");
  EXPECT_EQ(file.metadata.at("provenance"),
            "imported from the TensorFlow checkpoint gym_qedrf08y_01900000/network_01900000, "
            "training step 3816002");
}

}  // namespace
}  // namespace roundabout::planner
