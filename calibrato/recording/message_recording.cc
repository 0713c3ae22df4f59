#include "calibrato/recording/message_recording.h"

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <map>
#include <string_view>
#include <system_error>
#include <utility>

#include "calibrato/base/files.h"
#include "calibrato/base/input_error.h"
#include "calibrato/recording/byte_fields.h"
#include "calibrato/recording/file_kind.h"
#include "calibrato/recording/mcap_reader.h"
#include "calibrato/recording/ros_messages.h"
#include "calibrato/recording/rosbag1_reader.h"
#include "calibrato/recording/rosbag2_reader.h"
#include "calibrato/recording/topic_choice.h"

namespace calibrato {
namespace {

namespace fs = std::filesystem;

using Logs = std::vector<std::unique_ptr<MessageLog>>;

struct PlacedImage {
  Time stamp;
  size_t log = 0;
  MessagePlace place;
};

// All that one topic has.
struct TopicContent {
  std::string type;
  MessageEncoding encoding = MessageEncoding::kRos1;
  std::vector<PlacedImage> images;
  ImuStream imu;
};

using Contents = std::map<std::string, TopicContent>;

// Even packed, a message that says something takes up bytes: more messages than that are not a
// recording, but a file that was made to exhaust the memory.
uint64_t MaxMessages(const Logs& logs) {
  constexpr uint64_t kAlways = 100'000;
  constexpr uint64_t kMinPackedBytes = 8;
  uint64_t num_bytes = 0;
  for (const auto& log : logs) {
    std::error_code error;
    const uintmax_t size = fs::file_size(log->path(), error);
    if (!error) num_bytes += size;
  }
  return kAlways + num_bytes / kMinPackedBytes;
}

[[noreturn]] void FailMessage(const std::string& path, const std::string& topic,
                              const std::string& why) {
  throw InputError(
      {"cannot read message", path + ", " + topic, why, "copy the bag again, or record it again"});
}

Contents ContentsOf(const std::string& path, const Logs& logs) {
  Contents contents;
  const uint64_t max_messages = MaxMessages(logs);
  uint64_t num_messages = 0;
  for (size_t k = 0; k < logs.size(); ++k) {
    logs[k]->ForEach([&](const LogTopic& topic, const MessagePlace& place, std::string_view bytes) {
      if (++num_messages > max_messages) {
        throw InputError({"cannot read bag", path,
                          "it has more messages than a file of its size can hold",
                          "copy it again, or record it again"});
      }
      const auto [entry, is_new] =
          contents.try_emplace(topic.name, TopicContent{topic.type, topic.encoding, {}, {}});
      TopicContent& content = entry->second;
      if (!is_new && (content.type != topic.type || content.encoding != topic.encoding)) {
        FailMessage(path, topic.name, "the topic has messages of two types");
      }
      try {
        if (topic.type != "Imu") {
          content.images.push_back({StampOfMessage(topic.encoding, bytes), k, place});
          return;
        }
        const ImuMessage imu = ReadImuMessage(topic.encoding, bytes);
        if (imu.gyro) content.imu.gyro.push_back({imu.stamp, *imu.gyro});
        if (imu.accel) content.imu.accel.push_back({imu.stamp, *imu.accel});
      } catch (const Damage& damage) {
        FailMessage(logs[k]->path(), topic.name, damage.why);
      }
    });
  }
  return contents;
}

class MessageImages : public ImageReader {
 public:
  MessageImages(std::shared_ptr<const Logs> logs, std::string topic, TopicContent content)
      : logs_(std::move(logs)), topic_(std::move(topic)), content_(std::move(content)) {}

  StoredImage Read(size_t k) const override {
    const PlacedImage& image = content_.images.at(k);
    const MessageLog& log = *(*logs_)[image.log];
    const std::string where =
        log.path() + ", " + topic_ + " at " + std::to_string(image.stamp.nanoseconds());
    const std::string bytes = log.Read(image.place);
    try {
      if (content_.type == "Image") {
        return {ReadImageMessage(content_.encoding, bytes).pixels, where};
      }
      return {ReadCompressedImageMessage(content_.encoding, bytes).file, where};
    } catch (const Damage& damage) {
      throw InputError({"cannot read image", where, damage.why, "copy the bag again"});
    }
  }

 private:
  std::shared_ptr<const Logs> logs_;
  std::string topic_;
  TopicContent content_;
};

CameraRecording Camera(const std::string& path, const std::shared_ptr<const Logs>& logs,
                       const std::string& topic, TopicContent content) {
  std::vector<PlacedImage>& images = content.images;
  const auto before = [](const PlacedImage& a, const PlacedImage& b) { return a.stamp < b.stamp; };
  std::vector<Time> stamps_as_recorded;
  if (!std::is_sorted(images.begin(), images.end(), before)) {
    for (const PlacedImage& image : images) stamps_as_recorded.push_back(image.stamp);
  }
  std::stable_sort(images.begin(), images.end(), before);
  const auto twin = std::adjacent_find(
      images.begin(), images.end(),
      [](const PlacedImage& a, const PlacedImage& b) { return a.stamp == b.stamp; });
  if (twin != images.end()) {
    const bool is_unset = twin->stamp == Time();
    throw InputError({"two images of one stamp", path + ", " + topic,
                      "their headers say " + std::to_string(twin->stamp.nanoseconds()) + " ns",
                      is_unset ? "let the camera's driver fill in header.stamp"
                               : "record the bag again, with one publisher to the topic"});
  }
  CameraImages recorded;
  recorded.stamps_as_recorded = std::move(stamps_as_recorded);
  for (const PlacedImage& image : images) {
    recorded.list.push_back({std::to_string(image.stamp.nanoseconds()), image.stamp});
  }
  recorded.reader = std::make_shared<const MessageImages>(logs, topic, std::move(content));
  return {topic, std::move(recorded), std::nullopt};
}

// The topic's samples; of a topic of one sensor, those of the other's beside them.
ImuRecording ImuOf(const std::string& path, const ImuTopics& topics, Contents* contents) {
  ImuRecording imu{topics.gyro, {}};
  imu.stream.gyro = std::move(contents->at(topics.gyro).imu.gyro);
  imu.stream.accel = std::move(contents->at(topics.accel).imu.accel);
  if (imu.stream.gyro.empty() || imu.stream.accel.empty()) {
    const bool no_gyro = imu.stream.gyro.empty();
    FailMessage(path, no_gyro ? topics.gyro : topics.accel,
                no_gyro ? "it has no angular velocities" : "it has no linear accelerations");
  }
  return imu;
}

std::unique_ptr<MessageLog> OpenLog(const std::string& path) {
  switch (KindOfFile(path)) {
    case FileKind::kRosbag1:
      return OpenRosbag1(path);
    case FileKind::kOldRosbag1:
      throw InputError(
          {"cannot read bag", path, "it is of a format before 2.0", "convert it by 'rosbag fix'"});
    case FileKind::kMcap:
      return OpenMcap(path);
    case FileKind::kSqlite:
      return OpenRosbag2Database(path);
    case FileKind::kZstd:
      if (!path.ends_with(".db3.zstd") && !path.ends_with(".mcap.zstd")) return nullptr;
      throw InputError({"cannot read bag", path, "the file as a whole is packed by zstd",
                        "unpack it by 'zstd -d'"});
    case FileKind::kVideo:
    case FileKind::kOther:
      return nullptr;
  }
  return nullptr;
}

bool IsFolder(const std::string& path) {
  std::error_code error;
  return fs::is_directory(path, error);
}

}  // namespace

std::vector<std::unique_ptr<MessageLog>> OpenMessageLogs(const std::string& path) {
  std::vector<std::string> paths = {path};
  if (IsFolder(path)) {
    paths.clear();
    for (const std::string& name : ListFiles(path)) {
      std::error_code error;
      const fs::path file = fs::path(path) / name;
      if (fs::is_regular_file(file, error)) paths.push_back(file.string());
    }
    // Parts are numbered without leading zeros: bag_2 comes before bag_10.
    std::stable_sort(paths.begin(), paths.end(), [](const std::string& a, const std::string& b) {
      return a.size() < b.size();
    });
  }
  Logs logs;
  for (const std::string& file : paths) {
    if (auto log = OpenLog(file)) logs.push_back(std::move(log));
  }
  return logs;
}

Recording OpenMessageRecording(const std::string& path, Logs given,
                               const RecordingOptions& options) {
  const auto logs = std::make_shared<const Logs>(std::move(given));
  Contents contents = ContentsOf(path, *logs);
  std::vector<std::string> image_topics;
  std::vector<std::string> imu_topics;
  for (const auto& [topic, content] : contents) {
    (content.type == "Imu" ? imu_topics : image_topics).push_back(topic);
  }
  Recording recording{path, {}, {}, {}};
  for (const auto& log : *logs) {
    recording.warnings.insert(recording.warnings.end(), log->warnings().begin(),
                              log->warnings().end());
  }
  const bool is_without_cameras = options.cameras_may_be_missing && options.image_globs.empty() &&
                                  image_topics.empty() && !imu_topics.empty();
  if (options.with_cameras && !is_without_cameras) {
    for (const std::string& topic : ChooseImageTopics(path, image_topics, options.image_globs)) {
      recording.cameras.push_back(Camera(path, logs, topic, std::move(contents.at(topic))));
    }
  }
  if (options.with_imus) {
    for (const ImuTopics& topics : ChooseImuTopics(path, imu_topics, options.imu_globs)) {
      recording.imus.push_back(ImuOf(path, topics, &contents));
    }
  }
  return recording;
}

}  // namespace calibrato
