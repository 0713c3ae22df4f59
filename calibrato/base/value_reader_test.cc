#include "calibrato/base/value_reader.h"

#include <gtest/gtest.h>

#include "calibrato/base/input_error_testing.h"

namespace calibrato {
namespace {

TEST(ValueReader, GivesEveryPartItsKeyAndTheLineOfItsKey) {
  ValueReader reader("f");
  reader.BeginObject(1);
  reader.AddKey("cam0", 2);
  reader.BeginObject(3);
  reader.AddKey("intrinsics", 3);
  reader.BeginArray(3);
  reader.AddScalar(1.0, 3);
  reader.AddScalar(2.0, 4);
  reader.End();
  reader.End();
  reader.End();
  const Value root = reader.Finish();
  EXPECT_EQ(root.Where(), "f line 1");
  EXPECT_EQ(root.At("cam0").Where(), "f line 2, key cam0");
  EXPECT_EQ(root.At("cam0").At("intrinsics").elements()[1].Where(),
            "f line 4, key cam0.intrinsics[1]");
}

TEST(ValueReader, RefusesTooDeepNestingAtTheExactLevel) {
  ValueReader reader("f");
  for (size_t i = 0; i < ValueReader::kMaxDepth; ++i) reader.BeginArray(1);
  EXPECT_NE(InputErrorOf([&] { reader.BeginArray(7); }).find("too many levels, f line 7"),
            std::string::npos);
}

TEST(ValueReader, RefusesTooManyValues) {
  ValueReader reader("f");
  reader.BeginArray(1);
  for (size_t i = 1; i < ValueReader::kMaxValues; ++i) reader.AddScalar(0, 2);
  EXPECT_NE(InputErrorOf([&] { reader.AddScalar(0, 3); }).find("too many values, f line 3"),
            std::string::npos);
}

TEST(ValueReader, RefusesLongKeysRepeatedInManyPaths) {
  ValueReader reader("f");
  reader.BeginObject(1);
  reader.AddKey(std::string(10'000'000, 'k'), 1);
  reader.BeginArray(1);
  const std::string message = InputErrorOf([&] {
    for (int i = 0; i < 100; ++i) reader.AddScalar(0, 1);
  });
  EXPECT_NE(message.find("too much text"), std::string::npos);
}

TEST(ValueReader, RefusesADuplicateKey) {
  ValueReader reader("f");
  reader.BeginObject(1);
  reader.AddKey("a", 1);
  reader.AddScalar(1, 1);
  EXPECT_EQ(InputErrorOf([&] { reader.AddKey("a", 2); }),
            "duplicate key a, f line 2: it stands earlier in the same mapping; remove one of the "
            "two");
}

}  // namespace
}  // namespace calibrato
