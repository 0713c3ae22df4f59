#include "calibrato/recording/convert_recording.h"

#include <algorithm>
#include <cctype>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <system_error>
#include <utility>
#include <vector>

#include "calibrato/base/input_error.h"
#include "calibrato/base/progress.h"
#include "calibrato/recording/message_writer.h"
#include "calibrato/recording/recording_folder.h"
#include "calibrato/recording/recording_folder_writer.h"
#include "calibrato/recording/ros_messages.h"
#include "calibrato/recording/topic_choice.h"

namespace calibrato {
namespace {

namespace fs = std::filesystem;

const CameraImages& ImagesOf(const CameraRecording& camera) {
  return std::get<CameraImages>(camera.data);
}

void CheckConvertible(const Recording& recording) {
  for (const CameraRecording& camera : recording.cameras) {
    if (std::holds_alternative<std::vector<BoardView>>(camera.data)) {
      throw InputError({"corner lists cannot be converted", recording.path,
                        camera.name + " has corners, for which bags have no form",
                        "convert the images, or use the list as it is"});
    }
    const std::vector<RecordedImage>& list = ImagesOf(camera).list;
    const bool has_stamps = std::any_of(list.begin(), list.end(),
                                        [](const RecordedImage& i) { return i.stamp != Time(); });
    if (!has_stamps && list.size() > 1) {
      throw InputError({"photos without stamps cannot be converted", recording.path,
                        camera.name + " has none",
                        "name the images by their stamps in nanoseconds"});
    }
  }
}

void CheckTarget(const std::string& path, bool replace) {
  std::error_code error;
  if (!fs::exists(fs::symlink_status(path, error))) return;
  if (!replace) {
    throw InputError({"there is something at --out already", path,
                      "a recording is not replaced unasked", "choose another name or add --force"});
  }
  if (fs::is_directory(path, error) && !HoldsCameras(path)) {
    throw InputError({"there is a folder at --out already", path, "it holds no recording",
                      "choose another name or remove it"});
  }
}

// The seconds of a header's stamp have 32 bits, in ROS 2 with a sign.
void CheckStamp(MessageEncoding encoding, Time stamp, const std::string& topic) {
  const int64_t last_s = encoding == MessageEncoding::kCdr ? INT32_MAX : int64_t{UINT32_MAX};
  if (stamp.nanoseconds() / 1'000'000'000 <= last_s) return;
  throw InputError(
      {"stamp too late for a bag", topic,
       std::to_string(stamp.nanoseconds()) + " ns, the last is " + std::to_string(last_s) + " s",
       "check that the stamps are in nanoseconds"});
}

// What ROS takes as the name of a topic; a glob that chose photos is none.
bool IsTopic(const std::string& name) {
  return name.starts_with('/') && std::all_of(name.begin(), name.end(), [](unsigned char c) {
           return std::isalnum(c) != 0 || c == '_' || c == '/';
         });
}

// A run of messages of one topic, in the order in which they are to be written.
class Stream {
 public:
  Stream(const std::string& topic, const std::string& type, std::vector<Time> stamps,
         std::function<std::string(size_t)> message, MessageBagWriter* writer)
      : topic_(writer->AddTopic(topic, type)),
        stamps_(std::move(stamps)),
        message_(std::move(message)) {
    for (const Time stamp : stamps_) CheckStamp(writer->encoding(), stamp, topic);
  }
  bool at_end() const { return next_ == stamps_.size(); }
  Time stamp() const { return stamps_[next_]; }
  size_t size() const { return stamps_.size(); }
  void WriteNext(MessageBagWriter* writer) {
    writer->Write(topic_, stamp(), message_(next_));
    ++next_;
  }

 private:
  size_t topic_;
  std::vector<Time> stamps_;
  std::function<std::string(size_t)> message_;
  size_t next_ = 0;
};

std::vector<Time> StampsOf(const std::vector<VectorSample>& samples) {
  std::vector<Time> stamps;
  stamps.reserve(samples.size());
  for (const VectorSample& sample : samples) stamps.push_back(sample.stamp);
  return stamps;
}

Stream CameraStream(const CameraRecording& camera, const std::string& fallback,
                    MessageBagWriter* writer) {
  const CameraImages& images = ImagesOf(camera);
  const bool is_file = std::holds_alternative<EncodedFile>(images.reader->Read(0).content);
  std::string topic = camera.name;
  if (!IsTopic(topic)) topic = fallback + (is_file ? "/compressed" : "");
  std::vector<Time> stamps;
  for (const RecordedImage& image : images.list) stamps.push_back(image.stamp);
  const MessageEncoding encoding = writer->encoding();
  return {topic, is_file ? "CompressedImage" : "Image", std::move(stamps),
          [&images, encoding](size_t k) -> std::string {
            StoredImage image = images.reader->Read(k);
            const Time stamp = images.list[k].stamp;
            const auto sequence = static_cast<uint32_t>(k);
            if (auto* file = std::get_if<EncodedFile>(&image.content)) {
              return CompressedImageMessageBytes(encoding, {stamp, "", std::move(*file)}, sequence);
            }
            return ImageMessageBytes(
                encoding, {stamp, "", std::get<RawPixels>(std::move(image.content))}, sequence);
          },
          writer};
}

Stream ImuTopicStream(const std::string& topic, const std::vector<VectorSample>* gyro,
                      const std::vector<VectorSample>* accel, MessageBagWriter* writer) {
  const MessageEncoding encoding = writer->encoding();
  return {topic, "Imu", StampsOf(gyro != nullptr ? *gyro : *accel),
          [=](size_t k) {
            ImuMessage message;
            message.stamp = (gyro != nullptr ? *gyro : *accel)[k].stamp;
            if (gyro != nullptr) message.gyro = (*gyro)[k].value;
            if (accel != nullptr) message.accel = (*accel)[k].value;
            return ImuMessageBytes(encoding, message, static_cast<uint32_t>(k));
          },
          writer};
}

void AddImuStreams(const ImuRecording& imu, const std::string& fallback, MessageBagWriter* writer,
                   std::vector<Stream>* streams) {
  const std::string topic = IsTopic(imu.name) ? imu.name : fallback;
  if (HasCommonStamps(imu.stream)) {
    streams->push_back(ImuTopicStream(topic, &imu.stream.gyro, &imu.stream.accel, writer));
    return;
  }
  const std::string gyro = AccelTopicOf(topic).empty() ? topic + "/gyro" : topic;
  streams->push_back(ImuTopicStream(gyro, &imu.stream.gyro, nullptr, writer));
  streams->push_back(ImuTopicStream(AccelTopicOf(gyro), nullptr, &imu.stream.accel, writer));
}

// Messages of all topics in order of time; those of one topic stay in their own order.
void WriteBag(const Recording& recording, MessageBagWriter* writer) {
  std::vector<Stream> streams;
  for (size_t n = 0; n < recording.cameras.size(); ++n) {
    streams.push_back(
        CameraStream(recording.cameras[n], "/cam" + std::to_string(n) + "/image_raw", writer));
  }
  for (size_t n = 0; n < recording.imus.size(); ++n) {
    AddImuStreams(recording.imus[n], "/imu" + std::to_string(n), writer, &streams);
  }
  size_t num_messages = 0;
  for (const Stream& stream : streams) num_messages += stream.size();
  Progress progress("writing", static_cast<int64_t>(num_messages));
  for (size_t k = 0; k < num_messages; ++k) {
    Stream* earliest = nullptr;
    for (Stream& stream : streams) {
      if (stream.at_end()) continue;
      if (earliest == nullptr || stream.stamp() < earliest->stamp()) earliest = &stream;
    }
    earliest->WriteNext(writer);
    progress.Advance();
  }
  writer->Close();
}

}  // namespace

RecordingForm RecordingFormFromName(const std::string& name) {
  if (name == "folder") return RecordingForm::kFolder;
  if (name == "rosbag1") return RecordingForm::kRosbag1;
  if (name == "mcap") return RecordingForm::kMcap;
  throw InputError({"unknown form '" + name + "'", "--to", "recordings are not written as that",
                    "give folder, rosbag1 or mcap"});
}

ConversionResult ConvertRecording(const Recording& recording, RecordingForm form,
                                  const std::string& path, bool replace) {
  CheckConvertible(recording);
  CheckTarget(path, replace);
  switch (form) {
    case RecordingForm::kFolder:
      WriteRecordingFolder(recording, path);
      break;
    case RecordingForm::kRosbag1:
      WriteBag(recording, NewRosbag1(path).get());
      break;
    case RecordingForm::kMcap:
      WriteBag(recording, NewMcap(path).get());
      break;
  }
  ConversionResult result;
  for (const CameraRecording& camera : recording.cameras) {
    result.num_images += static_cast<int64_t>(ImagesOf(camera).list.size());
  }
  for (const ImuRecording& imu : recording.imus) {
    result.num_imu_samples += static_cast<int64_t>(imu.stream.gyro.size());
  }
  return result;
}

}  // namespace calibrato
