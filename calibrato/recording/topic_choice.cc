#include "calibrato/recording/topic_choice.h"

#include <fnmatch.h>

#include <algorithm>
#include <cctype>
#include <iterator>
#include <string_view>

#include "calibrato/base/input_error.h"

namespace calibrato {
namespace {

std::string Listed(const std::vector<std::string>& topics) {
  constexpr size_t kMaxListed = 12;
  std::string text;
  for (size_t k = 0; k < std::min(topics.size(), kMaxListed); ++k) {
    text += (k == 0 ? "" : ", ") + topics[k];
  }
  if (topics.size() > kMaxListed) text += ", ..";
  return text;
}

bool IsDigit(char c) { return std::isdigit(static_cast<unsigned char>(c)) != 0; }

// The name with every number replaced by '#'.
std::string Pattern(const std::string& topic) {
  std::string pattern;
  for (const char c : topic) {
    if (!IsDigit(c)) {
      pattern += c;
    } else if (!pattern.ends_with('#')) {
      pattern += '#';
    }
  }
  return pattern;
}

// Of names of one pattern: numbers of more digits are larger, then they compare as text.
bool ComesBefore(const std::string& a, const std::string& b) {
  return a.size() != b.size() ? a.size() < b.size() : a < b;
}

// What the user is told of a kind of topics.
struct Words {
  std::string kind;    // "image"
  std::string option;  // "--images"
};

std::vector<std::string> Choose(const std::string& path, std::vector<std::string> topics,
                                const std::vector<std::string>& globs, const Words& words) {
  std::sort(topics.begin(), topics.end(), ComesBefore);
  std::vector<std::string> chosen;
  for (const std::string& glob : globs) {
    std::vector<std::string> fitting;
    std::copy_if(
        topics.begin(), topics.end(), std::back_inserter(fitting),
        [&](const std::string& topic) { return fnmatch(glob.c_str(), topic.c_str(), 0) == 0; });
    if (fitting.size() != 1) {
      throw InputError({fitting.empty() ? "no " + words.kind + " topic fits '" + glob + "'"
                                        : "several " + words.kind + " topics fit '" + glob + "'",
                        path, topics.empty() ? "it has none" : "it has " + Listed(topics),
                        "give one of them by " + words.option});
    }
    chosen.push_back(fitting.front());
  }
  if (!globs.empty()) return chosen;
  const bool is_numbered = std::all_of(topics.begin(), topics.end(), [&](const std::string& topic) {
    return Pattern(topic) == Pattern(topics.front());
  });
  if (!is_numbered) {
    throw InputError(
        {"which " + words.kind + " topics?", path, "it has " + Listed(topics),
         "choose by " + words.option + " " + topics.front() + ", once for each, in their order"});
  }
  return topics;
}

}  // namespace

std::vector<std::string> ChooseImageTopics(const std::string& path,
                                           const std::vector<std::string>& topics,
                                           const std::vector<std::string>& globs) {
  if (topics.empty()) {
    throw InputError({"no images", path,
                      "it has no messages of sensor_msgs' Image or CompressedImage",
                      "record the topic of the camera"});
  }
  return Choose(path, topics, globs, {"image", "--images"});
}

std::vector<ImuTopics> ChooseImuTopics(const std::string& path,
                                       const std::vector<std::string>& topics,
                                       const std::vector<std::string>& globs) {
  // Pairs count as one IMU, under the name of the gyroscope.
  std::vector<std::string> names = topics;
  const auto has = [&](const std::string& topic) {
    return std::find(topics.begin(), topics.end(), topic) != topics.end();
  };
  std::erase_if(names, [&](const std::string& name) {
    return std::any_of(topics.begin(), topics.end(),
                       [&](const std::string& topic) { return AccelTopicOf(topic) == name; });
  });
  std::vector<ImuTopics> chosen;
  for (const std::string& name : Choose(path, names, globs, {"IMU", "--imu-topic"})) {
    const std::string accel = AccelTopicOf(name);
    chosen.push_back({name, has(accel) ? accel : name});
  }
  return chosen;
}

std::string AccelTopicOf(std::string gyro_topic) {
  constexpr std::string_view kGyro = "gyro";
  const size_t position = gyro_topic.find(kGyro);
  if (position == std::string::npos) return "";
  return gyro_topic.replace(position, kGyro.size(), "accel");
}

}  // namespace calibrato
