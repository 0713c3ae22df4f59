#include "calibrato/learning/byte_stream.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "calibrato/base/input_error.h"

namespace calibrato {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

std::string SomeContent() {
  ByteWriter writer;
  writer.Write(int64_t{-7});
  writer.Write(0.1);
  writer.Write(std::string_view("two\nlines"));
  writer.Write(std::vector<float>{1.5F, -2.5F});
  writer.Write(Eigen::VectorXd(Eigen::Vector3d(1.0, 2.0, 3.0)));
  writer.Write(Eigen::MatrixXd(Eigen::Matrix<double, 2, 3>{{1, 2, 3}, {4, 5, 6}}));
  writer.Write(Eigen::MatrixXd(72, 0));
  return writer.bytes();
}

void ReadAll(std::string_view bytes) {
  ByteReader reader(bytes, "some.bin");
  EXPECT_EQ(reader.ReadInt(), -7);
  EXPECT_EQ(reader.ReadDouble(), 0.1);
  EXPECT_EQ(reader.ReadText(), "two\nlines");
  EXPECT_EQ(reader.ReadFloats(), (std::vector<float>{1.5F, -2.5F}));
  EXPECT_EQ(reader.ReadVector(), Eigen::Vector3d(1.0, 2.0, 3.0));
  EXPECT_EQ(reader.ReadMatrix(), (Eigen::Matrix<double, 2, 3>{{1, 2, 3}, {4, 5, 6}}));
  const Eigen::MatrixXd empty = reader.ReadMatrix();
  EXPECT_EQ(empty.rows(), 72);
  EXPECT_EQ(empty.cols(), 0);
  reader.ExpectEnd();
}

TEST(ByteReader, ReadsWhatAWriterWrote) { ReadAll(SomeContent()); }

TEST(ByteReader, RefusesContentCutAnywhere) {
  const std::string bytes = SomeContent();
  for (size_t size = 0; size < bytes.size(); ++size) {
    EXPECT_THROW(ReadAll(std::string_view(bytes).substr(0, size)), InputError) << size;
  }
}

TEST(ByteReader, RefusesCountsThatTheContentCannotFill) {
  for (const int64_t count : {int64_t{-1}, std::numeric_limits<int64_t>::max()}) {
    ByteWriter writer;
    writer.Write(count);
    ByteReader reader(writer.bytes(), "some.bin");
    EXPECT_THROW(reader.ReadFloats(), InputError);
  }
}

TEST(ByteReader, RefusesContentThatGoesOn) {
  const ByteReader reader("x", "some.bin");
  EXPECT_THROW(reader.ExpectEnd(), InputError);
}

TEST(Unsealed, GivesBackTheContent) {
  EXPECT_EQ(Unsealed("SOMEKIND", 3, Sealed("SOMEKIND", 3, "the content"), "f"), "the content");
  EXPECT_EQ(Unsealed("SOMEKIND", 3, Sealed("SOMEKIND", 3, ""), "f"), "");
}

TEST(Unsealed, RefusesBytesCutAnywhereOrChangedAnywhere) {
  const std::string bytes = Sealed("SOMEKIND", 3, "the content of the file");
  for (size_t i = 0; i < bytes.size(); ++i) {
    EXPECT_THROW((void)Unsealed("SOMEKIND", 3, bytes.substr(0, i), "f"), InputError) << i;
    std::string changed = bytes;
    changed[i] = static_cast<char>(changed[i] ^ 4);
    EXPECT_THROW((void)Unsealed("SOMEKIND", 3, changed, "f"), InputError) << i;
  }
}

TEST(Unsealed, NamesFileAndBothVersions) {
  EXPECT_THAT([] { (void)Unsealed("SOMEKIND", 3, Sealed("SOMEKIND", 2, "x"), "out/f.bin"); },
              ThrowsMessage<InputError>(
                  AllOf(HasSubstr("out/f.bin"), HasSubstr("version 2"), HasSubstr("version 3"))));
}

TEST(Unsealed, TellsAnotherKindOfFile) {
  EXPECT_THAT([] { (void)Unsealed("SOMEKIND", 3, "seed: 1\n", "f"); },
              ThrowsMessage<InputError>(HasSubstr("another kind of file")));
}

}  // namespace
}  // namespace calibrato
