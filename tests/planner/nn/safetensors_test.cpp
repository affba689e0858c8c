#include "planner/nn/safetensors.h"

#include <array>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <sstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/scratch_folder.h"
#include "tests/support/startup_error.h"

namespace roundabout::planner::nn {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::StartsWith;

class Safetensors : public ::testing::Test {
 protected:
  // A file with this header and this much data.
  void writeRaw(const std::string& header, std::size_t data_bytes) {
    std::string bytes(8, '\0');
    const std::uint64_t length = header.size();
    std::memcpy(bytes.data(), &length, bytes.size());
    writeBytes(bytes + header + std::string(data_bytes, '\0'));
  }

  void writeBytes(const std::string& bytes) { std::ofstream(path_, std::ios::binary) << bytes; }

  std::string readBytes() const {
    std::ostringstream bytes;
    bytes << std::ifstream(path_, std::ios::binary).rdbuf();
    return bytes.str();
  }

  std::string errorOfReading() const {
    return test::startupErrorOf([this] { readSafetensors(path_); });
  }

  static std::string tensor(const std::string& shape, const std::string& offsets,
                            const std::string& type = "F32") {
    return R"({"dtype":")" + type + R"(","shape":)" + shape + R"(,"data_offsets":)" + offsets + "}";
  }

  test::ScratchFolder folder_;
  std::string path_ = folder_ / "weights.safetensors";
};

TensorFile exampleFile() {
  TensorFile file;
  file.metadata = {{"architecture", "example"}, {"note", "\"quoted\", \n and ä"}};
  file.tensors["matrix"] = {{2, 3}, {1.0F, -2.5F, 3e-40F, 3e38F, 0.0F, -0.0F}};
  file.tensors["empty"] = {{0, 5}, {}};
  file.tensors["scalar"] = {{}, {7.0F}};
  return file;
}

TEST_F(Safetensors, ReadsBackWhatItWrote) {
  const TensorFile file = exampleFile();
  writeSafetensors(path_, file);
  const TensorFile read = readSafetensors(path_);
  EXPECT_EQ(read.metadata, file.metadata);
  ASSERT_EQ(read.tensors.size(), file.tensors.size());
  for (const auto& [name, tensor] : file.tensors) {
    EXPECT_EQ(read.tensors.at(name).shape, tensor.shape) << name;
    EXPECT_EQ(read.tensors.at(name).values, tensor.values) << name;
  }
}

TEST_F(Safetensors, WritesTheSameBytesEachTime) {
  writeSafetensors(path_, exampleFile());
  const std::string first = readBytes();
  writeSafetensors(path_, exampleFile());
  EXPECT_EQ(readBytes(), first);
}

TEST_F(Safetensors, ReadsAFileThatAnotherProgramWrote) {
  const std::string header = R"({"b":{"dtype":"F32","shape":[1],"data_offsets":[8,12]},)"
                             R"("a":{"dtype":"F32","shape":[2],"data_offsets":[0,8]}}  )";
  writeRaw(header, 12);
  const TensorFile file = readSafetensors(path_);
  EXPECT_TRUE(file.metadata.empty());
  EXPECT_EQ(file.tensors.at("a").values.size(), 2U);
  EXPECT_EQ(file.tensors.at("b").values.size(), 1U);
}

TEST_F(Safetensors, RefusesEveryTruncation) {
  writeSafetensors(path_, exampleFile());
  const std::string bytes = readBytes();
  for (std::size_t length = 0; length < bytes.size(); ++length) {
    writeBytes(bytes.substr(0, length));
    EXPECT_THAT(errorOfReading(), AllOf(StartsWith(path_ + ": "), HasSubstr("expected")))
        << length << " of " << bytes.size() << " bytes";
  }
}

TEST_F(Safetensors, RefusesBytesLeftOver) {
  writeSafetensors(path_, exampleFile());
  writeBytes(readBytes() + "x");
  EXPECT_EQ(errorOfReading(), path_ + ": data: expected 28 bytes, found 1 bytes left over");
}

TEST_F(Safetensors, RefusesAMissingFileAndAFolder) {
  EXPECT_THAT(errorOfReading(), HasSubstr("expected a safetensors file, found No such file"));
  EXPECT_THAT(test::startupErrorOf([this] { readSafetensors(folder_.path()); }),
              HasSubstr("expected a safetensors file, found Is a directory"));
}

TEST_F(Safetensors, RefusesAHeaderThatIsTooLarge) {
  writeBytes(std::string("\xff\xff\xff\xff\xff\xff\xff\x7f", 8) + "{}");
  EXPECT_THAT(errorOfReading(), HasSubstr("header: expected at most 1048576 bytes, found 9223"));
}

TEST_F(Safetensors, RefusesAHeaderThatIsNoJsonObject) {
  writeRaw("{\"a\":", 0);
  EXPECT_THAT(errorOfReading(), HasSubstr("header: expected a JSON object, found no JSON"));
  writeRaw("[]", 0);
  EXPECT_THAT(errorOfReading(), HasSubstr("header: expected a JSON object, found array"));
}

TEST_F(Safetensors, RefusesMetadataThatIsNotText) {
  writeRaw(R"({"__metadata__":{"max_others":19}})", 0);
  EXPECT_THAT(errorOfReading(), HasSubstr("metadata max_others: expected a string, found number"));
  writeRaw(R"({"__metadata__":7})", 0);
  EXPECT_THAT(errorOfReading(), HasSubstr("metadata: expected a JSON object, found number"));
}

TEST_F(Safetensors, NamesTheTensorWhoseEntryIsIncomplete) {
  writeRaw(R"({"a":{"dtype":"F32","shape":[1]}})", 4);
  EXPECT_THAT(errorOfReading(), HasSubstr("tensor a: expected an entry with dtype, shape and"));
  writeRaw(R"({"a":7})", 4);
  EXPECT_THAT(errorOfReading(), HasSubstr("tensor a: expected an entry with dtype, shape and"));
}

TEST_F(Safetensors, NamesTheTensorOfAnotherType) {
  writeRaw("{\"a\":" + tensor("[2]", "[0,4]", "F16") + "}", 4);
  EXPECT_THAT(errorOfReading(),
              HasSubstr("tensor a: expected dtype \"F32\" or \"F64\", found \"F16\""));
}

TEST_F(Safetensors, RoundsDoublesToSinglePrecision) {
  writeRaw("{\"a\":" + tensor("[2]", "[0,16]", "F64") + "}", 0);
  const std::array<double, 2> numbers = {-2.5, 0.1};
  std::ofstream(path_, std::ios::binary | std::ios::app)
      .write(reinterpret_cast<const char*>(numbers.data()), sizeof(numbers));
  EXPECT_EQ(readSafetensors(path_).tensors.at("a").values, (std::vector{-2.5F, 0.1F}));

  writeRaw("{\"a\":" + tensor("[2]", "[0,8]", "F64") + "}", 8);
  EXPECT_THAT(errorOfReading(), HasSubstr("tensor a: expected 8 bytes for each number"));
}

TEST_F(Safetensors, NamesTheTensorWhoseShapeIsNoShape) {
  for (const char* shape : {"[-1]", "[1.5]", "\"1\"", "[18446744073709551615]"}) {
    writeRaw("{\"a\":" + tensor(shape, "[0,4]") + "}", 4);
    EXPECT_THAT(errorOfReading(), HasSubstr("tensor a: expected a shape")) << shape;
  }
}

TEST_F(Safetensors, NamesTheTensorWhoseShapeDoesNotFitItsBytes) {
  for (const char* shape : {"[2]", "[0]", "[4294967296,4294967296,4294967296,4294967296]"}) {
    writeRaw("{\"a\":" + tensor(shape, "[0,4]") + "}", 4);
    EXPECT_THAT(errorOfReading(), HasSubstr("tensor a: expected 4 bytes for each number")) << shape;
  }
  writeRaw("{\"a\":" + tensor("[1]", "[0,5]") + "}", 5);
  EXPECT_THAT(errorOfReading(), HasSubstr("tensor a: expected 4 bytes for each number"));
  writeRaw("{\"a\":" + tensor("[5]", "[0,0]") + "}", 0);
  EXPECT_THAT(errorOfReading(), HasSubstr("tensor a: expected 4 bytes for each number"));
}

TEST_F(Safetensors, NamesTheTensorOutOfRange) {
  for (const char* offsets : {"[0,8]", "[4,0]", "[0]", "[0,4,4]", "[-4,0]", "\"0,4\""}) {
    writeRaw("{\"a\":" + tensor("[1]", offsets) + "}", 4);
    EXPECT_THAT(errorOfReading(), HasSubstr("tensor a: expected data_offsets [begin, end] within"))
        << offsets;
  }
}

TEST_F(Safetensors, NamesTheTensorThatOverlapsAnother) {
  writeRaw("{\"a\":" + tensor("[2]", "[0,8]") + ",\"b\":" + tensor("[2]", "[4,12]") + "}", 12);
  EXPECT_THAT(errorOfReading(),
              HasSubstr("tensor b: expected data from byte 8 on, found an overlap from byte 4"));
}

TEST_F(Safetensors, NamesTheTensorAfterAGap) {
  writeRaw("{\"a\":" + tensor("[1]", "[0,4]") + ",\"b\":" + tensor("[1]", "[8,12]") + "}", 12);
  EXPECT_THAT(errorOfReading(),
              HasSubstr("tensor b: expected data from byte 4 on, found a gap from byte 8"));
}

TEST_F(Safetensors, LeavesNothingBehindWhenItCannotWrite) {
  const std::string path = folder_ / "missing/weights.safetensors";
  EXPECT_THAT(test::startupErrorOf([&] { writeSafetensors(path, exampleFile()); }),
              AllOf(StartsWith(path), HasSubstr("expected a file that can be written, found No")));
}

}  // namespace
}  // namespace roundabout::planner::nn
