#include "calibrato/learning/training_log.h"

#include <gtest/gtest.h>

#include <filesystem>

#include "calibrato/base/files.h"

namespace calibrato {
namespace {

TEST(TrainingLog, IsOnDiskAsItIsInMemoryLineByLine) {
  const std::string folder = testing::TempDir() + "calibrato_training_log";
  std::filesystem::create_directories(folder);
  const std::string path = folder + "/training.jsonl";
  TrainingLog log(folder, "{\"episode\":1}\n");
  EXPECT_EQ(ReadFile(path), "{\"episode\":1}\n");
  log.Append(Value::Object().Set("episode", 2));
  EXPECT_EQ(ReadFile(path), "{\"episode\":1}\n{\"episode\": 2}\n");
  EXPECT_EQ(ReadFile(path), log.lines());
  log.Rewind("{\"episode\":1}\n");
  log.Append(Value::Object().Set("episode", 3));
  EXPECT_EQ(ReadFile(path), "{\"episode\":1}\n{\"episode\": 3}\n");
}

}  // namespace
}  // namespace calibrato
