#include "calibrato/learning/checkpoint.h"

#include <algorithm>

#include "calibrato/learning/byte_stream.h"
#include "calibrato/learning/transition_bytes.h"

namespace calibrato {
namespace {

constexpr std::string_view kMagic = "CALLEARN";
constexpr int64_t kVersion = 2;

}  // namespace

std::string ToBytes(const Checkpoint& checkpoint) {
  ByteWriter writer;
  writer.Write(static_cast<int64_t>(checkpoint.options.size()));
  for (const auto& [name, value] : checkpoint.options) {
    writer.Write(std::string_view(name));
    writer.Write(std::string_view(value));
  }
  writer.Write(static_cast<int64_t>(checkpoint.stage_episodes.size()));
  for (const int episodes : checkpoint.stage_episodes) writer.Write(int64_t{episodes});
  writer.Write(int64_t{checkpoint.num_warm_up_episodes});
  writer.Write(int64_t{checkpoint.num_episodes_done});
  writer.Write(checkpoint.num_calibrations);
  writer.Write(checkpoint.best_return);
  writer.Write(checkpoint.best_test_return);
  writer.Write(checkpoint.best_test_actions);
  writer.Write(int64_t{checkpoint.num_rollbacks});
  writer.Write(checkpoint.carried_over);
  writer.Write(std::string_view(checkpoint.agent));
  writer.Write(static_cast<int64_t>(checkpoint.replay_memory.capacity()));
  writer.Write(static_cast<int64_t>(checkpoint.replay_memory.size()));
  for (size_t i = 0; i < checkpoint.replay_memory.size(); ++i) {
    Write(checkpoint.replay_memory[i], writer);
  }
  writer.Write(std::string_view(checkpoint.training_jsonl));
  return Sealed(kMagic, kVersion, writer.bytes());
}

Checkpoint CheckpointFromBytes(std::string_view bytes, const std::string& path) {
  ByteReader reader(Unsealed(kMagic, kVersion, bytes, path), path);
  Checkpoint checkpoint;
  const int64_t num_options = reader.ReadInt();
  for (int64_t i = 0; i < num_options; ++i) {
    std::string name = reader.ReadText();
    std::string value = reader.ReadText();
    checkpoint.options.emplace_back(std::move(name), std::move(value));
  }
  const int64_t num_stages = reader.ReadInt();
  for (int64_t i = 0; i < num_stages; ++i) {
    checkpoint.stage_episodes.push_back(static_cast<int>(reader.ReadInt()));
  }
  checkpoint.num_warm_up_episodes = static_cast<int>(reader.ReadInt());
  checkpoint.num_episodes_done = static_cast<int>(reader.ReadInt());
  checkpoint.num_calibrations = reader.ReadInt();
  checkpoint.best_return = reader.ReadDouble();
  checkpoint.best_test_return = reader.ReadDouble();
  checkpoint.best_test_actions = reader.ReadMatrix();
  checkpoint.num_rollbacks = static_cast<int>(reader.ReadInt());
  checkpoint.carried_over = reader.ReadVector();
  checkpoint.agent = reader.ReadText();
  const int64_t capacity = reader.ReadInt();
  const int64_t num_transitions = reader.ReadInt();
  if (capacity < 1 || num_transitions > capacity) reader.Fail("a replay memory of impossible size");
  checkpoint.replay_memory = ReplayMemory(static_cast<size_t>(capacity));
  for (int64_t i = 0; i < num_transitions; ++i) {
    checkpoint.replay_memory.Add(ReadTransition(reader));
  }
  checkpoint.training_jsonl = reader.ReadText();
  reader.ExpectEnd();
  return checkpoint;
}

}  // namespace calibrato
