#pragma once

#include <memory>
#include <string>
#include <unordered_set>
#include <vector>

#include "calibrato/base/value.h"

namespace calibrato {

/// Builds a Value from what a parser meets, in the order of the file, and gives each part its file,
/// line and key. Holds the limits that keep a small hostile file from filling the memory: nesting,
/// number of values, bytes of text. Private to the room.
class ValueReader {
 public:
  static constexpr size_t kMaxDepth = 100;
  static constexpr size_t kMaxValues = 1'000'000;
  static constexpr size_t kMaxTextBytes = size_t{256} << 20;

  /// @param name  Stands for the file in errors.
  explicit ValueReader(const std::string& name);

  // Every `line` counts from 1. Each throws an InputError on a duplicate key or beyond a limit.
  void BeginObject(int line);
  void BeginArray(int line);
  /// Ends the innermost object or array.
  /// @return The completed value, valid until the next call.
  const Value& End();
  /// The key of the object's next value.
  void AddKey(const std::string& key, int line);
  /// A null, bool, number or quoted text.
  const Value& AddScalar(Value value, int line);
  /// Text without quotes, whose type is decided by the accessor that asks for it.
  const Value& AddPlainText(const std::string& text, int line);
  /// What an alias stands for. It keeps the line and key of its anchor, where its text is.
  void AddCopy(const Value& value, int line);
  /// Counts a copy kept outside, for later AddCopy calls, against the limits.
  void CountCopy(const Value& value);

  /// True where an object waits for a key.
  bool WantsKey() const;
  /// The root, when all that was begun has ended; null if nothing was added.
  Value Finish();

  /// @param column  0 if unknown.
  [[noreturn]] void Fail(const std::string& what, int line, int column, const std::string& why,
                         const std::string& remedy) const;

 private:
  struct Extent {
    size_t values = 1;
    size_t text_bytes = 0;
    size_t depth = 0;  // 0 for a scalar
  };
  struct Level {
    Value value;
    std::unordered_set<std::string> keys;  // of an object, to find duplicates
    std::string key;                       // of the next value
    int key_line = 0;                      // 0 while no key is pending
  };

  static Extent Measure(const Value& value);
  void Begin(Value value, int line);
  void CheckDepth(size_t depth, int line) const;
  void Count(size_t values, size_t text_bytes, int line);
  void SetSource(Value& value, int line);
  const Value& Place(Value value);

  std::shared_ptr<const std::string> file_;
  std::vector<Level> levels_;
  Value root_;
  size_t num_values_ = 0;
  size_t num_text_bytes_ = 0;
};

}  // namespace calibrato
