#include "calibrato/recording/decompression.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "calibrato/recording/bag_for_test.h"
#include "calibrato/recording/byte_fields.h"

namespace calibrato {
namespace {

using testing::HasSubstr;

// Long enough for several buffers, with repetitions and without.
std::string Content() {
  std::string content;
  uint32_t state = 1;
  for (int k = 0; k < 3'000'000; ++k) {
    state = state * 1664525 + 1013904223;
    content += k % 1000 < 300 ? static_cast<char>(state >> 24) : 'a';
  }
  return content;
}

std::string WhyNot(Compression compression, const std::string& packed, uint64_t size) {
  try {
    static_cast<void>(Decompress(compression, packed, size));
  } catch (const Damage& damage) {
    return damage.why;
  }
  return "";
}

struct Packer {
  Compression compression;
  std::string (*pack)(const std::string&);
};

class DecompressionTest : public testing::TestWithParam<Packer> {};

TEST_P(DecompressionTest, GivesBackWhatWasPacked) {
  const auto [compression, pack] = GetParam();
  const std::string content = Content();
  EXPECT_EQ(Decompress(compression, pack(content), content.size()), content);
  EXPECT_EQ(Decompress(compression, pack("x"), 1), "x");
  EXPECT_EQ(Decompress(compression, pack(""), 0), "");
}

TEST_P(DecompressionTest, HoldsTheSizeToTheClaim) {
  const auto [compression, pack] = GetParam();
  const std::string content = Content();
  const std::string packed = pack(content);
  EXPECT_NE(WhyNot(compression, packed, content.size() - 1), "");
  EXPECT_NE(WhyNot(compression, packed, content.size() + 1), "");
  // What is claimed costs no memory: this would be an exabyte.
  EXPECT_THAT(WhyNot(compression, packed, uint64_t{1} << 60), HasSubstr("claims"));
}

TEST_P(DecompressionTest, RefusesWhatIsTruncatedOrDamaged) {
  const auto [compression, pack] = GetParam();
  const std::string content = Content().substr(0, 5000);
  const std::string packed = pack(content);
  for (size_t size = 0; size < packed.size(); size += 7) {
    EXPECT_NE(WhyNot(compression, packed.substr(0, size), content.size()), "") << size;
  }
  EXPECT_THAT(WhyNot(compression, "no such thing", 100), HasSubstr("damaged"));
}

INSTANTIATE_TEST_SUITE_P(Packers, DecompressionTest,
                         testing::Values(Packer{Compression::kBzip2, PackedByBzip2},
                                         Packer{Compression::kLz4, PackedByLz4},
                                         Packer{Compression::kZstd, PackedByZstd}));

TEST(Decompress, TakesNoneAsItIs) {
  EXPECT_EQ(Decompress(Compression::kNone, "abc", 3), "abc");
  EXPECT_THAT(WhyNot(Compression::kNone, "abc", 4), HasSubstr("claims 4"));
}

TEST(CompressionFromName, KnowsTheNamesOfBags) {
  EXPECT_EQ(CompressionFromName("none"), Compression::kNone);
  EXPECT_EQ(CompressionFromName(""), Compression::kNone);
  EXPECT_EQ(CompressionFromName("bz2"), Compression::kBzip2);
  EXPECT_EQ(CompressionFromName("lz4"), Compression::kLz4);
  EXPECT_EQ(CompressionFromName("zstd"), Compression::kZstd);
  EXPECT_EQ(CompressionFromName("rar"), std::nullopt);
}

}  // namespace
}  // namespace calibrato
