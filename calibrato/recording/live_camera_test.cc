#include "calibrato/recording/live_camera.h"

#include <gtest/gtest.h>

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <memory>
#include <mutex>
#include <stdexcept>
#include <vector>

#include "calibrato/base/input_error.h"
#include "calibrato/recording/test_folder.h"
#include "calibrato/recording/video_writer.h"

namespace calibrato {
namespace {

GreyImage Plain(int level) {
  return {{2, 1}, std::vector<uint8_t>(2, static_cast<uint8_t>(level))};
}

// Gives frames 0, 1, .. up to a number that may be raised, then holds back the next.
class SteppedDevice {
 public:
  LiveCamera::Device Device(bool may_drop) {
    return {[this] { return Grab(); },
            [this]() -> std::optional<GreyImage> { return Plain(num_given_ - 1); }, may_drop};
  }
  void GiveUpTo(int number) {
    const std::lock_guard lock(mutex_);
    allowed_ = number;
    changed_.notify_all();
  }
  // Once it is asked for the frame after these, all of them were handed over.
  void WaitUntilAskedBeyond(int number) {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [&] { return num_asked_ > number; });
  }
  void End() {
    const std::lock_guard lock(mutex_);
    is_over_ = true;
    changed_.notify_all();
  }

 private:
  bool Grab() {
    std::unique_lock lock(mutex_);
    ++num_asked_;
    changed_.notify_all();
    changed_.wait(lock, [&] { return is_over_ || num_given_ < allowed_; });
    if (num_given_ >= allowed_) return false;
    ++num_given_;
    return true;
  }

  std::mutex mutex_;
  std::condition_variable changed_;
  int allowed_ = 0;
  int num_asked_ = 0;
  int num_given_ = 0;
  bool is_over_ = false;
};

Time Now() {
  return Time::FromNanoseconds(std::chrono::duration_cast<std::chrono::nanoseconds>(
                                   std::chrono::system_clock::now().time_since_epoch())
                                   .count());
}

// Whoever is busy meanwhile gets the latest, stamped when it came and not when it was asked for.
TEST(LiveCamera, StampsFramesAsTheyComeAndDropsThoseThatNobodyAsksFor) {
  SteppedDevice device;
  LiveCamera camera(device.Device(true));
  // Wherever the test ends: the camera's thread waits for the device.
  const std::shared_ptr<void> ending(nullptr, [&](void*) { device.End(); });
  device.GiveUpTo(1);
  const auto first = camera.Next();
  ASSERT_TRUE(first);
  EXPECT_EQ(first->image.pixels, Plain(0).pixels);
  EXPECT_EQ(first->num_dropped, 0);
  device.GiveUpTo(6);
  device.WaitUntilAskedBeyond(6);
  const Time after_all = Now();
  device.GiveUpTo(7);
  device.WaitUntilAskedBeyond(7);
  const Time before_asking = Now();
  const auto latest = camera.Next();
  ASSERT_TRUE(latest);
  EXPECT_EQ(latest->image.pixels, Plain(6).pixels);
  EXPECT_EQ(latest->num_dropped, 5);
  EXPECT_GE(latest->stamp, after_all);
  EXPECT_LE(latest->stamp, before_asking);
  device.GiveUpTo(8);
  const auto next = camera.Next();
  ASSERT_TRUE(next);
  EXPECT_EQ(next->num_dropped, 0);
  device.End();
  EXPECT_FALSE(camera.Next());
  EXPECT_FALSE(camera.Next());
}

TEST(LiveCamera, EndsWhereTheDeviceThrows) {
  LiveCamera camera(LiveCamera::Device{[]() -> bool { throw std::runtime_error("unplugged"); },
                                       [] { return std::optional<GreyImage>(); }, true});
  EXPECT_FALSE(camera.Next());
}

TEST(LiveCamera, GivesAllFramesOfAFile) {
  const TestFolder folder;
  const std::string path = folder.path() + "/clip.avi";
  constexpr int kNumFrames = 12;
  {
    VideoWriter video(path, {64, 48}, 10.0);
    for (int k = 0; k < kNumFrames; ++k) {
      video.Add({{64, 48}, std::vector<uint8_t>(3 * 64 * 48, static_cast<uint8_t>(20 * k))},
                0.1 * k);
    }
    video.Finish(0.1 * kNumFrames);
  }
  LiveCamera camera(path);
  std::vector<LiveCamera::Frame> frames;
  while (auto frame = camera.Next()) frames.push_back(std::move(*frame));
  ASSERT_EQ(frames.size(), static_cast<size_t>(kNumFrames));
  for (int k = 0; k < kNumFrames; ++k) {
    const auto& frame = frames[static_cast<size_t>(k)];
    EXPECT_EQ(frame.num_dropped, 0);
    EXPECT_NEAR(frame.image.pixels[0], 20 * k, 3);
    if (k == 0) continue;
    EXPECT_GT(frame.stamp, frames[static_cast<size_t>(k - 1)].stamp);
  }
}

TEST(LiveCamera, LeavesAFileThatIsNotReadToItsEnd) {
  const TestFolder folder;
  const std::string path = folder.path() + "/clip.avi";
  {
    VideoWriter video(path, {64, 48}, 10.0);
    video.Add({{64, 48}, std::vector<uint8_t>(size_t{3} * 64 * 48, 80)}, 0.0);
    video.Finish(0.5);
  }
  LiveCamera camera(path);
  EXPECT_TRUE(camera.Next());
}

TEST(LiveCamera, NamesADeviceThatIsNotThere) {
  try {
    const LiveCamera camera("/dev/no-such-camera");
    ADD_FAILURE() << "opened";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("/dev/no-such-camera"), std::string::npos);
  }
}

}  // namespace
}  // namespace calibrato
